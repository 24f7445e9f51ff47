//! From a problem to a checked expansion.

use crate::binding::Given;
use crate::clock;
use crate::constants::Constants;
use crate::derivation::{Derivation, Solution};
use crate::error::DerivationError;
use crate::exponent::proved_exponent;
use crate::found::Found;
use crate::limits::{Bytes, bytes_of, check_parameters, has_logarithms, limit_memory};
use crate::prepare::{Prepared, prepare};
use crate::series::{NamedSeries, Powers, energy_integral, series, undo_time_scale};
use crate::settings::{Route, Settings, condition};
use crate::work::Progress;
use lindstedt_algebra::{RationalAlgebra, Stop};
use lindstedt_coeff::PolynomialRing;
use lindstedt_equation::{Condition, Problem, Quantity};
use lindstedt_expand::{
    ExpandError, OrderWork, Request, check, compile, expand, leading_amplitude,
};
use lindstedt_multimodular as multimodular;
use lindstedt_number::Exact;
use lindstedt_phase::Lobachevsky;
use rug::Rational;

type Observer<'a> = dyn FnMut(Progress) -> bool + 'a;

/// A prepared problem on its way.
struct Task<'a> {
    problem: &'a Problem,
    settings: &'a Settings,
    condition: Condition,
    ring: &'a PolynomialRing,
    given: Given<'a>,
}

/// Derives and checks the expansion of a problem: omega^2, omega and T/2pi as power series in the small
/// parameter, and x_0, x_1, ... as functions of the phase tau = omega t.
///
/// Dimensionless, in the time of the problem; the amplitude is what the condition of the settings fixes
/// (the problem's first if none is given), and it is part of the result. Exact: the coefficients are
/// rational numbers or polynomials in named constants, the residual has been checked, over Q proved.
/// Cost over Q: O(N^3) per prime for order N, and a number of primes that grows a little faster than N;
/// in the Lobachevsky ring O(1) per term by the clock, a factor of about 1.8 per order by the driver.
///
/// `observer` is told the progress; when it returns `false` the derivation stops with the orders
/// finished so far (over Q, where all orders are finished together, with an error). The same
/// holds within an order when `settings.stop` says so; then the orders finished are not checked, and by the
/// clock, which unfolds them together, it is an error.
///
/// # Errors
/// [`DerivationError`] with the reason; nothing is ever dropped or approximated silently.
///
/// # Example
/// ```
/// use lindstedt_derivation::{Settings, derive};
/// use lindstedt_equation::Quantity;
/// let problem = lindstedt_problems::find("duffing").ok_or("no such problem")?;
/// let result = derive(&problem, &Settings { order: 3, ..Settings::default() }, &mut |_| true)?;
/// assert_eq!(result.exact(Quantity::Frequency, 2).as_deref(), Some("-21/256"));
/// assert_eq!(result.checked_orders, Some(3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    problem: &Problem,
    settings: &Settings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Derivation, DerivationError> {
    check_parameters(problem, &settings.parameters)?;
    let Prepared { problem, bound, time_scale } = prepare(problem, settings)?;
    let problem = &problem;
    let condition = condition(problem, settings.condition)?;
    let amplitude = settings.parameters.get("amplitude").cloned();
    let ring = PolynomialRing { parameters: vec!["ln(a)".to_owned()] };
    let given = Given { ring: &ring, parameters: &settings.parameters };
    let task = Task { problem, settings, condition, ring: &ring, given };
    let bytes = |order| task.proved(order, &mut |_| true).ok().map(|proved| bytes_of(&proved));
    let bytes: &Bytes<'_> = &bytes;
    limit_memory(problem, settings, bytes)?;
    let logarithms = has_logarithms(&problem.equation);
    let (route, found) = match settings.route {
        Route::EnergyIntegral => (Route::EnergyIntegral, task.by_energy(observer)?),
        Route::Frequency => task.frequency_alone(logarithms, observer)?,
        Route::Automatic | Route::Clock if logarithms => task.by_clock(bytes, observer)?,
        Route::Clock => return Err(ExpandError::NotOneClock { order: 0 }.into()),
        _ if logarithms => (Route::Driver, task.over_moments(observer)?),
        _ => (Route::Driver, task.over_rationals(observer)?),
    };
    let Found { solution, powers, amplitudes, stiffness, checked_orders } = found;
    if ring.as_rational(&stiffness).is_some_and(|kappa| kappa < 0) {
        return Err(ExpandError::NegativeStiffness.into());
    }
    // The driver's orders are few enough to be printed whenever it was stopped.
    let stop = match solution {
        Solution::FrequencyOnly { .. } => settings.stop.clone(),
        _ => Stop::default(),
    };
    let how = (condition, &stop);
    let given = amplitude.as_ref();
    let mut series = series(problem, &ring, how, powers, amplitudes, given, &stiffness)?;
    if let Solution::Rational(cycle) = &solution
        && condition == Condition::LimitCycle
        && let Some(exponent) = proved_exponent(&problem.equation, cycle)
    {
        let coefficients = exponent.iter().map(|q| ring.rational(q)).collect();
        series.push(NamedSeries {
            quantity: Quantity::FloquetExponent,
            half_power: 0,
            coefficients,
        });
    }
    undo_time_scale(&mut series, &ring, &time_scale);
    let default = problem.parameters.iter().find(|p| p.name == "amplitude");
    let amplitude = match amplitude {
        Some(value) => Some(value),
        None => default.map(|card| Exact::parse(&card.default)).transpose()?,
    };
    Ok(Derivation {
        problem: problem.clone(),
        condition,
        order: series.first().map_or(0, |s| s.coefficients.len() - 1),
        checked_orders,
        ring,
        stiffness,
        series,
        solution,
        route,
        amplitude: amplitude.clone(),
        bound,
        time_scale,
        numbers: Vec::new(),
        description: None,
        constants: Constants::new(amplitude),
    })
}

impl Task<'_> {
    fn proved(
        &self,
        order: usize,
        observer: &mut dyn FnMut(usize) -> bool,
    ) -> Result<multimodular::Proved, multimodular::Error> {
        let (equation, stop) = (&self.problem.equation, &self.settings.stop);
        let names = |name: &str| self.given.value(name);
        multimodular::derive(equation, &names, self.condition, order, stop, observer)
    }

    fn by_energy(&self, observer: &mut Observer<'_>) -> Result<Found, DerivationError> {
        let Self { problem, settings, ring, .. } = self;
        let request = (self.condition, settings.order);
        let (powers, stiffness) =
            energy_integral(problem, ring, request, &settings.stop, &self.given)?;
        if !observer(Progress::Checking) || settings.stop.asked() {
            return Err(ExpandError::Interrupted { order: settings.order }.into());
        }
        let solution = Solution::FrequencyOnly { images: None };
        Ok(Found { solution, powers, amplitudes: Vec::new(), stiffness, checked_orders: None })
    }

    /// By the energy integral where it applies, or modulo primes.
    fn frequency_alone(
        &self,
        logarithms: bool,
        observer: &mut Observer<'_>,
    ) -> Result<(Route, Found), DerivationError> {
        match self.by_energy(observer) {
            Err(DerivationError::NoSuchRoute { .. }) if !logarithms => {}
            found => return Ok((Route::EnergyIntegral, found?)),
        }
        let Self { problem, settings, ring, .. } = self;
        let mut on_primes = |primes| observer(Progress::Primes(primes));
        let (equation, order, stop) = (&problem.equation, settings.order, &settings.stop);
        let (names, condition) = (|name: &str| self.given.value(name), self.condition);
        let found =
            multimodular::frequency(equation, &names, condition, order, stop, &mut on_primes)?;
        let lists = [&found.squared, &found.frequency, &found.period].map(Vec::as_slice);
        let found = Found {
            powers: Powers::rational(ring, lists),
            amplitudes: Vec::new(),
            stiffness: ring.rational(&found.stiffness),
            checked_orders: None,
            solution: Solution::FrequencyOnly { images: Some(found.images) },
        };
        Ok((Route::Frequency, found))
    }

    /// By the clock, or by the driver where that is not asked for and does not apply.
    fn by_clock(
        &self,
        bytes: &Bytes<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<(Route, Found), DerivationError> {
        let Self { problem, settings, condition, given, .. } = self;
        match clock::derive(problem, given, *condition, settings, observer)? {
            Some(found) => Ok((Route::Clock, found)),
            None if settings.route == Route::Clock => {
                Err(ExpandError::NotOneClock { order: 0 }.into())
            }
            None => {
                let settings = Settings { route: Route::Driver, ..(*settings).clone() };
                limit_memory(problem, &settings, bytes)?;
                Ok((Route::Driver, self.over_moments(observer)?))
            }
        }
    }

    /// In the Lobachevsky ring over Q\[mu_m\].
    fn over_moments(&self, observer: &mut Observer<'_>) -> Result<Found, DerivationError> {
        let Self { problem, settings, condition, .. } = *self;
        let algebra = Lobachevsky::new(self.ring.clone()).with_stop(settings.stop.clone());
        let equation = compile(&algebra, &problem.equation, &self.given, settings.order)?;
        let leading_amplitude = leading_amplitude(&algebra, &equation, condition)?;
        let request = Request { condition, order: settings.order, leading_amplitude };
        let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
        let expansion = expand(&algebra, &equation, &request, &mut on_order)?;
        observer(Progress::Checking);
        let checked_orders = match check(&algebra, &equation, &expansion) {
            Err(ExpandError::Interrupted { .. }) => None,
            other => Some(other?),
        };
        Ok(Found {
            powers: Powers::of_square(self.ring, expansion.frequency_squared.clone())?,
            amplitudes: expansion.amplitude.clone(),
            stiffness: expansion.stiffness.clone(),
            solution: Solution::Lobachevsky(Box::new(expansion)),
            checked_orders,
        })
    }

    /// From images modulo many primes.
    fn over_rationals(&self, observer: &mut Observer<'_>) -> Result<Found, DerivationError> {
        let ring = self.ring;
        let mut on_primes = |primes| observer(Progress::Primes(primes));
        let proved = self.proved(self.settings.order, &mut on_primes)?;
        let constants = |list: &[Rational]| list.iter().map(|q| ring.rational(q)).collect();
        let lists = [&proved.squared, &proved.frequency, &proved.period];
        Ok(Found {
            powers: Powers::rational(ring, lists.map(Vec::as_slice)),
            amplitudes: constants(&proved.amplitude),
            stiffness: ring.rational(&proved.stiffness),
            checked_orders: Some(proved.order()),
            solution: Solution::Rational(Box::new(proved)),
        })
    }
}
