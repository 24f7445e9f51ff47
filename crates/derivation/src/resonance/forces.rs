//! The phases of the forces: cos and sin of (A + eps B_1 + eps^2 B_2 + ...) t + phi, all of them whole multiples
//! of one phase eta with eta' = Omega + eps sigma_1 + eps^2 sigma_2 + ..., up to constants.

use super::{Names, ResonanceError};
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use rug::{Integer, Rational};

/// The rate of an angle, order by order in the small parameter.
type Rate = Vec<Expression>;

/// The force's phase: eta' = rate + eps detuning_1 + ..., eta(0) = start.
pub(super) struct Phase {
    /// Omega > 0, or 0 where there is no force.
    pub rate: Rational,
    /// sigma_1, sigma_2, ...
    pub detuning: Vec<Expression>,
    /// eta at t = 0: a number or a constant of parameters.
    pub start: Expression,
}

/// rate * t + start.
struct Angle {
    rate: Rate,
    start: Expression,
}

/// Whether this is a harmonic function of the time.
pub(super) fn is_wave(e: &Expression) -> bool {
    matches!(e, Expression::Function(Function::Cos | Function::Sin, angle)
        if angle.contains(&Expression::Time))
}

/// The parts of an angle rate * t + start; nothing for an angle of another form.
fn parts(angle: &Expression) -> Option<Angle> {
    let all = expand(angle)?;
    let still = |m: &Monomial| m.x == 0 && m.velocity == 0;
    let in_time = |m: &Monomial| still(m) && m.atoms.len() == 1 && m.atoms.get("t") == Some(&1);
    let at_start = |m: &Monomial| still(m) && m.atoms.is_empty() && m.order == 0;
    let highest = all.terms.keys().filter(|m| in_time(m)).map(|m| m.order).max()?;
    let order = |n| all.coefficient(|m| m.order == n && in_time(m));
    let known = all.terms.keys().all(|m| in_time(m) || at_start(m));
    let start = all.coefficient(at_start);
    known.then(|| Angle { rate: (0..=highest).map(order).collect(), start })
}

/// An angle of numbers, later by `delay`.
pub(super) fn delayed(angle: &Expression, delay: &Expression) -> Option<Expression> {
    let rate = parts(angle)?.rate.swap_remove(0);
    (angle.clone() - rate * delay.clone()).multiplied_out().map(|e| e.canonical())
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

/// The phase of all forces, and the equations with functions of m Omega t in the place of every force: with
/// the detuning and the phase at t = 0 taken out. That of the first force is eta's; what another one is ahead of
/// it stays, as constants cos(phi) and sin(phi).
pub(super) fn phase(
    equations: &[Expression],
    names: Names<'_>,
) -> Result<(Phase, Vec<Expression>), ResonanceError> {
    let mut found: Vec<(Rational, Angle)> = Vec::new();
    for wave in equations.iter().flat_map(Expression::nodes).filter(|e| is_wave(e)) {
        let mut angle = angle_of(wave, names)?;
        let slow = || ResonanceError::NotAForce { term: names.shown(wave) };
        let leading = angle.rate.remove(0).as_number().filter(|q| !q.is_zero()).ok_or_else(slow)?;
        found.push((leading, angle));
    }
    let Some((first, Angle { rate: detuning, start })) = found.first() else {
        let phase = Phase { rate: Rational::new(), detuning: Vec::new(), start: 0.into() };
        return Ok((phase, equations.to_vec()));
    };
    // A harmonic of the same phase is detuned in the same ratio.
    for (rate, Angle { rate: own, .. }) in &found {
        let ratio = Rational::from(rate / first);
        let at = |list: &Rate, n: usize| list.get(n).cloned().unwrap_or_else(|| 0.into());
        let differs = |n| gap(&at(own, n), &ratio, &at(detuning, n)).is_some();
        if (0..own.len().max(detuning.len())).any(differs) {
            return Err(ResonanceError::SecondPhase);
        }
    }
    let omega = found.iter().fold(Rational::new(), |omega, (rate, _)| divisor(&omega, rate));
    let scale = Expression::Number(Rational::from(&omega / first));
    let scaled = |e: &Expression| (scale.clone() * e.clone()).canonical();
    let phase = Phase {
        rate: omega,
        detuning: detuning.iter().map(scaled).collect(),
        start: scaled(start),
    };
    let rewritten = |e: &Expression| {
        let (Expression::Function(function, _), true) = (e, is_wave(e)) else { return None };
        let Angle { mut rate, start: own } = angle_of(e, names).ok()?;
        let leading = rate.swap_remove(0).as_number()?;
        let ahead = gap(&own, &Rational::from(&leading / first), start);
        Some(ahead_of(*function, Expression::Number(leading) * Expression::Time, ahead))
    };
    Ok((phase, equations.iter().map(|e| e.map(&rewritten)).collect()))
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
    let quarters = ahead.clone() * Expression::integer(2) * Expression::parameter("pi").pow(-1);
    let quarters = quarters.multiplied_out().and_then(|e| e.canonical().as_number());
    let whole = quarters.filter(Rational::is_integer).map(|q| q.numer().mod_u(4));
    match whole {
        Some(n) => {
            let cos = [1, 0, -1, 0];
            let at = |n: u32| Expression::integer(cos[n as usize % 4]);
            // sin of n quarters is the cosine of n - 1.
            [at(n), at(n + 3)]
        }
        None => [Function::Cos, Function::Sin].map(|function| {
            let text = ahead.clone().apply(function).print("eps", Style::Text);
            Expression::parameter(&text)
        }),
    }
}

/// The largest rational number of which both are whole multiples; of 0 and q, |q|.
pub(super) fn divisor(p: &Rational, q: &Rational) -> Rational {
    let [left, right] =
        [Integer::from(p.numer() * q.denom()), Integer::from(q.numer() * p.denom())];
    Rational::from((left.gcd(&right), Integer::from(p.denom() * q.denom())))
}

/// The resonance sum_j k_j nu_j = m Omega that a rate is near without being at it, as the rate at it;
/// nothing where the rate is at a resonance itself or near none.
///
/// At: sum |k_j| + m at most [`EXACT`]; near: at most [`NEAR`], and the rates differ by a tenth at most.
pub(super) fn near(rate: &Rational, frequencies: &[Rational]) -> Option<Rational> {
    let mut best: Option<(u32, Rational, Rational)> = None;
    for k in combinations(frequencies.len(), EXACT) {
        let sum: Rational = k.iter().zip(frequencies).map(|(k, nu)| Rational::from(nu * *k)).sum();
        let size: u32 = k.iter().map(|k| k.unsigned_abs()).sum();
        for m in 1..=EXACT.saturating_sub(size) {
            let at = Rational::from(&sum / m).abs();
            if at == *rate {
                return None;
            }
            let gap = Rational::from(&at - rate).abs() / rate;
            let close = !at.is_zero() && size + m <= NEAR && gap <= Rational::from((1, 10));
            let better =
                |(order, other, _): &(u32, Rational, _)| (size + m, &gap) < (*order, other);
            if close && best.as_ref().is_none_or(better) {
                best = Some((size + m, gap, at));
            }
        }
    }
    best.map(|(_, _, at)| at)
}

/// Of a resonance that holds exactly.
const EXACT: u32 = 10;
/// Of one that is looked for beside a rate.
const NEAR: u32 = 4;

/// Whole numbers k_1, ..., k_M, not all zero, with sum |k_j| below `most`.
fn combinations(unknowns: usize, most: u32) -> Vec<Vec<i32>> {
    let most = i32::try_from(most).unwrap_or(0);
    let mut list = vec![Vec::new()];
    for _ in 0..unknowns.min(3) {
        let longer = list.iter().flat_map(|k: &Vec<i32>| {
            let rest = most - 1 - k.iter().map(|k| k.abs()).sum::<i32>();
            (-rest..=rest).map(|next| k.iter().copied().chain([next]).collect())
        });
        list = longer.collect();
    }
    list.retain(|k| k.iter().any(|k| *k != 0));
    list
}
