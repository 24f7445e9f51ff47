//! x'' + sin x = 0, embedded in the small-delta method.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, Function, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    let exponent = Expression::Small * x.clone().pow(2).ln();
    // S(z) = sin(a e^(z/2))/(a e^(z/2)), and e^(z/2) = (y^2)^(delta/2) = stretch.
    let half = Expression::Number(rug::Rational::from((1, 2)));
    let stretch = x.clone().pow(2).pow(Expression::Small * half);
    let angle = Expression::parameter("amplitude") * stretch;
    let force = x.clone() * angle.clone().apply(Function::Sin) * angle.pow(-1);
    Problem::new("pendulum", Expression::ACCELERATION + x * exponent.formal("S"))
        .with_title("mathematical pendulum x'' + sin x = 0 by the small-delta method (delta = 1)")
        .with_small("delta")
        .under([Condition::InitialAmplitude], AmplitudeRole::InSums)
        .with_time_domain(Expression::ACCELERATION + force)
        .with_parameter(
            "amplitude",
            "x(0) = a in radians, 0 < a < pi, x'(0) = 0; enters through the sums S_n",
            "1",
        )
        .with_parameter("delta", "small parameter; delta = 1 is the pendulum", "1")
        .with_notes(
            "x = a y turns sin x into a y sum_k (-1)^k a^(2k) (y^2)^k/(2k+1)!. Replacing the \
             exponent k by k delta gives y S(delta ln y^2) with S(z) = sum_n S_n z^n/n! and \
             S_n = sum_k (-1)^k a^(2k) k^n/(2k+1)!; S_0 = sin(a)/a. Time in sqrt(length/g).",
        )
        .with_source("Awrejcewicz and Andrianov, section 4, equations (43)-(51)")
}
