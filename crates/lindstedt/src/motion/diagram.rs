//! Bifurcation diagrams: the points of a section over a parameter, resumable.

use super::set_up;
use super::setup::Setup;
use super::{Section, Start, answer, increasing, precomputed, section};
use crate::grid::{Axis, Part};
use crate::refusal::Refused;
use crate::{Answer, Error, Oscillator, Progress, Remark, Standing, Status, Work};
use lindstedt_equation::Expression;
use lindstedt_simulate::{
    self as simulate, DiagramSettings, Doubles, Point, Quantity, Settings, Surface, Sweep, diagram,
};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::{ControlFlow, Range};
use std::time::Instant;

/// The question for a bifurcation diagram.
///
/// ```
/// use lindstedt::{Oscillator, Work, motion::Bifurcation};
/// let friction = Oscillator::builtin("stick-slip")?;
/// let question = Bifurcation { skipped: 50, kept: 4, ..Bifurcation::over("gamma=0.5..0.6:2") };
/// let answer = friction.bifurcation(&question, &Work::default())?;
/// assert_eq!(answer.value.sweep.columns.len(), 2);
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bifurcation {
    /// Where every motion starts.
    pub start: Start,
    /// `NAME=LO..HI:COUNT`, or NAME alone for the range that the problem file says.
    pub sweep: String,
    /// The section; by default at impacts, else once per period of the force, else at maxima of x.
    pub section: Option<Section>,
    /// Points left out at the beginning.
    pub skipped: u32,
    /// Points that are kept.
    pub kept: u32,
    /// Whether every value but the first starts from the last point of the one before, upwards and then down again.
    pub follow: bool,
    /// Only these of the values; of none that follow each other.
    pub part: Option<Part>,
}

impl Bifurcation {
    /// A diagram over a parameter, of 100 points per value after 200.
    #[must_use]
    pub fn over(sweep: &str) -> Self {
        let (start, sweep) = (Start::default(), sweep.to_owned());
        Self { start, sweep, section: None, skipped: 200, kept: 100, follow: false, part: None }
    }
}

/// The points over one value, or why there are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Column {
    /// The value.
    pub value: f64,
    /// The same as it would be written.
    pub exact: String,
    /// x and x' of each point; just before an impact.
    pub points: Vec<[f64; 2]>,
    /// Why the motion ended.
    pub failure: Option<String>,
    /// Whether it is one of the way down, where values [follow](Bifurcation::follow) each other.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub downwards: bool,
    /// The whole state at the last point, from which the next value starts where values follow each other; else empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub end: Vec<f64>,
}

/// Where finished columns are kept, so that a diagram that was stopped goes on.
pub trait Journal {
    /// The columns of an earlier run, in any order; nothing where the work is to be given up.
    /// `identity` is one line that determines every number; a column whose value is none of the
    /// diagram is not used, and what is missing between others is computed again.
    fn begin(&mut self, identity: &str) -> Option<Vec<Column>>;
    /// The next finished column; whether to go on.
    fn keep(&mut self, column: &Column) -> bool;
    /// All columns are there.
    fn complete(&mut self) {}
}

/// Nothing is kept.
impl Journal for () {
    fn begin(&mut self, _identity: &str) -> Option<Vec<Column>> {
        Some(Vec::new())
    }
    fn keep(&mut self, _column: &Column) -> bool {
        true
    }
}

/// What was swept.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Swept {
    /// The parameter.
    pub parameter: String,
    /// The section.
    pub section: Section,
    /// Points left out.
    pub skip: u32,
    /// Points kept.
    pub kept: u32,
    /// Doubles of whose error nothing is known.
    pub status: Status,
    /// One per finished value.
    pub columns: Vec<Column>,
    /// The same downwards, where values follow each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back: Option<Vec<Column>>,
}

/// The result of [`Oscillator::bifurcation`].
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Diagram {
    /// None: a section of a motion with perturbations that grow is typical of it.
    pub digits: Option<u32>,
    /// The start of every motion.
    pub start: answer::Begin,
    /// The motion before the start, in words, where there is a delay.
    pub history: Option<&'static str>,
    /// The columns.
    pub sweep: Swept,
    /// Whether all values are finished.
    pub complete: bool,
    /// In words.
    pub verdict: String,
}

/// What the numbers of a diagram are.
const TIER: &str = "doubles, without an error: a section of a motion with perturbations that grow is \
                    typical of it";

impl Oscillator {
    /// The points of a section over the values of a parameter, after a transient, every value from
    /// the same start; on all cores, in order. Where values [follow](Bifurcation::follow) each other, one after the other:
    /// of two attractors the motion stays at its own as long as there is one, which upwards and downwards is another.
    ///
    /// In doubles, without an error: of chaotic motion the points are typical, not those of one
    /// motion.
    ///
    /// # Errors
    /// [`Refused`] for a parameter that cannot be varied and for a section that there is not. A motion
    /// that fails is a column with its reason.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work, motion::Bifurcation};
    /// let question = Bifurcation { skipped: 20, kept: 3, ..Bifurcation::over("gamma=0.3..0.4:2") };
    /// let (belt, work) = (Oscillator::builtin("stick-slip")?, Work::default());
    /// let columns = belt.bifurcation(&question, &work)?.value.sweep.columns;
    /// assert!(columns.iter().all(|column| column.points.len() == 3));
    /// // With a journal that keeps nothing it is the same.
    /// assert_eq!(belt.bifurcation_resumed(&question, &work, &mut ())?.value.sweep.columns, columns);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn bifurcation(
        &self,
        question: &Bifurcation,
        work: &Work,
    ) -> Result<Answer<Diagram>, Error> {
        self.bifurcation_resumed(question, work, &mut ())
    }

    /// The same without what a journal has already; it is told every finished column.
    ///
    /// # Errors
    /// As there; [`Refused`] as stopped where the journal gives up.
    pub fn bifurcation_resumed(
        &self,
        question: &Bifurcation,
        work: &Work,
        journal: &mut dyn Journal,
    ) -> Result<Answer<Diagram>, Error> {
        let begin = Instant::now();
        let mut setup = set_up(self, &question.start, true, precomputed(work))?;
        let axis = self.swept(&question.sweep, &setup)?;
        setup.flow.forcing = setup.forcing_at(&axis)?;
        // What varies has no value of its own.
        setup.at.retain(|(name, value)| *name != axis.name || !value.is_empty());
        if question.follow && setup.orbit.is_some() {
            let message = "the orbit of the start is that of every value";
            return Err(Refused::usage("sweep", message, "--state X,V").into());
        }
        if question.kept == 0 {
            return Err(Refused::usage("sweep", "no points to keep", "--periods 100").into());
        }
        if question.follow && question.part.is_some() {
            let message = "values that follow each other have no parts";
            return Err(Refused::usage("sweep", message, "without --follow").into());
        }
        let section = section(question.section, true, &setup)?.unwrap_or(Section::Velocity);
        let mut values: Vec<Quantity> =
            axis.part(question.part).values.into_iter().map(Quantity::from).collect();
        let count = values.len();
        if question.follow {
            values.extend_from_within(..);
            values[count..].reverse();
        }
        let mut task = Task { question, setup, name: axis.name, section, values, count };
        let given_up = || Refused::stopped("the file of the sweep cannot be used", "");
        let kept = journal.begin(&task.identity()).ok_or_else(given_up)?;
        let (mut columns, lost) = task.known(kept);
        task.compute(&mut columns, work, journal)?;
        let complete = columns.iter().all(Option::is_some);
        let back =
            question.follow.then(|| columns.split_off(count).into_iter().flatten().collect());
        let columns: Vec<Column> = columns.into_iter().flatten().collect();
        let verdict = task.verdict(&columns, back.as_ref());
        let mut remarks = self.remarks().to_vec();
        remarks.extend(task.setup.remarks.drain(..).map(Remark));
        let done = columns.len();
        let lost = (!lost.is_empty()).then(|| {
            format!("{} = {}: lost in the journal, computed again", task.name, lost.join(", "))
        });
        remarks.extend(lost.map(Remark));
        if complete {
            journal.complete();
        } else {
            remarks.push(Remark("stopped; with --resume FILE it can be continued".to_owned()));
        }
        let value = Diagram {
            digits: None,
            start: answer::Begin::new(&task.setup),
            history: task.setup.history,
            sweep: Swept {
                parameter: task.name,
                section,
                skip: question.skipped,
                kept: question.kept,
                status: Status::Estimated,
                columns,
                back,
            },
            complete,
            verdict,
        };
        let header = self.header(task.setup.at, None, TIER, begin);
        let standing = if complete { Standing::Complete } else { Standing::Stopped { done } };
        Ok(Answer { header, value, standing, remarks })
    }

    /// The values to go through.
    fn swept(&self, text: &str, setup: &Setup) -> Result<Axis, Error> {
        let usage = |message: String, hint: &str| Refused::usage("sweep", message, hint);
        let name = text.split('=').next().unwrap_or_default().trim();
        let file = self.problem_file();
        let known = setup.sweepable.iter().any(|known| known == name);
        let text = match file.ranges.get(text.trim()) {
            Some(range) => format!("{name}={range}"),
            None if text.contains('=') => text.to_owned(),
            None if known => {
                let message = format!("{} gives no range for {name}", setup.name);
                return Err(usage(message, &format!("--sweep {name}=LO..HI:COUNT")).into());
            }
            None => {
                let message = format!("{text:?} is not NAME=LO..HI:COUNT");
                return Err(usage(message, "gamma=0.5..1:400").into());
            }
        };
        if file.fixed.iter().any(|fixed| fixed == name) {
            let message = format!("{name:?} is fixed in the file");
            return Err(usage(message, "take it out of `fixed`").into());
        }
        let axis = Axis::parse(&text)?;
        if !setup.sweepable.contains(&axis.name) {
            let hint = format!(
                "it can be one of: {}; what the start or the delays depend on is fixed",
                setup.sweepable.join(", ")
            );
            return Err(usage(format!("{name:?} cannot be varied here"), &hint).into());
        }
        increasing(&axis.values).map_err(|message| usage(message, "LO..HI:COUNT"))?;
        Ok(axis)
    }
}

/// A diagram to compute.
struct Task<'a> {
    question: &'a Bifurcation,
    setup: Setup,
    name: String,
    section: Section,
    /// All in the order in which they are gone through: upwards, and down again where they follow each other.
    values: Vec<Quantity>,
    /// How many there are upwards.
    count: usize,
}

impl Task<'_> {
    /// What determines every number.
    fn identity(&self) -> String {
        let others = self.setup.at.iter().filter(|(name, _)| *name != self.name);
        let others: Vec<String> = others.map(|(name, value)| format!("{name}={value}")).collect();
        let upwards = &self.values[..self.count];
        let ends = [upwards.first(), upwards.last()];
        let [low, high] = ends.map(|q| q.map(answer::shown).unwrap_or_default());
        let start: Vec<f64> = self.setup.flow.states().map(|q| q.float(64).to_f64()).collect();
        format!(
            "{} {}; {} = {low}..{high}:{}{}; start {start:?}; {:?}; skip {}, keep {}; {}",
            self.setup.name,
            others.join(" "),
            self.name,
            self.count,
            if self.question.follow { " and back" } else { "" },
            self.section,
            self.question.skipped,
            self.question.kept,
            self.setup.identity,
        )
    }

    /// The columns that were kept, each in its place, and the values that are missing before the last of them.
    fn known(&self, kept: Vec<Column>) -> (Vec<Option<Column>>, Vec<String>) {
        let key = |column: Column| ((column.exact.clone(), column.downwards), column);
        let mut kept: HashMap<_, Column> = kept.into_iter().map(key).collect();
        let shown: Vec<String> = self.values.iter().map(answer::shown).collect();
        let places = shown.iter().enumerate();
        let columns: Vec<Option<Column>> =
            places.map(|(i, value)| kept.remove(&(value.clone(), i >= self.count))).collect();
        let last = columns.iter().rposition(Option::is_some).unwrap_or(0);
        let places = columns.iter().zip(&shown).take(last);
        let lost = places.filter(|(column, _)| column.is_none()).map(|(_, value)| value.clone());
        let lost = lost.collect();
        (columns, lost)
    }

    fn verdict(&self, columns: &[Column], back: Option<&Vec<Column>>) -> String {
        let all = || columns.iter().chain(back.into_iter().flatten());
        let count: usize = all().map(|column| column.points.len()).sum();
        let empty = all().filter(|column| column.points.is_empty()).count();
        let ways = match back {
            Some(_) => " upwards and downwards, each from the end of the one before",
            None => "",
        };
        let (done, values) = (columns.len(), self.count);
        format!(
            "{done} of {values} values of {}{ways}, {empty} without points, {count} points in all",
            self.name
        )
    }

    /// The columns that are missing.
    fn compute(
        &self,
        columns: &mut [Option<Column>],
        work: &Work,
        journal: &mut dyn Journal,
    ) -> Result<(), Error> {
        let mut model = self.setup.flow.model.clone();
        if self.section == Section::Velocity {
            model = model.with_section(Expression::VELOCITY);
        }
        let forcing = self.setup.flow.forcing.as_ref().map_or(10.0, |q| q.float(64).to_f64());
        let events = |surface, rising| simulate::Section::Events {
            surface,
            rising,
            patience: 100.0 * forcing,
        };
        let start: Vec<f64> = self.setup.flow.states().map(|q| q.float(64).to_f64()).collect();
        let mut settings = DiagramSettings {
            time: 0.0,
            start: start.clone(),
            section: match self.section {
                Section::Stroboscopic => simulate::Section::Period(forcing),
                Section::Impact => events(Surface::Wall(0), None),
                Section::Velocity => events(Surface::Section(0), Some(false)),
            },
            periods: self.periods()?,
            transient: self.question.skipped,
            kept: self.question.kept,
            // What follows is computed one by one: only so a kept column can be followed, too.
            follow: false,
            integration: Settings { most_impacts: 10_000_000, ..Settings::for_digits(16) },
        };
        let sweep = Sweep {
            model: &model,
            parameters: &self.setup.flow.parameters,
            name: &self.name,
            values: &self.values,
        };
        let flow = |on: bool| if on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let tick = || flow(!work.stop.asked());
        let (all, mut done) = (columns.len(), columns.iter().flatten().count());
        let mut goes_on = true;
        for range in gaps(columns, self.question.follow) {
            let before = range.start.checked_sub(1).and_then(|i| columns.get(i)?.as_ref());
            let end = before.map(|column| &column.end).filter(|end| end.len() == start.len());
            settings.start.clone_from(end.unwrap_or(&start));
            let last = range.end;
            let next = diagram(&sweep, &Doubles, &settings, range, &tick, &mut |found| {
                let place = self.values.get(found.index).zip(columns.get_mut(found.index));
                let Some((value, place)) = place else { return flow(false) };
                let column = self.column(found.index, value, &found.points);
                goes_on = journal.keep(&column);
                if goes_on {
                    *place = Some(column);
                    done += 1;
                }
                goes_on &= work.goes_on(Progress::Parts(done, all));
                flow(goes_on)
            });
            if next < last || !goes_on {
                break;
            }
        }
        Ok(())
    }

    fn column(
        &self,
        place: usize,
        value: &Quantity,
        points: &Result<Vec<Point<f64>>, simulate::SimulateError>,
    ) -> Column {
        let pair = |p: &Point<f64>| {
            let state = if self.section == Section::Impact { &p.before } else { &p.state };
            match state[..] {
                [x, v, ..] => [x, v],
                _ => [f64::NAN; 2],
            }
        };
        let end = points.as_ref().ok().and_then(|points| points.last());
        let end = end.filter(|_| self.question.follow).map(|point| point.state.clone());
        Column {
            value: value.float(53).to_f64(),
            exact: answer::shown(value),
            points: points.iter().flatten().map(pair).collect(),
            failure: points.as_ref().err().map(ToString::to_string),
            downwards: place >= self.count,
            end: end.unwrap_or_default(),
        }
    }

    /// The period of the force per value, where it depends on the parameter.
    fn periods(&self) -> Result<Vec<f64>, Error> {
        if self.section != Section::Stroboscopic {
            return Ok(Vec::new());
        }
        self.values.iter().filter_map(|value| self.setup.period_at(&self.name, value)).collect()
    }
}

impl Swept {
    /// Which coordinate tells the points apart: 0 for x, 1 for x'; and what it is.
    #[must_use]
    pub fn ordinate(&self) -> (usize, &'static str) {
        match self.section {
            Section::Impact => (1, "velocity x' before impact"),
            Section::Velocity => (0, "maximum of x"),
            Section::Stroboscopic => (0, "displacement x"),
        }
    }
}

/// The runs of what is missing, or each by itself.
fn gaps(columns: &[Option<Column>], single: bool) -> Vec<Range<usize>> {
    let mut gaps: Vec<Range<usize>> = Vec::new();
    for (i, _) in columns.iter().enumerate().filter(|(_, column)| column.is_none()) {
        match gaps.last_mut().filter(|gap| !single && gap.end == i) {
            Some(gap) => gap.end = i + 1,
            None => gaps.push(i..i + 1),
        }
    }
    gaps
}
