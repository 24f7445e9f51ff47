//! Which methods take an equation, and why the others do not.

pub(crate) mod hint;

use crate::refusal::{Refusal, Refused, averages};
use crate::{Error, Exact};
use lindstedt_derivation::{DerivationError, check_parameters, known_values};
use lindstedt_equation::classify::{Classification, ClassifyError, Method, Reason, classify};
pub use lindstedt_equation::description::{
    Described, DescribedForce, DescribedMethod, Description, reason_text, shortened,
};
use lindstedt_equation::{Condition, Expression, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_problem_file::ProblemFile;
use std::collections::BTreeMap;

/// Classifies a problem with the values given and the defaults. A value outside its domain is against
/// every method that looks at it: Melnikov's looks at no amplitude, averaging asks for another start.
/// # Errors
/// [`ClassifyError`].
pub fn of(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
) -> Result<Classification, ClassifyError> {
    let mut parts = classify(problem, &known_values(problem, given))?;
    if let Err(error) = check_parameters(problem, given)
        && let DerivationError::OutsideDomain { name, .. } = &error
    {
        let looks = |method| match method {
            Method::Melnikov => false,
            Method::Averaging => name != "amplitude",
            _ => true,
        };
        let applies =
            |(method, against): &&mut (Method, Vec<Reason>)| against.is_empty() && looks(*method);
        for (_, against) in parts.methods.iter_mut().filter(applies) {
            against.push(Reason::OutsideDomain(error.to_string()));
        }
    }
    Ok(parts)
}

/// What to do with frequencies that have no common measure,
const FORCES: &str = "forces are averaged together where their frequencies are rational multiples of one: approximate the \
     ratio by a fraction; `lindstedt simulate` takes them as they are";
/// with a phase beside a delay,
const PHASE: &str = "beside a delay a force has no phase: shift the time, which nothing else in the equation contains, so that \
     it is cos(omega*t) or sin(omega*t); `lindstedt simulate` takes it as it is";
/// with one that is irrational,
const RATIO: &str = "a rational multiple of the frequency of the oscillator, as cos(sqrt(2)*t) beside x'' + 2*x, is taken as it \
     is; a parameter without a value, cos(omega*t), counts as independent (`lindstedt derive`), a fraction near it as itself; \
     `lindstedt simulate` takes it as it is";
/// with a detuning that is not small,
const DETUNING: &str = "write cos((1 + eps*sigma)*t), or give the parameter a value (--set NAME=VALUE); `lindstedt simulate` takes \
     it as it is";
/// with x = 0 as a saddle,
const SADDLE: &str = "x = 0 is a saddle: put x = c + y with a centre c, or `lindstedt simulate`";
/// and with terms that are not small.
const SMALL_TERMS: &str =
    "a factor of the small parameter marks the small terms; `lindstedt simulate` takes it as it is";
/// and with a linear part that has a delay.
const HOPF: &str = "with a factor eps, eps*x(t - T), it is averaged; `lindstedt derive --unknown NAME` finds the Hopf points of a \
     parameter and the cycles born there; `lindstedt simulate` takes it as it is";
/// and with a division by the small parameter.
const DIVIDED: &str =
    "multiply it out, so that the factor cancels; `lindstedt simulate` takes it as it is";
/// What a file says for the amplitude to be averaged.
const AVERAGES: &str =
    "averaging takes it: condition = \"free-amplitude\" in the file, or --normalisation free";

/// Whether this is a function of more than a multiple of the time.
fn has_phase(e: &Expression) -> bool {
    let zero = |e: &Expression| (*e == Expression::Time).then(|| Expression::integer(0));
    match e {
        Expression::Function(_, angle) => {
            angle.substitute(&zero).canonical() != Expression::integer(0)
        }
        _ => false,
    }
}

/// The path of a file with the place of a term of its equation, or of the equation.
pub(crate) fn place(file: &ProblemFile, path: &str, term: Option<&Expression>) -> String {
    let place = term.and_then(|term| file.locate(term)).or_else(|| file.locate_equation());
    let place = place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"));
    format!("{path}{place}")
}

/// What an equation without a small parameter misses.
#[must_use]
pub fn marks(small: &str) -> String {
    format!(
        "a factor {small} marks the small terms; `simulate` takes it as it is, and `evaluate --prove` where it is smooth"
    )
}

/// Refuses, before any work, a file whose equation the expansion with the condition asked for does
/// not take, with the term and its place. Free amplitudes and values outside their domain are left to
/// their driver.
///
/// # Errors
/// [`Refused`] with the reason.
pub fn check(
    parts: &Classification,
    file: &ProblemFile,
    condition: Option<Condition>,
    path: &str,
) -> Result<(), Refused> {
    let condition = condition.or(file.problem.conditions.first().copied());
    let against = |method: Method| {
        let listed = parts.methods.iter().filter(move |(m, _)| *m == method);
        let reasons = listed.flat_map(|(_, against)| against);
        reasons.filter(|r| !matches!(r, Reason::Condition | Reason::OutsideDomain(_)))
    };
    let small = &file.problem.small;
    let delayed = file.problem.equation.nodes().any(Expression::is_delayed);
    let nothing_small = !file.problem.equation.contains(&Expression::Small);
    let marks = marks(small);
    let refused = |at: String, what: String, hint: String| {
        let message = format!("{at}: {what}");
        Err(Refused::no_answer("no-method", message, hint))
    };
    if !parts.takes(Method::Melnikov) {
        check_frequencies(parts, |e| place(file, path, Some(e)), small)?;
    }
    let Some(reason) = against(Method::LindstedtPoincare).next() else {
        if condition.is_some() {
            return Ok(());
        }
        let (what, hint) = if nothing_small {
            (reason_text(&Reason::NoSmallParameter, small), marks)
        } else {
            let hint = "\"initial-amplitude\", \"limit-cycle\", \"free-amplitude\"";
            ("condition = [] asks for no expansion".to_owned(), hint.to_owned())
        };
        return refused(place(file, path, None), what, hint);
    };
    if condition == Some(Condition::FreeAmplitude) {
        let plain = |r: &&Reason| match r {
            Reason::NoLinearPart | Reason::NotWeaklyNonlinear(_) => nothing_small,
            Reason::Frequency(_) | Reason::DelayedLinearPart(_) | Reason::Divided(_) => true,
            _ => false,
        };
        let Some(reason) = against(Method::Averaging).find(plain) else { return Ok(()) };
        let at = place(file, path, reason.term());
        let hint = match reason {
            Reason::DelayedLinearPart(_) => HOPF.to_owned(),
            _ if nothing_small => marks,
            Reason::Frequency(e) if delayed && e.nodes().any(has_phase) => PHASE.to_owned(),
            Reason::Frequency(_) => FORCES.to_owned(),
            _ => String::new(),
        };
        return refused(at, reason_text(reason, small), hint);
    }
    let at = match reason {
        // The equation is not to blame.
        Reason::Impact => path.to_owned(),
        _ => place(file, path, reason.term()),
    };
    let averages = against(Method::Averaging).next().is_none()
        && parts.forcing.iter().all(|force| force.resonance.is_none());
    let hint = next_best(parts, reason, file, averages).unwrap_or(marks);
    refused(at, reason_text(reason, small), hint)
}

/// Refuses forces with frequencies that no averaging takes, each for its own reason.
///
/// # Errors
/// [`Refused`], with the codes `ratio-not-rational` and `detuning-not-small`.
pub fn check_frequencies(
    parts: &Classification,
    place: impl Fn(&Expression) -> String,
    small: &str,
) -> Result<(), Refused> {
    let averaging = parts.methods.iter().filter(|(method, _)| *method == Method::Averaging);
    for reason in averaging.flat_map(|(_, against)| against) {
        let message = |term| format!("{}: {}", place(term), reason_text(reason, small));
        return Err(match reason {
            Reason::IrrationalRatio(e) => {
                Refused::no_answer("ratio-not-rational", message(e), RATIO)
            }
            Reason::LargeDetuning(e) => {
                Refused::no_answer("detuning-not-small", message(e), DETUNING)
            }
            _ => continue,
        });
    }
    Ok(())
}

/// What takes an equation that the expansion does not; nothing where a small parameter would make it one
/// that the expansion takes.
fn next_best(
    parts: &Classification,
    reason: &Reason,
    file: &ProblemFile,
    averages: bool,
) -> Option<String> {
    let nothing_small = !file.problem.equation.contains(&Expression::Small);
    let in_numbers = matches!(reason, Reason::NonSmooth(_) | Reason::NotPolynomial(_))
        && parts.takes(Method::TimeDomain);
    if nothing_small && *reason == Reason::NoSmallParameter {
        return None;
    }
    let hint = match reason {
        Reason::DelayedLinearPart(_) => HOPF,
        _ if parts.takes(Method::Melnikov) => {
            "Melnikov's method takes equations of this kind: lindstedt threshold FILE"
        }
        Reason::UnknownFrequency => "--set NAME=VALUE gives it one",
        _ if averages => AVERAGES,
        _ if in_numbers => return Some(hint::in_numbers(parts, file, reason)),
        Reason::Divided(_) => {
            return Some(hint::divided(file).unwrap_or_else(|| DIVIDED.to_owned()));
        }
        _ if nothing_small => return hint::power_law(&file.problem),
        Reason::NegativeStiffness => SADDLE,
        Reason::NotWeaklyNonlinear(_) => SMALL_TERMS,
        _ => "`lindstedt simulate` takes it; `lindstedt problems --show FILE` lists the methods",
    };
    Some(hint.to_owned())
}

/// A refusal of the engine; of the equation of a file with its place. Where no amplitude is constant,
/// or none that is known exactly, averaging is what takes the equation.
#[must_use]
pub fn refusal(error: Error, file: Option<&ProblemFile>, path: &str) -> Error {
    let averages = error.expand().is_some_and(averages);
    let no_root = matches!(error.expand(), Some(ExpandError::StiffnessNotSquare));
    let Some(file) = file.filter(|_| error.code() == "no-expansion") else { return error };
    let hint = if averages {
        AVERAGES.to_owned()
    } else if !file.problem.equation.contains(&Expression::Small) {
        marks(&file.problem.small)
    } else if no_root {
        "--set gives all parameters values, that of the force included; or write omega_0^2*x"
            .to_owned()
    } else {
        error.hint()
    };
    let message = format!("{}: {error}", place(file, path, None));
    Refused { code: error.code(), kind: error.kind(), message, hint }.into()
}
