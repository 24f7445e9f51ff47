//! The value of a parameter for which an orbit of an autonomous problem persists, to first order: the zero of
//! D = D_0 + mu D_1, the work of the perturbation along the unperturbed orbit.

use crate::bound::{bind, missing, multiply_out, rest};
use crate::melnikov::MelnikovProblem;
use crate::reading::Unperturbed;
use crate::refusal::{Refusal, Why};
use crate::threshold::OrbitValue;
use lindstedt_algebra::Stop;
use lindstedt_equation::monomials::{Monomial, Monomials};
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::{Class, MelnikovError, Verdict};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use std::collections::BTreeMap;

/// x'' = f(x) + eps (g_0(x, x') + mu g_1(x, x')) with an orbit of x'' = f(x) between saddles.
///
/// ```
/// use lindstedt_number::{Exact, ball::Balls, digits::decimal};
/// use lindstedt_problem_file::ProblemFile;
/// use lindstedt_recognise::PersistenceProblem;
///
/// // A pendulum under a torque rotates, however slowly, from 4 delta/pi on.
/// let file = ProblemFile::parse("equation = \"x'' + sin(x) = eps*(torque - x'/5)\"")?;
/// let found = PersistenceProblem::new(&file.problem, &Default::default(), "torque")?;
/// let upper = &found.orbits(Balls::new(100))?[0];
/// assert_eq!((upper.name, decimal(&upper.value.parameter, 12)), ("upper orbit", Some("0.254647908947".into())));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PersistenceProblem {
    /// With g_0 alone.
    known: MelnikovProblem,
    /// With g_1 alone, on the same orbit.
    factor: MelnikovProblem,
}

/// On one orbit, in x.
#[derive(Clone, Debug)]
pub struct Persistent {
    /// mu = -D_0/D_1.
    pub parameter: Ball,
    /// D_0 and D_1, the work that the perturbation takes from the motion.
    pub work: [Ball; 2],
}

impl PersistenceProblem {
    /// Reads the equation with the values of its parameters, but for the one that is sought.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit: a periodic force, or a term that is not linear in the unknown.
    pub fn new(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        unknown: &str,
    ) -> Result<Self, Refusal> {
        let mut values = values.clone();
        values.insert(unknown.to_owned(), Exact::from(1));
        let rest = rest(problem)?;
        missing(&rest.parameters(), &values)?;
        values.remove(unknown);
        let all = multiply_out(&bind(&rest, &values))?;
        for (m, q) in &all.terms {
            place(&all, m, unknown).map_err(|why| {
                let term = Box::new(all.tree(m, q));
                Refusal::Term { term, why }
            })?;
        }
        values.insert(unknown.to_owned(), Exact::from(1));
        let read = |sought: bool, closed: bool| {
            let part = part(problem, &all, |m| m.parameters.contains_key(unknown) == sought);
            MelnikovProblem::autonomous(&part, &values, closed)
        };
        let mut found = Self { known: read(false, true)?, factor: read(true, true)? };
        let is_closed = |p: &MelnikovProblem| matches!(p.unperturbed, Unperturbed::Closed { .. });
        match (is_closed(&found.known), is_closed(&found.factor)) {
            (true, false) => found.known = read(false, false)?,
            (false, true) => found.factor = read(true, false)?,
            _ => {}
        }
        Ok(found)
    }

    /// The same problem, whose numeric orbits end undecided when asked to stop.
    #[must_use]
    pub fn watched(self, stop: &Stop) -> Self {
        Self { known: self.known.watched(stop), ..self }
    }

    /// Of g_0 and g_1 the one whose theory ends first: at jumps of friction that are met at the saddle, or tangentially.
    #[must_use]
    pub fn roughest(&self, balls: Balls, eps: f64) -> &MelnikovProblem {
        let roughness = |problem: &MelnikovProblem| match problem.verdict(balls, eps) {
            _ if !problem.jumps() => i32::from(problem.bends()),
            Some(Verdict::Holds) => 2,
            Some(Verdict::Doubtful) => 3,
            _ => 4,
        };
        let [known, factor] = [&self.known, &self.factor];
        if roughness(factor) > roughness(known) { factor } else { known }
    }

    /// The unperturbed oscillator.
    #[must_use]
    pub fn unperturbed(&self) -> &Unperturbed {
        &self.known.unperturbed
    }

    /// How the numbers are known.
    #[must_use]
    pub fn class(&self) -> Class {
        let is_estimated = |problem: &MelnikovProblem| problem.class() == Class::Estimated;
        if is_estimated(&self.known) || is_estimated(&self.factor) {
            Class::Estimated
        } else {
            Class::Certified
        }
    }

    /// The parameter on every orbit: right loop before left, upper before lower.
    ///
    /// # Errors
    /// [`MelnikovError::UnknownWithoutWork`], [`MelnikovError::Undecided`], or those of a quadrature.
    pub fn orbits(&self, balls: Balls) -> Result<Vec<OrbitValue<Persistent>>, MelnikovError> {
        let list = self.known.dissipations(balls, &self.factor.perturbation)?;
        let one = |orbit: OrbitValue<[Ball; 2]>| {
            let [known, factor] = orbit.value;
            // An estimate that is not told from zero is one.
            let estimated = self.class() == Class::Estimated;
            if factor.contains_zero() && (estimated || factor.is_exact()) {
                return Err(MelnikovError::UnknownWithoutWork);
            }
            let quotient = balls.div(&balls.neg(&known), &factor);
            let parameter = quotient.ok_or(MelnikovError::Undecided { bits: balls.bits() })?;
            let value = Persistent { parameter, work: [known, factor] };
            Ok(OrbitValue { name: orbit.name, saddle: orbit.saddle, value })
        };
        list.into_iter().map(one).collect()
    }
}

/// The problem with the terms of order zero and those of the perturbation that are `wanted`.
fn part(problem: &Problem, all: &Monomials, wanted: impl Fn(&Monomial) -> bool) -> Problem {
    let terms = all.terms.iter().filter(|(m, _)| m.order == 0 || wanted(m));
    let terms = terms.map(|(m, q)| all.tree(m, q));
    let mut part = problem.clone();
    part.equation = Expression::Sum(terms.chain([Expression::ACCELERATION]).collect()).canonical();
    part.time_domain = None;
    part
}

/// The unknown is a factor of terms of the perturbation, and stands nowhere else. What is of higher order in the small
/// parameter is refused where the parts are read: Melnikov's integral is the coefficient of the first one.
fn place(all: &Monomials, m: &Monomial, unknown: &str) -> Result<(), Why> {
    let symbol = Expression::parameter(unknown);
    let inside = |key: &String| all.atoms.get(key).is_some_and(|e| e.contains(&symbol));
    let hidden = m.atoms.keys().any(inside) || m.parameters.keys().any(inside);
    match m.parameters.get(unknown) {
        None | Some(1) if hidden => Err(Why::NotLinearUnknown),
        Some(1) if m.order == 0 => Err(Why::NotSmall),
        None | Some(1) => Ok(()),
        Some(_) => Err(Why::NotLinearUnknown),
    }
}
