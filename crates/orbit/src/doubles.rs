//! A field in doubles, and its motion: for guesses, nothing more.

use crate::Field;
use crate::operation::Operation;
use crate::polynomial::{Polynomial, Term};

/// A field with its coefficients in doubles.
pub(crate) struct InDoubles {
    forces: Vec<Terms>,
    functions: Vec<(Operation, Terms)>,
}

/// Waves (h, a, b) times powers.
type Terms = Vec<(Vec<(f64, f64, f64)>, Vec<u32>)>;

impl InDoubles {
    pub(crate) fn new(field: &Field) -> Self {
        let functions = field.functions.iter().map(|f| (f.kind, terms(&f.argument)));
        let forces = field.forces.iter().map(terms).collect();
        Self { forces, functions: functions.collect() }
    }

    /// x_i'' at a state (x_1.., x_1'..) and a phase of the force; without the waves of the force where none
    /// is given.
    pub(crate) fn accelerations(&self, state: &[f64], phase: Option<f64>) -> Vec<f64> {
        let mut variables = state.to_vec();
        for (kind, argument) in &self.functions {
            let p = value(argument, &variables, phase);
            variables.push(kind.in_doubles(p));
        }
        self.forces.iter().map(|g| value(g, &variables, phase)).collect()
    }

    /// The state a time h later, by one step of Runge and Kutta; `rate` is the frequency of the force.
    pub(crate) fn step(&self, state: &[f64], time: f64, h: f64, rate: f64) -> Vec<f64> {
        let slope = |state: &[f64], time: f64| -> Vec<f64> {
            let bend = self.accelerations(state, Some(rate * time));
            state[bend.len()..].iter().copied().chain(bend).collect()
        };
        let along = |slope: &[f64], h: f64| -> Vec<f64> {
            state.iter().zip(slope).map(|(x, v)| x + h * v).collect()
        };
        let a = slope(state, time);
        let b = slope(&along(&a, h / 2.0), time + h / 2.0);
        let c = slope(&along(&b, h / 2.0), time + h / 2.0);
        let d = slope(&along(&c, h), time + h);
        let mean = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
        state.iter().enumerate().map(|(i, x)| x + h * mean(i)).collect()
    }
}

fn terms(polynomial: &Polynomial) -> Terms {
    let term = |t: &Term| {
        let waves = t.factor.iter().map(|(h, (a, b))| (f64::from(*h), a.to_f64(), b.to_f64()));
        (waves.collect(), t.powers.clone())
    };
    polynomial.terms.iter().map(term).collect()
}

fn value(terms: &Terms, variables: &[f64], phase: Option<f64>) -> f64 {
    let wave = |(h, a, b): &(f64, f64, f64)| match phase {
        _ if *h == 0.0 => *a,
        None => 0.0,
        Some(phase) => {
            let (sin, cos) = (h * phase).sin_cos();
            a * cos + b * sin
        }
    };
    let term = |(waves, powers): &(Vec<(f64, f64, f64)>, Vec<u32>)| {
        let powers = powers.iter().zip(variables).filter(|(n, _)| **n > 0);
        let product: f64 = powers.map(|(n, x)| x.powi(*n as i32)).product();
        waves.iter().map(wave).sum::<f64>() * product
    };
    terms.iter().map(term).sum()
}
