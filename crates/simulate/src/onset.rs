//! The tangency of the manifolds as a function of a small parameter, extrapolated to zero.

use crate::continuation::continue_tangency;
use crate::error::SimulateError;
use crate::integrator::Tick;
use crate::quantity::Quantity;
use crate::tangency::Homoclinic;
use rug::Float;
use std::ops::ControlFlow;

/// value(eps) = intercept + slope eps + O(eps^2) of a tangency.
#[derive(Clone, Debug, PartialEq)]
pub struct TangencyLine {
    /// The value at eps = 0.
    pub intercept: f64,
    /// Its derivative there.
    pub slope: f64,
    /// The estimated errors of both: twice the first omitted term of Newton's form, as large as the last two let it be,
    /// and what the errors of the tangencies do. Infinite for fewer than three points.
    pub errors: [f64; 2],
    /// eps, the tangency and its estimated error.
    pub points: Vec<[f64; 3]>,
}

impl Homoclinic<'_> {
    /// The first tangency between two values of the free parameter at the smallest value of `along`, followed through
    /// the others, which rise, and its curve extrapolated to `along` = 0 by the polynomial through all of them.
    ///
    /// Errors: those of [`Self::first_tangency`] and [`continue_tangency`]. Cost: some tenths of a second for a point.
    pub fn tangent_line(
        &self,
        (along, values): (&str, &[f64]),
        bracket: (f64, f64),
        count: u32,
        tick: &Tick<'_>,
    ) -> Result<TangencyLine, SimulateError> {
        let mut parameters = self.parameters.clone();
        let first = values.first().copied().unwrap_or_default();
        parameters.set(along, Quantity::Float(Float::with_val(53, first)));
        let homoclinic = Homoclinic { parameters: &parameters, ..*self };
        let start = homoclinic.first_tangency(bracket, count, tick)?;
        let mut points = Vec::new();
        let start = (start.value, start.phase);
        continue_tangency(&homoclinic, (along, values), start, tick, &mut |eps, tangency| {
            points.push([eps, tangency.value, tangency.error]);
            ControlFlow::Continue(())
        })?;
        Ok(TangencyLine::through(points))
    }
}

impl TangencyLine {
    /// The curve through tangencies (eps, the value, its error) by rising eps.
    ///
    /// ```
    /// use lindstedt_simulate::TangencyLine;
    /// let line = TangencyLine::through([0.1, 0.2, 0.4].map(|eps| [eps, 1.0 + 2.0 * eps - eps * eps, 0.0]).to_vec());
    /// assert!((line.intercept - 1.0).abs() < 1e-15 && (line.slope - 2.0).abs() < 1e-14);
    /// ```
    #[must_use]
    pub fn through(points: Vec<[f64; 3]>) -> Self {
        let all: Vec<(f64, f64)> = points.iter().map(|[eps, value, _]| (*eps, *value)).collect();
        let [intercept, slope] = at_zero(&all);
        let mut errors = omitted(&all);
        for (k, [.., error]) in points.iter().enumerate() {
            let unit = |(j, (eps, _)): (usize, &(f64, f64))| (*eps, f64::from(u8::from(j == k)));
            let weight = at_zero(&all.iter().enumerate().map(unit).collect::<Vec<_>>());
            errors = [0, 1].map(|n| errors[n] + (weight[n] * error).abs());
        }
        Self { intercept, slope, errors, points }
    }
}

/// The divided differences of points from the first on: the coefficients of Newton's form.
fn differences(points: &[(f64, f64)]) -> Vec<f64> {
    let mut differences: Vec<f64> = points.iter().map(|point| point.1).collect();
    for n in 1..points.len() {
        for k in (n..points.len()).rev() {
            differences[k] =
                (differences[k] - differences[k - 1]) / (points[k].0 - points[k - n].0);
        }
    }
    differences
}

/// The value and the derivative at 0 of the polynomial through points.
fn at_zero(points: &[(f64, f64)]) -> [f64; 2] {
    let horner = |[value, slope]: [f64; 2], (point, c): (&(f64, f64), &f64)| {
        [c - point.0 * value, value - point.0 * slope]
    };
    points.iter().zip(&differences(points)).rev().fold([0.0; 2], horner)
}

/// Twice the term after the last one of Newton's form, at 0: value and derivative. One of the last two coefficients
/// may be small by chance; if they grow, they go on to.
fn omitted(points: &[(f64, f64)]) -> [f64; 2] {
    let [.., _, before, last] = differences(points)[..] else { return [f64::INFINITY; 2] };
    let next = before.abs().max(last.abs() * (last / before).abs().max(1.0));
    let product =
        |[value, slope]: [f64; 2], point: &(f64, f64)| [-point.0 * value, value - point.0 * slope];
    points.iter().fold([1.0, 0.0], product).map(|term| 2.0 * next * term.abs())
}
