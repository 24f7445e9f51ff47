//! `lindstedt stability`: what averaging predicts for the vibro-impact orbit, and the truth.

mod chart;
mod figure;
pub mod known;
pub mod report;
pub mod request;

use crate::Outcome;
use crate::arguments::{Format, StabilityOptions};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{Session, digits};
use chart::Grid;
use lindstedt::Number;
use lindstedt_impact::ImpactError;
use lindstedt_impact::report::{certified_stability_watched, stability_watched};
use report::Answer;
use request::Request;

pub fn run(options: &StabilityOptions, session: &Session<'_>) -> Outcome {
    let request = Request::read(options)?;
    let digits = digits(&options.precision)?;
    output::check_writable(session)?;
    for path in &options.plot {
        output::check_file(path)?;
    }
    let stop = session.stop();
    let stopped = |error| match error {
        ImpactError::Cancelled if !session.interrupted() => Failure {
            exit: UNDECIDED,
            code: "limit-seconds",
            message: "the time limit was reached before the point was finished".to_owned(),
            hint: "raise --limit-seconds, or fewer --digits, or --f64".to_owned(),
        },
        other => other.into(),
    };
    let answer = if options.precision.f64 {
        let point = request.parameters.nearest();
        let report = stability_watched(&point, &request.point(), &stop).map_err(stopped)?;
        Answer::new(&request, &report, &|x| Number::double(*x))
    } else {
        let asked = u32::try_from(digits).unwrap_or(u32::MAX);
        let point = (&request.parameters, &request.point());
        let report =
            certified_stability_watched(point.0, point.1, asked, &stop).map_err(stopped)?;
        Answer::new(&request, &report, &|x| Number::of_ball(x.ball(), digits))
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
            | ImpactError::Negative { .. }
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
