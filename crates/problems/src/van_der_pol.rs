//! x'' - eps (1 - x^2) x' + x = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    let gain = 1 - x.clone().pow(2);
    Problem::new(
        "van-der-pol",
        Expression::ACCELERATION + x - Expression::Small * gain * Expression::VELOCITY,
    )
    .with_title("van der Pol's oscillator x'' - eps (1 - x^2) x' + x = 0, its limit cycle")
    .under([Condition::LimitCycle, Condition::FreeAmplitude], AmplitudeRole::Determined)
    .with_parameter("eps", "strength of the nonlinear damping, any sign", "1")
    .with_notes(
        "Phase x'(0) = 0; the amplitude x(0) is the largest displacement, determined order \
             by order. Time in the period of small oscillations over 2 pi.",
    )
    .with_source("C. M. Andersen and J. F. Geer, SIAM J. Appl. Math. 42 (1982) 678")
}
