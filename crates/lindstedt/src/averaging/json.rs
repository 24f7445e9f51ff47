//! The plain form of an averaged problem, and where its series converges.

use super::radius::{Radius, divergence};
use super::{Averaging, Coefficient, RateTerm};
use crate::answer::Object;
use crate::oscillator::condition_name;
use crate::{Exact, Number, Status};
use lindstedt_equation::Condition;
use lindstedt_impact::convergence::{Convergence, convergence};
use lindstedt_impact::parameters::Branch;
use lindstedt_number::complex::Complex;
use lindstedt_recognise::ImpactProblem;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

impl Averaging {
    /// With the radius of convergence where the problem is an impact oscillator whose parameters
    /// all have values.
    pub(crate) fn with_convergence(mut self, values: &BTreeMap<String, Exact>) -> Self {
        self.convergence = self.radius(values);
        self
    }

    fn radius(&self, values: &BTreeMap<String, Exact>) -> Option<Convergence> {
        self.problem.impact.as_ref().filter(|_| self.is_linear())?;
        let numbers = |rates: &[Vec<RateTerm>]| -> Option<Vec<f64>> {
            let value = |rate: &Vec<RateTerm>| match rate.first().map(|term| &term.coefficient) {
                None => Some(0.0),
                Some(Coefficient::Number(number)) => number.decimal.parse().ok(),
                Some(Coefficient::Formula { .. }) => None,
            };
            rates.iter().map(value).collect()
        };
        let (growth, frequency) = (numbers(&self.amplitude_rate)?, numbers(&self.phase_rate)?);
        let terms = growth.into_iter().zip(frequency).map(|(r, w)| Complex::new(r, w));
        let terms: Vec<_> = terms.collect();
        // The flight between the impacts knows nothing of restitution, wall and force: where these
        // have no value, any will do.
        let mut values = values.clone();
        for card in &self.problem.parameters {
            if let Ok(value) = Exact::parse(&card.default) {
                values.entry(card.name.to_string()).or_insert(value);
            }
        }
        let found = ImpactProblem::new(&self.problem, &values, None, Branch::Plus).ok()?;
        let parameters = found.parameters.nearest();
        parameters.validate().ok()?;
        Some(convergence(&parameters, &terms))
    }

    /// That the averaged series diverges, in words.
    pub(crate) fn divergence(&self) -> Option<String> {
        self.convergence.as_ref().filter(|found| found.diverges()).map(divergence)
    }
}

impl Coefficient {
    /// As a number: a formula has no decimal.
    fn number(&self) -> Printed<'_> {
        match self {
            Self::Number(number) => Printed::Number(number),
            Self::Formula { text, .. } => {
                Printed::Formula { exact: text, decimal: (), error: (), status: Status::Exact }
            }
        }
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Printed<'a> {
    Number(&'a Number),
    Formula { exact: &'a str, decimal: (), error: (), status: Status },
    Zero { exact: &'static str, decimal: &'static str, error: (), status: Status },
}

const ZERO: Printed<'static> =
    Printed::Zero { exact: "0", decimal: "0", error: (), status: Status::Exact };

/// One term of a rate.
#[derive(Serialize)]
struct Term<'a> {
    power: i32,
    coefficient: Printed<'a>,
}

/// The numbers of a linear rate.
fn numbers(rates: &[Vec<RateTerm>]) -> Vec<Printed<'_>> {
    rates.iter().map(|rate| rate.first().map_or(ZERO, |term| term.coefficient.number())).collect()
}

/// The polynomials in a of any rate.
fn polynomials(rates: &[Vec<RateTerm>]) -> Vec<Vec<Term<'_>>> {
    rates.iter().map(|rate| rate.iter().map(Term::new).collect()).collect()
}

impl<'a> Term<'a> {
    fn new(term: &'a RateTerm) -> Self {
        Self { power: term.exponent, coefficient: term.coefficient.number() }
    }
}

/// Which orders were substituted into the equation.
#[derive(Serialize)]
struct Residual {
    checked_orders: usize,
    zero: Option<bool>,
    encloses_zero: bool,
}

impl Serialize for Averaging {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (a, b) = (&self.amplitude_rate, &self.phase_rate);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("normalisation", condition_name(Condition::FreeAmplitude))?;
        if self.is_linear() {
            let series = Object(vec![("growth_rate", numbers(a)), ("frequency", numbers(b))]);
            map.serialize_entry("series", &series)?;
        } else {
            let rates = vec![("amplitude_rate", polynomials(a)), ("phase_rate", polynomials(b))];
            map.serialize_entry("series", &Object(rates))?;
        }
        let solution: Vec<&String> = self.solution.iter().map(|[text, _]| text).collect();
        map.serialize_entry("solution", &solution)?;
        map.serialize_entry("terms", &self.terms)?;
        let residual = Residual {
            checked_orders: self.checked_orders,
            zero: self.exact.then_some(true),
            encloses_zero: !self.exact,
        };
        map.serialize_entry("residual", &residual)?;
        let name = "averaging (Krylov, Bogoliubov, Mitropolsky)";
        map.serialize_entry("method", &Object(vec![("name", name)]))?;
        if let Some(found) = &self.convergence {
            map.serialize_entry("convergence", &Radius::new(found))?;
        }
        map.serialize_entry("classification", &self.description)?;
        map.end()
    }
}
