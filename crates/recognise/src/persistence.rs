//! The value of a parameter for which an orbit of an autonomous problem persists, to first order: the zero of
//! D = D_0 + mu D_1, the work of the perturbation along the unperturbed orbit.

use crate::bound::{bind, multiply_out, rest};
use crate::melnikov::MelnikovProblem;
use crate::reading::Unperturbed;
use crate::refusal::{Refusal, Why};
use crate::threshold::OrbitValue;
use lindstedt_algebra::Stop;
use lindstedt_equation::monomials::{Monomial, Monomials};
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::{Class, MelnikovError};
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
    /// At mu = 1.
    with: MelnikovProblem,
    /// At mu = 0, on the same orbit.
    without: MelnikovProblem,
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
        values.remove(unknown);
        let all = multiply_out(&bind(&rest(problem)?, &values))?;
        let bad = all.terms.iter().find(|(m, _)| !is_linear(&all, m, unknown));
        if let Some((m, q)) = bad {
            let term = Box::new(all.tree(m, q));
            return Err(Refusal::Term { term, why: Why::NotLinearUnknown });
        }
        let mut at = |value: i32, closed: bool| {
            values.insert(unknown.to_owned(), Exact::from(value));
            MelnikovProblem::autonomous(problem, &values, closed)
        };
        let with = at(1, true)?;
        let without = at(0, matches!(with.unperturbed, Unperturbed::Closed { .. }))?;
        Ok(Self { with, without })
    }

    /// The same problem, whose numeric orbits end undecided when asked to stop.
    #[must_use]
    pub fn watched(self, stop: &Stop) -> Self {
        Self { with: self.with.watched(stop), ..self }
    }

    /// The unperturbed oscillator.
    #[must_use]
    pub fn unperturbed(&self) -> &Unperturbed {
        &self.with.unperturbed
    }

    /// How the numbers are known.
    #[must_use]
    pub fn class(&self) -> Class {
        let is_estimated = |problem: &MelnikovProblem| problem.class() == Class::Estimated;
        if is_estimated(&self.with) || is_estimated(&self.without) {
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
        let list = self.with.dissipations(balls, &self.without.perturbation)?;
        let one = |orbit: OrbitValue<[Ball; 2]>| {
            let [with, without] = orbit.value;
            let by_unknown = balls.sub(&with, &without);
            // An estimate that is not told from zero is one.
            let estimated = self.class() == Class::Estimated;
            if by_unknown.contains_zero() && (estimated || by_unknown.is_exact()) {
                return Err(MelnikovError::UnknownWithoutWork);
            }
            let quotient = balls.div(&balls.neg(&without), &by_unknown);
            let parameter = quotient.ok_or(MelnikovError::Undecided { bits: balls.bits() })?;
            let value = Persistent { parameter, work: [without, by_unknown] };
            Ok(OrbitValue { name: orbit.name, saddle: orbit.saddle, value })
        };
        list.into_iter().map(one).collect()
    }
}

/// Whether a term has the unknown as a factor of a first-order term, or not at all.
fn is_linear(all: &Monomials, m: &Monomial, unknown: &str) -> bool {
    let symbol = Expression::parameter(unknown);
    let inside = |key: &String| all.atoms.get(key).is_some_and(|e| e.contains(&symbol));
    let hidden = m.atoms.keys().any(inside) || m.parameters.keys().any(inside);
    match m.parameters.get(unknown) {
        None => !hidden,
        Some(1) => !hidden && m.order == 1,
        Some(_) => false,
    }
}
