//! What rational numbers are whole multiples of.

use rug::{Integer, Rational};

/// The largest rational number of which both are whole multiples, gcd of numerators over lcm of denominators; of 0 and q, |q|.
///
/// ```
/// use lindstedt_algebra::common_measure;
/// use rug::Rational;
///
/// let [p, q] = [(3, 4), (-5, 6)].map(Rational::from);
/// assert_eq!(common_measure(&p, &q), Rational::from((1, 12)));
/// assert_eq!(common_measure(&Rational::new(), &q), Rational::from((5, 6)));
/// ```
#[must_use]
pub fn common_measure(p: &Rational, q: &Rational) -> Rational {
    let numerator = Integer::from(p.numer().gcd_ref(q.numer()));
    Rational::from((numerator, Integer::from(p.denom().lcm_ref(q.denom()))))
}
