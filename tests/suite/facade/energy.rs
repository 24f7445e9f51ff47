//! The energy integral: period against frequency.

use lindstedt::unstable::algebra::{Ring, Stop};
use lindstedt::unstable::coeff::PolynomialRing;
use lindstedt::unstable::derivation::energy::{period_over_2pi, power_law_frequency};
use lindstedt::unstable::series::Series;
use rug::Rational;

#[test]
fn the_two_forms_agree() {
    let ring = PolynomialRing::default();
    let ones = vec![ring.one(); 9];
    let period = period_over_2pi(&ring, &ones, 8, &Stop::default());
    let squared = period.and_then(|p| Series::truncated(p).power(&ring, &Rational::from(-2)));
    let direct = |p| power_law_frequency(&ring, p, 8, &Stop::default()).unwrap();
    assert_eq!(squared.map(|s| s.coefficients), Some(direct(2)));
    let frequency = Series::truncated(direct(1));
    let period = Series::truncated(direct(-1));
    let one = frequency.mul(&ring, &period, 8).coefficients;
    assert!(one[0] == ring.one() && one[1..].iter().all(|c| ring.is_zero(c)));
}
