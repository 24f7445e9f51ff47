//! The Melnikov driver: potential, friction, forcing, belt speed -> M(t0), D, F, gamma_c.

use crate::dissipation::{damping_work, polynomial_dissipation, quadrature_dissipation};
use crate::forcing::ForcingWork;
use crate::{Branch, Damping, Forcing, Friction, Harmonic, MelnikovError, Potential};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};

/// How a number is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The radius of the ball is proved.
    Certified,
    /// The radius is an estimate (a quadrature without proof).
    Estimated,
}

/// x'' = f(x) + eps (gamma * forcing - T(x' - v*) - sum c g(x) x'^j), with the orbit of the potential.
///
/// ```
/// use lindstedt_melnikov::{Branch, Forcing, Friction, PolynomialFriction, Potential, System};
/// use lindstedt_number::Exact;
/// use lindstedt_number::{ball::Balls, digits::decimal};
///
/// // a = b = 1, alpha = beta = T0 = 0.3, omega = 2, v* = 0.4.
/// let coefficient = || Exact::from((3, 10));
/// let law = PolynomialFriction::cubic(coefficient(), &coefficient(), coefficient());
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
    damping: Vec<Damping>,
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
        Ok(Self { potential, friction, damping: Vec::new(), forcing, belt_speed })
    }

    /// The same with more friction, that depends on x.
    ///
    /// # Errors
    /// [`MelnikovError::DegreeTooLarge`].
    pub fn damped(self, damping: Vec<Damping>) -> Result<Self, MelnikovError> {
        damping.iter().try_for_each(Damping::check)?;
        Ok(Self { damping, ..self })
    }

    /// The potential.
    #[must_use]
    pub fn potential(&self) -> &Potential {
        &self.potential
    }
    /// T.
    #[must_use]
    pub fn friction(&self) -> &Friction {
        &self.friction
    }
    /// The terms c g(x) x'^j.
    #[must_use]
    pub fn damping(&self) -> &[Damping] {
        &self.damping
    }
    /// The forcing.
    #[must_use]
    pub fn forcing(&self) -> &Forcing {
        &self.forcing
    }
    /// v*.
    #[must_use]
    pub fn belt_speed(&self) -> &Exact {
        &self.belt_speed
    }

    /// D on a branch. Certified for polynomial friction, estimated by quadrature otherwise.
    ///
    /// # Errors
    /// [`MelnikovError::NoMirrorImage`], [`MelnikovError::NoClosedForm`] for friction that depends on x in a
    /// way that the orbit does not take, [`MelnikovError::Undecided`], or those of the quadrature.
    pub fn dissipation(
        &self,
        balls: Balls,
        branch: Branch,
    ) -> Result<(Ball, Class), MelnikovError> {
        self.check_branch(branch)?;
        let bits = balls.bits();
        let undecided = || MelnikovError::Undecided { bits };
        let (potential, belt) = (&self.potential, &self.belt_speed);
        if !self.damping.iter().all(|term| potential.takes_damping(&term.factor)) {
            return Err(MelnikovError::NoClosedForm);
        }
        let along = damping_work(balls, potential, &self.damping, branch).ok_or_else(undecided)?;
        let (law, class) = if let Friction::Polynomial(law) = &self.friction {
            let d = polynomial_dissipation(balls, potential, law, branch, belt);
            (d.ok_or_else(undecided)?, Class::Certified)
        } else {
            let d = quadrature_dissipation(bits, potential, &self.friction, branch, belt)?;
            (balls.from_parts(&d.value, &d.error), Class::Estimated)
        };
        Ok((balls.add(&law, &along), class))
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
        let Forcing::Harmonics { omega, .. } = &self.forcing else {
            return Err(MelnikovError::NoClosedForm);
        };
        let work = self.work(balls, branch)?;
        let theta = balls.mul(&omega.ball(balls), &t0.ball(balls));
        let forced = balls.mul(&gamma.ball(balls), &work.derivative(balls, &theta, 0));
        Ok((balls.sub(&forced, &d), class))
    }

    /// F(theta), the work of the forcing at unit gamma.
    ///
    /// # Errors
    /// [`MelnikovError::NoClosedForm`] for incommensurate frequencies and for a factor that the
    /// orbit does not take ([`Potential::takes_force`]), [`MelnikovError::Undecided`] where its size
    /// leaves the range of the exponents.
    pub fn work(&self, balls: Balls, branch: Branch) -> Result<ForcingWork, MelnikovError> {
        match &self.forcing {
            Forcing::Harmonics { omega, harmonics } => {
                self.work_of(balls, branch, (omega, harmonics))
            }
            Forcing::Incommensurate(_) => Err(MelnikovError::NoClosedForm),
        }
    }

    fn work_of(
        &self,
        balls: Balls,
        branch: Branch,
        part: (&Exact, &[Harmonic]),
    ) -> Result<ForcingWork, MelnikovError> {
        self.check_branch(branch)?;
        if !part.1.iter().all(|harmonic| self.potential.takes_force(&harmonic.factor)) {
            return Err(MelnikovError::NoClosedForm);
        }
        ForcingWork::new(balls, &self.potential, branch, part)
            .ok_or(MelnikovError::Undecided { bits: balls.bits() })
    }

    /// (max F, -min F).
    fn reach(&self, balls: Balls, branch: Branch) -> Result<(Ball, Ball), MelnikovError> {
        self.forcing.reach(balls, &|part| self.work_of(balls, branch, part))
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
