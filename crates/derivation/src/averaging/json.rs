//! The plain form of an averaged problem.

use super::{Averaging, Coefficient, Formula, RateTerm};
use lindstedt_equation::Condition;
use lindstedt_impact::Radius;
use lindstedt_number::{Number, Object, Status};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

impl Coefficient {
    /// As a number: a formula has no decimal.
    fn number(&self) -> Printed<'_> {
        match self {
            Self::Number(number) | Self::ClosedForm { number, .. } => Printed::Number(number),
            Self::Formula(formula) => {
                let exact = formula.text();
                Printed::Formula { exact, decimal: (), error: (), status: Status::Exact }
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

impl Serialize for Coefficient {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.number().serialize(serializer)
    }
}

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

/// The rates, with the same keys at every order.
#[derive(Serialize)]
struct Series<'a> {
    amplitude_rate: Vec<Vec<Term<'a>>>,
    phase_rate: Vec<Vec<Term<'a>>>,
    /// Of rates that are linear in a.
    growth_rate: Option<Vec<Printed<'a>>>,
    frequency: Option<Vec<Printed<'a>>>,
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
        map.serialize_entry("normalisation", &Condition::FreeAmplitude)?;
        map.serialize_entry("symbols", &self.symbols)?;
        let linear = self.is_linear();
        let series = Series {
            amplitude_rate: polynomials(a),
            phase_rate: polynomials(b),
            growth_rate: linear.then(|| numbers(a)),
            frequency: linear.then(|| numbers(b)),
        };
        map.serialize_entry("series", &series)?;
        let solution: Vec<&str> = self.solution.iter().map(Formula::text).collect();
        map.serialize_entry("solution", &solution)?;
        map.serialize_entry("terms", &self.terms)?;
        let residual = Residual {
            checked_orders: self.checked_orders,
            zero: self.exact.then_some(true),
            encloses_zero: !self.exact,
        };
        map.serialize_entry("residual", &residual)?;
        let method = match self.between_turning_points() {
            true => {
                vec![("name", "averaging between turning points"), ("amplitude", "turning-point")]
            }
            false => vec![("name", "averaging (Krylov, Bogoliubov, Mitropolsky)")],
        };
        map.serialize_entry("method", &Object(method))?;
        map.serialize_entry("limit_cycles", &self.cycles)?;
        if let Some(cycle) = &self.single_cycle {
            map.serialize_entry("single_cycle", cycle)?;
        }
        map.serialize_entry("convergence", &self.convergence.as_ref().map(Radius::new))?;
        map.serialize_entry("classification", &self.description)?;
        map.end()
    }
}
