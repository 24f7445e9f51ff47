//! What the recurrences ask of numbers: of those of one integration, and of the numbers of several side by side.

use super::real::{Places, Real};
use std::fmt::Debug;

/// The mode of a switch whose argument w is being carried through zero: |w| and sign w are zero,
/// and what is raised to a power or divided by there.
pub(crate) const LEAP: i8 = 2;

/// The operations, with the modes of switches.
pub(crate) trait Arithmetic: Places {
    /// The sign of a switch; sliding; or carried through zero.
    type Mode: Copy + Debug;

    /// Whether the switch slides: the integrator fills its rows.
    fn slides(&self, mode: Self::Mode) -> bool;
    /// [`LEAP`].
    fn leaps(&self, mode: Self::Mode) -> bool;
    /// to = to times the sign.
    fn times_sign(&self, to: &mut Self::Element, mode: Self::Mode);
    fn is_zero(&self, x: &Self::Element) -> bool;
}

impl<R: Real> Arithmetic for R {
    type Mode = i8;

    #[inline]
    fn slides(&self, mode: i8) -> bool {
        mode == 0
    }
    #[inline]
    fn leaps(&self, mode: i8) -> bool {
        mode == LEAP
    }
    #[inline]
    fn times_sign(&self, to: &mut Self::Element, mode: i8) {
        self.times_integer(to, i32::from(mode));
    }
    #[inline]
    fn is_zero(&self, x: &Self::Element) -> bool {
        self.sign(x) == 0
    }
}
