//! The parameter for which the motion of a forced oscillator stays periodic, order by order: the edges of
//! the tongues of Mathieu's and Hill's equations.
//!
//!   x'' + a x + eps (...) = 0,   a = a_0 + eps a_1 + ...,   a_0 = nu^2 the value given,
//!   x = A cos(nu t) + ... or A sin(nu t) + ...,   no correction with the frequency nu,
//!
//! nu and the force's frequency being whole multiples of one frequency. Each of the two motions has its a; at
//! even and odd ones of Mathieu's equation they are a_m(q) and b_m(q) (DLMF 28.6).

use super::flow::{Symbols, compiled_form};
use super::forces::divisor;
use super::modes::modes_refused;
use super::print::print_powers;
use super::system::refuse_delays;
use super::{Element, Names, ResonanceError, System, Terms};
use crate::averaging::{AveragingSettings, constant};
use crate::error::DerivationError as Error;
use crate::limits::refuse_taken;
use crate::values::value;
use crate::work::Progress;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::print::{Style, Term, print_sum};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::resonance::{check_flow, periodic};
use lindstedt_expand::{Binding, ExpandError, OrderWork, compile_system};
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeTerm, Amplitudes};
use rug::Rational;

/// A parameter as a series, for every motion that stays periodic.
///
/// ```
/// use lindstedt_coeff::print::Style;
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::sought};
/// use lindstedt_problem_file::ProblemFile;
/// let text = "equation = \"x'' + (a - 2*eps*cos(2*t))*x = 0\"\n[parameters]\na = { value = \"1\" }";
/// let problem = ProblemFile::parse(text)?.problem;
/// let found = sought(&problem, "a", &AveragingSettings::default(), &mut |_| true)?;
/// // a_1 = 1 + q - q^2/8 - ..., b_1 = 1 - q - q^2/8 + ...
/// let series: Vec<_> = found.branches.iter().map(|b| found.print_series(b, Style::Text)).collect();
/// assert_eq!(series, ["1 + eps - 1/8*eps^2", "1 - eps - 1/8*eps^2"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Sought {
    /// The problem.
    pub problem: Problem,
    /// The name of the parameter.
    pub parameter: String,
    /// nu.
    pub frequency: Rational,
    /// The frequency of which nu and the force's are whole multiples.
    pub base: Rational,
    /// Names without a value.
    pub symbols: Vec<String>,
    /// The orders asked for.
    pub order: usize,
    /// The motions: of the cosine, of the sine; one where there is no force.
    pub branches: Vec<SoughtBranch>,
}

/// One motion and the series of the parameter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SoughtBranch {
    /// Whether x begins with the sine.
    pub sine: bool,
    /// a_0, a_1, ...: polynomials in the symbols.
    pub series: Vec<Terms>,
    /// x_0, x_1, ...: the exponent of E is the harmonic of the base frequency.
    pub solution: Vec<Terms>,
    /// Orders 0..=this leave no residual; nothing where there was no time to check.
    pub checked_orders: Option<usize>,
}

impl SoughtBranch {
    /// The highest order derived.
    #[must_use]
    pub fn order(&self) -> usize {
        self.series.len().saturating_sub(1)
    }
}

/// Parameters by name, one of which is sought.
struct Seeking<'a>(Symbols<'a, Integers>, &'a str);

impl Binding<Amplitudes<Integers>> for Seeking<'_> {
    fn parameter(&self, name: &str) -> Option<Element> {
        self.0.parameter(name)
    }
    fn formal(&self, name: &str, n: usize) -> Option<Element> {
        self.0.formal(name, n)
    }
    fn is_sought(&self, name: &str) -> bool {
        name == self.1
    }
}

/// The parameter `name` for which the motion of frequency nu = sqrt(a_0) stays periodic; a_0 is its value
/// among the settings or on its card. The amplitude A is the value of `amplitude`, else 1; other parameters
/// as for [`super::slow_flow`].
///
/// Exact; every order is substituted back. Cost: for Mathieu's equation O(N^3) products of numbers.
///
/// # Errors
/// [`ResonanceError`] for what is no such system; [`ExpandError::NotBalanced`] where no value keeps one of
/// the motions periodic; [`Error::SymbolTaken`] for a symbol named like one of the orders, x_1.
pub fn sought(
    problem: &Problem,
    name: &str,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Sought, Error> {
    let (start, equation) = beginning(problem, name, settings)?;
    let mut given = settings.parameters.clone();
    given.remove(name);
    let amplitude = given.remove("amplitude");
    let amplitude = amplitude.and_then(|a| a.as_rational().cloned()).unwrap_or_else(|| 1.into());
    let cards = |known: &str| value(problem, &given, known).filter(|_| known != name);
    let equations = [equation];
    refuse_delays(&equations, Names(problem))?;
    let system = System::of(&equations, &given, &cards, Names(problem), false)?;
    if let Some(name) = system.open_frequency() {
        let problem = problem.name.to_string();
        return Err(Error::Unset { problem, name: name.clone() });
    }
    if !system.is_exact() || system.unit.is_some() {
        return Err(modes_refused(&system.plain_squares()).into());
    }
    if system.forces.len() > 1 {
        return Err(ResonanceError::SecondPhase { phases: system.forces.len() }.into());
    }
    let frequency = system.frequencies.first().cloned().unwrap_or_default();
    let base = divisor(&frequency, &system.force());
    let whole = |rate: &Rational| {
        let high = ResonanceError::TooHigh { order: settings.order, largest: i32::MAX };
        Rational::from(rate / &base).numer().to_i32().ok_or(high)
    };
    let (harmonic, step) = (whole(&frequency)?, whole(&system.force())?);
    let symbols: Vec<String> =
        system.symbols.iter().filter(|known| *known != name).cloned().collect();
    refuse_taken(&symbols, |base, numbered| (numbered && base == "x").then_some("a coefficient"))?;
    let names: Vec<&str> = symbols.iter().map(String::as_str).collect();
    let algebra = Amplitudes::new(Integers, &system.frequencies, &base, &names);
    let algebra = algebra.ok_or(ResonanceError::TooManySymbols { count: names.len() })?;
    let algebra = algebra.with_stop(settings.stop.clone());
    let mut found = Sought {
        problem: problem.clone(),
        parameter: name.to_owned(),
        frequency,
        base,
        symbols,
        order: settings.order,
        branches: Vec::new(),
    };
    let task = Task {
        algebra: &algebra,
        system: &system,
        settings,
        start: &start,
        name,
        step,
        names: Names(problem),
    };
    let mut refused = None;
    for sine in [false, true].into_iter().take(if step == 0 { 1 } else { 2 }) {
        let (order, largest) = (settings.order, algebra.largest_exponent());
        let high = ResonanceError::TooHigh { order, largest };
        let [cos, sin] = algebra.wave(0, harmonic).ok_or(high)?;
        let generating = algebra.scale(if sine { &sin } else { &cos }, &amplitude);
        match task.branch(sine, generating, observer) {
            Ok(branch) => found.branches.push(branch),
            Err(error @ Error::Expand(ExpandError::NotBalanced { .. })) => refused = Some(error),
            Err(error) => return Err(error),
        }
    }
    match refused {
        Some(error) if found.branches.is_empty() => Err(error),
        _ => Ok(found),
    }
}

/// a_0, and the equation with a_0 + eps a in the place of a.
fn beginning(
    problem: &Problem,
    name: &str,
    settings: &AveragingSettings,
) -> Result<(Rational, Expression), Error> {
    if !problem.others.is_empty() {
        let unknowns = 1 + problem.others.len();
        return Err(ResonanceError::SoughtOfSeveral { unknowns }.into());
    }
    if !problem.equation.parameters().iter().any(|known| known == name) {
        return Err(ResonanceError::NotSought { name: name.to_owned() }.into());
    }
    let unset = || Error::Unset { problem: problem.name.to_string(), name: name.to_owned() };
    let start = value(problem, &settings.parameters, name).ok_or_else(unset)?;
    let irrational = || Error::Irrational { name: name.to_owned(), value: start.to_string() };
    let start = start.as_rational().ok_or_else(irrational)?.clone();
    let around = |e: &Expression| match e {
        Expression::Parameter(known) if known == name => Some(
            Expression::Number(start.clone()) + Expression::Small * Expression::parameter(name),
        ),
        _ => None,
    };
    let equation = problem.equation.substitute(&around).canonical();
    Ok((start, equation))
}

struct Task<'a> {
    algebra: &'a Amplitudes<Integers>,
    system: &'a System,
    settings: &'a AveragingSettings,
    start: &'a Rational,
    name: &'a str,
    step: i32,
    names: Names<'a>,
}

impl Task<'_> {
    fn branch(
        &self,
        sine: bool,
        generating: Element,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<SoughtBranch, Error> {
        let (algebra, order) = (self.algebra, self.settings.order);
        let symbols = Symbols { algebra, step: self.step.max(1), other: &|_| None };
        let binding = Seeking(symbols, self.name);
        let graph = compile_system(algebra, &compiled_form(self.system), &binding, order)?;
        // The phase of the force turns `step` times as fast as that of the algebra.
        let scale = Rational::from((1, self.step.max(1)));
        let sigma = |e: &Expression| {
            let refused = || ResonanceError::NotAForce { term: self.names.shown(e) };
            let sigma = constant(algebra, e, &|name| algebra.symbol(name)).ok_or_else(refused)?;
            Ok::<_, ResonanceError>(algebra.scale(&sigma, &scale))
        };
        let forces = self.system.forces.iter();
        let list = |phase: &super::Phase| phase.detuning.iter().map(sigma).collect();
        let detuning = forces.map(list).collect::<Result<Vec<Vec<_>>, _>>()?;
        let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
        let found = periodic(algebra, &graph, order, &detuning, vec![generating], &mut on_order)?;
        if algebra.overflowed() {
            let largest = algebra.largest_exponent();
            return Err(ResonanceError::TooHigh { order, largest }.into());
        }
        observer(Progress::Checking);
        let checked_orders = match check_flow(algebra, &graph, &found) {
            _ if self.settings.stop.asked() => None,
            Err(ExpandError::Interrupted { .. }) => None,
            other => Some(other?),
        };
        let terms = |f: &Element| algebra.rational_terms(f).unwrap_or_default();
        let start = algebra.rational(self.start);
        Ok(SoughtBranch {
            sine,
            series: std::iter::once(&start).chain(&found.parameter).map(terms).collect(),
            solution: found.solution.iter().flatten().map(terms).collect(),
            checked_orders,
        })
    }
}

impl Sought {
    /// The exponents of the symbols behind those of z, zbar and E.
    fn symbols_of(&self, exponents: &[i32], style: Style) -> Vec<String> {
        super::print::factors(&self.symbols, exponents.get(3..).unwrap_or_default(), style)
    }

    /// One coefficient of the series.
    fn terms(&self, terms: &Terms, style: Style) -> Vec<Term> {
        let term = |term: &AmplitudeTerm| Term {
            coefficient: term.re.clone(),
            factors: self.symbols_of(&term.exponents, style),
        };
        terms.iter().map(term).collect()
    }

    /// a_n.
    #[must_use]
    pub fn print_coefficient(&self, terms: &Terms, style: Style) -> String {
        print_sum(&self.terms(terms, style), style)
    }

    /// a_0 + a_1 eps + ...
    #[must_use]
    pub fn print_series(&self, branch: &SoughtBranch, style: Style) -> String {
        let small = super::print_name(&self.problem.small, style);
        print_powers(&branch.series, &small, style, &|terms| self.terms(terms, style))
    }

    /// x_n as a sum of cosines and sines of t.
    #[must_use]
    pub fn print_motion(&self, terms: &Terms, style: Style) -> String {
        let mut sum = Vec::new();
        for term in terms.iter().filter(|term| term.exponents[2] >= 0) {
            let m = term.exponents[2];
            let twice = Rational::from(if m == 0 { 1 } else { 2 });
            // c E^m + conj = 2 Re c cos - 2 Im c sin.
            let parts = [("cos", term.re.clone()), ("sin", -term.im.clone())];
            for (function, c) in parts.into_iter().filter(|(_, c)| !c.is_zero()) {
                let mut factors = self.symbols_of(&term.exponents, style);
                if m != 0 {
                    let rate = Rational::from(&self.base * m);
                    let angle = Term { coefficient: rate, factors: vec!["t".to_owned()] };
                    let angle = print_sum(&[angle], style);
                    let backslash = if style == Style::Latex { r"\" } else { "" };
                    factors.push(format!("{backslash}{function}({angle})"));
                }
                sum.push(Term { coefficient: c * &twice, factors });
            }
        }
        print_sum(&sum, style)
    }
}
