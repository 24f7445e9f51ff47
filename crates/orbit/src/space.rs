//! The real basis 1, cos k tau, sin k tau up to a mode for every unknown, with the symmetries that the
//! equations keep.

use nalgebra::Complex;

/// Patterns of signs: bit i stands for unknown i and is set where it changes its sign.
pub(crate) type Signs = Vec<u64>;

/// The symmetries of an orbit that F keeps; each halves the unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Parity {
    /// x(tau + pi) = -x(tau): odd harmonics alone. Of several unknowns some may keep their sign: even
    /// harmonics.
    pub odd: bool,
    /// x(-tau) = x(tau): cosines alone. Of several unknowns some may change their sign: sines.
    pub even: bool,
    /// The unknowns that keep their sign under the shift.
    #[serde(skip)]
    pub(crate) keeping: u64,
    /// The unknowns that change it under the reversal.
    #[serde(skip)]
    pub(crate) turning: u64,
}

/// cos k tau (or 1), or sin k tau, of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Wave {
    pub(crate) unknown: usize,
    pub(crate) k: usize,
    pub(crate) sine: bool,
}

impl Wave {
    /// The real coefficient of this wave in the function with the complex coefficients c_k.
    pub(crate) fn of(self, c: Complex<f64>) -> f64 {
        match (self.k, self.sine) {
            (0, _) => c.re,
            (_, false) => 2.0 * c.re,
            (_, true) => -2.0 * c.im,
        }
    }

    /// The complex coefficient c_k of `value` times this wave.
    pub(crate) fn complex(self, value: f64) -> Complex<f64> {
        match (self.k, self.sine) {
            (0, _) => Complex::new(value, 0.0),
            (_, false) => Complex::new(value / 2.0, 0.0),
            (_, true) => Complex::new(0.0, -value / 2.0),
        }
    }
}

impl Parity {
    /// Whether mode k of an unknown can be there.
    pub(crate) fn has(self, unknown: usize, k: usize) -> bool {
        !self.odd || (k % 2 == 1) != (self.keeping >> unknown & 1 == 1)
    }

    /// The waves of mode k of an unknown.
    pub(crate) fn waves(self, unknown: usize, k: usize) -> impl Iterator<Item = Wave> + Clone {
        let has = self.has(unknown, k);
        let turns = self.even && self.turning >> unknown & 1 == 1;
        let cosine = (has && !turns).then_some(Wave { unknown, k, sine: false });
        let sines = has && k > 0 && (!self.even || turns);
        let sine = sines.then_some(Wave { unknown, k, sine: true });
        cosine.into_iter().chain(sine)
    }

    /// The waves up to mode `modes` of so many unknowns.
    pub(crate) fn basis(self, unknowns: usize, modes: usize) -> Vec<Wave> {
        let of = |i: usize| (0..=modes).flat_map(move |k| self.waves(i, k));
        (0..unknowns).flat_map(of).collect()
    }
}
