//! Where an orbit is proved to be and where it is alone; whether two proofs speak of one orbit.

use crate::centre::Centre;
use crate::upward::Up;
use crate::{Condition, Parity};
use rug::float::Round;
use rug::{Float, Rational};

/// The ball with the orbit and the one in which it is alone.
pub(crate) struct Place {
    pub(crate) parity: Parity,
    /// nu and s of the norm.
    pub(crate) weight: f64,
    pub(crate) scale: f64,
    pub(crate) centre: Centre,
    /// How far the middle of the balls can be from the centre.
    pub(crate) slack: Up,
    pub(crate) radius: Float,
    pub(crate) unique_within: Float,
    /// The condition, its value and the error of that; nothing of a forced orbit.
    pub(crate) condition: Option<(Condition, Rational, Up)>,
}

impl Place {
    /// Whether it is proved that the orbit in the one ball is the orbit in the other: one ball of an orbit lies in
    /// the other's of uniqueness.
    pub(crate) fn is_same_as(&self, other: &Self) -> bool {
        self.surrounds(other) || other.surrounds(self)
    }

    /// Whether the ball with the other's orbit lies in the one in which this orbit is alone. The norms must be
    /// comparable: that of the other at least this one, but for the weights of the frequency.
    fn surrounds(&self, other: &Self) -> bool {
        let (mine, others) = (self.parity, other.parity);
        let is_odd = others.odd && others.keeping == mine.keeping;
        let is_even = others.even && others.turning == mine.turning;
        let is_among = (!mine.odd || is_odd) && (!mine.even || is_even);
        let one_question = match (&self.condition, &other.condition) {
            (None, None) => true,
            (Some((mine, a, near)), Some((others, b, by))) => {
                mine == others && Up::of(&Rational::from(a - b)) <= *near + *by
            }
            _ => false,
        };
        if !one_question || self.weight > other.weight || !is_among {
            return false;
        }
        let scale = self.condition.as_ref().map(|_| self.scale);
        let apart = self.centre.distance(&other.centre, Up(self.weight), scale);
        let times = Up(self.scale).over(other.scale).max(Up::ONE);
        let reach = apart + self.slack + (Up::of_float(&other.radius) + other.slack) * times;
        reach.0 <= self.unique_within.to_f64_round(Round::Down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    fn place(amplitude: f64, [radius, unique, slack]: [f64; 3]) -> Place {
        let modes = vec![Complex::default(), Complex::new(amplitude / 2.0, 0.0)];
        Place {
            parity: Parity::default(),
            weight: 1.0,
            scale: 1.0,
            centre: Centre::from_doubles(72, 1.0, &[modes]),
            slack: Up(slack),
            radius: Float::with_val(53, radius),
            unique_within: Float::with_val(53, unique),
            condition: None,
        }
    }

    /// Distance, radius and slack of the one must fit into the ball in which the other is alone.
    #[test]
    fn one_ball_must_lie_in_the_other() {
        let wide = place(1.0, [1e-3, 0.1, 0.0]);
        for (amplitude, numbers, same) in [
            (1.05, [0.04, 0.0, 0.0], true),
            (1.2, [0.04, 0.0, 0.0], false),
            (1.05, [0.06, 0.0, 0.0], false),
            (1.05, [0.04, 0.0, 0.02], false),
        ] {
            let other = place(amplitude, numbers);
            assert_eq!(wide.is_same_as(&other), same, "{amplitude} {numbers:?}");
            assert_eq!(other.is_same_as(&wide), same);
        }
        let moved = Place { slack: Up(0.07), ..place(1.0, [1e-3, 0.1, 0.0]) };
        assert!(!moved.is_same_as(&place(1.05, [0.04, 0.0, 0.0])));
    }
}
