//! The start on the periodic impact orbit of the vibro-impact oscillator.

use super::setup::{Setup, identity};
use crate::failure::{Failure, NO_ANSWER};
use crate::stability::exact_parameters;
use lindstedt::Exact;
use lindstedt::equation::Expression;
use lindstedt::equation::Function::{Cos, Exp, Sin};
use lindstedt::equation::Problem;
use lindstedt::number::real::Real as _;
use lindstedt::simulate::{Digits, Model, Parameters, Quantity, Real as _};
use lindstedt_impact::flight::clearance;
use lindstedt_impact::orbit::orbit;
use rug::{Float, Rational};

/// The equation with t + psi/omega for t.
fn advanced(e: &Expression) -> Expression {
    let change = |e: &Expression| {
        let omega = || Expression::parameter("omega").pow(-1);
        (*e == Expression::Time).then(|| Expression::Time + Expression::parameter("psi") * omega())
    };
    e.substitute(&change)
}

/// Just after an impact, with the orbit as history; `problem` is the vibro-impact oscillator.
pub fn on_orbit(
    problem: &Problem,
    set: &[String],
    perturbation: Option<&Rational>,
    digits: u32,
) -> Result<Setup, Failure> {
    let (exact, at) = exact_parameters(set)?;
    let bits = Digits::for_digits(digits + 40).bits();
    let p = exact.certified(bits);
    let real = |x: &lindstedt::number::real::Certified| Float::with_val(bits, x.ball().midpoint());
    let mut parameters = Parameters::new().with(&problem.small, 1);
    for (name, text) in at.iter().filter(|(name, _)| name != "branch") {
        parameters.set(name, Exact::parse(text)?);
    }
    let period = real(&p.period());
    parameters.set("T", period.clone());
    let (alpha, omega, c) = (real(&p.alpha), real(&p.omega), real(&p.damping));
    let rate = Float::with_val(bits, -&c) / 2u32;
    let square = alpha.square() - Float::with_val(bits, rate.square_ref());
    let amplitude = real(&p.forced_amplitude());
    if square <= 0 || !amplitude.is_finite() {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-history",
            message: "the history is written for c < 2 alpha away from undamped resonance".into(),
            hint: "change c, alpha or omega".into(),
        });
    }
    let w = square.sqrt();
    let orbit = orbit(&p).map_err(lindstedt::Error::from)?;
    if let Ok(Some(found)) = clearance(&p, &orbit)
        && found.margin.is_positive()
    {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-orbit",
            message: "no orbit: the flight passes through the wall".into(),
            hint: "give a start with --state".into(),
        });
    }
    let (velocity, restitution) = (real(&orbit.velocity), real(&p.restitution));
    let [x, mut v] = [real(&p.wall), -(restitution * &velocity)];
    let psi = real(&orbit.force_angle());
    let phi = Float::with_val(bits, &psi - &real(&p.phase_lag()));
    let (sin, cos) = phi.clone().sin_cos(Float::new(bits));
    // x = F cos(omega t + phi) + e^(r t) (C cos W t + D sin W t), r = -c/2.
    let first = Float::with_val(bits, &x - Float::with_val(bits, &amplitude * &cos));
    let forced = Float::with_val(bits, &amplitude * &omega) * &sin;
    let second = (Float::with_val(bits, &v + &forced) - Float::with_val(bits, &rate * &first)) / &w;
    let named = [
        ("F", amplitude),
        ("phi", phi),
        ("psi", psi),
        ("C", first),
        ("D", second),
        ("W", w),
        ("R", rate),
    ];
    for (name, value) in named {
        parameters.set(name, value);
    }
    let symbol = Expression::parameter;
    // The flight before t = 0 began one period earlier.
    let since = || Expression::Time + symbol("T");
    let free = symbol("C") * (symbol("W") * since()).apply(Cos)
        + symbol("D") * (symbol("W") * since()).apply(Sin);
    let angle = symbol("omega") * Expression::Time + symbol("phi");
    let history = symbol("F") * angle.apply(Cos) + (symbol("R") * since()).apply(Exp) * free;
    let mut shifted = problem.clone();
    shifted.equation = advanced(&problem.equation);
    let model = Model::of_problem(&shifted)?.with_history(std::slice::from_ref(&history));
    if let Some(delta) = perturbation {
        v += Float::with_val(bits, &velocity * delta);
    }
    let forcing = Float::with_val(bits, rug::float::Constant::Pi) * 2u32 / &omega;
    Ok(Setup {
        identity: identity(problem, Some(&history)),
        name: problem.name.to_string(),
        model,
        parameters,
        at,
        start: [Quantity::Float(x), Quantity::Float(v)],
        forcing: Some(Quantity::Float(forcing)),
        frequency: None,
        wall: true,
        linear: false,
        sticks: false,
        orbit: Some((period, velocity)),
        // The orbit does not depend on the gains.
        sweepable: vec!["A".into(), "B".into()],
        fixed: Vec::new(),
        ranges: std::collections::BTreeMap::new(),
        remarks: vec![
            "start and history: the periodic orbit, t = 0 just after an impact".to_owned(),
        ],
    })
}
