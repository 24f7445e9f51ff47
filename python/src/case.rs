//! A problem with its values.

use crate::arrays::{self, Averaged, Frequency, Motion, Motions};
use crate::failure::exception;
use crate::found::{Found, written};
use crate::options::Options;
use crate::verbs;
use crate::work::Means;
use lindstedt::catalogue::Catalogue;
use lindstedt::choices::{Choice, NORMALISATIONS};
use lindstedt::{Condition, Error, Oscillator};
use lindstedt_report::{Format, Present};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// An oscillator.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Case(Oscillator);

/// The built-in problems as JSON.
#[pyfunction]
pub fn problems() -> PyResult<String> {
    written(&Catalogue::builtin())
}

fn made(
    kind: &str,
    text: &str,
    values: &[(String, String)],
    condition: Option<&str>,
) -> Result<Oscillator, Error> {
    let mut case = match kind {
        "builtin" => Oscillator::builtin(text)?,
        "file" => Oscillator::file(text)?,
        _ => Oscillator::parse(text)?,
    };
    for (name, value) in values {
        case = case.set(name, value)?;
    }
    let Some(word) = condition else { return Ok(case) };
    let condition = Choice::find(NORMALISATIONS, word).ok_or_else(|| {
        let message = format!("there is no normalisation {word:?}");
        crate::failure::usage(message, "initial, fundamental or free")
    })?;
    case.under(condition)
}

impl Case {
    /// The value of the amplitude, where there is one.
    fn amplitude(&self) -> Option<f64> {
        let all = self.0.all_values().into_iter();
        all.filter(|(name, _)| name == "amplitude").map(|(_, value)| value.to_f64()).next()
    }
}

#[pymethods]
impl Case {
    /// `kind` is `equation`, `file` or `builtin`.
    #[new]
    fn new(
        py: Python<'_>,
        kind: &str,
        text: &str,
        values: Vec<(String, String)>,
        condition: Option<&str>,
    ) -> PyResult<Self> {
        made(kind, text, &values, condition).map(Self).map_err(|error| exception(py, &error))
    }

    /// The name of the problem.
    #[getter]
    fn name(&self) -> String {
        self.0.problem().name.to_string()
    }

    /// The small parameter.
    #[getter]
    fn small(&self) -> String {
        self.0.problem().small.to_string()
    }

    /// Whether the amplitude drifts.
    #[getter]
    fn drifts(&self) -> bool {
        self.0.condition() == Some(Condition::FreeAmplitude)
    }

    /// The equation, `... = 0`.
    #[getter]
    fn equation(&self) -> String {
        self.0.to_string()
    }

    /// The values that are set or that the problem has.
    fn values(&self) -> BTreeMap<String, String> {
        self.0.all_values().into_iter().map(|(name, value)| (name, value.to_string())).collect()
    }

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String> {
        self.0.problem().parameters.iter().map(|card| card.name.to_string()).collect()
    }

    /// What was noticed when the problem was read.
    fn remarks(&self) -> Vec<String> {
        self.0.remarks().iter().map(ToString::to_string).collect()
    }

    /// What the equation is made of and which methods take it, as JSON.
    fn entry(&self) -> PyResult<String> {
        written(&self.0.entry())
    }

    /// The same as a page.
    fn page(&self) -> String {
        Format::Text.write(&self.0.entry().document())
    }

    /// The answer to a question.
    fn ask(
        &self,
        py: Python<'_>,
        verb: &str,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Found> {
        means.ask(py, |work| verbs::ask(&self.0, verb, &Options::new(options), work)).map(Found)
    }

    /// omega as a function of parameters.
    fn frequency_function(
        &self,
        py: Python<'_>,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Frequency> {
        means.ask(py, |work| {
            let options = Options::new(options);
            let question = verbs::resummed(&options)?;
            options.finish()?;
            Ok(Frequency(self.0.frequency_function(&question, work)?, self.amplitude()))
        })
    }

    /// x(t) as a function of parameters.
    fn solution_function(
        &self,
        py: Python<'_>,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Motions> {
        means.ask(py, |work| {
            let options = Options::new(options);
            let question = verbs::resummed(&options)?;
            let harmonics = options.parsed("harmonics")?.unwrap_or(15);
            options.finish()?;
            let value = self.0.solution_function(&question, harmonics, work)?;
            Ok(Motions(value, self.amplitude()))
        })
    }

    /// x(t) by its harmonics.
    fn periodic_solution(
        &self,
        py: Python<'_>,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Motion> {
        means.ask(py, |work| {
            let options = Options::new(options);
            let question = verbs::phased(&options)?;
            let harmonics = options.parsed("harmonics")?.unwrap_or(15);
            options.finish()?;
            Ok(Motion(self.0.periodic_solution(&question, harmonics, work)?))
        })
    }

    /// a(t), psi(t), x(t) of the averaged motion.
    fn averaged_motion(
        &self,
        py: Python<'_>,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Averaged> {
        means.ask(py, |work| {
            let options = Options::new(options);
            let question = verbs::averaged(&options)?;
            options.finish()?;
            Ok(Averaged(self.0.averaged_motion(&question, work)?))
        })
    }

    /// The values of every axis of a sweep.
    fn axes(&self, py: Python<'_>, sweep: &str) -> PyResult<Vec<Vec<String>>> {
        let values = |text: &str| -> Result<_, Error> {
            Ok(self.0.axis(text)?.values.iter().map(ToString::to_string).collect())
        };
        let axes: Result<_, Error> = sweep.split(';').map(values).collect();
        axes.map_err(|error| exception(py, &error))
    }

    /// A chart, a surface or a diagram as arrays.
    fn arrays<'py>(
        &self,
        py: Python<'py>,
        verb: &str,
        options: BTreeMap<String, String>,
        means: &Means,
    ) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
        let options = Options::new(options);
        match verb {
            "stability" => arrays::chart(py, &self.0, options, means),
            "threshold" => arrays::surface(py, &self.0, options, means),
            _ => arrays::diagram(py, &self.0, options, means),
        }
    }
}
