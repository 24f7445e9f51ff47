//! All functions of a clock, kept unexpanded: D^j p, the products of the c_m and the monomials.
//!
//! Where all c_m are powers of one rational series v (the power law: v = delta/(1 + delta)), everything is kept in
//! powers of v, where a product of the c_m is one power and D^j p has O(j) coefficients an order in place of O(j N).

use super::super::{Factor, Lobachevsky, LobachevskyElement, Word};
use super::leaf::{Leaf, Leaves, factorial};
use super::monomials::{LambdaMonomial, Monomials};
use super::{ClockAlgebra, Still};
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::sparse::{Monomial, Sparse};
use rug::{Integer, Rational};
use std::collections::BTreeMap;
use std::fmt::Debug;

/// P = sum_j (-1)^j/j! (sum_m c_m Lambda_m)^j D^j p by its parts: c_m, D^j p as series in v, and v as one in eps.
///
/// ```
/// use lindstedt_algebra::{PhaseAlgebra, Rationals, Ring, Stop};
/// use lindstedt_phase::{Lobachevsky, lobachevsky::Unfolding};
/// use rug::Rational;
/// // To order 1 the power law has p = cos + delta cos l and c_1 = delta: x_1 = cos l + sin Lambda_1.
/// let ring = Lobachevsky::formal(Rationals);
/// let still = [ring.cosine(), ring.mul(&ring.cosine(), &ring.log_secant())];
/// let numbers = [vec![], vec![Rational::from(1)]];
/// let stop = Stop::default();
/// let parts = Unfolding::new(&Rationals, &numbers, None, &still, &stop).ok_or("not still")?;
/// assert_eq!(parts.judge(&ring, &numbers, &still), Some(Ok(())));
/// let lift = |q: &Rational| q.clone();
/// let x_1 = parts.function(1, &Rationals, &lift, &stop).ok_or("stopped")?;
/// assert_eq!(x_1, ring.add(&still[1], &ring.mul(&ring.sine(), &ring.lambda(1))));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug)]
pub struct Unfolding<E> {
    /// c_m in powers of v, by order and then m - 1.
    numbers: Vec<Vec<E>>,
    /// \[eps^n\] v^k by k and then n.
    powers: Vec<Vec<Rational>>,
    /// D^j p in powers of v, by j and then the order up to N - j.
    images: Vec<Vec<Leaf<E>>>,
    monomials: Monomials<E>,
}

impl<E: Clone + PartialEq + Debug + Send + Sync> Unfolding<E> {
    /// The parts for p_0, p_1, ... and `numbers[n][m - 1]` = c_mn; `variable` is v where c_m = v^m for all m. Nothing
    /// where the p_n are not still, where there is not one list of numbers for each of them, where v does not begin
    /// at order one, or when stopped.
    pub fn new<C: RationalAlgebra<Element = E>>(
        constants: &C,
        numbers: &[Vec<E>],
        variable: Option<&[Rational]>,
        still: &[Still<C>],
        stop: &Stop,
    ) -> Option<Self> {
        let leaves = Leaves(constants);
        let p: Vec<_> = still.iter().map(|f| leaves.of(f)).collect::<Option<_>>()?;
        if p.is_empty() || p.len() != numbers.len() {
            return None;
        }
        let order = p.len() - 1;
        let powers = powers(variable, order);
        let numbers = match variable {
            Some(_) => (0..=order).map(|m| unit(constants, m)).collect(),
            None => numbers.to_vec(),
        };
        let p = match variable {
            Some(_) => in_variable(constants, &powers, p)?,
            None => p,
        };
        let monomials = Monomials::new(constants, &numbers);
        let images = images(constants, &numbers, p, monomials.degree(), stop)?;
        Some(Self { numbers, powers, images, monomials })
    }

    fn order(&self) -> usize {
        self.numbers.len() - 1
    }

    /// The monomials prod_m Lambda_m^k_m that occur.
    pub fn monomials(&self) -> &[LambdaMonomial] {
        &self.monomials.list
    }

    /// The different products prod_m c_m^k_m, as series in eps; a monomial knows the position of its own.
    pub fn products<C: RationalAlgebra<Element = E>>(&self, constants: &C) -> Vec<Vec<E>> {
        let in_eps = |product: &Vec<E>| {
            let coefficient = |n| self.weights(constants, product, n).swap_remove(0);
            (0..=self.order()).map(coefficient).collect()
        };
        self.monomials.products.iter().map(in_eps).collect()
    }

    /// What the order t of a function in v counts for in order n of its product with a series: sum_i
    /// \[eps^n\] v^(i + t) a_i, for t = 0, ..., n.
    fn weights<C: RationalAlgebra<Element = E>>(&self, constants: &C, a: &[E], n: usize) -> Vec<E> {
        let nonzero: Vec<_> = a.iter().enumerate().filter(|(_, c)| !constants.is_zero(c)).collect();
        let weight = |t: usize| {
            let mut sum = constants.zero();
            for &(i, c) in nonzero.iter().take_while(|(i, _)| i + t <= n) {
                let power = &self.powers[i + t][n];
                if !power.is_zero() {
                    constants.add_assign(&mut sum, &constants.scale(c, power));
                }
            }
            sum
        };
        (0..=n).map(weight).collect()
    }

    /// x_n, with its coefficients in another ring; nothing when stopped or beyond the order.
    ///
    /// Cost: a product of numbers per term, beside O(n^2) combinations of the D^j p.
    pub fn function<C: RationalAlgebra<Element = E>, F>(
        &self,
        n: usize,
        constants: &C,
        lift: &(dyn Fn(&E) -> F + Sync),
        stop: &Stop,
    ) -> Option<LobachevskyElement<F>>
    where
        F: Clone + PartialEq + Debug + Send + Sync,
    {
        if n > self.order() {
            return None;
        }
        let leaves = Leaves(constants);
        let mut weights: BTreeMap<usize, Vec<E>> = BTreeMap::new();
        let mut combined: BTreeMap<(usize, usize), Leaf<E>> = BTreeMap::new();
        let mut blocks: BTreeMap<Factor, Vec<(Word, F)>> = BTreeMap::new();
        for monomial in &self.monomials.list {
            if stop.asked() {
                return None;
            }
            let key = (monomial.degree, monomial.product);
            let leaf = combined.entry(key).or_insert_with(|| {
                let product = &self.monomials.products[key.1];
                let weights =
                    weights.entry(key.1).or_insert_with(|| self.weights(constants, product, n));
                let known = weights.iter().zip(&self.images[key.0]);
                let known: Vec<_> = known.filter(|(w, _)| !constants.is_zero(w)).collect();
                leaves.combination(&known)
            });
            let length = leaf.values().map(Vec::len).max().unwrap_or(0);
            for s in 0..length {
                let mut factor = Rational::from((1, factorial(s) * &monomial.factorials));
                if monomial.degree % 2 == 1 {
                    factor = -factor;
                }
                let word = monomial.word.times(&Word::log(s as u16));
                for (position, list) in leaf.iter() {
                    if let Some(c) = list.get(s).filter(|c| !constants.is_zero(c)) {
                        let value = lift(&constants.scale(c, &factor));
                        blocks.entry(*position).or_default().push((word.clone(), value));
                    }
                }
            }
        }
        let block = |(factor, mut terms): (Factor, Vec<(Word, F)>)| {
            terms.sort_unstable_by(|(a, _), (b, _)| a.cmp(b));
            Some((factor, Sparse::from_increasing(terms)?))
        };
        Some(LobachevskyElement { blocks: blocks.into_iter().map(block).collect::<Option<_>>()? })
    }

    /// The number of terms of x_0, x_1, ..., none of which is formed: an image of a coefficient under a homomorphism
    /// to `residues` that is not zero shows that the coefficient is not; where it is zero the coefficient itself is
    /// formed. `image` gives nothing where a number has none, and so does this.
    pub fn terms<C: RationalAlgebra<Element = E>, R: RationalAlgebra>(
        &self,
        constants: &C,
        residues: &R,
        image: &dyn Fn(&E) -> Option<R::Element>,
        stop: &Stop,
    ) -> Option<Vec<usize>> {
        let mut alike: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for monomial in &self.monomials.list {
            *alike.entry((monomial.degree, monomial.product)).or_default() += 1;
        }
        let (rows, slots) = self.rows(constants, image)?;
        let list = |list: &Vec<E>| list.iter().map(image).collect::<Option<Vec<_>>>();
        let products: Vec<_> = self.monomials.products.iter().map(list).collect::<Option<_>>()?;
        let power = |q: &Rational| image(&constants.rational(q));
        let powers = self.powers.iter().map(|list| list.iter().map(power).collect());
        let powers: Vec<Vec<_>> = powers.collect::<Option<_>>()?;
        let mut counts = vec![0; self.order() + 1];
        for (&(degree, product), &count) in &alike {
            if stop.asked() {
                return None;
            }
            let series =
                self.monomials.products[product].iter().zip(&products[product]).enumerate();
            let series: Vec<_> = series.filter(|(_, (c, _))| !constants.is_zero(c)).collect();
            for (n, counted) in counts.iter_mut().enumerate() {
                let mut sums: Vec<Option<R::Element>> = vec![None; slots[degree].len()];
                for (t, row) in rows[degree].iter().enumerate().take(n + 1) {
                    let known = series.iter().take_while(|(i, _)| i + t <= n);
                    let known = known.filter(|(i, _)| !self.powers[i + t][n].is_zero());
                    let pairs: Vec<_> = known.map(|(i, (_, c))| (*c, &powers[i + t][n])).collect();
                    if pairs.is_empty() {
                        continue;
                    }
                    let weight = residues.sum_of_products(&pairs);
                    for (slot, c) in row {
                        let sum = sums[*slot].get_or_insert_with(|| residues.zero());
                        residues.add_assign(sum, &residues.mul(&weight, c));
                    }
                }
                let mut found = 0;
                for (sum, place) in sums.iter().zip(&slots[degree]) {
                    found += match sum {
                        None => 0,
                        Some(sum) if !residues.is_zero(sum) => 1,
                        Some(_) => {
                            usize::from(!self.vanishes(constants, degree, product, n, *place))
                        }
                    };
                }
                *counted += count * found;
            }
        }
        Some(counts)
    }

    /// Whether a coefficient of (-1)^j C_k is zero.
    fn vanishes<C: RationalAlgebra<Element = E>>(
        &self,
        constants: &C,
        degree: usize,
        product: usize,
        n: usize,
        (factor, s): (Factor, usize),
    ) -> bool {
        let weights = self.weights(constants, &self.monomials.products[product], n);
        let known = weights.iter().zip(&self.images[degree]);
        let pairs: Vec<_> =
            known.filter_map(|(w, leaf)| Some((w, leaf.get(&factor)?.get(s)?))).collect();
        constants.is_zero(&constants.sum_of_products(&pairs))
    }

    /// The images of the coefficients of D^j p, by j and order, with the position of their places among all of j.
    #[expect(clippy::type_complexity, reason = "the two halves of one table")]
    fn rows<C: RationalAlgebra<Element = E>, R>(
        &self,
        constants: &C,
        image: &dyn Fn(&E) -> Option<R>,
    ) -> Option<(Vec<Vec<Vec<(usize, R)>>>, Vec<Vec<(Factor, usize)>>)> {
        let (mut rows, mut slots) = (Vec::new(), Vec::new());
        for of_degree in &self.images {
            let mut known: BTreeMap<(Factor, usize), usize> = BTreeMap::new();
            let mut list = Vec::new();
            for leaf in of_degree {
                let mut row = Vec::new();
                for (factor, coefficients) in leaf {
                    let nonzero = coefficients.iter().enumerate();
                    for (s, c) in nonzero.filter(|(_, c)| !constants.is_zero(c)) {
                        let next = known.len();
                        let slot = *known.entry((*factor, s)).or_insert(next);
                        row.push((slot, image(c)?));
                    }
                }
                list.push(row);
            }
            let mut places: Vec<_> = known.into_iter().map(|(place, slot)| (slot, place)).collect();
            places.sort_unstable_by_key(|(slot, _)| *slot);
            slots.push(places.into_iter().map(|(_, place)| place).collect());
            rows.push(list);
        }
        Some((rows, slots))
    }

    /// Whether these are the parts of the function P with still part p_0, p_1, ... and dP/dLambda_m = -c_m D P,
    /// identically and up to the order; nothing when the algebra is stopped.
    ///
    /// With P = sum_j (-1)^j/j! (sum_m c_m Lambda_m)^j P_j the identity is g P_(j + 1) = dP_j/dpsi, and P_0 = p. Both
    /// are verified in the Lobachevsky ring, by its products and its derivation, which made none of the parts.
    ///
    /// # Errors
    /// The first order at which that is seen to fail; 0 where the lists do not fit together.
    pub fn judge<C: RationalAlgebra<Element = E> + Clone>(
        &self,
        algebra: &Lobachevsky<C>,
        numbers: &[Vec<E>],
        still: &[Still<C>],
    ) -> Option<Result<(), usize>> {
        let constants = &algebra.constants;
        let order = self.order();
        if numbers.len() != order + 1 || still.len() != order + 1 {
            return Some(Err(0));
        }
        let largest = self.numbers.iter().chain(numbers).map(Vec::len).max().unwrap_or(0);
        let zero = constants.zero();
        let at = |list: &[Vec<E>], n: usize, m: usize| list[n].get(m).unwrap_or(&zero).clone();
        for n in 0..=order {
            for m in 0..largest {
                let own: Vec<E> = (0..=order).map(|k| at(&self.numbers, k, m)).collect();
                if self.weights(constants, &own, n)[0] != at(numbers, n, m) {
                    return Some(Err(n));
                }
            }
        }
        let element = |leaf: &Leaf<E>| element(constants, leaf);
        let mut images: Vec<Vec<_>> = Vec::new();
        for list in &self.images {
            images.push(list.iter().map(element).collect());
        }
        for (n, p) in still.iter().enumerate() {
            let mut sum = algebra.zero();
            for (f, power) in images[0].iter().zip(self.powers.iter().map(|list| &list[n])) {
                algebra.add_assign(&mut sum, &algebra.scale(f, power));
            }
            if sum != *p {
                return Some(Err(n));
            }
        }
        let mut pace: Vec<_> = self.numbers.iter().map(|c| algebra.pace(c)).collect();
        pace[0] = algebra.one();
        for (j, pair) in images.windows(2).enumerate() {
            if pair[0].len() != pair[1].len() + 1 || pair[0].len() != order + 1 - j {
                return Some(Err(0));
            }
            for n in 0..pair[1].len() {
                let factors: Vec<_> = pace[..=n].iter().zip(pair[1][..=n].iter().rev()).collect();
                let left = algebra.sum_of_products(&factors);
                let right = algebra.derivative(&pair[0][n]);
                // Products that were left out are no defect.
                if algebra.stop.asked() {
                    return None;
                }
                if left != right {
                    return Some(Err(n + j));
                }
            }
        }
        // Every monomial that occurs finds its image.
        let whole = self.monomials.degree() < self.images.len();
        Some(if whole { Ok(()) } else { Err(order) })
    }
}

/// The m-th unit list: c_m = v^m as numbers of order m.
fn unit<C: RationalAlgebra>(constants: &C, m: usize) -> Vec<C::Element> {
    let mut list = vec![constants.zero(); m];
    if let Some(last) = list.last_mut() {
        *last = constants.one();
    }
    list
}

/// \[eps^n\] v^k by k and then n, for v = eps if there is none.
fn powers(variable: Option<&[Rational]>, order: usize) -> Vec<Vec<Rational>> {
    let zero = || vec![Rational::new(); order + 1];
    let mut power = zero();
    power[0] += 1;
    let mut list = vec![power];
    for k in 1..=order {
        let mut next = zero();
        let below = &list[k - 1];
        match variable {
            None => next[k] += 1,
            Some(v) => {
                for (n, target) in next.iter_mut().enumerate().skip(k) {
                    let pairs: Vec<_> = below[..=n].iter().zip(v[..=n].iter().rev()).collect();
                    *target = Rationals.sum_of_products(&pairs);
                }
            }
        }
        list.push(next);
    }
    list
}

/// A series in eps as one in v: order n of it is (p_n - sum_{k<n} \[eps^n\] v^k f_k)/\[eps^n\] v^n.
fn in_variable<C: RationalAlgebra>(
    constants: &C,
    powers: &[Vec<Rational>],
    p: Vec<Leaf<C::Element>>,
) -> Option<Vec<Leaf<C::Element>>> {
    let leaves = Leaves(constants);
    let mut list: Vec<Leaf<C::Element>> = Vec::new();
    for (n, p) in p.into_iter().enumerate() {
        let leading = &powers[n][n];
        if leading.is_zero() {
            return None;
        }
        let inverse = Rational::from(leading.recip_ref());
        let number = |q: Rational| constants.rational(&q);
        let weights: Vec<_> =
            (0..n).map(|k| number(-Rational::from(&powers[k][n] * &inverse))).collect();
        let own = number(inverse);
        let mut terms: Vec<_> = weights.iter().zip(&list).collect();
        terms.push((&own, &p));
        let next = leaves.combination(&terms);
        list.push(next);
    }
    Some(list)
}

/// D^j p for j = 0, 1, ..., up to the order N - j: g D f = f'.
fn images<C: RationalAlgebra>(
    constants: &C,
    numbers: &[Vec<C::Element>],
    p: Vec<Leaf<C::Element>>,
    degree: usize,
    stop: &Stop,
) -> Option<Vec<Vec<Leaf<C::Element>>>> {
    let leaves = Leaves(constants);
    let mut images = vec![p];
    for j in 0..degree {
        let mut next = Vec::new();
        let (_, but_last) = images[j].split_last()?;
        for (n, image) in but_last.iter().enumerate() {
            if stop.asked() {
                return None;
            }
            let slope = leaves.derivative(image);
            let paced = leaves.paced(numbers, &next, n);
            next.push(leaves.difference(slope, &paced));
        }
        images.push(next);
    }
    Some(images)
}

/// A leaf as an element of the ring.
fn element<C: RationalAlgebra>(
    constants: &C,
    leaf: &Leaf<C::Element>,
) -> LobachevskyElement<C::Element> {
    let mut blocks = BTreeMap::new();
    for (factor, list) in leaf {
        let term = |(s, c): (usize, &C::Element)| {
            let inverse = Rational::from((Integer::from(1), factorial(s)));
            (Word::log(s as u16), constants.scale(c, &inverse))
        };
        let polynomial = Sparse::collect(constants, list.iter().enumerate().map(term));
        if !polynomial.is_zero() {
            blocks.insert(*factor, polynomial);
        }
    }
    LobachevskyElement { blocks }
}
