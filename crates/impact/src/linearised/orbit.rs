//! The periodic orbit with one impact in T: four linear equations.

use super::{ImpactMap, coefficient};
use lindstedt_coeff::quotient::{Quotient, Quotients};

impl ImpactMap {
    /// The periodic orbit with impact velocity v: \[C, D, a cos phi, a sin phi\] from
    /// x(0) = x(T) = s, x'(0) = -R_r v, x'(T) = v, which are linear in them (Cramer's rule).
    #[must_use]
    pub fn periodic_orbit(&self) -> Option<[Quotient; 4]> {
        let q = &self.field;
        let (matrix, sides) = self.end_conditions();
        let whole = determinant(q, &matrix);
        let mut solution = Vec::new();
        for column in 0..UNKNOWNS.len() {
            let mut replaced = matrix.clone();
            for (row, side) in replaced.iter_mut().zip(&sides) {
                if let Some(entry) = row.get_mut(column) {
                    *entry = side.clone();
                }
            }
            solution.push(q.div(&determinant(q, &replaced), &whole)?);
        }
        for amplitude in solution.iter_mut().skip(2) {
            *amplitude = q.mul(amplitude, &q.parameter("a"));
        }
        solution.try_into().ok()
    }

    /// Whether \[C, D, a cos phi, a sin phi\] meet the four end conditions, exactly.
    #[must_use]
    pub fn is_periodic(&self, orbit: &[Quotient; 4]) -> bool {
        let q = &self.field;
        let (matrix, sides) = self.end_conditions();
        matrix.iter().zip(&sides).all(|(row, side)| {
            let mut left = q.integer(0);
            for (n, (entry, value)) in row.iter().zip(orbit).enumerate() {
                let product = q.mul(entry, value);
                // The columns of cos phi and sin phi have the factor a.
                let term = if n < 2 { Some(product) } else { q.div(&product, &q.parameter("a")) };
                let Some(term) = term else { return false };
                left = q.add(&left, &term);
            }
            q.equal(&left, side)
        })
    }

    /// The coefficients of C, D, cos phi, sin phi in x(0), x(T), x'(0), x'(T), and the values of
    /// these on the orbit.
    fn end_conditions(&self) -> (Vec<Vec<Quotient>>, Vec<Quotient>) {
        let q = &self.field;
        let p = |name: &str| q.parameter(name);
        let forms = [
            &self.displacement_after,
            &self.displacement_before,
            &self.velocity_after,
            &self.velocity_before,
        ];
        let row = |form: &&Quotient| UNKNOWNS.iter().map(|u| coefficient(q, form, u)).collect();
        let sides = vec![p("s"), p("s"), q.neg(&q.mul(&p("R_r"), &p("v"))), p("v")];
        (forms.iter().map(row).collect(), sides)
    }
}

/// What a periodic orbit determines.
const UNKNOWNS: [&str; 4] = ["C", "D", "cos(phi)", "sin(phi)"];

/// By expansion along the first row.
fn determinant(q: &Quotients, matrix: &[Vec<Quotient>]) -> Quotient {
    let Some((first, rest)) = matrix.split_first() else { return q.integer(1) };
    let mut sum = q.integer(0);
    for (n, entry) in first.iter().enumerate() {
        if q.is_zero(entry) {
            continue;
        }
        let mut minor = rest.to_vec();
        for row in &mut minor {
            row.remove(n);
        }
        let term = q.mul(entry, &determinant(q, &minor));
        sum = q.add(&sum, &if n % 2 == 0 { term } else { q.neg(&term) });
    }
    sum
}
