//! Trigonometric polynomials with rational coefficients over one denominator, and as doubles.

use crate::laurent::Laurent;
use crate::polynomial::Trigonometric;
use crate::upward::Up;
use nalgebra::Complex;
use rug::float::Round;
use rug::{Complete, Float, Integer, Rational};

/// A trigonometric polynomial: integer coefficients times one rational number.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    pub(crate) modes: Laurent,
    pub(crate) scale: Rational,
}

/// Complex coefficients k = 0.. in doubles.
pub(crate) type Doubles = Vec<Complex<f64>>;

/// factor times modes times a wave.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) factor: Rational,
    pub(crate) modes: Laurent,
    pub(crate) wave: Trigonometric,
}

pub(crate) fn unit() -> Trigonometric {
    Trigonometric::from([(0, (Rational::from(1), Rational::new()))])
}

/// The sum of the parts over one denominator.
pub(crate) fn combine(parts: Vec<Part>) -> Exact {
    let mut denominator = Integer::from(1);
    for part in &parts {
        for (a, b) in part.wave.values() {
            // A half for the complex coefficient (a - i b)/2 of cos and sin.
            denominator.lcm_mut(&(part.factor.denom() * a.denom()).complete());
            denominator.lcm_mut(&(part.factor.denom() * b.denom()).complete());
        }
    }
    denominator *= 2;
    let whole = |q: &Rational| (q * &denominator).complete().numer().clone();
    let reach = |p: &Part| p.modes.modes() + p.wave.keys().max().map_or(0, |h| *h as usize);
    let mut sum = Laurent::zero(parts.iter().map(reach).max().unwrap_or(0));
    for part in &parts {
        for (h, (a, b)) in &part.wave {
            let half = |q: &Rational| if *h == 0 { q.clone() } else { q.clone() / 2 };
            let re = whole(&(half(a) * &part.factor));
            let im = whole(&-(half(b) * &part.factor));
            shifted(&mut sum, &part.modes, *h as i64, &re, &im);
            if *h > 0 {
                shifted(&mut sum, &part.modes, -i64::from(*h), &re, &-im);
            }
        }
    }
    sum.trim();
    Exact { modes: sum, scale: Rational::from((1, denominator)) }
}

/// sum += (re + i im) e^(i h tau) f.
fn shifted(sum: &mut Laurent, f: &Laurent, h: i64, re: &Integer, im: &Integer) {
    for k in 0..sum.re.len() {
        let l = k as i64 - h;
        let at = l.unsigned_abs() as usize;
        let (Some(a), Some(b)) = (f.re.get(at), f.im.get(at)) else { continue };
        let flip = l < 0;
        sum.re[k] += re * a;
        if !im.is_zero() {
            sum.im[k] += im * a;
        }
        if !b.is_zero() {
            let (by_re, by_im) = (Integer::from(re * b), Integer::from(im * b));
            if flip {
                sum.im[k] -= by_re;
                sum.re[k] += by_im;
            } else {
                sum.im[k] += by_re;
                sum.re[k] -= by_im;
            }
        }
    }
}

impl Exact {
    /// modes/2^bits.
    pub(crate) fn over_power(modes: Laurent, bits: u32) -> Self {
        Self { modes, scale: Rational::from((1, Integer::from(1) << bits)) }
    }

    /// An upper bound of 2^shift sum_k nu^k (|a_k| + |b_k|).
    pub(crate) fn norm(&self, nu: Up, shift: u32) -> Up {
        let up = |x: &Float, y: &Float| Float::with_val_round(53, x * y, Round::Up).0;
        let scale = Float::with_val_round(53, &self.scale, Round::AwayZero).0.abs() << shift;
        let (mut sum, mut power) = (Up::ZERO, Up::ONE);
        for (k, (re, im)) in self.modes.re.iter().zip(&self.modes.im).enumerate() {
            let size = Integer::from(re.abs_ref()) + Integer::from(im.abs_ref());
            let size: Integer = size * if k == 0 { 1 } else { 2 };
            if !size.is_zero() {
                let size = Float::with_val_round(53, &size, Round::Up).0;
                sum = sum + Up::of_float(&up(&size, &scale)) * power;
            }
            power = power * nu;
        }
        sum
    }

    /// The value at tau = 0.
    pub(crate) fn at_zero(&self) -> Rational {
        let twice: Integer = self.modes.re.iter().skip(1).sum();
        let sum = self.modes.re.first().cloned().unwrap_or_default() + twice * 2;
        Rational::from(&self.scale * sum)
    }

    /// d/dtau.
    pub(crate) fn derivative(&self) -> Self {
        Self { modes: self.modes.derivative(), scale: self.scale.clone() }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        Self {
            modes: self.modes.times(&other.modes),
            scale: (&self.scale * &other.scale).complete(),
        }
    }

    pub(crate) fn scaled(&self, factor: i32) -> Self {
        Self { modes: self.modes.clone(), scale: (&self.scale * factor).complete() }
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        let part =
            |f: &Self, factor: Rational| Part { factor, modes: f.modes.clone(), wave: unit() };
        combine(vec![part(self, self.scale.clone()), part(other, -other.scale.clone())])
    }

    /// The exponent with which the largest part is about 1; nothing for 0.
    pub(crate) fn exponent(&self) -> Option<i32> {
        let parts = self.modes.re.iter().chain(&self.modes.im);
        let largest = parts.map(Integer::significant_bits).max().filter(|bits| *bits > 0)?;
        Some(largest as i32 + split(&self.scale).1)
    }

    /// The coefficients in doubles times 2^exponent.
    pub(crate) fn doubles(&self, exponent: i32) -> Doubles {
        let (scale, shift) = split(&self.scale);
        let double = |n: &Integer| {
            let (mantissa, size) = n.to_f64_exp();
            let power = size as i32 + shift - exponent;
            if power < -900 { 0.0 } else { mantissa * scale * power_of_two(power) }
        };
        let both = self.modes.re.iter().zip(&self.modes.im);
        both.map(|(re, im)| Complex::new(double(re), double(im))).collect()
    }
}

/// The relative error of each real and imaginary part of [`Exact::doubles`] (what is smaller than 2^-900
/// became 0): truncation of the mantissa, of the scale, and their product, at most 2 + 2 + 1 units.
pub(crate) const ERROR: Up = Up(8.0 * crate::upward::UNIT);
/// q = mantissa 2^exponent, the mantissa of size about 1 and truncated.
fn split(q: &Rational) -> (f64, i32) {
    let float = Float::with_val(53, q);
    let exponent = float.get_exp().unwrap_or(0);
    ((float >> exponent).to_f64(), exponent)
}

/// 2^power; infinite or 0 where doubles end.
pub(crate) fn power_of_two(power: i32) -> f64 {
    2.0f64.powi(power)
}
