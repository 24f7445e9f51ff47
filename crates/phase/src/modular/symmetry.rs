//! Symmetries under psi -> -psi and psi -> pi - psi.

/// The four symmetries, in this order.
pub(super) const SYMMETRIES: [Symmetry; 4] = [
    Symmetry { sine: false, odd: false },
    Symmetry { sine: false, odd: true },
    Symmetry { sine: true, odd: false },
    Symmetry { sine: true, odd: true },
];

/// Cosines or sines, of even or of odd multiples of the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Symmetry {
    pub sine: bool,
    pub odd: bool,
}

impl Symmetry {
    pub fn index(self) -> usize {
        2 * usize::from(self.sine) + usize::from(self.odd)
    }
    /// The k-th multiple: 0, 2, 4 (cosines), 2, 4, 6 (sines) or 1, 3, 5.
    pub fn harmonic(self, k: usize) -> usize {
        match (self.sine, self.odd) {
            (false, false) => 2 * k,
            (true, false) => 2 * k + 2,
            (_, true) => 2 * k + 1,
        }
    }
    pub fn times(self, other: Self) -> Self {
        Self { sine: self.sine ^ other.sine, odd: self.odd ^ other.odd }
    }
}
