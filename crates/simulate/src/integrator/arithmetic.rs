//! What the recurrences ask of numbers: of those of one integration, and of the numbers of several side by side.

use super::real::Real;
use std::fmt::Debug;

/// The mode of a switch whose argument w is being carried through zero: |w| and sign w are zero,
/// and what is raised to a power or divided by there.
pub(crate) const LEAP: i8 = 2;

/// The operations of [`Real`] on places, with the modes of switches.
pub(crate) trait Arithmetic {
    /// A number.
    type Element: Clone + Debug;
    /// The sign of a switch; sliding; or carried through zero.
    type Mode: Copy + Debug;

    /// Whether the switch slides: the integrator fills its rows.
    fn slides(&self, mode: Self::Mode) -> bool;
    /// [`LEAP`].
    fn leaps(&self, mode: Self::Mode) -> bool;
    /// to = to times the sign.
    fn times_sign(&self, to: &mut Self::Element, mode: Self::Mode);
    fn is_zero(&self, x: &Self::Element) -> bool;
    fn zero(&self) -> Self::Element;
    fn double(&self, x: f64) -> Self::Element;
    fn negative(&self, a: &Self::Element) -> Self::Element;
    fn set(&self, to: &mut Self::Element, x: &Self::Element);
    fn set_zero(&self, to: &mut Self::Element);
    fn add(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    fn subtract(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    fn multiply(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    fn divide(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    fn increase(&self, to: &mut Self::Element, a: &Self::Element);
    fn accumulate(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    fn scale(&self, to: &mut Self::Element, a: &Self::Element);
    fn times_integer(&self, to: &mut Self::Element, n: i32);
    fn over_integer(&self, to: &mut Self::Element, n: u32);
    fn exp(&self, to: &mut Self::Element, x: &Self::Element);
    fn ln(&self, to: &mut Self::Element, x: &Self::Element);
    fn sin(&self, to: &mut Self::Element, x: &Self::Element);
    fn cos(&self, to: &mut Self::Element, x: &Self::Element);
    fn power(&self, to: &mut Self::Element, x: &Self::Element, p: &Self::Element);
    fn convolve(&self, to: &mut Self::Element, a: &[Self::Element], b: &[Self::Element]);
    fn convolve_derivative(
        &self,
        to: &mut Self::Element,
        scratch: &mut Self::Element,
        a: &[Self::Element],
        b: &[Self::Element],
    );
}

/// The operations as those of a real number.
macro_rules! forward {
    ($($name:ident($($argument:ident: $kind:ty),*);)*) => {
        $(#[inline]
        fn $name(&self, to: &mut Self::Element, $($argument: $kind),*) {
            Real::$name(self, to, $($argument),*);
        })*
    };
}

impl<R: Real> Arithmetic for R {
    type Element = R::Element;
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
        Real::times_integer(self, to, i32::from(mode));
    }
    #[inline]
    fn is_zero(&self, x: &Self::Element) -> bool {
        Real::sign(self, x) == 0
    }
    #[inline]
    fn zero(&self) -> Self::Element {
        Real::zero(self)
    }
    #[inline]
    fn double(&self, x: f64) -> Self::Element {
        Real::double(self, x)
    }
    #[inline]
    fn negative(&self, a: &Self::Element) -> Self::Element {
        Real::negative(self, a)
    }
    forward! {
        set(x: &Self::Element);
        set_zero();
        add(a: &Self::Element, b: &Self::Element);
        subtract(a: &Self::Element, b: &Self::Element);
        multiply(a: &Self::Element, b: &Self::Element);
        divide(a: &Self::Element, b: &Self::Element);
        increase(a: &Self::Element);
        accumulate(a: &Self::Element, b: &Self::Element);
        scale(a: &Self::Element);
        times_integer(n: i32);
        over_integer(n: u32);
        exp(x: &Self::Element);
        ln(x: &Self::Element);
        sin(x: &Self::Element);
        cos(x: &Self::Element);
        power(x: &Self::Element, p: &Self::Element);
        convolve(a: &[Self::Element], b: &[Self::Element]);
        convolve_derivative(scratch: &mut Self::Element, a: &[Self::Element], b: &[Self::Element]);
    }
}
