//! `lindstedt trade`: what every tier costs, and how wrong it is.

mod figure;
mod report;

use crate::Outcome;
use crate::arguments::{Format, TradeOptions};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{self, Session};
use lindstedt::Error;
use lindstedt::trade::{Plan, measure};

pub fn run(options: &TradeOptions, session: &Session<'_>) -> Outcome {
    let problem = session::problem(&options.problem)?;
    let parameters = session::parameters(&options.set)?;
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
    };
    let trade = measure(&problem, &parameters, &plan, &mut |method, rows| {
        session.say(format!("{} rows finished; {}", rows.len(), method.name()));
        session.goes_on()
    });
    let trade = trade.map_err(|error| match error {
        Error::NoValue => Failure {
            exit: NO_ANSWER,
            code: "no-reference",
            message: format!("{}: the true period at these parameters is not known", problem.name),
            hint: "power-law, pendulum, duffing, van-der-pol at eps=1".to_owned(),
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
        Format::Json => format!("{:#}\n", report::json(&trade, &plan, options.wanted)),
        format => report::text(&trade, &plan, options.wanted, format),
    };
    output::write(session, &text)?;
    if !trade.finished {
        output::warn("not finished: the rows above are");
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    let met = options.wanted.is_none_or(|e| lindstedt::trade::recommend(&trade.rows, e).is_some());
    Ok(if met { 0 } else { UNDECIDED })
}
