//! From the still part of an oscillation and the numbers of its clock to all of its functions.
//!
//! P = sum_j (-1)^j/j! (sum_m c_m Lambda_m)^j D^j p, D = (1/g) d/dpsi, g = 1 + sum_m c_m l^m/m!: the coefficient of
//! a monomial Lambda^k = prod_m Lambda_m^k_m is
//!
//!   C_k/prod_m k_m!,   C_k = (-1)^j prod_m c_m^k_m D^j p,   j = sum_m k_m,
//!
//! and no two still functions are multiplied but by g. Monomials with equal products of the c_m share C_k (for the power
//! law c_m = u^m, so that j and the weight decide), which leaves one multiplication by 1/(s! prod k_m!) for a term.
//! `docs/src/concepts/clock.md` has the proof.

mod check;
mod leaf;
mod monomials;

use super::{Factor, Lobachevsky, LobachevskyElement, LogPolynomial, Moments, Word};
use leaf::{Leaf, Leaves, factorial};
use lindstedt_algebra::{ClockAlgebra, RationalAlgebra, Ring, StillAndClock, Stop};
use lindstedt_coeff::sparse::{Monomial, Sparse};
use monomials::Monomials;
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

impl<C: Moments> ClockAlgebra for Lobachevsky<C> {
    fn pace(&self, numbers: &[C::Element]) -> Self::Element {
        let terms = (1u16..).zip(numbers).map(|(m, c)| {
            let inverse = Rational::from((1, factorial(m.into())));
            (Word::log(m), self.constants.scale(c, &inverse))
        });
        let factor = Factor { power: 0, sine: false };
        self.block(factor, Sparse::collect(&self.constants, terms))
    }

    fn split_clock(&self, f: &Self::Element) -> Option<StillAndClock<Self>> {
        let mut still = self.zero();
        let mut numbers = Vec::new();
        for (factor, polynomial) in f.blocks() {
            let mut rest: LogPolynomial<C::Element> = Sparse::default();
            for (word, c) in polynomial.terms() {
                if word.lambda_degree() == 0 {
                    let term = Sparse::term(&self.constants, word.clone(), c.clone());
                    rest.add_assign(&self.constants, &term);
                    continue;
                }
                let m = word.exponents().len() - 1;
                let alone = *word == Word::lambda(m as u16);
                if !alone || *factor != (Factor { power: 0, sine: true }) {
                    return None;
                }
                if numbers.len() < m {
                    numbers.resize(m, self.constants.zero());
                }
                numbers[m - 1] = c.clone();
            }
            if !rest.is_zero() {
                still.blocks.insert(*factor, rest);
            }
        }
        Some((still, numbers))
    }
}

/// A clock over constants C and the ring with the moments mu_m in which the functions are wanted.
pub struct Clock<'a, C: RationalAlgebra, T: Moments> {
    /// The constants of the clock.
    pub constants: &'a C,
    /// The constants with moments.
    pub target: &'a T,
    /// C in T.
    pub lift: &'a (dyn Fn(&C::Element) -> T::Element + Sync),
    /// The element of C that an element of T is, if it is one.
    pub restrict: &'a (dyn Fn(&T::Element) -> Option<C::Element> + Sync),
    /// c_mn by order n and then m - 1; nothing at order 0.
    pub numbers: &'a [Vec<C::Element>],
    /// Asked between the parts whether to stop.
    pub stop: Stop,
}

/// An element of the Lobachevsky ring over the formal constants of a clock.
pub type Still<C> = LobachevskyElement<<C as Ring>::Element>;

/// (-1)^j C_k order by order: the coefficients of l^s/s! by the position of the factor.
type Shared<E> = Vec<Vec<(usize, Vec<E>)>>;

/// The same by degree and product.
type SharedByKey<E> = BTreeMap<(usize, usize), Shared<E>>;

/// One block per factor and order, in increasing order of words.
type Blocks<E> = Vec<Vec<Vec<(Word, E)>>>;

impl<C: RationalAlgebra, T: Moments> Clock<'_, C, T> {
    fn order(&self) -> usize {
        self.numbers.len().saturating_sub(1)
    }

    /// x_0, x_1, ... from p_0, p_1, ...; nothing where these are not still, where `numbers` has not one list for each
    /// of them, or when stopped.
    ///
    /// Cost: a product of rational numbers per term of the result, beside O(N^3) small products.
    pub fn unfold(&self, still: &[Still<C>]) -> Option<Vec<LobachevskyElement<T::Element>>> {
        let leaves = Leaves(self.constants);
        let p: Vec<_> = still.iter().map(|f| leaves.of(f)).collect::<Option<_>>()?;
        if p.is_empty() || p.len() != self.numbers.len() {
            return None;
        }
        let monomials = Monomials::new(self.constants, self.numbers);
        let images = self.images(p, monomials.degree())?;
        let factors: BTreeSet<Factor> =
            images.iter().flatten().flat_map(|leaf| leaf.keys().copied()).collect();
        let factors: Vec<Factor> = factors.into_iter().collect();
        let shared = self.shared(&monomials, &images, &factors)?;
        let blocks = self.scatter(&monomials, &shared, factors.len())?;
        let element = |of_order: Vec<Vec<(Word, T::Element)>>| {
            let polynomials = of_order.into_iter().map(Sparse::from_increasing);
            let blocks = factors.iter().copied().zip(polynomials.collect::<Option<Vec<_>>>()?);
            let blocks = blocks.filter(|(_, polynomial)| !polynomial.is_zero()).collect();
            Some(LobachevskyElement { blocks })
        };
        blocks.into_iter().map(element).collect()
    }

    /// M = 1 + sum_m mu_m c_m, order by order: the mean of g. Where c_m = c^m its coefficients in powers of c are the
    /// mu_m themselves.
    pub fn mean_pace(&self) -> Vec<T::Element> {
        let coefficient = |(n, numbers): (usize, &Vec<C::Element>)| {
            let mut sum = if n == 0 { self.target.one() } else { self.target.zero() };
            for (m, c) in (1u16..).zip(numbers) {
                let term = self.target.mul(&self.target.moment(m), &(self.lift)(c));
                self.target.add_assign(&mut sum, &term);
            }
            sum
        };
        self.numbers.iter().enumerate().map(coefficient).collect()
    }

    /// D^j p for j = 0, 1, ..., up to the order N - j: g D f = f'.
    fn images(
        &self,
        p: Vec<Leaf<C::Element>>,
        degree: usize,
    ) -> Option<Vec<Vec<Leaf<C::Element>>>> {
        let leaves = Leaves(self.constants);
        let mut images = vec![p];
        for j in 0..degree {
            let mut next = Vec::new();
            let (_, but_last) = images[j].split_last()?;
            for (n, image) in but_last.iter().enumerate() {
                if self.stop.asked() {
                    return None;
                }
                let slope = leaves.derivative(image);
                let paced = leaves.paced(self.numbers, &next, n);
                next.push(leaves.difference(slope, &paced));
            }
            images.push(next);
        }
        Some(images)
    }

    /// (-1)^j C_k for every pair of a degree j and a product of the c_m.
    fn shared(
        &self,
        monomials: &Monomials<C::Element>,
        images: &[Vec<Leaf<C::Element>>],
        factors: &[Factor],
    ) -> Option<SharedByKey<C::Element>> {
        let leaves = Leaves(self.constants);
        let mut shared = BTreeMap::new();
        for monomial in &monomials.list {
            let key = (monomial.degree, monomial.product);
            if shared.contains_key(&key) {
                continue;
            }
            if self.stop.asked() {
                return None;
            }
            let orders = leaves.times(&monomials.products[key.1], &images[key.0], self.order());
            let indexed = |leaf: Leaf<C::Element>| {
                let position = |factor: &Factor| factors.binary_search(factor).ok();
                leaf.into_iter().filter_map(|(f, list)| Some((position(&f)?, list))).collect()
            };
            shared.insert(key, orders.into_iter().map(indexed).collect());
        }
        Some(shared)
    }

    /// Every C_k to its words l^s Lambda^k with the factor (-1)^j/(s! prod k_m!), in the order of the words.
    fn scatter(
        &self,
        monomials: &Monomials<C::Element>,
        shared: &SharedByKey<C::Element>,
        factors: usize,
    ) -> Option<Blocks<T::Element>> {
        let mut words = Vec::new();
        for monomial in &monomials.list {
            let orders = shared.get(&(monomial.degree, monomial.product))?;
            let lengths = orders.iter().flatten().map(|(_, list)| list.len());
            let length = lengths.max().unwrap_or(0);
            words.extend(
                (0..length).map(|s| (monomial.word.times(&Word::log(s as u16)), s, monomial)),
            );
        }
        words.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        let mut blocks: Blocks<T::Element> =
            (0..=self.order()).map(|_| (0..factors).map(|_| Vec::new()).collect()).collect();
        for (word, s, monomial) in words {
            if self.stop.asked() {
                return None;
            }
            let mut factor = Rational::from((1, factorial(s) * &monomial.factorials));
            if monomial.degree % 2 == 1 {
                factor = -factor;
            }
            let orders = shared.get(&(monomial.degree, monomial.product))?;
            for (of_order, target) in orders.iter().zip(&mut blocks) {
                for (position, list) in of_order {
                    let c = list.get(s).filter(|c| !self.constants.is_zero(c));
                    if let Some(c) = c {
                        let value = (self.lift)(&self.constants.scale(c, &factor));
                        target[*position].push((word.clone(), value));
                    }
                }
            }
        }
        Some(blocks)
    }
}
