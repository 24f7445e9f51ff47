//! The evaluation of exact constants: polynomials in named symbols as balls.

use lindstedt_algebra::Stop;
use lindstedt_coeff::{Polynomial, Symbol};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::lobachevsky_function::means;
use rug::Rational;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, PoisonError};

/// The values of named constants at any precision, each computed once per precision.
#[derive(Debug, Default)]
pub struct Constants {
    /// The amplitude a: formal parameter 0 is ln a, and S_n = sum_k (-1)^k a^(2k) k^n/(2k+1)!.
    amplitude: Option<Exact>,
    known: Mutex<BTreeMap<(u32, Symbol), Ball>>,
}

impl Clone for Constants {
    /// The amplitude; values are computed again when they are asked for.
    fn clone(&self) -> Self {
        Self::new(self.amplitude.clone())
    }
}

impl Constants {
    /// The constants that do not depend on an amplitude, and those that do if one is given.
    pub fn new(amplitude: Option<Exact>) -> Self {
        Self { amplitude, known: Mutex::default() }
    }

    fn value(&self, symbol: Symbol, balls: Balls) -> Option<Ball> {
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = lock().get(&(balls.bits(), symbol)) {
            return Some(value.clone());
        }
        let amplitude = || Some(self.amplitude.as_ref()?.ball(balls));
        let value = match symbol {
            Symbol::Moment(m) => {
                let mut table = lock();
                for (k, mu) in (0u16..).zip(means(usize::from(m), balls)) {
                    table.insert((balls.bits(), Symbol::Moment(k)), mu);
                }
                return table.get(&(balls.bits(), symbol)).cloned();
            }
            Symbol::LogTwo => balls.ln_2(),
            Symbol::Pi => balls.pi(),
            Symbol::Zeta(k) => balls.zeta(u32::from(k))?,
            Symbol::Sum(n) => sine_sum(n, &amplitude()?, balls, &Stop::default())?,
            Symbol::Parameter(0) => balls.ln(&amplitude()?)?,
            Symbol::Parameter(_) => return None,
        };
        lock().insert((balls.bits(), symbol), value.clone());
        Some(value)
    }

    /// The polynomial's value as a ball at the precision of the context.
    pub fn evaluate(&self, p: &Polynomial, balls: Balls) -> Option<Ball> {
        let symbols = p.terms().iter().flat_map(|(m, _)| m.factors()).map(|(s, _)| *s);
        let moment = |s| if let Symbol::Moment(m) = s { Some(m) } else { None };
        if let Some(largest) = symbols.filter_map(moment).max() {
            self.value(Symbol::Moment(largest), balls)?;
        }
        let mut powers: BTreeMap<(Symbol, i16), Ball> = BTreeMap::new();
        let mut sum = balls.zero();
        // The products of the first factors of a monomial, most of which the next one shares.
        let mut products: Vec<(&(Symbol, i16), Ball)> = Vec::new();
        for (monomial, coefficient) in p.terms() {
            let factors = monomial.factors();
            let known = products.iter().zip(factors).take_while(|((f, _), g)| f == g).count();
            products.truncate(known);
            for factor @ &(symbol, exponent) in &factors[known..] {
                if let Entry::Vacant(entry) = powers.entry(*factor) {
                    let base = self.value(symbol, balls)?;
                    entry.insert(balls.powi(&base, exponent.into())?);
                }
                let power = &powers[factor];
                let product = products.last().map(|(_, before)| balls.mul(before, power));
                products.push((factor, product.unwrap_or_else(|| power.clone())));
            }
            let term = match products.last() {
                Some((_, product)) => balls.mul_rational(product, coefficient),
                None => balls.from_rational(coefficient),
            };
            sum = balls.add(&sum, &term);
        }
        Some(sum)
    }
}

/// S_n(a) = sum_k (-1)^k a^(2k) k^n/(2k+1)!, 0^0 = 1: S_0 = sin(a)/a. The terms are summed until
/// they decrease by more than a half each; then the rest is below the last term.
/// Nothing once `stop` said so, which is asked for every term.
pub fn sine_sum(n: u16, amplitude: &Ball, balls: Balls, stop: &Stop) -> Option<Ball> {
    let square = balls.square(amplitude);
    let mut weight = balls.one();
    let mut sum = if n == 0 { balls.one() } else { balls.zero() };
    for k in 1i64.. {
        if stop.asked() {
            return None;
        }
        weight = balls.mul(&weight, &square);
        // (2k)(2k + 1) is never zero.
        weight =
            balls.div_i64(&weight, 2 * k * (2 * k + 1)).unwrap_or_else(|| balls.indeterminate());
        let power = rug::Integer::from(k);
        let power = rug::ops::Pow::pow(power, u32::from(n));
        let mut term = balls.mul_rational(&weight, &Rational::from(power));
        if k % 2 == 1 {
            term = balls.neg(&term);
        }
        // Ratio of consecutive terms: a^2 (1 + 1/k)^n/((2k+2)(2k+3)) < 1/2 once k > n and
        // 2 e a^2 < (2k+2)^2.
        let decreasing = k > i64::from(n)
            && balls.mul_i64(&square, 6).abs_upper() < (2 * k + 2).saturating_mul(2 * k + 2);
        let size = term.abs_upper();
        if !size.is_finite() {
            return Some(balls.indeterminate());
        }
        let negligible = size.is_zero()
            || sum.midpoint().get_exp().unwrap_or(0) - size.get_exp().unwrap_or(0)
                > balls.bits() as i32 + 8;
        if decreasing && negligible {
            // term + rest <= 2 size.
            let rest = balls.from_parts(&size, &rug::Float::new(53));
            return Some(balls.add_error(&sum, &balls.mul_i64(&rest, 2).abs_upper()));
        }
        sum = balls.add(&sum, &term);
    }
    Some(sum)
}
