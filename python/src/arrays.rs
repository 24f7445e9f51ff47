//! What crosses as arrays: functions of many points, charts, surfaces, diagrams.

use crate::found::written;
use crate::options::Options;
use crate::verbs;
use crate::work::Means;
use lindstedt::evaluate::averaged;
use lindstedt::evaluate::{Estimated, FrequencyFunction, PeriodicSolution, SolutionFunction};
use lindstedt::grid::{Grid, Part, check_room};
use lindstedt::motion::Bifurcation;
use lindstedt::unstable::impact::map::Verdict;
use lindstedt::{Answer, Error, Exact, Oscillator, Refused, Stability, Standing, Threshold, Work};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// One array after the other.
type Pair<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

fn pair(py: Python<'_>, list: Vec<Estimated>) -> Pair<'_> {
    let values: Vec<f64> = list.iter().map(|found| found.value).collect();
    let errors: Vec<f64> = list.into_iter().map(|found| found.error).collect();
    (values.into_pyarray(py), errors.into_pyarray(py))
}

/// omega(small, amplitude), and the amplitude of the case.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Frequency(pub Answer<FrequencyFunction>, pub Option<f64>);

#[pymethods]
impl Frequency {
    /// Header, parameters and methods as JSON.
    fn json(&self) -> PyResult<String> {
        written(&self.0)
    }

    /// The amplitude that the case has.
    #[getter]
    fn amplitude(&self) -> Option<f64> {
        self.1
    }

    /// omega and its estimated errors; an array of length one is that value everywhere.
    fn at<'py>(
        &self,
        py: Python<'py>,
        small: PyReadonlyArray1<'py, f64>,
        amplitude: PyReadonlyArray1<'py, f64>,
        means: &Means,
    ) -> PyResult<Pair<'py>> {
        let (small, amplitude) = (small.as_slice()?, amplitude.as_slice()?);
        let count = small.len().max(amplitude.len());
        let list = |work: &Work| {
            check_room(count, size_of::<Estimated>(), work)?;
            Ok(self.0.value.list(small, amplitude, &work.stop))
        };
        Ok(pair(py, means.list(py, count, list)?))
    }
}

/// x(t; small, amplitude), and the amplitude of the case.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Motions(pub Answer<SolutionFunction>, pub Option<f64>);

#[pymethods]
impl Motions {
    /// Header, parameters and methods as JSON.
    fn json(&self) -> PyResult<String> {
        written(&self.0)
    }

    /// The amplitude that the case has.
    #[getter]
    fn amplitude(&self) -> Option<f64> {
        self.1
    }

    /// x and its estimated errors, point by point all times; an array of length one is that value everywhere.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
        small: PyReadonlyArray1<'py, f64>,
        amplitude: PyReadonlyArray1<'py, f64>,
        means: &Means,
    ) -> PyResult<Pair<'py>> {
        let (times, small) = (times.as_slice()?, small.as_slice()?);
        let amplitude = amplitude.as_slice()?;
        let (points, harmonics) = (small.len().max(amplitude.len()), self.0.value.harmonics + 1);
        let each = harmonics.saturating_add(times.len());
        let count = points.saturating_mul(harmonics).saturating_mul(each);
        let (values, errors) = means.list(py, count, |work| {
            check_room(points, each.saturating_mul(size_of::<Estimated>()), work)?;
            let (mut values, mut errors) = (Vec::new(), Vec::new());
            for x in self.0.value.list(small, amplitude, &work.stop) {
                values.append(&mut x.list(times, &work.stop));
                errors.append(&mut x.errors(times, &work.stop));
                if work.stop.asked() {
                    break;
                }
            }
            Ok((values, errors))
        })?;
        Ok((values.into_pyarray(py), errors.into_pyarray(py)))
    }
}

/// x(t).
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Motion(pub Answer<PeriodicSolution>);

#[pymethods]
impl Motion {
    /// Header, frequency and harmonics as JSON.
    fn json(&self) -> PyResult<String> {
        written(&self.0)
    }

    /// x at times.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
        means: &Means,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let times = times.as_slice()?;
        let count = times.len().saturating_mul(self.0.value.harmonics.len());
        let values = means.list(py, count, |work| {
            check_room(times.len(), size_of::<f64>(), work)?;
            Ok(self.0.value.list(times, &work.stop))
        })?;
        Ok(values.into_pyarray(py))
    }

    /// Its estimated errors.
    fn errors<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
        means: &Means,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let times = times.as_slice()?;
        let errors = means.list(py, times.len(), |work| {
            check_room(times.len(), size_of::<f64>(), work)?;
            Ok(self.0.value.errors(times, &work.stop))
        })?;
        Ok(errors.into_pyarray(py))
    }
}

/// a(t), psi(t), x(t) of an averaged motion.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Averaged(pub Answer<averaged::Motion>);

/// Times that are no numbers, or no averaged motion that reaches them.
const NOTHING: [f64; 6] =
    [f64::NAN, f64::INFINITY, f64::NAN, f64::INFINITY, f64::NAN, f64::INFINITY];

#[pymethods]
impl Averaged {
    /// Header, start and rates as JSON.
    fn json(&self) -> PyResult<String> {
        written(&self.0)
    }

    /// Row by row the values and errors of a, psi, x; the times in increasing order. What the motion does not reach is no
    /// number; stopped work has none.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
        means: &Means,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let times = times.as_slice()?;
        let rows = means.ask(py, |work| {
            let exact = |time: &f64| Exact::from_f64(*time);
            let missing = || crate::failure::usage("a time is no number", "finite times");
            let times: Vec<Exact> =
                times.iter().map(exact).collect::<Option<_>>().ok_or_else(missing)?;
            let mut motion = self.0.value.clone();
            let moments = motion.at(&times, work);
            if work.stop.asked() {
                return Err(Refused::stopped("stopped before all times were reached", "").into());
            }
            // Those that are not reached are left out.
            let mut moments = moments.iter().peekable();
            let row = |time: &Exact| {
                let Some(found) = moments.next_if(|moment| moment.time == *time) else {
                    return NOTHING;
                };
                let [a, psi, x] = [&found.amplitude, &found.phase, &found.displacement];
                [a.double, a.error, psi.double, psi.error, x.double, x.error]
            };
            Ok(times.iter().map(row).collect::<Vec<_>>())
        })?;
        Ok(Array2::from(rows).reversed_axes().as_standard_layout().into_owned().into_pyarray(py))
    }
}

fn missing() -> Error {
    crate::failure::usage("an array needs a sweep", "sweep = \"A=-1..1:201\"")
}

/// Stable, unstable, neutral as 1, -1, 0; 2 where there is none.
fn code(verdict: Option<Verdict>) -> i8 {
    match verdict {
        Some(Verdict::Stable) => 1,
        Some(Verdict::Unstable) => -1,
        Some(Verdict::Neutral) => 0,
        None => 2,
    }
}

/// Row by row, as an array of two dimensions; what stopped work did not reach is blank.
fn table<U, T: Clone>(grid: &Grid<U>, mut list: Vec<T>, blank: T) -> PyResult<Array2<T>> {
    let (width, height) = (grid.width(), grid.rows.as_ref().map_or(1, |axis| axis.values.len()));
    list.resize(width.saturating_mul(height), blank);
    let made = Array2::from_shape_vec((height, width), list);
    made.map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The part of a chart, a surface or a diagram: `FIRST,COUNT`.
fn part(options: &Options) -> Result<Option<Part>, Error> {
    match options.list("part")?.as_deref() {
        None => Ok(None),
        Some([first, count]) => Ok(Some((*first, *count))),
        Some(_) => Err(crate::failure::usage("a part is its first row and their number", "0,16")),
    }
}

/// The prediction and the truth over one or two parameters.
pub fn chart<'py>(
    py: Python<'py>,
    case: &Oscillator,
    options: Options,
    means: &Means,
) -> PyResult<Bound<'py, PyDict>> {
    let (chart, radius) = means.ask(py, move |work| {
        let radius = options.flag("radius")?;
        let part = part(&options)?;
        let question = Stability { radius, part, ..verbs::stability(case, &options)? };
        let grid = case.stability(&question, work)?.value.grid;
        Ok((grid.ok_or_else(missing)?, radius))
    })?;
    let [(columns, x), (rows, y)] = chart.values();
    let (grid, dict) = (&chart.grid, PyDict::new(py));
    let points = || grid.points.iter();
    let predicted = points().map(|p| code(p.as_ref().and_then(|p| p.predicted))).collect();
    let exact = points().map(|p| code(p.as_ref().and_then(|p| p.exact))).collect();
    let radii = || points().map(|p| p.as_ref().map_or(f64::NAN, |p| p.exact_radius)).collect();
    let radius = radius.then(|| table(grid, radii(), f64::NAN)).transpose()?;
    dict.set_item("names", (columns, rows))?;
    dict.set_item("x", x.into_pyarray(py))?;
    dict.set_item("y", y.into_pyarray(py))?;
    dict.set_item("predicted", table(grid, predicted, code(None))?.into_pyarray(py))?;
    dict.set_item("exact", table(grid, exact, code(None))?.into_pyarray(py))?;
    dict.set_item("radius", radius.map(|radius| radius.into_pyarray(py)))?;
    dict.set_item("complete", chart.finished)?;
    Ok(dict)
}

/// The signed threshold over one or two parameters.
pub fn surface<'py>(
    py: Python<'py>,
    case: &Oscillator,
    options: Options,
    means: &Means,
) -> PyResult<Bound<'py, PyDict>> {
    let (sweep, standing) = means.ask(py, move |work| {
        let part = part(&options)?;
        let question = Threshold { part, ..verbs::threshold(case, &options)? };
        let found = case.threshold(&question, work)?;
        Ok((found.value.sweep.ok_or_else(missing)?, found.standing))
    })?;
    let (grid, dict) = (&sweep.grid, PyDict::new(py));
    let names: Vec<&str> = grid.axes().map(|axis| &*axis.name).collect();
    let signed = grid.points.iter().map(|point| point.unwrap_or(f64::NAN)).collect();
    dict.set_item("names", names)?;
    dict.set_item("x", grid.columns.doubles().into_pyarray(py))?;
    dict.set_item("y", grid.rows.as_ref().map(|axis| axis.doubles().into_pyarray(py)))?;
    dict.set_item("signed", table(grid, signed, f64::NAN)?.into_pyarray(py))?;
    dict.set_item("certified", sweep.certified)?;
    dict.set_item(
        "blanks",
        sweep.blanks.iter().map(|blank| blank.reason.clone()).collect::<Vec<_>>(),
    )?;
    dict.set_item("complete", !matches!(standing, Standing::Stopped { .. }))?;
    Ok(dict)
}

/// The points of a section over a parameter: one row (value, x, x') per point.
pub fn diagram<'py>(
    py: Python<'py>,
    case: &Oscillator,
    options: Options,
    means: &Means,
) -> PyResult<Bound<'py, PyDict>> {
    let found = means.ask(py, move |work| {
        let sweep = options.text("sweep").ok_or_else(missing)?;
        let part = part(&options)?;
        let question = Bifurcation { part, ..verbs::diagram(&sweep, &options)? };
        case.bifurcation(&question, work)
    })?;
    let (swept, dict) = (&found.value.sweep, PyDict::new(py));
    let columns = || swept.columns.iter();
    let [mut value, mut x, mut velocity] = [const { Vec::new() }; 3];
    for column in columns() {
        for [at, rate] in &column.points {
            value.push(column.value);
            x.push(*at);
            velocity.push(*rate);
        }
    }
    dict.set_item("name", &swept.parameter)?;
    dict.set_item("values", columns().map(|c| c.value).collect::<Vec<f64>>().into_pyarray(py))?;
    dict.set_item("value", value.into_pyarray(py))?;
    dict.set_item("x", x.into_pyarray(py))?;
    dict.set_item("velocity", velocity.into_pyarray(py))?;
    let ended: Vec<(f64, &String)> =
        columns().filter_map(|c| Some((c.value, c.failure.as_ref()?))).collect();
    dict.set_item("ended", ended)?;
    dict.set_item("complete", found.value.complete)?;
    Ok(dict)
}
