//! Motions of two complex unknowns that are steady but for a phase that the flow does not fix.
//!
//! Where w' = G(w) is the same for w_j e^{i d_j theta}, w_j(t) = w_j e^{i d_j delta t} is such a motion: G_j = i d_j delta w_j.
//! With c one of the unknowns, o the other, w_c = a > 0 (the phase is free) and w_o = a y, where G has no constant part and
//! so g = G/a is a polynomial in a and y, delta = Im g_c/d_c and
//!
//!   Re g_c = 0,   g_o = i (d_o/d_c) Im(g_c) y:
//!
//! three equations of a and y, whose zeros are isolated, also beside w = 0. All of them have |y| <= L for one c or
//! |y| <= 1/L for the other.

use super::branch::eigenvalues;
use super::{ComplexTerm, Flow, Polynomial, System};
use nalgebra::Complex;
use rug::Rational;
use rug::ops::Pow;

/// A flow of two complex unknowns with a free phase.
#[derive(Clone, Debug)]
pub struct FreePhase {
    /// G.
    pub equations: [Vec<ComplexTerm>; 2],
    /// d_1, d_2, not 0.
    pub weights: [Rational; 2],
    /// The names of the parameters of G.
    pub parameters: Vec<String>,
}

type Complexes = [Polynomial; 2];

fn times(a: &Complexes, b: &Complexes) -> Complexes {
    let minus = &a[1] * &Polynomial::constant((-1).into());
    [(&a[0] * &b[0]) + &(&minus * &b[1]), (&a[0] * &b[1]) + &(&a[1] * &b[0])]
}

impl FreePhase {
    /// The three equations with w_c = scales\[0\] s and y = scales\[1\] eta, in Re eta, Im eta and s; nothing where G has a
    /// constant part.
    #[must_use]
    pub fn reduced(&self, c: usize, scales: &[Rational; 2]) -> Option<Flow> {
        let of_gauge = self.divided(c, c, scales)?;
        let of_other = self.divided(1 - c, c, scales)?;
        let ratio = Rational::from(&self.weights[1 - c] / &self.weights[c]);
        let turn = &of_gauge[1] * &Polynomial::constant(ratio * &scales[1]);
        let minus = Polynomial::constant((-1).into());
        let [re, im] = of_other;
        let [eta_re, eta_im] = [0, 1].map(Polynomial::variable);
        let rows =
            vec![of_gauge[0].clone(), re + &(&turn * &eta_im), im + &(&(&turn * &eta_re) * &minus)];
        Some(Flow::of_rows(rows, self.parameters.clone()))
    }

    /// G_j/a.
    fn divided(&self, j: usize, c: usize, scales: &[Rational; 2]) -> Option<Complexes> {
        let mut sum = Complexes::default();
        for term in &self.equations[j] {
            let degree: u32 = term.amplitudes.iter().sum();
            let mut exponents = vec![0, 0, degree.checked_sub(1)?];
            exponents.extend(&term.parameters);
            let others = &term.amplitudes[2 * (1 - c)..2 * (1 - c) + 2];
            let size = Rational::from((&scales[0]).pow(degree - 1))
                * Rational::from((&scales[1]).pow(others[0] + others[1]));
            let part = |q: &Rational| {
                let mut part = Polynomial::default();
                part.add_term(&exponents, &size);
                &part * &Polynomial::within(q.clone(), term.radius)
            };
            let mut product = [part(&term.re), part(&term.im)];
            for (sign, n) in [1, -1].into_iter().zip(others) {
                let eta = [
                    Polynomial::variable(0),
                    &Polynomial::variable(1) * &Polynomial::constant(sign.into()),
                ];
                product = (0..*n).fold(product, |product, _| times(&product, &eta));
            }
            sum = [0, 1].map(|k| std::mem::take(&mut sum[k]) + &product[k]);
        }
        Some(sum)
    }

    /// delta of a motion w, and the exponents of the deviations from it but the one, 0, along the free phase; `system`
    /// is G at these parameters.
    pub fn drift(&self, system: &System, w: &[f64; 4]) -> (f64, Vec<Complex<f64>>) {
        let (values, mut slopes) = system.derivatives(w);
        let weights = self.weights.each_ref().map(Rational::to_f64);
        let square = |c: usize| w[2 * c].powi(2) + w[2 * c + 1].powi(2);
        let c = usize::from(square(1) > square(0));
        let turn = w[2 * c] * values[2 * c + 1] - w[2 * c + 1] * values[2 * c];
        let delta = turn / square(c) / weights[c];
        for (j, d) in weights.iter().enumerate() {
            slopes[8 * j + 2 * j + 1] += delta * d;
            slopes[8 * j + 4 + 2 * j] -= delta * d;
        }
        let mut exponents = eigenvalues(4, &slopes);
        let size = |k: &usize| exponents[*k].norm();
        if let Some(k) = (0..exponents.len()).min_by(|a, b| size(a).total_cmp(&size(b))) {
            exponents.remove(k);
        }
        (delta, exponents)
    }
}
