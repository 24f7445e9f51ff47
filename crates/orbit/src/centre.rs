//! The numerical solution: dyadic Fourier coefficients and a rational frequency, with the exact
//! value of everything that is a polynomial in them.

use crate::field::{Field, Trigonometric};
use crate::laurent::Laurent;
use crate::upward::Up;
use nalgebra::Complex;
use rug::{Complete, Float, Integer, Rational};
use std::collections::BTreeMap;

/// x = sum_k c_k e^(i k tau), c_k = modes_k/2^bits, tau = omega t.
#[derive(Clone, Debug)]
pub(crate) struct Centre {
    pub(crate) bits: u32,
    pub(crate) frequency: Rational,
    pub(crate) modes: Laurent,
}

/// A trigonometric polynomial: integer coefficients times one rational number.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    pub(crate) modes: Laurent,
    pub(crate) scale: Rational,
}

/// Complex coefficients k = 0.. in doubles times 2^exponent.
#[derive(Clone, Debug)]
pub(crate) struct Doubles {
    /// Each real and imaginary part has a relative error below [`Doubles::ERROR`]; what is
    /// smaller than 2^-900 became 0.
    pub(crate) values: Vec<Complex<f64>>,
    pub(crate) exponent: i32,
}

/// The powers x^i z^j of integer polynomials, each multiplied once.
struct Powers {
    x: Laurent,
    z: Laurent,
    known: BTreeMap<(u32, u32), Laurent>,
}

impl Powers {
    fn get(&mut self, i: u32, j: u32) -> Laurent {
        if (i, j) == (0, 0) {
            return Laurent::one();
        }
        if let Some(power) = self.known.get(&(i, j)) {
            return power.clone();
        }
        let power = if i > 0 {
            self.get(i - 1, j).times(&self.x)
        } else {
            self.get(0, j - 1).times(&self.z)
        };
        self.known.insert((i, j), power.clone());
        power
    }
}

/// The exact values at a centre that Newton's method and the proof need.
pub(crate) struct Values {
    /// F = omega^2 d^2x/dtau^2 - g(x, omega z, tau).
    pub(crate) residual: Exact,
    /// g_x.
    pub(crate) by_x: Exact,
    /// omega g_y: what dh/dtau is multiplied by.
    pub(crate) by_slope: Exact,
    /// dF/domega = 2 omega d^2x/dtau^2 - z g_y.
    pub(crate) by_frequency: Exact,
}

impl Centre {
    /// The coefficients c_k rounded to `bits` bits behind the point.
    pub(crate) fn from_doubles(bits: u32, frequency: f64, modes: &[Complex<f64>]) -> Self {
        let round = |x: f64| {
            let scaled = Float::with_val(64, x) << bits;
            scaled.to_integer().unwrap_or_default()
        };
        let re = modes.iter().map(|c| round(c.re)).collect();
        let im = modes.iter().map(|c| round(c.im)).collect();
        let frequency = dyadic(&Float::with_val(64, frequency), bits);
        Self { bits, frequency, modes: Laurent { re, im } }
    }

    /// The same numbers with another precision, rounded where it is less.
    pub(crate) fn with_bits(mut self, bits: u32) -> Self {
        let old = self.bits;
        let change = |c: &mut Integer| {
            if bits >= old {
                *c <<= bits - old;
            } else {
                *c += Integer::from(1) << (old - bits - 1);
                *c >>= old - bits;
            }
        };
        self.modes.re.iter_mut().chain(&mut self.modes.im).for_each(change);
        self.bits = bits;
        self
    }

    /// c_k in doubles.
    pub(crate) fn doubles(&self) -> Vec<Complex<f64>> {
        let scale = Rational::from((1, Integer::from(1) << self.bits));
        Exact { modes: self.modes.clone(), scale }.doubles(Some(0)).values
    }

    /// Adds a correction: doubles times 2^exponent.
    pub(crate) fn add(&mut self, frequency: f64, modes: &[Complex<f64>], exponent: i32) {
        let bits = self.bits;
        let round = |x: f64| {
            let scaled = Float::with_val(64, x) << (bits as i32 + exponent);
            scaled.to_integer().unwrap_or_default()
        };
        if modes.len() > self.modes.re.len() {
            self.modes.resize(modes.len() - 1);
        }
        for (k, c) in modes.iter().enumerate() {
            self.modes.re[k] += round(c.re);
            self.modes.im[k] += round(c.im);
        }
        if frequency != 0.0 {
            self.frequency += dyadic(&(Float::with_val(64, frequency) << exponent), bits);
        }
    }

    /// x(tau) at tau = 0, exactly.
    pub(crate) fn at_zero(&self) -> Rational {
        let twice: Integer = self.modes.re.iter().skip(1).sum();
        let sum = self.modes.re.first().cloned().unwrap_or_default() + twice * 2;
        Rational::from((sum, Integer::from(1) << self.bits))
    }

    /// (|x|_nu, |dx/dtau|_nu, the larger of |c_0| and |dx/dtau|_nu taken mode by mode).
    pub(crate) fn norms(&self, nu: Up) -> [Up; 3] {
        let (mut x, mut slope, mut both, mut power) = (Up::ZERO, Up::ZERO, Up::ZERO, Up::ONE);
        for (k, (re, im)) in self.modes.re.iter().zip(&self.modes.im).enumerate() {
            let scale = if k == 0 { 1.0 } else { 2.0 };
            let size = Up(above(re, self.bits)) + Up(above(im, self.bits));
            let size = size * Up(scale) * power;
            x = x + size;
            slope = slope + size * Up(k as f64);
            both = both + size * Up(k.max(1) as f64);
            power = power * nu;
        }
        [x, slope, both]
    }

    /// The phase of the largest x on a grid, in doubles.
    pub(crate) fn top(&self) -> f64 {
        let modes = self.doubles();
        let points = 16 * modes.len().max(16);
        let value = |j: usize| -> f64 {
            let wave = Complex::from_polar(1.0, std::f64::consts::TAU * j as f64 / points as f64);
            let sum = modes.iter().rev().fold(Complex::<f64>::default(), |sum, c| sum * wave + c);
            2.0 * sum.re
        };
        let values = (0..points).map(|j| (j, value(j)));
        let best = values.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(j, _)| j);
        std::f64::consts::TAU * best as f64 / points as f64
    }

    /// The distance from another numerical solution in the norm with the weight nu and the weight of the
    /// frequency, which does not count without.
    pub(crate) fn distance(&self, other: &Self, nu: Up, scale: Option<f64>) -> Up {
        let bits = self.bits.max(other.bits);
        let (mut apart, other) = (self.clone().with_bits(bits), other.clone().with_bits(bits));
        apart.modes.resize(self.modes.modes().max(other.modes.modes()));
        let parts =
            [(&mut apart.modes.re, &other.modes.re), (&mut apart.modes.im, &other.modes.im)];
        for (mine, others) in parts {
            mine.iter_mut().zip(others).for_each(|(a, b)| *a -= b);
        }
        let [.., both] = apart.norms(nu);
        let detuned = Rational::from(&self.frequency - &other.frequency);
        both + scale.map_or(Up::ZERO, |scale| Up::of(&detuned) * Up(scale))
    }

    /// The largest amplitude of a harmonic, roughly.
    pub(crate) fn largest(&self) -> Float {
        let parts = self.modes.re.iter().chain(&self.modes.im).map(|n| n.clone().abs());
        Float::with_val(53, parts.max().unwrap_or_default()) >> (self.bits - 1)
    }

    fn powers(&self) -> Powers {
        let z = self.modes.derivative();
        Powers { x: self.modes.clone(), z, known: BTreeMap::new() }
    }

    /// F at the centre.
    pub(crate) fn residual(&self, field: &Field) -> Exact {
        self.residual_with(field, &mut self.powers())
    }

    fn residual_with(&self, field: &Field, powers: &mut Powers) -> Exact {
        let square = self.frequency.clone().square();
        let minus = |_, _| Rational::from(-1);
        let parts = self.parts(field, powers, 0, 0, 0, minus);
        self.with_inertia(square, parts)
    }

    /// factor d^2x/dtau^2 + the parts.
    fn with_inertia(&self, factor: Rational, mut parts: Vec<Part>) -> Exact {
        let bend = self.modes.derivative().derivative();
        parts.push(Part { factor: factor >> self.bits, modes: bend, wave: unit() });
        combine(parts)
    }

    /// The mean over a period of a polynomial field, exactly.
    pub(crate) fn mean(&self, field: &Field) -> Rational {
        let one = |_, _| Rational::from(1);
        let sum = combine(self.parts(field, &mut self.powers(), 0, 0, 0, one));
        sum.modes.re.first().map_or(Rational::new(), |c| sum.scale * c)
    }

    /// F and its derivatives at the centre.
    pub(crate) fn values(&self, field: &Field) -> Values {
        let mut powers = self.powers();
        let residual = self.residual_with(field, &mut powers);
        let by_x = self.parts(field, &mut powers, 0, 1, 0, |i, _| Rational::from(i));
        let by_slope = self.parts(field, &mut powers, 0, 0, 1, |_, j| Rational::from(j));
        let by_frequency = self.parts(field, &mut powers, 1, 0, 0, |_, j| -Rational::from(j));
        let by_frequency = self.with_inertia((&self.frequency * 2u32).complete(), by_frequency);
        Values { residual, by_x: combine(by_x), by_slope: combine(by_slope), by_frequency }
    }

    /// The terms c omega^(j-p) x^(i-q) z^(j-r) f times `factor(i, j)`.
    fn parts(
        &self,
        field: &Field,
        powers: &mut Powers,
        p: u32,
        q: u32,
        r: u32,
        factor: impl Fn(u32, u32) -> Rational,
    ) -> Vec<Part> {
        let mut parts = Vec::new();
        for term in &field.terms {
            let (i, j) = (term.x, term.velocity);
            if j < p.max(r) || i < q {
                continue;
            }
            let modes = powers.get(i - q, j - r);
            let power = rug::ops::Pow::pow(self.frequency.clone(), j - p);
            let factor = (factor(i, j) * power) >> (self.bits * (i - q + j - r));
            parts.push(Part { factor, modes, wave: term.factor.clone() });
        }
        parts
    }
}

struct Part {
    factor: Rational,
    modes: Laurent,
    wave: Trigonometric,
}

fn unit() -> Trigonometric {
    Trigonometric::from([(0, (Rational::from(1), Rational::new()))])
}

/// The sum of the parts over one denominator.
fn combine(parts: Vec<Part>) -> Exact {
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

/// |n|/2^bits rounded up.
fn above(n: &Integer, bits: u32) -> f64 {
    let float = Float::with_val_round(53, n, rug::float::Round::AwayZero).0 >> bits;
    float.to_f64_round(rug::float::Round::AwayZero).abs()
}

/// x rounded to a multiple of 2^-bits.
fn dyadic(x: &Float, bits: u32) -> Rational {
    let scaled = Float::with_val(x.prec(), x << bits);
    Rational::from((scaled.to_integer().unwrap_or_default(), Integer::from(1) << bits))
}

impl Exact {
    /// The coefficients in doubles: scaled so that the largest part is about 1, or by the given
    /// exponent.
    pub(crate) fn doubles(&self, exponent: Option<i32>) -> Doubles {
        let (scale, shift) = split(&self.scale);
        let parts = self.modes.re.iter().chain(&self.modes.im);
        let largest = parts.map(Integer::significant_bits).max().unwrap_or(0);
        let exponent = exponent.unwrap_or(largest as i32 + shift);
        let double = |n: &Integer| {
            let (mantissa, size) = n.to_f64_exp();
            let power = size as i32 + shift - exponent;
            if power < -900 { 0.0 } else { mantissa * scale * power_of_two(power) }
        };
        let both = self.modes.re.iter().zip(&self.modes.im);
        let values = both.map(|(re, im)| Complex::new(double(re), double(im))).collect();
        Doubles { values, exponent }
    }
}

impl Doubles {
    /// Truncation of the mantissa, of the scale, and their product: at most 2 + 2 + 1 units.
    pub(crate) const ERROR: Up = Up(8.0 * crate::upward::UNIT);
}

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
