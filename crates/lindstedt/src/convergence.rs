//! Where the averaged series of an impact oscillator converges.

use crate::Exact;
use crate::averaging::{Averaging, Coefficient, RateTerm};
use lindstedt_derivation::all_values;
use lindstedt_impact::convergence::{Convergence, convergence};
use lindstedt_impact::parameters::Branch;
use lindstedt_number::complex::Complex;
use lindstedt_recognise::ImpactProblem;
use std::collections::BTreeMap;

/// The radius of convergence where the problem is an impact oscillator whose parameters all have
/// values.
pub(crate) fn of(averaging: &Averaging, values: &BTreeMap<String, Exact>) -> Option<Convergence> {
    averaging.problem.impact.as_ref().filter(|_| averaging.is_linear())?;
    let numbers = |rates: &[Vec<RateTerm>]| -> Option<Vec<f64>> {
        let value = |rate: &Vec<RateTerm>| match rate.first().map(|term| &term.coefficient) {
            None => Some(0.0),
            Some(Coefficient::Number(number) | Coefficient::ClosedForm { number, .. }) => {
                number.decimal.parse().ok()
            }
            Some(Coefficient::Formula(_)) => None,
        };
        rates.iter().map(value).collect()
    };
    let (growth, frequency) =
        (numbers(&averaging.amplitude_rate)?, numbers(&averaging.phase_rate)?);
    let terms = growth.into_iter().zip(frequency).map(|(r, w)| Complex::new(r, w));
    let terms: Vec<_> = terms.collect();
    // The flight between the impacts knows nothing of restitution, wall and force: where these
    // have no value, any will do.
    let values = all_values(&averaging.problem, values);
    let found = ImpactProblem::new(&averaging.problem, &values, None, Branch::Plus).ok()?;
    let parameters = found.parameters.nearest();
    parameters.validate().ok()?;
    Some(convergence(&parameters, &terms))
}
