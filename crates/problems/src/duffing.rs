//! x'' + x + rho x^3 = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    Problem::new("duffing", Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3))
        .with_title("Duffing oscillator x'' + x + eps x^3 = 0, in rho = eps A^2")
        .with_small("rho")
        .under(
            [
                Condition::InitialAmplitude,
                Condition::FundamentalAmplitude,
                Condition::FreeAmplitude,
            ],
            AmplitudeRole::InSmallParameter,
        )
        .with_parameter("eps", "coefficient of the cubic force, any sign", "1")
        .with_parameter(
            "amplitude",
            "A: x(0), or the first harmonic with --normalisation fundamental",
            "1",
        )
        .with_notes(
            "m x'' + k x + k_3 x^3 = 0 with time in sqrt(m/k) and eps = k_3/k; x = A y gives \
             y'' + y + rho y^3 = 0 with rho = eps A^2. The coefficients depend on what A is.",
        )
        .with_source("classical; initial-amplitude series converges for |rho| < 1")
}
