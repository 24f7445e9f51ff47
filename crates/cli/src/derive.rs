//! `lindstedt derive`: the expansion, order by order, as one would write it on the board.

use crate::Outcome;
use crate::arguments::{Precision, one_of};
use crate::failure::Failure;
use crate::session::Session;
use clap::{Args, ValueEnum};
use lindstedt::choices::{NORMALISATIONS, Numbers, ROUTES, TIERS};
use lindstedt::{Answer, Condition, Derive, Error, Refused, Route};

#[derive(Debug, Args)]
pub struct DeriveOptions {
    /// power-law, pendulum, vibro-impact, duffing, van-der-pol; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// The highest order.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000_000))]
    pub order: u32,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is: x(0), the first harmonic, or free to drift (averaging).
    #[arg(long, value_parser = one_of(NORMALISATIONS))]
    pub normalisation: Option<Condition>,
    /// A parameter that is sought as a series: for which a forced motion stays periodic (edges of tongues), or at a Hopf point,
    /// in the size of the cycle born there.
    #[arg(long, value_name = "NAME")]
    pub unknown: Option<String>,
    /// A nonlinear normal mode by its number (1, 2, ...): backbone and shape.
    #[arg(long, value_name = "K", conflicts_with = "unknown")]
    pub mode: Option<u32>,
    /// By the clock where the equation allows it and else by the driver; one of them; or the energy
    /// integral (frequency alone: conservative forces that are polynomial, the power law, the pendulum).
    #[arg(long, value_parser = one_of(&ROUTES[..4]), default_value = "auto")]
    pub route: Route,
    /// The frequency and the period alone, to higher order: by the energy integral where it applies, and else modulo
    /// primes (limit cycles, forces with velocities).
    #[arg(long, value_enum, value_name = "WHAT")]
    pub only: Option<Only>,
    /// Exact, the default (averaging encloses what is irrational, but not where exact is asked for), or numbers with an estimated
    /// error: collocation (--digits or --f64) or a truncated Fourier series in doubles (--harmonics).
    #[arg(long, value_parser = one_of(TIERS))]
    pub tier: Option<Numbers>,
    /// Harmonics of each symmetry class in the Fourier tier.
    #[arg(long, default_value_t = 64, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=16384))]
    pub harmonics: u32,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Only {
    /// The series of omega^2, omega and T.
    Frequency,
}

pub fn run(options: &DeriveOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let work = session.precise_work(&options.precision)?;
    session.check_writable(&options.problem, &[], None)?;
    let order = options.order as usize;
    let unknown = options.unknown.as_deref().or(oscillator.unknown());
    let averaged = oscillator.condition() == Some(Condition::FreeAmplitude);
    let numbers = options.tier.unwrap_or(Numbers::Exact);
    if options.only.is_some() && (numbers != Numbers::Exact || options.mode.is_some()) {
        let message = "--only frequency belongs to exact expansions of one unknown".to_owned();
        return Err(Failure::usage("route-and-tier", message, "drop --only, or --tier and --mode"));
    }
    if options.mode.is_some() || unknown.is_some() || averaged {
        check_plain(options)?;
    }
    if let Some(mode) = options.mode {
        return session.show(
            Ok(as_asked(options, oscillator.normal_mode(mode as usize, order, &work))?),
            &[],
        );
    }
    if let Some(name) = unknown {
        return session.show(Ok(as_asked(options, oscillator.sought(name, order, &work))?), &[]);
    }
    if averaged {
        return session.show(Ok(as_asked(options, oscillator.averaged(order, &work))?), &[]);
    }
    let Some(tier) = numbers.tier(options.harmonics as usize, &work) else {
        let route = route(options)?;
        return session.show(oscillator.derive(Derive { order, route }, &work), &[]);
    };
    if options.route == Route::EnergyIntegral {
        let message = "the energy integral is exact: --route energy has no other tier".to_owned();
        return Err(Failure::usage("route-and-tier", message, "drop --route or --tier"));
    }
    session.show(oscillator.estimate(order, tier, &work), &[])
}

/// An answer, but no enclosures where exact coefficients are asked for.
fn as_asked<T>(
    options: &DeriveOptions,
    answer: Result<Answer<T>, Error>,
) -> Result<Answer<T>, Failure> {
    let answer = answer?;
    if options.tier == Some(Numbers::Exact) && answer.header.tier != "exact" {
        let message = "coefficients are irrational: they are enclosed, not exact";
        let hint = "without --tier exact all their digits are certain";
        return Err(Refused::no_answer("no-rational-modes", message, hint).into());
    }
    Ok(answer)
}

/// The route; `--only frequency` goes by the energy integral where that applies, and else by primes.
fn route(options: &DeriveOptions) -> Result<Route, Failure> {
    Ok(match (options.only, options.route) {
        (Some(Only::Frequency), Route::Automatic) => Route::Frequency,
        (_, Route::EnergyIntegral) => Route::EnergyIntegral,
        (None, route) => route,
        (Some(Only::Frequency), _) => {
            let message = "--only frequency has its own routes".to_owned();
            return Err(Failure::usage("route-and-tier", message, "drop --route or --only"));
        }
    })
}

/// Refuses tiers and routes where there is one way alone.
fn check_plain(options: &DeriveOptions) -> Result<(), Failure> {
    let exact = options.tier.is_none_or(|tier| tier == Numbers::Exact);
    let plain = exact && options.only.is_none();
    if plain && options.route == Route::Automatic {
        return Ok(());
    }
    let message =
        "--tier, --route and --only belong to expansions with a fixed amplitude".to_owned();
    Err(Failure::usage("route-and-tier", message, "drop --route, --only or --tier"))
}
