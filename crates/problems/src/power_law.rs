//! x'' + x (x^2)^delta = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, ParameterCard, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    let stiffness = x.clone().pow(2).pow(Expression::Small);
    Problem {
        name: "power-law".into(),
        title: "oscillator with a restoring force |x|^n of any exponent n = 1 + 2 delta".into(),
        equation: Expression::ACCELERATION + x * stiffness,
        time_domain: None,
        impact: None,
        synchronous: None,
        small: "delta".into(),
        conditions: vec![Condition::InitialAmplitude],
        amplitude: AmplitudeRole::ScalesFrequency { exponent: 2 },
        parameters: vec![
            ParameterCard {
                name: "n".into(),
                meaning: "exponent of the force, n = 1 + 2 delta, n > -1".into(),
                default: "3".into(),
            },
            ParameterCard {
                name: "delta".into(),
                meaning: "small parameter, delta = (n - 1)/2".into(),
                default: "1".into(),
            },
            ParameterCard {
                name: "amplitude".into(),
                meaning: "x(0) = a > 0, x'(0) = 0; x = a y multiplies omega^2 by a^(2 delta)"
                    .into(),
                default: "1".into(),
            },
        ],
        notes: "m x'' + k x |x/d|^(2 delta) = 0 with time in sqrt(m/k) and length in d. \
                Even for odd forces: x (x^2)^delta is x^n for odd n and x |x|^(n-1) in general."
            .into(),
        source: "Awrejcewicz and Andrianov, section 4, equations (28)-(42)".into(),
    }
}
