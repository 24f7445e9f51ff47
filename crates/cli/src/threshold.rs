//! `lindstedt threshold`: the Melnikov threshold of homoclinic chaos, its zeros, curves, surfaces.

mod figure;
mod general;
mod report;
mod request;
mod subharmonics;
mod sweep;

use crate::Outcome;
use crate::arguments::{Format, ThresholdOptions};
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output;
use crate::session::{Session, digits};
use lindstedt_melnikov::MelnikovError;
use request::Request;

pub fn run(options: &ThresholdOptions, session: &Session<'_>) -> Outcome {
    let digits = digits(&options.precision)?;
    let request = Request::read(options)?;
    output::check_writable(session)?;
    let request = request.watched(&session.stop());
    let mut answer = report::Answer::new(&request, digits, session).map_err(|failure| {
        // An orbit that was not followed to its end looks undecided.
        match failure.exit {
            UNDECIDED if !session.goes_on() => stopped(session),
            _ => failure,
        }
    })?;
    if let Some(largest) = options.subharmonics {
        answer.subharmonics = Some(subharmonics::list(&request, largest, digits, session)?);
    }
    let table = sweep::Table::compute(&request, options.precision.f64, session)?;
    session.done();
    let text = match session.format() {
        Format::Json => format!("{:#}\n", answer.json(table.as_ref(), session)),
        Format::Text => answer.text(table.as_ref()),
        Format::Latex => answer.latex(),
        Format::Markdown => answer.markdown(),
    };
    for path in &options.plot {
        let contents = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            sweep::csv(&request, table.as_ref(), &answer)
        } else {
            figure::draw(&request, table.as_ref())?
        };
        std::fs::write(path, contents)
            .map_err(|error| output::trouble(&path.display().to_string(), &error))?;
    }
    output::write(session, &text)?;
    if table.as_ref().is_some_and(|table| !table.finished) {
        output::warn("stopped; the rows not reached are empty");
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    Ok(0)
}

fn stopped(session: &Session<'_>) -> Failure {
    let interrupted = session.interrupted();
    Failure {
        exit: if interrupted { INTERRUPTED } else { UNDECIDED },
        code: if interrupted { "interrupted" } else { "limit-seconds" },
        message: "stopped before the threshold was found".to_owned(),
        hint: "fewer --digits take less time".to_owned(),
    }
}

impl From<MelnikovError> for Failure {
    fn from(error: MelnikovError) -> Self {
        Self::of(&error)
    }
}
