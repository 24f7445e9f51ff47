//! Monomials in the Lambda_m that occur up to an order, and the products of the c_m that belong to them.

use super::super::Word;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::sparse::Monomial;
use rug::Integer;
use std::collections::BTreeMap;

/// prod_m Lambda_m^k_m.
#[derive(Clone, Debug)]
pub struct LambdaMonomial {
    /// As a word without l.
    pub word: Word,
    /// sum_m k_m.
    pub degree: usize,
    /// prod_m k_m!.
    pub factorials: Integer,
    /// prod_m c_m^k_m, by its position among the different ones.
    pub product: usize,
}

/// All monomials whose product of the c_m does not vanish up to the order.
#[derive(Clone, Debug)]
pub(super) struct Monomials<E> {
    pub list: Vec<LambdaMonomial>,
    /// Series in the small parameter, no two of them equal.
    pub products: Vec<Vec<E>>,
}

impl<E: Clone + PartialEq> Monomials<E> {
    /// The monomials for `numbers[n][m - 1]` = c_mn.
    pub fn new<C: RationalAlgebra<Element = E>>(constants: &C, numbers: &[Vec<E>]) -> Self {
        let largest = numbers.iter().map(Vec::len).max().unwrap_or(0);
        let zero = constants.zero();
        let at = |m: usize, n: usize| numbers[n].get(m - 1).unwrap_or(&zero).clone();
        let clock: Vec<Vec<E>> =
            (1..=largest).map(|m| (0..numbers.len()).map(|n| at(m, n)).collect()).collect();
        let mut one = vec![constants.zero(); numbers.len()];
        one[0] = constants.one();
        let unit = LambdaMonomial {
            word: Word::unit(),
            degree: 0,
            factorials: Integer::from(1),
            product: 0,
        };
        let mut all = Self { list: vec![unit], products: vec![one] };
        let mut known: BTreeMap<(usize, usize), Option<usize>> = BTreeMap::new();
        // Every monomial once: its factors never decrease.
        let mut stack = vec![(0, 1)];
        while let Some((index, first)) = stack.pop() {
            for m in first..=largest {
                let parent = &all.list[index];
                let key = (parent.product, m);
                let product = match known.get(&key) {
                    Some(product) => *product,
                    None => {
                        let product = all.multiplied(constants, key.0, &clock[m - 1]);
                        known.insert(key, product);
                        product
                    }
                };
                let Some(product) = product else { continue };
                let parent = &all.list[index];
                let word = parent.word.times(&Word::lambda(m as u16));
                let exponent = word.exponents().get(m).copied().unwrap_or(1);
                let child = LambdaMonomial {
                    degree: parent.degree + 1,
                    factorials: Integer::from(&parent.factorials * u32::from(exponent)),
                    word,
                    product,
                };
                all.list.push(child);
                stack.push((all.list.len() - 1, m));
            }
        }
        all
    }

    /// The position of a product times a series; nothing where it vanishes up to the order.
    fn multiplied<C: RationalAlgebra<Element = E>>(
        &mut self,
        constants: &C,
        product: usize,
        by: &[E],
    ) -> Option<usize> {
        let a = &self.products[product];
        let coefficient = |n: usize| {
            let pairs: Vec<_> = a[..=n].iter().zip(by[..=n].iter().rev()).collect();
            let nonzero = |(x, y): &(&E, &E)| !constants.is_zero(x) && !constants.is_zero(y);
            let pairs: Vec<_> = pairs.into_iter().filter(nonzero).collect();
            constants.sum_of_products(&pairs)
        };
        let series: Vec<E> = (0..a.len()).map(coefficient).collect();
        if series.iter().all(|c| constants.is_zero(c)) {
            return None;
        }
        let found = self.products.iter().position(|other| *other == series);
        Some(found.unwrap_or_else(|| {
            self.products.push(series);
            self.products.len() - 1
        }))
    }

    /// The largest number of factors.
    pub fn degree(&self) -> usize {
        self.list.iter().map(|monomial| monomial.degree).max().unwrap_or(0)
    }
}
