//! The bounds for an orbit that moves with a parameter, c(s) = cbar + s d, -1 <= s <= 1: what its places add to
//! those at cbar.

use super::{Contraction, Frame, Weights};
use crate::drift::Drift;
use crate::function::from_units;
use crate::polynomial::Polynomial;
use crate::upward::Up;
use rug::Float;
use rug::float::Round;

impl Frame<'_> {
    /// The radius of a ball about cbar with all balls of radius r about the places of the centre.
    pub(crate) fn around(&self, weights: &Weights, r: &Float) -> Float {
        match self.drift {
            None => r.clone(),
            Some(d) => Float::with_val_round(53, r + &self.length(d, weights), Round::Up).0,
        }
    }

    /// The norm of d, rounded up.
    pub(crate) fn length(&self, drift: &Drift, weights: &Weights) -> Float {
        let (.., size) = drift.step.norms(weights.nu());
        let frequency = if self.extra() == 1 { Up::of(&drift.step.frequency) } else { Up::ZERO };
        Float::with_val(53, (size + frequency * Up(self.scale)).0)
    }

    /// Y0 with |A G'(0)| (`moves`) and the rest of the second order; Z1 with the change of DF from cbar to c(s).
    pub(super) fn moving(
        &self,
        still: Contraction,
        drift: &Drift,
        moves: &Float,
        weights: &Weights,
    ) -> Contraction {
        let up = |a: &Float, b: &Float| Float::with_val_round(53, a + b, Round::Up).0;
        let (rest, errors) = self.rest(&still, drift, weights);
        let y0 = up(&up(&up(&still.y0, moves), &Float::with_val(53, rest.0)), &errors);
        let length = self.length(drift, weights);
        let change = self.z2(&still, weights, &length) * Up::of_float(&length);
        Contraction { y0, z1: still.z1 + change, change, ..still }
    }

    /// |A G''|/2 for all s, and what the errors of the functions in the middle add to G(0) + s G'(0).
    pub(super) fn rest(
        &self,
        still: &Contraction,
        drift: &Drift,
        weights: &Weights,
    ) -> (Up, Float) {
        let (n, nu) = (self.field.unknowns(), weights.nu());
        let (h, slopes, size) = drift.step.norms(nu);
        let outer = self.outer(weights, &self.length(drift, weights));
        let turn = if self.extra() == 1 { Up::of(&drift.step.frequency) } else { Up::ZERO };
        // |dv/ds| with v = omega z.
        let rates = (0..n).map(|k| turn * outer.slopes[k] + outer.frequency * slopes[k]);
        let by: Vec<Up> = h.into_iter().chain(rates).collect();
        let of = |p: &Polynomial| p.majorant(&outer.at, nu);
        let twice = |a: usize, b: usize| if a == b { Up::ONE } else { Up(2.0) };
        let second = self.field.second.iter();
        let mut bent: Up =
            second.map(|(_, [a, b], p)| of(p) * by[*a] * by[*b] * twice(*a, *b)).sum();
        let velocities = self.field.first.iter().flat_map(|row| row[n..].iter().zip(&slopes));
        bent = bent + velocities.map(|(p, slope)| of(p) * Up(2.0) * turn * *slope).sum();
        let errors = |list: &[Polynomial]| -> Up {
            list.iter().map(|p| p.change(&weights.at, &weights.in_middle, nu)).sum()
        };
        let [residual, column, flow] = self.of_functions(weights, &weights.in_middle);
        let mut uncertain = column * size + flow * turn;
        if let Some(varying) = &self.field.varying {
            let mixed = varying.first.iter().flat_map(|row| row.iter().zip(&by));
            bent = bent + mixed.map(|(p, by)| of(p) * Up(2.0) * *by).sum();
            bent = bent + varying.second.iter().map(of).sum();
            uncertain = uncertain + from_units(errors(&varying.forces), self.centre.bits);
        }
        let (.., whole) = self.centre.norms(nu);
        let inertia =
            Up(2.0) * turn * turn * (whole + size) + Up(4.0) * outer.frequency * turn * size;
        let rest = (still.inverse * bent + still.bend * inertia) * Up(0.5);
        let residual = Float::with_val(53, (still.inverse * residual).0) >> self.centre.bits;
        let uncertain = Float::with_val(53, (still.inverse * uncertain).0);
        (rest, Float::with_val_round(53, &residual + &uncertain, Round::Up).0)
    }
}
