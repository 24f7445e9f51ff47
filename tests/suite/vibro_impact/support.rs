//! Parameter sets and a generator.

use lindstedt_impact::parameters::{Branch, ExactParameters};
use rug::Rational;

/// Number, omega, k, R_r, s, c of the nine orbits without penetration; alpha = P0 = 1. The eighth
/// lies on the branch of the smaller impact velocity.
pub const ORBITS: [(&str, [&str; 5], Branch); 9] = [
    ("O1", ["13/5", "1", "4/5", "0", "1/20"], Branch::Plus),
    ("O2", ["13/5", "2", "2/5", "1/5", "1/20"], Branch::Plus),
    ("O3", ["33/10", "1", "3/5", "-1/5", "1/5"], Branch::Plus),
    ("O4", ["2", "1", "4/5", "-1/5", "1/10"], Branch::Plus),
    ("O5", ["33/10", "2", "4/5", "0", "1/20"], Branch::Plus),
    ("O6", ["22/5", "2", "4/5", "-1/5", "1/10"], Branch::Plus),
    ("O7", ["4/5", "1", "4/5", "1/2", "1/20"], Branch::Plus),
    ("O8", ["22/5", "3", "4/5", "1/2", "1/10"], Branch::Minus),
    ("O9", ["13/10", "1", "4/5", "1/5", "1/20"], Branch::Plus),
];

/// An orbit with the gains A and B.
pub fn parameters(index: usize, gains: [Rational; 2]) -> ExactParameters {
    let (_, values, branch) = ORBITS[index];
    let [omega, k, restitution, wall, damping] =
        values.map(|text| text.parse::<Rational>().unwrap());
    let [a, b] = gains;
    ExactParameters {
        alpha: Rational::from(1).into(),
        omega: omega.into(),
        periods: k.numer().to_u32().unwrap(),
        restitution: restitution.into(),
        wall: wall.into(),
        damping: damping.into(),
        force: Rational::from(1).into(),
        displacement_gain: a.into(),
        velocity_gain: b.into(),
        branch,
    }
}
