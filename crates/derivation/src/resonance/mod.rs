//! Averaging at resonance and of several unknowns: from equations to their slow flow, exact in the symbols.
//!
//!   x_j = z_j + zbar_j + the response to the force + sum eps^n u_{j,n}(z, zbar, E),   E = e^{i eta},
//!   z_j' = i nu_j z_j + sum eps^n f_{j,n}(z, zbar, E),   eta' = Omega + sum eps^n sigma_n
//!
//! (see [`lindstedt_expand::resonance`]). What the frequencies nu_j and Omega depend on has a value; their
//! ratios are rational numbers, so that what is resonant is decided exactly. A linear part that couples the
//! unknowns is taken apart into modes x = P q where those are rational. A force beside a resonance is
//! detuned: with `cos((1 + eps*sigma)*t)` as it is written, and with a frequency that is a number by the
//! symbol sigma = (omega - Omega)/eps.

mod error;
mod forces;
mod modes;
mod system;

pub use error::ResonanceError;
pub use system::{Beside, System};

use crate::averaging::constant;
use crate::error::DerivationError as Error;
use crate::work::Progress;
use lindstedt_algebra::Stop;
use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;
use lindstedt_expand::resonance::{Nearest, check_flow, resonant};
use lindstedt_expand::{Binding, ExpandError, OrderWork, compile_system};
use lindstedt_number::Exact;
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm, Amplitudes};
use rug::{Integer, Rational};
use std::collections::BTreeMap;
use system::Values;

type Element = AmplitudeElement<Integer>;

/// A polynomial in z_1, zbar_1, ..., z_M, zbar_M, E = e^{i eta} and the symbols, in this order of
/// exponents; that of E may be negative.
pub type Terms = Vec<AmplitudeTerm>;

/// A slow flow that was substituted into its equations, as plain data.
#[derive(Clone, Debug)]
pub struct SlowFlow {
    /// What was averaged.
    pub system: System,
    /// The highest order derived.
    pub order: usize,
    /// Orders 0..=this leave no residual; nothing where there was no time to check.
    pub checked_orders: Option<usize>,
    /// f_{j,n} at `[j][n]`; f_{j,0} = i nu_j z_j.
    pub flow: Vec<Vec<Terms>>,
    /// x_{j,n} at `[j][n]`, of the modes where the system has shapes: z_j + zbar_j + the response to the
    /// force, u_{j,1}, ...
    pub solution: Vec<Vec<Terms>>,
    /// sigma_1, sigma_2, ...
    pub detuning: Vec<Terms>,
    /// The smallest divisor of every order and unknown.
    pub nearest: Vec<Nearest>,
}

impl SlowFlow {
    /// M.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.system.frequencies.len()
    }

    /// The smallest divisor of all orders.
    #[must_use]
    pub fn nearest(&self) -> Option<&Nearest> {
        self.nearest.iter().min_by(|a, b| a.size.cmp_abs(&b.size))
    }
}

/// What to average.
#[derive(Clone, Debug)]
pub struct FlowSettings<'a> {
    /// The highest order.
    pub order: usize,
    /// Values that are put in, by name; what is not listed stays a symbol, unless a frequency depends on it.
    pub given: &'a BTreeMap<String, Exact>,
    /// Values for those, by name and in the order in which symbols are printed.
    pub cards: &'a [(String, Option<Exact>)],
    /// Asked within the orders whether to stop.
    pub stop: Stop,
}

struct Symbols<'a>(&'a Amplitudes<Integers>);

impl Binding<Amplitudes<Integers>> for Symbols<'_> {
    fn parameter(&self, name: &str) -> Option<Element> {
        self.0.symbol(name)
    }
    fn formal(&self, _: &str, _: usize) -> Option<Element> {
        None
    }
}

/// The slow flow of the left sides of `equations` = 0, unknown j in equation j.
///
/// Exact; the residual of every order vanishes identically. Cost: O(N^2) products of polynomials whose
/// length grows like N^(symbols + 1).
///
/// # Errors
/// [`ResonanceError`] by name for what is no such system; [`ExpandError`] for terms that are no polynomial.
///
/// ```
/// use lindstedt_derivation::resonance::{FlowSettings, slow_flow};
/// use lindstedt_equation::{Expression, Function};
/// // x'' + x + eps (x^3 - F cos((1 + eps sigma) t)) = 0.
/// let (x, small) = (Expression::DISPLACEMENT, Expression::Small);
/// let rate = Expression::integer(1) + small.clone() * Expression::parameter("sigma");
/// let force = Expression::parameter("F") * (rate * Expression::Time).apply(Function::Cos);
/// let equation = Expression::ACCELERATION + x.clone() + small * (x.pow(3) - force);
/// let (given, cards) = Default::default();
/// let settings = FlowSettings { order: 2, given: &given, cards, stop: Default::default() };
/// let found = slow_flow(&[equation], &settings, &mut |_| true)?;
/// assert_eq!((found.checked_orders, found.flow[0][1].len()), (Some(2), 2));
/// # Ok::<(), lindstedt_derivation::DerivationError>(())
/// ```
pub fn slow_flow(
    equations: &[Expression],
    settings: &FlowSettings<'_>,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<SlowFlow, Error> {
    let cards = |name: &str| settings.cards.iter().find(|(card, _)| card == name)?.1.clone();
    let values = Values { given: settings.given, cards: &cards };
    let order: Vec<String> = settings.cards.iter().map(|(name, _)| name.clone()).collect();
    let system = System::of(equations, &values, &order)?;
    let names: Vec<&str> = system.symbols.iter().map(String::as_str).collect();
    let algebra = Amplitudes::new(Integers, &system.frequencies, &system.force, &names);
    let algebra = algebra.ok_or(ResonanceError::TooManySymbols { count: names.len() })?;
    let algebra = algebra.with_stop(settings.stop.clone());
    let graph = compile_system(&algebra, &system.equations, &Symbols(&algebra), settings.order)?;
    let sigma = |e: &Expression| {
        let refused = || ResonanceError::NotAForce { term: shown(e) };
        constant(&algebra, e, &|name| algebra.symbol(name)).ok_or_else(refused)
    };
    let detuning = system.detuning.iter().map(sigma).collect::<Result<Vec<_>, _>>()?;
    let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
    let found = resonant(&algebra, &graph, settings.order, &detuning, &mut on_order);
    let too_high = || Error::from(ResonanceError::TooHigh { order: settings.order });
    let found = found.map_err(|error| match error {
        ExpandError::Interrupted { .. } if algebra.overflowed() => too_high(),
        error => error.into(),
    })?;
    if algebra.overflowed() {
        return Err(too_high());
    }
    refuse_near_miss(&found.nearest)?;
    observer(Progress::Checking);
    let checked_orders = match check_flow(&algebra, &graph, &found) {
        Err(ExpandError::Interrupted { .. }) => None,
        other => Some(other?),
    };
    let terms = |f: &Element| algebra.rational_terms(f).unwrap_or_default();
    let mut flow: Vec<Vec<Terms>> =
        found.flow.iter().map(|list| list.iter().map(terms).collect()).collect();
    for (j, list) in flow.iter_mut().enumerate() {
        use lindstedt_algebra::AmplitudeAlgebra;
        list[0] = terms(&algebra.by_time(&algebra.amplitude(j)));
    }
    let solution = found.solution.iter().map(|list| list.iter().map(terms).collect()).collect();
    let detuning = found.detuning.iter().map(terms).collect();
    let order = found.order();
    Ok(SlowFlow { system, order, checked_orders, flow, solution, detuning, nearest: found.nearest })
}

/// A divisor below this says that a resonance was missed by a little.
const NEAR_MISS: (i32, i32) = (1, 1000);

fn refuse_near_miss(nearest: &[Nearest]) -> Result<(), ResonanceError> {
    let least = Rational::from(NEAR_MISS);
    match nearest.iter().find(|near| *near.size.as_abs() < least) {
        None => Ok(()),
        Some(near) => Err(ResonanceError::NearMiss {
            order: near.order,
            harmonic: near.harmonic.clone(),
            size: near.size.to_f64(),
        }),
    }
}

fn shown(e: &Expression) -> String {
    e.print("eps", Style::Text)
}
