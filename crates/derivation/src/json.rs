//! The plain form of a derivation.

use crate::derivation::{Derivation, Solution};
use lindstedt_coeff::print::Style;
use lindstedt_number::Object;
use rayon::prelude::*;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// Which orders were substituted into the equation.
#[derive(Serialize)]
struct Residual {
    checked_orders: Option<usize>,
    zero: Option<bool>,
}

/// The algebra, or the primes.
#[derive(Serialize)]
struct Method {
    name: &'static str,
    route: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    primes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    proof_primes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chance: Option<f64>,
}

impl Serialize for Derivation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let series = self.series.iter().map(|series| series.quantity.name()).zip(&self.numbers);
        let series = Object(series.collect());
        let orders = 0..self.solved();
        let solution: Vec<String> =
            orders.clone().into_par_iter().map(|n| self.print_solution(n, Style::Text)).collect();
        let terms: Vec<usize> = orders.map(|n| self.terms(n)).collect();
        let route = self.route.name();
        let named = |name| Method { name, route, primes: None, proof_primes: None, chance: None };
        let method = match &self.solution {
            Solution::Rational(proved) => Method {
                primes: Some(proved.primes),
                proof_primes: Some(proved.proof_primes),
                ..named("multi-modular, proved")
            },
            Solution::FrequencyOnly { images: Some(images) } => Method {
                primes: Some(images.primes),
                chance: Some(images.chance),
                ..named("multi-modular frequency, checked at values of eps")
            },
            Solution::FrequencyOnly { images: None } => named("energy integral"),
            Solution::Clock(_) | Solution::Lobachevsky(_) => named("Lobachevsky ring over Q[mu_m]"),
        };
        let checked = self.checked_orders;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("normalisation", &self.condition)?;
        map.serialize_entry("series", &series)?;
        map.serialize_entry("solution", &solution)?;
        map.serialize_entry("terms", &terms)?;
        let residual = Residual { checked_orders: checked, zero: checked.map(|_| true) };
        map.serialize_entry("residual", &residual)?;
        map.serialize_entry("method", &method)?;
        map.serialize_entry("classification", &self.description)?;
        map.end()
    }
}
