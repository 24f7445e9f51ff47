//! `lindstedt trade`: what every tier costs, and how wrong it is.

mod figure;
mod report;

use crate::Outcome;
use crate::arguments::{Format, TradeOptions};
use crate::classification;
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{self, Loaded, Session};
use lindstedt::equation::{Condition, Expression};
use lindstedt::problem_file::parse_equation;
use lindstedt::trade::{Plan, Row, measure, most_accurate, recommend, recommend_for_many};
use lindstedt::{Error, Exact};
use rug::Rational;
use std::collections::BTreeMap;

/// What a recommendation is asked for.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// A relative error.
    pub error: Option<f64>,
    /// A time.
    pub seconds: Option<f64>,
}

impl Wanted {
    pub fn is_some(self) -> bool {
        self.error.is_some() || self.seconds.is_some()
    }

    fn in_time(self, rows: &[Row], found: Option<usize>) -> Option<usize> {
        let most = self.seconds.unwrap_or(f64::INFINITY);
        found.filter(|i| rows.get(*i).is_some_and(|row| row.seconds <= most))
    }

    /// The fastest run that states the error, if it is fast enough.
    pub fn best(self, rows: &[Row]) -> Option<usize> {
        self.in_time(rows, recommend(rows, self.error?))
    }

    /// The same for one more value of the small parameter: that time may be bought with a longer
    /// derivation.
    pub fn best_for_many(self, rows: &[Row]) -> Option<usize> {
        let most = self.seconds.unwrap_or(f64::INFINITY);
        let found = recommend_for_many(rows, self.error?);
        found.filter(|i| rows.get(*i).is_some_and(|row| row.seconds_again <= most))
    }

    /// The run that states the least error in the time.
    pub fn within(self, rows: &[Row]) -> Option<usize> {
        most_accurate(rows, self.seconds?)
    }

    /// Whether there is a recommendation for all that was asked.
    fn is_met(self, rows: &[Row]) -> bool {
        self.error.is_none_or(|_| self.best(rows).is_some())
            && self.seconds.is_none_or(|_| self.within(rows).is_some())
    }
}

/// Where the small parameter only counts orders (the equation as it was written does not mention
/// it, a table of orders puts it in) it is 1, unless it is set.
fn set_order_parameter(loaded: &Loaded, given: &mut BTreeMap<String, Exact>) {
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

pub fn run(options: &TradeOptions, session: &Session<'_>) -> Outcome {
    let mut loaded = session::load(&options.problem)?;
    loaded.without_pi(&options.problem)?;
    let condition =
        classification::condition(options.normalisation, &mut loaded, &options.problem)?;
    let mut parameters = session::parameters(&options.set)?;
    set_order_parameter(&loaded, &mut parameters);
    if condition.is_none()
        && loaded.problem.conditions.is_empty()
        && let Some(file) = &loaded.file
        && let Ok(parts) = classification::of(&loaded.problem, &parameters)
    {
        classification::check(&parts, file, condition, &options.problem)?;
    }
    let problem = loaded.problem;
    let wanted = Wanted { error: options.wanted, seconds: options.within };
    output::check_writable(session)?;
    for path in &options.plot {
        output::check_file(path)?;
    }
    let sizes = |list: &[u32]| list.iter().map(|&n| n as usize).collect();
    let plan = Plan {
        orders: sizes(&options.orders),
        digits: options.digits.clone(),
        harmonics: sizes(&options.harmonics),
        run_seconds: options.limit_run,
        repeats: options.repeats,
        memory: session.memory(),
        condition,
    };
    let first = condition.or(problem.conditions.first().copied());
    let trade = measure(&problem, &parameters, &plan, &mut |method, rows| {
        session.say(format!("{} rows finished; {}", rows.len(), method.name()));
        session.goes_on()
    });
    let trade = trade.map_err(|error| match error {
        Error::NoValue | Error::NotEvaluated { .. } => Failure {
            exit: NO_ANSWER,
            code: "no-reference",
            message: format!("{}: the true period at these parameters is not known", problem.name),
            hint: match first {
                Some(Condition::FundamentalAmplitude) => {
                    "it is sought from x(0), not from the first harmonic: --normalisation initial, \
                     where the problem offers it"
                }
                _ => {
                    "oscillators with a periodic solution that starts at rest: power-law, \
                     pendulum, duffing, van-der-pol, files"
                }
            }
            .to_owned(),
        },
        other => other.into(),
    })?;
    session.done();
    for path in &options.plot {
        let is_svg = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
        let text = if is_svg { figure::draw(&trade)? } else { report::csv(&trade) };
        output::write_file(path, &text)?;
    }
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report::json(&trade, &plan, wanted)),
        format => report::text(&trade, &plan, wanted, format),
    };
    output::write(session, &text)?;
    if !trade.finished {
        output::warn("not finished: the rows above are");
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    Ok(if wanted.is_met(&trade.rows) { 0 } else { UNDECIDED })
}
