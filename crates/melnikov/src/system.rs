//! The Melnikov driver: potential, friction, forcing, belt speed -> M(t0), D, F, gamma_c.

use crate::dissipation::{polynomial_dissipation, quadrature_dissipation};
use crate::forcing::ForcingWork;
use crate::hyperbolic::HyperbolicRing;
use crate::{Branch, Forcing, Friction, MelnikovError, Potential};
use lindstedt_algebra::Ring;
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Float;

/// How a number is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The radius of the ball is proved.
    Certified,
    /// The radius is an estimate (a quadrature without proof).
    Estimated,
}

/// x'' = f(x) + eps (gamma * forcing - T(x' - v*)), with the orbit of the potential.
///
/// ```
/// use lindstedt_melnikov::{Branch, Forcing, Friction, PolynomialFriction, Potential, System};
/// use lindstedt_number::Exact;
/// use lindstedt_number::{ball::Balls, digits::decimal};
///
/// // The paper's point: a = b = 1, alpha = beta = T0 = 0.3, omega = 2, v* = 0.4.
/// let coefficient = || Exact::from((3, 10));
/// let law = PolynomialFriction::paper(coefficient(), &coefficient(), coefficient());
/// let system = System::new(
///     Potential::DoubleWell { a: Exact::from(1), b: Exact::from(1) },
///     Friction::Polynomial(law),
///     Forcing::single(Exact::from(2)),
///     Exact::from((2, 5)),
/// )?;
/// let threshold = system.threshold(Balls::new(160), Branch::Positive)?;
/// assert_eq!(decimal(&threshold.gamma, 20).as_deref(), Some("0.63707134284816358297"));
/// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    potential: Potential,
    friction: Friction,
    forcing: Forcing,
    belt_speed: Exact,
}

/// The threshold on one branch, for gamma > 0: simple zeros of M exist if and only if
/// gamma > `gamma` (|gamma| F > |D|, see `docs/src/melnikov.md`).
#[derive(Clone, Debug)]
pub struct Threshold {
    /// gamma_c >= 0.
    pub gamma: Ball,
    /// D/F: negative where the orbit gains energy from the belt.
    pub signed: Ball,
    /// D, the work of friction along the orbit.
    pub dissipation: Ball,
    /// F > 0: max of the forcing work for D > 0, -min for D < 0.
    pub forcing: Ball,
    /// The class of D, and so of all.
    pub class: Class,
}

/// What the perturbation theory needs: |v*| and | |v*| - V | large against eps.
///
/// At v* = 0 the saddle lies on the switching line and becomes a stick segment; at |v*| = V the
/// orbit touches the switching line. Elsewhere the orbit crosses it transversally and the formula
/// holds to O(eps). Without dry friction (and kinks) there is no condition.
#[derive(Clone, Debug)]
pub struct Validity {
    /// |v*|.
    pub belt_speed: Ball,
    /// | |v*| - V |.
    pub tangency_distance: Ball,
    /// Whether the friction law jumps at w = 0.
    pub dry: bool,
}

/// The verdict for one eps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Both distances exceed 10 eps (the factor is a convention).
    Holds,
    /// A distance lies between 0 and 10 eps: the O(eps) correction need not be small.
    Doubtful,
    /// A distance is 0, or not decided: outside the theory for every eps.
    Fails,
}

impl Validity {
    /// The verdict for the given eps > 0 (anything else is read as the limit eps -> 0).
    #[must_use]
    pub fn verdict(&self, eps: f64) -> Verdict {
        if !self.dry {
            return Verdict::Holds;
        }
        let margin = self.belt_speed.abs_lower().min(&self.tangency_distance.abs_lower());
        if margin.is_zero() {
            Verdict::Fails
        } else if eps > 0.0 && margin.to_f64() <= 10.0 * eps {
            Verdict::Doubtful
        } else {
            Verdict::Holds
        }
    }
}

impl System {
    /// Checks parameters and the orbit.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`], [`MelnikovError::WrongOrbit`],
    /// [`MelnikovError::DegreeTooLarge`] or [`MelnikovError::NotFinite`].
    pub fn new(
        potential: Potential,
        friction: Friction,
        forcing: Forcing,
        belt_speed: Exact,
    ) -> Result<Self, MelnikovError> {
        potential.check()?;
        friction.check()?;
        forcing.check()?;
        Ok(Self { potential, friction, forcing, belt_speed })
    }
    /// The potential.
    #[must_use]
    pub fn potential(&self) -> &Potential {
        &self.potential
    }

    /// D on a branch. Certified for polynomial friction, estimated by quadrature otherwise.
    ///
    /// # Errors
    /// [`MelnikovError::NoMirrorImage`], [`MelnikovError::Undecided`], or those of the quadrature.
    pub fn dissipation(
        &self,
        balls: Balls,
        branch: Branch,
    ) -> Result<(Ball, Class), MelnikovError> {
        self.check_branch(branch)?;
        let undecided = MelnikovError::Undecided { bits: balls.bits() };
        if let Friction::Polynomial(law) = &self.friction {
            let d = polynomial_dissipation(balls, &self.potential, law, branch, &self.belt_speed);
            return Ok((d.ok_or(undecided)?, Class::Certified));
        }
        let bits = balls.bits();
        let d = quadrature_dissipation(
            bits,
            &self.potential,
            &self.friction,
            branch,
            &self.belt_speed,
        )?;
        Ok((balls.from_parts(&d.value, &d.error), Class::Estimated))
    }

    /// M(t0) = gamma F(omega t0) - D at one t0 (not for incommensurate forcing).
    ///
    /// # Errors
    /// Those of [`System::dissipation`]; [`MelnikovError::NoClosedForm`] for a forcing
    /// without a single frequency.
    pub fn melnikov(
        &self,
        balls: Balls,
        branch: Branch,
        gamma: &Exact,
        t0: &Exact,
    ) -> Result<(Ball, Class), MelnikovError> {
        let (d, class) = self.dissipation(balls, branch)?;
        let omega = match &self.forcing {
            Forcing::Harmonics { omega, .. } | Forcing::Parametric { omega } => omega,
            Forcing::Incommensurate(_) => return Err(MelnikovError::NoClosedForm),
        };
        let work = self.work(balls, branch)?;
        let theta = balls.mul(&omega.ball(balls), &t0.ball(balls));
        let forced = balls.mul(&gamma.ball(balls), &work.derivative(balls, &theta, 0));
        Ok((balls.sub(&forced, &d), class))
    }

    /// F(theta), the work of the forcing at unit gamma.
    ///
    /// # Errors
    /// [`MelnikovError::NoClosedForm`] where the forcing has no such form,
    /// [`MelnikovError::Undecided`] where its size leaves the range of the exponents.
    pub fn work(&self, balls: Balls, branch: Branch) -> Result<ForcingWork, MelnikovError> {
        self.check_branch(branch)?;
        let closed = match &self.forcing {
            Forcing::Harmonics { .. } => true,
            Forcing::Parametric { .. } => self.potential.description().is_some_and(|orbit| {
                let ring = HyperbolicRing;
                ring.mul(&orbit.shape, &ring.derivative(&orbit.shape)).decays()
            }),
            Forcing::Incommensurate(_) => false,
        };
        if !closed {
            return Err(MelnikovError::NoClosedForm);
        }
        ForcingWork::new(balls, &self.potential, branch, &self.forcing)
            .ok_or(MelnikovError::Undecided { bits: balls.bits() })
    }

    /// (max F, -min F).
    fn reach(&self, balls: Balls, branch: Branch) -> Result<(Ball, Ball), MelnikovError> {
        let undecided = MelnikovError::Undecided { bits: balls.bits() };
        if let Forcing::Incommensurate(terms) = &self.forcing {
            let mut sum = balls.zero();
            for (omega, weight) in terms {
                let transform = self.potential.velocity_transform(balls, &omega.ball(balls));
                let (c, s) = transform.ok_or(undecided.clone())?;
                let square = balls.add(&balls.square(&c), &balls.square(&s));
                let size = balls.sqrt(&square).ok_or(undecided.clone())?;
                sum = balls.add(&sum, &balls.mul(&size, &weight.abs().ball(balls)));
            }
            return Ok((sum.clone(), sum));
        }
        let work = self.work(balls, branch)?;
        let largest = work.extreme(balls, false).ok_or(undecided.clone())?;
        let smallest = work.extreme(balls, true).ok_or(undecided)?;
        Ok((largest, balls.neg(&smallest)))
    }

    /// The threshold of simple zeros of M on a branch.
    ///
    /// # Errors
    /// Those of [`System::dissipation`]; [`MelnikovError::NoForcing`];
    /// [`MelnikovError::Undecided`] where the sign of D decides which extreme counts and is not
    /// decided.
    pub fn threshold(&self, balls: Balls, branch: Branch) -> Result<Threshold, MelnikovError> {
        let undecided = MelnikovError::Undecided { bits: balls.bits() };
        let (dissipation, class) = self.dissipation(balls, branch)?;
        let (up, down) = self.reach(balls, branch)?;
        let forcing = if dissipation.is_negative() {
            down
        } else if dissipation.is_positive() {
            up
        } else if up.overlaps(&down) {
            balls.hull(&up, &down)
        } else {
            return Err(undecided);
        };
        if forcing.is_exact() && forcing.contains_zero() {
            return Err(MelnikovError::NoForcing);
        }
        let signed = balls.div(&dissipation, &forcing).ok_or(undecided)?;
        Ok(Threshold { gamma: balls.abs(&signed), signed, dissipation, forcing, class })
    }

    /// The distances on which the validity depends.
    #[must_use]
    pub fn validity(&self, balls: Balls) -> Option<Validity> {
        let belt_speed = self.belt_speed.abs().ball(balls);
        // V (1 - |v*|/V) keeps its digits near the tangency.
        let gap = self.potential.speed_gap(balls, &self.belt_speed)?;
        let distance = balls.mul(&self.potential.largest_speed(balls)?, &gap);
        let dry = match &self.friction {
            Friction::Polynomial(law) => law.dry.sign().is_ne(),
            other => !other.kinks().is_empty(),
        };
        Some(Validity { belt_speed, tangency_distance: balls.abs(&distance), dry })
    }

    fn check_branch(&self, branch: Branch) -> Result<(), MelnikovError> {
        if branch == Branch::Negative && !self.potential.has_mirror_image() {
            return Err(MelnikovError::NoMirrorImage);
        }
        Ok(())
    }
}

/// The midpoint of a ball as f64 with the radius.
#[must_use]
pub fn midpoint_and_radius(ball: &Ball) -> (f64, f64) {
    let radius: &Float = ball.radius();
    (ball.midpoint().to_f64(), radius.to_f64())
}
