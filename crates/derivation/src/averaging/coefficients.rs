//! The rings of coefficients of an averaged expansion: numbers or parameters.

use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{PolynomialRing, Symbol};
use lindstedt_equation::classify::rational_root;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::amplitudes::scalars::{Integers, Over, Scalars};
use rug::Rational;
use std::cmp::Ordering;

/// What is asked of a ring of coefficients besides its operations.
pub(super) trait Coefficients: RationalAlgebra + Clone {
    /// What polynomials in amplitudes compute with.
    type Scalars: Scalars<Number = Self::Element>;
    /// The numerators of the ring.
    fn scalars(&self) -> Self::Scalars;
    /// The positive square root, where the ring has it.
    fn square_root(&self, a: &Self::Element) -> Option<Self::Element>;
    /// Whether a is positive, zero or negative, where that is known.
    fn sign(&self, a: &Self::Element) -> Option<Ordering>;
    /// cos x, sin x for the angle x = rate * time.
    fn turn(&self, rate: &Self::Element, time: &Self::Element) -> Option<[Self::Element; 2]>;
}

impl Coefficients for Rationals {
    type Scalars = Integers;

    fn scalars(&self) -> Integers {
        Integers
    }
    fn square_root(&self, a: &Rational) -> Option<Rational> {
        rational_root(a)
    }
    fn sign(&self, a: &Rational) -> Option<Ordering> {
        Some(a.cmp0())
    }
    /// Cosine and sine of a rational number other than zero are irrational.
    fn turn(&self, rate: &Rational, time: &Rational) -> Option<[Rational; 2]> {
        (rate.is_zero() || time.is_zero()).then(|| [Rational::from(1), Rational::new()])
    }
}

impl Coefficients for BallRing {
    type Scalars = Over<Self>;

    fn scalars(&self) -> Over<Self> {
        Over::exact(*self)
    }
    fn square_root(&self, a: &Enclosure) -> Option<Enclosure> {
        a.0.is_positive().then(|| self.balls.sqrt(&a.0).map(Enclosure)).flatten()
    }
    fn sign(&self, a: &Enclosure) -> Option<Ordering> {
        sign(&a.0)
    }
    fn turn(&self, rate: &Enclosure, time: &Enclosure) -> Option<[Enclosure; 2]> {
        let angle = self.balls.mul(&rate.0, &time.0);
        Some([Enclosure(self.balls.cos(&angle)), Enclosure(self.balls.sin(&angle))])
    }
}

impl Coefficients for ParameterField {
    type Scalars = Over<Self>;

    fn scalars(&self) -> Over<Self> {
        Over::exact(self.clone())
    }
    /// Of q s_1^(2 n_1) ...: the parameters are taken to be positive.
    fn square_root(&self, a: &ParameterFraction) -> Option<ParameterFraction> {
        let [(monomial, coefficient)] = a.numerator().terms() else { return None };
        if !a.denominator().is_empty() {
            return None;
        }
        let mut root = self.rational(&Rationals.square_root(coefficient)?);
        for &(symbol, exponent) in monomial.factors() {
            let Symbol::Parameter(index) = symbol else { return None };
            let base = self.parameter(index);
            let base = if exponent > 0 { base } else { self.reciprocal(&base)? };
            for _ in 0..exponent.unsigned_abs() / 2 {
                root = self.mul(&root, &base);
            }
            if exponent % 2 != 0 {
                return None;
            }
        }
        Some(root)
    }
    /// Of what no parameter but pi stands in.
    fn sign(&self, a: &ParameterFraction) -> Option<Ordering> {
        let ring = BallRing { balls: Balls::new(SIGN_BITS) };
        let known =
            |i: u16| self.ring.parameters.get(usize::from(i)).is_some_and(|name| name == "pi");
        let mut open = false;
        let value = self.evaluate(&ring, a, |i| {
            open |= !known(i);
            Enclosure(ring.balls.pi())
        })?;
        sign(&value.0).filter(|_| !open)
    }
    /// The pair of parameters named after the angle, where there is one.
    fn turn(
        &self,
        rate: &ParameterFraction,
        time: &ParameterFraction,
    ) -> Option<[ParameterFraction; 2]> {
        let angle = self.mul(rate, time);
        if self.is_zero(&angle) {
            return Some([self.one(), self.zero()]);
        }
        let [cos, sin] = pair_names(self, &angle).map(|name| self.position(&name));
        Some([self.parameter(cos?), self.parameter(sin?)])
    }
}

/// Bits of the enclosure that gives the sign of a polynomial in pi.
const SIGN_BITS: u32 = 400;

fn sign(ball: &Ball) -> Option<Ordering> {
    match ball {
        ball if ball.lower() > 0 => Some(Ordering::Greater),
        ball if ball.upper() < 0 => Some(Ordering::Less),
        ball => (ball.is_exact() && ball.contains_zero()).then_some(Ordering::Equal),
    }
}

/// The names of the sine and cosine of an angle.
fn pair_names(field: &ParameterField, angle: &ParameterFraction) -> [String; 2] {
    let angle = field.print(angle, Style::Text);
    [format!("cos({angle})"), format!("sin({angle})")]
}

/// The field with a pair of parameters for every angle (zero angles and repetitions are skipped).
pub(super) fn with_angles(field: &ParameterField, angles: &[ParameterFraction]) -> ParameterField {
    let mut parameters = field.ring.parameters.clone();
    let mut pairs = field.pairs.clone();
    for angle in angles.iter().filter(|angle| !field.is_zero(angle)) {
        let names = pair_names(field, angle);
        if parameters.contains(&names[0]) {
            continue;
        }
        let position = u16::try_from(parameters.len()).unwrap_or(u16::MAX);
        parameters.extend(names);
        pairs.push((position, position.saturating_add(1)));
    }
    ParameterField { ring: PolynomialRing { parameters }, pairs, affine: field.affine }
}
