//! Q(pi): quotients of polynomials in pi over Q. Pi is transcendental, so they are numbers and equal only where
//! they are equal as quotients: every question about them is decided.

use crate::equation::{Field, PI};
use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_coeff::constant;
use lindstedt_coeff::print::{Print, Style, Term, power, print_sum};
use lindstedt_equation::Expression;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Number, certified, rational};
use lindstedt_series::univariate::{common_divisor, divided, plus, product, scaled};
use rug::{Integer, Rational};
use std::cmp::Ordering;

/// The largest power of pi, or of a sum with it, in an equation.
const LARGEST_POWER: u32 = 64;

/// Coefficients of 1, pi, pi^2, ...; the last one is not zero.
type Polynomial = Vec<Rational>;

/// p/q: coprime, q monic; 0/1 for zero.
#[derive(Clone, Debug, PartialEq)]
pub struct InPi {
    numerator: Polynomial,
    denominator: Polynomial,
}

/// The field Q(pi). Cost: a sum or product of quotients of degree n takes O(n^2) operations on rational numbers, with the
/// greatest common divisor O(n^3) where the denominator is no power of pi.
#[derive(Clone, Copy, Debug, Default)]
pub struct PiField;

impl PiField {
    /// q pi^n.
    #[must_use]
    pub fn power(self, q: &Rational, n: i32) -> InPi {
        let mut high = vec![Rational::new(); n.unsigned_abs() as usize];
        high.push(1.into());
        let (over, under) = if n < 0 { (vec![1.into()], high) } else { (high, vec![1.into()]) };
        quotient(scaled(&over, q), under)
    }

    /// The number as a ball; nothing where the bits do not tell the denominator from zero.
    #[must_use]
    pub fn ball(self, a: &InPi, balls: Balls) -> Option<Ball> {
        let pi = balls.pi();
        let value = |p: &Polynomial| {
            let add = |sum, q: &Rational| balls.add(&balls.mul(&sum, &pi), &balls.from_rational(q));
            p.iter().rev().fold(balls.zero(), add)
        };
        balls.div(&value(&a.numerator), &value(&a.denominator))
    }
}

/// p/q in lowest terms; q is not zero.
fn quotient(p: Polynomial, q: Polynomial) -> InPi {
    if p.is_empty() {
        return InPi { numerator: p, denominator: vec![1.into()] };
    }
    // The power of pi first: mostly it is all.
    let zeros = |p: &Polynomial| p.iter().take_while(|c| c.is_zero()).count();
    let low = zeros(&p).min(zeros(&q));
    let (mut p, mut q) = (p[low..].to_vec(), q[low..].to_vec());
    if q.len() > zeros(&q) + 1 {
        let divisor = common_divisor(&p, &q);
        [p, q] = [p, q].map(|all| {
            let [over, _] = divided(&all, &divisor);
            over
        });
    }
    let inverse = q.last().map_or_else(|| 1.into(), |leading| Rational::from(leading.recip_ref()));
    InPi { numerator: scaled(&p, &inverse), denominator: scaled(&q, &inverse) }
}

impl Ring for PiField {
    type Element = InPi;

    fn zero(&self) -> InPi {
        self.rational(&Rational::new())
    }
    fn one(&self) -> InPi {
        self.rational(&1.into())
    }
    fn is_zero(&self, a: &InPi) -> bool {
        a.numerator.is_empty()
    }
    fn add_assign(&self, a: &mut InPi, b: &InPi) {
        if b.numerator.is_empty() {
            return;
        }
        let over = if a.denominator == b.denominator {
            (plus(a.numerator.clone(), &b.numerator), a.denominator.clone())
        } else {
            let crossed = product(&a.numerator, &b.denominator);
            let over = plus(crossed, &product(&b.numerator, &a.denominator));
            (over, product(&a.denominator, &b.denominator))
        };
        *a = quotient(over.0, over.1);
    }
    fn neg(&self, a: &InPi) -> InPi {
        self.scale(a, &Rational::from(-1))
    }
    fn mul(&self, a: &InPi, b: &InPi) -> InPi {
        let over = product(&a.numerator, &b.numerator);
        quotient(over, product(&a.denominator, &b.denominator))
    }
}

impl RationalAlgebra for PiField {
    fn rational(&self, q: &Rational) -> InPi {
        let numerator = if q.is_zero() { Vec::new() } else { vec![q.clone()] };
        InPi { numerator, denominator: vec![1.into()] }
    }
    fn scale(&self, a: &InPi, q: &Rational) -> InPi {
        if q.is_zero() {
            return self.zero();
        }
        InPi { numerator: scaled(&a.numerator, q), denominator: a.denominator.clone() }
    }
    fn reciprocal(&self, a: &InPi) -> Option<InPi> {
        (!self.is_zero(a)).then(|| quotient(a.denominator.clone(), a.numerator.clone()))
    }
    fn as_rational(&self, a: &InPi) -> Option<Rational> {
        match (&a.numerator[..], &a.denominator[..]) {
            ([], _) => Some(Rational::new()),
            ([q], [_]) => Some(q.clone()),
            _ => None,
        }
    }
}

impl Field for PiField {
    /// Of multiples of pi/2.
    fn turn(&self, angle: &InPi) -> Option<[InPi; 2]> {
        let quarters = self.mul(angle, &self.power(&2.into(), -1));
        let quarters = self.as_rational(&quarters).filter(Rational::is_integer)?;
        let of = |n: u32| {
            let place = Integer::from(quarters.numer() + n).mod_u(4);
            self.rational(&[1, 0, -1, 0][place as usize % 4].into())
        };
        // sin x = cos(x - pi/2).
        Some([of(0), of(3)])
    }

    fn constant(&self, e: &Expression) -> Option<InPi> {
        let high = |e: &Expression| match e {
            Expression::Power(_, n) => n.as_number().is_none_or(|n| n.abs() > LARGEST_POWER),
            _ => false,
        };
        let pi = |name: &str| (name == PI).then(|| self.power(&1.into(), 1));
        if e.nodes().any(high) { None } else { constant(self, e, &pi) }
    }

    fn number(&self, a: &InPi, digits: usize) -> Option<Number> {
        if let Some(q) = self.as_rational(a) {
            return rational(&q, digits).ok();
        }
        certified(Some(self.print(a, Style::Text)), digits, |balls| self.ball(a, balls)).ok()
    }

    fn sign(&self, a: &InPi) -> Option<Ordering> {
        if self.is_zero(a) {
            return Some(Ordering::Equal);
        }
        let decided = |bits: u32| {
            let ball = self.ball(a, Balls::new(bits))?;
            let sign = if ball.is_positive() { Ordering::Greater } else { Ordering::Less };
            (!ball.contains_zero()).then_some(sign)
        };
        (7..=16).find_map(|k| decided(1 << k))
    }
}

/// sum_k c_k pi^(k - shift), the highest power first.
fn terms(p: &Polynomial, shift: usize, style: Style) -> Vec<Term> {
    let pi = if style == Style::Text { PI } else { r"\pi" };
    let term = |(k, c): (usize, &Rational)| {
        let exponent = k as i64 - shift as i64;
        let factors = (exponent != 0).then(|| power(pi, exponent, style)).into_iter().collect();
        Term { coefficient: c.clone(), factors }
    };
    p.iter().enumerate().rev().filter(|(_, c)| !c.is_zero()).map(term).collect()
}

/// The factor that makes the coefficients of both integers without a common divisor.
fn primitive(p: &Polynomial, q: &Polynomial) -> Rational {
    let all = || p.iter().chain(q).filter(|c| !c.is_zero());
    let low = all().fold(Integer::from(1), |low, c| low.lcm(c.denom()));
    let common = all().fold(Integer::new(), |common, c| {
        common.gcd(&(Integer::from(&low / c.denom()) * c.numer()))
    });
    Rational::from((low, common))
}

impl Print for PiField {
    fn print_terms(&self, a: &InPi, style: Style) -> Vec<Term> {
        let degree = a.denominator.len() - 1;
        if a.denominator[..degree].iter().all(Rational::is_zero) {
            return terms(&a.numerator, degree, style);
        }
        // Over integers without a common factor; the sign stands in front of a single term.
        let scale = primitive(&a.numerator, &a.denominator);
        let [over, under] =
            [&a.numerator, &a.denominator].map(|p| terms(&scaled(p, &scale), 0, style));
        let negative = matches!(&over[..], [only] if only.coefficient < 0);
        let over: Vec<Term> = if negative {
            let minus = |t: Term| Term { coefficient: -t.coefficient, ..t };
            over.into_iter().map(minus).collect()
        } else {
            over
        };
        let (single, under) = (over.len() == 1, print_sum(&under, style));
        let over = print_sum(&over, style);
        let whole = match style {
            Style::Text if single => format!("{over}/({under})"),
            Style::Text => format!("({over})/({under})"),
            Style::Latex => format!(r"\frac{{{over}}}{{{under}}}"),
        };
        let coefficient = Rational::from(if negative { -1 } else { 1 });
        vec![Term { coefficient, factors: vec![whole] }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::laws;

    #[test]
    fn laws_hold_and_values_agree() {
        let field = PiField;
        let pi = field.power(&1.into(), 1);
        let low = field.add(&pi, &field.rational(&(-3).into()));
        let wide = field.mul(&field.reciprocal(&low).unwrap(), &field.power(&(2, 7).into(), -2));
        let samples = [field.zero(), field.one(), pi, low.clone(), wide.clone()];
        assert_eq!(laws::rational_algebra(&field, &samples), Ok(()));
        // 1/(pi - 3) 2/(7 pi^2), by balls.
        let balls = Balls::new(200);
        let exact = field.mul(&wide, &field.power(&1.into(), 2));
        let back = field.mul(&exact, &low);
        assert_eq!(field.as_rational(&back), Some((2, 7).into()));
        let pi = std::f64::consts::PI;
        let value = field.ball(&wide, balls).unwrap().midpoint().to_f64();
        assert!((value - 2.0 / 7.0 / pi / pi / (pi - 3.0)).abs() < 1e-13);
        assert_eq!(field.print(&wide, Style::Text), "2/(7*pi^3 - 21*pi^2)");
    }

    #[test]
    fn quarter_turns() {
        let field = PiField;
        let turn = |q: (i32, i32)| {
            let found = field.turn(&field.power(&q.into(), 1))?;
            Some(found.map(|part| field.as_rational(&part).unwrap().to_f64()))
        };
        assert_eq!(turn((1, 2)), Some([0.0, 1.0]));
        assert_eq!(turn((-1, 2)), Some([0.0, -1.0]));
        assert_eq!(turn((-5, 1)), Some([-1.0, 0.0]));
        assert_eq!(turn((1, 3)), None);
        assert_eq!(field.turn(&field.one()), None);
    }
}
