//! Floquet multipliers of the delayed impact system: the inverses of the zeros of G.

use crate::characteristic::Characteristic;
use crate::error::ImpactError;
use crate::map::Verdict;
use crate::winding::zero_count;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// Floquet multipliers down to some modulus.
#[derive(Clone, Debug)]
pub struct Multipliers<S> {
    /// gamma, by falling modulus, of a conjugate pair the positive imaginary part first.
    pub values: Vec<Complex<S>>,
    /// The modulus down to which the list is complete, by the winding number.
    pub complete_to: f64,
}

/// The exact verdict: stable if G has no zero in |w| <= 1, unstable if the winding number along
/// |w| = 1 is positive, neutral where a zero on or near the circle leaves it undecided.
///
/// Returns the number of zeros (multipliers with |gamma| > 1) too. Certified for balls.
pub fn exact_verdict<S: Real>(g: &Characteristic<S>) -> (Verdict, Option<u32>) {
    match zero_count(g, 1.0) {
        Some(count) if count.zeros == 0 => (Verdict::Stable, Some(0)),
        Some(count) => (Verdict::Unstable, Some(count.zeros)),
        None => (Verdict::Neutral, None),
    }
}

/// All multipliers with |gamma| > `least_modulus`.
///
/// Found by Newton's method with deflation in doubles until their number equals the winding number,
/// then refined. Certified for balls: around each a disc proved by Rouche's theorem to hold exactly
/// one zero of G, the discs disjoint, their number equal to the proved count. A real zero is proved
/// real by the symmetry of G.
///
/// # Errors
/// [`ImpactError::NotPositive`] unless `least_modulus` > 0,
/// [`ImpactError::NoConvergence`] if the search ends before the count is reached,
/// [`ImpactError::Undecided`] if the count or a disc cannot be proved at this precision (multiple
/// or clustered zeros).
pub fn multipliers<S: Real>(
    g: &Characteristic<S>,
    least_modulus: f64,
) -> Result<Multipliers<S>, ImpactError> {
    if least_modulus.is_nan() || least_modulus <= 0.0 {
        return Err(ImpactError::NotPositive { name: "least modulus", value: least_modulus });
    }
    let bits = g.period().precision();
    let undecided = |what| ImpactError::Undecided { what, bits };
    // A zero on the very circle would leave the count open: step outwards past it.
    let (radius, count) = (0..6)
        .map(|step| (1.0 + 1e-3 * f64::from(step * step)) / least_modulus)
        .find_map(|radius| zero_count(g, radius).map(|count| (radius, count.zeros)))
        .ok_or_else(|| undecided("the number of multipliers"))?;
    let found = find_zeros(&g.to_f64(), radius, count as usize)
        .ok_or(ImpactError::NoConvergence { what: "the search for multipliers" })?;
    let mut discs = Vec::with_capacity(found.len());
    for zero in &found {
        if !g.goes_on() {
            return Err(ImpactError::Cancelled);
        }
        discs.push(refine(g, zero).ok_or_else(|| undecided("a multiplier"))?);
    }
    for (n, (one, reach)) in discs.iter().enumerate() {
        let apart = |other: &(Complex<S>, f64)| {
            (one.clone() - &other.0).to_f64().modulus() > 2.0 * (reach + other.1)
        };
        if !discs[..n].iter().all(apart) {
            return Err(undecided("distinct multipliers"));
        }
    }
    let mut values: Vec<_> = discs.iter().map(|(zero, _)| zero.inverse()).collect();
    values.sort_by(|a, b| {
        let (x, y) = (a.to_f64(), b.to_f64());
        let (p, q) = (x.norm_squared(), y.norm_squared());
        let pair = (p - q).abs() <= 1e-12 * p && x.im == -y.im;
        if pair { y.im.total_cmp(&x.im) } else { q.total_cmp(&p) }
    });
    Ok(Multipliers { values, complete_to: 1.0 / radius })
}

/// The zeros of G in |w| < radius in doubles, `expected` of them.
pub(crate) fn find_zeros(
    g: &Characteristic<f64>,
    radius: f64,
    expected: usize,
) -> Option<Vec<Complex<f64>>> {
    let mut zeros: Vec<Complex<f64>> = Vec::new();
    let inside = |zeros: &[Complex<f64>]| zeros.iter().filter(|w| w.modulus() < radius).count();
    let origin = Complex::real(0.0);
    let (value, slope) = g.value_and_slope(&origin);
    search(g, &-value.over(&slope), radius, &mut zeros);
    for (ratio, angles) in [(1.6_f64, 6_u32), (1.25, 12), (1.1, 30)] {
        let mut size = radius.min(1.0) * 1e-3;
        while size < radius * ratio {
            for n in 0..=angles {
                if inside(&zeros) >= expected || !g.goes_on() {
                    break;
                }
                // Slightly off the symmetric angles, except on the axis itself.
                let angle = std::f64::consts::PI * f64::from(n) / f64::from(angles);
                let (sin, cos) = angle.sin_cos();
                let sin = if n == 0 || n == angles { 0.0 } else { sin };
                search(g, &Complex::new(size * cos, size * sin), radius, &mut zeros);
            }
            size *= ratio;
        }
    }
    zeros.retain(|w| w.modulus() < radius);
    (zeros.len() == expected).then_some(zeros)
}

/// Newton's method on G/prod(w - w_j): appends a new zero, with its conjugate.
fn search(
    g: &Characteristic<f64>,
    start: &Complex<f64>,
    radius: f64,
    zeros: &mut Vec<Complex<f64>>,
) {
    let mut w = start.clone();
    for _ in 0..50 {
        let (value, slope) = g.value_and_slope(&w);
        let newton = value.over(&slope);
        let pull =
            zeros.iter().fold(Complex::real(0.0), |sum, zero| sum + (w.clone() - zero).inverse());
        let mut step = newton.over(&(Complex::real(1.0) - newton.clone() * &pull));
        let size = step.modulus();
        if !size.is_finite() {
            return;
        }
        let limit = 0.7 * w.modulus() + 1e-3;
        if size > limit {
            step = step.scaled(&(limit / size));
        }
        w = w - &step;
        if w.modulus() > 2.0 * radius {
            return;
        }
        if size < 1e-11 * w.modulus() {
            return accept(g, w, zeros);
        }
    }
}

fn accept(g: &Characteristic<f64>, mut w: Complex<f64>, zeros: &mut Vec<Complex<f64>>) {
    if w.im.abs() < 1e-8 * w.modulus() {
        w.im = 0.0;
    }
    // Without deflation; a real start stays real.
    for _ in 0..4 {
        let (value, slope) = g.value_and_slope(&w);
        let mut step = value.over(&slope);
        if w.im == 0.0 {
            step.im = 0.0;
        }
        if !step.is_finite() {
            return;
        }
        w = w - &step;
    }
    let (value, slope) = g.value_and_slope(&w);
    if value.over(&slope).modulus() > 1e-9 * w.modulus() {
        return;
    }
    let known = |w: &Complex<f64>| {
        zeros.iter().any(|zero| (zero.clone() - w).modulus() < 1e-9 * w.modulus())
    };
    if known(&w) {
        return;
    }
    if w.im != 0.0 {
        zeros.push(w.conjugate());
    }
    zeros.push(w);
}

/// Newton's method at the precision of G, then the disc: |G(w) - G - G' (w - w_0)| < |G'| h/2 and
/// |G| <= |G'| h/2 on |w - w_0| = h, so G has as many zeros in it as the linear function, one.
/// Returns the enclosure and h.
fn refine<S: Real>(g: &Characteristic<S>, start: &Complex<f64>) -> Option<(Complex<S>, f64)> {
    let unit = g.period();
    let real = start.im == 0.0;
    let mut w = Complex::new(unit.number(start.re), unit.number(start.im));
    let mut last = f64::INFINITY;
    for _ in 0..40 {
        let (value, slope) = g.value_and_slope(&w);
        let mut step = value.over(&slope).centre();
        if real {
            step.im = unit.integer(0);
        }
        let size = step.magnitude_above();
        if !size.is_finite() || (size > 0.0 && size >= last && size > 1e-6 * start.modulus()) {
            return None;
        }
        if size >= last || size == 0.0 {
            break;
        }
        last = size;
        w = (w - &step).centre();
    }
    let (value, slope) = g.value_and_slope(&w);
    let radius = value.modulus().doubled() / slope.modulus();
    let h = radius.magnitude_above();
    let middle = w.to_f64();
    let reach = g.scale(&middle) / 4.0;
    let bound = g.bound(&middle, reach * (1.0 + 1e-12) + 1e-14 * middle.modulus());
    let room = slope.magnitude_below() * reach * reach / (4.0 * bound);
    if !(h < room && h < reach / 2.0) {
        return None;
    }
    let im = if real { w.im.clone() } else { w.im.widened(&radius) };
    Some((Complex::new(w.re.widened(&radius), im), h))
}

/// max |gamma| in doubles: the zero of least modulus reached from the seeds (the zeros of a
/// neighbouring point), confirmed by the winding number of the circle just inside it.
///
/// The seeds are replaced by the zeros found. `None` if G has no zero or none is confirmed.
pub(crate) fn leading_modulus(
    g: &Characteristic<f64>,
    seeds: &mut Vec<Complex<f64>>,
) -> Option<f64> {
    let mut zeros = Vec::new();
    let reach = 1e3;
    for seed in seeds.iter() {
        search(g, seed, reach, &mut zeros);
    }
    let start = Complex::real(0.0);
    let (value, slope) = g.value_and_slope(&start);
    let first = -value.over(&slope);
    search(g, &first, reach, &mut zeros);
    if zeros.len() < 3 {
        search(g, &Complex::new(first.re, 0.7 * first.modulus()), reach, &mut zeros);
    }
    let least =
        |zeros: &[Complex<f64>]| zeros.iter().map(|w| w.modulus()).fold(f64::INFINITY, f64::min);
    let mut modulus = least(&zeros);
    if !modulus.is_finite() {
        modulus = 1e3;
    }
    let inner = modulus * (1.0 - 1e-4);
    match zero_count(g, inner)?.zeros {
        0 if zeros.is_empty() => return None,
        0 => {}
        count => {
            zeros = find_zeros(g, inner, count as usize)?;
            modulus = least(&zeros);
        }
    }
    zeros.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    zeros.truncate(3);
    seeds.clone_from(&zeros);
    Some(1.0 / modulus)
}
