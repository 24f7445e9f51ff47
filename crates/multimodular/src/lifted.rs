//! What is proved of one order.

use lindstedt_phase::trigonometric::TrigonometricPolynomial;
use rug::Rational;

/// One order over Q, in lowest terms.
pub(crate) struct Lifted {
    /// W_n, omega_n, T_n.
    pub series: [Rational; 3],
    pub amplitude: Rational,
    pub solution: TrigonometricPolynomial<Rational>,
}
