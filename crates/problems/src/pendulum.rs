//! x'' + sin x = 0, embedded in the small-delta method.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, ParameterCard, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::Displacement;
    let exponent = Expression::Small * x.clone().pow(2).ln();
    Problem {
        name: "pendulum",
        title: "mathematical pendulum x'' + sin x = 0 by the small-delta method (delta = 1)",
        equation: Expression::Acceleration + x * exponent.formal("S"),
        small: "delta",
        conditions: vec![Condition::InitialAmplitude],
        amplitude: AmplitudeRole::InSums,
        parameters: vec![
            ParameterCard {
                name: "amplitude",
                meaning: "x(0) = a in radians, 0 < a < pi, x'(0) = 0; enters through the sums S_n",
                default: "1",
            },
            ParameterCard {
                name: "delta",
                meaning: "small parameter; delta = 1 is the pendulum",
                default: "1",
            },
        ],
        notes: "x = a y turns sin x into a y sum_k (-1)^k a^(2k) (y^2)^k/(2k+1)!. Replacing the \
                exponent k by k delta gives y S(delta ln y^2) with S(z) = sum_n S_n z^n/n! and \
                S_n = sum_k (-1)^k a^(2k) k^n/(2k+1)!; S_0 = sin(a)/a. Time in sqrt(length/g).",
        source: "Awrejcewicz and Andrianov, section 4, equations (43)-(51)",
    }
}
