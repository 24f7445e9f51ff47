//! What is integrated: the problem's equation with values, start and history.

use super::case::Case;
use super::history::Evaluator;
use super::orbit::on_orbit;
use crate::failure::Failure;
use crate::session::{Loaded, load, parameters};
use crate::start::{Taken, compare};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, Expression, Impact, Problem};
use lindstedt::problem_file::{History, Names, ProblemFile};
use lindstedt::problems::{stick_slip, vibro_impact};
use lindstedt::simulate::{Model, Parameters, Quantity};
use lindstedt::{Error, Exact};
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
    /// Its frequency in the parameters, where that can be swept, and the small parameter's name.
    pub frequency: Option<(Expression, String)>,
    /// A wall bounds the motion.
    pub wall: bool,
    /// The equation is linear, without a wall.
    pub linear: bool,
    /// Dry friction makes the body stick.
    pub sticks: bool,
    /// Period and impact velocity of the periodic impact orbit that the motion starts on.
    pub orbit: Option<(Float, Float)>,
    /// Parameters that can be swept (nothing else depends on them).
    pub sweepable: Vec<String>,
    /// Parameters that a file holds fixed.
    pub fixed: Vec<String>,
    /// Ranges LO..HI:COUNT of parameters that a file says.
    pub ranges: BTreeMap<String, String>,
    /// Equation, wall and history in one line: with the parameters and the start, all that determines a
    /// motion.
    pub identity: String,
    /// What was chosen, in words.
    pub remarks: Vec<String>,
}

/// Where a motion starts, as far as it was said.
#[derive(Default)]
pub struct Start<'a> {
    /// x(0), x'(0).
    pub state: Option<[Quantity; 2]>,
    /// `constant`, `free-flight`, or an expression in t.
    pub history: Option<&'a str>,
    /// Velocity added on the orbit.
    pub perturbation: Option<Rational>,
    /// A parameter is swept: on the orbit itself nothing but rounding errors would tell stable
    /// from unstable, so the start is perturbed.
    pub sweep: bool,
}

/// See [`Setup::identity`].
pub fn identity(problem: &Problem, history: Option<&Expression>) -> String {
    let print = |e: &Expression| e.print(&problem.small, Style::Text);
    let mut text = print(&problem.equation);
    if let Some(Impact { position, crossing, restitution }) = &problem.impact {
        text += &format!("; {crossing:?} to {}, {}", print(position), print(restitution));
    }
    if let Some(history) = history {
        text += &format!("; before {}", print(history));
    }
    text
}

/// Whether two problems are the same equation with the same wall and delay.
pub fn same(a: &Problem, b: &Problem) -> bool {
    let equation = |p: &Problem| {
        let equation = p.equation.canonical();
        equation.multiplied_out().unwrap_or(equation)
    };
    let wall = |p: &Problem| {
        let wall = p.impact.as_ref()?;
        Some((wall.position.canonical(), wall.crossing, wall.restitution.canonical()))
    };
    equation(a) == equation(b) && wall(a) == wall(b) && a.synchronous == b.synchronous
}

fn source(name: &str) -> Result<Loaded, Failure> {
    let belt = stick_slip::problem();
    if belt.name == name { Ok(Loaded { problem: belt, file: None }) } else { load(name) }
}

impl Setup {
    /// Reads a problem; numbers that are computed have `digits` digits and some more.
    pub fn read(
        name: &str,
        set: &[String],
        start: &Start<'_>,
        digits: u32,
    ) -> Result<Self, Failure> {
        let Loaded { problem, file } = source(name)?;
        let file = file.as_ref();
        let impacting = same(&problem, &vibro_impact::problem());
        let state = match (&start.state, file.and_then(|f| f.initial.as_ref())) {
            (None, Some([x, v])) => {
                // What is wrong with --set is said below. A first harmonic is no start.
                let given = parameters(set).unwrap_or_default();
                if problem.conditions.first() != Some(&Condition::FundamentalAmplitude) {
                    compare(&problem, file, &given, Taken::Initial("--state AMPLITUDE,0"));
                }
                Some([Exact::parse(x)?.into(), Exact::parse(v)?.into()])
            }
            (state, _) => state.clone(),
        };
        let names = || match file {
            Some(file) => file.names.clone(),
            None => Names::only(&problem.small, problem.parameters.iter().map(|card| &*card.name)),
        };
        let history = match start.history {
            Some(text) => Some(History::parse(text, &names()).map_err(Error::from)?),
            None => file.and_then(|f| f.history.clone()).map(|(history, _)| history),
        };
        let mut set = set.to_vec();
        if impacting {
            set.extend(defaults(&problem, &set));
        }
        let mut setup = if impacting && state.is_none() && history.is_none() {
            let usual = || start.sweep.then(|| Rational::from((1, 1000)));
            let perturbation = start.perturbation.clone().or_else(usual);
            on_orbit(&problem, &set, perturbation.as_ref(), digits)?
        } else if start.perturbation.is_some() {
            let message = if impacting {
                "--perturb starts on the orbit".to_owned()
            } else {
                format!(
                    "{} starts at a state: only vibro-impact begins on its periodic impact orbit, which \
                     --perturb leaves",
                    problem.name
                )
            };
            let hint =
                if impacting { "leave out --state and --history" } else { "--state X,V alone" };
            return Err(Failure::usage("perturb", message, hint));
        } else {
            let case = Case { problem: &problem, file, impacting, digits };
            case.setup(&set, state, history)?
        };
        if let Some(file) = file {
            setup.keep_to(file);
        }
        Ok(setup)
    }

    /// The period of the force where the parameter has this value, if it is one on which the
    /// frequency depends.
    pub fn period_at(&self, name: &str, value: &Quantity) -> Option<Result<f64, Failure>> {
        let (frequency, small) = self.frequency.as_ref()?;
        if !frequency.parameters().iter().any(|parameter| parameter == name) {
            return None;
        }
        let mut parameters = self.parameters.clone();
        parameters.set(name, value.clone());
        let evaluator = Evaluator { parameters: &parameters, small, bits: 64 };
        let period = evaluator.period(frequency).transpose()?;
        Some(period.map(|period| period.to_f64()))
    }

    /// What a file says about its parameters and its questions.
    fn keep_to(&mut self, file: &ProblemFile) {
        self.fixed = file.fixed.clone();
        self.ranges = file.ranges.clone();
        if !file.asked.is_empty() {
            let list = file.asked.join(", ");
            self.remarks.push(format!("asked for in the file, not answered by a motion: {list}"));
        }
    }
}

/// The parameters of a file that is the vibro-impact oscillator, as far as they are not set.
fn defaults(problem: &Problem, set: &[String]) -> Vec<String> {
    let known = vibro_impact::problem().parameters;
    let is_set = |name: &str| {
        set.iter().any(|item| item.split_once('=').is_some_and(|(n, _)| n.trim() == name))
    };
    let cards = problem.parameters.iter();
    let cards = cards.filter(|card| known.iter().any(|k| k.name == card.name));
    let cards = cards.filter(|card| !is_set(&card.name) && !card.default.is_empty());
    cards.map(|card| format!("{}={}", card.name, card.default)).collect()
}
