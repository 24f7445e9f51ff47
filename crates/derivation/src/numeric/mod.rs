//! The numeric tiers of the driver: the same recursion over functions known by their values.
//!
//! Forces that no exact ring takes (|x|^p, sin x, x + sign x, quotients) are expanded here, and
//! the power law to orders where its exact solution has millions of terms. The numbers are
//! *estimated*: every expansion is computed on two grids of different accuracy, and four times the
//! largest difference of the two results up to that order stands beside each number.

mod amplitude;
mod binding;
mod estimate;
mod job;

use crate::error::DerivationError as Error;
use crate::limits::check_parameters;
use crate::prepare::prepare;
use crate::settings::{Settings, condition as asked_condition};
pub use estimate::{Estimate, EstimatedSeries, Tier};
use job::{Job, limit_memory};
use lindstedt_equation::print::Style;
use lindstedt_equation::symmetry::moving_singularity;
use lindstedt_equation::{AmplitudeRole, Condition, Problem};
use lindstedt_expand::OrderWork;

/// Derives an expansion in a numeric tier. `settings.route` does not apply.
///
/// `observer` is told every finished order of every grid; when it returns `false`, the derivation
/// ends with an error (one grid alone has no error estimate).
///
/// # Errors
/// [`Error`] with the reason; [`Error::MovingSingularity`] for forces like |x| that are not part of an
/// odd equation which can be run backwards; [`Error::NotEnoughBits`] when refining the grid does not reach the
/// digits (a force that is singular inside the quarter period, for example).
///
/// # Example
/// ```
/// use lindstedt_derivation::Settings;
/// use lindstedt_derivation::numeric::{Tier, derive};
/// use lindstedt_equation::Quantity;
/// let problem = lindstedt_problems::find("power-law").ok_or("no such problem")?;
/// let settings = Settings { order: 3, ..Settings::default() };
/// let result = derive(&problem, &settings, Tier::Collocation { digits: 30 }, &mut |_| true)?;
/// let alpha = result.named(Quantity::FrequencySquared).and_then(|s| s.number(1, 30)).ok_or("none")?;
/// assert_eq!(alpha.decimal, "-0.386294361119890618834464242916");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    problem: &Problem,
    settings: &Settings,
    tier: Tier,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Estimate, Error> {
    check_parameters(problem, &settings.parameters)?;
    let condition = asked_condition(problem, settings.condition)?;
    if let Some(term) = moving_singularity(&problem.equation) {
        let term = term.print(&problem.small, Style::Text);
        return Err(Error::MovingSingularity { term });
    }
    limit_memory(settings, 32, 64)?;
    // The amplitude that is scaled out is part of the equation; a limit cycle's is found exactly.
    let changed = problem.amplitude == AmplitudeRole::Scaled || condition == Condition::LimitCycle;
    let asked = Settings { condition: Some(condition), ..settings.clone() };
    let prepared = if changed { Some(prepare(problem, &asked)?) } else { None };
    let problem = prepared.as_ref().map_or(problem, |prepared| &prepared.problem);
    let mut job = Job { problem, settings, condition, observer };
    let mut estimate = job.estimate(tier)?;
    if let Some(prepared) = &prepared {
        estimate.undo_time_scale(&prepared.time_scale);
    }
    Ok(estimate)
}
