//! From a problem to a checked expansion: the call behind `lindstedt derive`.

mod json;
pub(crate) mod limits;
pub(crate) mod prepare;
mod series;

use crate::Number;
use crate::classification::Description;
use crate::constants::Constants;
use crate::{Error, Exact, Progress};
pub use limits::check_parameters;
pub(crate) use limits::{check_delays, unknown_parameter};
use limits::{has_logarithms, limit_memory};
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::{Condition, Problem};
use lindstedt_expand::{
    Binding, ExpandError, Expansion, Request, check, compile, expand, leading_amplitude,
};
use lindstedt_multimodular::{self as multimodular, RationalBinding};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{certified, to_ratio};
use lindstedt_phase::evaluate::{PhaseFunctions, of_rational};
use lindstedt_phase::lobachevsky_function::LambdaTable;
use lindstedt_phase::print::PrintPhase;
use lindstedt_phase::{Lobachevsky, Trigonometric};
use num_bigint::BigInt;
use num_rational::Ratio;
use prepare::{Prepared, prepare};
use rayon::prelude::*;
use rug::Rational;
use series::{Powers, energy_integral, series};
use std::collections::BTreeMap;

/// What to derive.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The highest order.
    pub order: usize,
    /// The normalisation; the problem's default if nothing.
    pub condition: Option<Condition>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, Exact>,
    /// The memory that may be used, in bytes.
    pub memory: u64,
    /// How the series are derived.
    pub route: Route,
    /// Asked within the orders, and from the threads of parallel loops, whether to stop.
    pub stop: Stop,
}

impl Default for Settings {
    /// Order 4, the problem's own normalisation and parameters, 8 GiB.
    fn default() -> Self {
        Self {
            order: 4,
            condition: None,
            parameters: BTreeMap::new(),
            memory: 8 << 30,
            route: Route::default(),
            stop: Stop::default(),
        }
    }
}

/// A power series that belongs to the result: prefactor * sum c_n eps^n.
#[derive(Clone, Debug)]
pub struct NamedSeries {
    /// `frequency_squared`, `frequency`, `period_over_2pi`; `amplitude` (x(0) of a limit cycle),
    /// `initial_displacement` (x(0) when the first harmonic is fixed).
    pub name: &'static str,
    /// A factor kappa^(half_power/2) in front, kappa the linear stiffness; 0 when kappa = 1.
    pub half_power: i32,
    /// The coefficients in the small parameter, exact.
    pub coefficients: Vec<Polynomial>,
}

/// How the series are derived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Route {
    /// By the driver: solution and frequency, checked by the residual.
    #[default]
    Driver,
    /// By the energy integral: the frequency alone, to much higher order; for forces
    /// x F(small ln x^2), and for polynomial ones where x(0) is the amplitude.
    EnergyIntegral,
}

/// The solution, in the algebra that the equation needed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Solution {
    /// None: the energy integral gives the frequency alone.
    FrequencyOnly,
    /// In the Lobachevsky ring.
    Lobachevsky(Box<Expansion<Lobachevsky<PolynomialRing>>>),
    /// Trigonometric polynomials over Q.
    Rational(Box<multimodular::Proved>),
}

/// A checked expansion: nothing leaves [`derive()`] that was not substituted back
/// (`checked_orders`), but for [`Route::EnergyIntegral`], which has no solution to substitute.
#[derive(Clone, Debug)]
pub struct Derivation {
    /// The problem as it was expanded: values put in, x and t scaled.
    pub problem: Problem,
    /// The normalisation used.
    pub condition: Condition,
    /// The highest order derived (lower than asked for when interrupted).
    pub order: usize,
    /// Orders whose residual vanishes identically: 0..=this; nothing without a solution, and
    /// where [`Settings::stop`] left no time to check.
    pub checked_orders: Option<usize>,
    /// The ring of the coefficients.
    pub ring: PolynomialRing,
    /// kappa, the factor of x at order zero.
    pub stiffness: Polynomial,
    /// The series of the result.
    pub series: Vec<NamedSeries>,
    /// The solution.
    pub solution: Solution,
    /// The amplitude that was asked for or is the default; nothing where there is none.
    pub amplitude: Option<Exact>,
    /// Parameters of the equation with the values that were put in.
    pub bound: BTreeMap<String, Rational>,
    /// Time is in units of 1/this: the solution's equation has linear stiffness 1 where x' occurs.
    /// The series of the result are in the time of the problem.
    pub time_scale: Rational,
    /// The coefficients of the series as numbers; empty where nobody asked for decimals.
    pub numbers: Vec<Vec<Number>>,
    /// What the equation is made of.
    pub description: Option<Description>,
    pub(crate) constants: Constants,
}

/// The name of the formal function whose Taylor coefficients are the sums S_n.
pub(crate) const FORMAL: &str = "S";

/// Rational values given for parameters of the equation, and the formal sums.
struct Given<'a> {
    ring: &'a PolynomialRing,
    parameters: &'a BTreeMap<String, Exact>,
}

impl Binding<PolynomialRing> for Given<'_> {
    fn parameter(&self, name: &str) -> Option<Polynomial> {
        Some(self.ring.rational(&RationalBinding::parameter(self, name)?))
    }
    fn formal(&self, name: &str, n: usize) -> Option<Polynomial> {
        let sum = Symbol::Sum(u16::try_from(n).ok()?);
        (name == FORMAL).then(|| self.ring.symbol(sum))
    }
}

impl Binding<Rationals> for Given<'_> {
    fn parameter(&self, name: &str) -> Option<Rational> {
        RationalBinding::parameter(self, name)
    }
    fn formal(&self, _: &str, _: usize) -> Option<Rational> {
        None
    }
}

impl RationalBinding for Given<'_> {
    fn parameter(&self, name: &str) -> Option<Rational> {
        self.parameters.get(name)?.as_rational().cloned()
    }
}

/// The normalisation asked for, if the problem offers it; its own if none is.
pub(crate) fn condition(problem: &Problem, asked: Option<Condition>) -> Result<Condition, Error> {
    let condition = match asked {
        None => problem.conditions.first().copied(),
        Some(asked) => problem.conditions.iter().copied().find(|c| *c == asked),
    };
    condition.ok_or_else(|| Error::UnknownCondition { problem: problem.name.to_string() })
}

/// Derives and checks the expansion of a problem: omega^2, omega and T/2pi as power series in the small
/// parameter, and x_0, x_1, ... as functions of the phase tau = omega t.
///
/// Dimensionless, in the time of the problem; the amplitude is what the condition of the settings fixes
/// (the problem's first if none is given), and it is part of the result. Exact: the coefficients are
/// rational numbers or polynomials in named constants, the residual has been checked, over Q proved.
/// Cost over Q: O(N^3) per prime for order N, and a number of primes that grows a little faster than N;
/// in the Lobachevsky ring a factor of about 1.8 per order.
///
/// `observer` is told the progress; when it returns `false` the derivation stops with the orders
/// finished so far (over Q, where all orders are finished together, with an error). The same
/// holds within an order when `settings.stop` says so; then the orders finished are not checked.
///
/// # Errors
/// [`Error`] with the reason; nothing is ever dropped or approximated silently.
///
/// # Example
/// ```
/// use lindstedt::{Settings, derive, problems};
/// let problem = problems::find("duffing").ok_or("no such problem")?;
/// let result = derive(&problem, &Settings { order: 3, ..Settings::default() }, &mut |_| true)?;
/// assert_eq!(result.exact("frequency", 2).as_deref(), Some("-21/256"));
/// assert_eq!(result.checked_orders, Some(3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    problem: &Problem,
    settings: &Settings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Derivation, Error> {
    check_parameters(problem, &settings.parameters)?;
    let Prepared { problem, bound, time_scale } = prepare(problem, settings)?;
    let problem = &problem;
    let condition = condition(problem, settings.condition)?;
    let amplitude = settings.parameters.get("amplitude").cloned();
    let has_logarithms = has_logarithms(&problem.equation);
    let ring = PolynomialRing { parameters: vec!["ln(a)".to_owned()] };
    let given = Given { ring: &ring, parameters: &settings.parameters };
    let over_q = |order: usize, observer: &mut dyn FnMut(usize) -> bool| {
        multimodular::derive(&problem.equation, &given, condition, order, &settings.stop, observer)
    };
    let bytes = |order| over_q(order, &mut |_| true).ok().map(|proved| limits::bytes_of(&proved));
    limit_memory(problem, settings, &bytes)?;
    let (solution, powers, amplitudes, stiffness, checked_orders) = if settings.route
        == Route::EnergyIntegral
    {
        let request = (condition, settings.order);
        let (powers, stiffness) = energy_integral(problem, &ring, request, &settings.stop, &given)?;
        if !observer(Progress::Checking) || settings.stop.asked() {
            return Err(ExpandError::Interrupted { order: settings.order }.into());
        }
        (Solution::FrequencyOnly, powers, Vec::new(), stiffness, None)
    } else if has_logarithms {
        let algebra = Lobachevsky::new(ring.clone()).with_stop(settings.stop.clone());
        let equation = compile(&algebra, &problem.equation, &given, settings.order)?;
        let leading_amplitude = leading_amplitude(&algebra, &equation, condition)?;
        let request = Request { condition, order: settings.order, leading_amplitude };
        let mut on_order =
            |work: &lindstedt_expand::OrderWork| observer(Progress::Order(work.order, work.terms));
        let expansion = expand(&algebra, &equation, &request, &mut on_order)?;
        observer(Progress::Checking);
        let checked = match check(&algebra, &equation, &expansion) {
            Err(ExpandError::Interrupted { .. }) => None,
            other => Some(other?),
        };
        let squared = expansion.frequency_squared.clone();
        let (amplitudes, stiffness) = (expansion.amplitude.clone(), expansion.stiffness.clone());
        (
            Solution::Lobachevsky(Box::new(expansion)),
            Powers::of_square(&ring, squared)?,
            amplitudes,
            stiffness,
            checked,
        )
    } else {
        let mut on_primes = |primes| observer(Progress::Primes(primes));
        let proved = over_q(settings.order, &mut on_primes)?;
        let constants =
            |list: &[Rational]| list.iter().map(|q| ring.rational(q)).collect::<Vec<_>>();
        let lists = [&proved.expansion.frequency_squared, &proved.frequency, &proved.period];
        let powers = Powers::rational(&ring, lists.map(Vec::as_slice));
        let amplitudes = constants(&proved.expansion.amplitude);
        let stiffness = ring.rational(&proved.expansion.stiffness);
        let order = proved.expansion.order();
        (Solution::Rational(Box::new(proved)), powers, amplitudes, stiffness, Some(order))
    };
    if ring.as_rational(&stiffness).is_some_and(|kappa| kappa < 0) {
        return Err(ExpandError::NegativeStiffness.into());
    }
    // The driver's orders are few enough to be printed whenever it was stopped.
    let stop = match solution {
        Solution::FrequencyOnly => settings.stop.clone(),
        _ => Stop::default(),
    };
    let condition_and_stop = (condition, &stop);
    let mut series = series(
        problem,
        &ring,
        condition_and_stop,
        powers,
        amplitudes,
        amplitude.as_ref(),
        &stiffness,
    )?;
    prepare::undo_time_scale(&mut series, &ring, &time_scale);
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
        amplitude: amplitude.clone(),
        bound,
        time_scale,
        numbers: Vec::new(),
        description: None,
        constants: Constants::new(amplitude),
    })
}

impl Derivation {
    /// With the coefficients as numbers of so many digits.
    pub(crate) fn with_numbers(mut self, digits: usize) -> Result<Self, Error> {
        let numbers = self.series.iter().map(|series| self.numbers(series, digits));
        self.numbers = numbers.collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// With what its equation is made of.
    pub(crate) fn described(mut self, description: Option<Description>) -> Self {
        self.description = description;
        self
    }

    /// The number of orders whose solution is known.
    #[must_use]
    pub fn solved(&self) -> usize {
        match self.solution {
            Solution::FrequencyOnly => 0,
            _ => self.order + 1,
        }
    }

    /// The series of that name.
    pub fn named(&self, name: &str) -> Option<&NamedSeries> {
        self.series.iter().find(|series| series.name == name)
    }

    /// Coefficient n of a series as an exact expression.
    pub fn exact(&self, name: &str, n: usize) -> Option<String> {
        let series = self.named(name)?;
        series.coefficients.get(n)?;
        Some(self.print_coefficient(series, n, Style::Text))
    }

    /// Coefficient n of a series as a fraction, where it is rational.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?.derive(2, &Work::default())?;
    /// let first = duffing.value.ratio("frequency_squared", 1);
    /// assert_eq!(first.map(|q| q.to_string()).as_deref(), Some("3/4"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn ratio(&self, name: &str, n: usize) -> Option<Ratio<BigInt>> {
        let series = self.named(name)?;
        let product = self.with_prefactor(series, series.coefficients.get(n)?)?;
        self.ring.as_rational(&product).map(|q| to_ratio(&q))
    }

    /// A coefficient times its power of the root of the stiffness, where that is in the ring: the
    /// root of a square is taken.
    fn with_prefactor(&self, series: &NamedSeries, coefficient: &Polynomial) -> Option<Polynomial> {
        let power = series.half_power;
        if power == 0 || self.ring.is_zero(coefficient) {
            return Some(coefficient.clone());
        }
        if power == 2 {
            return Some(self.ring.mul(coefficient, &self.stiffness));
        }
        let root = rational_root(&self.ring.as_rational(&self.stiffness)?)?;
        let root = if power < 0 { root.recip() } else { root };
        let factor = rug::ops::Pow::pow(root, power.unsigned_abs());
        Some(self.ring.scale(coefficient, &factor))
    }

    /// Coefficient n with its prefactor, printed.
    pub fn print_coefficient(&self, series: &NamedSeries, n: usize, style: Style) -> String {
        let Some(coefficient) = series.coefficients.get(n) else { return "0".to_owned() };
        if let Some(product) = self.with_prefactor(series, coefficient) {
            return self.ring.print(&product, style);
        }
        let power = series.half_power;
        let kappa = self.ring.print(&self.stiffness, style);
        let single = kappa.chars().all(|c| c.is_alphanumeric() || "_{}".contains(c));
        let factor = match style {
            Style::Text if single => format!("{kappa}^({power}/2)"),
            Style::Text => format!("({kappa})^({power}/2)"),
            Style::Latex if single => format!("{kappa}^{{{power}/2}}"),
            Style::Latex => format!(r"\left({kappa}\right)^{{{power}/2}}"),
        };
        if *coefficient == self.ring.one() {
            return factor;
        }
        let rest = self.ring.print(coefficient, style);
        match style {
            Style::Text => format!("{factor}*({rest})"),
            Style::Latex => format!(r"{factor}\left({rest}\right)"),
        }
    }

    /// kappa, the factor of x at order zero, printed.
    pub fn ring_print(&self, style: Style) -> String {
        self.ring.print(&self.stiffness, style)
    }

    /// W_n of omega^2 = kappa sum W_n eps^n for amplitude one, in the moments mu_m, printed; empty
    /// beyond the orders derived.
    pub fn frequency_correction(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly => String::new(),
            Solution::Lobachevsky(expansion) => {
                self.ring.print(&expansion.frequency_squared[n], style)
            }
            Solution::Rational(proved) => {
                Rationals.print(&proved.expansion.frequency_squared[n], style)
            }
        }
    }

    /// x_n(0), printed.
    pub fn amplitude_correction(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly => String::new(),
            Solution::Lobachevsky(expansion) => self.ring.print(&expansion.amplitude[n], style),
            Solution::Rational(proved) => Rationals.print(&proved.expansion.amplitude[n], style),
        }
    }

    /// Coefficient n of a series as a number with `digits` digits.
    ///
    /// # Errors
    /// [`Error::NotEnoughBits`] when the digits cannot be reached.
    pub fn number(&self, series: &NamedSeries, n: usize, digits: usize) -> Result<Number, Error> {
        let exact = self.print_coefficient(series, n, Style::Text);
        Ok(certified(Some(exact), digits, |balls| self.ball(series, n, balls))?)
    }

    /// All coefficients of a series as numbers.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn numbers(&self, series: &NamedSeries, digits: usize) -> Result<Vec<Number>, Error> {
        let orders = (0..series.coefficients.len()).into_par_iter();
        orders.map(|n| self.number(series, n, digits)).collect()
    }

    /// x_0, x_1, ..., x_N, or their functions in the phase, to be evaluated at many phases. Nothing where the
    /// solution was not kept.
    pub(crate) fn phase_functions(&self, derivative: bool, balls: Balls) -> Option<PhaseFunctions> {
        match &self.solution {
            Solution::Lobachevsky(expansion) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let functions: Vec<_> = match derivative {
                    true => expansion.solution.iter().map(|x| algebra.derivative(x)).collect(),
                    false => expansion.solution.clone(),
                };
                let table = LambdaTable::new(functions.len(), balls);
                let value = |c: &_| self.constants.evaluate(c, balls);
                PhaseFunctions::lobachevsky(&functions, table, value)
            }
            Solution::Rational(proved) => {
                let algebra = Trigonometric::new(Rationals);
                let solution = &proved.expansion.solution;
                let functions: Vec<_> = match derivative {
                    true => solution.iter().map(|x| algebra.derivative(x)).collect(),
                    false => solution.clone(),
                };
                PhaseFunctions::trigonometric(&functions, balls, of_rational(balls))
            }
            Solution::FrequencyOnly => None,
        }
    }

    /// Coefficient n of a series as a ball.
    pub fn ball(&self, series: &NamedSeries, n: usize, balls: Balls) -> Option<Ball> {
        let value = self.constants.evaluate(series.coefficients.get(n)?, balls)?;
        if series.half_power == 0 {
            return Some(value);
        }
        let root = balls.sqrt(&self.constants.evaluate(&self.stiffness, balls)?)?;
        Some(balls.mul(&value, &balls.powi(&root, series.half_power.into())?))
    }

    /// x_n printed, as a function of the phase `tau` = omega t; empty beyond the orders derived.
    pub fn print_solution(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly => String::new(),
            Solution::Lobachevsky(expansion) => {
                Lobachevsky::new(self.ring.clone()).print(&expansion.solution[n], "tau", style)
            }
            Solution::Rational(proved) => {
                Trigonometric::new(Rationals).print(&proved.expansion.solution[n], "tau", style)
            }
        }
    }

    /// The right side f_n of x_n'' + x_n = f_n - W_n x_0'', printed, and its number of terms; empty
    /// beyond the orders derived.
    pub fn print_right_side(&self, n: usize, style: Style) -> (String, usize) {
        if n > self.order {
            return (String::new(), 0);
        }
        match &self.solution {
            Solution::Lobachevsky(expansion) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let f = expansion.right_side(&algebra, n);
                (algebra.print(&f, "tau", style), algebra.terms(&f))
            }
            Solution::FrequencyOnly => (String::new(), 0),
            Solution::Rational(proved) => {
                let algebra = Trigonometric::new(Rationals);
                let f = proved.expansion.right_side(&algebra, n);
                (algebra.print(&f, "tau", style), algebra.terms(&f))
            }
        }
    }

    /// The number of terms of x_n; 0 beyond the orders derived.
    pub fn terms(&self, n: usize) -> usize {
        if n > self.order {
            return 0;
        }
        match &self.solution {
            Solution::FrequencyOnly => 0,
            Solution::Lobachevsky(expansion) => expansion.solution[n].len(),
            Solution::Rational(proved) => {
                Trigonometric::new(Rationals).terms(&proved.expansion.solution[n])
            }
        }
    }
}
