//! `lindstedt derive`: the expansion, order by order, as one would write it on the board.

use crate::Outcome;
use crate::arguments::{self, DeriveOptions, TierName};
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
            let route = match options.route {
                arguments::Route::Auto => Route::Automatic,
                arguments::Route::Clock => Route::Clock,
                arguments::Route::Driver => Route::Driver,
                arguments::Route::Energy => Route::EnergyIntegral,
            };
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

/// Refuses tiers and routes where there is one way alone.
fn check_plain(options: &DeriveOptions) -> Result<(), Failure> {
    if options.tier == TierName::Exact && options.route == arguments::Route::Auto {
        return Ok(());
    }
    let message = "--tier and --route belong to expansions with a fixed amplitude".to_owned();
    Err(Failure::usage("route-and-tier", message, "drop --route or --tier"))
}
