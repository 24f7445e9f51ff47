//! What is true on a whole ball about the centre: bounds of the variables, and Z2.

use super::{Contraction, Frame, Weights};
use crate::Failure;
use crate::centre::Variables;
use crate::function::from_units;
use crate::operation::Operation;
use crate::polynomial::Polynomial;
use crate::upward::Up;
use rug::{Float, Rational};

/// Upper bounds on the ball of some radius.
pub(crate) struct Outer {
    pub(crate) frequency: Up,
    /// |dx_i/dtau|.
    pub(super) slopes: Vec<Up>,
    /// The variables.
    pub(crate) at: Vec<Up>,
    /// Their Lipschitz constants.
    lipschitz: Vec<Up>,
}

impl Frame<'_> {
    /// The bounds on the ball of radius r.
    pub(super) fn outer(&self, weights: &Weights, r: &Float) -> Outer {
        let (nu, r) = (weights.nu(), Up::of_float(r));
        let (x, z, _) = self.centre.norms(nu);
        let free = self.extra() == 1;
        let frequency = Up(self.centre.frequency.to_f64().next_up());
        let detuned = if free { Up::ONE.over(self.scale) } else { Up::ZERO };
        let frequency = if free { frequency + r * detuned } else { frequency };
        let slopes: Vec<Up> = z.into_iter().map(|z| z + r).collect();
        let mut at: Vec<Up> = x.into_iter().map(|x| x + r).collect();
        let mut lipschitz = vec![Up::ONE; at.len()];
        at.extend(slopes.iter().map(|z| *z * frequency));
        lipschitz.extend(slopes.iter().map(|z| frequency + *z * detuned));
        let sizes = &weights.at[at.len()..];
        for (i, function) in self.field.functions.iter().enumerate() {
            let partner = match function.kind {
                Operation::Sine => sizes[i + 1],
                Operation::Cosine => sizes[i - 1],
                _ => sizes[i],
            };
            let change = function.argument.change(&at, &lipschitz, nu);
            let [size, derivative] = function.kind.outer(sizes[i], partner, change * r);
            at.push(size);
            lipschitz.push(derivative * change);
        }
        Outer { frequency, slopes, at, lipschitz }
    }

    /// Z2(r) >= |A (DF(c) - DF(d))|/|c - d| for c, d in the ball of radius r.
    pub(crate) fn z2(&self, bounds: &Contraction, weights: &Weights, r: &Float) -> Up {
        self.curvatures(bounds, weights, r).into_iter().fold(Up::ZERO, Up::max)
    }

    /// Its parts, for two functions, for a function and the frequency, for the frequency twice: the second
    /// derivatives of the majorant polynomial, and 2 omega d^2/dtau^2, 2 d^2x/dtau^2 of the inertia.
    pub(super) fn curvatures(&self, bounds: &Contraction, weights: &Weights, r: &Float) -> [Up; 3] {
        let (n, nu, free) = (self.field.unknowns(), weights.nu(), self.extra() == 1);
        let outer = self.outer(weights, r);
        let frequency = outer.frequency;
        // By pairs of unknowns, by an unknown and the frequency, by the frequency twice.
        let mut both = vec![Up::ZERO; n * n];
        let mut mixed = vec![Up::ZERO; n];
        let mut square = Up::ZERO;
        for (_, [a, b], second) in &self.field.second {
            let size = second.majorant(&outer.at, nu);
            let orders = if a == b { vec![(*a, *b)] } else { vec![(*a, *b), (*b, *a)] };
            for (a, b) in orders {
                let rate = |v: usize| if v < n { Up::ONE } else { frequency };
                let (i, k) = (a % n, b % n);
                both[i * n + k] = both[i * n + k] + size * rate(a) * rate(b);
                if b >= n {
                    mixed[i] = mixed[i] + size * rate(a) * outer.slopes[k];
                }
                if a >= n && b >= n {
                    square = square + size * outer.slopes[i] * outer.slopes[k];
                }
            }
        }
        let both = bounds.inverse * both.into_iter().fold(Up::ZERO, Up::max);
        if !free {
            return [both, Up::ZERO, Up::ZERO];
        }
        let by_velocity = |k: usize| -> Up {
            self.field.first.iter().map(|row| row[n + k].majorant(&outer.at, nu)).sum()
        };
        let mixed = mixed.into_iter().enumerate().map(|(k, size)| size + by_velocity(k));
        let twice = Up(2.0);
        let mixed =
            bounds.inverse * mixed.fold(Up::ZERO, Up::max) + twice * frequency * bounds.bend;
        let (.., size) = self.centre.norms(nu);
        let square = bounds.inverse * square + twice * bounds.bend * (size + Up::of_float(r));
        [both, mixed.over(self.scale), square.over(self.scale).over(self.scale)]
    }

    /// A Lipschitz constant of a polynomial in the variables on the ball of radius r.
    pub(crate) fn slope(&self, polynomial: &Polynomial, weights: &Weights, r: &Float) -> Up {
        let outer = self.outer(weights, r);
        polynomial.change(&outer.at, &outer.lipschitz, weights.nu())
    }

    /// What is uncertain of a polynomial at the centre.
    pub(crate) fn unknown(&self, polynomial: &Polynomial, weights: &Weights) -> Up {
        polynomial.uncertainty(&self.outer(weights, &Float::new(53)).at, weights.nu())
    }

    /// The mean over a period of a polynomial at the centre (but for the errors of the functions).
    pub(crate) fn mean(&self, polynomial: &Polynomial) -> Rational {
        Variables::known(self.centre, self.functions).mean(polynomial)
    }

    /// What the errors of the functions make uncertain of a polynomial at the centre.
    pub(crate) fn error_of(&self, polynomial: &Polynomial, weights: &Weights) -> Float {
        let units = polynomial.change(&weights.at, &weights.errors, weights.nu());
        Float::with_val(53, units.0) >> self.centre.bits
    }

    /// The weights for nu >= 1, with the functions enclosed in their norm.
    ///
    /// # Errors
    /// [`Failure::NoFunction`].
    pub(crate) fn weights(&self, nu: f64) -> Result<Weights, Failure> {
        let mut weights = Weights::new(nu, self.reach());
        let (nu, bits) = (weights.nu(), self.centre.bits);
        let (x, z, _) = self.centre.norms(nu);
        let frequency = Up(self.centre.frequency.to_f64().next_up());
        weights.at = x.into_iter().chain(z.into_iter().map(|z| z * frequency)).collect();
        weights.errors = vec![Up::ZERO; weights.at.len()];
        weights.in_middle = weights.errors.clone();
        let first = weights.at.len();
        for tied in &self.ties {
            let argument = &self.field.functions[weights.at.len() - first].argument;
            let uncertain = argument.uncertainty(&weights.at, nu);
            let uncertain = match uncertain == Up::ZERO {
                true => uncertain,
                false => uncertain * Up(2f64.powi(bits as i32)),
            };
            let refused = || Failure::NoFunction { argument: tied.size(nu).0 };
            let error = |errors: &[Up], more: Up| {
                let uncertain = more + argument.change(&weights.at, errors, nu);
                tied.error(nu, uncertain).ok_or_else(refused)
            };
            let in_middle = error(&weights.in_middle, Up::ZERO)?;
            let error = error(&weights.errors, uncertain)?;
            for function in &tied.functions {
                weights.at.push(function.norm(nu, 0) + from_units(error, bits));
                weights.errors.push(error);
                weights.in_middle.push(in_middle);
            }
        }
        Ok(weights)
    }

    /// What errors of the functions make uncertain of F (in units of 2^-bits), of DF on one unknown, and of
    /// dF/domega.
    pub(super) fn of_functions(&self, weights: &Weights, errors: &[Up]) -> [Up; 3] {
        if self.ties.is_empty() {
            return [Up::ZERO; 3];
        }
        let (n, bits) = (self.field.unknowns(), self.centre.bits);
        let frequency = Up(self.centre.frequency.to_f64().next_up());
        let of = |p: &Polynomial| p.change(&weights.at, errors, weights.nu());
        let column = |k: usize| -> Up {
            self.field.first.iter().map(|row| of(&row[k]) + of(&row[n + k]) * frequency).sum()
        };
        let column = (0..n).map(column).fold(Up::ZERO, Up::max);
        let flow = self.field.flow.iter().map(of).sum::<Up>().over(self.frequency_below);
        let residual = self.field.forces.iter().map(of).sum();
        [residual, from_units(column, bits), from_units(flow, bits)]
    }
}
