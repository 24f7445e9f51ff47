//! The judge of functions that are said to be one function of a clock: dP/dLambda_m = -c_m D P, term by term.
//!
//! It reads the finished functions, not what made them. With P = sum_k C_k Lambda^k/prod k_m! it verifies
//!
//!   g C_{k + e_m} = -c_m dC_k/dpsi   (orders 0 to N, m no larger than the smallest index in k)
//!
//! and that C_0 is the still part. Every monomial but 1 is reached once, so all C_k = (-1)^j prod c_m^k_m D^j p, which is
//! the identity for every m. It is linear in the functions: monomials whose coefficients are equal are
//! recognised by comparing them, and the operators act on one of them.

use super::super::{Factor, LobachevskyElement, Moments};
use super::leaf::{Leaf, Leaves, factorial};
use super::{Clock, Still};
use lindstedt_algebra::{RationalAlgebra, Stopping};
use rug::{Integer, Rational};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Exponents of Lambda_1, Lambda_2, ... without trailing zeros.
type Exponents<'a> = &'a [u16];

/// One term: its order, its factor, the exponent of l, its coefficient.
type Place<'a, E> = (usize, Factor, usize, &'a E);

/// Classes with the terms of one of their monomials, by degree, weight and prod k_m!.
type Seen<'a, E> = BTreeMap<(u32, u32, Integer), Vec<(usize, &'a [Place<'a, E>])>>;

impl<C: RationalAlgebra, T: Moments> Clock<'_, C, T> {
    /// Whether the functions x_n have the still parts p_n and obey dP/dLambda_m = -c_m D P for all m, identically and
    /// up to the order; nothing when stopped.
    ///
    /// # Errors
    /// The first order at which that is seen to fail; 0 where the lists do not fit together.
    pub fn check(
        &self,
        still: &[Still<C>],
        functions: &[LobachevskyElement<T::Element>],
    ) -> Option<Result<(), usize>> {
        let leaves = Leaves(self.constants);
        let p: Option<Vec<_>> = still.iter().map(|f| Some(leaves.trimmed(leaves.of(f)?))).collect();
        let same_length = functions.len() == self.numbers.len() && functions.len() == still.len();
        let (Some(p), true) = (p, same_length) else { return Some(Err(0)) };
        let Some(mut parts) = self.parts(functions)? else { return Some(Err(0)) };
        let unit = parts.class_of.get(&[][..]).map(|&class| &parts.classes[class]);
        let differs = |(a, b): (&Leaf<_>, &Leaf<_>)| a != b;
        let Some(unit) = unit else { return Some(Err(0)) };
        if let Some(order) = unit.iter().zip(&p).position(differs) {
            return Some(Err(order));
        }
        self.identities(&mut parts)
    }

    /// The C_k; nothing inside where one of them is not over the constants of the clock.
    fn parts<'a>(
        &self,
        functions: &'a [LobachevskyElement<T::Element>],
    ) -> Option<Option<Parts<'a, C::Element>>> {
        let mut places: FxHashMap<Exponents<'a>, Vec<Place<'a, T::Element>>> = FxHashMap::default();
        for (n, f) in functions.iter().enumerate() {
            for (factor, polynomial) in f.blocks() {
                if self.stop.asked() {
                    return None;
                }
                for (word, c) in polynomial.terms() {
                    let (s, lambdas) = word.exponents().split_first().unwrap_or((&0, &[]));
                    places.entry(lambdas).or_default().push((n, *factor, (*s).into(), c));
                }
            }
        }
        let mut parts = Parts { classes: Vec::new(), class_of: FxHashMap::default() };
        // Monomials that can share a coefficient, by degree, weight and prod k_m!: terms are compared as they stand.
        let mut seen: Seen<'_, T::Element> = BTreeMap::new();
        for (exponents, list) in &places {
            if self.stop.asked() {
                return None;
            }
            let key = signature(exponents);
            let alike = seen.entry(key.clone()).or_default();
            let found = alike.iter().find(|(_, other)| *other == &list[..]);
            let class = match found {
                Some((class, _)) => *class,
                None => {
                    let Some(series) = self.series(list, &key.2) else { return Some(None) };
                    let class = parts.class(series);
                    alike.push((class, list));
                    class
                }
            };
            parts.class_of.insert(exponents, class);
        }
        Some(Some(parts))
    }

    /// C_k from the terms of its monomial.
    fn series(
        &self,
        list: &[Place<'_, T::Element>],
        factorials: &Integer,
    ) -> Option<Vec<Leaf<C::Element>>> {
        let leaves = Leaves(self.constants);
        let mut series = vec![Leaf::new(); self.numbers.len()];
        for &(n, factor, s, c) in list {
            let scale = Rational::from(factorial(s) * factorials);
            let value = self.constants.scale(&(self.restrict)(c)?, &scale);
            leaves.put(series[n].entry(factor).or_default(), s, &value);
        }
        Some(series.into_iter().map(|leaf| leaves.trimmed(leaf)).collect())
    }

    /// g C_{k + e_m} = -c_m dC_k/dpsi for all k and m that are due.
    fn identities(&self, parts: &mut Parts<'_, C::Element>) -> Option<Result<(), usize>> {
        let largest = self.numbers.iter().map(Vec::len).max().unwrap_or(0);
        let none = parts.class(vec![Leaf::new(); self.numbers.len()]);
        let mut due: FxHashMap<(usize, usize, usize), ()> = FxHashMap::default();
        for (exponents, class) in &parts.class_of {
            let smallest = exponents.iter().position(|k| *k > 0);
            for m in 0..smallest.map_or(largest, |m| (m + 1).min(largest)) {
                let mut child = exponents.to_vec();
                child.resize(child.len().max(m + 1), 0);
                child[m] += 1;
                let child = parts.class_of.get(&child[..]).copied().unwrap_or(none);
                due.insert((*class, m, child), ());
            }
            // A monomial whose parent does not occur is no image of anything.
            if let Some(m) = smallest {
                let mut parent = exponents.to_vec();
                parent[m] -= 1;
                while parent.last() == Some(&0) {
                    parent.pop();
                }
                if m >= largest || !parts.class_of.contains_key(&parent[..]) {
                    let first = parts.classes[*class].iter().position(|leaf| !leaf.is_empty());
                    return Some(Err(first.unwrap_or(0)));
                }
            }
        }
        let constants = Stopping(self.constants, &self.stop);
        let leaves = Leaves(&constants);
        let mut slopes = BTreeMap::new();
        let mut paced = BTreeMap::new();
        for (parent, m, child) in due.into_keys() {
            let slope: &Vec<_> = slopes.entry(parent).or_insert_with(|| {
                parts.classes[parent].iter().map(|leaf| leaves.derivative(leaf)).collect()
            });
            let left: &Vec<_> = paced.entry(child).or_insert_with(|| {
                let series = &parts.classes[child];
                let minus = |n| leaves.paced(self.numbers, series, n);
                let orders = series.iter().enumerate();
                orders.map(|(n, c)| leaves.difference(minus(n), &leaves.negated(c))).collect()
            });
            let zero = self.constants.zero();
            let number = |of_order: &Vec<_>| of_order.get(m).unwrap_or(&zero).clone();
            let number: Vec<_> = self.numbers.iter().map(number).collect();
            let right = leaves.times(&number, slope, self.order());
            // Products that were left out are no defect.
            if self.stop.asked() {
                return None;
            }
            let differs = |(a, b)| !leaves.difference(leaves.negated(a), b).is_empty();
            if let Some(order) = left.iter().zip(&right).position(differs) {
                return Some(Err(order));
            }
        }
        Some(Ok(()))
    }
}

/// The C_k, each different one once.
struct Parts<'a, E> {
    classes: Vec<Vec<Leaf<E>>>,
    class_of: FxHashMap<Exponents<'a>, usize>,
}

impl<E: PartialEq> Parts<'_, E> {
    /// The position of a series among the different ones.
    fn class(&mut self, series: Vec<Leaf<E>>) -> usize {
        let found = self.classes.iter().position(|other| *other == series);
        found.unwrap_or_else(|| {
            self.classes.push(series);
            self.classes.len() - 1
        })
    }
}

/// Degree, weight and prod k_m! of a monomial.
fn signature(exponents: Exponents<'_>) -> (u32, u32, Integer) {
    let (mut degree, mut weight, mut product) = (0, 0, Integer::from(1));
    for (m, &k) in (1u32..).zip(exponents) {
        degree += u32::from(k);
        weight += m * u32::from(k);
        product *= factorial(k.into());
    }
    (degree, weight, product)
}
