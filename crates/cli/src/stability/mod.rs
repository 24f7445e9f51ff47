//! `lindstedt stability`: what averaging predicts for the vibro-impact orbit, and the truth.

mod chart;
mod figure;
mod report;
pub mod request;

use crate::Outcome;
use crate::arguments::{Format, StabilityOptions};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{Session, digits};
use chart::Grid;
use lindstedt_impact::ImpactError;
use lindstedt_impact::report::{certified_stability, stability};
use report::{Answer, certified_number, double_number};
use request::Request;

pub fn run(options: &StabilityOptions, session: &Session<'_>) -> Outcome {
    let request = Request::read(options)?;
    let digits = digits(&options.precision)?;
    output::check_writable(session)?;
    for path in &options.plot {
        output::check_file(path)?;
    }
    let answer = if options.precision.f64 {
        let report = stability(&request.parameters.to_f64(), &request.point())?;
        Answer::new(&request, &report, &|x| double_number(*x))
    } else {
        let asked = u32::try_from(digits).unwrap_or(u32::MAX);
        let report = certified_stability(&request.parameters, &request.point(), asked)?;
        Answer::new(&request, &report, &|x| certified_number(x.ball(), digits))
    };
    let grid = Grid::compute(&request, session)?;
    session.done();
    for warning in &answer.warnings {
        output::warn(warning);
    }
    if let Some(grid) = &grid {
        for path in &options.plot {
            let is_svg = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
            let text = if is_svg { figure::draw(&request, grid)? } else { grid.csv() };
            output::write_file(path, &text)?;
        }
    }
    let text = match session.format() {
        Format::Json => format!("{:#}\n", answer.json(grid.as_ref())),
        format => answer.text(format, grid.as_ref()),
    };
    output::write(session, &text)?;
    if grid.as_ref().is_some_and(|grid| !grid.finished) {
        output::warn("the chart is not finished");
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    // Without an orbit there is no stability to speak of.
    Ok(match answer.exists {
        _ if grid.is_some() => 0,
        Some(true) => 0,
        Some(false) => NO_ANSWER,
        None => UNDECIDED,
    })
}

impl From<ImpactError> for Failure {
    fn from(error: ImpactError) -> Self {
        let (exit, code) = match error {
            ImpactError::NotFinite { .. }
            | ImpactError::NotPositive { .. }
            | ImpactError::OutOfRange { .. }
            | ImpactError::OrderZero
            | ImpactError::BadAxes => return Self::usage("parameter", error.to_string(), ""),
            ImpactError::NoConvergence { .. } | ImpactError::Undecided { .. } => {
                (UNDECIDED, "undecided")
            }
            ImpactError::Cancelled => (INTERRUPTED, "interrupted"),
            _ => (NO_ANSWER, "no-orbit"),
        };
        Self { exit, code, message: error.to_string(), hint: String::new() }
    }
}
