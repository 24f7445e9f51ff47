//! One or two swept parameters, and what was computed at their values.

use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, Progress, Standing, Work};
use lindstedt_algebra::Stop;
use lindstedt_problem_file::canonical_name;
use rayon::prelude::*;
use rug::{Integer, Rational};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::str::FromStr;

/// So many points are shared out to the cores at a time.
const BLOCK: usize = 1 << 10;
/// The most values of an axis.
const MOST_VALUES: usize = 1_000_000;

/// The values of a swept parameter, in order.
///
/// ```
/// use lindstedt::grid::Axis;
/// let axis: Axis = "omega=1..2:3".parse()?;
/// assert_eq!(axis.doubles(), [1.0, 1.5, 2.0]);
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The parameter.
    pub name: String,
    /// Its values, exact.
    pub values: Vec<Exact>,
}

/// A part of the work over an axis: so many of its values from one on. What is computed there is what the whole has
/// there, bit by bit.
pub type Part = (usize, usize);

impl Axis {
    /// The first axis of a sweep, and the second.
    ///
    /// # Errors
    /// That of an axis; [`Refused`] for a third one.
    pub fn pair(
        axes: impl IntoIterator<Item = Result<Self, Error>>,
    ) -> Result<(Option<Self>, Option<Self>), Error> {
        let mut axes = axes.into_iter();
        let pair = (axes.next().transpose()?, axes.next().transpose()?);
        let message = "at most two parameters are swept";
        let refused = || Refused::usage("sweep", message, "one --sweep or two").into();
        axes.next().map_or(Ok(pair), |_| Err(refused()))
    }

    /// The values of a part.
    pub(crate) fn part(&self, part: Option<Part>) -> Self {
        let (first, count) = part.unwrap_or((0, self.values.len()));
        let values = self.values.iter().skip(first).take(count).cloned().collect();
        Self { name: self.name.clone(), values }
    }

    /// At most so many of the values at equal distances, both ends among them.
    pub(crate) fn every(&self, most: usize) -> Self {
        let last = self.values.len().max(1) - 1;
        let stride = last.div_ceil(most.max(2) - 1).max(1);
        let mut values: Vec<Exact> = self.values.iter().step_by(stride).cloned().collect();
        if !last.is_multiple_of(stride) {
            values.extend(self.values.last().cloned());
        }
        Self { name: self.name.clone(), values }
    }

    /// Reads `NAME=LO..HI:COUNT` (equal steps, both ends included, exact) or `NAME=V1,V2,...`.
    ///
    /// # Errors
    /// [`Refused`] with the form that is expected, [`DerivationError::BadValue`](crate::DerivationError::BadValue).
    ///
    /// ```
    /// use lindstedt::grid::Axis;
    /// let axis = Axis::parse("amplitude=0..1:5")?;
    /// let values: Vec<String> = axis.values.iter().map(ToString::to_string).collect();
    /// assert_eq!(values, ["0", "1/4", "1/2", "3/4", "1"]);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, Error> {
        Self::parse_until(text, &Stop::default())
    }

    /// As [`Axis::parse`]; a million exact values take a good part of a second, which `stop` breaks off.
    ///
    /// # Errors
    /// As [`Axis::parse`], and [`Kind::Stopped`](crate::Kind::Stopped).
    pub fn parse_until(text: &str, stop: &Stop) -> Result<Self, Error> {
        let usage = |message: String| {
            Error::from(Refused::usage("sweep", message, "NAME=LO..HI:COUNT, as in omega=0..1:11"))
        };
        let Some((name, range)) = text.split_once('=') else {
            return Err(usage(format!("{text:?} is no range")));
        };
        let name = canonical_name(name.trim());
        let values = match range.split_once("..") {
            None => range.split(',').map(Exact::parse).collect::<Result<_, _>>()?,
            Some((low, rest)) => {
                let (high, count) =
                    rest.rsplit_once(':').ok_or_else(|| usage(format!("{text:?} has no count")))?;
                let number = count.trim().parse().ok();
                let count = number.filter(|n| (1..=MOST_VALUES).contains(n)).ok_or_else(|| {
                    usage(format!("a range has 1 to {MOST_VALUES} values, not {count}"))
                })?;
                let (low, high) = (Exact::parse(low)?, Exact::parse(high)?);
                let value = steps(&low, &high, count)
                    .ok_or_else(|| usage(format!("{text:?} mixes numbers and multiples of pi")))?;
                let value = |i| (i % BLOCK != 0 || !stop.asked()).then(|| value(i));
                let all: Option<Vec<Exact>> = (0..count).map(value).collect();
                let message = "stopped before the values of the sweep were there";
                all.ok_or_else(|| Refused::stopped(message, ""))?
            }
        };
        Ok(Self { name, values })
    }

    /// Reads the ends of a range, `NAME=LO..HI`, exact: an axis of two values.
    ///
    /// # Errors
    /// As [`Axis::parse`].
    pub fn ends(text: &str) -> Result<Self, Error> {
        let parts =
            text.split_once('=').and_then(|(name, range)| Some((name, range.split_once("..")?)));
        let Some((name, (low, high))) = parts else {
            let shown: String = text.chars().take(60).collect();
            let message = format!("cannot read the range {shown:?}");
            return Err(Refused::usage("range", message, "NAME=LO..HI, as in omega=0..1").into());
        };
        let values = vec![Exact::parse(low)?, Exact::parse(high)?];
        Ok(Self { name: canonical_name(name.trim()), values })
    }

    /// Whether the values have equal steps.
    #[must_use]
    pub fn is_equidistant(&self) -> bool {
        let values = self.doubles();
        let (Some(first), Some(last)) = (values.first(), values.last()) else { return true };
        let step = (last - first) / (values.len().max(2) - 1) as f64;
        let off = |(n, x): (usize, &f64)| (first + step * n as f64 - x).abs() > 1e-9 * step.abs();
        !values.iter().enumerate().any(off)
    }

    /// The values as doubles, for tables and figures.
    #[must_use]
    pub fn doubles(&self) -> Vec<f64> {
        self.values.iter().map(Exact::to_f64).collect()
    }
}

impl FromStr for Axis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text)
    }
}

/// Refuses points of so many bytes that need more than twice the memory there is.
///
/// # Errors
/// [`Refused`] with what they need.
pub fn check_room(points: usize, bytes: usize, work: &Work) -> Result<(), Error> {
    let needed = points.saturating_mul(bytes) as u64;
    if needed / 2 <= work.memory {
        return Ok(());
    }
    let (needed, limit) = (needed >> 20, work.memory >> 20);
    let message = format!("{points} points need {needed} MiB, the limit is {limit} MiB");
    let hint = "fewer values, or raise --limit-memory";
    Err(Refused::undecided("too-large", message, hint).into())
}

/// The value of every number below `count`, from `low` to `high` in equal steps; nothing where only one end is a multiple of
/// pi other than zero.
fn steps<'a>(
    low: &'a Exact,
    high: &'a Exact,
    count: usize,
) -> Option<impl Fn(usize) -> Exact + 'a> {
    let (a, b, in_pi) = match (low, high) {
        (Exact::Rational(a), Exact::Rational(b)) => (a, b, false),
        (Exact::PiTimes(a), Exact::PiTimes(b)) => (a, b, true),
        (Exact::Rational(a), Exact::PiTimes(b)) if a.is_zero() => (a, b, true),
        (Exact::PiTimes(a), Exact::Rational(b)) if b.is_zero() => (a, b, true),
        _ => return None,
    };
    let last = count.saturating_sub(1).max(1);
    let step = Rational::from(b - a) / Integer::from(last);
    Some(move |i: usize| {
        let q = Rational::from(&step * Integer::from(i)) + a;
        if in_pi { Exact::PiTimes(q) } else { Exact::Rational(q) }
    })
}

/// What was computed at every point of one or two axes; row by row, the first axis along the columns.
///
/// ```
/// use lindstedt::{Work, grid::{Axis, Grid}};
/// let squares = Grid::compute(Axis::parse("a=0..3:4")?, None, &Work::default(), |a, _| a.to_f64().powi(2));
/// assert_eq!(squares.points, [Some(0.0), Some(1.0), Some(4.0), Some(9.0)]);
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Grid<T> {
    /// The first swept parameter.
    pub columns: Axis,
    /// The second, if there is one.
    pub rows: Option<Axis>,
    /// The points; nothing where there is none. Where the work was stopped those that come later are missing.
    pub points: Vec<Option<T>>,
}

impl<T: Send> Grid<T> {
    /// Computes every point, on all cores and in order but for what the cores share out: of stopped work the first
    /// points are there.
    /// `point` is given the value of the first parameter, then that of the second.
    pub fn compute(
        columns: Axis,
        rows: Option<Axis>,
        work: &Work,
        point: impl Fn(&Exact, Option<&Exact>) -> T + Sync,
    ) -> Self {
        let width = columns.values.len();
        let height = rows.as_ref().map_or(1, |axis| axis.values.len());
        let done = std::sync::atomic::AtomicUsize::new(0);
        let at = |index: usize| {
            if work.stop.asked() {
                return None;
            }
            let second = rows.as_ref().and_then(|axis| axis.values.get(index / width));
            let found = point(columns.values.get(index % width)?, second);
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            work.tell(Progress::Parts(done, width * height));
            Some(found)
        };
        let (all, mut points) = (width * height, Vec::new());
        for first in (0..all).step_by(BLOCK) {
            if work.stop.asked() {
                break;
            }
            points.par_extend((first..all.min(first + BLOCK)).into_par_iter().map(at));
        }
        Self { columns, rows, points }
    }
}

impl<T: Send> Grid<T> {
    /// What a question to the same oscillator with the values of every point gives, each in silence.
    pub(crate) fn of_cases(
        oscillator: &Oscillator,
        columns: Axis,
        rows: Option<Axis>,
        work: &Work,
        ask: impl Fn(&Oscillator, &Work) -> T + Sync,
    ) -> Self {
        let names = [&columns].into_iter().chain(&rows).map(|axis| axis.name.clone());
        let (names, silent) = (Vec::from_iter(names), Work { progress: None, ..work.clone() });
        Self::compute(columns, rows, work, |x, y| {
            let values = names.iter().zip([x].into_iter().chain(y));
            let case = oscillator.clone();
            ask(&values.fold(case, |case, (name, value)| case.with(name, value.clone())), &silent)
        })
    }
}

impl<T> Grid<T> {
    /// Complete, or stopped after so many points.
    pub(crate) fn standing(&self) -> Standing {
        let done = self.done();
        if self.is_complete() { Standing::Complete } else { Standing::Stopped { done } }
    }

    /// `columns`, `rows`, and `points` in order.
    pub(crate) fn serialize_with<'a, S: Serializer, P: Serialize>(
        &'a self,
        serializer: S,
        point: impl Fn(&'a Exact, Option<&'a Exact>, Option<&'a T>) -> P,
    ) -> Result<S::Ok, S::Error> {
        let points: Vec<P> = self.iter().map(|(x, y, found)| point(x, y, found)).collect();
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("columns", &self.columns)?;
        map.serialize_entry("rows", &self.rows)?;
        map.serialize_entry("points", &points)?;
        map.end()
    }

    /// The same grid with something else at its points.
    pub fn map<U>(self, point: impl Fn(T) -> Option<U>) -> Grid<U> {
        let Self { columns, rows, points } = self;
        let points = points.into_iter().map(|found| point(found?)).collect();
        Grid { columns, rows, points }
    }

    /// The number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.columns.values.len().max(1)
    }

    /// The first axis, then the second.
    pub fn axes(&self) -> impl Iterator<Item = &Axis> {
        [&self.columns].into_iter().chain(&self.rows)
    }

    /// The number of points that were reached.
    #[must_use]
    pub fn done(&self) -> usize {
        self.points.iter().flatten().count()
    }

    /// Whether all points were reached.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let height = self.rows.as_ref().map_or(1, |rows| rows.values.len());
        self.done() == self.columns.values.len() * height
    }

    /// The value of the first parameter, that of the second, and the point; in order.
    pub fn iter(&self) -> impl Iterator<Item = (&Exact, Option<&Exact>, Option<&T>)> {
        let width = self.width();
        self.points.iter().enumerate().filter_map(move |(index, point)| {
            let second = self.rows.as_ref().and_then(|axis| axis.values.get(index / width));
            Some((self.columns.values.get(index % width)?, second, point.as_ref()))
        })
    }
}

impl Serialize for Axis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut object = serializer.serialize_struct("Axis", 2)?;
        object.serialize_field("parameter", &self.name)?;
        let values: Vec<String> = self.values.iter().map(ToString::to_string).collect();
        object.serialize_field("values", &values)?;
        object.end()
    }
}
