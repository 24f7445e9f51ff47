//! What the numbers of an image are.

/// What a number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// W_n.
    Squared,
    /// omega_n.
    Frequency,
    /// T_n of T omega = 1.
    Period,
    /// The coefficient of cos k psi.
    Cosine(usize),
    /// The coefficient of sin k psi.
    Sine(usize),
}

impl Place {
    /// k.
    pub(crate) fn harmonic(self) -> Option<usize> {
        match self {
            Self::Cosine(k) | Self::Sine(k) => Some(k),
            Self::Squared | Self::Frequency | Self::Period => None,
        }
    }
}
