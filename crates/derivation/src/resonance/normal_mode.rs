//! Nonlinear normal modes: the slow flow restricted to one mode.
//!
//! With the time tau = nu t of the mode, q_j'' + kappa_j q_j + eps (...) = 0, kappa_j = nu_j^2/nu^2 rational even
//! where the frequencies are not; of all amplitudes z of this mode alone is there, so that
//!
//!   dz/dtau = i z + sum eps^n f_n(z, zbar) = z (i Omega/nu + A),   q_j = delta_j (z + zbar) + sum eps^n u_{j,n}(z, zbar),
//!
//! Omega and A being polynomials in rho = a^2 = 4 |z|^2: the backbone and the growth, and x = P q the shape. A
//! mode j with kappa_j = k^2, which the harmonic k drives, ends it: internal resonance, where no mode moves
//! alone.
//!
//! Where the squares of the frequencies are irrational the slow flow of all modes is enclosed, and of its amplitudes all but one are
//! zero: they stay so, unless the mode drives another at its frequency.

use super::flow::Symbols;
use super::modes::{Matrix, spectrum};
use super::prepared::Prepared;
use super::print::print_powers;
use super::separated::separated;
use super::system::{Detuned, refuse_delays, symbols};
use super::unit::Unit;
use super::{
    Element, Enclosed, Names, ResonanceError, SlowFlow, Terms, collected, refuse_near_miss,
    slow_flow,
};
use crate::averaging::AveragingSettings;
use crate::error::DerivationError as Error;
use crate::limits::refuse_taken;
use crate::values::value;
use crate::work::Progress;
use lindstedt_coeff::print::{Style, Term, power, print_sum};
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::{Expression, Problem, Unknown};
use lindstedt_expand::resonance::{SlowFlow as Found, check_flow, resonant};
use lindstedt_expand::{ExpandError, OrderWork, compile_system};
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeTerm, Amplitudes};
use rug::Rational;
use std::collections::BTreeMap;

/// A nonlinear normal mode, substituted into its equations, as plain data.
///
/// ```
/// use lindstedt_coeff::print::Style;
/// use lindstedt_derivation::{averaging::AveragingSettings, resonance::normal_mode};
/// use lindstedt_problem_file::ProblemFile;
/// // Two masses, the first on a cubic spring; in phase their linear frequency is 1.
/// let text = "equations = [\"x'' + 2*x - y + eps*x^3/2\", \"y'' + 2*y - x\"]";
/// let problem = ProblemFile::parse(text)?.problem;
/// let mode = normal_mode(&problem, 1, &AveragingSettings::default(), &mut |_| true)?;
/// let backbone = mode.print_in_amplitude(&mode.frequency_squared, Style::Text);
/// assert_eq!(backbone, "1 + 3/16*rho*eps - 101/2048*rho^2*eps^2");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NormalMode {
    /// The problem.
    pub problem: Problem,
    /// The number of the mode, from 1.
    pub mode: usize,
    /// The symbol of which frequencies are multiples; nothing where they have numbers.
    pub unit: Option<Unit>,
    /// nu^2 in multiples of its square.
    pub square: Rational,
    /// kappa_j, that of the mode (1) first.
    pub ratios: Vec<Rational>,
    /// P of x = P q, by rows, the shape of the mode first.
    pub shapes: Matrix,
    /// Names without a value, and the root `sqrt(d)` of a number that coefficients contain, to the power 0 or 1.
    pub symbols: Vec<String>,
    /// The highest order derived.
    pub order: usize,
    /// (Omega/nu)^2 order by order: polynomials in rho and the symbols.
    pub frequency_squared: Vec<Terms>,
    /// A/nu order by order, in the same way; all empty where the equations are conservative.
    pub growth: Vec<Terms>,
    /// x_{i,n} at `[i][n]`: polynomials in z, zbar (and a zero for E) and the symbols.
    pub solution: Vec<Vec<Terms>>,
    /// Orders 0..=this leave no residual; nothing where there was no time to check.
    pub checked_orders: Option<usize>,
    /// Where squares are irrational: what all numbers are known within.
    pub enclosed: Option<Enclosed>,
}

/// The normal mode of a number (from 1, by increasing frequency where the unknowns are coupled), to the order
/// of the settings. Parameters as for [`super::slow_flow`].
///
/// Exact, or enclosed where squares of frequencies are irrational; every order is substituted back.
///
/// # Errors
/// [`ResonanceError`] by name: a force, internal resonance, irrational squares that are multiple, a
/// velocity where the frequency is a root. [`Error::SymbolTaken`] for a symbol named like what the mode is written with.
pub fn normal_mode(
    problem: &Problem,
    mode: usize,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<NormalMode, Error> {
    let equations: Vec<Expression> = problem.equations().cloned().collect();
    let cards = |name: &str| value(problem, &settings.parameters, name);
    let names = Names(problem);
    refuse_delays(&equations, names)?;
    let prepared = Prepared::of(&equations, &settings.parameters, &cards, names)?;
    if !prepared.forces.is_empty() {
        return Err(ResonanceError::ForcedMode.into());
    }
    let (unit, root): (Option<Unit>, Option<Unit>) = match prepared.unit {
        Some(unit) if unit.square.is_some() => (None, Some(unit)),
        unit => (unit, None),
    };
    let modes = spectrum(&prepared.mass, &prepared.stiffness);
    if unit.is_none() && matches!(modes, Err(ResonanceError::NoRationalForm)) {
        let flow = slow_flow(problem, settings, Detuned::Not, observer)?;
        return enclosed_mode(flow, mode);
    }
    let modes = modes.map_err(|error| match (error, &unit) {
        (ResonanceError::NoRationalForm, Some(unit)) => unit.unset(),
        (other, _) => other,
    })?;
    let count = modes.squares.len();
    let index = mode.checked_sub(1).filter(|index| *index < count);
    let modes = modes.with_first(index.ok_or(ResonanceError::NoSuchMode { mode, modes: count })?);
    let square = modes.squares[0].clone();
    if square <= 0 {
        return Err(ResonanceError::NoOscillation { square: square.to_string() }.into());
    }
    let equations = separated(&prepared.equations, &modes, None, names)?;
    let equations = in_own_time(&equations, &square, unit.as_ref())?;
    let symbols = symbols(equations.iter(), names);
    check_names(&symbols, names)?;
    let list: Vec<&str> = symbols.iter().map(String::as_str).collect();
    let ratios: Vec<_> =
        modes.squares.iter().map(|other| Rational::from(other / &square)).collect();
    let algebra = Amplitudes::new(Integers, &[1.into()], &Rational::new(), &list);
    let algebra = algebra.ok_or_else(|| ResonanceError::no_room(&[1.into()], &[], list.len()))?;
    let algebra = algebra.with_unknowns(&ratios).with_inverses().with_stop(settings.stop.clone());
    let binding = Symbols { algebra: &algebra, step: 1, other: &|_| None };
    let graph = compile_system(&algebra, &equations, &binding, settings.order)?;
    let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
    let found = resonant(&algebra, &graph, settings.order, &[], &mut on_order);
    let (order, largest) = (settings.order, algebra.largest_exponent());
    let too_high = ResonanceError::TooHigh { order, largest };
    let found = match found {
        _ if algebra.overflowed() => return Err(too_high.into()),
        found => found?,
    };
    refuse_internal(&algebra, &found)?;
    refuse_near_miss(&found.nearest, 1)?;
    observer(Progress::Checking);
    let checked_orders = match check_flow(&algebra, &graph, &found) {
        _ if settings.stop.asked() => None,
        Err(ExpandError::Interrupted { .. }) => None,
        other => Some(other?),
    };
    let terms = |f: &Element| algebra.rational_terms(f).unwrap_or_default();
    let rates = found.flow[0].iter().map(|f| in_amplitude(&terms(f))).collect::<Vec<_>>();
    let lists: Vec<Vec<Terms>> =
        found.solution.iter().map(|list| list.iter().map(&terms).collect()).collect();
    let solution = modes.shapes.iter().flatten().map(|row| unknown(row, &lists)).collect();
    let mut mode = NormalMode {
        problem: problem.clone(),
        mode,
        unit,
        square,
        ratios,
        shapes: modes.shapes.unwrap_or_default(),
        symbols,
        order: found.order(),
        frequency_squared: squared(&rates, 0.0).0,
        growth: rates.into_iter().map(|[growth, _]| listed(growth)).collect(),
        solution,
        checked_orders,
        enclosed: None,
    };
    if let Some(root) = root {
        root.put_in(&mode.symbols, 1, mode.frequency_squared.iter_mut().chain(&mut mode.growth));
        root.put_in(&mode.symbols, 3, mode.solution.iter_mut().flatten());
    }
    Ok(mode)
}

/// Refuses symbols that are named like what a mode is written with.
fn check_names(symbols: &[String], names: Names<'_>) -> Result<(), Error> {
    refuse_taken(symbols, |base, numbered| match base {
        "rho" if !numbered => Some("the square of the amplitude"),
        "a" if !numbered => Some("the amplitude"),
        "psi" if !numbered => Some("the phase"),
        "Omega" if !numbered => Some("the frequency"),
        "nu" if !numbered => Some("the frequency of the linear mode"),
        _ if numbered && names.is_unknown(base) => Some("a coefficient"),
        _ => None,
    })
}

/// The equations divided by nu^2, in the time nu t, nu in multiples of the unit.
fn in_own_time(
    equations: &[Expression],
    square: &Rational,
    unit: Option<&Unit>,
) -> Result<Vec<Expression>, ResonanceError> {
    let root = rational_root(square);
    let velocity = |e: &Expression| matches!(e, Expression::Unknown(Unknown { derivative: 1, .. }));
    if root.is_none() && equations.iter().flat_map(Expression::nodes).any(velocity) {
        let square = print_square(square, unit, Style::Text);
        return Err(ResonanceError::IrrationalMode { square });
    }
    let unit = unit.map_or_else(|| Expression::integer(1), Unit::expression);
    let faster = |e: &Expression| {
        let root = root.clone().filter(|_| velocity(e))?;
        Some(Expression::Number(root) * unit.clone() * e.clone())
    };
    let scale = Expression::Number(Rational::from(square.recip_ref())) * unit.clone().pow(-2);
    let equation = |(j, equation): (usize, &Expression)| {
        let acceleration = Expression::unknown(j, 2);
        let rest = equation.terms().iter().filter(|term| **term != acceleration);
        let rest = rest.map(|term| (scale.clone() * term.map(&faster)).canonical());
        let rest = rest.flat_map(|term| term.terms().to_vec()).collect::<Vec<_>>();
        Expression::Sum([acceleration.clone()].into_iter().chain(rest).collect())
    };
    Ok(equations.iter().enumerate().map(equation).collect())
}

fn print_square(square: &Rational, unit: Option<&Unit>, style: Style) -> String {
    let factor = |unit: &Unit| power(&super::print_name(&unit.name, style), 2, style);
    let factors = unit.map(factor).into_iter().collect();
    print_sum(&[Term { coefficient: square.clone(), factors }], style)
}

fn refuse_internal(
    algebra: &Amplitudes<Integers>,
    found: &Found<Element>,
) -> Result<(), ResonanceError> {
    for (j, flow) in found.flow.iter().enumerate().skip(1) {
        for (order, f) in flow.iter().enumerate() {
            let terms = algebra.rational_terms(f).unwrap_or_default();
            if let Some(term) = terms.first() {
                let multiple = term.exponents[0] - term.exponents[1];
                return Err(ResonanceError::InternalResonance { order, mode: j + 1, multiple });
            }
        }
    }
    Ok(())
}

/// x_i order by order, from the modes.
fn unknown(row: &[Rational], lists: &[Vec<Terms>]) -> Vec<Terms> {
    let order = |n: usize| {
        let mut sum = BTreeMap::<Vec<i32>, [Rational; 2]>::new();
        for (p, list) in row.iter().zip(lists) {
            for term in list.get(n).into_iter().flatten() {
                let entry = sum.entry(term.exponents.clone()).or_default();
                entry[0] += Rational::from(p * &term.re);
                entry[1] += Rational::from(p * &term.im);
            }
        }
        collected(sum)
    };
    (0..lists.iter().map(Vec::len).max().unwrap_or(0)).map(order).collect()
}

/// The mode of an enclosed flow of all.
fn enclosed_mode(flow: SlowFlow, mode: usize) -> Result<NormalMode, Error> {
    let count = flow.unknowns();
    let index = mode.checked_sub(1).filter(|index| *index < count);
    let index = index.ok_or(ResonanceError::NoSuchMode { mode, modes: count })?;
    let known = flow.enclosed.ok_or(ResonanceError::NoRationalForm)?;
    check_names(&flow.system.symbols, Names(&flow.problem))?;
    // Of z_j alone: exponents of z, zbar, E and the symbols.
    let alone = |terms: &Terms| -> Terms {
        let of = |term: &AmplitudeTerm| {
            let (amplitudes, rest) = term.exponents.split_at(2 * count);
            let others = amplitudes.chunks_exact(2).enumerate().filter(|(k, _)| *k != index);
            let still = others.into_iter().all(|(_, pair)| pair == [0, 0]);
            let own = amplitudes[2 * index..2 * index + 2].iter().chain(rest).copied();
            still.then(|| AmplitudeTerm { exponents: own.collect(), ..term.clone() })
        };
        terms.iter().filter_map(of).collect()
    };
    for (lists, sure) in [(&flow.flow, true), (&flow.doubtful, false)] {
        for (j, orders) in lists.iter().enumerate().filter(|(j, _)| *j != index) {
            for (order, terms) in orders.iter().enumerate() {
                let Some(term) = alone(terms).pop() else { continue };
                let multiple = term.exponents[0] - term.exponents[1];
                let harmonic = format!("{multiple}*nu_{mode}");
                return Err(match sure {
                    true => ResonanceError::InternalResonance { order, mode: j + 1, multiple },
                    false => ResonanceError::UndecidedDivisor { order, harmonic },
                }
                .into());
            }
        }
    }
    let mut rates: Vec<_> = flow.flow[index].iter().map(|f| in_amplitude(&alone(f))).collect();
    let (nu, square) = (&flow.system.frequencies[index], &flow.system.squares[index]);
    rates.iter_mut().flatten().flat_map(|part| part.values_mut()).for_each(|c| *c /= nu);
    let size = |list: &mut dyn Iterator<Item = &Rational>| {
        list.fold(1.0f64, |most, c| most.max(c.to_f64().abs()))
    };
    // c/nu with both within r: r (1 + |c/nu|)/(nu - r); the same of squares.
    let r = known.radius;
    let quotient = |most: f64, by: f64| UPWARD * r * (1.0 + most) / (by - r);
    let within = size(&mut rates.iter().flatten().flat_map(|part| part.values()));
    let (frequency_squared, of_squares) = squared(&rates, quotient(within, nu.to_f64()));
    let lists: Vec<Vec<Terms>> =
        flow.solution.iter().map(|list| list.iter().map(alone).collect()).collect();
    let shapes = flow.system.shapes.clone().unwrap_or_default();
    let parts = lists.iter().flatten().flatten().flat_map(|term| [&term.re, &term.im]);
    let (share, part) = (size(&mut shapes.iter().flatten()), size(&mut parts.into_iter()));
    let of_shapes = UPWARD * count as f64 * r * (share + part + r);
    let with_first = |list: &[Rational]| {
        let mut list = list.to_vec();
        list[..=index].rotate_right(1);
        list
    };
    let ratios: Vec<_> =
        flow.system.squares.iter().map(|other| Rational::from(other / square)).collect();
    let of_ratios = quotient(size(&mut ratios.iter()), square.to_f64());
    let radius = [of_squares, of_shapes, of_ratios].into_iter().fold(r, f64::max);
    Ok(NormalMode {
        mode,
        unit: None,
        square: square.clone(),
        ratios: with_first(&ratios),
        solution: shapes.iter().map(|row| unknown(row, &lists)).collect(),
        shapes: shapes.iter().map(|row| with_first(row)).collect(),
        symbols: flow.system.symbols.clone(),
        order: flow.order,
        frequency_squared,
        growth: rates.into_iter().map(|[growth, _]| listed(growth)).collect(),
        checked_orders: flow.checked_orders,
        enclosed: Some(Enclosed { radius, ..known }),
        problem: flow.problem,
    })
}

/// Makes up for the rounding of a few operations.
const UPWARD: f64 = 1.0 + 1e-12;

/// Exponents of rho and the symbols.
type InAmplitude = BTreeMap<Vec<i32>, Rational>;

/// Real and imaginary part of f/z, with |z|^2 = rho/4.
fn in_amplitude(terms: &Terms) -> [InAmplitude; 2] {
    let mut parts = [InAmplitude::new(), InAmplitude::new()];
    for term in terms {
        let k = term.exponents[1];
        let key: Vec<i32> = [k].into_iter().chain(term.exponents[3..].iter().copied()).collect();
        for (part, c) in parts.iter_mut().zip([&term.re, &term.im]) {
            *part.entry(key.clone()).or_default() += Rational::from(c >> (2 * k.unsigned_abs()));
        }
    }
    parts
}

/// (1 + sum eps^n Omega_n)^2, order by order, and what its coefficients are within where those of the Omega_n are within r.
fn squared(rates: &[[InAmplitude; 2]], r: f64) -> (Vec<Terms>, f64) {
    let symbols = rates.iter().flatten().flat_map(|r| r.keys()).map(Vec::len).max().unwrap_or(1);
    let one = InAmplitude::from([(vec![0; symbols], Rational::from(1))]);
    let order = |n: usize| if n == 0 { &one } else { &rates[n][1] };
    let mut most = 0.0f64;
    let coefficient = |n: usize| {
        let mut sum = BTreeMap::<Vec<i32>, (Rational, f64)>::new();
        for k in 0..=n {
            for (v, a) in order(k) {
                for (w, b) in order(n - k) {
                    let key = v.iter().zip(w).map(|(v, w)| v + w).collect();
                    let (c, within) = sum.entry(key).or_default();
                    *c += Rational::from(a * b);
                    *within += r * (a.to_f64().abs() + b.to_f64().abs() + r);
                }
            }
        }
        most = sum.values().fold(most, |most, (_, within)| most.max(UPWARD * within));
        listed(sum.into_iter().map(|(key, (c, _))| (key, c)).collect())
    };
    let orders = (0..rates.len()).map(coefficient).collect();
    (orders, most)
}

fn listed(sum: InAmplitude) -> Terms {
    collected(sum.into_iter().map(|(exponents, re)| (exponents, [re, Rational::new()])))
}

impl NormalMode {
    /// A number: of enclosures the digits that are certain.
    #[must_use]
    pub fn number(&self, q: &Rational) -> String {
        self.enclosed.map_or_else(|| q.to_string(), |it| it.number(q))
    }

    /// A term of a sum, with its digits among the factors.
    fn term(&self, c: &Rational, factors: Vec<String>, style: Style) -> Term {
        let own = |it: Enclosed| it.coefficient(c, style);
        let (coefficient, digits) = self.enclosed.map_or_else(|| (c.clone(), None), own);
        Term { coefficient, factors: digits.into_iter().chain(factors).collect() }
    }

    /// nu^2.
    #[must_use]
    pub fn print_square(&self, style: Style) -> String {
        if self.enclosed.is_some() {
            return self.number(&self.square);
        }
        print_square(&self.square, self.unit.as_ref(), style)
    }

    /// nu in multiples of the unit, where it is rational.
    #[must_use]
    pub fn frequency(&self) -> Option<Rational> {
        rational_root(&self.square)
    }

    fn factors(&self, powers: &[(&str, i32)], symbols: &[i32], style: Style) -> Vec<String> {
        let symbols = super::print::factors(&self.symbols, symbols, style);
        let powers = powers.iter().filter(|(_, n)| *n != 0);
        let powers =
            powers.map(|(name, n)| power(&super::print_name(name, style), i64::from(*n), style));
        symbols.into_iter().chain(powers).collect()
    }

    /// One order of [`Self::frequency_squared`] or [`Self::growth`].
    #[must_use]
    pub fn print_order(&self, terms: &Terms, style: Style) -> String {
        print_sum(&self.order_terms(terms, style), style)
    }

    fn order_terms(&self, terms: &Terms, style: Style) -> Vec<Term> {
        let term = |term: &AmplitudeTerm| {
            let factors = self.factors(&[("rho", term.exponents[0])], &term.exponents[1..], style);
            self.term(&term.re, factors, style)
        };
        terms.iter().map(term).collect()
    }

    /// [`Self::frequency_squared`] or [`Self::growth`] as a series in the small parameter.
    #[must_use]
    pub fn print_in_amplitude(&self, orders: &[Terms], style: Style) -> String {
        let small = super::print_name(&self.problem.small, style);
        print_powers(orders, &small, style, &|terms| self.order_terms(terms, style))
    }

    /// One order of an unknown as a sum of cosines and sines of psi, psi' = Omega, z = a/2 e^{i psi}.
    #[must_use]
    pub fn print_shape(&self, terms: &Terms, style: Style) -> String {
        let mut sum = Vec::new();
        for term in terms {
            let [p, q] = [term.exponents[0], term.exponents[1]];
            let twice = u32::from(p > q);
            if p < q {
                continue;
            }
            // c z^p zbar^q + conj = 2 (a/2)^{p+q} (Re c cos - Im c sin).
            let scale = |c: &Rational| Rational::from(c << twice) >> (p + q).unsigned_abs();
            let parts = [("cos", scale(&term.re)), ("sin", -scale(&term.im))];
            for (function, c) in parts.into_iter().filter(|(_, c)| !c.is_zero()) {
                let mut factors = self.factors(&[("a", p + q)], &term.exponents[3..], style);
                if p > q {
                    let angle = super::print_turns((p - q).unsigned_abs(), "psi", style);
                    let backslash = if style == Style::Latex { r"\" } else { "" };
                    factors.push(format!("{backslash}{function}({angle})"));
                }
                sum.push(self.term(&c, factors, style));
            }
        }
        print_sum(&sum, style)
    }
}
