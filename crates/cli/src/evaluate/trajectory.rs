//! x(t) at asked times: table, comma-separated values, figure.

use super::{figure, flag};
use crate::arguments::EvaluateOptions;
use crate::failure::Failure;
use crate::session::Session;
use crate::session::number_json;
use lindstedt::Exact;
use lindstedt::equation::Problem;
use lindstedt::evaluate::{Displacement, Trajectory};
use lindstedt::number::ball::Balls;
use plotters::prelude::BLUE;
use rayon::prelude::*;
use rug::Rational;
use serde_json::{Value as Json, json};
use std::fmt::Write;
use std::path::Path;

/// The most times of one table.
const MOST_TIMES: u32 = 100_000;
/// Points of a figure for which no times are given.
const POINTS: u32 = 129;
/// Times between two looks at the clock.
const BLOCK: usize = 16;

/// The times asked for.
pub struct Request {
    /// Nothing: one period.
    range: Option<(Rational, Rational)>,
    count: u32,
}

fn usage(text: &str) -> Failure {
    let shown: String = text.chars().take(60).collect();
    let hint = "--times LO..HI:COUNT, for example 0..10:101";
    Failure::usage("range", format!("cannot read the times {shown:?}"), hint)
}

/// The number, or the double next to a multiple of pi.
fn rational(text: &str) -> Result<Rational, Failure> {
    let value = Exact::parse(text)?;
    let nearest = || value.ball(Balls::new(200)).midpoint().to_rational();
    value.as_rational().cloned().or_else(nearest).ok_or_else(|| usage(text))
}

impl Request {
    /// Nothing unless --times, --plot or --code ask for the solution.
    pub fn read(options: &EvaluateOptions) -> Result<Option<Self>, Failure> {
        let is = |path: &Path, kind: &str| {
            path.extension().is_some_and(|e| e.eq_ignore_ascii_case(kind))
        };
        if let Some(path) = options.plot.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
            let message = format!("cannot plot to {}", path.display());
            return Err(Failure::usage("plot", message, "the name must end in .svg or .csv"));
        }
        let Some(text) = &options.times else {
            let asked = !options.plot.is_empty() || options.code.is_some();
            return Ok(asked.then_some(Self { range: None, count: POINTS }));
        };
        let (low, rest) = text.split_once("..").ok_or_else(|| usage(text))?;
        let (high, count) = rest.rsplit_once(':').ok_or_else(|| usage(text))?;
        let count: u32 = count.trim().parse().map_err(|_| usage(text))?;
        if count == 0 || count > MOST_TIMES {
            let message = format!("1 to {MOST_TIMES} times, not {count}");
            return Err(Failure::usage("range", message, ""));
        }
        Ok(Some(Self { range: Some((rational(low)?, rational(high)?)), count }))
    }

    /// The times, from 0 to `last` where none were given.
    pub fn times(&self, last: f64) -> Vec<Exact> {
        let (low, high) = self
            .range
            .clone()
            .unwrap_or_else(|| (Rational::new(), Rational::from_f64(last).unwrap_or_default()));
        let width = (high - &low) / Rational::from(self.count.saturating_sub(1).max(1));
        (0..self.count).map(|i| Exact::Rational(Rational::from(&width * i) + &low)).collect()
    }
}

/// x(t) at the times asked for.
pub struct Table {
    points: Vec<Displacement>,
    order: usize,
    resum: String,
    pub finished: bool,
}

impl Table {
    pub fn compute(
        request: &Request,
        trajectory: &Trajectory,
        session: &Session<'_>,
    ) -> Result<Self, Failure> {
        let times = request.times(trajectory.period);
        let mut points = Vec::new();
        for block in times.chunks(BLOCK) {
            if !session.goes_on() {
                break;
            }
            session.say(format!("x(t): {} of {}", points.len(), times.len()));
            points.par_extend(block.par_iter().map(|time| trajectory.at(time)));
        }
        let finished = points.len() == times.len();
        let methods: Vec<&str> = trajectory.methods().iter().map(|m| flag(*m)).collect();
        let (order, resum) = (trajectory.order(), methods.join(" or "));
        Ok(Self { points, order, resum, finished })
    }

    /// Time, value, `+- error` as text; the last is empty where no digit is known.
    pub fn rows(&self) -> impl Iterator<Item = [String; 3]> {
        self.points.iter().map(|point| {
            let time = point.time.ball(Balls::new(64)).midpoint().to_f64();
            let Some(number) = &point.value else {
                return [format!("{time:?}"), "not one digit".to_owned(), String::new()];
            };
            // The bound belongs to the digits that are printed.
            let error = match &number.error {
                Some(error) => format!("+- {error}"),
                None => "(no estimate)".to_owned(),
            };
            [format!("{time:?}"), number.decimal.clone(), error]
        })
    }

    pub fn json(&self) -> Json {
        let values: Vec<Json> = self
            .points
            .iter()
            .map(|point| {
                // Without a digit that the estimate supports there is no decimal to print.
                let none = || json!({"exact": null, "decimal": null, "error": null, "status": "estimated"});
                let number = point.value.as_ref().map_or_else(none, number_json);
                json!({"t": point.time.to_string(), "x": number})
            })
            .collect();
        json!({"order": self.order, "resum": self.resum, "values": values})
    }

    pub fn text(&self) -> String {
        let mut text = format!("\n  x(t), order {}, summed by {}\n", self.order, self.resum);
        for [time, value, error] in self.rows() {
            let line = format!("  {time:<22} {value:<34} {error}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }

    /// The contents of a .csv or .svg file.
    pub fn file(&self, path: &Path, problem: &Problem) -> Result<String, Failure> {
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            let mut text = String::from("t,x,error\n");
            for point in &self.points {
                let time = point.time.ball(Balls::new(64)).midpoint().to_f64();
                let _ = writeln!(text, "{time:?},{:?},{:e}", point.double, point.error);
            }
            return Ok(text);
        }
        let at = |point: &Displacement| point.time.ball(Balls::new(64)).midpoint().to_f64();
        let points = self.points.iter().map(|point| (at(point), point.double)).collect();
        let caption = format!("{}: x(t), order {}, {}", problem.name, self.order, self.resum);
        figure::draw(&caption, "x", &[(points, BLUE)])
    }
}
