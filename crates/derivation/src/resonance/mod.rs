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
mod json;
mod modes;
mod motion;
mod normal_mode;
mod polar;
mod print;
mod sought;
mod system;

pub use error::ResonanceError;
pub use motion::Motion;
pub use normal_mode::{NormalMode, normal_mode};
pub use polar::{Polar, PolarTerm};
pub use print::{print_name, print_turns};
pub use sought::{Sought, SoughtBranch, sought};
pub use system::{Beside, System};

use crate::averaging::{AveragingSettings, constant};
use crate::error::DerivationError as Error;
use crate::limits::{refuse_above, unknown_parameter};
use crate::values::value;
use crate::work::Progress;
use lindstedt_algebra::AmplitudeAlgebra;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::resonance::{Nearest, check_flow, resonant};
use lindstedt_expand::{Binding, ExpandError, OrderWork, compile_system};
use lindstedt_number::Exact;
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm, Amplitudes};
use rug::{Integer, Rational};
use std::collections::BTreeMap;

type Element = AmplitudeElement<Integer>;

/// A polynomial in z_1, zbar_1, ..., z_M, zbar_M, E = e^{i eta} and the symbols, in this order of
/// exponents; that of E may be negative.
pub type Terms = Vec<AmplitudeTerm>;

/// A slow flow that was substituted into its equations, as plain data.
///
/// ```
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::slow_flow};
/// use lindstedt_problem_file::ProblemFile;
/// let text = "equation = \"x'' + x + eps*h*x*cos(2*t) = 0\"";
/// let problem = ProblemFile::parse(text)?.problem;
/// let found = slow_flow(&problem, &AveragingSettings::default(), &mut |_| true)?;
/// // f_1 = (i/4) h zbar E: exponents of z, zbar, E, h.
/// let [term] = &found.flow[0][1][..] else { panic!("one term") };
/// assert_eq!((&term.exponents[..], term.im.to_string().as_str()), (&[0, 1, 1, 1][..], "1/4"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlowFlow {
    /// The problem.
    pub problem: Problem,
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

    /// The names of the x_j: those of the unknowns, or q_1, q_2, ... of the modes.
    #[must_use]
    pub fn coordinates(&self) -> Vec<String> {
        let mode = |j| format!("q_{}", j + 1);
        match (&self.system.shapes, self.unknowns()) {
            (Some(_), n) => (0..n).map(mode).collect(),
            (None, n) => (0..n).map(|j| self.problem.unknown(j)).collect(),
        }
    }

    /// The names of the factors of a monomial, in the order of its exponents.
    #[must_use]
    pub fn factors(&self) -> Vec<String> {
        let index = |j| if self.unknowns() == 1 { String::new() } else { format!("_{}", j + 1) };
        let pair = |j| ["z", "zbar"].map(|name| format!("{name}{}", index(j)));
        let amplitudes = (0..self.unknowns()).flat_map(pair);
        amplitudes.chain(["E".to_owned()]).chain(self.system.symbols.iter().cloned()).collect()
    }

    /// The smallest divisor of all orders.
    #[must_use]
    pub fn nearest(&self) -> Option<&Nearest> {
        self.nearest.iter().min_by(|a, b| a.size.cmp_abs(&b.size))
    }
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

/// Whether a force of the problem, with these values, has a frequency beside a resonance: then
/// [`slow_flow`] takes it as detuned.
#[must_use]
pub fn is_beside(problem: &Problem, given: &BTreeMap<String, Exact>) -> bool {
    let equations: Vec<Expression> = problem.equations().cloned().collect();
    let cards = |name: &str| value(problem, given, name);
    let system = System::of(&equations, given, &cards, Names(problem), true);
    system.is_ok_and(|system| system.beside.is_some())
}

/// The slow flow of a problem. Parameters of the equations that are not among those of the settings stay
/// symbols, unless a frequency depends on them: then they have the values of their cards.
///
/// Exact; the residual of every order vanishes identically. Cost: O(N^2) products of polynomials whose
/// length grows like N^(symbols + 1).
///
/// # Errors
/// [`ResonanceError`] by name for what is no such system; [`ExpandError`] for terms that are no polynomial.
///
/// ```
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::slow_flow};
/// use lindstedt_problem_file::ProblemFile;
/// let text = "equation = \"x'' + x + eps*x^3 = eps*F*cos((1 + eps*sigma)*t)\"";
/// let problem = ProblemFile::parse(text)?.problem;
/// let found = slow_flow(&problem, &AveragingSettings::default(), &mut |_| true)?;
/// assert_eq!((found.checked_orders, found.flow[0][1].len()), (Some(2), 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn slow_flow(
    problem: &Problem,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<SlowFlow, Error> {
    let card = |name: &str| problem.parameters.iter().any(|card| card.name == *name);
    let known = |name: &String| card(name) || **name == *problem.small;
    if let Some(name) = settings.parameters.keys().find(|name| !known(name)) {
        return Err(unknown_parameter(problem, name));
    }
    let equations: Vec<Expression> = problem.equations().cloned().collect();
    let cards = |name: &str| value(problem, &settings.parameters, name);
    let system = System::of(&equations, &settings.parameters, &cards, Names(problem), true)?;
    let names: Vec<&str> = system.symbols.iter().map(String::as_str).collect();
    let algebra = Amplitudes::new(Integers, &system.frequencies, &system.force, &names);
    let algebra = algebra.ok_or(ResonanceError::TooManySymbols { count: names.len() })?;
    let algebra = algebra.with_stop(settings.stop.clone());
    let graph = compile_system(&algebra, &system.equations, &Symbols(&algebra), settings.order)?;
    let sigma = |e: &Expression| {
        let refused = || ResonanceError::NotAForce { term: Names(problem).shown(e) };
        constant(&algebra, e, &|name| algebra.symbol(name)).ok_or_else(refused)
    };
    let detuning = system.detuning.iter().map(sigma).collect::<Result<Vec<_>, _>>()?;
    let mut room = Room::new(settings);
    let mut on_order =
        |work: &OrderWork| observer(Progress::Order(work.order, work.terms)) && room.has_next(work);
    let found = resonant(&algebra, &graph, settings.order, &detuning, &mut on_order);
    room.checked?;
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
    let checked = check_flow(&algebra, &graph, &found);
    let checked_orders = match checked {
        // What was multiplied after the work was stopped means nothing, for better or worse.
        _ if settings.stop.asked() => None,
        Err(ExpandError::Interrupted { .. }) => None,
        other => Some(other?),
    };
    let terms = |f: &Element| algebra.rational_terms(f).unwrap_or_default();
    let mut flow: Vec<Vec<Terms>> =
        found.flow.iter().map(|list| list.iter().map(terms).collect()).collect();
    for (j, list) in flow.iter_mut().enumerate() {
        list[0] = terms(&algebra.by_time(&algebra.amplitude(j)));
    }
    let solution = found.solution.iter().map(|list| list.iter().map(terms).collect()).collect();
    let detuning = found.detuning.iter().map(terms).collect();
    let order = found.order();
    let problem = problem.clone();
    Ok(SlowFlow {
        problem,
        system,
        order,
        checked_orders,
        flow,
        solution,
        detuning,
        nearest: found.nearest,
    })
}

/// What the next order is predicted to need, from the terms of those before it.
struct Room {
    bytes: f64,
    last: f64,
    order: usize,
    limit: u64,
    checked: Result<(), Error>,
}

/// Bytes held for one term of the motion, a rule of thumb: a word, two integers of some limbs, and those again
/// for the rates, the nodes of the equation and the products in progress.
const BYTES: f64 = 7000.0;

impl Room {
    fn new(settings: &AveragingSettings) -> Self {
        let (limit, order) = (settings.memory, settings.order);
        Self { bytes: 0.0, last: 0.0, order, limit, checked: Ok(()) }
    }

    fn has_next(&mut self, work: &OrderWork) -> bool {
        let now = work.terms as f64 * BYTES;
        let growth = if self.last > 0.0 { now / self.last } else { 1.0 };
        self.bytes += now;
        self.last = now;
        let next = self.bytes + now * growth;
        if work.order < self.order {
            self.checked = refuse_above(self.limit, work.order + 1, next.log2());
        }
        self.checked.is_ok()
    }
}

/// A divisor below this says that a resonance was missed by a little.
const NEAR_MISS: (i32, i32) = (1, 1000);

fn refuse_near_miss(nearest: &[Nearest]) -> Result<(), ResonanceError> {
    let least = Rational::from(NEAR_MISS);
    match nearest.iter().find(|near| *near.size.as_abs() < least) {
        None => Ok(()),
        Some(near) => Err(ResonanceError::NearMiss {
            order: near.order,
            harmonic: sum_of_harmonics(&near.harmonic),
            size: near.size.to_f64(),
        }),
    }
}

/// k_1 nu_1 + ... + m Omega, in words.
fn sum_of_harmonics(harmonic: &[i32]) -> String {
    let last = harmonic.len() - 1;
    let term = |(j, k): (usize, &i32)| lindstedt_coeff::print::Term {
        coefficient: Rational::from(*k),
        factors: vec![if j == last { "Omega".to_owned() } else { format!("nu_{}", j + 1) }],
    };
    let terms = harmonic.iter().enumerate().filter(|(_, k)| **k != 0).map(term);
    lindstedt_coeff::print::print_sum(
        &terms.collect::<Vec<_>>(),
        lindstedt_coeff::print::Style::Text,
    )
}

/// The names of the user.
#[derive(Clone, Copy)]
struct Names<'a>(&'a Problem);

impl Names<'_> {
    fn shown(self, e: &Expression) -> String {
        e.print_named(&self.0.small, &self.0.unknowns, Style::Text)
    }
}
