//! x'' + x (x^2)^delta = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    let stiffness = x.clone().pow(2).pow(Expression::Small);
    Problem::new("power-law", Expression::ACCELERATION + x * stiffness)
        .with_title("oscillator with a restoring force |x|^n of any exponent n = 1 + 2 delta")
        .with_small("delta")
        .under([Condition::InitialAmplitude], AmplitudeRole::ScalesFrequency { exponent: 2 })
        .with_parameter("n", "exponent of the force, n = 1 + 2 delta, n > -1", "3")
        .with_parameter("delta", "small parameter, delta = (n - 1)/2", "1")
        .with_parameter(
            "amplitude",
            "x(0) = a > 0, x'(0) = 0; x = a y multiplies omega^2 by a^(2 delta)",
            "1",
        )
        .with_notes(
            "m x'' + k x |x/d|^(2 delta) = 0 with time in sqrt(m/k) and length in d. \
             Even for odd forces: x (x^2)^delta is x^n for odd n and x |x|^(n-1) in general.",
        )
        .with_source("Awrejcewicz and Andrianov, section 4, equations (28)-(42)")
}
