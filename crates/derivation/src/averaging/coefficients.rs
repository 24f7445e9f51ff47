//! The rings of coefficients of an averaged expansion: numbers or parameters.

use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{PolynomialRing, Symbol};
use lindstedt_equation::classify::rational_root;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_phase::amplitudes::scalars::{Integers, Over, Scalars};
use rug::Rational;

/// What is asked of a ring of coefficients besides its operations.
pub(super) trait Coefficients: RationalAlgebra + Clone {
    /// What polynomials in amplitudes compute with.
    type Scalars: Scalars<Number = Self::Element>;
    /// The numerators of the ring.
    fn scalars(&self) -> Self::Scalars;
    /// The positive square root, where the ring has it.
    fn square_root(&self, a: &Self::Element) -> Option<Self::Element>;
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
