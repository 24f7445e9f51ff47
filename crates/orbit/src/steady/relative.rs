//! Motions of two complex unknowns that are steady but for a phase that the flow does not fix.
//!
//! Where w' = G(w) is the same for w_j e^{i d_j theta}, w_j(t) = w_j e^{i d_j delta t} is such a motion: G_j = i d_j delta w_j.
//! With c one of the unknowns, o the other, w_c = a > 0 (the phase is free) and w_o = a y, where G has no constant part and
//! so g = G/a is a polynomial in a and y, delta = Im g_c/d_c and
//!
//!   Re g_c = 0,   g_o = i (d_o/d_c) Im(g_c) y:
//!
//! three equations of a and y, whose zeros are isolated, also beside w = 0. All of them have |y| <= L for one c or
//! |y| <= 1/L for the other. Of whole weights n_1, n_2 without a common divisor w_c > 0 leaves |n_c| phases: as many zeros are
//! one motion.
//!
//! Where an energy E_1 |w_1|^2 + E_2 |w_2|^2 + ... is conserved (Lyapunov 1907: normal modes), such motions are families of one
//! parameter: the balance of energy makes one equation follow from the others, up to terms beyond the order of a truncated
//! flow. In its place the amplitude A of the family is given, E_1 A^2 = 4 (E_1 |w_1|^2 + E_2 |w_2|^2), or A^2 = 4 (|w_1|^2 + |w_2|^2)
//! where E_1 and E_2 are not known to have one sign, and G_j = (i d_j delta + beta E_j) w_j (Munoz-Almaraz et al. 2003): the
//! balance is beta (E_1^2 |w_1|^2 + E_2^2 |w_2|^2) = 0, so that beta vanishes, up to those terms.
//!
//!   E_c g_o = (i (d_o/d_c) E_c Im(g_c) + E_o Re g_c) y.
//!
//! Searches go by a and y ([`FreePhase::reduced`]), branches by w and delta ([`FreePhase::branches`]), since a may vanish along them.

mod branches;
mod rest;

use super::flow::{times, whole};
use super::survey::Located;
use super::{Branch, ComplexTerm, Flow, Polynomial, System, Value, bound};
use crate::eigenvalues::eigenvalues;
use nalgebra::Complex;
use rug::Rational;
use rug::ops::Pow;
use std::f64::consts::PI;

/// A flow of two complex unknowns with a free phase.
#[derive(Clone, Debug)]
pub struct FreePhase {
    /// G.
    pub equations: [Vec<ComplexTerm>; 2],
    /// d_1, d_2, not 0.
    pub weights: [Rational; 2],
    /// The names of the parameters of G; of families the last is A.
    pub parameters: Vec<String>,
    /// E_1 and E_2 of families, in the parameters.
    pub energy: Option<[Polynomial; 2]>,
    /// Whether they are of one sign, so that A is measured by them.
    pub definite: bool,
}

/// A branch of such motions.
#[derive(Clone, Debug)]
pub struct Turning {
    /// w and the parameter, the exponents without those that are 0 for every such motion.
    pub branch: Branch,
    /// delta at its points.
    pub rates: Vec<f64>,
    /// Where motions change, in w and the parameter; Hopf points are not proved.
    pub changes: Vec<Located>,
}

type Complexes = [Polynomial; 2];

/// |w_j|^2.
fn square(w: &[f64], j: usize) -> f64 {
    w[2 * j].powi(2) + w[2 * j + 1].powi(2)
}

/// |w_j|^2 as a polynomial in Re w_1, Im w_1, ...
fn square_of(j: usize) -> Polynomial {
    let [x, y] = [2 * j, 2 * j + 1].map(Polynomial::variable);
    (&x * &x) + &(&y * &y)
}

impl FreePhase {
    /// w' = G.
    fn flow(&self) -> Flow {
        let names: Vec<&str> = self.parameters.iter().map(String::as_str).collect();
        Flow::of_complex(&self.equations, &names)
    }

    /// n_1, n_2.
    fn phases(&self) -> [f64; 2] {
        let ratio = Rational::from(&self.weights[1] / &self.weights[0]);
        [ratio.denom().to_f64(), ratio.numer().to_f64()]
    }

    /// Whether two points lie on one motion, within a distance.
    #[must_use]
    pub fn same(&self, a: &[f64], b: &[f64], within: f64) -> bool {
        let [first, second] = [a, b].map(|w| [square(w, 0).sqrt(), square(w, 1).sqrt()]);
        let [n, m] = self.phases();
        let turn = |w: &[f64]| n * w[3].atan2(w[2]) - m * w[1].atan2(w[0]);
        let off = (turn(a) - turn(b)) / (2.0 * PI);
        let apart = 2.0 * PI * (off - off.round()).abs() * first[0].min(first[1]);
        apart < within && first.iter().zip(second).all(|(a, b)| (a - b).abs() < within)
    }

    /// The three equations with w_c = scales\[0\] s and y = scales\[1\] eta, in Re eta, Im eta and s; nothing where G has a
    /// constant part.
    #[must_use]
    pub fn reduced(&self, c: usize, scales: &[Rational; 2]) -> Option<Flow> {
        let of_gauge = self.divided(c, c, scales)?;
        let [mut re, mut im] = self.divided(1 - c, c, scales)?;
        let times_y =
            |p: &Polynomial, q: &Rational| p * &Polynomial::constant(q * scales[1].clone());
        let ratio = Rational::from(&self.weights[1 - c] / &self.weights[c]);
        let [eta_re, eta_im] = [0, 1].map(Polynomial::variable);
        let energy = self.energy.as_ref().map(|all| all.each_ref().map(|e| e.after(3)));
        let scale = energy.as_ref().map_or(whole(1), |e| e[c].clone());
        let turn = times_y(&(&scale * &of_gauge[1]), &ratio);
        let minus = whole(-1);
        re = (&scale * &re) + &(&turn * &eta_im);
        im = (&scale * &im) + &(&minus * &(&turn * &eta_re));
        let (Some(energy), Some(measure)) = (&energy, &self.measure()) else {
            return Some(Flow::of_rows(vec![of_gauge[0].clone(), re, im], self.parameters.clone()));
        };
        let growth = times_y(&(&energy[1 - c] * &of_gauge[0]), &Rational::from(-1));
        re = re + &(&growth * &eta_re);
        im = im + &(&growth * &eta_im);
        let s = Polynomial::variable(2);
        let other = (&eta_re * &eta_re) + &(&eta_im * &eta_im);
        let other = &other * &Polynomial::constant(scales[1].clone().square());
        let squares = [whole(1), other];
        let squares =
            squares.map(|y| &y * &(&(&s * &s) * &Polynomial::constant(scales[0].clone().square())));
        let size = self.size(measure, 3, [&squares[c], &squares[1 - c]]);
        Some(Flow::of_rows(vec![re, im, size], self.parameters.clone()))
    }

    /// E_1 and E_2 by which A is measured: 1 where they are of no one sign.
    fn measure(&self) -> Option<[Polynomial; 2]> {
        let one = || whole(1);
        let energy = self.energy.as_ref()?;
        Some(if self.definite { energy.clone() } else { [one(), one()] })
    }

    /// E_1 |w_1|^2 + E_2 |w_2|^2 - E_1 A^2/4, the parameters being the variables from `first` on.
    fn size(
        &self,
        energy: &[Polynomial; 2],
        first: usize,
        squares: [&Polynomial; 2],
    ) -> Polynomial {
        let [one, two] = energy.each_ref().map(|e| e.after(first));
        let amplitude = Polynomial::variable(first + self.parameters.len() - 1);
        let own = &(&amplitude * &amplitude) * &Polynomial::constant(Rational::from((-1, 4)));
        (&one * squares[0]) + &(&two * squares[1]) + &(&one * &own)
    }

    /// A of a motion of a family.
    #[must_use]
    pub fn amplitude(&self, values: &[Option<Value>], w: &[f64]) -> Option<f64> {
        let rows = System::new(&self.measure()?, values).values(&[] as &[f64]);
        let square = square(w, 0) + rows[1] / rows[0] * square(w, 1);
        Some(2.0 * square.sqrt())
    }

    /// Some R with |w_j| <= R at all motions: of families from A, else from the terms of highest degree of Re(conj(w_j) G_j) and
    /// d_2 |w_2|^2 Im(conj(w_1) G_1) - d_1 |w_1|^2 Im(conj(w_2) G_2), which vanish there. Nothing where they have common zeros.
    #[must_use]
    pub fn bound(&self, values: &[Option<Value>]) -> Option<f64> {
        if let Some(measure) = &self.measure() {
            let rows = System::new(measure, values).values(&[] as &[f64]);
            let amplitude = values.last()?.as_ref()?.interval().above();
            let most = (rows[0] / rows[1]).sqrt().max(1.0) * amplitude / 2.0;
            return (most.is_finite() && most > 0.0).then_some(most * (1.0 + 1e-9));
        }
        let rows = self.flow().rows;
        let variables: [Polynomial; 4] = std::array::from_fn(Polynomial::variable);
        let minus = whole(-1);
        let product = |j: usize| {
            let (x, y) = (&variables[2 * j], &variables[2 * j + 1]);
            times(&[x.clone(), &minus * y], &[rows[2 * j].clone(), rows[2 * j + 1].clone()])
        };
        let square = |j: usize| &square_of(j) * &Polynomial::constant(self.weights[j].clone());
        let ([first, turn], [second, other]) = (product(0), product(1));
        let turns = (&turn * &square(1)) + &(&minus * &(&other * &square(0)));
        // The phase that is free makes w_2 real.
        let still = Some(Value::Rational(Rational::new()));
        let given: Vec<_> =
            [None, None, None, still].into_iter().chain(values.iter().cloned()).collect();
        bound(&System::new(&[first, second, turns], &given))
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
                let eta = [Polynomial::variable(0), &Polynomial::variable(1) * &whole(sign)];
                product = (0..*n).fold(product, |product, _| times(&product, &eta));
            }
            sum = [0, 1].map(|k| std::mem::take(&mut sum[k]) + &product[k]);
        }
        Some(sum)
    }

    /// delta of a motion w, and the exponents of the deviations from it but those that are 0 for all: one along the free
    /// phase, and of families one along them; there the others are a pair, its square half the trace of the square.
    /// `system` is G in w and a parameter that has no value, if there is one.
    #[must_use]
    pub fn drift(&self, system: &System, w: &[f64]) -> (f64, Vec<Complex<f64>>) {
        let (values, slopes) = system.derivatives(w);
        let weights = self.weights.each_ref().map(Rational::to_f64);
        let c = usize::from(square(w, 1) > square(w, 0));
        let [x, y, p, q] = [w[2 * c], w[2 * c + 1], values[2 * c], values[2 * c + 1]];
        let delta = (x * q - y * p) / square(w, c) / weights[c];
        let growth = (x * p + y * q) / square(w, c);
        let rows = slopes.chunks_exact(system.variables()).flat_map(|row| &row[..4]);
        let mut slopes: Vec<f64> = rows.copied().collect();
        for (j, d) in weights.iter().enumerate() {
            slopes[8 * j + 2 * j + 1] += delta * d;
            slopes[8 * j + 4 + 2 * j] -= delta * d;
        }
        if self.energy.is_some() {
            // Of the size of the terms left out, as it is whichever energy it goes by.
            (0..4).for_each(|k| slopes[5 * k] -= growth);
            let entry = |i: usize, j: usize| slopes[4 * i + j] * slopes[4 * j + i];
            let trace: f64 = (0..16).map(|k| entry(k / 4, k % 4)).sum();
            let root = Complex::new(0.5 * trace, 0.0).sqrt();
            let other = if trace < 0.0 { root.conj() } else { Complex::new(-root.re, 0.0) };
            return (delta, vec![root, other]);
        }
        let mut exponents = eigenvalues(4, &slopes);
        let size = |k: &usize| exponents[*k].norm();
        if let Some(k) = (0..exponents.len()).min_by(|a, b| size(a).total_cmp(&size(b))) {
            exponents.remove(k);
        }
        (delta, exponents)
    }
}
