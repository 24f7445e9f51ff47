//! The nearest singularity and its nature, from the coefficients.
//!
//! First-order inhomogeneous differential approximants (A. J. Guttmann, Phase Transitions and
//! Critical Phenomena 13 (1989)): polynomials with
//!
//!   P_1 f' + P_0 f + R = O(x^(deg P_1 + deg P_0 + deg R + 2)),  P_1(0) = 1.
//!
//! f then behaves like A (1 - x/x_c)^alpha + B at a zero x_c of P_1, alpha = -P_0/P_1' there, A
//! and B regular: poles, branch points with any exponent, logarithms (alpha = 0), in pairs or
//! not. Zeros that other degrees do not reproduce are spurious.

use super::complex::{derivative, evaluate, zeros};
use super::estimate::distance;
use super::linear::Echelon;
use super::maps::multiply;
use super::{Complex, Growth, growth};
use lindstedt_algebra::Stop;
use rug::Float;

/// What kind of singularity an exponent means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// (1 - x/x_c)^-1, ^-2, ...
    Pole,
    /// ^(1/2).
    SquareRoot,
    /// ^(-1/2).
    InverseSquareRoot,
    /// ln(1 - x/x_c) times a non-negative integer power.
    Logarithm,
    /// Any other power.
    Power,
}

/// A singularity of the function, with the one conjugate to it where it is not real.
#[derive(Clone, Debug)]
pub struct Singularity {
    /// Where, with non-negative imaginary part.
    pub at: Complex,
    /// The disagreement of the approximants.
    pub error: Float,
    /// alpha in (1 - x/x_c)^alpha.
    pub exponent: Float,
    /// The disagreement of the approximants in alpha.
    pub exponent_error: Float,
    /// The kind that alpha means within its error and 10^-3.
    pub kind: Kind,
}

/// Zeros of different approximants within this relative distance are one singularity.
const SAME: f64 = 0.02;
/// Of those that agree with the growth, one known no better than to this part of its modulus gives
/// way to one farther away that is known so many times better.
const POOR: f64 = 1e-3;
const SHARPER: u32 = 10;
/// The number of approximants that must agree.
const CONFIRMATIONS: usize = 4;

/// The zeros of P_1 with their exponents, in ascending modulus, in the upper half plane.
fn approximant(
    c: &[Float],
    degrees: [usize; 3],
    bits: u32,
    stop: &Stop,
) -> Option<Vec<(Complex, Complex)>> {
    let [top, middle, rest] = degrees;
    let rows = top + middle + rest + 2;
    let slope = derivative(c);
    let at = |list: &[Float], i: usize, j: usize| -> Float {
        let entry = i.checked_sub(j).and_then(|k| list.get(k));
        entry.map_or_else(|| Float::new(bits), |x| Float::with_val(bits, x))
    };
    let width = rows + 1;
    let matrix: Vec<Vec<Float>> = (0..rows)
        .map(|i| {
            let mut row: Vec<Float> = (0..=top).map(|j| at(&slope, i, j)).collect();
            row.extend((0..=middle).map(|j| at(c, i, j)));
            row.extend((0..=rest).map(|j| Float::with_val(bits, u32::from(i == j))));
            row
        })
        .collect();
    let echelon = Echelon::new(matrix, bits, stop);
    // A larger kernel belongs to a function that satisfies such an equation exactly.
    let vector = if echelon.rank < width { echelon.kernel()? } else { return None };
    let (p1, others) = vector.split_at_checked(top + 1)?;
    let p0 = others.get(..=middle)?;
    let slope = derivative(p1);
    let found = zeros(p1, bits, stop)?;
    let exponent = |z: &Complex| evaluate(p0, z).div(&evaluate(&slope, z));
    let upper = found.into_iter().filter(|z| !z.im.is_sign_negative() || z.im.is_zero() || tiny(z));
    let list = upper.map(|z| {
        let quotient = exponent(&z);
        (z, Complex { re: -quotient.re, im: -quotient.im })
    });
    Some(list.filter(|(_, alpha)| alpha.is_finite()).collect())
}

/// Whether a zero is real but for rounding.
fn tiny(z: &Complex) -> bool {
    z.im.clone().abs() < z.abs() >> (z.re.prec() / 4)
}

/// As [`nearest_singularity`], without the comparison; nothing once `stop` said so.
fn of_all(c: &[Float], radius: Option<f64>, bits: u32, stop: &Stop) -> Option<Singularity> {
    // With the error of the radius.
    let circle = match (radius, growth(c)) {
        (Some(radius), _) => Some((radius, radius * SAME)),
        (None, Growth::Radius { radius, error }) => Some((radius, error)),
        (None, Growth::Undecided) => None,
        (None, _) => return None,
    };
    if c.len() < 12 || radius == Some(0.0) {
        return None;
    }
    // In y = x/2^k the coefficients neither grow nor fall.
    let shift = super::pade::scale_exponent(c);
    let scaled: Vec<Float> =
        c.iter().zip(0i32..).map(|(x, n)| x.clone() << shift.saturating_mul(n)).collect();
    // One coefficient is lost to the derivative: top + middle + rest + 2 <= N.
    let order = scaled.len() - 1;
    let mut lists = Vec::new();
    for (drop, tilt) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0), (2, 1), (3, 0)] {
        let free = order.saturating_sub(2 + drop);
        let third = free / 3;
        let (middle, rest) = match tilt {
            0 => (third, third),
            1 => (third.saturating_sub(1), third),
            _ => (third, third.saturating_sub(1)),
        };
        let top = free - middle - rest;
        if let Some(list) = approximant(&scaled, [top, middle, rest], bits, stop) {
            lists.push(list);
        }
    }
    let (first, others) = lists.split_first()?;
    let mut nearest: Option<Singularity> = None;
    for (z, alpha) in first {
        let modulus = z.abs();
        let near = others.iter().filter_map(|list| {
            let closest =
                list.iter().min_by(|a, b| a.0.sub(z).abs().total_cmp(&b.0.sub(z).abs()))?;
            let gap = closest.0.sub(z).abs();
            let same = gap < Float::with_val(53, &modulus * SAME);
            let alike = closest.1.sub(alpha).abs() < 0.05 + alpha.abs().to_f64() * 0.05;
            (same && alike).then(|| (gap, closest.1.sub(alpha).abs()))
        });
        let agreeing: Vec<(Float, Float)> = near.collect();
        if agreeing.len() < CONFIRMATIONS.min(others.len()) || agreeing.is_empty() {
            continue;
        }
        // One outlier among many is a near-singular system, not a disagreement.
        let worst = |pick: fn(&(Float, Float)) -> &Float| -> Option<Float> {
            let mut gaps: Vec<&Float> = agreeing.iter().map(pick).collect();
            gaps.sort_by(|a, b| a.total_cmp(b));
            gaps.get(gaps.len() * 3 / 4).or(gaps.last()).map(|g| Float::with_val(53, *g))
        };
        let (error, exponent_error) = (worst(|p| &p.0)?, worst(|p| &p.1)?);
        let exponent = alpha.re.clone();
        // A zero with alpha = 1, 2, ... is where the equation, not the function, is singular.
        let whole = exponent.to_f64().round();
        if whole >= 1.0 && distance(&exponent, &Float::with_val(53, whole)) < 0.05 {
            continue;
        }
        let kind = kind(&exponent, &exponent_error)?;
        let refined =
            if kind == Kind::SquareRoot { square_root(&scaled, z, bits, stop) } else { None };
        let (at, error) = refined
            .filter(|(at, _)| at.sub(z).abs() < Float::with_val(53, &modulus * SAME))
            .unwrap_or((z.clone(), error));
        if stop.asked() {
            return None;
        }
        let (at, error) = (at.shift(shift), error << shift);
        let off = |radius: f64| (at.abs().to_f64() - radius).abs() - 2.0 * error.to_f64();
        if circle.is_some_and(|(radius, margin)| off(radius) > margin) {
            continue;
        }
        // Coefficients tell less of a farther singularity: a near one that is known badly, and
        // worse by far than one behind it, is where the approximants imitate a cut.
        let better = |old: &Singularity| {
            let near = Float::with_val(53, old.at.abs() * POOR);
            old.error > near && Float::with_val(53, &error * SHARPER) < old.error
        };
        if nearest.as_ref().is_none_or(better) {
            nearest = Some(Singularity { at, error, exponent, exponent_error, kind });
        }
    }
    nearest
}

/// Parts of the coefficients that a singularity of all of them is compared with.
const PARTS: [(usize, usize); 3] = [(1, 3), (1, 2), (3, 4)];
/// Two places nearer to each other than this part of the modulus are the same singularity.
const DISPUTED: f64 = 0.25;

/// The nearest singularity that several approximants from the last coefficients agree upon.
///
/// Its modulus is the radius of convergence: a zero that contradicts `radius`, where that is known,
/// or else the growth of the coefficients ([`growth`], within the error of both) is spurious.
/// Nothing for fewer than 12 coefficients, where no zero is stable, and for coefficients that grow
/// or fall factorially. The error is the largest disagreement, also with what a third, half and three
/// quarters of the coefficients say; estimated, not proved. Nothing once `stop` said so. Cost: twelve eliminations of N^3/3 products.
///
/// Where fewer coefficients state, with their error, another place, one of the two errors is wrong: the
/// difference is the error. (Of x'' + x + eps (8/3 x^4 + 4/3 x^2 + x^5) = 0 orders 40 to 64 agree on
/// 0.1323 +- 1e-5, orders 24 and 30 on the saddle, at 0.137632.)
#[must_use]
pub fn nearest_singularity(
    c: &[Float],
    radius: Option<f64>,
    bits: u32,
    stop: &Stop,
) -> Option<Singularity> {
    let mut found = of_all(c, radius, bits, stop)?;
    for (part, whole) in PARTS {
        let Some(fewer) = c.get(..c.len() * part / whole) else { continue };
        let Some(other) = of_all(fewer, radius, bits, stop) else { continue };
        let mut gap = Float::with_val(53, &other.at.re - &found.at.re);
        gap.hypot_mut(&(other.at.im.clone().abs() - found.at.im.clone().abs()));
        // Far away it is another one.
        let is_same = gap < found.at.abs() * DISPUTED;
        if is_same && gap > Float::with_val(53, &found.error + &other.error) {
            found.error = found.error.max(&gap);
        }
    }
    Some(found)
}

/// A square root branch point near `start`, from quadratic approximants p f^2 + q f + r =
/// O(x^(deg p + deg q + deg r + 2)): a zero of the discriminant q^2 - 4 p r. They have such branch
/// points themselves and converge faster than the differential ones (R. E. Shafer, SIAM J.
/// Numer. Anal. 11 (1974) 447). Returned: that of the highest order, and the largest distance of
/// the others from it.
fn square_root(c: &[Float], start: &Complex, bits: u32, stop: &Stop) -> Option<(Complex, Float)> {
    let square = multiply(c, c, bits);
    let order = c.len().checked_sub(1)?;
    let mut list: Vec<Complex> = Vec::new();
    for drop in 0..5 {
        let free = order.checked_sub(2 + drop)?;
        let first = free / 3;
        let second = (free - first) / 2;
        let (p, q, r) = (first, second, free - first - second);
        let rows = free + 2;
        let at = |list: &[Float], i: usize, j: usize| -> Float {
            let entry = i.checked_sub(j).and_then(|k| list.get(k)).cloned();
            entry.unwrap_or_else(|| Float::new(bits))
        };
        let row = |i: usize| -> Vec<Float> {
            let mut row: Vec<Float> = (0..=p).map(|j| at(&square, i, j)).collect();
            row.extend((0..=q).map(|j| at(c, i, j)));
            row.extend((0..=r).map(|j| Float::with_val(bits, u32::from(i == j))));
            row
        };
        let echelon = Echelon::new((0..rows).map(row).collect(), bits, stop);
        let Some(vector) = echelon.kernel() else { continue };
        let (left, rest) = vector.split_at_checked(p + 1)?;
        let (middle, right) = rest.split_at_checked(q + 1)?;
        let pad = |list: &[Float]| -> Vec<Float> {
            let mut list = list.to_vec();
            list.resize(2 * rows, Float::new(bits));
            list
        };
        let product = multiply(&pad(left), &pad(right), bits);
        let squared = multiply(&pad(middle), &pad(middle), bits);
        let discriminant: Vec<Float> = squared
            .iter()
            .zip(&product)
            .map(|(s, p)| Float::with_val(bits, s - (p.clone() << 2u32)))
            .collect();
        let slope = derivative(&discriminant);
        let mut z = start.clone();
        for _ in 0..bits.ilog2() + 8 {
            let step = evaluate(&discriminant, &z).div(&evaluate(&slope, &z));
            if !step.is_finite() {
                break;
            }
            z = z.sub(&step);
        }
        list.push(z);
    }
    let (best, others) = list.split_first()?;
    let error = others.iter().map(|z| z.sub(best).abs()).reduce(|a, b| a.max(&b))?;
    Some((best.clone(), Float::with_val(53, error)))
}

/// The kind of an exponent.
fn kind(exponent: &Float, error: &Float) -> Option<Kind> {
    let tolerance = error.to_f64().max(1e-3);
    let is = |value: f64| distance(exponent, &Float::with_val(53, value)) <= tolerance;
    let whole = exponent.to_f64().round();
    Some(if is(0.5) {
        Kind::SquareRoot
    } else if is(-0.5) {
        Kind::InverseSquareRoot
    } else if is(whole) && whole < 0.0 {
        Kind::Pole
    } else if is(whole) {
        Kind::Logarithm
    } else {
        Kind::Power
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BITS: u32 = 400;

    fn power(p: f64, at: f64, order: usize) -> Vec<Float> {
        let mut list = vec![Float::with_val(BITS, 1)];
        for k in 0..order {
            let factor = Float::with_val(BITS, k as f64 - p) / (k as f64 + 1.0) / at;
            list.push(Float::with_val(BITS, &list[k] * factor));
        }
        list
    }

    /// A (1 - x/x_c)^p + B with A = e^x and B = 1/(1 + x/5): place, exponent, kind.
    #[test]
    fn branch_points_with_background() {
        let order = 45;
        let exponential: Vec<Float> = (0..=order)
            .map(|n| Float::with_val(BITS, Float::factorial(n as u32)).recip())
            .collect();
        for (p, kind) in [
            (0.5, Kind::SquareRoot),
            (-0.5, Kind::InverseSquareRoot),
            (-1.0, Kind::Pole),
            (1.0 / 3.0, Kind::Power),
        ] {
            let singular = power(p, -2.0, order);
            let mut c = multiply(&singular, &exponential, BITS);
            for (x, y) in c.iter_mut().zip(power(-1.0, -5.0, order)) {
                *x += y;
            }
            let found = nearest_singularity(&c, None, BITS, &Stop::default()).unwrap();
            let true_error = (found.at.re.clone() + 2u32).abs();
            assert!(true_error < 1e-8, "{p}: {true_error}");
            assert!(true_error <= found.error.clone(), "{p}: {true_error} {}", found.error);
            assert!((found.exponent.to_f64() - p).abs() < 1e-6, "{p}: {}", found.exponent);
            assert_eq!(found.kind, kind);
        }
    }

    /// ln(1 + x/3) e^x is a logarithm.
    #[test]
    fn logarithm() {
        let order = 45;
        let term = |n: u32| {
            if n == 0 {
                Float::new(BITS)
            } else {
                Float::with_val(BITS, -1) / n / Float::with_val(BITS, -3.0f64).pow_u(n)
            }
        };
        let exponential = |n: u32| Float::with_val(BITS, Float::factorial(n)).recip();
        let log: Vec<Float> = (0..=order).map(term).collect();
        let smooth: Vec<Float> = (0..=order).map(exponential).collect();
        let found =
            nearest_singularity(&multiply(&log, &smooth, BITS), None, BITS, &Stop::default());
        let found = found.unwrap();
        assert!((found.at.re.to_f64() + 3.0).abs() < 1e-8);
        assert_eq!(found.kind, Kind::Logarithm);
    }

    trait PowU {
        fn pow_u(self, n: u32) -> Float;
    }
    impl PowU for Float {
        fn pow_u(self, n: u32) -> Float {
            rug::ops::Pow::pow(self, n)
        }
    }
}
