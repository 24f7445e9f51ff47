//! The parameters of the stick-slip oscillator, exact or in doubles.

use lindstedt_number::Exact;

/// x'' = a x - b x^3 + eps (gamma cos(omega t) - T(x' - v*)),
/// T(w) = T0 sgn w - alpha w + beta w^3. All dimensionless. The closed form of a [`System`](crate::System), where it has one:
/// [`StickSlip::of`]; the system of a closed form: [`StickSlip::system`]. In doubles: [`FastPoint`].
///
/// ```
/// use lindstedt_melnikov::{Forcing, Friction, PolynomialFriction, Potential, StickSlip, System};
/// use lindstedt_number::{Exact, ball::Balls};
///
/// let friction = PolynomialFriction::cubic(Exact::from((3, 10)), &Exact::from((3, 10)), Exact::from((3, 10)));
/// let well = Potential::DoubleWell { a: Exact::from(1), b: Exact::from(1) };
/// let forcing = Forcing::single(Exact::from(2));
/// let system = System::new(well, Friction::Polynomial(friction), forcing, Exact::from((2, 5)))?;
/// let closed = StickSlip::of(&system).and_then(|form| form.signed_threshold(Balls::new(60)));
/// assert!(closed.is_some_and(|gamma| (gamma.midpoint().to_f64() - 0.6370713428481636).abs() < 1e-15));
/// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StickSlip<T = Exact> {
    /// a > 0.
    pub a: T,
    /// b > 0.
    pub b: T,
    /// T0, the dry friction.
    pub dry: T,
    /// alpha.
    pub alpha: T,
    /// beta.
    pub beta: T,
    /// omega > 0.
    pub omega: T,
    /// v*, the belt speed.
    pub belt_speed: T,
}

/// The parameters in doubles.
pub type FastPoint = StickSlip<f64>;

/// A parameter to sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// a.
    A,
    /// b.
    B,
    /// T0.
    Dry,
    /// alpha.
    Alpha,
    /// beta.
    Beta,
    /// omega.
    Omega,
    /// v*.
    BeltSpeed,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::A, Self::B, Self::Dry, Self::Alpha, Self::Beta, Self::Omega, Self::BeltSpeed];
}

impl<T> StickSlip<T> {
    /// The same with one parameter changed.
    #[must_use]
    #[inline]
    pub fn with(mut self, axis: Axis, value: T) -> Self {
        match axis {
            Axis::A => self.a = value,
            Axis::B => self.b = value,
            Axis::Dry => self.dry = value,
            Axis::Alpha => self.alpha = value,
            Axis::Beta => self.beta = value,
            Axis::Omega => self.omega = value,
            Axis::BeltSpeed => self.belt_speed = value,
        }
        self
    }

    /// The value of one parameter.
    #[must_use]
    pub fn get(&self, axis: Axis) -> &T {
        match axis {
            Axis::A => &self.a,
            Axis::B => &self.b,
            Axis::Dry => &self.dry,
            Axis::Alpha => &self.alpha,
            Axis::Beta => &self.beta,
            Axis::Omega => &self.omega,
            Axis::BeltSpeed => &self.belt_speed,
        }
    }

    /// The parameters as other numbers.
    pub fn map<U>(&self, number: impl Fn(&T) -> U) -> StickSlip<U> {
        StickSlip {
            a: number(&self.a),
            b: number(&self.b),
            dry: number(&self.dry),
            alpha: number(&self.alpha),
            beta: number(&self.beta),
            omega: number(&self.omega),
            belt_speed: number(&self.belt_speed),
        }
    }
}
