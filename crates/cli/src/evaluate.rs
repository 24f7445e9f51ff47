//! `lindstedt evaluate`: numbers from the expansion.

mod averaged;
mod code;
mod figure;
mod report;
mod trajectory;

use crate::Outcome;
use crate::arguments::{EvaluateOptions, Format, Resum};
use crate::classification::{self, refusal};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{Loaded, Session, digits, load, parameters};
use crate::start::{self, Taken};
use lindstedt::equation::{Condition, Expression};
use lindstedt::evaluate::{EvaluateSettings, Trajectory, evaluate};
use lindstedt::problem_file::parse_equation;
use lindstedt::series::resummation::Method;
use lindstedt::{Error, Exact, ProblemFile, Progress, expand::ExpandError};
use report::Report;
use rug::Rational;
use std::collections::BTreeMap;

/// Digits of a double.
const DOUBLE: usize = 16;

pub fn run(options: &EvaluateOptions, session: &Session<'_>) -> Outcome {
    let mut loaded = load(&options.problem)?;
    loaded.without_pi(&options.problem)?;
    let condition =
        classification::condition(options.normalisation, &mut loaded, &options.problem)?;
    let mut given = parameters(&options.set)?;
    if let Some(file) = &loaded.file
        && let Ok(parts) = classification::of(&loaded.problem, &given)
    {
        classification::check(&parts, file, condition, &options.problem)?;
    }
    set_order_parameter(&loaded, &mut given);
    let free = condition.or(loaded.problem.conditions.first().copied());
    if free == Some(Condition::FreeAmplitude)
        && loaded.problem.conditions.contains(&Condition::FreeAmplitude)
    {
        return averaged::run(options, &loaded, given, session);
    }
    if options.start.is_some() || options.state.is_some() {
        let message = "--start and --state belong to averaged motions".to_owned();
        let hint = "--normalisation free averages; else --set amplitude=A, --phase PHASE";
        return Err(Failure::usage("start", message, hint));
    }
    use_initial_data(&loaded, free, &mut given)?;
    let Loaded { problem, file } = loaded;
    let settings = EvaluateSettings {
        order: options.order.map(|order| order as usize),
        method: method(options.resum),
        condition,
        parameters: given,
        digits: digits(&options.precision)?,
        memory: session.memory(),
        stop: session.stop(),
    };
    let times = trajectory::Request::read(options)?;
    output::check_writable(session)?;
    let mut observer = |progress: Progress| {
        if let Progress::Primes(n) = progress {
            session.say(format!("{n} primes done"));
        }
        session.goes_on()
    };
    let fail = |error| failure(error, file.as_ref(), &options.problem, session);
    let result = evaluate(&problem, &settings, &mut observer).map_err(fail)?;
    let solution = match &times {
        None => None,
        Some(_) if result.period.is_none() && result.exact_period.is_none() => {
            return Err(Failure {
                exit: UNDECIDED,
                code: "no-value",
                message: "the period has not one digit at these parameters, so x(t) has none"
                    .to_owned(),
                hint: "a higher --order, another --resum, or `lindstedt simulate`".to_owned(),
            });
        }
        Some(request) => {
            let phase = Exact::parse(&options.phase)?;
            // A figure or a function in doubles needs no more than these.
            let digits = if options.times.is_some() { settings.digits } else { DOUBLE };
            let settings = EvaluateSettings { digits, ..settings.clone() };
            let found = Trajectory::new(&problem, &settings, &result, phase, &mut observer)
                .map_err(fail)?;
            if let Some(language) = options.code {
                session.done();
                let text = code::write(&problem, &found, language, options.harmonics)?;
                output::write(session, &text)?;
                return Ok(0);
            }
            Some(trajectory::Table::compute(request, &found, session)?)
        }
    };
    session.done();
    for path in &options.plot {
        if let Some(table) = &solution {
            let contents = table.file(path, &problem)?;
            std::fs::write(path, contents)
                .map_err(|error| output::trouble(&path.display().to_string(), &error))?;
        }
    }
    let report = Report {
        problem: &problem,
        result: &result,
        resum: options.resum,
        solution: solution.as_ref(),
    };
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report.json(session)),
        Format::Text => report.text(),
        Format::Latex => report.latex(),
        Format::Markdown => report.markdown(),
    };
    output::write(session, &text)?;
    if solution.as_ref().is_some_and(|table| !table.finished) {
        output::warn("stopped; the times not reached are missing");
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    if result.period.is_none() {
        output::warn("the expansion gives not one digit of the period here");
        return Ok(UNDECIDED);
    }
    Ok(0)
}

/// Where the small parameter only counts orders (the equation as it was written does not mention
/// it, a table of orders puts it in) it is 1, unless it is set.
pub fn set_order_parameter(loaded: &Loaded, given: &mut BTreeMap<String, Exact>) {
    let problem = &loaded.problem;
    let written = loaded.file.as_ref().map(|file| parse_equation(&file.equation, &file.names));
    let mentions = |e: &Expression| e.contains(&Expression::Small);
    let counts_only = match &written {
        Some(Ok(equation)) => !mentions(equation),
        // Built-in problems have a card for a small parameter that means something.
        None => problem.conditions.contains(&Condition::FreeAmplitude) && problem.impact.is_some(),
        Some(Err(_)) => false,
    };
    let listed = problem.parameters.iter().any(|card| card.name == problem.small);
    if counts_only && !listed {
        let one = || Exact::Rational(Rational::from(1));
        given.entry(problem.small.to_string()).or_insert_with(one);
    }
}

/// x(0) of a file is its amplitude where the condition is an initial amplitude.
fn use_initial_data(
    loaded: &Loaded,
    condition: Option<Condition>,
    given: &mut BTreeMap<String, Exact>,
) -> Result<(), Failure> {
    let Some([x, velocity]) = loaded.file.as_ref().and_then(|file| file.initial.as_ref()) else {
        return Ok(());
    };
    if condition != Some(Condition::InitialAmplitude) {
        return Ok(());
    }
    let set = given.contains_key("amplitude");
    let taken = if set { Taken::Amplitude } else { Taken::Initial("--set amplitude=AMPLITUDE") };
    start::compare(&loaded.problem, loaded.file.as_ref(), given, taken);
    if set {
        return Ok(());
    }
    let still = Exact::parse(velocity)?.as_rational().is_some_and(|v| v.is_zero());
    let listed = loaded.problem.parameters.iter().any(|card| card.name == "amplitude");
    if !still || !listed {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "initial-data",
            message: "the expansion starts at rest: x(0) = amplitude, x'(0) = 0".into(),
            hint: "--set amplitude=A and --phase PHASE, or change [initial] of the file".into(),
        });
    }
    given.insert("amplitude".to_owned(), Exact::parse(x)?);
    Ok(())
}

fn failure(error: Error, file: Option<&ProblemFile>, path: &str, session: &Session<'_>) -> Failure {
    match error {
        Error::Expand(ExpandError::Interrupted { .. }) if !session.interrupted() => Failure {
            exit: UNDECIDED,
            code: "limit-seconds",
            message: "the time limit was reached before the expansion was finished".to_owned(),
            hint: "raise --limit-seconds or lower --order".to_owned(),
        },
        other => refusal(other, file, path).into(),
    }
}

fn method(resum: Resum) -> Option<Method> {
    Some(match resum {
        Resum::None => Method::PartialSum,
        Resum::Pade => Method::Pade,
        Resum::Uniform => Method::Uniform,
        Resum::UniformPade => Method::UniformPade,
        Resum::Conformal => Method::ConformalPade,
        Resum::BorelPade => Method::BorelPade,
        Resum::Auto => return None,
    })
}

/// The name of a method on the command line.
fn flag(method: Method) -> &'static str {
    match method {
        Method::PartialSum => "none",
        Method::Pade => "pade",
        Method::Uniform => "uniform",
        Method::UniformPade => "uniform-pade",
        Method::ConformalPade => "conformal",
        _ => "borel-pade",
    }
}
