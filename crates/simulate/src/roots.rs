//! All roots of a polynomial in (0, length], in order.
//!
//! A sum bound excludes roots at cost O(p); otherwise the Bernstein coefficients on the interval
//! decide by Descartes' rule (no sign change: no root, one: exactly one), with bisection by de
//! Casteljau's algorithm while there are more (Collins and Akritas; Mourrain, Rouillier and Roy,
//! 2004). A simple root is then refined by Newton's method, kept inside its interval, to the
//! last digits. Sign changes that remain in an interval of relative width 2^(-bits/2 + 4) cannot
//! be told from a double root: a cluster.

use crate::integrator::real::Real;
use crate::tape::horner;

/// A simple root.
#[derive(Clone, Debug)]
pub(crate) struct Root<E> {
    pub(crate) at: E,
    /// The sign after the root.
    pub(crate) after: i8,
}

/// A double root, or two that cannot be told apart: its place.
#[derive(Clone, Debug)]
pub(crate) struct Cluster<E> {
    pub(crate) at: E,
    /// The signs before and after it: the same where the zero is touched, or passed twice.
    signs: (i8, i8),
}

/// What a search does at a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AtCluster {
    /// It ends there.
    Stop,
    /// It goes on: a cluster with different signs before and after it is a root, others are none.
    Pass,
}

/// Places to compute in, kept from one search to the next.
#[derive(Clone, Debug)]
pub(crate) struct RootFinder<E> {
    scaled: Vec<E>,
    derivative: Vec<E>,
    /// Bernstein coefficients of the intervals still to be looked at, the leftmost on top.
    stack: Vec<Piece<E>>,
    pool: Vec<Vec<E>>,
    /// C(n, 0), C(n, 1), ... of every n that was needed.
    binomials: Vec<Vec<E>>,
    pub(crate) found: Vec<Root<E>>,
}

#[derive(Clone, Debug)]
struct Piece<E> {
    left: E,
    width: E,
    depth: u32,
    bernstein: Vec<E>,
}

impl<E: Clone + PartialOrd> RootFinder<E> {
    pub(crate) fn new() -> Self {
        Self {
            scaled: Vec::new(),
            derivative: Vec::new(),
            stack: Vec::new(),
            pool: Vec::new(),
            binomials: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Finds the roots of sum_k c_k s^k in (0, length], at most `most` of them, into `found`;
    /// c_0 is not zero. At a cluster it stops, with the roots before it found, or passes.
    pub(crate) fn search<R: Real<Element = E>>(
        &mut self,
        real: &R,
        coefficients: &[E],
        length: &E,
        (most, at_cluster): (usize, AtCluster),
    ) -> Result<(), Cluster<E>> {
        self.found.clear();
        if self.excluded(real, coefficients, length) {
            return Ok(());
        }
        for piece in self.stack.drain(..) {
            self.pool.push(piece.bernstein);
        }
        let bernstein = self.bernstein(real);
        let (left, width) = (real.zero(), real.double(1.0));
        self.stack.push(Piece { left, width, depth: 0, bernstein });
        while let Some(piece) = self.stack.pop() {
            let outcome = self.piece(real, piece, length);
            match outcome {
                Ok(()) if self.found.len() >= most => return Ok(()),
                Ok(()) => {}
                Err(cluster) if at_cluster == AtCluster::Stop => return Err(cluster),
                Err(Cluster { at, signs: (before, after) }) => {
                    if before * after < 0 {
                        self.found.push(Root { at, after });
                    }
                }
            }
        }
        if at_cluster == AtCluster::Pass {
            self.drop_pairs(real, length, -f64::from(real.bits() / 2));
        }
        Ok(())
    }

    /// Leaves out two roots so near to each other that errors may have made them of a double one: with log2 `half` of
    /// the root of the relative error.
    pub(crate) fn drop_pairs<R: Real<Element = E>>(&mut self, real: &R, length: &E, half: f64) {
        let resolved = real.log2(length) + 4.0 + half;
        let mut kept: Vec<Root<E>> = Vec::with_capacity(self.found.len());
        for root in self.found.drain(..) {
            match kept.last() {
                Some(last)
                    if last.after != root.after
                        && real.log2(&real.difference(&root.at, &last.at)) <= resolved =>
                {
                    kept.pop();
                }
                _ => kept.push(root),
            }
        }
        self.found = kept;
    }

    /// c_k length^k into `scaled`; whether c_0 + c_1 u, 0 <= u <= 1, outweighs all other terms.
    fn excluded<R: Real<Element = E>>(&mut self, real: &R, c: &[E], length: &E) -> bool {
        self.scaled.resize_with(c.len(), || real.zero());
        let mut power = real.double(1.0);
        let mut rest = real.zero();
        for (k, (scaled, c)) in self.scaled.iter_mut().zip(c).enumerate() {
            real.multiply(scaled, c, &power);
            real.scale(&mut power, length);
            if k > 1 {
                if real.sign(scaled) < 0 {
                    real.times_integer(scaled, -1);
                    real.increase(&mut rest, scaled);
                    real.times_integer(scaled, -1);
                } else {
                    real.increase(&mut rest, scaled);
                }
            }
        }
        let Some(first) = self.scaled.first() else { return true };
        let last = self.scaled.get(1).map_or_else(|| first.clone(), |c| real.sum(first, c));
        real.sign(first) * real.sign(&last) > 0
            && rest < real.absolute(first)
            && rest < real.absolute(&last)
    }

    /// b_i = sum_{k<=i} C(i,k)/C(n,k) c_k, by n(n+1)/2 additions.
    fn bernstein<R: Real<Element = E>>(&mut self, real: &R) -> Vec<E> {
        let n = self.scaled.len() - 1;
        if self.binomials.len() <= n {
            self.binomials.resize_with(n + 1, Vec::new);
        }
        if self.binomials[n].is_empty() {
            let mut binomial = rug::Integer::from(1);
            for k in 0..=n {
                self.binomials[n].push(real.rational(&rug::Rational::from(&binomial)));
                binomial = binomial * (n - k) as u64 / (k + 1) as u64;
            }
        }
        let mut b = self.pool.pop().unwrap_or_default();
        b.resize_with(n + 1, || real.zero());
        for ((b, c), binomial) in b.iter_mut().zip(&self.scaled).zip(&self.binomials[n]) {
            real.divide(b, c, binomial);
        }
        for j in 1..=n {
            for i in (j..=n).rev() {
                let (before, from) = b.split_at_mut(i);
                real.increase(&mut from[0], &before[i - 1]);
            }
        }
        b
    }

    fn piece<R: Real<Element = E>>(
        &mut self,
        real: &R,
        piece: Piece<E>,
        length: &E,
    ) -> Result<(), Cluster<E>> {
        let Piece { left, width, depth, mut bernstein } = piece;
        let n = bernstein.len() - 1;
        let mut last = 0;
        let mut changes = 0;
        for b in &bernstein {
            let sign = real.sign(b);
            if sign != 0 {
                changes += u32::from(last != 0 && sign != last);
                last = sign;
            }
        }
        let (first, end) = (real.sign(&bernstein[0]), real.sign(&bernstein[n]));
        // The value at a point of division is exactly zero: the root is there.
        if first == 0 && depth > 0 {
            let after = bernstein.iter().map(|b| real.sign(b)).find(|s| *s != 0).unwrap_or(0);
            self.found.push(Root { at: real.product(&left, length), after });
        }
        if changes == 1 && first != 0 && end != 0 {
            let root = self.refine(real, &left, &width, first);
            self.found.push(Root { at: real.product(&root, length), after: -first });
        } else if changes > 0 {
            if depth + 4 > real.bits() / 2 {
                self.pool.push(bernstein);
                return Err(Cluster { at: real.product(&left, length), signs: (first, end) });
            }
            let half = real.product(&width, &real.double(0.5));
            let mut right = self.pool.pop().unwrap_or_default();
            right.resize_with(n + 1, || real.zero());
            // De Casteljau in place: `bernstein` becomes the left half.
            for j in 0..=n {
                real.set(&mut right[n - j], &bernstein[n]);
                for i in ((j + 1)..=n).rev() {
                    let (before, from) = bernstein.split_at_mut(i);
                    real.increase(&mut from[0], &before[i - 1]);
                    real.scale(&mut from[0], &real.double(0.5));
                }
            }
            let middle = real.sum(&left, &half);
            let depth = depth + 1;
            self.stack.push(Piece { left: middle, width: half.clone(), depth, bernstein: right });
            self.stack.push(Piece { left, width: half, depth, bernstein });
            return Ok(());
        } else if end == 0 && first != 0 {
            // A root at the right end counts only if it is the end of the whole interval.
            let right = real.sum(&left, &width);
            if right == real.double(1.0) {
                self.found.push(Root { at: length.clone(), after: -first });
            }
        }
        self.pool.push(std::mem::take(&mut bernstein));
        Ok(())
    }

    /// The simple root in (left, left + width) of the scaled polynomial, whose sign at the left
    /// end is `first`.
    fn refine<R: Real<Element = E>>(&mut self, real: &R, left: &E, width: &E, first: i8) -> E {
        self.derivative.clear();
        for (k, c) in (0..).zip(&self.scaled).skip(1) {
            let mut d = c.clone();
            real.times_integer(&mut d, k);
            self.derivative.push(d);
        }
        let (mut low, mut high) = (left.clone(), real.sum(left, width));
        let half = real.double(0.5);
        let mut u = real.sum(left, &real.product(width, &half));
        let (mut value, mut slope) = (real.zero(), real.zero());
        let mut smallest = f64::INFINITY;
        for round in 0..4 * real.bits() {
            horner(real, &mut value, &self.scaled, &u);
            horner(real, &mut slope, &self.derivative, &u);
            match real.sign(&value) {
                0 => break,
                sign if sign == first => real.set(&mut low, &u),
                _ => real.set(&mut high, &u),
            }
            let step = real.quotient(&value, &slope);
            let next = real.difference(&u, &step);
            let size = real.log2(&step);
            if next > low && next < high {
                u = next;
                // Newton's steps no longer shrink: only rounding errors are left.
                let limit = real.log2(&u) - f64::from(real.bits());
                if size <= limit || (size >= smallest && size <= limit + 12.0) {
                    break;
                }
                smallest = size;
            } else {
                let middle = real.product(&real.sum(&low, &high), &half);
                // The ends are neighbours, or the sign is lost in rounding errors.
                if middle == low || middle == high || round > 3 * real.bits() {
                    break;
                }
                u = middle;
            }
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digits::Digits;
    use crate::integrator::real::{Doubles, Places};

    fn polynomial(roots: &[f64]) -> Vec<f64> {
        let mut c = vec![1.0];
        for root in roots {
            c.push(0.0);
            for k in (0..c.len()).rev() {
                c[k] = if k > 0 { c[k - 1] } else { 0.0 } - root * c[k];
            }
        }
        c
    }

    fn roots(c: &[f64], length: f64, most: usize) -> Result<Vec<f64>, f64> {
        let mut finder = RootFinder::new();
        let outcome = finder.search(&Doubles, c, &length, (most, AtCluster::Stop));
        outcome.map_err(|cluster| cluster.at)?;
        Ok(finder.found.iter().map(|root| root.at).collect())
    }

    #[test]
    fn all_roots_in_order() {
        let c = polynomial(&[0.3, 0.31, 1.5, 1.75, -0.2, 3.0]);
        let found = roots(&c, 2.0, 9).unwrap();
        assert_eq!(found.len(), 4);
        for (x, y) in found.iter().zip([0.3, 0.31, 1.5, 1.75]) {
            assert!((x - y).abs() < 1e-13, "{x} {y}");
        }
        assert_eq!(roots(&c, 2.0, 1).unwrap().len(), 1);
        assert!(roots(&c, 0.29, 9).unwrap().is_empty());
        // The end belongs to the interval, and so do points of division.
        assert_eq!(roots(&polynomial(&[1.0]), 1.0, 9).unwrap(), [1.0]);
        let found = roots(&polynomial(&[0.5, 0.25]), 1.0, 9).unwrap();
        assert_eq!(found.len(), 2);
        assert!((found[0] - 0.25).abs() + (found[1] - 0.5).abs() < 1e-15);
    }

    /// Out and back inside the interval with both ends on one side.
    #[test]
    fn a_pair_of_close_roots_is_seen() {
        let found = roots(&polynomial(&[0.6, 0.6001, 5.0]), 1.0, 9).unwrap();
        assert_eq!(found.len(), 2);
        assert!((found[0] - 0.6).abs() < 1e-10 && (found[1] - 0.6001).abs() < 1e-10);
    }

    #[test]
    fn a_double_root_is_a_cluster() {
        let place = roots(&polynomial(&[0.6, 0.6, 5.0]), 1.0, 9).unwrap_err();
        assert!((place - 0.6).abs() < 1e-6);
        // A miss by 1e-4 is no contact.
        let mut c = polynomial(&[0.6, 0.6]);
        c[0] += 1e-8;
        assert!(roots(&c, 1.0, 9).unwrap().is_empty());
    }

    #[test]
    fn a_search_passes_clusters_if_told_to() {
        let mut finder = RootFinder::new();
        let mut places = |roots: &[f64]| {
            let c = polynomial(roots);
            finder.search(&Doubles, &c, &1.0, (9, AtCluster::Pass)).unwrap();
            finder.found.iter().map(|root| (root.at, root.after)).collect::<Vec<_>>()
        };
        let found = places(&[0.3, 0.6, 0.6, 0.8]);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0].0 - 0.3).abs() < 1e-12 && (found[1].0 - 0.8).abs() < 1e-12);
        // Through a triple root the sign changes.
        let found = places(&[0.6, 0.6, 0.6]);
        assert_eq!(found.len(), 1, "{found:?}");
        // These are two.
        assert_eq!(places(&[0.6, 0.6 + 1e-6]).len(), 2);
        assert!((found[0].0 - 0.6).abs() < 1e-4 && found[0].1 > 0);
    }

    #[test]
    fn last_digits_at_high_precision() {
        let real = Digits::for_digits(60);
        let mut finder = RootFinder::new();
        // s^3 - 2 s - 1/4 on (0, 2].
        let c: Vec<_> = [-0.25, -2.0, 0.0, 1.0].map(|x| real.double(x)).to_vec();
        finder.search(&real, &c, &real.double(2.0), (9, AtCluster::Stop)).unwrap();
        let s = finder.found[0].at.clone();
        let mut value = real.zero();
        horner(&real, &mut value, &c, &s);
        assert_eq!(finder.found.len(), 1);
        assert!(value.to_f64().abs() < 1e-70);
    }
}
