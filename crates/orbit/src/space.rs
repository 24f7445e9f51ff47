//! The real basis 1, cos k tau, sin k tau up to a mode, with the symmetries that the equation keeps.

use nalgebra::Complex;

/// The symmetries of an orbit that F keeps; each halves the unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Parity {
    /// x(tau + pi) = -x(tau): odd harmonics alone.
    pub odd: bool,
    /// x(-tau) = x(tau): cosines alone.
    pub even: bool,
}

/// cos k tau (or 1), or sin k tau.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Wave {
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
    /// Whether mode k can be there.
    pub(crate) fn has(self, k: usize) -> bool {
        !self.odd || k % 2 == 1
    }

    /// The waves of mode k.
    pub(crate) fn waves(self, k: usize) -> impl Iterator<Item = Wave> + Clone {
        let cosine = self.has(k).then_some(Wave { k, sine: false });
        let sine = (self.has(k) && !self.even && k > 0).then_some(Wave { k, sine: true });
        cosine.into_iter().chain(sine)
    }

    /// The waves up to mode `modes`.
    pub(crate) fn basis(self, modes: usize) -> Vec<Wave> {
        (0..=modes).flat_map(|k| self.waves(k)).collect()
    }
}
