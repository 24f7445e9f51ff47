//! The parameter for which the motion of a forced oscillator stays periodic, order by order: the edges of
//! the tongues of Mathieu's and Hill's equations.
//!
//!   x'' + a x + eps (...) = 0,   a = a_0 + eps a_1 + ...,   a_0 = nu^2 the value given,
//!   x = A cos(nu t) + ... or A sin(nu t) + ... or a mixture of both ([`start`]), corrections of frequency nu
//!   only beside it,
//!
//! nu and the force's frequency being whole multiples of one frequency. Each of the motions has its a; at
//! even and odd ones of Mathieu's equation they are a_m(q) and b_m(q) (DLMF 28.6).

mod start;

use super::flow::{Symbols, compiled, wave_of};
use super::forces::is_wave;
use super::print::print_powers;
use super::system::{Detuned, refuse_delays};
use super::{Element, Names, ResonanceError, System, Terms};
use crate::averaging::AveragingSettings;
use crate::error::DerivationError as Error;
use crate::limits::refuse_taken;
use crate::values::value;
use crate::work::Progress;
use lindstedt_algebra::{RationalAlgebra, Ring, common_measure};
use lindstedt_coeff::constant;
use lindstedt_coeff::print::{Style, Term, print_sum};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::resonance::{check_flow, periodic, resonant};
use lindstedt_expand::{Binding, ExpandError, OrderWork};
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeTerm, Amplitudes};
use rug::Rational;
use start::{Complex, Search, Start, Starts, is_linear, may_choose, power};

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
    /// The motions: where the force does not choose, of the cosine and of the sine; one where there is no force.
    pub branches: Vec<SoughtBranch>,
    /// Whether no other mixture of cosine and sine starts a periodic motion; where the condition has several harmonics, only
    /// the cosine and the sine with either sign are tried.
    pub all: bool,
}

/// One motion and the series of the parameter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SoughtBranch {
    /// How x begins, c cos(nu t) + s sin(nu t) with c^2 + s^2 = 1; of a linear equation any multiple of it.
    pub start: [Rational; 2],
    /// The time of the equation at which that of the motion is 0.
    pub origin: String,
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
        self.solution.len().saturating_sub(1)
    }

    /// Whether corrections have a part of the frequency of x_0.
    #[must_use]
    pub fn turns(&self) -> bool {
        let motion = |terms: &Terms| -> Vec<i32> { terms.iter().map(|t| t.exponents[2]).collect() };
        let own = self.solution.first().map(motion).unwrap_or_default();
        self.solution.iter().skip(1).any(|terms| motion(terms).iter().any(|m| own.contains(m)))
    }

    /// cos, sin, or c*cos + s*sin.
    #[must_use]
    pub fn starts_with(&self) -> String {
        let part = |(c, name): (&Rational, &str)| Term {
            coefficient: c.clone(),
            factors: vec![name.to_owned()],
        };
        let parts = self.start.iter().zip(["cos", "sin"]).filter(|(c, _)| !c.is_zero());
        print_sum(&parts.map(part).collect::<Vec<_>>(), Style::Text)
    }
}

/// Parameters by name, one of which is sought, and e^{i eta} turned.
struct Seeking<'a>(Symbols<'a, Integers>, &'a str, &'a Complex);

impl Binding<Amplitudes<Integers>> for Seeking<'_> {
    fn parameter(&self, name: &str) -> Option<Element> {
        let own = self.0.parameter(name)?;
        let Some((l, m, sine)) = wave_of(name) else { return Some(own) };
        // cos(m eta + phi) = cos phi cos(m eta) - sin phi sin(m eta), and so the sine.
        let [cos, sin] = power(self.2, m);
        let algebra = self.0.algebra;
        let [wave, other] = algebra.wave(l, m.checked_mul(self.0.step)?)?;
        let (other, sin) = if sine { (wave, sin) } else { (other, -sin) };
        Some(algebra.add(&algebra.scale(&own, &cos), &algebra.scale(&other, &sin)))
    }
    fn is_sought(&self, name: &str) -> bool {
        name == self.1
    }
}

/// The parameter `name` for which the motion of frequency nu stays periodic; where it occurs at order zero, it starts from
/// its value among the settings or on its card, else from what order one says. The amplitude A is the value of `amplitude`, else 1; other parameters
/// as for [`super::slow_flow`].
///
/// Exact; every order is substituted back. Cost: for Mathieu's equation O(N^3) products of numbers.
///
/// # Errors
/// [`ResonanceError`] for what is no such system; [`ResonanceError::NotBalanced`] where no value keeps a motion of this amplitude
/// periodic; [`Error::SymbolTaken`] for a symbol named like one of the orders, x_1.
pub fn sought(
    problem: &Problem,
    name: &str,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Sought, Error> {
    let amplitude = settings.parameters.get("amplitude").and_then(|a| a.as_rational().cloned());
    let amplitude = amplitude.unwrap_or_else(|| 1.into());
    let found = sought_at(&amplitude, problem, name, settings, observer);
    found.map_err(|error| match error {
        Error::Expand(ExpandError::NotBalanced { order }) => {
            ResonanceError::NotBalanced { order, amplitude }.into()
        }
        error => error,
    })
}

fn sought_at(
    amplitude: &Rational,
    problem: &Problem,
    name: &str,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Sought, Error> {
    let occurs = |e: &Expression| e.parameters().iter().any(|known| known == name);
    if problem.equation.nodes().any(|e| is_wave(e) && occurs(e)) {
        return Err(ResonanceError::SoughtFrequency { name: name.to_owned() }.into());
    }
    let (start, equation) = beginning(problem, name, settings)?;
    let mut given = settings.parameters.clone();
    given.remove(name);
    given.remove("amplitude");
    let cards = |known: &str| value(problem, &given, known).filter(|_| known != name);
    let equations = [equation];
    refuse_delays(&equations, Names(problem))?;
    let system = System::of(&equations, &given, &cards, Names(problem), Detuned::Not)?;
    if let Some(name) = system.open_frequency() {
        return Err(Error::without_value(problem, name));
    }
    if !system.is_exact() || system.unit.is_some() {
        let squares: Vec<String> = system.plain_squares().iter().map(ToString::to_string).collect();
        let (squares, unit) = (squares.join(", "), system.unit.map(|unit| unit.name));
        return Err(ResonanceError::SoughtOfRoots { squares, unit }.into());
    }
    if system.forces.len() > 1 {
        return Err(ResonanceError::SecondPhase { phases: system.forces.len() }.into());
    }
    let frequency = system.frequencies.first().cloned().unwrap_or_default();
    let base = common_measure(&frequency, &system.force());
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
    let no_room =
        || ResonanceError::no_room(&system.frequencies, &[vec![base.clone()]], names.len());
    let algebra = algebra.ok_or_else(no_room)?;
    let algebra = algebra.with_stop(settings.stop.clone());
    let mut found = Sought {
        problem: problem.clone(),
        parameter: name.to_owned(),
        frequency,
        base: base.clone(),
        symbols,
        order: settings.order,
        branches: Vec::new(),
        all: true,
    };
    let task = Task {
        algebra: &algebra,
        system: &system,
        settings,
        start: start.as_ref(),
        name,
        step,
        base: &base,
        names: Names(problem),
    };
    let (order, largest) = (settings.order, algebra.largest_exponent());
    let Starts { list, order: decided, all } = task.starts(harmonic, amplitude, observer)?;
    found.all = all;
    for start in list {
        let wave = algebra.wave(0, harmonic);
        let [cos, sin] = wave.ok_or(ResonanceError::TooHigh { order, largest })?;
        let [re, im] = start.direction.each_ref().map(|part| Rational::from(part * amplitude));
        let generating = algebra.sub(&algebra.scale(&cos, &re), &algebra.scale(&sin, &im));
        found.branches.push(task.branch(start, generating, observer).map_err(
            |error| match error {
                Error::Expand(ExpandError::NotBalanced { order }) if decided > 1 => {
                    ResonanceError::Turns { order, decided }.into()
                }
                error => error,
            },
        )?);
    }
    Ok(found)
}

/// a_0, and the equation with a_0 + eps a in the place of a; the equation as it is where eps is a factor of a.
fn beginning(
    problem: &Problem,
    name: &str,
    settings: &AveragingSettings,
) -> Result<(Option<Rational>, Expression), Error> {
    if !problem.others.is_empty() {
        let unknowns = 1 + problem.others.len();
        return Err(ResonanceError::SoughtOfSeveral { unknowns }.into());
    }
    if !problem.equation.parameters().iter().any(|known| known == name) {
        return Err(ResonanceError::NotSought { name: name.to_owned() }.into());
    }
    let small = |e: &Expression| matches!(e, Expression::Small).then(|| 0.into());
    if !problem.equation.map(&small).canonical().parameters().iter().any(|known| known == name) {
        return Ok((None, problem.equation.clone()));
    }
    let unset = || ResonanceError::NoStart { name: name.to_owned() };
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
    Ok((Some(start), equation))
}

struct Task<'a> {
    algebra: &'a Amplitudes<Integers>,
    system: &'a System,
    settings: &'a AveragingSettings,
    start: Option<&'a Rational>,
    name: &'a str,
    step: i32,
    base: &'a Rational,
    names: Names<'a>,
}

impl Task<'_> {
    /// The directions and turns of the motions, and the order that fixes them; [`start`].
    fn starts(
        &self,
        harmonic: i32,
        amplitude: &Rational,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Starts, Error> {
        if self.step == 0 {
            let list = Start::symmetric().into_iter().take(1).collect();
            return Ok(Starts { list, order: 1, all: true });
        }
        let chosen = |e: &Expression| may_choose(e, self.settings.order, [harmonic, self.step]);
        if !self.system.equations.iter().any(chosen) {
            return Ok(Starts { list: Start::symmetric(), order: 1, all: true });
        }
        let names: Vec<&str> = self.system.symbols.iter().map(String::as_str).collect();
        let algebra = Amplitudes::new(Integers, &self.system.frequencies, self.base, &names);
        let base = || [vec![self.base.clone()]];
        let no_room = || ResonanceError::no_room(&self.system.frequencies, &base(), names.len());
        let algebra = algebra.ok_or_else(no_room)?;
        let algebra = algebra.with_stop(self.settings.stop.clone());
        let symbols = Symbols { algebra: &algebra, step: self.step, other: &|_| None };
        let system = (self.system, self.names);
        let detuning = self.detuning(&algebra)?;
        let place = names.iter().position(|name| *name == self.name).unwrap_or_default();
        let mut flow = |order| {
            let graph = compiled(&algebra, system, &symbols, order)?;
            let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
            let found = resonant(&algebra, &graph, order, &detuning, &mut on_order)?;
            let terms = |f: &Element| algebra.rational_terms(f).unwrap_or_default();
            Ok(found.flow.iter().flatten().map(terms).collect())
        };
        let mut search = Search {
            flow: &mut flow,
            linear: self.system.equations.iter().all(is_linear),
            symbols: (names.len(), place),
            amplitude,
            multiples: [harmonic, self.step],
            name: &|n| format!("{}_{}", self.name, if self.start.is_some() { n } else { n - 1 }),
        };
        search.starts(self.settings.order)
    }

    fn detuning(
        &self,
        algebra: &Amplitudes<Integers>,
    ) -> Result<Vec<Vec<Element>>, ResonanceError> {
        // The phase of the force turns `step` times as fast as that of the algebra.
        let scale = Rational::from((1, self.step.max(1)));
        let sigma = |e: &Expression| {
            let refused = || ResonanceError::NotAForce { term: self.names.shown(e) };
            let sigma = constant(algebra, e, &|name| algebra.symbol(name)).ok_or_else(refused)?;
            Ok(algebra.scale(&sigma, &scale))
        };
        let forces = self.system.forces.iter();
        forces.map(|phase| phase.detuning.iter().map(sigma).collect()).collect()
    }

    fn branch(
        &self,
        start: Start,
        generating: Element,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<SoughtBranch, Error> {
        let (algebra, order) = (self.algebra, self.settings.order);
        let symbols = Symbols { algebra, step: self.step.max(1), other: &|_| None };
        let binding = Seeking(symbols, self.name, &start.turn);
        let graph = compiled(algebra, (self.system, self.names), &binding, order)?;
        let detuning = self.detuning(algebra)?;
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
        let first = self.start.map(|start| algebra.rational(start));
        let [cos, sin] = start.direction;
        Ok(SoughtBranch {
            start: [cos, -sin],
            origin: self.names.shown(&origin(self.system, &start.turn)),
            series: first.iter().chain(&found.parameter).map(terms).collect(),
            solution: found.solution.iter().flatten().map(terms).collect(),
            checked_orders,
        })
    }
}

/// t_0 of Omega t + the phase of the force = Omega (t - t_0) + arg(turn).
fn origin(system: &System, turn: &Complex) -> Expression {
    let [force] = &system.forces[..] else { return 0.into() };
    let pi = || Expression::parameter("pi");
    let angle = match turn {
        [re, im] if re.is_zero() => Expression::Number(Rational::from(im / 2)) * pi(),
        [re, im] => {
            let half = Expression::integer(if *re > 0 { 0 } else { 1 }) * pi();
            let tangent = Rational::from(im / re);
            match tangent.is_zero() {
                true => half,
                false => half + Expression::parameter(&format!("arctan({tangent})")),
            }
        }
    };
    let gap = angle - force.start.clone();
    (gap * Expression::Number(system.force().recip())).canonical()
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
