//! Potentials with a known homoclinic or heteroclinic orbit.

use crate::crossing::{self, largest_value};
use crate::error::positive;
use crate::hyperbolic::{Hyperbolic, HyperbolicRing};
use crate::orbit::{check_pendulum, check_phi_six};
use crate::root::sqrt_positive_part;
use crate::{MelnikovError, Monomial, OrbitDescription};
use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// Which of the two mirror-image orbits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The right loop (x > 0), the kink, the upper separatrix.
    Positive,
    /// Its mirror image x -> -x.
    Negative,
}

impl Branch {
    /// +1 or -1.
    #[must_use]
    pub fn sign(self) -> i64 {
        match self {
            Self::Positive => 1,
            Self::Negative => -1,
        }
    }
}

/// A conservative oscillator x'' = f(x) with its orbit x0(t); t = 0 is the time of symmetry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Potential {
    /// x'' = a x - b x^3, x0 = sqrt(2a/b) sech(sqrt(a) t): the paper's (20).
    DoubleWell {
        /// a > 0.
        a: Exact,
        /// b > 0.
        b: Exact,
    },
    /// x'' = -a x + b x^3, x0 = sqrt(a/b) tanh(sqrt(a/2) t): softening Duffing, heteroclinic.
    SoftDuffing {
        /// a > 0.
        a: Exact,
        /// b > 0.
        b: Exact,
    },
    /// x'' = a x - b x^2, x0 = (3a/2b) sech^2(sqrt(a) t/2): one loop only.
    Helmholtz {
        /// a > 0.
        a: Exact,
        /// b > 0.
        b: Exact,
    },
    /// x'' = -a sin x, x0 = 2 gd(sqrt(a) t), x0' = 2 sqrt(a) sech(sqrt(a) t): heteroclinic.
    Pendulum {
        /// a > 0, the square of the frequency of small swings.
        a: Exact,
    },
    /// Any polynomial force with an orbit in the hyperbolic algebra; what the others have in closed
    /// form is found by certified crossings here.
    Described {
        /// Force, scales and shape, checked against each other.
        orbit: Box<OrbitDescription>,
        /// a > 0 (1 where the description does not use it).
        a: Exact,
        /// b > 0 (1 where the description does not use it).
        b: Exact,
    },
    /// x'' = a x (1 - x^2)(1 - 3 x^2), x0 = (1 + e^{-2 kappa t})^{-1/2}, kappa = sqrt(a), from the
    /// saddle 0 to the saddle 1.
    PhiSix {
        /// a > 0.
        a: Exact,
    },
}

impl Potential {
    /// The orbit in the hyperbolic algebra, where the potential is a polynomial and it lies there.
    #[must_use]
    pub fn description(&self) -> Option<OrbitDescription> {
        let zero = || Monomial::new(0, 1, 0, 0);
        let m = Monomial::new;
        match self {
            Self::DoubleWell { .. } => Some(OrbitDescription {
                force: vec![zero(), m(1, 1, 1, 0), zero(), m(-1, 1, 0, 1)],
                rate_squared: m(1, 1, 1, 0),
                amplitude_squared: m(2, 1, 1, -1),
                shape: Hyperbolic::sech(1),
            }),
            Self::SoftDuffing { .. } => Some(OrbitDescription {
                force: vec![zero(), m(-1, 1, 1, 0), zero(), m(1, 1, 0, 1)],
                rate_squared: m(1, 2, 1, 0),
                amplitude_squared: m(1, 1, 1, -1),
                shape: Hyperbolic::tanh(),
            }),
            Self::Helmholtz { .. } => Some(OrbitDescription {
                force: vec![zero(), m(1, 1, 1, 0), m(-1, 1, 0, 1)],
                rate_squared: m(1, 4, 1, 0),
                amplitude_squared: m(9, 4, 2, -2),
                shape: Hyperbolic::sech(2),
            }),
            Self::Described { orbit, .. } => Some((**orbit).clone()),
            Self::Pendulum { .. } | Self::PhiSix { .. } => None,
        }
    }

    /// The parameters with their names.
    #[must_use]
    pub fn parameters(&self) -> Vec<(&'static str, &Exact)> {
        match self {
            Self::DoubleWell { a, b }
            | Self::SoftDuffing { a, b }
            | Self::Helmholtz { a, b }
            | Self::Described { a, b, .. } => {
                vec![("a", a), ("b", b)]
            }
            Self::Pendulum { a } | Self::PhiSix { a } => vec![("a", a)],
        }
    }

    /// Positive parameters, and the orbit satisfies the equation of motion (in the algebra).
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`] or [`MelnikovError::WrongOrbit`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        for (name, value) in self.parameters() {
            positive(value, name)?;
        }
        if let Some(description) = self.description() {
            return description.check();
        }
        let ring = HyperbolicRing;
        match self {
            Self::Pendulum { .. } => {
                // x = 2 gd z: sin x = 2 sech tanh, cos x = 2 sech^2 - 1.
                let v = ring.scale(&Hyperbolic::sech(1), &Rational::from(2));
                let s = ring.mul(&v, &Hyperbolic::tanh());
                let c = ring.scale(&Hyperbolic::sech(2), &Rational::from(2));
                check_pendulum(&v, &s, &ring.sub(&c, &ring.one()))
            }
            // x^2 = 1/(1 + e^{-2z}) = (1 + tanh z)/2.
            _ => check_phi_six(
                &ring.scale(&ring.add(&ring.one(), &Hyperbolic::tanh()), &Rational::from((1, 2))),
            ),
        }
    }

    /// Whether x -> -x maps the equation to itself, so that both branches exist.
    #[must_use]
    pub fn has_mirror_image(&self) -> bool {
        match self {
            Self::Helmholtz { .. } => false,
            Self::Described { orbit, .. } => {
                orbit.force.iter().step_by(2).all(|f| f.coefficient.is_zero())
            }
            _ => true,
        }
    }

    /// Whether x0 returns to the saddle where it came from.
    #[must_use]
    pub fn is_homoclinic(&self) -> bool {
        match self {
            // An even shape returns; an odd part makes a step or an asymmetric loop, for which
            // nothing is assumed.
            Self::Described { orbit, .. } => orbit.shape.terms().all(|(_, _, odd)| !odd),
            _ => matches!(self, Self::DoubleWell { .. } | Self::Helmholtz { .. }),
        }
    }

    /// kappa, the rate in z = kappa t.
    #[must_use]
    pub fn rate(&self, balls: Balls) -> Option<Ball> {
        match self {
            Self::DoubleWell { a, .. } | Self::Pendulum { a } | Self::PhiSix { a } => {
                balls.sqrt(&a.ball(balls))
            }
            Self::SoftDuffing { a, .. } => balls.sqrt(&balls.mul_power_of_two(&a.ball(balls), -1)),
            Self::Helmholtz { a, .. } => {
                Some(balls.mul_power_of_two(&balls.sqrt(&a.ball(balls))?, -1))
            }
            Self::Described { orbit, a, b } => balls.sqrt(&orbit.rate_squared.ball(balls, a, b)?),
        }
    }

    /// X, the scale of x; 1 for the pendulum and phi^6.
    #[must_use]
    pub fn amplitude(&self, balls: Balls) -> Option<Ball> {
        match self {
            Self::DoubleWell { a, b } => {
                let ratio = balls.div(&a.ball(balls), &b.ball(balls))?;
                balls.sqrt(&balls.mul_power_of_two(&ratio, 1))
            }
            Self::SoftDuffing { a, b } => balls.sqrt(&balls.div(&a.ball(balls), &b.ball(balls))?),
            Self::Helmholtz { a, b } => {
                let ratio = balls.div(&a.ball(balls), &b.ball(balls))?;
                Some(balls.mul_rational(&ratio, &Rational::from((3, 2))))
            }
            Self::Described { orbit, a, b } => {
                balls.sqrt(&orbit.amplitude_squared.ball(balls, a, b)?)
            }
            Self::Pendulum { .. } | Self::PhiSix { .. } => Some(balls.one()),
        }
    }

    /// dxi/dz, so that v0 = X kappa dxi/dz; `None` for phi^6, which leaves the algebra.
    #[must_use]
    pub fn velocity_shape(&self) -> Option<Hyperbolic> {
        let ring = HyperbolicRing;
        match self {
            Self::Pendulum { .. } => Some(ring.scale(&Hyperbolic::sech(1), &Rational::from(2))),
            Self::PhiSix { .. } => None,
            _ => Some(ring.derivative(&self.description()?.shape)),
        }
    }

    /// X kappa.
    pub(crate) fn velocity_scale(&self, balls: Balls) -> Option<Ball> {
        Some(balls.mul(&self.amplitude(balls)?, &self.rate(balls)?))
    }

    /// V = max |v0|, the largest speed on the orbit.
    #[must_use]
    pub fn largest_speed(&self, balls: Balls) -> Option<Ball> {
        let scale = self.velocity_scale(balls)?;
        match self {
            Self::Described { .. } => {
                Some(balls.mul(&scale, &largest_value(balls, &self.velocity_shape()?)?))
            }
            // max sech tanh = 1/2.
            Self::DoubleWell { .. } => Some(balls.mul_power_of_two(&scale, -1)),
            Self::SoftDuffing { .. } => Some(scale),
            // max 2 s (1 - s^2) = 4/(3 sqrt 3) at s = tanh z = 1/sqrt 3.
            Self::Helmholtz { .. } => over_sqrt_three(balls, &scale, (4, 3)),
            Self::Pendulum { .. } => Some(balls.mul_power_of_two(&scale, 1)),
            Self::PhiSix { .. } => over_sqrt_three(balls, &scale, (2, 3)),
        }
    }

    /// 1 - |v|/V. Without cancellation for the double well, with V = a/sqrt(2b),
    /// (a^2 - 2 b v^2)/(a (a + sqrt(2b) |v|)), and for the pendulum, with V = 2 sqrt(a),
    /// (4 a - v^2)/(V (V + |v|)).
    pub(crate) fn speed_gap(&self, balls: Balls, v: &Exact) -> Option<Ball> {
        let square = |x: &Exact| balls.square(&x.ball(balls));
        let speed = v.abs().ball(balls);
        match self {
            Self::DoubleWell { a, b } => {
                let numerator = match (a.as_rational(), b.as_rational(), v.as_rational()) {
                    (Some(a), Some(b), Some(v)) => {
                        let (a2, bv2) =
                            (Rational::from(a.square_ref()), Rational::from(v.square_ref()) * b);
                        balls.from_rational(&(a2 - bv2 * 2u32))
                    }
                    _ => {
                        let bv2 = balls.mul(&square(v), &b.ball(balls));
                        balls.sub(&square(a), &balls.mul_power_of_two(&bv2, 1))
                    }
                };
                let a = a.ball(balls);
                let root = balls.sqrt(&balls.mul_power_of_two(&b.ball(balls), 1))?;
                let sum = balls.add(&a, &balls.mul(&root, &speed));
                balls.div(&numerator, &balls.mul(&a, &sum))
            }
            Self::Pendulum { a } => {
                let numerator = match (a.as_rational(), v.as_rational()) {
                    (Some(a), Some(v)) => {
                        let four = Rational::from(a * 4u32);
                        balls.from_rational(&(four - Rational::from(v.square_ref())))
                    }
                    _ => balls.sub(&balls.mul_power_of_two(&a.ball(balls), 2), &square(v)),
                };
                let largest = self.largest_speed(balls)?;
                balls.div(&numerator, &balls.mul(&largest, &balls.add(&largest, &speed)))
            }
            _ => {
                let y = balls.div(&speed, &self.largest_speed(balls)?)?;
                Some(balls.sub(&balls.one(), &y))
            }
        }
    }

    /// int v0 sgn(v0 - v) dt on the positive branch: twice the distance travelled faster than v,
    /// minus the whole displacement.
    ///
    /// Double well: 2 sqrt(2a/b) sqrt(1 - |v|/V)_+, the short form of the bracket of (26). The
    /// others: the distance in closed form, potential by potential.
    #[must_use]
    pub fn sign_integral(&self, balls: Balls, v: &Exact) -> Option<Ball> {
        let amplitude = self.amplitude(balls)?;
        if let Self::Described { orbit, .. } = self {
            let level = balls.div(&v.ball(balls), &self.velocity_scale(balls)?)?;
            let value = crossing::sign_integral(balls, &orbit.shape, &level)?;
            return Some(balls.mul(&amplitude, &value));
        }
        let gap = self.speed_gap(balls, v)?;
        if self.is_homoclinic() {
            let fast = match self {
                Self::DoubleWell { .. } => sqrt_positive_part(balls, &gap)?,
                _ => helmholtz_distance(balls, &gap)?,
            };
            return Some(balls.mul_power_of_two(&balls.mul(&amplitude, &fast), 1));
        }
        // The displacement, and the distance faster than v for 0 <= v <= V, in units of X.
        let (whole, fast) = match self {
            Self::SoftDuffing { .. } => {
                let root = sqrt_positive_part(balls, &gap)?;
                (balls.from_i64(2), balls.mul_power_of_two(&root, 1))
            }
            Self::Pendulum { .. } => {
                let angle = arc_cosine_of_gap(balls, &gap)?;
                (balls.mul_power_of_two(&balls.pi(), 1), balls.mul_power_of_two(&angle, 2))
            }
            _ => (balls.one(), phi_six_distance(balls, &gap)?),
        };
        let fast = if v.sign().is_lt() { whole.clone() } else { fast };
        let value = balls.sub(&balls.mul_power_of_two(&fast, 1), &whole);
        Some(balls.mul(&amplitude, &value))
    }
}

/// q scale/sqrt 3.
fn over_sqrt_three(balls: Balls, scale: &Ball, q: (u32, u32)) -> Option<Ball> {
    balls.div(&balls.mul_rational(scale, &Rational::from(q)), &balls.sqrt(&balls.from_i64(3))?)
}

/// acos(1 - g) = 2 atan(sqrt(g/(2 - g))) for g = 1 - |v|/V in [0, 1], 0 for g < 0.
fn arc_cosine_of_gap(balls: Balls, gap: &Ball) -> Option<Ball> {
    let ratio = balls.div(gap, &balls.sub(&balls.from_i64(2), gap))?;
    let angle = balls.atan(&sqrt_positive_part(balls, &ratio)?);
    Some(balls.mul_power_of_two(&angle, 1))
}

/// phi^6: x^3 - x = -y/(3 sqrt 3/2) has the roots x = (2/sqrt 3) cos p, cos 3p = -y; their
/// distance is 2 sin(pi/3 - p) = 2 sin(acos(y)/3).
fn phi_six_distance(balls: Balls, gap: &Ball) -> Option<Ball> {
    let third = balls.div_i64(&arc_cosine_of_gap(balls, gap)?, 3)?;
    Some(balls.mul_power_of_two(&balls.sin(&third), 1))
}

/// Helmholtz: x = X (1 - s^2) with s - s^3 = 2y/(3 sqrt 3). The two roots s = (2/sqrt 3) cos p
/// have cos 3p = -y, so s_b^2 - s_a^2 = (2/3)(cos 2p - cos 2(2pi/3 - p)) =
/// (4/3) sin(2pi/3) sin(2pi/3 - 2p) = (2/sqrt 3) sin(2 acos(y)/3).
fn helmholtz_distance(balls: Balls, gap: &Ball) -> Option<Ball> {
    let angle = balls.mul_rational(&arc_cosine_of_gap(balls, gap)?, &Rational::from((2, 3)));
    over_sqrt_three(balls, &balls.sin(&angle), (2, 1))
}
