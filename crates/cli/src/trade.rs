//! `lindstedt trade`: what every tier costs, and how wrong it is.

use crate::Outcome;
use crate::arguments::TradeOptions;
use crate::session::Session;
use lindstedt::trade::Plan;

pub fn run(options: &TradeOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let sizes = |list: &[u32]| list.iter().map(|&n| n as usize).collect();
    let plan = Plan {
        orders: sizes(&options.orders),
        digits: options.digits.clone(),
        harmonics: sizes(&options.harmonics),
        run_seconds: options.limit_run,
        repeats: options.repeats,
        error: options.wanted,
        seconds: options.within,
    };
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.trade(&plan, &session.work()), &options.plot)
}
