//! Averaging of a problem: rates of amplitude and phase as formulas or as numbers.

mod coefficients;
mod cycles;
mod expansion;
mod formulas;
mod friction;
mod json;
pub mod numbers;
mod task;
mod values;

pub use cycles::{Algebraic, Cycle, Cycles, SingleCycle, print_series};
pub use expansion::AveragedExpansion;

use crate::error::DerivationError as Error;
use crate::limits::refuse_above;
use crate::work::Progress;
use lindstedt_algebra::Stop;
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::print::Style;
use lindstedt_equation::Problem;
use lindstedt_equation::description::Description;
use lindstedt_impact::convergence::Convergence;
use lindstedt_number::{Exact, Number};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};
use task::Task;

/// What to average.
#[derive(Clone, Debug)]
pub struct AveragingSettings {
    /// The highest order.
    pub order: usize,
    /// Values of parameters by name. Parameters of the equation that are not listed stay symbols.
    pub parameters: BTreeMap<String, Exact>,
    /// Digits of numbers that are not rational.
    pub digits: usize,
    /// Asked within the orders whether to stop.
    pub stop: Stop,
    /// The memory that may be used, in bytes.
    pub memory: u64,
}

impl Default for AveragingSettings {
    /// Order 2, every parameter a symbol, 30 digits, 8 GiB.
    fn default() -> Self {
        Self {
            order: 2,
            parameters: BTreeMap::new(),
            digits: 30,
            stop: Stop::default(),
            memory: 8 << 30,
        }
    }
}

/// One term c a^exponent of a rate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RateTerm {
    /// The power of the amplitude.
    pub exponent: i32,
    /// c.
    pub coefficient: Coefficient,
}

impl RateTerm {
    /// c a^exponent.
    #[must_use]
    pub fn new(exponent: i32, coefficient: Coefficient) -> Self {
        Self { exponent, coefficient }
    }
}

/// A coefficient of an averaged expansion.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// A number.
    Number(Number),
    /// A number in pi: its exact form is a formula, too.
    ClosedForm {
        /// The number.
        number: Number,
        /// Its exact form as LaTeX.
        latex: String,
    },
    /// A formula in the parameters that have no value.
    Formula(Formula),
}

/// A formula, written in the notation that is asked for: of a high order a megabyte each.
#[derive(Clone)]
pub struct Formula {
    print: Arc<dyn Fn(Style) -> String + Send + Sync>,
    text: OnceLock<String>,
}

impl Formula {
    pub(crate) fn new(print: impl Fn(Style) -> String + Send + Sync + 'static) -> Self {
        Self { print: Arc::new(print), text: OnceLock::new() }
    }

    /// One line of text.
    pub fn text(&self) -> &str {
        self.text.get_or_init(|| (self.print)(Style::Text))
    }

    /// LaTeX.
    pub fn latex(&self) -> String {
        (self.print)(Style::Latex)
    }
}

impl std::fmt::Debug for Formula {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text())
    }
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text()
    }
}

/// An averaged problem, substituted into its equation:
///
///   x = a cos psi + ..., da/dt = sum eps^n A_n(a), dpsi/dt = sum eps^n B_n(a) with B_0 = omega_0;
///
/// no other term of x contains cos psi or sin psi. Where the law jumps with the velocity
/// ([`Averaging::between_turning_points`]) a is the amplitude of the turning points instead.
///
/// ```
/// use lindstedt_derivation::averaging::{AveragingSettings, average};
/// let problem = lindstedt_problems::find("van-der-pol").ok_or("no such problem")?;
/// let settings = AveragingSettings { order: 1, ..AveragingSettings::default() };
/// let cycle = average(&problem, &settings, &mut |_| true)?;
/// // A_1 = a/2 - a^3/8.
/// let exponents: Vec<i32> = cycle.amplitude_rate[1].iter().map(|term| term.exponent).collect();
/// assert_eq!(exponents, [1, 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Averaging {
    /// The problem.
    pub problem: Problem,
    /// The highest order derived.
    pub order: usize,
    /// Orders 0..=this leave no residual; 0 where [`AveragingSettings::stop`] left no time to check
    /// the others.
    pub checked_orders: usize,
    /// A_n, order by order, as terms in increasing powers of a.
    pub amplitude_rate: Vec<Vec<RateTerm>>,
    /// B_n; the one of order zero is omega_0.
    pub phase_rate: Vec<Vec<RateTerm>>,
    /// u_0 = a cos psi + the forced response, u_1, ...
    pub solution: Vec<Formula>,
    /// Terms of u_n.
    pub terms: Vec<usize>,
    /// The parameters without a value, which the formulas keep.
    pub symbols: Vec<String>,
    /// Whether the coefficients are exact (rational numbers or formulas); otherwise they are
    /// certified and the residual encloses zero.
    pub exact: bool,
    /// The limit cycles with their Floquet exponents; nothing where values are missing or irrational, or no
    /// rate of the amplitude depends on it otherwise than linearly.
    pub cycles: Option<Cycles>,
    /// Where values are missing or irrational and A_k has one zero a_0^2: its limit cycle.
    pub single_cycle: Option<SingleCycle>,
    /// Where the averaged series of an impact oscillator converges, with a value for every parameter.
    pub convergence: Option<Convergence>,
    /// What the equation is made of.
    pub description: Option<Description>,
}

impl Averaging {
    /// Whether the law jumps with the velocity. Then a is the amplitude of the turning points and psi is
    /// counted between them: x = a at psi = 0, x = -a at psi = pi; u_n holds for 0 <= psi <= pi, and
    /// x(a, psi + pi) = -x(a, psi).
    #[must_use]
    pub fn between_turning_points(&self) -> bool {
        friction::jumps(&self.problem)
    }

    /// Whether A_n = R_n a and B_n are free of a: then the amplitude grows exponentially, and
    /// `growth_rate` and `frequency` are numbers.
    pub fn is_linear(&self) -> bool {
        let only = |rates: &[Vec<RateTerm>], exponent| {
            rates.iter().flatten().all(|term| term.exponent == exponent)
        };
        only(&self.amplitude_rate, 1) && only(&self.phase_rate, 0)
    }
}

/// Averages a problem.
///
/// Coefficients are rational where all parameters of the equation have rational values and no
/// delay occurs; formulas when a parameter has no value (the others must be rational); certified
/// numbers otherwise, at a precision that is raised until all digits are certain. Laws with sign(x') and
/// |x'| are averaged between turning points, over Q[pi, 1/pi] and the parameters without a value.
///
/// # Errors
/// [`Error`] with the reason; resonances are named.
///
/// ```
/// use lindstedt_derivation::averaging::{AveragingSettings, Coefficient, average};
/// let problem = lindstedt_problems::vibro_impact::problem();
/// let settings = AveragingSettings { order: 1, ..AveragingSettings::default() };
/// let result = average(&problem, &settings, &mut |_| true)?;
/// // The paper's (7): da/dt = eps R a.
/// let Coefficient::Formula(formula) = &result.amplitude_rate[1][0].coefficient else { panic!() };
/// assert!(formula.text().contains("1/2*alpha^(-1)*A*sin(alpha*T)"), "{formula:?}");
/// # Ok::<(), lindstedt_derivation::DerivationError>(())
/// ```
pub fn average(
    problem: &Problem,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Averaging, Error> {
    if friction::jumps(problem) {
        return friction::average(problem, settings, observer);
    }
    let task = Task::new(problem, settings)?;
    let open = task.names.iter().filter(|name| task.value(name).is_none()).count();
    if open > 0 {
        limit_memory(settings, open)?;
        return task.symbolic(observer);
    }
    if let Some(result) = task.rational(observer)? {
        return Ok(result);
    }
    task.certified(observer)
}

/// The averaged expansion with every parameter a symbol: [`average`] as elements of the field of rational
/// functions of the parameters, sines and cosines, exact and substituted into its equation.
///
/// x = a cos psi + ..., da/dt = sum eps^n A_n(a), dpsi/dt = sum eps^n B_n(a) with B_0 = omega_0, n up to `order`.
///
/// # Errors
/// As [`average`]; the expansion grows with each symbol (see its memory limit).
///
/// ```
/// use lindstedt_derivation::averaging::formulas;
/// let (_, expansion) = formulas(&lindstedt_problems::vibro_impact::problem(), 1)?;
/// assert_eq!(expansion.amplitude_rate.len(), 2);
/// # Ok::<(), lindstedt_derivation::DerivationError>(())
/// ```
pub fn formulas(
    problem: &Problem,
    order: usize,
) -> Result<(ParameterField, AveragedExpansion<ParameterFraction>), Error> {
    let settings = AveragingSettings { order, digits: 20, ..AveragingSettings::default() };
    let (field, over) = Task::new(problem, &settings)?.over_parameters(&mut |_| true)?;
    Ok((field, over.expansion))
}

/// Refuses before allocating, by the number of symbols. Measured: the rates of the delay loop in seven take 4 MiB at
/// order 8 and 225 MiB at order 18, those of a damping of degree 4 in two 31 MiB at order 24, to a tenth and a third what
/// is predicted. Laws of many powers take more than that: whoever counts memory while it grows stops them.
fn limit_memory(settings: &AveragingSettings, symbols: usize) -> Result<(), Error> {
    let growth = 1.4f64.log2() * symbols as f64 / 6.0;
    let bits = 22.0 + (settings.order as f64 - 8.0) * growth;
    refuse_above(settings.memory, settings.order, bits)
}
