//! `lindstedt derive`: the expansion, order by order, as one would write it on the board.

mod report;

use crate::Outcome;
use crate::arguments::{self, DeriveOptions, Format};
use crate::averaging;
use crate::classification;
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output;
use crate::session::{Loaded, Session, digits, load, parameters};
use crate::start::{self, Taken};
use lindstedt::coeff::print::Style;
use lindstedt::equation::Condition;
use lindstedt::equation::classify::{Method, Reason, polynomial};
use lindstedt::expand::ExpandError;
use lindstedt::{Error, Exact, Number, ProblemFile, Progress, Route, Settings, Solution};
use report::{Frame, Report};
use serde_json::{Value as Json, json};

pub fn run(options: &DeriveOptions, session: &Session<'_>) -> Outcome {
    let mut loaded = load(&options.problem)?;
    loaded.without_pi(&options.problem)?;
    let condition =
        classification::condition(options.normalisation, &mut loaded, &options.problem)?;
    let Loaded { problem, file } = loaded;
    let digits = digits(&options.precision)?;
    let settings = Settings {
        order: options.order as usize,
        condition,
        parameters: parameters(&options.set)?,
        memory: session.memory(),
        route: match options.route {
            arguments::Route::Driver => Route::Driver,
            arguments::Route::Energy => Route::EnergyIntegral,
        },
        stop: session.stop(),
    };
    output::check_writable(session)?;
    // The equation of a file is looked at before any work starts; built-in ones are known.
    let mut header = String::new();
    if let Some(file) = &file
        && let Ok(mut parts) = classification::of(&problem, &settings.parameters)
    {
        if options.tier != arguments::TierName::Exact {
            // To values at nodes every force is alike; what is not finite there is refused later.
            let expansion =
                parts.methods.iter_mut().filter(|(m, _)| *m == Method::LindstedtPoincare);
            for (_, against) in expansion {
                against.retain(|r| !matches!(r, Reason::NonSmooth(_) | Reason::NotPolynomial(_)));
            }
        }
        classification::check(&parts, file, settings.condition, &options.problem)?;
        if session.format() == Format::Text {
            header = classification::text(&parts, &problem.small, true) + "\n";
        }
    }
    let condition = settings.condition.or(problem.conditions.first().copied());
    if condition == Some(Condition::FreeAmplitude)
        && problem.conditions.contains(&Condition::FreeAmplitude)
    {
        // A file gives its values; the parameters of a built-in problem stay symbols.
        let mut settings = settings;
        if file.is_some() {
            let cards = problem.parameters.iter();
            let known =
                cards.filter_map(|c| Some((c.name.to_string(), Exact::parse(&c.default).ok()?)));
            settings.parameters = known.chain(settings.parameters).collect();
        }
        let read = file.as_ref().map(|file| (file, &*options.problem));
        return averaging::run(&problem, &settings, digits, &header, session, read);
    }
    if options.tier != arguments::TierName::Exact {
        let file = file.as_ref();
        return crate::derive_numeric::run(options, (&problem, file), &settings, digits, session);
    }
    let mut primes = 0;
    let mut observer = |progress: Progress| {
        if let Progress::Primes(n) = progress {
            primes = n;
        }
        session.say(match progress {
            Progress::Order(n, terms) => format!("order {n} of {}: {terms} terms", settings.order),
            Progress::Primes(n) => format!("{n} primes done"),
            Progress::Integrating(n) => format!("{n} values compared"),
            Progress::Checking => "substituting into the equation".to_owned(),
            _ => String::new(),
        });
        session.goes_on()
    };
    let result = lindstedt::derive(&problem, &settings, &mut observer);
    let result = result.map_err(|error| match error {
        // Over Q all orders are finished together, so there is nothing to show.
        Error::Expand(ExpandError::Interrupted { .. }) if !session.interrupted() => Failure {
            exit: UNDECIDED,
            code: "limit-seconds",
            message: unfinished(primes > 0 || polynomial(&problem.equation).is_some(), primes),
            hint: "raise --limit-seconds or lower --order".to_owned(),
        },
        other => classification::refusal(other, file.as_ref(), &options.problem).into(),
    })?;
    let report = Report::new(&result, digits)?;
    session.done();
    if result.condition == Condition::InitialAmplitude {
        start::compare(&problem, file.as_ref(), &settings.parameters, Taken::Amplitude);
    }
    say_missing(file.as_ref(), &|name| {
        result.series.iter().any(|series| series.name == name)
            || name == "solution" && report.solved() > 0
    });
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report.json(session)),
        Format::Text => header + &report.board(Style::Text, &Frame::TEXT),
        Format::Latex => report.board(Style::Latex, &Frame::LATEX),
        Format::Markdown => report.board(Style::Latex, &Frame::MARKDOWN),
    };
    output::write(session, &text)?;
    let unchecked =
        result.checked_orders.is_none() && !matches!(result.solution, Solution::FrequencyOnly);
    if result.order < settings.order || unchecked {
        let reason = if session.interrupted() { "interrupted" } else { "time limit" };
        let checked = if unchecked { "but not checked" } else { "and checked" };
        output::warn(&format!("{reason}: orders 0 to {} are finished {checked}", result.order));
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    Ok(0)
}

/// The message of an expansion without a single order. Over Q every order is reconstructed from all
/// primes together and proved by substitution at the end.
fn unfinished(over_q: bool, primes: usize) -> String {
    let message = "the time limit was reached before the expansion was finished";
    if over_q {
        format!(
            "{message}: over Q all orders are reconstructed together from many primes ({primes} \
             done) and proved at the end; before that no order is"
        )
    } else {
        message.to_owned()
    }
}

/// Says what a problem file asks for and the derivation does not have.
pub fn say_missing(file: Option<&ProblemFile>, has: &dyn Fn(&str) -> bool) {
    let Some(file) = file else { return };
    let missing: Vec<&str> =
        file.asked.iter().map(String::as_str).filter(|name| !has(name)).collect();
    if !missing.is_empty() {
        output::warn(&format!(
            "asked for in the file, but not in this result: {}",
            missing.join(", ")
        ));
    }
}

/// A number of the JSON contract.
pub fn number_json(number: &Number) -> Json {
    json!(number)
}
