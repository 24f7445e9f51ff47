//! Polynomials in pi.

use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// c_0 + c_1 pi + c_2 pi^2 + ... with rational coefficients, without trailing zeros.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PiPolynomial {
    /// c_0, c_1, ...
    pub coefficients: Vec<Rational>,
}

impl PiPolynomial {
    /// An enclosure at the precision of the context.
    #[must_use]
    pub fn ball(&self, balls: Balls) -> Ball {
        let pi = balls.pi();
        self.coefficients
            .iter()
            .rev()
            .fold(balls.zero(), |sum, c| balls.add(&balls.mul(&sum, &pi), &balls.from_rational(c)))
    }
}
