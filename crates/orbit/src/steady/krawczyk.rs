//! Newton's method for n polynomials in n unknowns, in doubles, and its proof on a box by Krawczyk's operator
//!
//!   K(X) = m - C G(m) + (1 - C G'(X)) (X - m),   m in X, C near the inverse of G'(m):
//!
//! every zero of G in X lies in K(X); if K(X) lies inside X, X has exactly one zero (Krawczyk 1969, Rump 1983).

use super::System;
use lindstedt_number::interval::Interval;
use nalgebra::{DMatrix, DVector};

/// A box: an interval per unknown.
pub type Region = Vec<Interval>;

/// A zero that is proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Zero {
    /// Where it lies.
    pub enclosure: Region,
    /// A box that has no other zero.
    pub unique_within: Region,
}

impl Zero {
    /// The middle of the enclosure.
    #[must_use]
    pub fn middle(&self) -> Vec<f64> {
        middle(&self.enclosure)
    }
}

/// What Krawczyk's operator says of a box.
pub(crate) enum Verdict {
    /// No zero.
    None,
    /// Exactly one zero, and here.
    One(Region),
    /// Every zero lies here.
    Within(Region),
    /// Nothing: G' has no inverse in doubles, or nothing is gained.
    Open,
}

pub(crate) fn middle(region: &[Interval]) -> Vec<f64> {
    region.iter().map(|x| x.middle()).collect()
}

/// Whether a box is a part of another.
pub(crate) fn is_in(inner: &[Interval], outer: &[Interval]) -> bool {
    inner.iter().zip(outer).all(|(a, b)| a.is_in(*b))
}

/// The common part.
pub(crate) fn meet(a: &[Interval], b: &[Interval]) -> Option<Region> {
    a.iter().zip(b).map(|(a, b)| a.meet(*b)).collect()
}

/// sum_j a_ij x_j.
fn apply(matrix: &[Interval], vector: &[Interval]) -> Region {
    let sum =
        |row: &[Interval]| row.iter().zip(vector).fold(Interval::ZERO, |sum, (a, x)| sum + *a * *x);
    matrix.chunks_exact(vector.len().max(1)).map(sum).collect()
}

/// The test of a box.
pub(crate) fn krawczyk(system: &System, region: &[Interval]) -> Verdict {
    let n = region.len();
    let (values, slopes) = system.derivatives(region);
    let excludes = |values: &[Interval]| values.iter().any(|value| !value.contains(0.0));
    if excludes(&values) {
        return Verdict::None;
    }
    let at = middle(region);
    let points: Region = at.iter().map(|x| Interval::point(*x)).collect();
    let away: Region = region.iter().zip(&points).map(|(x, m)| *x - *m).collect();
    let values = system.values(&points);
    let change = apply(&slopes, &away);
    let mean: Region = values.iter().zip(&change).map(|(a, b)| *a + *b).collect();
    if excludes(&mean) {
        return Verdict::None;
    }
    let near = DMatrix::from_row_iterator(n, n, slopes.iter().map(|slope| slope.middle()));
    let Some(inverse) = near.try_inverse().filter(|m| m.iter().all(|x| x.is_finite())) else {
        return Verdict::Open;
    };
    let row_major = inverse.transpose();
    let inverse: Region = row_major.iter().map(|x| Interval::point(*x)).collect();
    let step = apply(&inverse, &values);
    let mut image = Vec::with_capacity(n);
    for i in 0..n {
        let mut reach = points[i] - step[i];
        for j in 0..n {
            let own = if i == j { Interval::ONE } else { Interval::ZERO };
            let product =
                (0..n).fold(Interval::ZERO, |sum, k| sum + inverse[i * n + k] * slopes[k * n + j]);
            reach = reach + (own - product) * away[j];
        }
        image.push(reach);
    }
    let Some(common) = meet(&image, region) else { return Verdict::None };
    if image.iter().zip(region).all(|(a, b)| a.is_inside(*b)) {
        return Verdict::One(common);
    }
    Verdict::Within(common)
}

/// The enclosure of the only zero of a box made as small as doubles allow.
fn refine(system: &System, region: Region) -> Region {
    let mut region = sharp(system, &region).unwrap_or(region);
    for _ in 0..100 {
        let (Verdict::One(next) | Verdict::Within(next)) = krawczyk(system, &region) else {
            break;
        };
        let width = |region: &Region| region.iter().map(|x| x.width()).sum::<f64>();
        let slow = width(&next) > 0.99 * width(&region);
        region = next;
        if slow {
            break;
        }
    }
    region
}

/// The only zero of a box on the smallest box around what Newton's method finds on which it is proved: a wide box shrinks little
/// at first.
fn sharp(system: &System, region: &[Interval]) -> Option<Region> {
    let at = newton(system, &middle(region))?;
    let around = |fraction: f64| -> Region {
        let side = |(x, within): (&f64, &Interval)| {
            let half = (within.width() * fraction).max(16.0 * f64::EPSILON * x.abs());
            Interval::new(x - half, x + half)
        };
        at.iter().zip(region).map(side).collect()
    };
    let boxes = (0..24).rev().map(|k| around(0.25f64.powi(k)));
    boxes.take_while(|part| meet(part, region).is_some()).find_map(|part| {
        match krawczyk(system, &part) {
            Verdict::One(enclosure) if is_in(&enclosure, region) => Some(enclosure),
            _ => None,
        }
    })
}

/// The zero of a box where the operator maps it into itself.
pub(crate) fn prove(system: &System, region: &[Interval]) -> Option<Zero> {
    let Verdict::One(enclosure) = krawczyk(system, region) else { return None };
    Some(Zero { enclosure: refine(system, enclosure), unique_within: region.to_vec() })
}

/// Newton steps in doubles.
const MOST_STEPS: usize = 30;

/// Newton's method in doubles; nothing where it does not converge.
pub(crate) fn newton(system: &System, start: &[f64]) -> Option<Vec<f64>> {
    newton_while(system, start, |_| true)
}

/// The same, given up at the first step that a condition does not hold for.
pub(crate) fn newton_while(
    system: &System,
    start: &[f64],
    keeps: impl Fn(&[f64]) -> bool,
) -> Option<Vec<f64>> {
    let n = start.len();
    let mut at = start.to_vec();
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let (values, slopes) = system.derivatives(&at);
        let matrix = DMatrix::from_row_slice(n, n, &slopes);
        let step = matrix.lu().solve(&DVector::from_vec(values))?;
        at.iter_mut().zip(step.iter()).for_each(|(x, d)| *x -= d);
        let (change, size) = (step.amax(), at.iter().fold(0.0f64, |m, x| m.max(x.abs())));
        if !change.is_finite() || !size.is_finite() || !keeps(&at) {
            return None;
        }
        // Steps of the size of the rounding errors do not shrink any more.
        if change <= 1e-15 * size || (change <= 1e-9 * size.max(1e-9) && change >= 0.5 * before) {
            return Some(at);
        }
        before = change;
    }
    None
}

/// A zero near a guess: Newton's method, then the proof on the largest of a list of boxes around it; the half widths
/// are the fractions 1, 1/4, 1/16, ... of those given.
#[must_use]
pub fn zero_near(system: &System, guess: &[f64], half_widths: &[f64]) -> Option<Zero> {
    if guess.len() != system.variables() || system.rows() != system.variables() {
        return None;
    }
    let at = newton(system, guess)?;
    let around = |fraction: f64| -> Region {
        let side = |(x, width): (&f64, &f64)| {
            let half = (width * fraction).max(4.0 * f64::EPSILON * x.abs());
            Interval::new(x - half, x + half)
        };
        at.iter().zip(half_widths).map(side).collect()
    };
    (0..24).find_map(|k| prove(system, &around(0.25f64.powi(k))))
}
