//! The question `derive`: exact, averaged, or in estimated numbers.

use crate::averaging::Averaging;
use crate::convergence;
use crate::numeric::{Estimate, Tier};
use crate::refusal::Refused;
use crate::start::Taken;
use crate::{
    Answer, Derivation, Error, Exact, Oscillator, Progress, Quantity, Remark, Route, Solution,
    Standing, Work,
};
use lindstedt_algebra::PhaseError;
use lindstedt_derivation::averaging::{self, AveragingSettings};
use lindstedt_derivation::{DerivationError, Settings, check_delays, numeric};
use lindstedt_equation::classify::{Method, Reason};
use lindstedt_equation::description::Description;
use lindstedt_equation::{AmplitudeRole, Condition, Expression};
use lindstedt_expand::ExpandError;
use lindstedt_impact::divergence;
use lindstedt_problem_file::PI;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What to derive.
///
/// ```
/// use lindstedt::{Derive, Oscillator, Quantity, Route, Work};
/// let question = Derive { order: 12, route: Route::EnergyIntegral };
/// let law = Oscillator::builtin("power-law")?.derive(question, &Work::default())?.value;
/// assert!(law.number(Quantity::Frequency, 1, 10)?.decimal.starts_with("-0.19314718"));
/// assert_eq!((law.order, law.checked_orders), (12, None)); // no solution to substitute
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Derive {
    /// The highest order.
    pub order: usize,
    /// How the series are derived.
    pub route: Route,
}

impl From<usize> for Derive {
    fn from(order: usize) -> Self {
        Self { order, route: Route::default() }
    }
}

/// An averaged expansion, the values that were put in, and what is to be said of them.
type PolarForm = (Averaging, BTreeMap<String, Exact>, Option<Remark>);

impl Oscillator {
    /// The expansion of omega^2, omega and T/2 pi in the small parameter and of x_0, x_1, ... as
    /// functions of the phase tau = omega t, up to an order, substituted back into the equation.
    ///
    /// The amplitude is what the condition fixes; values of parameters are put in, and those without
    /// one refuse. Exact: rational numbers or polynomials in named constants, printed beside
    /// `work.digits` digits. Cost over Q: O(N^3) per prime, and primes that grow a little faster than N; in
    /// the Lobachevsky ring O(1) per term by the clock, a factor of about 1.8 per order by the driver.
    ///
    /// Stopped work leaves the orders that are finished ([`Standing::Stopped`]); over Q, where all are
    /// finished together, it is refused.
    ///
    /// # Errors
    /// [`Error`] with the reason: nothing is ever dropped or approximated silently.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Quantity, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?.derive(3, &Work::default())?.value;
    /// assert_eq!(duffing.exact(Quantity::Frequency, 2).as_deref(), Some("-21/256"));
    /// assert_eq!(duffing.checked_orders, Some(3));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn derive(
        &self,
        question: impl Into<Derive>,
        work: &Work,
    ) -> Result<Answer<Derivation>, Error> {
        let (start, question) = (Instant::now(), question.into());
        self.without_pi()?;
        self.check()?;
        let settings = Settings { route: question.route, ..self.settings(question.order, work) };
        let primes = AtomicUsize::new(0);
        let found = lindstedt_derivation::derive(self.problem(), &settings, &mut |progress| {
            if let Progress::Primes(n) = progress {
                primes.store(n, Ordering::Relaxed);
            }
            work.goes_on(progress)
        });
        let primes = primes.into_inner();
        let value = found.map_err(|error| self.unfinished(error.into(), primes))?;
        let mut value = value.with_numbers(work.printed_digits())?;
        value.description = self.describe().ok();
        let mut remarks = self.remarks().to_vec();
        if value.condition == Condition::InitialAmplitude {
            remarks.extend(self.start_remark(Taken::Amplitude));
        }
        let solved = !matches!(value.solution, Solution::FrequencyOnly { .. });
        remarks.extend(self.missing(&|asked| {
            value.named(asked).is_some() || asked == Quantity::Solution && solved
        }));
        let unchecked = solved && value.checked_orders.is_none();
        let done = value.order < question.order || unchecked;
        let standing = self.standing(done, value.order, !unchecked, &mut remarks);
        let at = self.entering(&value);
        remarks.extend(self.idle(|name| at.iter().any(|(known, _)| known == name)));
        let header = self.header(at, Some(value.order), "exact", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// The same series in estimated numbers: forces that no exact ring takes, and high orders of those
    /// whose exact solution has millions of terms.
    ///
    /// # Errors
    /// As [`lindstedt_derivation::numeric::derive`].
    ///
    /// ```
    /// use lindstedt::{Error, Oscillator, Quantity, Work, numeric::Tier};
    /// let force = Oscillator::parse("x'' + x + eps*sin(x) = 0")?;
    /// let found = force.estimate(1, Tier::Collocation { digits: 12 }, &Work::default())?.value;
    /// let period = found.named(Quantity::Period).ok_or(Error::NoValue)?;
    /// // -J_1(1), by another route.
    /// let first = period.number(1, 12).ok_or(Error::NoValue)?;
    /// assert!(first.decimal.starts_with("-0.44005058574"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn estimate(
        &self,
        order: usize,
        tier: Tier,
        work: &Work,
    ) -> Result<Answer<Estimate>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        self.check_numeric()?;
        let settings = self.settings(order, work);
        let mut observer = |done: &lindstedt_expand::OrderWork| {
            work.goes_on(Progress::Order(done.order, done.terms))
        };
        let found = numeric::derive(self.problem(), &settings, tier, &mut observer);
        let value = found.map_err(|error| match error {
            DerivationError::Expand(ExpandError::Interrupted { .. }) => Refused::stopped(
                "stopped before two grids were finished",
                "raise --limit-seconds or lower --order or --digits",
            )
            .into(),
            error => self.refusal(error.into()),
        })?;
        let value = value.with_numbers(work.printed_digits(), &self.problem().small);
        let tier = value.tier.name();
        let entering = self.entering_coefficients();
        let header = self.header(&entering, Some(value.order), tier, start);
        let mut remarks = self.remarks().to_vec();
        remarks.extend(self.idle(|name| entering.contains_key(name)));
        Ok(Answer { header, value, standing: Standing::Complete, remarks })
    }

    /// The averaged equations of Krylov, Bogoliubov and Mitropolsky,
    ///
    ///   x = a cos psi + ..., da/dt = sum eps^n A_n(a), dpsi/dt = sum eps^n B_n(a), B_0 = omega_0,
    ///
    /// up to an order. Parameters that are not set stay symbols; where no formula in them exists (a
    /// frequency without a root, a response without an inverse), the values of the problem file are taken, and
    /// that is said. Exact, or certified where values are
    /// irrational; the residual vanishes or encloses zero.
    ///
    /// # Errors
    /// [`Error`] with the reason; resonances are named.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// let cycle = Oscillator::parse("x'' + x = eps*(1 - x^2)*x'")?;
    /// let averaged = cycle.average(2, &Work::default())?;
    /// assert_eq!(averaged.value.amplitude_rate[1].len(), 2); // a/2 - a^3/8
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn average(&self, order: usize, work: &Work) -> Result<Answer<Averaging>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        let free = self.clone().under(Condition::FreeAmplitude)?;
        let values = self.all_values().into_iter().collect();
        check_delays(&self.problem().equation, &values)?;
        free.check()?;
        let (mut value, at, taken) = free.polar(order, work)?;
        // A_n(a)/a, B_n(a) and x.
        let had = [Quantity::GrowthRate, Quantity::Frequency, Quantity::Solution];
        let mut remarks = self.remarks().to_vec();
        remarks.extend(taken);
        remarks.extend(self.idle(|name| at.contains_key(name)));
        remarks.extend(self.missing(&|asked| had.contains(&asked)));
        value.convergence = convergence::of(&value, &at);
        value.description = free.describe().ok();
        let diverges = value.convergence.as_ref().filter(|found| found.diverges());
        remarks.extend(diverges.map(divergence).map(Remark));
        let orders = (order, value.order, value.checked_orders == value.order);
        let tier = if value.exact { "exact" } else { "certified" };
        Ok(self.finished(at, orders, tier, remarks, start).map(|()| value))
    }

    /// The averaged expansion, the values that were put in, and what is to be said of them.
    fn polar(&self, order: usize, work: &Work) -> Result<PolarForm, Error> {
        let average = |parameters: &BTreeMap<String, Exact>| {
            let settings = AveragingSettings {
                order,
                parameters: parameters.clone(),
                digits: work.printed_digits(),
                stop: work.stop.clone(),
                memory: work.memory,
            };
            averaging::average(self.problem(), &settings, &mut |progress| work.goes_on(progress))
        };
        let mut given = self.entering_coefficients();
        // In a delay, beside numbers alone, pi is one, too: sin(pi/2) is no symbol.
        let equation = &self.problem().equation;
        let late = |e: &Expression| match e {
            Expression::Unknown(x) => {
                x.delay.as_ref().is_some_and(|by| !by.parameters().is_empty())
            }
            _ => false,
        };
        let open = equation.parameters();
        let open: Vec<&String> = open.iter().filter(|name| !given.contains_key(*name)).collect();
        if open == [PI] && equation.nodes().any(late) {
            given.insert(PI.to_owned(), Exact::parse(PI)?);
        }
        let error = match average(&given) {
            Ok(value) => {
                given.remove(PI);
                return Ok((value, given, None));
            }
            Err(error) => error,
        };
        let mut all: BTreeMap<String, Exact> = self.all_values().into_iter().collect();
        all.retain(|name, _| given.contains_key(name) || !self.given().contains_key(name));
        let no_symbols = matches!(
            error,
            DerivationError::Expand(
                ExpandError::StiffnessNotSquare
                    | ExpandError::Phase { source: PhaseError::Indivisible { .. }, .. }
            )
        );
        if !no_symbols || all.len() == given.len() {
            return Err(self.refusal(error.into()));
        }
        let value = average(&all).map_err(|error| self.refusal(error.into()))?;
        let remark =
            "the expansion is no formula in the parameters: all values of the problem are put in";
        Ok((value, all, Some(Remark(remark.to_owned()))))
    }

    fn settings(&self, order: usize, work: &Work) -> Settings {
        Settings {
            order,
            condition: self.asked_condition(),
            parameters: self.entering_coefficients(),
            memory: work.memory,
            stop: work.stop.clone(),
            ..Settings::default()
        }
    }

    /// The values given but that of the small parameter of an equation, on which no coefficient depends.
    pub(crate) fn entering_coefficients(&self) -> BTreeMap<String, Exact> {
        let mut given = self.given().clone();
        if self.problem().parameters.iter().all(|card| card.name != self.problem().small) {
            given.remove(&*self.problem().small);
        }
        given
    }

    /// That no coefficient depends on a value given.
    fn idle(&self, enters: impl Fn(&str) -> bool) -> impl Iterator<Item = Remark> {
        let idle = self.given().iter().filter(move |(name, _)| !enters(name));
        idle.map(|(name, q)| Remark(format!("no coefficient depends on {name} = {q}")))
    }

    /// What the equation is made of, and which methods take it, in words.
    ///
    /// # Errors
    /// As [`Oscillator::classify`].
    ///
    /// ```
    /// use lindstedt::Oscillator;
    /// let pendulum = Oscillator::parse("x'' + sin(x) = 0")?;
    /// assert!(pendulum.describe()?.methods.iter().any(|method| method.method == "time domain"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn describe(&self) -> Result<Description, Error> {
        Ok(Description::new(&self.classify()?, &self.problem().small))
    }

    /// To values at nodes every force is alike; what is not finite there is refused later.
    fn check_numeric(&self) -> Result<(), Error> {
        let Ok(mut parts) = self.classify() else { return Ok(()) };
        for (method, against) in &mut parts.methods {
            if *method == Method::LindstedtPoincare {
                against.retain(|r| !matches!(r, Reason::NonSmooth(_) | Reason::NotPolynomial(_)));
            }
        }
        self.check_parts(&parts)
    }

    /// Over Q every order is reconstructed from all primes together and proved by substitution at
    /// the end: stopped before, there is not one.
    fn unfinished(&self, error: Error, primes: usize) -> Error {
        if !error.is_interrupted() {
            return self.refusal(error);
        }
        let over_q = primes > 0
            || lindstedt_equation::classify::polynomial(&self.problem().equation).is_some();
        let why = if over_q {
            format!(
                ": over Q all orders are reconstructed together from many primes ({primes} done) and \
                 proved at the end; before that no order is"
            )
        } else {
            String::new()
        };
        let message = format!("stopped before the expansion was finished{why}");
        Refused::stopped(message, "raise --limit-seconds or lower --order").into()
    }

    /// An answer to orders as asked for, done and perhaps checked, at these values; without its value.
    pub(crate) fn finished(
        &self,
        at: impl IntoIterator<Item = (impl ToString, impl ToString)>,
        (asked, done, checked): (usize, usize, bool),
        tier: &'static str,
        mut remarks: Vec<Remark>,
        start: Instant,
    ) -> Answer<()> {
        let standing = self.standing(done < asked || !checked, done, checked, &mut remarks);
        Answer { header: self.header(at, Some(done), tier, start), value: (), standing, remarks }
    }

    /// Complete, or stopped after an order, which is said.
    pub(crate) fn standing(
        &self,
        stopped: bool,
        done: usize,
        checked: bool,
        remarks: &mut Vec<Remark>,
    ) -> Standing {
        if !stopped {
            return Standing::Complete;
        }
        let checked = if checked { "and checked" } else { "but not checked" };
        remarks.push(Remark(format!("stopped: orders 0 to {done} are finished {checked}")));
        Standing::Stopped { done }
    }

    /// What the problem file asks for and the answer does not have.
    pub(crate) fn missing(&self, has: &dyn Fn(Quantity) -> bool) -> Option<Remark> {
        let asked = self.problem_file().asked.iter().filter(|asked| !has(**asked));
        let missing: Vec<&str> = asked.map(|asked| asked.name()).collect();
        let list = missing.join(", ");
        let text = || Remark(format!("asked for in the file, but not in this result: {list}"));
        (!missing.is_empty()).then(text)
    }

    /// The values that the coefficients depend on.
    fn entering(&self, derivation: &Derivation) -> Vec<(String, String)> {
        let enters = matches!(
            derivation.problem.amplitude,
            AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSums | AmplitudeRole::Scaled
        );
        let amplitude = derivation.amplitude.as_ref().filter(|_| enters);
        let amplitude = amplitude.map(|value| ("amplitude".to_owned(), value.to_string()));
        let bound = derivation.bound.iter().map(|(name, q)| (name.clone(), q.to_string()));
        amplitude.into_iter().chain(bound).collect()
    }
}
