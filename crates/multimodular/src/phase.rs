//! A random phase modulo a prime.

use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_phase::modular::{PrimeFields, Residues};
use rug::Rational;

/// cos k psi and sin k psi modulo p for e^(i psi) = z, any number but zero: not one of the points of the algebra.
pub(crate) struct Phase {
    cosines: Vec<Residues>,
    sines: Vec<Residues>,
    /// k.
    multiples: Vec<Residues>,
}

impl Phase {
    /// Up to a harmonic; the primes are 1 modulo 4. The phases follow from them and a number, and nothing else follows
    /// from those.
    pub(crate) fn new(field: &PrimeFields, degree: usize, number: u32) -> Option<Self> {
        let z = field.rational(&Rational::from(seed(field.primes()[0], number)));
        let (inverse, half) = (field.reciprocal(&z)?, field.rational(&Rational::from((1, 2))));
        let half_over_i = field.mul(&half, &field.reciprocal(&field.root_of_unity(4)?)?);
        let (mut plus, mut minus, mut multiple) = (field.one(), field.one(), field.zero());
        let mut phase = Self { cosines: Vec::new(), sines: Vec::new(), multiples: Vec::new() };
        for _ in 0..=degree {
            phase.cosines.push(field.mul(&half, &field.add(&plus, &minus)));
            phase.sines.push(field.mul(&half_over_i, &field.sub(&plus, &minus)));
            phase.multiples.push(multiple);
            (plus, minus) = (field.mul(&plus, &z), field.mul(&minus, &inverse));
            field.add_assign(&mut multiple, &field.one());
        }
        Some(phase)
    }

    /// f, f' and f'' there, from the amplitudes of cosines and sines.
    pub(crate) fn values(
        &self,
        field: &PrimeFields,
        [cos, sin]: &[Vec<Residues>; 2],
    ) -> [Residues; 3] {
        let mut values = [field.zero(); 3];
        for (k, multiple) in self.multiples.iter().enumerate() {
            let at = |list: &[Residues]| list.get(k).copied().unwrap_or_default();
            let (a, b) = (at(cos), at(sin));
            if field.is_zero(&a) && field.is_zero(&b) {
                continue;
            }
            let even = field.add(&field.mul(&a, &self.cosines[k]), &field.mul(&b, &self.sines[k]));
            let odd = field.sub(&field.mul(&b, &self.cosines[k]), &field.mul(&a, &self.sines[k]));
            let bend = field.mul(&field.mul(multiple, multiple), &even);
            field.add_assign(&mut values[0], &even);
            field.add_assign(&mut values[1], &field.mul(multiple, &odd));
            field.add_assign(&mut values[2], &field.neg(&bend));
        }
        values
    }
}

/// A step of the generator splitmix64; another residue modulo every prime.
fn seed(prime: u32, number: u32) -> u64 {
    let mut seed = u64::from(prime) << 32 | u64::from(number);
    seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    seed = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    seed = (seed ^ (seed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (seed >> 4).max(2)
}
