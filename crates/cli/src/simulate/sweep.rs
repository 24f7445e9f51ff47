//! Bifurcation diagrams, resumable.
//!
//! The file of a sweep begins with what was asked and has one line per finished value. Columns are
//! written in order, each with one write, so whatever ends the program leaves whole lines but for
//! the last; what is not whole is computed again, with the same numbers.

use super::column::Line;
use super::plot::{BLUE, FINE, chart};
use super::report::PRINTED;
use super::request::{range, section};
use super::setup::Setup;
use crate::arguments::{Section, SimulateOptions};
use crate::failure::{FILE, Failure};
use crate::output::trouble;
use crate::session::Session;
use lindstedt::simulate::{
    self, DiagramSettings, Doubles, Quantity, Settings, Surface, Sweep, diagram,
};
use plotters::prelude::*;
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::Path;

/// Points of the section per value.
const KEPT: u32 = 100;
const TRANSIENT: u32 = 200;

/// A diagram.
pub struct Diagram {
    pub setup: Setup,
    pub name: String,
    pub section: Section,
    pub values: Vec<Quantity>,
    pub transient: u32,
    pub kept: u32,
    /// One per finished value.
    pub lines: Vec<Line>,
}

impl Diagram {
    pub fn read(options: &SimulateOptions, setup: Setup, text: &str) -> Result<Self, Failure> {
        let usage = |message: String, hint: &str| Failure::usage("sweep", message, hint);
        let Some((name, values)) = text.split_once('=') else {
            let name = text.trim();
            let (message, hint) = if setup.sweepable.iter().any(|known| known == name) {
                let message = format!("{} gives no range for {name}", setup.name);
                (message, format!("--sweep {name}=LO..HI:COUNT"))
            } else {
                (format!("{text:?} is not NAME=LO..HI:COUNT"), "gamma=0.5..1:400".to_owned())
            };
            return Err(usage(message, &hint));
        };
        let name = name.trim().to_owned();
        if setup.fixed.contains(&name) {
            return Err(usage(format!("{name:?} is fixed in the file"), "take it out of `fixed`"));
        }
        if !setup.sweepable.contains(&name) {
            let hint = format!(
                "it can be one of: {}; what the start or the delays depend on is fixed",
                setup.sweepable.join(", ")
            );
            return Err(usage(format!("{name:?} cannot be varied here"), &hint));
        }
        if options.until.is_some() || options.times.is_some() {
            let message = "a sweep counts points: --periods or --impacts, and --skip".to_owned();
            return Err(usage(message, ""));
        }
        let kept = options.periods.or(options.impacts).unwrap_or(KEPT);
        if kept == 0 {
            return Err(usage("no points to keep".to_owned(), "--periods 100"));
        }
        let usual = Section::Velocity;
        Ok(Self {
            name,
            section: section(options, &setup)?.unwrap_or(usual),
            values: range("sweep", values)?,
            transient: options.skip.unwrap_or(TRANSIENT),
            kept,
            lines: Vec::new(),
            setup,
        })
    }

    /// What determines every number of the file.
    fn heading(&self) -> String {
        let list: Vec<String> = (self.setup.at.iter())
            .filter(|(name, _)| *name != self.name)
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        let ends = [self.values.first(), self.values.last()];
        let ends = ends.map(|q| q.map_or(f64::NAN, |q| q.float(64).to_f64()));
        let start = self.setup.start.each_ref().map(|q| q.float(64).to_f64());
        format!(
            "# lindstedt bifurcation 3: {} {}; {} = {:?}..{:?}:{}; start {start:?}; {:?}; skip {}, keep {}; x,v per point; {}\n",
            self.setup.name,
            list.join(" "),
            self.name,
            ends[0],
            ends[1],
            self.values.len(),
            self.section,
            self.transient,
            self.kept,
            self.setup.identity,
        )
    }

    /// Computes the diagram, from where the file ends; whether it is complete.
    pub fn compute(&mut self, file: Option<&Path>, session: &Session<'_>) -> Result<bool, Failure> {
        let mut written = match file {
            Some(path) => Some((path, self.open(path)?)),
            None => None,
        };
        let mut model = self.setup.model.clone();
        if self.section == Section::Velocity {
            model = model.with_section(lindstedt::equation::Expression::VELOCITY);
        }
        let forcing = self.setup.forcing.as_ref().map_or(10.0, |q| q.float(64).to_f64());
        let patience = 100.0 * forcing;
        let wall = Surface::Wall(0);
        let place = match self.section {
            Section::Stroboscopic => simulate::Section::Period(forcing),
            Section::Impact => simulate::Section::Events { surface: wall, rising: None, patience },
            Section::Velocity => simulate::Section::Events {
                surface: Surface::Section(0),
                rising: Some(false),
                patience,
            },
        };
        let settings = DiagramSettings {
            time: 0.0,
            start: self.setup.start.iter().map(|q| q.float(64).to_f64()).collect(),
            section: place,
            periods: self.periods()?,
            transient: self.transient,
            kept: self.kept,
            follow: false,
            integration: Settings { most_impacts: 10_000_000, ..Settings::for_digits(16) },
        };
        let parameters = self.setup.parameters.clone();
        let (values, name, section) = (self.values.clone(), self.name.clone(), self.section);
        let sweep = Sweep { model: &model, parameters: &parameters, name: &name, values: &values };
        let mut failed = None;
        let tick =
            || if session.goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let range = self.lines.len()..values.len();
        let next = diagram(&sweep, &Doubles, &settings, range, &tick, &mut |column| {
            session.say(format!("{name}: {} of {}", column.index + 1, values.len()));
            let line = Line::of(&column, &values, section);
            if let Some((path, file)) = &mut written
                && let Err(error) = file.write_all(line.text(column.index).as_bytes())
            {
                failed = Some(trouble(&path.display().to_string(), &error));
                return ControlFlow::Break(());
            }
            self.lines.push(line);
            tick()
        });
        match failed {
            Some(failure) => Err(failure),
            None => Ok(next >= values.len()),
        }
    }

    /// The period of the force per value, where it depends on the parameter.
    fn periods(&self) -> Result<Vec<f64>, Failure> {
        if self.section != Section::Stroboscopic {
            return Ok(Vec::new());
        }
        self.values.iter().filter_map(|value| self.setup.period_at(&self.name, value)).collect()
    }

    /// Opens the file of the sweep: reads the whole lines, cuts off the rest.
    fn open(&mut self, path: &Path) -> Result<std::fs::File, Failure> {
        let wrong = |error: &std::io::Error| trouble(&path.display().to_string(), error);
        let heading = self.heading();
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(wrong(&error)),
        };
        // A heading that is cut short is one that the program did not finish writing.
        if !text.starts_with(&heading) && !heading.starts_with(&text) {
            return Err(Failure {
                exit: FILE,
                code: "file",
                message: format!("{} belongs to another sweep", path.display()),
                hint: "give another file to --resume".into(),
            });
        }
        let mut kept = heading.clone();
        for line in text.strip_prefix(&heading).unwrap_or("").split_inclusive('\n') {
            let index = self.lines.len();
            let Some(value) = self.values.get(index) else { break };
            let Some(read) = Line::read(line, index, value) else { break };
            self.lines.push(read);
            kept += line;
        }
        let options =
            std::fs::OpenOptions::new().write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(|e| wrong(&e))?;
        if !text.starts_with(&heading) {
            file.write_all(heading.as_bytes()).map_err(|e| wrong(&e))?;
        }
        file.set_len(kept.len() as u64).map_err(|e| wrong(&e))?;
        std::io::Seek::seek(&mut file, std::io::SeekFrom::End(0)).map_err(|e| wrong(&e))?;
        Ok(file)
    }

    /// Which coordinate tells the points apart.
    fn ordinate(&self) -> (usize, &'static str) {
        match self.section {
            Section::Impact => (1, "velocity x' before impact"),
            Section::Velocity => (0, "maximum of x"),
            Section::Stroboscopic => (0, "displacement x"),
        }
    }

    pub fn figure(&self) -> Result<String, Failure> {
        let (k, up) = self.ordinate();
        let points: Vec<(f64, f64)> = (self.lines.iter())
            .flat_map(|line| line.points.iter().map(move |point| (line.value, point[k])))
            .collect();
        let title = format!(
            "{}: bifurcation diagram, {} values, {} points each after {}",
            self.setup.name,
            self.lines.len(),
            self.kept,
            self.transient
        );
        let labels = (format!("{} (dimensionless)", self.name), format!("{up} (dimensionless)"));
        chart(&title, &labels, &[], &points, |chart| {
            // One small square per point keeps the file small.
            let (style, side) = (BLUE.mix(0.7).filled(), FINE as i32);
            let dot = |p: &(f64, f64)| {
                EmptyElement::at(*p) + Rectangle::new([(0, 0), (side, side)], style)
            };
            chart.draw_series(points.iter().map(dot))?;
            Ok(())
        })
    }

    /// What the points span, per value; the points themselves belong into a file.
    pub fn text(&self, verdict: &str) -> String {
        let (k, what) = self.ordinate();
        let mut text = format!("{}: {verdict}\n", self.setup.name);
        let [x, v] = self.setup.start.each_ref().map(|q| q.float(64).to_f64());
        let _ = writeln!(text, "  start of every column: x = {x:?}, x' = {v:?}");
        for remark in &self.setup.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        let _ = writeln!(text, "  {:<24}  {:>6}  {what}: least, largest", self.name, "points");
        for line in self.lines.iter().take(PRINTED) {
            let _ = match (&line.failure, line.span(k)) {
                (Some(reason), _) => writeln!(text, "  {:<24}  {reason}", line.exact),
                (None, None) => {
                    let why = "the events of the section cease before";
                    writeln!(text, "  {:<24}  {:>6}  {why}", line.exact, 0)
                }
                (None, Some([least, largest])) => {
                    let count = line.points.len();
                    let few = count < self.kept as usize;
                    let ceased = if few { "  then the events cease" } else { "" };
                    let span = format!("{least:.9}  {largest:.9}");
                    writeln!(text, "  {:<24}  {count:>6}  {span}{ceased}", line.exact)
                }
            };
        }
        if self.lines.len() > PRINTED {
            let count = self.lines.len();
            let _ = writeln!(text, "  ... {count} in all (--format json, --plot FILE.csv)");
        }
        text
    }

    pub fn csv(&self) -> String {
        let mut text = self.heading();
        let _ = writeln!(text, "{},x,v", self.name);
        for line in &self.lines {
            for [x, v] in &line.points {
                // What has no end as a decimal number is rounded: a column of numbers.
                let value = if line.exact.contains(['/', 'p']) {
                    format!("{:?}", line.value)
                } else {
                    line.exact.clone()
                };
                let _ = writeln!(text, "{value},{x:?},{v:?}");
            }
        }
        text
    }
}
