//! The phases of the forces: cos and sin of (A + eps B_1 + eps^2 B_2 + ...) t + phi. Forces whose rates are
//! rational multiples of one another at all orders are harmonics of one phase eta_l with
//! eta_l' = Omega_l + eps sigma_{l,1} + eps^2 sigma_{l,2} + ..., up to constants; others have phases of their own.

use super::unit::Unit;
use super::{Names, ResonanceError};
use lindstedt_algebra::common_measure;
use lindstedt_equation::monomials::{self, expand};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use rug::{Integer, Rational};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// The rate of an angle, order by order in the small parameter.
type Rate = Vec<Expression>;

/// The phase of a force: eta' = rate + eps detuning_1 + ..., eta(0) = start.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Omega: its multiples of the unit and of the independent parameters, in their order.
    pub rate: Vec<Rational>,
    /// q_j of Omega = sum_j q_j nu_j, of a rate that is defined by irrational frequencies: then the multiple of the unit is
    /// a rational number beside it, as theirs are. Empty for every other one.
    pub of_modes: Vec<Rational>,
    /// sigma_1, sigma_2, ...
    pub detuning: Vec<Expression>,
    /// eta at t = 0: a number or a constant of parameters; 0 where no force has a phase.
    pub start: Expression,
}

impl Phase {
    /// Omega, where it is a multiple of the unit.
    #[must_use]
    pub fn number(&self) -> Option<Rational> {
        let [number, rest @ ..] = &self.rate[..] else { return None };
        rest.iter().all(Rational::is_zero).then(|| number.clone())
    }
}

/// rate * t + start.
struct Angle {
    rate: Rate,
    start: Expression,
}

/// The name of eta_l in the equations: none is written so.
const PHASE: &str = "'eta";

/// Whether this is a name that no user wrote.
pub(super) fn is_internal(name: &str) -> bool {
    name.starts_with('\'')
}

/// Whether this is a harmonic function of the time or of the phase of a force.
pub(super) fn is_wave(e: &Expression) -> bool {
    let in_time = |e: &Expression| match e {
        Expression::Time => true,
        Expression::Parameter(name) => name.starts_with(PHASE),
        _ => false,
    };
    matches!(e, Expression::Function(Function::Cos | Function::Sin, angle)
        if angle.nodes().any(in_time))
}

/// l and m of cos(m eta_l) or sin(m eta_l).
pub(super) fn harmonic(wave: &Expression) -> Option<(Function, usize, i32)> {
    let Expression::Function(function, angle) = wave else { return None };
    let number = |m, e: &Expression| m * e.as_number().unwrap_or_else(|| 1.into());
    let m = angle.factors().iter().fold(Rational::from(1), number);
    let phase = angle.factors().iter().find_map(|e| match e {
        Expression::Parameter(name) => name.strip_prefix(PHASE)?.parse().ok(),
        _ => None,
    })?;
    Some((*function, phase, m.is_integer().then(|| m.numer().to_i32())??))
}

/// e with `change(l)` in the place of eta_l.
pub(super) fn with_phases(
    e: &Expression,
    change: &dyn Fn(usize) -> Option<Expression>,
) -> Expression {
    e.map(&|e| match e {
        Expression::Parameter(name) => change(name.strip_prefix(PHASE)?.parse().ok()?),
        _ => None,
    })
}

/// The parts of an angle rate * t + start; nothing for an angle of another form.
fn parts(angle: &Expression) -> Option<Angle> {
    let (rate, start) = monomials::angle(angle)?;
    let highest = rate.terms.keys().map(|m| m.order).max()?;
    let order = |n| rate.coefficient(|m| m.order == n);
    let known = start.terms.keys().all(|m| m.order == 0);
    known.then(|| Angle {
        rate: (0..=highest).map(order).collect(),
        start: start.coefficient(|_| true),
    })
}

/// The rates at order zero of all angles: what must have a value.
pub(super) fn leading_rates(
    equations: &[Expression],
    names: Names<'_>,
) -> Result<Vec<Expression>, ResonanceError> {
    let nodes = equations.iter().flat_map(Expression::nodes).filter(|e| is_wave(e));
    nodes.map(|wave| Ok(angle_of(wave, names)?.rate.swap_remove(0))).collect()
}

fn angle_of(wave: &Expression, names: Names<'_>) -> Result<Angle, ResonanceError> {
    let refused = || ResonanceError::NotAForce { term: names.shown(wave) };
    let Expression::Function(_, angle) = wave else { return Err(refused()) };
    parts(angle).ok_or_else(refused)
}

/// a - ratio * b, multiplied out; nothing where that vanishes.
fn gap(a: &Expression, ratio: &Rational, b: &Expression) -> Option<Expression> {
    let gap = a.clone() - Expression::Number(ratio.clone()) * b.clone();
    gap.multiplied_out()
        .map(|e| e.canonical())
        .filter(|e| e.as_number().is_none_or(|q| !q.is_zero()))
}

/// The unit and the independent parameters.
type Generators<'a> = (Option<&'a Unit>, &'a [String]);

/// The multiples of the unit and of independent parameters that add up to a rate; nothing for another rate.
fn multiples(rate: &Expression, (unit, independent): Generators<'_>) -> Option<Vec<Rational>> {
    let mut list = vec![Rational::new(); 1 + independent.len()];
    for (m, q) in &expand(rate)?.terms {
        let mut named = m.parameters.iter();
        let place = match (named.next(), named.next()) {
            (None, _) if unit.is_none() => 0,
            (Some((name, 1)), None) if unit.is_some_and(|unit| unit.name == *name) => 0,
            (Some((name, 1)), None) => 1 + independent.iter().position(|known| known == name)?,
            _ => return None,
        };
        let plain = m.order == 0 && m.x == 0 && m.velocity == 0 && m.atoms.is_empty();
        list[place] += plain.then_some(q)?;
    }
    Some(list)
}

/// q with a = q b.
fn ratio(a: &[Rational], b: &[Rational]) -> Option<Rational> {
    let place = b.iter().position(|q| !q.is_zero())?;
    let q = Rational::from(&a[place] / &b[place]);
    a.iter().zip(b).all(|(a, b)| *a == Rational::from(&q * b)).then_some(q)
}

/// Forces of one phase: the rate and the rest of the angle of the first, what the rates of all are multiples of, and
/// the largest of their ratios to the first.
struct Class {
    first: Vec<Rational>,
    angle: Angle,
    common: Rational,
    largest: Rational,
}

/// The highest harmonic that is taken of one phase: exponents of E are held in words. Beyond it forces have phases of
/// their own, whose rates are numbers, so that what is resonant is decided as exactly.
const HIGHEST: u32 = 1000;

impl Class {
    /// The ratio of an angle's rate to that of the first force, where it is rational at all orders.
    fn ratio(&self, leading: &[Rational], angle: &Angle) -> Option<Rational> {
        let ratio = ratio(leading, &self.first)?;
        let at = |list: &Rate, n: usize| list.get(n).cloned().unwrap_or_else(|| 0.into());
        let (own, known) = (&angle.rate, &self.angle.rate);
        let differs = |n| gap(&at(own, n), &ratio, &at(known, n)).is_some();
        (!(0..own.len().max(known.len())).any(differs)).then_some(ratio)
    }

    /// Takes a force of this phase, where all its forces stay harmonics below [`HIGHEST`].
    fn take(&mut self, leading: &[Rational], angle: &Angle) -> bool {
        let Some(ratio) = self.ratio(leading, angle) else { return false };
        let common = common_measure(&self.common, &ratio);
        let largest = ratio.abs().max(self.largest.clone());
        let fits = Rational::from(&largest / &common) <= HIGHEST;
        if fits {
            (self.common, self.largest) = (common, largest);
        }
        fits
    }

    fn phase(&self) -> Phase {
        // Numbers are positive.
        let negative = self.first[1..].iter().all(Rational::is_zero) && self.first[0] < 0;
        let scale = if negative { Rational::from(-&self.common) } else { self.common.clone() };
        let scaled = |e: &Expression| (Expression::Number(scale.clone()) * e.clone()).canonical();
        Phase {
            rate: self.first.iter().map(|q| Rational::from(q * &scale)).collect(),
            of_modes: Vec::new(),
            detuning: self.angle.rate.iter().map(scaled).collect(),
            start: scaled(&self.angle.start),
        }
    }
}

/// Equations with functions of m eta_l in the place of every force.
pub(super) struct InPhases {
    pub phases: Vec<Phase>,
    pub equations: Vec<Expression>,
    /// The phi by which forces are ahead of their phase, which stay as constants cos(phi) and sin(phi).
    pub angles: Angles,
}

/// The phases of the forces, and the equations in them.
pub(super) fn phases(
    equations: &[Expression],
    generators: Generators<'_>,
    names: Names<'_>,
) -> Result<InPhases, ResonanceError> {
    let read = |wave: &Expression| {
        let mut angle = angle_of(wave, names)?;
        let slow = || ResonanceError::NotAForce { term: names.shown(wave) };
        let leading = angle.rate.remove(0);
        let found = multiples(&leading, generators);
        if found.is_none() && leading.parameters().is_empty() {
            let rate = names.shown(&leading);
            return Err(match generators.0.filter(|_| leading.as_number().is_some()) {
                Some(unit) => ResonanceError::NoRatio { first: rate, second: unit.name.clone() },
                None => ResonanceError::IrrationalRate { rate },
            });
        }
        let leading = found.filter(|list| list.iter().any(|q| !q.is_zero()));
        Ok((leading.ok_or_else(slow)?, angle))
    };
    let mut classes: Vec<Class> = Vec::new();
    for wave in equations.iter().flat_map(Expression::nodes).filter(|e| is_wave(e)) {
        let (first, angle) = read(wave)?;
        if !classes.iter_mut().any(|class| class.take(&first, &angle)) {
            classes.push(Class { first, angle, common: 1.into(), largest: 1.into() });
        }
    }
    let phases: Vec<Phase> = classes.iter().map(Class::phase).collect();
    let angles = RefCell::new(Vec::new());
    let rewritten = |e: &Expression| {
        let (Expression::Function(function, _), true) = (e, is_wave(e)) else { return None };
        let (leading, angle) = read(e).ok()?;
        let harmonic_of = |(l, class): (usize, &Class)| {
            class.ratio(&leading, &angle)?;
            let m = ratio(&leading, &phases[l].rate)?;
            (m.is_integer() && *m.as_abs() <= HIGHEST).then_some((l, m))
        };
        let (l, m) = classes.iter().enumerate().find_map(harmonic_of)?;
        let ahead = gap(&angle.start, &m, &phases[l].start);
        angles.borrow_mut().extend(ahead.iter().filter(|e| quarters(e).is_none()).cloned());
        let eta = Expression::parameter(&format!("{PHASE}{l}"));
        let angle = if m == 1 { eta } else { Expression::Number(m) * eta };
        Some(ahead_of(*function, angle, ahead))
    };
    let equations = equations.iter().map(|e| e.map(&rewritten)).collect();
    Ok(InPhases { phases, equations, angles: named(angles.into_inner()) })
}

/// A function of angle + ahead: cos(angle) cos(ahead) - sin(angle) sin(ahead), or the sine.
fn ahead_of(function: Function, angle: Expression, ahead: Option<Expression>) -> Expression {
    let cosine = function == Function::Cos;
    let Some(ahead) = ahead else { return angle.apply(function) };
    let other = if cosine { Function::Sin } else { Function::Cos };
    let sign = Expression::integer(if cosine { -1 } else { 1 });
    let [cos, sin] = turned(&ahead);
    cos * angle.clone().apply(function) + sign * sin * angle.apply(other)
}

/// Cosine and sine of a constant: numbers at whole quarters of a turn, else constants of that name.
fn turned(ahead: &Expression) -> [Expression; 2] {
    match quarters(ahead).map(|n| n.mod_u(4)) {
        Some(n) => {
            let cos = [1, 0, -1, 0];
            let at = |n: u32| Expression::integer(cos[n as usize % 4]);
            // sin of n quarters is the cosine of n - 1.
            [at(n), at(n + 3)]
        }
        None => wave_names(ahead).map(|name| Expression::parameter(&name)),
    }
}

/// The names of the cosine and the sine of a constant angle.
pub(super) fn wave_names(angle: &Expression) -> [String; 2] {
    [Function::Cos, Function::Sin]
        .map(|function| angle.clone().apply(function).print("eps", Style::Text))
}

/// By the names of cosine and sine: a constant angle, and whether it is the sine.
pub(super) type Angles = BTreeMap<String, (Expression, bool)>;

/// The names of the cosines and sines of constant angles.
pub(super) fn named(angles: impl IntoIterator<Item = Expression>) -> Angles {
    let of = |angle: Expression| {
        let [cos, sin] = wave_names(&angle);
        [(cos, (angle.clone(), false)), (sin, (angle, true))]
    };
    angles.into_iter().flat_map(of).collect()
}

/// So many quarters of a turn, where a constant angle is a whole number of them.
pub(super) fn quarters(angle: &Expression) -> Option<Integer> {
    let quarters = angle.clone() * Expression::integer(2) * Expression::parameter("pi").pow(-1);
    let quarters = quarters.multiplied_out().and_then(|e| e.canonical().as_number());
    quarters.filter(Rational::is_integer).map(|q| q.numer().clone())
}

/// The resonance sum_j k_j nu_j = m Omega that a rate is near without being at it, as the rate at it;
/// nothing where the rate is at a resonance itself or near none.
///
/// At: one is a whole multiple of the other, or sum |k_j| + m is at most [`EXACT`] (of many frequencies sum |k_j|
/// is smaller); near: at most [`NEAR`], and the rates differ by a tenth at most. The order of the frequencies
/// changes nothing.
pub(super) fn near(rate: &Rational, frequencies: &[Rational]) -> Option<Rational> {
    let multiple = |a: &Rational, b: &Rational| Rational::from(a / b).is_integer();
    if frequencies.iter().any(|nu| multiple(rate, nu) || multiple(nu, rate)) {
        return None;
    }
    let mut best: Option<(u32, Rational, Rational)> = None;
    for (size, at) in rates(frequencies) {
        if at == *rate {
            return None;
        }
        let gap = Rational::from(&at - rate).abs() / rate;
        let close = size <= NEAR && gap <= Rational::from((1, 10));
        let better = |(order, other, known): &(u32, Rational, Rational)| {
            (size, &gap, &at) < (*order, other, known)
        };
        if close && best.as_ref().is_none_or(better) {
            best = Some((size, gap, at));
        }
    }
    best.map(|(_, _, at)| at)
}

/// The rates of forces at the resonances that are looked for, of which this one is at most a half of them away: those of the
/// fewest frequencies first, then the nearest. None where it is at one of them itself.
pub(super) fn around(rate: &Rational, frequencies: &[Rational]) -> Vec<Rational> {
    let mut list: Vec<(u32, Rational, Rational)> = Vec::new();
    for (size, at) in rates(frequencies).into_iter().filter(|(size, _)| *size <= NEAR) {
        let gap = Rational::from(&at - rate).abs() / &at;
        if gap.is_zero() {
            return Vec::new();
        }
        if gap <= Rational::from((1, 2)) {
            list.push((size, gap, at));
        }
    }
    list.sort();
    let mut list: Vec<Rational> = list.into_iter().map(|(_, _, at)| at).collect();
    for k in (1..list.len()).rev() {
        if list[..k].contains(&list[k]) {
            list.remove(k);
        }
    }
    list
}

/// sum |k_j| + m and |sum_j k_j nu_j|/m of the resonances that are known.
fn rates(frequencies: &[Rational]) -> Vec<(u32, Rational)> {
    let all = resonances(frequencies).map(|(size, q)| (size, sum(&q, frequencies)));
    all.filter(|(_, at)| *at > 0).collect()
}

/// sum_j q_j nu_j.
pub(super) fn sum(q: &[Rational], frequencies: &[Rational]) -> Rational {
    q.iter().zip(frequencies).map(|(q, nu)| Rational::from(nu * q)).sum()
}

/// sum |k_j| + m and the k_j/m of the resonances that are known.
fn resonances(frequencies: &[Rational]) -> impl Iterator<Item = (u32, Vec<Rational>)> {
    combinations(frequencies.len()).into_iter().flat_map(|k| {
        let size: u32 = k.iter().map(|k| k.unsigned_abs()).sum();
        let share = move |m: u32| k.iter().map(|k| Rational::from((*k, m))).collect();
        (1..=EXACT.saturating_sub(size)).map(move |m| (size + m, share(m)))
    })
}

/// The q_j of the resonance sum_j q_j nu_j that a rate is up to the rounding of irrational frequencies, of the lowest order.
pub(super) fn combination(rate: &Rational, frequencies: &[Rational]) -> Option<Vec<Rational>> {
    let bound = Rational::from(rate / (Integer::from(1) << SAME)).abs();
    let same = |q: &Vec<Rational>| (sum(q, frequencies) - rate).abs() <= bound;
    let all = resonances(frequencies).filter(|(_, q)| same(q));
    all.min_by_key(|(size, _)| *size).map(|(_, q)| q)
}

/// Of a resonance that holds exactly.
const EXACT: u32 = 10;
/// Of one that is looked for beside a rate.
const NEAR: u32 = 4;
/// Bits to which rates are the same that are rational numbers beside an irrational one.
const SAME: u32 = 100;

/// Whole numbers k_1, ..., k_M, not all zero, with sum |k_j| below [`EXACT`] or, of many unknowns, below what
/// leaves some thousands; never below [`NEAR`].
fn combinations(unknowns: usize) -> Vec<Vec<i32>> {
    let most = match unknowns {
        0..=4 => EXACT,
        5 | 6 => 7,
        _ => NEAR,
    };
    let most = most.cast_signed();
    let mut list = vec![Vec::new()];
    for _ in 0..unknowns {
        let longer = list.iter().flat_map(|k: &Vec<i32>| {
            let rest = most - 1 - k.iter().map(|k| k.abs()).sum::<i32>();
            (-rest..=rest).map(|next| k.iter().copied().chain([next]).collect())
        });
        list = longer.collect();
    }
    list.retain(|k| k.iter().any(|k| *k != 0));
    list
}
