//! Pade approximants.
//!
//! [l/m] = p/q with deg p <= l, deg q <= m, q(0) = 1 and f q - p = O(x^(l+m+1)): the kernel of
//! the Toeplitz matrix c_{i-j}, i = l+1 .. l+m, j = 0 .. m. Where it has not full rank the
//! approximant has smaller degrees, and these are used (P. Gonnet, S. Guttel, L. N. Trefethen,
//! SIAM Review 55 (2013) 101): a rational function is recovered as such.

use super::complex::{Complex, derivative, evaluate, zeros};
use super::linear::Echelon;
use lindstedt_algebra::Stop;
use rug::Float;
use rug::ops::Pow;

/// Halvings of the interval that holds a pole.
const BISECTIONS: u32 = 100;

/// p(x)/q(x), q(0) = 1.
#[derive(Clone, Debug)]
pub struct Pade {
    /// Coefficients of p and q in y = x 2^-exponent.
    numerator: Vec<Float>,
    denominator: Vec<Float>,
    exponent: i32,
    bits: u32,
}

/// A zero so near to a pole, relative to its modulus, and a residue so small make a doublet.
const NEAR: f64 = 1e-6;
const WEAK: f64 = 1e-8;

/// A pole with the zero next to it.
#[derive(Clone, Debug)]
pub struct Pole {
    /// The pole.
    pub at: Complex,
    /// The residue of p/q.
    pub residue: Complex,
    /// Whether a zero lies within 10^-6 of its modulus and the residue is below 10^-8 of the
    /// modulus times |f(0)|: a Froissart doublet, which other degrees do not reproduce. A pole of
    /// the function with so weak a residue looks the same; only other degrees tell.
    pub doublet: bool,
}

/// The poles and zeros, ascending in modulus.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The poles.
    pub poles: Vec<Pole>,
    /// The zeros.
    pub zeros: Vec<Complex>,
}

/// log_2 |x|, for numbers of any exponent.
pub(super) fn log2(x: &Float) -> Option<f64> {
    let exponent = f64::from(x.get_exp()?);
    // The mantissa lies in [1/2, 1).
    Some(exponent + x.to_f64_exp().0.abs().log2())
}

/// The slope of log_2 |c_n| over n by least squares, 0 for fewer than two values.
fn slope(c: &[Float]) -> f64 {
    let points: Vec<(f64, f64)> =
        c.iter().enumerate().filter_map(|(n, x)| Some((n as f64, log2(x)?))).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (top, bottom) = points
        .iter()
        .fold((0.0, 0.0), |(t, b), p| (t + (p.0 - x) * (p.1 - y), b + (p.0 - x) * (p.0 - x)));
    if bottom > 0.0 { top / bottom } else { 0.0 }
}

/// k such that the c_n 2^(k n) neither grow nor fall on the whole.
pub(super) fn scale_exponent(c: &[Float]) -> i32 {
    -slope(c).round().clamp(-1e8, 1e8) as i32
}

/// Drops leading coefficients that only rounding keeps from zero: they are no degree.
fn trim(p: &mut Vec<Float>, bits: u32) {
    let largest = p.iter().filter_map(log2).fold(f64::NEG_INFINITY, f64::max);
    let noise = largest - f64::from(bits) * 0.75;
    while p.len() > 1 && p.last().is_some_and(|x| log2(x).is_none_or(|e| e < noise)) {
        p.pop();
    }
}

impl Pade {
    /// [l/m] from the coefficients c_0 .. c_{l+m}, of which all bits are taken to be right.
    /// Nothing where there are fewer coefficients, or one is not finite.
    ///
    /// Cost O(m^3) products. Nothing once `stop` said so.
    ///
    /// ```
    /// use lindstedt_series::resummation::Pade;
    /// use rug::Float;
    /// // 1/(1 + x): the [3/3] approximant is the [0/1] one.
    /// let c: Vec<Float> = (0..7).map(|n| Float::with_val(200, if n % 2 == 0 { 1 } else { -1 })).collect();
    /// let pade = Pade::new(&c, 3, 3, 200, &Default::default()).ok_or("too few coefficients")?;
    /// assert_eq!(pade.degrees(), (0, 1));
    /// let half = pade.value(&Float::with_val(200, 1)).ok_or("a pole")?;
    /// assert!((half - 0.5f64).abs() < 1e-55);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn new(c: &[Float], l: usize, m: usize, bits: u32, stop: &Stop) -> Option<Self> {
        let c = c.get(..=l.checked_add(m)?)?;
        if !c.iter().all(Float::is_finite) {
            return None;
        }
        let exponent = scale_exponent(c);
        let scaled: Vec<Float> = c
            .iter()
            .zip(0i32..)
            .map(|(x, n)| Float::with_val(bits, x) << exponent.saturating_mul(n))
            .collect();
        let (mut l, mut m) = (l, m);
        let denominator = loop {
            let row = |i: usize| -> Vec<Float> {
                let entry = |j: usize| i.checked_sub(j).and_then(|k| scaled.get(k)).cloned();
                (0..=m).map(|j| entry(j).unwrap_or_else(|| Float::new(bits))).collect()
            };
            let rows: Vec<Vec<Float>> = (l + 1..=l + m).map(row).collect();
            if m == 0 {
                break vec![Float::with_val(bits, 1)];
            }
            let echelon = Echelon::new(rows, bits, stop);
            if stop.asked() {
                return None;
            }
            if echelon.rank < m {
                l = l.saturating_sub(m - echelon.rank);
                m = echelon.rank;
                continue;
            }
            let mut q = echelon.kernel()?;
            let largest = q.iter().map(|x| Float::with_val(bits, x.abs_ref()));
            let largest = largest.reduce(|a, b| a.max(&b))?;
            // q(0) = 0 where the table has a block: the approximant next to it is meant.
            if Float::with_val(bits, q[0].abs_ref()) <= largest >> (bits / 2) {
                l = l.saturating_sub(1);
                m -= 1;
                continue;
            }
            let head = q[0].clone();
            for x in &mut q {
                *x /= &head;
            }
            break q;
        };
        let coefficient = |k: usize| {
            let mut sum = Float::new(bits);
            for (j, x) in denominator.iter().enumerate().take(k + 1) {
                sum += Float::with_val(bits, x * &scaled[k - j]);
            }
            sum
        };
        let mut numerator: Vec<Float> = (0..=l).map(coefficient).collect();
        let mut denominator = denominator;
        trim(&mut numerator, bits);
        trim(&mut denominator, bits);
        Some(Self { numerator, denominator, exponent, bits })
    }

    /// p and q in y = x 2^-exponent, q(0) = 1, to so many bits.
    pub(super) fn of_parts(p: &[Float], q: &[Float], exponent: i32, bits: u32) -> Self {
        let rounded = |list: &[Float]| {
            let mut list: Vec<Float> = list.iter().map(|x| Float::with_val(bits, x)).collect();
            trim(&mut list, bits);
            list
        };
        Self { numerator: rounded(p), denominator: rounded(q), exponent, bits }
    }

    /// Whether the series of p/q begins with the coefficients c: not inside a block of the table,
    /// where the approximant next to it stands for one that does not exist.
    pub(super) fn begins_with(&self, c: &[Float]) -> bool {
        let scaled: Vec<Float> = c
            .iter()
            .zip(0i32..)
            .map(|(x, n)| x.clone() << self.exponent.saturating_mul(n))
            .collect();
        let size = |list: &[Float]| {
            let sizes = list.iter().map(|x| Float::with_val(53, x.abs_ref()));
            sizes.reduce(|a, b| a.max(&b)).unwrap_or_else(|| Float::new(53))
        };
        let noise = (size(&scaled) * size(&self.denominator)) >> (self.bits / 2);
        (0..c.len()).all(|n| {
            let mut rest =
                self.numerator.get(n).map_or_else(|| Float::new(self.bits), |p| -p.clone());
            for (q, c) in self.denominator.iter().take(n + 1).zip(scaled[..=n].iter().rev()) {
                rest += q * c;
            }
            rest.abs() <= noise
        })
    }

    /// The degrees of numerator and denominator, after a loss of rank.
    #[must_use]
    pub fn degrees(&self) -> (usize, usize) {
        (self.numerator.len() - 1, self.denominator.len() - 1)
    }

    /// p(x)/q(x); nothing at a pole.
    #[must_use]
    pub fn value(&self, x: &Float) -> Option<Float> {
        let (top, bottom) = self.parts(x);
        let value = top / bottom;
        value.is_finite().then_some(value)
    }

    /// The same to fewer bits.
    pub(super) fn rounded(mut self, bits: u32) -> Self {
        let all = self.numerator.iter_mut().chain(&mut self.denominator);
        all.for_each(|c| c.set_prec(bits));
        self.bits = bits;
        self
    }

    /// The coefficients of p and q in doubles, in y = x 2^-exponent, and 2^-exponent.
    pub(super) fn in_doubles(&self) -> (Vec<f64>, Vec<f64>, f64) {
        let doubles = |list: &[Float]| list.iter().map(Float::to_f64).collect();
        let scale = f64::from(-self.exponent).exp2();
        (doubles(&self.numerator), doubles(&self.denominator), scale)
    }

    /// p(x) and q(x).
    pub(super) fn parts(&self, x: &Float) -> (Float, Float) {
        let y = Float::with_val(self.bits, x) >> self.exponent;
        let horner =
            |p: &[Float]| p.iter().rev().fold(Float::new(self.bits), |sum, c| sum * &y + c);
        (horner(&self.numerator), horner(&self.denominator))
    }

    /// Where the denominator changes its sign between 0 and x: the jump across a cut that the poles
    /// there may stand for. Poles with residue r at distances s along a cut through R are the
    /// trapezoidal sum of Cauchy's integral over the jump: |jump| = 2 pi r/s, with s near R/m for m
    /// poles. A spurious pole, next to a zero, has almost no residue and makes almost no jump.
    pub(super) fn jump(&self, x: &Float) -> Option<Float> {
        let at = |t: &Float| self.parts(&Float::with_val(self.bits, x * t));
        let (mut near, mut far) = (Float::new(self.bits), Float::with_val(self.bits, 1));
        if !at(&far).1.is_sign_negative() {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = Float::with_val(self.bits, &near + &far) / 2u32;
            if at(&middle).1.is_sign_negative() { far = middle } else { near = middle }
        }
        let ((top, q), (_, r)) = (at(&far), at(&near));
        let slope = Float::with_val(self.bits, r - q) / Float::with_val(self.bits, &far - &near);
        // The residue in t = x/r; r and the spacing are measured in the same unit.
        let residue = Float::with_val(53, top / slope).abs();
        let (_, poles) = self.degrees();
        Some(residue * (std::f64::consts::TAU * poles as f64) / far)
    }

    /// The poles and zeros, with the doublets marked. Nothing where the iteration for the
    /// zeros of a polynomial does not settle, and once `stop` said so.
    #[must_use]
    pub fn picture(&self, stop: &Stop) -> Option<Picture> {
        let at = |p: &[Float]| -> Option<Vec<Complex>> {
            if p.len() < 2 { Some(Vec::new()) } else { zeros(p, self.bits, stop) }
        };
        let (zeros, poles) = (at(&self.numerator)?, at(&self.denominator)?);
        let slope = derivative(&self.denominator);
        let size = Float::with_val(self.bits, self.numerator.first()?.abs_ref());
        let describe = |pole: Complex| {
            let residue = evaluate(&self.numerator, &pole).div(&evaluate(&slope, &pole));
            let modulus = pole.abs();
            let distance = zeros.iter().map(|z| z.sub(&pole).abs()).reduce(|a, b| a.min(&b));
            let near = distance.is_some_and(|d| d < Float::with_val(53, &modulus * NEAR));
            let scale = Float::with_val(53, &modulus * &size);
            let weak = residue.abs() < scale * WEAK;
            Pole {
                at: pole.shift(self.exponent),
                residue: residue.shift(self.exponent),
                doublet: near && weak,
            }
        };
        Some(Picture {
            poles: poles.into_iter().map(describe).collect(),
            zeros: zeros.iter().map(|z| z.clone().shift(self.exponent)).collect(),
        })
    }

    /// [l/m] with the doublets removed by lowering both degrees until none is left; nothing once `stop` said so.
    #[must_use]
    pub fn robust(c: &[Float], l: usize, m: usize, bits: u32, stop: &Stop) -> Option<Self> {
        let (mut l, mut m) = (l, m);
        loop {
            let pade = Self::new(c, l, m, bits, stop)?;
            let picture = pade.picture(stop);
            if stop.asked() {
                return None;
            }
            let doublets =
                picture.map_or(0, |p| p.poles.iter().filter(|pole| pole.doublet).count());
            let (upper, lower) = pade.degrees();
            if doublets == 0 || lower == 0 {
                return Some(pade);
            }
            (l, m) = (upper.saturating_sub(doublets), lower.saturating_sub(doublets));
        }
    }
}

/// sum c_n x^n for n <= k, for every k.
#[must_use]
pub fn partial_sums(c: &[Float], x: &Float, bits: u32) -> Vec<Float> {
    let mut sum = Float::new(bits);
    let term = |(n, c): (usize, &Float)| {
        let n = u32::try_from(n).unwrap_or(u32::MAX);
        sum += Float::with_val(bits, x.pow(n)) * c;
        sum.clone()
    };
    c.iter().enumerate().map(term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::Rational;

    const BITS: u32 = 300;

    fn series(f: impl Fn(u32) -> Rational) -> Vec<Float> {
        (0..41).map(|n| Float::with_val(BITS, f(n))).collect()
    }

    /// [5/5] - e = 2.7665049e-10 (mpmath 1.3.0).
    #[test]
    fn exponential_function() {
        let c = series(|n| Rational::from((1, rug::Integer::from(rug::Integer::factorial(n)))));
        let one = Float::with_val(BITS, 1);
        let value = Pade::new(&c, 5, 5, BITS, &Stop::default()).unwrap().value(&one).unwrap();
        let error = value - one.exp();
        assert!((error.to_f64() / 2.766_504_9e-10 - 1.0).abs() < 1e-7, "{error}");
    }

    #[test]
    fn a_rational_function_is_recovered_with_its_poles() {
        // (2 + x)/((1 - x/3)(1 + x^2/4)), by the recurrence of its denominator.
        let q = [(1, 1), (-1, 3), (1, 4), (-1, 12)].map(Rational::from);
        let mut c: Vec<Rational> = Vec::new();
        for n in 0..41usize {
            let mut value = Rational::from(match n {
                0 => 2,
                1 => 1,
                _ => 0,
            });
            for k in 1..=n.min(3) {
                value -= Rational::from(&q[k] * &c[n - k]);
            }
            c.push(value);
        }
        let floats: Vec<Float> = c.iter().map(|x| Float::with_val(BITS, x)).collect();
        for (l, m) in [(20, 20), (10, 10), (3, 17), (1, 3)] {
            let pade = Pade::new(&floats, l, m, BITS, &Stop::default()).unwrap();
            assert_eq!(pade.degrees(), (1, 3), "[{l}/{m}]");
            let picture = pade.picture(&Stop::default()).unwrap();
            let moduli: Vec<f64> = picture.poles.iter().map(|p| p.at.abs().to_f64()).collect();
            for (found, exact) in moduli.iter().zip([2.0, 2.0, 3.0]) {
                assert!((found - exact).abs() < 1e-12);
            }
            assert!((picture.zeros[0].re.to_f64() + 2.0).abs() < 1e-12);
            assert!(picture.poles.iter().all(|p| !p.doublet));
        }
    }

    /// Noise of size 1e-12 on a geometric series makes doublets; they are found and removed.
    #[test]
    fn froissart_doublets() {
        let mut state = 7u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / 2f64.powi(31) - 0.5
        };
        let c: Vec<Float> = (0..21).map(|_| Float::with_val(BITS, 1.0 + 1e-12 * noise())).collect();
        let plain = Pade::new(&c, 10, 10, BITS, &Stop::default()).unwrap();
        let doublets =
            plain.picture(&Stop::default()).unwrap().poles.iter().filter(|p| p.doublet).count();
        assert_eq!((plain.degrees().1, doublets), (10, 9));
        let robust = Pade::robust(&c, 10, 10, BITS, &Stop::default()).unwrap();
        assert_eq!(robust.degrees().1, 1);
        let value = robust.value(&Float::with_val(BITS, -3)).unwrap();
        assert!((value - 0.25f64).abs() < 1e-9);
    }
}
