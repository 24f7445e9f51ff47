//! Still functions: polynomials in l for every cos^k and cos^k sin, dense in the divided powers l^s/s!.
//!
//! In these the solution of the power law has integer coefficients: products bring binomial coefficients and no
//! denominators, and d(l^s/s!)/dl = l^(s-1)/(s-1)! is a shift.

use super::super::{Factor, LobachevskyElement};
use lindstedt_algebra::RationalAlgebra;
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// The coefficients of l^s/s!, s = 0, 1, ..., by factor.
pub(super) type Leaf<E> = BTreeMap<Factor, Vec<E>>;

/// s!.
pub(super) fn factorial(s: usize) -> Integer {
    Integer::from(Integer::factorial(s as u32))
}

/// Calculus of still functions over a ring of constants.
pub(super) struct Leaves<'a, C>(pub &'a C);

impl<C: RationalAlgebra> Leaves<'_, C> {
    /// A function as a leaf; nothing where it is not still.
    pub fn of(&self, f: &LobachevskyElement<C::Element>) -> Option<Leaf<C::Element>> {
        let mut leaf = Leaf::new();
        for (factor, polynomial) in f.blocks() {
            let mut list = Vec::new();
            for (word, c) in polynomial.terms() {
                let s = match word.exponents() {
                    [] => 0,
                    &[s] => usize::from(s),
                    _ => return None,
                };
                self.put(&mut list, s, &self.0.scale(c, &Rational::from(factorial(s))));
            }
            leaf.insert(*factor, list);
        }
        Some(leaf)
    }

    /// list\[s\] += c.
    pub fn put(&self, list: &mut Vec<C::Element>, s: usize, c: &C::Element) {
        if list.len() <= s {
            list.resize(s + 1, self.0.zero());
        }
        self.0.add_assign(&mut list[s], c);
    }

    /// Without zeros at the ends, so that equal functions are equal lists.
    pub fn trimmed(&self, mut f: Leaf<C::Element>) -> Leaf<C::Element> {
        for list in f.values_mut() {
            while list.last().is_some_and(|c| self.0.is_zero(c)) {
                list.pop();
            }
        }
        f.retain(|_, list| !list.is_empty());
        f
    }

    /// f - g.
    pub fn difference(&self, f: Leaf<C::Element>, g: &Leaf<C::Element>) -> Leaf<C::Element> {
        let mut f = f;
        for (factor, list) in g {
            let own = f.entry(*factor).or_default();
            for (s, c) in list.iter().enumerate() {
                self.put(own, s, &self.0.neg(c));
            }
        }
        self.trimmed(f)
    }

    /// df/dpsi:  (cos^k w)' = cos^(k-1) sin (dw/dl - k w),
    /// (cos^k sin w)' = cos^(k-1) (dw/dl - k w) + cos^(k+1) ((k + 1) w - dw/dl).
    pub fn derivative(&self, f: &Leaf<C::Element>) -> Leaf<C::Element> {
        let mut image = Leaf::new();
        for (&Factor { power, sine }, w) in f {
            let mut add = |power, sine, k: i32, sign: i32| {
                let list = image.entry(Factor { power, sine }).or_default();
                for (s, c) in w.iter().enumerate() {
                    if self.0.is_zero(c) {
                        continue;
                    }
                    self.put(list, s, &self.0.scale(c, &Rational::from(-sign * k)));
                    if s > 0 {
                        let lowered = if sign > 0 { c.clone() } else { self.0.neg(c) };
                        self.put(list, s - 1, &lowered);
                    }
                }
            };
            add(power - 1, !sine, power, 1);
            if sine {
                add(power + 1, false, power + 1, -1);
            }
        }
        self.trimmed(image)
    }

    /// sum_{k>=1} g_k f_{n-k}, g_k = sum_m c_mk l^m/m!, with `numbers[k][m - 1]` = c_mk.
    pub fn paced(
        &self,
        numbers: &[Vec<C::Element>],
        f: &[Leaf<C::Element>],
        n: usize,
    ) -> Leaf<C::Element> {
        let range = || (1..=n.min(numbers.len() - 1)).filter(|k| n - k < f.len());
        let degree = numbers.iter().map(Vec::len).max().unwrap_or(0);
        let mut lengths: BTreeMap<Factor, usize> = BTreeMap::new();
        for (factor, list) in range().flat_map(|k| &f[n - k]) {
            let length = lengths.entry(*factor).or_default();
            *length = list.len().max(*length);
        }
        let mut sum = Leaf::new();
        for (factor, length) in lengths {
            let lists: Vec<_> = range().filter_map(|k| Some((k, f[n - k].get(&factor)?))).collect();
            let image = sum.entry(factor).or_default();
            for m in 1..=degree {
                let known: Vec<_> = lists
                    .iter()
                    .filter_map(|&(k, list)| Some((numbers[k].get(m - 1)?, list)))
                    .filter(|(c, _)| !self.0.is_zero(c))
                    .collect();
                for s in 0..length {
                    let pairs: Vec<_> =
                        known.iter().filter_map(|&(c, list)| Some((c, list.get(s)?))).collect();
                    let value = self.0.sum_of_products(&pairs);
                    if !self.0.is_zero(&value) {
                        let ways = Integer::from(Integer::binomial_u((m + s) as u32, m as u32));
                        self.put(image, m + s, &self.0.scale(&value, &Rational::from(ways)));
                    }
                }
            }
        }
        self.trimmed(sum)
    }

    /// sum_i a_i f_i.
    pub fn combination(&self, terms: &[(&C::Element, &Leaf<C::Element>)]) -> Leaf<C::Element> {
        let mut lengths: BTreeMap<Factor, usize> = BTreeMap::new();
        for (factor, list) in terms.iter().flat_map(|(_, f)| *f) {
            let length = lengths.entry(*factor).or_default();
            *length = list.len().max(*length);
        }
        let of_factor = |(factor, length): (Factor, usize)| {
            let lists: Vec<_> =
                terms.iter().filter_map(|(a, f)| Some((*a, f.get(&factor)?))).collect();
            let at = |s: usize| {
                let pairs: Vec<_> =
                    lists.iter().filter_map(|&(a, list)| Some((a, list.get(s)?))).collect();
                self.0.sum_of_products(&pairs)
            };
            (factor, (0..length).map(at).collect())
        };
        self.trimmed(lengths.into_iter().map(of_factor).collect())
    }
}
