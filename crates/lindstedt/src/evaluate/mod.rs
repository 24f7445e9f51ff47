//! The question `evaluate`: period and frequency at given parameters, by resummation of the
//! series of T/2pi, beside the closed form where there is one; x(t) at given times.

pub mod averaged;
mod code;
mod compiled;
mod functions;
mod improve;
mod one_phase;
mod prove;
mod sweep;
mod times;
pub(crate) mod turn;
mod wanted;

use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Answer, Error, Exact, Kind, Oscillator, Refusal, Remark, Standing, Work};
pub use code::{Language, SolutionCode};
use compiled::Way;
pub use functions::ExpansionCode;
use improve::Beside;
use lindstedt_equation::monomials::{Terms, add, expand};
use lindstedt_equation::{Condition, Expression};
use lindstedt_evaluation::setting::Setting;
pub use lindstedt_evaluation::{
    Displacement, Displacements, Evaluation, Fourier, Improved, PeriodicSolution, Place, Question,
    SolutionFunction, Trajectory, compiled::FrequencyFunction, kind_name, method_name, rounded,
    with_error,
};
pub(crate) use lindstedt_evaluation::{period, setting, source};
use lindstedt_problem_file::parse_equation;
pub use lindstedt_series::resummation::Estimated;
use lindstedt_series::resummation::Method;
pub use one_phase::{Belt, FirstOrder, FirstOrderCycle, StickingBegins};
pub use prove::{
    Between, Bounds, EndOfBranch, Expansion, ProvedBranch, ProvedFamily, ProvedMember, ProvedOrbit,
    ProvedState, UnknownOrbit, UnknownState, Verdict as ProofVerdict,
};
use rug::Rational;
use rug::ops::Pow;
use std::time::Instant;
pub use sweep::{EvaluationSweep, RatesSweep, Swept, SweptPeriod, SweptPoint, SweptRates};
pub use times::Times;

/// What to evaluate.
///
/// ```
/// use lindstedt::{Error, Evaluate, Oscillator, Work};
/// let question = Evaluate { order: Some(24), method: "pade".parse().ok(), ..Evaluate::default() };
/// let duffing = Oscillator::builtin("duffing")?.set("eps", "1/2")?;
/// let found = duffing.evaluate(&question, &Work::default())?.value;
/// let period = found.period.ok_or(Error::NoValue)?;
/// assert!(period.decimal.starts_with("5.366659355191767"));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Evaluate {
    /// The highest order of the expansion; a quick one if nothing.
    pub order: Option<usize>,
    /// The method; nothing is `auto`, the one with the least error estimate.
    pub method: Option<Method>,
    /// The times at which x is asked for.
    pub times: Option<Times>,
    /// x(t) = X(omega t + phase), X(0) at rest.
    pub phase: Exact,
}

/// Powers of the small parameter from which they are put in.
const HIGH_POWER: u32 = 3;

impl Default for Evaluate {
    /// A quick order, the best method, no times, phase 0.
    fn default() -> Self {
        let phase = Exact::Rational(Rational::new());
        Self { order: None, method: None, times: None, phase }
    }
}

impl Oscillator {
    /// The period, 2 pi over it, and with times the solution x(t).
    ///
    /// The series of T/2pi in the small parameter is summed; which quantity is truncated matters, and
    /// it is always this one. Where neither order nor method is asked for and the sum has fewer digits than
    /// were, Newton's method in Fourier space goes on from it, and that is said ([`Improved`]). `period` and `frequency` are estimated; `exact_period` is certified, and
    /// there for x'' + k x (x^2)^delta, x'' + k x + c eps x^3 and the pendulum with a given amplitude.
    /// A small parameter that only counts orders is 1; x(0) of a file is its amplitude.
    ///
    /// Undecided where not one digit of the period is supported, or nothing is known of its error; stopped work leaves the times that
    /// were reached.
    ///
    /// # Errors
    /// [`EvaluationError::NotEvaluated`](crate::EvaluationError::NotEvaluated) for a problem without a periodic solution that is expanded (no
    /// condition, a free amplitude, a wall); [`DerivationError::Unset`](crate::DerivationError::Unset) where the small parameter or another one
    /// has no value; [`DerivationError::OutsideDomain`](crate::DerivationError::OutsideDomain) and [`DerivationError::UnknownParameter`](crate::DerivationError::UnknownParameter) for parameters,
    /// [`EvaluationError::Resummation`](crate::EvaluationError::Resummation) where the method asked for does not apply, and what
    /// [`Oscillator::derive`] returns.
    ///
    /// ```
    /// use lindstedt::{Error, Evaluate, Oscillator, Work};
    /// let cubic = Oscillator::builtin("power-law")?;
    /// let found = cubic.evaluate(&Evaluate::default(), &Work::default())?.value;
    /// let exact = found.exact_period.ok_or(Error::NoValue)?;
    /// assert_eq!(exact.decimal, "7.41629870920548767373540138878");
    /// let period = found.period.ok_or(Error::NoValue)?;
    /// assert!(period.decimal.starts_with("7.41629870920548"));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn evaluate(&self, question: &Evaluate, work: &Work) -> Result<Answer<Evaluation>, Error> {
        let start = Instant::now();
        let (case, mut remarks) = self.settled()?;
        let mut value = case.period(question, work)?;
        value.find_stability(work);
        let mut standing = Standing::Complete;
        let beside = case.beside(&mut value, (question, question.times.is_some()), work);
        if matches!(beside, Beside::Stopped) {
            let stopped = "stopped before Newton's method had the orbit: the series alone";
            remarks.push(Remark(stopped.to_owned()));
            standing = Standing::Stopped { done: 0 };
        }
        if let Some(times) = &question.times {
            let truth = match &beside {
                Beside::Truth(orbit) => Some(|time: &Exact| orbit.at(time, &question.phase)),
                _ => None,
            };
            let found = match &beside {
                Beside::Better(found) => {
                    let last = value.best_period.midpoint().to_f64();
                    found.table(&value, &times.list(last), &question.phase, work)
                }
                _ => {
                    let path = case.trajectory(&value, question, work)?;
                    path.table(&times.list(path.period), truth.as_ref(), work)
                }
            };
            if !found.complete {
                let stopped = "stopped; the times not reached are missing";
                remarks.push(Remark(stopped.to_owned()));
                standing = Standing::Stopped { done: found.points.len() };
            }
            value.solution = Some(found);
        }
        if standing == Standing::Complete && value.period.is_none() {
            let none = "the expansion gives not one digit of the period here";
            remarks.push(Remark(none.to_owned()));
            standing = Standing::Undecided;
        }
        if standing == Standing::Complete && value.is_without_estimate() {
            let none = "nothing is known of the error: too few coefficients, and no closed form; \
                        a higher --order, or --prove";
            remarks.push(Remark(none.to_owned()));
            standing = Standing::Undecided;
        }
        let header = self.header(value.at.clone(), Some(value.order), "resummation", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// The solution as a function in a language: its harmonics in omega t, in doubles.
    ///
    /// # Errors
    /// As [`Oscillator::evaluate`]; [`Refused`] where the expansion has no value at some phase.
    ///
    /// ```
    /// use lindstedt::evaluate::Language;
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::builtin("duffing")?.set("eps", "1/10")?;
    /// let question = Evaluate { order: Some(6), ..Evaluate::default() };
    /// let code = duffing.solution_code(&question, Language::Python, 3, &Work::default())?;
    /// assert!(code.value.code.contains("def displacement(t):"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn solution_code(
        &self,
        question: &Evaluate,
        language: Language,
        harmonics: usize,
        work: &Work,
    ) -> Result<Answer<SolutionCode>, Error> {
        let start = Instant::now();
        let solved = self.solved(question, harmonics, work)?;
        let (order, at, name) = (solved.order, solved.at, &self.problem().name);
        let tier = solved.way.tier();
        let value = match solved.way {
            Way::Newton(series, omega) => {
                SolutionCode::by_newton(name, (series, omega.value), language)
            }
            Way::Sum(path, fourier) => SolutionCode::new(name, &path, fourier, language),
        };
        let header = self.header(at, Some(order), tier, start);
        Ok(Answer { header, value, standing: Standing::Complete, remarks: solved.remarks })
    }

    /// x(t) of a period that [`Oscillator::evaluate`] found for the same question; a period without a
    /// digit has none.
    ///
    /// # Errors
    /// [`Refused`], those of [`Oscillator::evaluate`].
    pub fn trajectory(
        &self,
        found: &Evaluation,
        question: &Evaluate,
        work: &Work,
    ) -> Result<Trajectory, Error> {
        let make = |asked: Question<'_>| Trajectory::new(asked, work);
        self.path(found, question, make)
    }

    /// The same made by a function.
    fn path(
        &self,
        found: &Evaluation,
        question: &Evaluate,
        make: impl FnOnce(Question<'_>) -> Result<Trajectory, lindstedt_evaluation::EvaluationError>,
    ) -> Result<Trajectory, Error> {
        let summed = found.improved.as_ref().map_or(&found.period, |improved| &improved.sum);
        if summed.is_none() && found.exact_period.is_none() {
            return Err(Refused::undecided(
                "no-value",
                "the period has not one digit at these parameters, so x(t) has none",
                "a higher --order, another --resum, or `lindstedt simulate`",
            )
            .into());
        }
        let in_doubles = question.times.as_ref().is_none_or(|times| times.range.is_none());
        let (setting, order, phase) = (self.setting()?, question.order, &question.phase);
        let asked = Question { setting, order, phase, evaluation: found, in_doubles };
        make(asked).map_err(|error| self.unevaluated(error.into()))
    }

    /// The period of a settled case.
    fn period(&self, question: &Evaluate, work: &Work) -> Result<Evaluation, Error> {
        let setting = self.setting().map_err(|error| self.unevaluated(error))?;
        self.period_of(setting, question, work)
    }

    /// The period of a setting of the case.
    fn period_of(
        &self,
        setting: Setting,
        question: &Evaluate,
        work: &Work,
    ) -> Result<Evaluation, Error> {
        let found = period(&setting, question.order, question.method, work);
        found.map_err(|error| self.unevaluated(error.into()))
    }

    /// The case as [`Oscillator::placed`] has it; refuses what cannot be expanded exactly.
    pub(crate) fn settled(&self) -> Result<(Self, Vec<Remark>), Error> {
        self.without_pi()?;
        self.check()?;
        let (case, mut remarks) = self.placed()?;
        let (case, remark) = case.with_powers_put_in()?;
        remarks.extend(remark);
        Ok((case, remarks))
    }

    /// The case with a value for a parameter that only counts orders, and with the amplitude that the
    /// initial data of its file mean.
    pub(crate) fn placed(&self) -> Result<(Self, Vec<Remark>), Error> {
        let case = self.with_order_parameter();
        let mut remarks = self.remarks().to_vec();
        let initial = self.problem_file().initial.as_ref();
        let Some([x, velocity]) =
            initial.filter(|_| self.condition() == Some(Condition::InitialAmplitude))
        else {
            return Ok((case, remarks));
        };
        let set = self.given().contains_key("amplitude");
        let taken =
            if set { Taken::Amplitude } else { Taken::Initial("--set amplitude=AMPLITUDE") };
        remarks.extend(case.start_remark(taken));
        if set {
            return Ok((case, remarks));
        }
        let rests = Exact::parse(velocity)?.as_rational().is_some_and(Rational::is_zero);
        if !rests || !self.problem().parameters.iter().any(|card| card.name == "amplitude") {
            return Err(Refused::no_answer(
                "initial-data",
                "the expansion starts at rest: x(0) = amplitude, x'(0) = 0",
                "--set amplitude=A and --phase PHASE, or change [initial] of the file",
            )
            .into());
        }
        Ok((case.with("amplitude", Exact::parse(x)?), remarks))
    }

    /// Where the small parameter only counts orders it is 1, unless it is set: a table of orders put it
    /// into the equation of a file, or it is no parameter of an averaged motion between impacts.
    pub(crate) fn with_order_parameter(&self) -> Self {
        let (problem, file) = (self.problem(), self.problem_file());
        let written = parse_equation(&file.equation, &file.names);
        let flight =
            problem.impact.is_some() && problem.conditions.contains(&Condition::FreeAmplitude);
        let counts = flight || written.is_ok_and(|tree| !tree.contains(&Expression::Small));
        let listed = problem.parameters.iter().any(|card| card.name == problem.small);
        if !counts || listed || self.given().contains_key(&*problem.small) {
            return self.clone();
        }
        self.clone().with(&problem.small, Exact::Rational(Rational::from(1)))
    }

    /// The highest power of the small parameter in the equation multiplied out, where it is so high that a series to some
    /// order has few terms in which it enters.
    ///
    /// # Errors
    /// [`Refused`] where it has too many terms to tell.
    pub(crate) fn high_power(&self) -> Result<Option<u32>, Error> {
        let equation = &self.problem().equation;
        match expand(equation) {
            Some(all) => {
                let orders = all.terms.into_keys().map(|m| m.order);
                Ok(orders.max().filter(|power| *power >= HIGH_POWER))
            }
            None if !equation.contains(&Expression::Small) => Ok(None),
            None => {
                let message = "multiplied out the equation has too many terms to see its powers of the small parameter";
                let hint = "`evaluate --prove`, `lindstedt simulate`";
                Err(Refused::no_answer("high-power", message, hint).into())
            }
        }
    }

    /// The same equation at this value q of the small parameter, with eps q^(k-1) for high powers eps^k: the estimates of
    /// a series know nothing of a term that enters it once or twice, or not at all.
    pub(crate) fn with_powers_put_in(self) -> Result<(Self, Option<Remark>), Error> {
        let problem = self.problem();
        let small = problem.small.clone();
        let (Some(power), Some(value)) = (self.high_power()?, self.given().get(&*small)) else {
            return Ok((self, None));
        };
        let Some(value) = value.as_rational().cloned() else {
            let message =
                format!("a series in {small} has {small}^{power} too seldom to tell its error");
            let hint = "a rational value; `evaluate --prove`, `lindstedt simulate`";
            return Err(Refused::no_answer("high-power", message, hint).into());
        };
        if value.is_zero() {
            return Ok((self, None));
        }
        let Some(mut all) = expand(&problem.equation) else { return Ok((self, None)) };
        let mut terms = Terms::new();
        for (mut monomial, mut q) in std::mem::take(&mut all.terms) {
            if monomial.order >= HIGH_POWER {
                q *= value.clone().pow(monomial.order - 1);
                monomial.order = 1;
            }
            add(&mut terms, monomial, &q);
        }
        let terms = terms.iter().map(|(monomial, q)| all.tree(monomial, q)).collect();
        let equation = Expression::Sum(terms).canonical();
        let remark = format!(
            "{small}^{power} stands as {small} times a number, its value here: a series in {small} would have it too seldom to \
             tell its error"
        );
        Ok((self.with_equation(equation), Some(Remark(remark))))
    }

    /// Refuses functions of the small parameter whose series could not tell their error.
    pub(crate) fn refuse_high_powers(&self) -> Result<(), Error> {
        let Some(power) = self.high_power()? else { return Ok(()) };
        let small = &self.problem().small;
        let message =
            format!("a series in {small} has {small}^{power} too seldom to tell its error");
        let hint = format!("`lindstedt evaluate` at values of {small}, or --sweep");
        Err(Refused::no_answer("high-power", message, hint).into())
    }

    /// The problem with a value for everything.
    pub(crate) fn setting(&self) -> Result<Setting, Error> {
        Ok(Setting::new(self.problem(), self.asked_condition(), self.given())?)
    }

    /// A refusal with its place; of stopped work in words.
    pub(crate) fn unevaluated(&self, error: Error) -> Error {
        if error.kind() == Kind::Stopped {
            let message = "stopped before the expansion was finished";
            return Refused::stopped(message, "raise --limit-seconds or lower --order").into();
        }
        self.refusal(error)
    }
}
