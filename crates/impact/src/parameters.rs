//! The parameters of the oscillator.
//!
//! x'' + c x' + alpha^2 x = P0 cos(omega t) + A (x - x_T) + B (x' - x'_T) for x <= s, and at x = s
//! x' -> -R_r x'; x_T = x(t - T), T = 2 pi k/omega. All numbers are dimensionless.

use crate::error::ImpactError;
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_number::real::{Certified, Real};

/// The sign of the root in the quadratic equation for the impact velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The larger impact velocity.
    Plus,
    /// The smaller one: always a saddle, with a multiplier above 1 that no delay loop can move in.
    Minus,
}

/// One parameter set over the reals S.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameters<S> {
    /// alpha > 0, frequency of the undamped free flight.
    pub alpha: S,
    /// omega > 0, frequency of the force.
    pub omega: S,
    /// k >= 1, periods of the force between two impacts.
    pub periods: u32,
    /// R_r in \[0, 1\], restitution coefficient.
    pub restitution: S,
    /// s, position of the wall.
    pub wall: S,
    /// c >= 0, damping.
    pub damping: S,
    /// P0 > 0, amplitude of the force.
    pub force: S,
    /// A, gain of the displacement loop.
    pub displacement_gain: S,
    /// B, gain of the velocity loop.
    pub velocity_gain: S,
    /// Sign of the root in the impact velocity.
    pub branch: Branch,
}

/// A parameter that can be swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swept {
    /// alpha.
    Alpha,
    /// omega (T = 2 pi k/omega follows).
    Omega,
    /// R_r.
    Restitution,
    /// s.
    Wall,
    /// c.
    Damping,
    /// P0.
    Force,
    /// A.
    DisplacementGain,
    /// B.
    VelocityGain,
}

impl Swept {
    /// All of them with their names.
    pub const ALL: [(&'static str, Self); 8] = [
        ("alpha", Self::Alpha),
        ("omega", Self::Omega),
        ("R_r", Self::Restitution),
        ("s", Self::Wall),
        ("c", Self::Damping),
        ("P0", Self::Force),
        ("A", Self::DisplacementGain),
        ("B", Self::VelocityGain),
    ];
}

impl<S> Parameters<S> {
    /// The place of a parameter.
    pub fn slot(&mut self, swept: Swept) -> &mut S {
        match swept {
            Swept::Alpha => &mut self.alpha,
            Swept::Omega => &mut self.omega,
            Swept::Restitution => &mut self.restitution,
            Swept::Wall => &mut self.wall,
            Swept::Damping => &mut self.damping,
            Swept::Force => &mut self.force,
            Swept::DisplacementGain => &mut self.displacement_gain,
            Swept::VelocityGain => &mut self.velocity_gain,
        }
    }
    /// The same in other numbers.
    pub(crate) fn map<T>(&self, number: impl Fn(&S) -> T) -> Parameters<T> {
        Parameters {
            alpha: number(&self.alpha),
            omega: number(&self.omega),
            periods: self.periods,
            restitution: number(&self.restitution),
            wall: number(&self.wall),
            damping: number(&self.damping),
            force: number(&self.force),
            displacement_gain: number(&self.displacement_gain),
            velocity_gain: number(&self.velocity_gain),
            branch: self.branch,
        }
    }
}

impl<S: Real> Parameters<S> {
    /// T = 2 pi k/omega, delay and period of the orbit.
    pub fn period(&self) -> S {
        let two_k = self.omega.integer(2 * i64::from(self.periods));
        self.omega.pi() * two_k / &self.omega
    }
    /// F = P0/sqrt((alpha^2 - omega^2)^2 + c^2 omega^2), amplitude of the forced part; not finite
    /// for alpha = omega, c = 0.
    pub fn forced_amplitude(&self) -> S {
        let (detuning, loss) = self.forced_denominator();
        self.force.clone() / (detuning.square() + loss.square()).sqrt()
    }
    /// theta0 = atan2(c omega, alpha^2 - omega^2): with the force P0 cos(omega t + psi) the forced
    /// part is F cos(omega t + psi - theta0).
    pub fn phase_lag(&self) -> S {
        let (detuning, loss) = self.forced_denominator();
        loss.atan2(&detuning)
    }
    /// (alpha^2 - omega^2, c omega), the first without cancellation.
    pub(crate) fn forced_denominator(&self) -> (S, S) {
        let sum = self.alpha.clone() + &self.omega;
        let difference = self.alpha.clone() - &self.omega;
        (sum * difference, self.damping.clone() * &self.omega)
    }
    /// The midpoints.
    pub fn to_f64(&self) -> Parameters<f64> {
        self.map(S::to_f64)
    }
    /// Checks the domain of every parameter.
    ///
    /// # Errors
    /// [`ImpactError::NotFinite`], [`ImpactError::NotPositive`], [`ImpactError::OutOfRange`].
    pub fn validate(&self) -> Result<(), ImpactError> {
        let named = [
            ("alpha", &self.alpha),
            ("omega", &self.omega),
            ("P0", &self.force),
            ("R_r", &self.restitution),
            ("c", &self.damping),
            ("s", &self.wall),
            ("A", &self.displacement_gain),
            ("B", &self.velocity_gain),
        ];
        for (name, value) in named {
            if !value.is_finite() {
                return Err(ImpactError::NotFinite { name });
            }
        }
        for (name, value) in &named[..3] {
            if !value.is_positive() {
                return Err(ImpactError::NotPositive { name, value: value.to_f64() });
            }
        }
        if self.periods == 0 {
            return Err(ImpactError::NotPositive { name: "k", value: 0.0 });
        }
        let above = self.restitution.clone() - self.restitution.integer(1);
        if self.restitution.is_negative() || above.is_positive() {
            let value = self.restitution.to_f64();
            let name = "R_r, the restitution,";
            return Err(ImpactError::OutOfRange { name, value, low: 0.0, high: 1.0 });
        }
        if self.damping.is_negative() {
            return Err(ImpactError::Negative { name: "c", value: self.damping.to_f64() });
        }
        Ok(())
    }
}

/// A parameter set with exact numbers, the input of the certified path.
pub type ExactParameters = Parameters<Exact>;

impl ExactParameters {
    /// Enclosures at the given precision.
    #[must_use]
    pub fn certified(&self, bits: u32) -> Parameters<Certified> {
        let balls = Balls::new(bits);
        self.map(|number| Certified::new(balls, number.ball(balls)))
    }
    /// The nearest doubles.
    #[must_use]
    pub fn nearest(&self) -> Parameters<f64> {
        self.map(Exact::to_f64)
    }
}
