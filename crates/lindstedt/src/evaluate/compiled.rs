//! Derived once, evaluated often: the frequency at a million parameters, x(t) at a million times.

use super::code::sampled;
use super::improve::Beside;
use super::{Evaluate, Fourier, PeriodicSolution, Question, SolutionFunction, Trajectory};
use crate::{Answer, DerivationError, Error, Exact, Oscillator, Refused, Remark, Standing, Work};
use lindstedt_equation::AmplitudeRole;
use lindstedt_evaluation::EvaluationError;
use lindstedt_evaluation::compiled::{FrequencyFunction, Varied};
use lindstedt_evaluation::setting::Setting;
use lindstedt_evaluation::{default_order, default_solution_order};
use lindstedt_series::resummation::Estimated;
use rug::Rational;
use std::time::Instant;

/// Four times as many phases are summed, each with many bits.
const MOST_HARMONICS: usize = 100_000;

const AMPLITUDE: &str = "amplitude";

impl Oscillator {
    /// omega as a function of the small parameter, and of the amplitude where a scaling of the equation carries
    /// it: the series of T/2pi derived once, summed in doubles at any number of points, each with its
    /// estimated error. What else there is has its value.
    ///
    /// Of the question the order and the method count; Borel's has no formula and is refused. An error is infinite
    /// where [`Oscillator::evaluate`] would have no digit, too, and a few times its error elsewhere. Cost: the
    /// derivation, a fraction of a second for the errors, then 0.1 to 0.3 microseconds per point and core.
    ///
    /// # Errors
    /// As [`Oscillator::evaluate`]; [`EvaluationError::Resummation`] where no method applies.
    ///
    /// ```
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
    /// let omega = duffing.frequency_function(&Evaluate::default(), &Work::default())?.value;
    /// let list = omega.list(&[0.1, 0.5, 2.0], &[1.0], &Default::default());
    /// // 2 pi/T, T = 4 K(k)/sqrt(1 + rho), k^2 = rho/(2 + 2 rho), rho = eps a^2: mpmath 1.3.0.
    /// assert!((list[1].value - 1.170_781_465_960_041_2).abs() <= list[1].error);
    /// assert_eq!(omega.at(2.0, 0.5), omega.at(0.5, 1.0));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn frequency_function(
        &self,
        question: &Evaluate,
        work: &Work,
    ) -> Result<Answer<FrequencyFunction>, Error> {
        self.refuse_high_powers()?;
        let make = |varied: &Varied<'_>| {
            let order = question.order.unwrap_or_else(|| default_order(&varied.setting.form));
            FrequencyFunction::new(varied, order, question.method, work)
        };
        self.function(make, varying)
    }

    /// x(t) as a function of the small parameter, and of the amplitude where a scaling of the equation carries it: the
    /// series derived once, summed in doubles at any number of points to the harmonics of x in omega t,
    ///
    ///   x = sum_k c_k cos(k omega t) + s_k sin(k omega t),   k = 0, 1, ..., `harmonics`,
    ///
    /// at the phase of [`Oscillator::evaluate`]'s default, each with its estimated error.
    ///
    /// Of the question the order and the method count. Cost: the derivation, about a second for the errors, then some
    /// 3 to 20 microseconds per point and core; [`PeriodicSolution::list`] tells what a time costs.
    ///
    /// # Errors
    /// As [`Oscillator::frequency_function`].
    ///
    /// ```
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
    /// let x = duffing.solution_function(&Evaluate::default(), 15, &Work::default())?.value;
    /// // sqrt(1 + rho) t = u, x = a cn(u, k), k^2 = rho/(2 + 2 rho), rho = eps a^2 = 1: mpmath 1.3.0.
    /// let found = x.at(0.25, 2.0).at(10.0);
    /// assert!((found.value - 1.597_749_537_994_828_7).abs() <= found.error);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn solution_function(
        &self,
        question: &Evaluate,
        harmonics: usize,
        work: &Work,
    ) -> Result<Answer<SolutionFunction>, Error> {
        few_harmonics(harmonics)?;
        self.refuse_high_powers()?;
        let make = |varied: &Varied<'_>| {
            let form = &varied.setting.form;
            let order = question.order.unwrap_or_else(|| default_solution_order(form));
            SolutionFunction::new(varied, (order, harmonics), question.method, work)
        };
        self.function(make, |solution| varying(&solution.frequency))
    }

    /// A function of what varies, with the values of all that does not; it tells the name of the small parameter, whether
    /// the amplitude varies, and the order.
    pub(super) fn function<F>(
        &self,
        make: impl FnOnce(&Varied<'_>) -> Result<F, EvaluationError>,
        varying: impl Fn(&F) -> (String, bool, usize),
    ) -> Result<Answer<F>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        self.check()?;
        let case = self.with_order_parameter();
        let (setting, small, weight) = case.varied()?;
        let varied = Varied { setting: &setting, small, weight };
        let value = make(&varied).map_err(|error| case.unevaluated(error.into()))?;
        let (small, has_amplitude, order) = varying(&value);
        let varies = |name: &str| name == small || has_amplitude && name == AMPLITUDE;
        let at = setting.at.iter().filter(|(name, _)| !varies(name));
        let header = self.header(at.cloned(), Some(order), "resummation", start);
        let remarks = self.remarks().to_vec();
        Ok(Answer { header, value, standing: Standing::Complete, remarks })
    }

    /// The problem with amplitude one where that varies, the parameter that varies as the small one, and the power of the
    /// amplitude beside it.
    fn varied(&self) -> Result<(Setting, String, Option<u32>), Error> {
        let one = |case: Self, name: &str| case.with(name, Exact::Rational(Rational::from(1)));
        let small = self.problem().small.to_string();
        let case = match self.setting() {
            // Its value does not count.
            Err(Error::Derivation(DerivationError::Unset { name, .. })) if name == small => {
                self.clone().with(&small, Exact::Rational(Rational::from((1, 10))))
            }
            _ => self.clone(),
        };
        let has = self.problem().parameters.iter().any(|card| card.name == AMPLITUDE);
        match self.problem().amplitude {
            AmplitudeRole::Scaled if has => {
                let setting = one(case.clone(), AMPLITUDE).setting()?;
                match setting.weight().map_err(EvaluationError::from)? {
                    Some(weight) => Ok((setting, small, Some(weight))),
                    None => Ok((case.setting()?, small, None)),
                }
            }
            AmplitudeRole::InSmallParameter => {
                let setting = one(case.clone(), AMPLITUDE).setting()?;
                match setting.factors().map(|(name, power)| (name.to_owned(), power)) {
                    Some((factor, power)) => Ok((setting, factor, Some(power))),
                    None => Ok((case.setting()?, small, None)),
                }
            }
            AmplitudeRole::ScalesFrequency { .. } => {
                Ok((one(case, AMPLITUDE).setting()?, small, None))
            }
            _ => Ok((case.setting()?, small, None)),
        }
    }

    /// x(t) by its first harmonics in omega t, for any number of times, with its estimated error.
    ///
    /// Taken once from the solution that [`Oscillator::evaluate`] finds for the same question: its series summed
    /// phase by phase, or Newton's orbit in Fourier space. Cost: as for a table of as many times as harmonics for a motion
    /// with both symmetries, four times as many for one without; then some 2 ns per harmonic and time.
    ///
    /// # Errors
    /// As [`Oscillator::solution_code`].
    ///
    /// ```
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::builtin("duffing")?.set("eps", "1/10")?;
    /// let x = duffing.periodic_solution(&Evaluate::default(), 15, &Work::default())?.value;
    /// assert!((x.at(0.0).value - 1.0).abs() <= x.error(0.0) && x.error(0.0) < 1e-12);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn periodic_solution(
        &self,
        question: &Evaluate,
        harmonics: usize,
        work: &Work,
    ) -> Result<Answer<PeriodicSolution>, Error> {
        let start = Instant::now();
        let solved = self.solved(question, harmonics, work)?;
        let (order, at, tier) = (solved.order, solved.at, solved.way.tier());
        let value = match solved.way {
            Way::Newton(fourier, frequency) => PeriodicSolution::new(fourier, frequency, "newton"),
            Way::Sum(path, fourier) => {
                PeriodicSolution::new(fourier, path.estimated_frequency(), "expansion")
            }
        };
        let header = self.header(at, Some(order), tier, start);
        Ok(Answer { header, value, standing: Standing::Complete, remarks: solved.remarks })
    }

    /// The solution of a question by its way.
    pub(super) fn solved(
        &self,
        question: &Evaluate,
        harmonics: usize,
        work: &Work,
    ) -> Result<Solved, Error> {
        few_harmonics(harmonics)?;
        let (case, remarks) = self.settled()?;
        let mut found = case.period(question, work)?;
        let beside = case.beside(&mut found, (question, true), work);
        let by_newton = match &beside {
            Beside::Better(it) => it.fourier(harmonics, &question.phase).zip(Some(it.frequency())),
            _ => None,
        };
        let (way, order) = match by_newton {
            Some((series, frequency)) => (Way::Newton(series, frequency), found.order),
            None => {
                let make = |asked: Question<'_>| Trajectory::without_error(asked, work);
                let path = case.path(&found, question, make)?;
                let sum = sampled(&path, harmonics, &work.stop)?;
                let sum = match &beside {
                    Beside::Truth(orbit) => orbit.measured(sum, &question.phase),
                    _ => sum,
                };
                let order = path.order();
                (Way::Sum(Box::new(path), sum), order)
            }
        };
        Ok(Solved { at: found.at, order, way, remarks })
    }
}

/// What varies, and the order.
fn varying(frequency: &FrequencyFunction) -> (String, bool, usize) {
    (frequency.small.clone(), frequency.has_amplitude, frequency.order)
}

/// Refuses more harmonics than are ever summed.
pub(super) fn few_harmonics(harmonics: usize) -> Result<(), Error> {
    if harmonics <= MOST_HARMONICS {
        return Ok(());
    }
    let message = format!("{harmonics} harmonics are too many: at most {MOST_HARMONICS} are taken");
    Err(Refused::usage("range", message, "fewer harmonics").into())
}

/// A solution that harmonics can be taken of.
pub(super) struct Solved {
    /// The values that enter.
    pub at: Vec<(String, Exact)>,
    /// The order of the expansion.
    pub order: usize,
    /// How it was found.
    pub way: Way,
    /// What was noticed.
    pub remarks: Vec<Remark>,
}

/// How a solution was found.
pub(super) enum Way {
    /// By Newton's method in Fourier space: harmonics and frequency.
    Newton(Fourier, Estimated),
    /// By the sum of its series at every phase, and its harmonics.
    Sum(Box<Trajectory>, Fourier),
}

impl Way {
    /// How its numbers were computed.
    pub fn tier(&self) -> &'static str {
        match self {
            Self::Newton(..) => "newton",
            Self::Sum(..) => "resummation",
        }
    }
}
