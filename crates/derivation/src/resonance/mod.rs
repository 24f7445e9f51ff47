//! Averaging at resonance and of several unknowns: from equations to their slow flow, exact in the symbols.
//!
//!   x_j = z_j + zbar_j + the response to the force + sum eps^n u_{j,n}(z, zbar, E),   E = e^{i eta},
//!   z_j' = i nu_j z_j + sum eps^n f_{j,n}(z, zbar, E),   eta' = Omega + sum eps^n sigma_n
//!
//! (see [`lindstedt_expand::resonance`]), with E_1, E_2, ... for forces that are no harmonics of one phase. What the
//! frequencies nu_j depend on has a value, and so has the frequency of a force where it is no independent symbol;
//! squares of frequencies are rational, so that what is resonant is decided exactly: square roots are
//! independent of one another unless their ratio is rational. With irrational ones coefficients are
//! enclosed by balls. A linear part that couples the
//! unknowns is taken apart into modes x = P q, exactly where those are rational, else enclosed. A force beside a resonance is
//! detuned: with `cos((1 + eps*sigma)*t)` as it is written, and with a frequency that is a number by the
//! symbol sigma = (omega - Omega)/eps.

mod algebraic;
mod conserved;
mod delays;
mod enclosed;
mod error;
mod flow;
mod forces;
mod invariants;
mod json;
mod modes;
mod motion;
mod normal_mode;
mod parametric;
mod polar;
mod prepared;
mod print;
mod quotients;
mod separated;
mod sought;
mod system;
mod unit;

pub use algebraic::AlgebraicModes;
pub use error::ResonanceError;
pub use forces::Phase;
pub use invariants::QuadraticInvariant;
pub use motion::{Motion, Positions};
pub use normal_mode::{NormalMode, normal_mode};
pub use polar::{Polar, PolarTerm};
pub use print::{print_name, print_turns};
pub use sought::{Sought, SoughtBranch, sought};
pub use system::{Beside, Detuned, System};
pub use unit::Unit;

use crate::averaging::AveragingSettings;
use crate::error::DerivationError as Error;
use crate::limits::{check_delays, refuse_above, refuse_taken, unknown_parameter};
use crate::values::value;
use crate::work::Progress;
use lindstedt_algebra::NEAR_MISS;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::OrderWork;
use lindstedt_expand::resonance::Nearest;
use lindstedt_number::Exact;
use lindstedt_number::Whole;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm};
use rug::Rational;
use std::collections::BTreeMap;
use system::refuse_delays;

type Element = AmplitudeElement<Whole>;

/// A polynomial in z_1, zbar_1, ..., z_M, zbar_M, E_1, ..., E_L (one E = e^{i eta} where there is no force, too)
/// and the symbols, in this order of exponents; those of E_l may be negative, and those of the symbols that are
/// sums of rates.
pub type Terms = Vec<AmplitudeTerm>;

/// A slow flow that was substituted into its equations, as plain data.
///
/// ```
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::{Detuned, slow_flow}};
/// use lindstedt_problem_file::ProblemFile;
/// let text = "equation = \"x'' + x + eps*h*x*cos(2*t) = 0\"";
/// let problem = ProblemFile::parse(text)?.problem;
/// let settings = AveragingSettings::default();
/// let found = slow_flow(&problem, &settings, Detuned::Beside, &mut |_| true)?;
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
    /// sigma_{l,1}, sigma_{l,2}, ... at `[l]`.
    pub detuning: Vec<Vec<Terms>>,
    /// The smallest divisor of every order and unknown.
    pub nearest: Vec<Nearest>,
    /// Where the equations derive from a potential, but for terms of velocities that do no work together: the energy
    /// x' N x'/2 + V order by order, N regular, of any signature, with the first entry 1 or a polynomial in parameters by which others are divided,
    /// which was found to be conserved by the flow, identically. So it contains no fast phase. N is diagonal, unless it depends on
    /// parameters. Else empty.
    pub energy: Vec<Terms>,
    /// Where frequencies are irrational: what the coefficients are known within. Those given are in the middle.
    pub enclosed: Option<Enclosed>,
    /// Terms of f_{j,n} at `[j][n]` that cannot be told from zero and are not in `flow`: their coefficients, 0, are known
    /// within the same; empty where there are none.
    pub doubtful: Vec<Vec<Terms>>,
}

/// Enclosures of the coefficients of a slow flow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Enclosed {
    /// The largest radius of a coefficient.
    pub radius: f64,
    /// The residual of every order contains zero, and all its coefficients lie within this of it.
    pub residual: f64,
    /// Digits that are printed.
    pub digits: usize,
}

impl SlowFlow {
    /// M.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.system.frequencies.len()
    }

    /// L, at least 1: the exponents of phases.
    #[must_use]
    pub fn forces(&self) -> usize {
        self.system.forces.len().max(1)
    }

    /// The place of the first symbol among the exponents.
    #[must_use]
    pub fn first_symbol(&self) -> usize {
        2 * self.unknowns() + self.forces()
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
        let of = |name: &str, j: usize, count: usize| match count {
            1 => name.to_owned(),
            _ => format!("{name}_{}", j + 1),
        };
        let pair = |j| ["z", "zbar"].map(|name| of(name, j, self.unknowns()));
        let amplitudes = (0..self.unknowns()).flat_map(pair);
        let phases = (0..self.forces()).map(|l| of("E", l, self.forces()));
        amplitudes.chain(phases).chain(self.system.symbols.iter().cloned()).collect()
    }

    /// Whether what it is written with can be told from its symbols.
    ///
    /// # Errors
    /// [`Error::SymbolTaken`].
    pub fn check_names(&self) -> Result<(), Error> {
        let System { symbols, independent, shapes, .. } = &self.system;
        // In JSON the amplitudes are z1, zbar1, ..., the phases E1, ...
        let plain = |name: &str| match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
            "z" | "zbar" => Some("a complex amplitude"),
            "E" => Some("exp(i*eta) of a force"),
            _ => None,
        };
        refuse_taken(symbols.iter().chain(independent), |base, numbered| match base {
            "a" => Some("an amplitude"),
            "psi" => Some("a phase"),
            "eta" => Some("the phase of a force"),
            "gamma" => Some("the phase against a force"),
            "nu" => Some("a frequency of the linear oscillators"),
            "f" | "u" if numbered => Some("a coefficient"),
            "H" if numbered => Some("a coefficient of the energy"),
            "q" if numbered && shapes.is_some() => Some("a mode"),
            _ => plain(base),
        })
    }

    /// A divisor: of enclosures the middle of one, as a double.
    #[must_use]
    pub fn size(&self, q: &Rational) -> String {
        if self.system.is_exact() { q.to_string() } else { format!("{:.6}", q.to_f64()) }
    }

    /// k_1 nu_1 + ... + m_1 Omega_1 + ..., in words.
    #[must_use]
    pub fn harmonic(&self, near: &Nearest) -> String {
        sum_of_harmonics(&near.harmonic, self.system.forces.len())
    }

    /// The smallest divisor of all orders.
    #[must_use]
    pub fn nearest(&self) -> Option<&Nearest> {
        self.nearest.iter().min_by(|a, b| a.size.cmp_abs(&b.size))
    }
}

/// Whether a force of the problem, with these values, has a frequency beside a resonance: then
/// [`slow_flow`] takes it as detuned.
#[must_use]
pub fn is_beside(problem: &Problem, given: &BTreeMap<String, Exact>) -> bool {
    let equations: Vec<Expression> = problem.equations().cloned().collect();
    let cards = |name: &str| value(problem, given, name);
    let system = System::of(&equations, given, &cards, Names(problem), Detuned::Beside);
    system.is_ok_and(|system| system.beside.is_some())
}

/// The slow flow of a problem. Parameters of the equations that are not among those of the settings stay
/// symbols, unless a frequency depends on them: then they have the values of their cards.
///
/// Parameters without a value in the frequencies of forces are taken to be independent: coefficients are then
/// quotients by sums such as 1 - omega, which are factors of their own ([`System::symbols`]).
///
/// Exact; the residual of every order vanishes identically. Where a frequency is the root of a rational number the
/// coefficients are enclosed with the digits of the settings ([`SlowFlow::enclosed`]). Cost: O(N^2) products of polynomials whose
/// length grows like N^(symbols + 1).
///
/// # Errors
/// [`ResonanceError`] by name for what is no such system; [`ExpandError`](lindstedt_expand::ExpandError) for terms that are no polynomial.
///
/// ```
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::{Detuned, slow_flow}};
/// use lindstedt_problem_file::ProblemFile;
/// let text = "equation = \"x'' + x + eps*x^3 = eps*F*cos((1 + eps*sigma)*t)\"";
/// let problem = ProblemFile::parse(text)?.problem;
/// let settings = AveragingSettings::default();
/// let found = slow_flow(&problem, &settings, Detuned::Beside, &mut |_| true)?;
/// assert_eq!((found.checked_orders, found.flow[0][1].len()), (Some(2), 2));
/// // A force beside a resonance, as it is and detuned from that.
/// let text = "equation = \"x'' + x + eps*x^3 = eps*cos(6/5*t)\"";
/// let problem = ProblemFile::parse(text)?.problem;
/// let found = slow_flow(&problem, &settings, Detuned::Not, &mut |_| true)?;
/// assert!(found.system.beside.is_none() && found.system.force() == rug::Rational::from((6, 5)));
/// let found = slow_flow(&problem, &settings, Detuned::From(&1.into()), &mut |_| true)?;
/// assert_eq!((found.system.force(), &found.system.resonances_around()[0]), (1.into(), &1.into()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn slow_flow(
    problem: &Problem,
    settings: &AveragingSettings,
    detuned: Detuned<'_>,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<SlowFlow, Error> {
    let card = |name: &str| problem.parameters.iter().any(|card| card.name == *name);
    let known = |name: &String| card(name) || **name == *problem.small;
    if let Some(name) = settings.parameters.keys().find(|name| !known(name)) {
        return Err(unknown_parameter(problem, name));
    }
    let equations: Vec<Expression> = problem.equations().cloned().collect();
    let tied = problem.synchronous.as_ref().map(|tie| tie.delay.to_string());
    if tied.is_some_and(|name| equations.iter().any(|e| e.parameters().contains(&name))) {
        refuse_delays(&equations, Names(problem))?;
    }
    equations.iter().try_for_each(|e| check_delays(e, &settings.parameters))?;
    let cards = |name: &str| value(problem, &settings.parameters, name);
    let system = System::of(&equations, &settings.parameters, &cards, Names(problem), detuned)?;
    let mut job = flow::Job { problem, system, settings };
    if !job.system.is_exact() {
        return enclosed::derived(&job, observer);
    }
    let flow = if job.system.independent.is_empty() {
        job.system.symbols.extend(job.system.unit.iter().map(|unit| unit.name.clone()));
        job.rational(observer)?
    } else {
        quotients::derived(&job, observer)?
    };
    Ok(flow.with_root())
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

/// The terms of a sum that do not vanish.
fn collected(sum: impl IntoIterator<Item = (Vec<i32>, [Rational; 2])>) -> Terms {
    let kept = sum.into_iter().filter(|(_, c)| !c.iter().all(Rational::is_zero));
    kept.map(|(exponents, [re, im])| AmplitudeTerm { exponents, re, im }).collect()
}

fn refuse_near_miss(nearest: &[Nearest], forces: usize) -> Result<(), ResonanceError> {
    let least = Rational::from(NEAR_MISS);
    match nearest.iter().find(|near| *near.size.as_abs() < least) {
        None => Ok(()),
        Some(near) => Err(ResonanceError::NearMiss {
            order: near.order,
            harmonic: sum_of_harmonics(&near.harmonic, forces),
            size: near.size.to_f64(),
        }),
    }
}

/// k_1 nu_1 + ... + m_1 Omega_1 + ..., in words.
fn sum_of_harmonics(harmonic: &[i32], forces: usize) -> String {
    let unknowns = harmonic.len().saturating_sub(forces);
    let name = |j: usize| match j.checked_sub(unknowns) {
        None => format!("nu_{}", j + 1),
        Some(_) if forces == 1 => "Omega".to_owned(),
        Some(l) => format!("Omega_{}", l + 1),
    };
    let term = |(j, k): (usize, &i32)| lindstedt_coeff::print::Term {
        coefficient: Rational::from(*k),
        factors: vec![name(j)],
    };
    let terms = harmonic.iter().enumerate().filter(|(_, k)| **k != 0).map(term);
    lindstedt_coeff::print::print_sum(&terms.collect::<Vec<_>>(), Style::Text)
}

/// The names of the user.
#[derive(Clone, Copy)]
struct Names<'a>(&'a Problem);

impl Names<'_> {
    fn is_unknown(self, name: &str) -> bool {
        (0..=self.0.others.len()).any(|j| self.0.unknown(j) == name)
    }

    fn shown(self, e: &Expression) -> String {
        e.print_named(&self.0.small, &self.0.unknowns, Style::Text)
    }
}
