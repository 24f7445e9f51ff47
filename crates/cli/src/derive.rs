//! `lindstedt derive`: the expansion, order by order, as one would write it on the board.

use crate::Outcome;
use crate::arguments::{self, DeriveOptions, Only, TierName};
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::numeric::Tier;
use lindstedt::unstable::equation::Condition;
use lindstedt::{Derive, Route};

pub fn run(options: &DeriveOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let work = session.precise_work(&options.precision)?;
    session.check_writable(&options.problem, &[], None)?;
    let order = options.order as usize;
    let unknown = options.unknown.as_deref().or(oscillator.unknown());
    let averaged = oscillator.condition() == Some(Condition::FreeAmplitude);
    if options.only.is_some() && (options.tier != TierName::Exact || options.mode.is_some()) {
        let message = "--only frequency belongs to exact expansions of one unknown".to_owned();
        return Err(Failure::usage("route-and-tier", message, "drop --only, or --tier and --mode"));
    }
    if options.mode.is_some() || unknown.is_some() || averaged {
        check_plain(options)?;
    }
    if let Some(mode) = options.mode {
        return session.show(oscillator.normal_mode(mode as usize, order, &work), &[]);
    }
    if let Some(name) = unknown {
        return session.show(oscillator.sought(name, order, &work), &[]);
    }
    if averaged {
        return session.show(oscillator.averaged(order, &work), &[]);
    }
    let tier = match options.tier {
        TierName::Exact => {
            let route = route(options)?;
            return session.show(oscillator.derive(Derive { order, route }, &work), &[]);
        }
        TierName::Fourier => Tier::Fourier { harmonics: options.harmonics as usize },
        TierName::Collocation if work.doubles => Tier::Doubles,
        TierName::Collocation => Tier::Collocation { digits: work.digits },
    };
    if options.route == arguments::Route::Energy {
        let message = "the energy integral is exact: --route energy has no other tier".to_owned();
        return Err(Failure::usage("route-and-tier", message, "drop --route or --tier"));
    }
    session.show(oscillator.estimate(order, tier, &work), &[])
}

/// The route; `--only frequency` goes by the energy integral where that applies, and else by primes.
fn route(options: &DeriveOptions) -> Result<Route, Failure> {
    Ok(match (options.only, options.route) {
        (Some(Only::Frequency), arguments::Route::Auto) => Route::Frequency,
        (None, arguments::Route::Auto) => Route::Automatic,
        (_, arguments::Route::Energy) => Route::EnergyIntegral,
        (None, arguments::Route::Clock) => Route::Clock,
        (None, arguments::Route::Driver) => Route::Driver,
        (Some(Only::Frequency), _) => {
            let message = "--only frequency has its own routes".to_owned();
            return Err(Failure::usage("route-and-tier", message, "drop --route or --only"));
        }
    })
}

/// Refuses tiers and routes where there is one way alone.
fn check_plain(options: &DeriveOptions) -> Result<(), Failure> {
    let plain = options.tier == TierName::Exact && options.only.is_none();
    if plain && options.route == arguments::Route::Auto {
        return Ok(());
    }
    let message =
        "--tier, --route and --only belong to expansions with a fixed amplitude".to_owned();
    Err(Failure::usage("route-and-tier", message, "drop --route, --only or --tier"))
}
