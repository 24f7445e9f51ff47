//! x'' + x + rho x^3 = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, ParameterCard, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    Problem {
        name: "duffing".into(),
        title: "Duffing oscillator x'' + x + eps x^3 = 0, in rho = eps A^2".into(),
        equation: Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3),
        time_domain: None,
        impact: None,
        synchronous: None,
        small: "rho".into(),
        conditions: vec![
            Condition::InitialAmplitude,
            Condition::FundamentalAmplitude,
            Condition::FreeAmplitude,
        ],
        amplitude: AmplitudeRole::InSmallParameter,
        parameters: vec![
            ParameterCard {
                name: "eps".into(),
                meaning: "coefficient of the cubic force, any sign".into(),
                default: "1".into(),
            },
            ParameterCard {
                name: "amplitude".into(),
                meaning: "A: x(0), or the first harmonic with --normalisation fundamental".into(),
                default: "1".into(),
            },
        ],
        notes: "m x'' + k x + k_3 x^3 = 0 with time in sqrt(m/k) and eps = k_3/k; x = A y gives \
                y'' + y + rho y^3 = 0 with rho = eps A^2. The coefficients depend on what A is."
            .into(),
        source: "classical; initial-amplitude series converges for |rho| < 1".into(),
    }
}
