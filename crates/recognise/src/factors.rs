//! Factors g(x) of perturbations: x^n, and products of sin(k x + phase), cos(k x + phase) whose phases are
//! multiples of pi/2, as sums of sin(k x), cos(k x).

use crate::in_pi::InPi;
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Function};
use lindstedt_melnikov::Factor;
use lindstedt_number::Exact;
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// sum q g(x).
pub(crate) type Factors = BTreeMap<Factor, Rational>;

/// Products of so many sines and cosines are multiplied out.
const MOST_WAVES: u32 = 100;

/// Whether it is a sine or cosine of a linear function of x, the same for all times.
pub(crate) fn is_wave(e: &Expression) -> bool {
    let Expression::Function(Function::Sin | Function::Cos, argument) = e else { return false };
    let Some(all) = expand(argument) else { return false };
    let linear = |m: &Monomial| m.order == 0 && m.velocity == 0 && m.atoms.is_empty() && m.x <= 1;
    all.terms.keys().all(linear) && all.terms.keys().any(|m| m.x == 1)
}

/// The factor of a bound term that depends on x, without the atom `beside`; nothing where it is none of the above.
pub(crate) fn factors(all: &Monomials, m: &Monomial, beside: Option<&str>) -> Option<Factors> {
    let waves = || m.atoms.iter().filter(|(key, _)| Some(key.as_str()) != beside);
    let count: u32 = waves().map(|(_, n)| *n).sum();
    if count == 0 {
        return Some(Factors::from([(Factor::Power(m.x), Rational::from(1))]));
    }
    (m.x == 0 && count <= MOST_WAVES).then_some(())?;
    let mut product = Factors::from([(Factor::Cosine(Rational::new()), Rational::from(1))]);
    for (key, n) in waves() {
        let (k, turns) = wave(all.atoms.get(key)?)?;
        for _ in 0..*n {
            let mut next = Factors::new();
            for (factor, q) in &product {
                multiply(&mut next, factor, q, &k, turns)?;
            }
            product = next;
        }
    }
    // cos 0 = 1.
    if let Some(q) = product.remove(&Factor::Cosine(Rational::new())) {
        product.insert(Factor::ONE, q);
    }
    product.retain(|_, q| !q.is_zero());
    Some(product)
}

/// cos(k x - turns pi/2) for a bound sine or cosine.
fn wave(e: &Expression) -> Option<(Rational, i64)> {
    let Expression::Function(function @ (Function::Sin | Function::Cos), argument) = e else {
        return None;
    };
    let (mut slope, mut phase) = (Rational::new(), InPi::default());
    for (m, q) in &expand(argument)?.terms {
        match (m.is_power(1, 0), m.is_power(0, 0)) {
            (true, _) if m.parameters.is_empty() && m.order == 0 => slope += q,
            (_, true) if m.order == 0 => phase.add(m, q)?,
            _ => return None,
        }
    }
    let turns = quarter_turns(&phase.value()?)?;
    Some((slope, if *function == Function::Sin { 1 - turns } else { -turns }))
}

/// The angle in units of pi/2, where it is a whole number of them.
fn quarter_turns(angle: &Exact) -> Option<i64> {
    let turns = match angle {
        Exact::PiTimes(q) => Rational::from(q * 2u32),
        other => other.as_rational().filter(|q| q.is_zero())?.clone(),
    };
    turns.is_integer().then(|| turns.numer().mod_u(4).into())
}

/// sum += q cos(k x - turns pi/2).
fn add(sum: &mut Factors, q: &Rational, k: Rational, turns: i64) {
    let (even, negative) = (turns % 2 == 0, matches!(turns.rem_euclid(4), 2 | 3));
    let flip = !even && k < 0;
    let size = Rational::from(k.abs_ref());
    let q = if negative != flip { Rational::from(-q) } else { q.clone() };
    if even {
        *sum.entry(Factor::Cosine(size)).or_default() += q;
    } else if !size.is_zero() {
        *sum.entry(Factor::Sine(size)).or_default() += q;
    }
}

/// sum += q g(x) cos(k x - turns pi/2): 2 cos u cos v = cos(u + v) + cos(u - v).
fn multiply(
    sum: &mut Factors,
    factor: &Factor,
    q: &Rational,
    k: &Rational,
    turns: i64,
) -> Option<()> {
    let (other, quarter) = match factor {
        Factor::Cosine(other) => (other, 0),
        Factor::Sine(other) => (other, 1),
        _ => return None,
    };
    let half = Rational::from(q / 2u32);
    add(sum, &half, Rational::from(other + k), quarter + turns);
    add(sum, &half, Rational::from(other - k), quarter - turns);
    Some(())
}

/// x = scale y + shift.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Not 0.
    pub scale: Rational,
    /// Nothing where it is neither rational nor a rational multiple of pi.
    pub shift: Option<Exact>,
}

impl Frame {
    /// x = y.
    pub fn identity() -> Self {
        Self { scale: Rational::from(1), shift: Some(Exact::from(0)) }
    }

    /// g(x) in y; nothing where it is no sum of factors over Q.
    pub fn moved(&self, factor: &Factor) -> Option<Factors> {
        let mut sum = Factors::new();
        match factor {
            Factor::Power(0) => {
                sum.insert(Factor::ONE, Rational::from(1));
            }
            Factor::Power(n) => {
                // (s y + c)^n.
                let shift = self.shift.as_ref()?.as_rational()?;
                let mut power = Rational::from(1);
                for m in (0..=*n).rev() {
                    let binomial = Rational::from(Integer::from(*n).binomial(m));
                    sum.insert(Factor::Power(m), binomial * &power);
                    power *= shift;
                }
                for (factor, q) in &mut sum {
                    if let Factor::Power(m) = factor {
                        for _ in 0..*m {
                            *q *= &self.scale;
                        }
                    }
                }
            }
            Factor::Sine(k) => self.turned(&mut sum, k, 1)?,
            Factor::Cosine(k) => self.turned(&mut sum, k, 0)?,
            _ => return None,
        }
        sum.retain(|_, q| !q.is_zero());
        Some(sum)
    }

    /// cos(k x - turns pi/2) = cos(k s y - (turns - 2 k c/pi) pi/2).
    fn turned(&self, sum: &mut Factors, k: &Rational, turns: i64) -> Option<()> {
        let shift = quarter_turns(&self.shift.as_ref()?.times(k))?;
        add(sum, &Rational::from(1), Rational::from(k * &self.scale), turns - shift);
        Some(())
    }
}
