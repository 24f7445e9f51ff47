//! One method's values as a formula in doubles.

use super::maps::wedge_constant;
use super::pade::scale_exponent;
use super::prepared::{Prepared, Way};
use super::{Map, Pade, Sample};
use rug::Float;

/// Newton's steps for the variable of a wedge at most: two from a guess between nodes, six from far below the innermost one.
const STEPS: u32 = 20;
/// After a step of this part of the variable the next would be below rounding.
const LAST: f64 = 1e-8;

/// A value of one approximant, and that of the one before.
pub(super) struct Values {
    pub value: f64,
    pub before: f64,
}

/// f = (x/(x'(0) w))^p g(w) in doubles.
#[derive(Clone, Debug)]
pub(super) struct Formula {
    change: Change,
    power: f64,
    form: Form,
}

/// w of x.
#[derive(Clone, Debug)]
enum Change {
    None,
    /// w = x/(s + x).
    Quotient(f64),
    /// [`Map::Wedge`] with its constant C and the fraction a.
    Wedge {
        constant: f64,
        fraction: f64,
    },
}

/// g.
#[derive(Clone, Debug)]
enum Form {
    Polynomial { coefficients: Vec<f64>, scale: f64 },
    Quotients { last: Quotient, before: Option<Quotient> },
}

/// p(y)/q(y), y = scale w.
#[derive(Clone, Debug)]
struct Quotient {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    scale: f64,
}

fn horner(coefficients: &[f64], y: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * y + c)
}

impl Quotient {
    fn new(pade: &Pade) -> Self {
        let (numerator, denominator, scale) = pade.in_doubles();
        Self { numerator, denominator, scale }
    }

    fn at(&self, w: f64) -> f64 {
        let y = self.scale * w;
        horner(&self.numerator, y) / horner(&self.denominator, y)
    }
}

/// c_n 2^(k n) in doubles, and 2^-k.
fn polynomial(c: &[Float], bits: u32) -> Form {
    let exponent = scale_exponent(c);
    let scaled = c.iter().zip(0i32..);
    let scaled = scaled.map(|(c, n)| Float::with_val(bits, c) << exponent.saturating_mul(n));
    let coefficients = scaled.map(|c| c.to_f64()).collect();
    Form::Polynomial { coefficients, scale: f64::from(-exponent).exp2() }
}

impl Formula {
    /// The formula of a method; nothing where there is no approximant.
    pub fn new(prepared: &Prepared, sample: &Sample) -> Option<Self> {
        let (change, power) = match &prepared.map {
            None => (Change::None, 0.0),
            Some((Map::Rational { scale }, p)) => (Change::Quotient(scale.to_f64()), p.to_f64()),
            Some((Map::Wedge { modulus, fraction }, p)) => {
                let constant = wedge_constant(modulus, fraction, sample.bits).to_f64();
                (Change::Wedge { constant, fraction: fraction.to_f64() }, p.to_f64())
            }
        };
        let form = match &prepared.way {
            Way::Series => polynomial(&sample.coefficients, sample.bits),
            Way::InVariable(c) => polynomial(c, sample.bits),
            Way::Approximants(stairs) => {
                let mut list = stairs.approximants().rev().map(Quotient::new);
                Form::Quotients { last: list.next()?, before: list.next() }
            }
        };
        Some(Self { change, power, form })
    }

    /// Whether w follows from x by iteration.
    pub fn is_implicit(&self) -> bool {
        matches!(self.change, Change::Wedge { .. })
    }

    /// f at x by the terms up to an order, w being near `guess` where it follows by iteration.
    #[inline]
    pub fn values(&self, x: f64, order: usize, guess: f64) -> Values {
        let (w, ratio) = match self.change {
            Change::None => (x, 1.0),
            // 1 - u = s/(s + x), without the cancellation for x -> infinity.
            Change::Quotient(scale) => (x / (scale + x), (scale + x) / scale),
            Change::Wedge { constant, fraction } => {
                let w = wedge(x / constant, fraction, guess);
                (w, x / (w * constant))
            }
        };
        let factor = if self.power == 0.0 { 1.0 } else { ratio.powf(self.power) };
        let (value, before) = match &self.form {
            Form::Polynomial { coefficients, scale } => {
                let known = coefficients.get(..=order).unwrap_or(coefficients);
                let value = horner(known, w * scale);
                (value, value)
            }
            Form::Quotients { last, before } => {
                let value = last.at(w);
                (value, before.as_ref().map_or(value, |before| before.at(w)))
            }
        };
        Values { value: factor * value, before: factor * before }
    }
}

/// w of x/C = w (1 - w)^(-2a) (1 + w)^(-2(1-a)) by Newton's method in the logarithms.
fn wedge(quotient: f64, fraction: f64, guess: f64) -> f64 {
    let goal = quotient.abs().ln();
    let (twice, rest) = (2.0 * fraction, 2.0 - 2.0 * fraction);
    let (ahead, behind) = if quotient < 0.0 { (rest, twice) } else { (twice, rest) };
    let mut w = guess.abs();
    for _ in 0..STEPS {
        let height = w.ln() - ahead * (-w).ln_1p() - behind * w.ln_1p() - goal;
        let slope = 1.0 / w + ahead / (1.0 - w) - behind / (1.0 + w);
        let before = w;
        w = (w - height / slope).clamp(w / 2.0, (1.0 + w) / 2.0);
        if (w - before).abs() <= LAST * before {
            break;
        }
    }
    w.copysign(quotient)
}
