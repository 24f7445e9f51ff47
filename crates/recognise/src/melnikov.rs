//! x'' = f(x) + eps (gamma g(x) cos(omega t) - T(x' - v*) - sum c g(x) x'^j) in the form of its terms.

use crate::bound::multiply_out;
use crate::forces::{Term, forcing, silent_frequency};
use crate::lowest::{common, forces};
use crate::reading::{Terms, Unperturbed};
use crate::refusal::{Refusal, Why};
use crate::threshold::{OrbitValue, Perturbation};
use lindstedt_algebra::Stop;
use lindstedt_equation::Problem;
use lindstedt_melnikov::{
    Axis, Branch, Class, Forcing, Friction, MelnikovError, Potential, StickSlip, System, Threshold,
    Verdict,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::collections::BTreeMap;

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
/// let gamma = &pendulum.thresholds(Balls::new(120))?[0].value.gamma;
/// // 4 delta cosh(pi omega/2)/pi
/// assert_eq!(decimal(gamma, 12).as_deref(), Some("3.19478526383"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MelnikovProblem {
    /// x'' = f(x).
    pub unperturbed: Unperturbed,
    /// The rest, in y.
    pub perturbation: Perturbation,
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
        let terms = Terms::read(problem, values)?;
        if let Some((term, _)) = terms.forces.first() {
            let forces: Vec<Term> = terms.forces.iter().map(|(_, force)| force.clone()).collect();
            let refusal = |why| Refusal::Term { term: Box::new(term.clone()), why };
            let (forcing, amplitude) = forcing(&forces).map_err(refusal)?;
            return Self::on_orbit(&terms, forcing, amplitude, true);
        }
        let amplitude = || Exact::from(0);
        let found = Self::on_orbit(&terms, Forcing::none(), amplitude(), true);
        let all = multiply_out(&terms.rest)?;
        let silent = forces(&all, values).unwrap_or_default();
        if silent.is_empty() {
            return Err(match found {
                Err(Refusal::NoOrbit) => Refusal::NoOrbit,
                _ => Refusal::NoForce,
            });
        }
        // In the proportions that they have with another value of a parameter of which all are multiples.
        let is_zero = |name: &String| values.get(name).is_some_and(|value| value.sign().is_eq());
        let name = common(&all, &silent).into_iter().find(is_zero);
        match (name, silent.as_slice()) {
            (Some(name), _) => {
                let mut values = values.clone();
                values.insert(name, Exact::Rational(Rational::from(1)));
                Ok(Self { amplitude: amplitude(), ..Self::new(problem, &values)? })
            }
            (None, [only]) if only.is_plain() => {
                let omega = silent_frequency(&terms.bound).ok_or(Refusal::NoForce)?;
                let (found, forcing) = (found?, Forcing::single(omega));
                Ok(Self { perturbation: Perturbation { forcing, ..found.perturbation }, ..found })
            }
            _ => Err(Refusal::SilentForces),
        }
    }

    /// Reads the equation of a problem without a periodic force; `closed`: on an orbit in closed form, if there is one.
    pub(crate) fn autonomous(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        closed: bool,
    ) -> Result<Self, Refusal> {
        let terms = Terms::read(problem, values)?;
        match terms.forces.first() {
            Some((term, _)) => {
                Err(Refusal::Term { term: Box::new(term.clone()), why: Why::Periodic })
            }
            None => Self::on_orbit(&terms, Forcing::none(), Exact::from(0), closed),
        }
    }

    fn on_orbit(
        terms: &Terms,
        forcing: Forcing,
        amplitude: Exact,
        closed: bool,
    ) -> Result<Self, Refusal> {
        let (unperturbed, perturbation, jumps) = terms.on_orbit(forcing, closed)?;
        let found = Self { unperturbed, perturbation, amplitude, jumps };
        found.system()?;
        Ok(found)
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

    /// The system of y; nothing for a numeric orbit.
    ///
    /// # Errors
    /// Those of [`System::new`].
    pub fn system(&self) -> Result<Option<System>, MelnikovError> {
        self.system_with(&self.perturbation)
    }

    fn system_with(&self, other: &Perturbation) -> Result<Option<System>, MelnikovError> {
        let Unperturbed::Closed { potential, .. } = &self.unperturbed else { return Ok(None) };
        let Perturbation { friction, damping, forcing, belt_speed } = other.clone();
        System::new(potential.clone(), friction, forcing, belt_speed)?.damped(damping).map(Some)
    }

    /// The oscillator of section 3, where the problem is one: everything about it in closed form.
    #[must_use]
    pub fn stick_slip(&self) -> Option<StickSlip> {
        StickSlip::of(&self.system().ok()??)
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
        Axis::ALL.into_iter().find(renamed)
    }

    /// |s|.
    fn size(&self) -> Rational {
        match &self.unperturbed {
            Unperturbed::Closed { scale, .. } => Rational::from(scale.abs_ref()),
            Unperturbed::Numeric(_) => Rational::from(1),
        }
    }

    /// Something of the orbits in closed form: right loop before left, upper before lower.
    fn on_branches<T>(
        &self,
        potential: &Potential,
        value: &dyn Fn(&System, Branch) -> Result<T, MelnikovError>,
    ) -> Result<Vec<OrbitValue<T>>, MelnikovError> {
        let Some(system) = self.system()? else { return Ok(Vec::new()) };
        let mut names = if potential.is_homoclinic() {
            ["right loop", "left loop"]
        } else {
            ["upper orbit", "lower orbit"]
        };
        let turned = matches!(&self.unperturbed, Unperturbed::Closed { scale, .. } if *scale < 0);
        if turned {
            names.reverse();
        }
        let mut found = Vec::new();
        for (branch, name) in [Branch::Positive, Branch::Negative].into_iter().zip(names) {
            if branch == Branch::Positive || potential.has_mirror_image() {
                found.push(OrbitValue { name, saddle: None, value: value(&system, branch)? });
            }
        }
        if turned {
            found.reverse();
        }
        Ok(found)
    }

    /// The thresholds on the orbits, in x: right loop before left, upper before lower.
    ///
    /// # Errors
    /// Those of [`System::threshold`].
    pub fn thresholds(&self, balls: Balls) -> Result<Vec<OrbitValue<Threshold>>, MelnikovError> {
        match &self.unperturbed {
            Unperturbed::Closed { potential, .. } => self
                .on_branches(potential, &|system, branch| {
                    Ok(self.in_x(balls, system.threshold(balls, branch)?))
                }),
            Unperturbed::Numeric(orbit) => orbit.thresholds(balls, &self.perturbation),
        }
    }

    /// D of this perturbation and of another one on the orbits, in x, in the same order.
    ///
    /// # Errors
    /// Those of [`System::dissipation`].
    pub(crate) fn dissipations(
        &self,
        balls: Balls,
        other: &Perturbation,
    ) -> Result<Vec<OrbitValue<[Ball; 2]>>, MelnikovError> {
        let both = [&self.perturbation, other];
        let Unperturbed::Closed { potential, .. } = &self.unperturbed else {
            let Unperturbed::Numeric(orbit) = &self.unperturbed else { return Ok(Vec::new()) };
            return orbit.dissipations(balls, both);
        };
        let Some(beside) = self.system_with(other)? else { return Ok(Vec::new()) };
        let square = Rational::from(self.size().square_ref());
        self.on_branches(potential, &|system, branch| {
            let of = |system: &System| -> Result<Ball, MelnikovError> {
                Ok(balls.mul_rational(&system.dissipation(balls, branch)?.0, &square))
            };
            Ok([of(system)?, of(&beside)?])
        })
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
        let speed = self.perturbation.belt_speed.abs().ball(balls);
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
        let is_smooth = match &self.perturbation.friction {
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
        match (&self.unperturbed, &self.perturbation.friction) {
            (Unperturbed::Closed { .. }, Friction::Polynomial(_)) => Class::Certified,
            _ => Class::Estimated,
        }
    }
}
