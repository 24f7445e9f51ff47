//! x'' - eps (1 - x^2) x' + x = 0.

use lindstedt_equation::{AmplitudeRole, Condition, Expression, ParameterCard, Problem};

pub(crate) fn problem() -> Problem {
    let x = Expression::DISPLACEMENT;
    let gain = 1 - x.clone().pow(2);
    Problem {
        name: "van-der-pol".into(),
        title: "van der Pol's oscillator x'' - eps (1 - x^2) x' + x = 0, its limit cycle".into(),
        equation: Expression::ACCELERATION + x - Expression::Small * gain * Expression::VELOCITY,
        time_domain: None,
        impact: None,
        synchronous: None,
        small: "eps".into(),
        conditions: vec![Condition::LimitCycle, Condition::FreeAmplitude],
        amplitude: AmplitudeRole::Determined,
        parameters: vec![ParameterCard {
            name: "eps".into(),
            meaning: "strength of the nonlinear damping, any sign".into(),
            default: "1".into(),
        }],
        notes: "Phase x'(0) = 0; the amplitude x(0) is the largest displacement, determined order \
                by order. Time in the period of small oscillations over 2 pi."
            .into(),
        source: "C. M. Andersen and J. F. Geer, SIAM J. Appl. Math. 42 (1982) 678".into(),
    }
}
