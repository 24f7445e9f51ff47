//! x'' = f(x) + eps (gamma cos(omega t) - T(x' - v*)) in the form of its terms.

use crate::bound::{bind, missing, multiply_out, named, rest};
use crate::forces::{Kind, Term, forcing, kind, silent_frequency};
use crate::in_pi::InPi;
use crate::law::FrictionLaw;
use crate::lowest::{common, forces};
use crate::numeric::NumericOrbit;
use crate::potential;
use crate::refusal::{Refusal, Why};
use crate::threshold::OrbitThreshold;
use lindstedt_algebra::Stop;
use lindstedt_equation::monomials::{Monomial, Monomials};
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::{
    Axis, Branch, Class, Forcing, Friction, MelnikovError, Potential, StickSlip, System, Threshold,
    Verdict,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::collections::BTreeMap;

/// The unperturbed oscillator.
#[derive(Clone, Debug)]
pub enum Unperturbed {
    /// One with a closed orbit, in y with x = s y + constant.
    Closed {
        /// y'' = ...
        potential: Potential,
        /// s, not 0.
        scale: Rational,
    },
    /// Any other smooth force, followed numerically.
    Numeric(Box<NumericOrbit>),
}

impl Unperturbed {
    /// With s of x = s y + constant.
    fn of(force: &Monomials) -> Result<(Self, Rational), Refusal> {
        if let Some((potential, scale)) = potential::closed(force) {
            return Ok((Self::Closed { potential, scale: scale.clone() }, scale));
        }
        Ok((Self::Numeric(Box::new(NumericOrbit::find(force)?)), Rational::from(1)))
    }
}

/// A problem in the form that Melnikov's method takes.
///
/// ```
/// use lindstedt_number::{Exact, ball::Balls, digits::decimal};
/// use lindstedt_problem_file::ProblemFile;
/// use lindstedt_recognise::MelnikovProblem;
///
/// let file = ProblemFile::parse(
///     r#"
///     name = "pendulum"
///     equation = "x'' + sin x = eps (gamma cos(omega t) - delta x')"
///     condition = []
///     [parameters]
///     gamma = {}
///     omega = {}
///     delta = {}
///     "#,
/// )?;
/// let values = ["gamma", "omega", "delta"].map(|name| (name.to_owned(), Exact::from(1)));
/// let pendulum = MelnikovProblem::new(&file.problem, &values.into())?;
/// let gamma = &pendulum.thresholds(Balls::new(120))?[0].threshold.gamma;
/// // 4 delta cosh(pi omega/2)/pi
/// assert_eq!(decimal(gamma, 12).as_deref(), Some("3.19478526383"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MelnikovProblem {
    /// x'' = f(x).
    pub unperturbed: Unperturbed,
    /// T in y.
    pub friction: Friction,
    /// The force at unit amplitude of its lowest harmonic.
    pub forcing: Forcing,
    /// v* in y.
    pub belt_speed: Exact,
    /// gamma as it stands in the equation for x: the whole coefficient of the lowest harmonic, the
    /// others being in proportion to it.
    pub amplitude: Exact,
    /// Whether friction jumps.
    jumps: bool,
}

impl MelnikovProblem {
    /// Reads the equation of a problem with the values of its parameters.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit.
    pub fn new(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Self, Refusal> {
        if problem.impact.is_some() {
            return Err(Refusal::Wall);
        }
        let rest = rest(problem)?;
        missing(&rest.parameters(), values)?;
        let bound = bind(&rest, values);
        let all = multiply_out(&bound)?;
        let refuse = |m: &Monomial, q: &Rational, why| {
            named(&rest, values, (all.tree(m, q), why), &|all, m| kind(all, m).err())
        };
        let (mut force, mut friction) = (Monomials::default(), Monomials::default());
        (force.atoms, friction.atoms) = (all.atoms.clone(), all.atoms.clone());
        let mut harmonics = Vec::new();
        for (m, q) in &all.terms {
            match kind(&all, m).map_err(|why| refuse(m, q, why))? {
                Kind::Force => {
                    force.terms.insert(m.clone(), Rational::from(-q));
                }
                Kind::Friction => {
                    friction.terms.insert(m.clone(), q.clone());
                }
                Kind::Harmonic => {
                    let found = Term::new(&all, m, &Rational::from(-q));
                    harmonics.push((m, q, found.ok_or_else(|| refuse(m, q, Why::Irrational))?));
                }
            }
        }
        let mut terms: Vec<Term> = harmonics.iter().map(|(.., term)| term.clone()).collect();
        terms.sort_by(|a, b| a.omega.to_f64().total_cmp(&b.omega.to_f64()));
        let force_refusal = |why| match harmonics.first() {
            Some((m, q, _)) => Refusal::Term { term: Box::new(all.tree(m, q)), why },
            None => Refusal::NoForce,
        };
        let (forcing, amplitude) = match terms.as_slice() {
            [] => {
                if let Some(several) = Self::silent(problem, &rest, values)? {
                    return Ok(several);
                }
                (Forcing::single(silent_frequency(&bound).ok_or(Refusal::NoForce)?), Exact::from(0))
            }
            list => forcing(list).map_err(force_refusal)?,
        };
        let off = |e: &Expression| matches!(e, Expression::Time).then(|| Expression::integer(0));
        let law = FrictionLaw::new(&bound.substitute(&off), &friction)?;
        let (unperturbed, scale) = Unperturbed::of(&force)?;
        let jumps = law.jumps();
        let (friction, belt_speed) = law.scaled(&scale);
        let found = Self { unperturbed, friction, forcing, belt_speed, amplitude, jumps };
        if matches!(found.forcing, Forcing::Parametric { .. }) && !found.takes_parametric(&force) {
            return Err(force_refusal(Why::Parametric));
        }
        if let Some(system) = found.system()? {
            system.potential().check()?;
        }
        Ok(found)
    }

    /// Several forces that all vanish: in the proportions that they have with another value of a
    /// parameter of which all are multiples.
    fn silent(
        problem: &Problem,
        rest: &Expression,
        values: &BTreeMap<String, Exact>,
    ) -> Result<Option<Self>, Refusal> {
        let all = multiply_out(rest)?;
        let forces = forces(&all, values).unwrap_or_default();
        if forces.len() < 2 {
            return Ok(None);
        }
        let is_zero = |name: &String| values.get(name).is_some_and(|value| value.sign().is_eq());
        let name = common(&all, &forces).into_iter().find(is_zero);
        let mut values = values.clone();
        values.insert(name.ok_or(Refusal::SilentForces)?, Exact::Rational(Rational::from(1)));
        Ok(Some(Self { amplitude: Exact::from(0), ..Self::new(problem, &values)? }))
    }

    /// The same problem, whose numeric orbits end undecided when asked to stop.
    #[must_use]
    pub fn watched(self, stop: &Stop) -> Self {
        let unperturbed = match self.unperturbed {
            Unperturbed::Numeric(orbit) => Unperturbed::Numeric(Box::new(orbit.watched(stop))),
            closed @ Unperturbed::Closed { .. } => closed,
        };
        Self { unperturbed, ..self }
    }

    /// x cos(omega t) is y cos(omega t) only without a shift, and known on polynomial orbits.
    fn takes_parametric(&self, force: &Monomials) -> bool {
        let Some(f) = potential::polynomial(force) else { return false };
        let zero = |k: usize| f.get(k).is_none_or(InPi::is_zero);
        let still = zero(0)
            && match &self.unperturbed {
                // The saddle at x = 0.
                Unperturbed::Closed { potential: Potential::Helmholtz { .. }, .. } => {
                    let slope = f.get(1).and_then(InPi::value);
                    slope.is_some_and(|f1| f1.sign().is_gt())
                }
                _ => zero(2),
            };
        let closed = matches!(&self.unperturbed,
            Unperturbed::Closed { potential, .. } if potential.description().is_some());
        closed && still
    }

    /// The system of y; nothing for a numeric orbit.
    ///
    /// # Errors
    /// Those of [`System::new`].
    pub fn system(&self) -> Result<Option<System>, MelnikovError> {
        let Unperturbed::Closed { potential, .. } = &self.unperturbed else { return Ok(None) };
        let (friction, forcing) = (self.friction.clone(), self.forcing.clone());
        System::new(potential.clone(), friction, forcing, self.belt_speed.clone()).map(Some)
    }

    /// The oscillator of section 3, where the problem is one: everything about it in closed form.
    #[must_use]
    pub fn stick_slip(&self) -> Option<StickSlip> {
        let Unperturbed::Closed { potential: Potential::DoubleWell { a, b }, .. } =
            &self.unperturbed
        else {
            return None;
        };
        let Friction::Polynomial(law) = &self.friction else { return None };
        let Forcing::Harmonics { omega, harmonics } = &self.forcing else { return None };
        let [only] = harmonics.as_slice() else { return None };
        let t = |k: usize| law.coefficients.get(k).cloned().unwrap_or_else(|| Exact::from(0));
        let rest = (0..law.coefficients.len()).filter(|k| *k != 1 && *k != 3);
        if only.order != 1 || rest.into_iter().any(|k| t(k).sign().is_ne()) {
            return None;
        }
        Some(StickSlip {
            a: a.clone(),
            b: b.clone(),
            dry: law.dry.clone(),
            alpha: -&t(1),
            beta: t(3),
            omega: omega.clone(),
            belt_speed: self.belt_speed.clone(),
        })
    }

    /// Which parameter of section 3 the parameter `name` of the problem is: changed, at three more
    /// values, it must change that one into itself and nothing else.
    #[must_use]
    pub fn axis(
        &self,
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        name: &str,
    ) -> Option<Axis> {
        let point = self.stick_slip()?;
        let known = values.get(name)?.clone();
        let probes = [(1009, 733), (2003, 1511), (389, 617)].map(Rational::from);
        let renamed = |axis: &Axis| {
            point.clone().with(*axis, known.clone()) == point
                && probes.iter().all(|q| {
                    let mut values = values.clone();
                    values.insert(name.to_owned(), Exact::Rational(q.clone()));
                    let found = Self::new(problem, &values).ok().and_then(|f| f.stick_slip());
                    found == Some(point.clone().with(*axis, Exact::Rational(q.clone())))
                })
        };
        let all =
            [Axis::A, Axis::B, Axis::Dry, Axis::Alpha, Axis::Beta, Axis::Omega, Axis::BeltSpeed];
        all.into_iter().find(renamed)
    }

    /// |s|.
    fn size(&self) -> Rational {
        match &self.unperturbed {
            Unperturbed::Closed { scale, .. } => Rational::from(scale.abs_ref()),
            Unperturbed::Numeric(_) => Rational::from(1),
        }
    }

    /// The thresholds on the orbits, in x: right loop before left, upper before lower.
    ///
    /// # Errors
    /// Those of [`System::threshold`].
    pub fn thresholds(&self, balls: Balls) -> Result<Vec<OrbitThreshold>, MelnikovError> {
        let Unperturbed::Closed { potential, scale } = &self.unperturbed else {
            return self.numeric_thresholds(balls);
        };
        let Some(system) = self.system()? else { return Ok(Vec::new()) };
        let mut names = if potential.is_homoclinic() {
            ["right loop", "left loop"]
        } else {
            ["upper orbit", "lower orbit"]
        };
        if *scale < 0 {
            names.reverse();
        }
        let mut found = Vec::new();
        for (branch, name) in [Branch::Positive, Branch::Negative].into_iter().zip(names) {
            if branch == Branch::Negative && !potential.has_mirror_image() {
                continue;
            }
            let threshold = self.in_x(balls, system.threshold(balls, branch)?);
            found.push(OrbitThreshold { name, saddle: None, threshold });
        }
        if *scale < 0 {
            found.reverse();
        }
        Ok(found)
    }

    fn numeric_thresholds(&self, balls: Balls) -> Result<Vec<OrbitThreshold>, MelnikovError> {
        let Unperturbed::Numeric(orbit) = &self.unperturbed else { return Ok(Vec::new()) };
        orbit.thresholds(balls, &self.friction, &self.forcing, &self.belt_speed)
    }

    /// x = s y: D_x = s^2 D_y, F_x = |s| F_y.
    fn in_x(&self, balls: Balls, threshold: Threshold) -> Threshold {
        let size = self.size();
        let by = |ball: &Ball| balls.mul_rational(ball, &size);
        Threshold {
            gamma: by(&threshold.gamma),
            signed: by(&threshold.signed),
            dissipation: by(&by(&threshold.dissipation)),
            forcing: by(&threshold.forcing),
            class: threshold.class,
        }
    }

    /// V, the largest speed on the orbit, in x.
    #[must_use]
    pub fn largest_speed(&self, balls: Balls) -> Option<Ball> {
        match &self.unperturbed {
            Unperturbed::Closed { potential, .. } => {
                Some(balls.mul_rational(&potential.largest_speed(balls)?, &self.size()))
            }
            Unperturbed::Numeric(orbit) => orbit.largest_speed(balls),
        }
    }

    /// (|v*|, ||v*| - V|, whether friction jumps), in x.
    #[must_use]
    pub fn distances(&self, balls: Balls) -> Option<(Ball, Ball, bool)> {
        let by = |ball: &Ball| balls.mul_rational(ball, &self.size());
        if let Ok(Some(system)) = self.system() {
            let validity = system.validity(balls)?;
            return Some((by(&validity.belt_speed), by(&validity.tangency_distance), self.jumps));
        }
        let speed = self.belt_speed.abs().ball(balls);
        let distance = balls.abs(&balls.sub(&self.largest_speed(balls)?, &speed));
        Some((speed, distance, self.jumps))
    }

    /// Whether friction jumps at v*, or may have no bounded slope there.
    #[must_use]
    pub fn jumps(&self) -> bool {
        self.jumps
    }

    /// Whether the slope of friction jumps at v*, but friction does not.
    #[must_use]
    pub fn bends(&self) -> bool {
        let is_smooth = match &self.friction {
            Friction::Polynomial(_) => true,
            other => other.kinks().is_empty(),
        };
        !self.jumps && !is_smooth
    }

    /// The verdict on the theory for this eps, as of [`lindstedt_melnikov::Validity`].
    #[must_use]
    pub fn verdict(&self, balls: Balls, eps: f64) -> Option<Verdict> {
        let (belt_speed, tangency_distance, dry) = self.distances(balls)?;
        let validity = lindstedt_melnikov::Validity { belt_speed, tangency_distance, dry };
        Some(validity.verdict(eps))
    }

    /// How the numbers are known.
    #[must_use]
    pub fn class(&self) -> Class {
        match (&self.unperturbed, &self.friction) {
            (Unperturbed::Closed { .. }, Friction::Polynomial(_)) => Class::Certified,
            _ => Class::Estimated,
        }
    }
}
