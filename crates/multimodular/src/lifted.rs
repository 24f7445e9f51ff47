//! What is proved of one order.

use crate::denominator::Denominator;
use crate::function::Function;
use crate::place::Place;
use lindstedt_algebra::Ring;
use lindstedt_expand::OrderNumbers;
use lindstedt_phase::modular::{PrimeFields, Residues};
use rug::Rational;

/// The numbers of one order over their common denominator, and what its numerators belong to.
pub(crate) struct Lifted {
    pub numbers: OrderNumbers,
    places: Vec<Place>,
}

impl Lifted {
    pub(crate) fn new(numbers: OrderNumbers, places: &[Place]) -> Self {
        let harmonics = places.iter().filter(|place| place.harmonic().is_some());
        Self { numbers, places: harmonics.copied().collect() }
    }

    /// W_n and the amplitudes of cosines and sines modulo eight primes; nothing where one divides a denominator.
    pub(crate) fn modulo(&self, field: &PrimeFields) -> Option<(Residues, [Vec<Residues>; 2])> {
        let OrderNumbers { denominator, numerators, squared, .. } = &self.numbers;
        let series = [denominator, squared.denom(), squared.numer()];
        let all = series.into_iter().chain(numerators.iter().map(|(_, c)| c));
        let residues = field.integers(all);
        let ([denominator, of_square, square], numerators) = residues.split_first_chunk()?;
        let inverses = field.reciprocals(&[*denominator, *of_square])?;
        let mut harmonics = [Vec::new(), Vec::new()];
        for (place, c) in self.places.iter().zip(numerators) {
            let (list, k) = match *place {
                Place::Cosine(k) => (&mut harmonics[0], k),
                Place::Sine(k) => (&mut harmonics[1], k),
                Place::Squared | Place::Frequency | Place::Period => continue,
            };
            list.resize(k, field.zero());
            list.push(field.mul(c, &inverses[0]));
        }
        Some((field.mul(square, &inverses[1]), harmonics))
    }

    /// W_n, omega_n and T_n, and x_n; `largest` bounds the primes that denominators are likely to have.
    pub(crate) fn order(self, largest: u32) -> ([Rational; 3], Function) {
        let OrderNumbers { denominator, numerators, squared, frequency, period } = self.numbers;
        let terms = self.places.into_iter().zip(numerators.into_iter().map(|(_, c)| c)).collect();
        ([squared, frequency, period], Function::new(Denominator::new(denominator, largest), terms))
    }
}
