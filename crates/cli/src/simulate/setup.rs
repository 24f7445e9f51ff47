//! What is integrated: the problem's equation with values, start and history.

use crate::failure::{Failure, NO_ANSWER};
use crate::session::{parameters, problem};
use crate::stability::request::exact_parameters;
use lindstedt::Value;
use lindstedt::equation::Function::{Cos, Exp, Sin};
use lindstedt::equation::{Expression, ParameterCard, Problem};
use lindstedt::problems::{stick_slip, vibro_impact};
use lindstedt::simulate::{Digits, Model, Parameters, Quantity, Real};
use lindstedt::verify::quantity;
use lindstedt_impact::flight::clearance;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::real::Real as _;
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// A problem in the time domain.
pub struct Setup {
    pub name: String,
    pub model: Model,
    pub parameters: Parameters,
    /// Every parameter as it stands, in the order of the data card.
    pub at: Vec<(String, String)>,
    /// x(0), x'(0).
    pub start: [Quantity; 2],
    /// The period of the force.
    pub forcing: Option<Quantity>,
    /// A wall bounds the motion.
    pub wall: bool,
    /// Dry friction makes the body stick.
    pub sticks: bool,
    /// Period and impact velocity of the periodic impact orbit that the motion starts on.
    pub orbit: Option<(Float, Float)>,
    /// Parameters that can be swept (nothing else depends on them).
    pub sweepable: Vec<&'static str>,
    /// What was chosen, in words.
    pub remarks: Vec<String>,
}

fn integer(n: i64) -> Quantity {
    Quantity::from(n)
}

type Given = BTreeMap<String, Value>;

/// All parameters of a card: given, or by default.
fn values(cards: &[ParameterCard], given: &Given) -> Result<Vec<(String, Value)>, Failure> {
    let known = |name: &String| cards.iter().any(|card| card.name == *name);
    if let Some(name) = given.keys().find(|name| !known(name)) {
        let names: Vec<&str> = cards.iter().map(|card| &*card.name).collect();
        let message = format!("there is no parameter {name:?}");
        let hint = format!("it has {}", names.join(", "));
        return Err(Failure::usage("unknown-parameter", message, &hint));
    }
    let value = |card: &ParameterCard| match given.get(&*card.name) {
        Some(value) => Ok((card.name.to_string(), value.clone())),
        None => Ok((card.name.to_string(), Value::parse(&card.default)?)),
    };
    cards.iter().map(value).collect()
}

impl Setup {
    /// Reads a problem; numbers that are computed have `digits` digits and some more.
    pub fn read(
        name: &str,
        set: &[String],
        state: Option<[Quantity; 2]>,
        perturbation: Option<&Rational>,
        digits: u32,
    ) -> Result<Self, Failure> {
        let mut setup = if name == vibro_impact::problem().name {
            return impact_oscillator(set, state, perturbation, digits);
        } else if name == stick_slip::problem().name {
            belt(&parameters(set)?)?
        } else {
            smooth(&of_file(problem(name)?, name)?, &parameters(set)?)?
        };
        if perturbation.is_some() {
            let message = format!("{name} has no periodic impact orbit to perturb");
            return Err(Failure::usage("perturb", message, "use --state"));
        }
        setup.start = state.unwrap_or(setup.start);
        Ok(setup)
    }
}

/// A problem of a file: its small parameter can be set, 1 by default; nothing of it is ignored.
fn of_file(mut problem: Problem, name: &str) -> Result<Problem, Failure> {
    if lindstedt::problems::find(name).is_some() {
        return Ok(problem);
    }
    if problem.impact.is_some() {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-method",
            message: "a wall in a problem file is not simulated yet".into(),
            hint: "the built-in vibro-impact oscillator has one".into(),
        });
    }
    if problem.parameters.iter().all(|card| card.name != problem.small) {
        let (name, meaning) = (problem.small.clone(), "small parameter".into());
        problem.parameters.push(ParameterCard { name, meaning, default: "1".into() });
    }
    Ok(problem)
}

fn shown(at: &[(String, Value)]) -> Vec<(String, String)> {
    at.iter().map(|(name, value)| (name.clone(), value.to_string())).collect()
}

fn bound(at: &[(String, Value)]) -> Parameters {
    let mut parameters = Parameters::new();
    for (name, value) in at {
        parameters.set(name, quantity(value));
    }
    parameters
}

/// The stick-slip oscillator, from (1/10, 0): the attractor that sticks, with the paper's parameters;
/// most other starts come to the small orbit of one period about the right well.
fn belt(given: &Given) -> Result<Setup, Failure> {
    let at = values(&stick_slip::problem().parameters, given)?;
    let omega = at.iter().find(|(name, _)| name == "omega").map(|(_, v)| quantity(v).float(4000));
    let omega = omega.filter(|x| *x > 0).ok_or_else(|| Failure {
        exit: NO_ANSWER,
        code: "outside-domain",
        message: "omega is outside its domain > 0".into(),
        hint: String::new(),
    })?;
    let pi = Float::with_val(4000, rug::float::Constant::Pi);
    Ok(Setup {
        name: "stick-slip".into(),
        model: Model::second_order(&stick_slip::equation())?.with_small("eps"),
        parameters: bound(&at),
        at: shown(&at),
        start: [Quantity::from(Rational::from((1, 10))), integer(0)],
        forcing: Some(Quantity::Float(pi * 2u32 / omega)),
        wall: false,
        sticks: true,
        orbit: None,
        sweepable: vec!["gamma", "a", "b", "T0", "alpha", "beta", "vstar", "eps"],
        remarks: Vec::new(),
    })
}

/// The problems of the expansion driver, for x itself: the driver's variable is x/amplitude.
fn smooth(problem: &Problem, given: &Given) -> Result<Setup, Failure> {
    // Domains as the expansions have them.
    lindstedt::check_parameters(problem, given)?;
    let mut at = values(&problem.parameters, given)?;
    // n = 1 + 2 delta: whichever is given determines the other.
    let rational = |name: &str| given.get(name).and_then(Value::as_rational).cloned();
    let linked = match (rational("n"), rational("delta")) {
        (Some(n), _) => Some((n.clone(), (n - 1u32) / 2u32)),
        (None, Some(delta)) => Some((Rational::from(&delta * 2u32) + 1u32, delta)),
        _ => None,
    };
    if let Some((n, delta)) = linked {
        for (name, value) in &mut at {
            match name.as_str() {
                "n" => *value = Value::Rational(n.clone()),
                "delta" => *value = Value::Rational(delta.clone()),
                _ => {}
            }
        }
    }
    let mut bindings = bound(&at);
    let find = |name: &str| at.iter().find(|(n, _)| n == name).map(|(_, v)| quantity(v));
    let one = Some(Rational::from(1));
    let equation = match &problem.time_domain {
        // At delta = 1 the pendulum's embedding is the pendulum.
        Some(_) if find("delta").and_then(|d| d.rational()) == one => {
            Expression::Acceleration + Expression::Displacement.apply(Sin)
        }
        Some(equation) => scaled(equation),
        None => problem.equation.clone(),
    };
    if let Some(eps) = find("eps") {
        // Duffing's rho = eps A^2 belongs to x/A; the coefficient for x is eps.
        bindings.set(&problem.small, eps);
    }
    let amplitude = find("amplitude").unwrap_or(integer(2));
    Ok(Setup {
        name: problem.name.to_string(),
        model: Model::second_order(&equation)?.with_small(&problem.small),
        parameters: bindings,
        at: shown(&at),
        start: [amplitude, integer(0)],
        forcing: None,
        wall: false,
        sticks: false,
        orbit: None,
        sweepable: match &*problem.name {
            "duffing" | "van-der-pol" => vec!["eps"],
            _ => Vec::new(),
        },
        remarks: Vec::new(),
    })
}

/// The equation for x = a y from that for y.
fn scaled(e: &Expression) -> Expression {
    let over = |e: Expression| e * Expression::parameter("amplitude").pow(-1);
    let list = |l: &[Expression]| l.iter().map(scaled).collect();
    match e {
        Expression::Displacement | Expression::Velocity | Expression::Acceleration => {
            over(e.clone())
        }
        Expression::Sum(l) => Expression::Sum(list(l)),
        Expression::Product(l) => Expression::Product(list(l)),
        Expression::Power(a, b) => Expression::Power(Box::new(scaled(a)), Box::new(scaled(b))),
        Expression::Function(f, a) => scaled(a).apply(*f),
        other => other.clone(),
    }
}

/// The equation with t + psi/omega for t.
fn advanced(e: &Expression) -> Expression {
    let list = |l: &[Expression]| l.iter().map(advanced).collect();
    match e {
        Expression::Time => {
            let omega = Expression::parameter("omega").pow(-1);
            Expression::Time + Expression::parameter("psi") * omega
        }
        Expression::Sum(l) => Expression::Sum(list(l)),
        Expression::Product(l) => Expression::Product(list(l)),
        Expression::Function(f, a) => advanced(a).apply(*f),
        other => other.clone(),
    }
}

/// The vibro-impact oscillator: on its periodic orbit just after an impact, with the orbit as
/// history, or at a given state, with the free flight without delay loop through it as history.
fn impact_oscillator(
    set: &[String],
    state: Option<[Quantity; 2]>,
    perturbation: Option<&Rational>,
    digits: u32,
) -> Result<Setup, Failure> {
    let (exact, at) = exact_parameters(set)?;
    let bits = Digits::for_digits(digits + 40).bits();
    let p = exact.certified(bits);
    let real = |x: &lindstedt_impact::real::Certified| Float::with_val(bits, x.ball().midpoint());
    let mut parameters = Parameters::new().with("eps", 1);
    for (name, text) in at.iter().filter(|(name, _)| name != "branch") {
        parameters.set(name, quantity(&Value::parse(text)?));
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
    let on_orbit = state.is_none();
    let mut remarks = Vec::new();
    let (psi, start, found) = match state {
        Some(state) => {
            remarks.push("history: free flight without delay loop through the start".to_owned());
            (Float::new(bits), state.map(|q| q.float(bits)), None)
        }
        None => {
            let orbit = orbit(&p)?;
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
            remarks.push(
                "start and history: the periodic orbit, t = 0 just after an impact".to_owned(),
            );
            let start = [real(&p.wall), -(restitution * &velocity)];
            (real(&orbit.force_angle()), start, Some((period, velocity)))
        }
    };
    let phi = Float::with_val(bits, &psi - &real(&p.phase_lag()));
    let (sin, cos) = phi.clone().sin_cos(Float::new(bits));
    // x = F cos(omega t + phi) + e^(r t) (C cos W t + D sin W t), r = -c/2.
    let first = Float::with_val(bits, &start[0] - Float::with_val(bits, &amplitude * &cos));
    let forced = Float::with_val(bits, &amplitude * &omega) * &sin;
    let second =
        (Float::with_val(bits, &start[1] + &forced) - Float::with_val(bits, &rate * &first)) / &w;
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
    // On the orbit the flight before t = 0 began one period earlier.
    let since = || if on_orbit { Expression::Time + symbol("T") } else { Expression::Time };
    let free = symbol("C") * (symbol("W") * since()).apply(Cos)
        + symbol("D") * (symbol("W") * since()).apply(Sin);
    let angle = symbol("omega") * Expression::Time + symbol("phi");
    let history = symbol("F") * angle.apply(Cos) + (symbol("R") * since()).apply(Exp) * free;
    let mut problem = vibro_impact::problem();
    problem.equation = advanced(&problem.equation);
    let model = Model::of_problem(&problem)?.with_history(&[history]);
    let [x, mut v] = start;
    if let Some(delta) = perturbation {
        let Some((_, velocity)) = &found else {
            let message = "--perturb starts on the orbit".to_owned();
            return Err(Failure::usage("perturb", message, "leave out --state"));
        };
        v += Float::with_val(bits, velocity * delta);
    }
    let forcing = Float::with_val(bits, rug::float::Constant::Pi) * 2u32 / &omega;
    Ok(Setup {
        name: "vibro-impact".into(),
        model,
        parameters,
        at,
        start: [Quantity::Float(x), Quantity::Float(v)],
        forcing: Some(Quantity::Float(forcing)),
        wall: true,
        sticks: false,
        orbit: found,
        // The orbit does not depend on the gains.
        sweepable: vec!["A", "B"],
        remarks,
    })
}
