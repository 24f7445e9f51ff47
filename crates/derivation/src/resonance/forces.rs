//! The phases of the forces: cos and sin of (A + eps B_1 + eps^2 B_2 + ...) t, all of them whole multiples of
//! one phase eta with eta' = Omega + eps sigma_1 + eps^2 sigma_2 + ...

use super::ResonanceError;
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Function};
use rug::{Integer, Rational};

/// The rate of an angle, order by order in the small parameter.
type Rate = Vec<Expression>;

/// The force's phase.
pub(super) struct Phase {
    /// Omega > 0, or 0 where there is no force.
    pub rate: Rational,
    /// sigma_1, sigma_2, ...
    pub detuning: Vec<Expression>,
}

/// Whether this is a harmonic function of the time.
pub(super) fn is_wave(e: &Expression) -> bool {
    matches!(e, Expression::Function(Function::Cos | Function::Sin, angle)
        if angle.contains(&Expression::Time))
}

/// The rate of an angle rate * t; nothing for an angle of another form.
fn rate(angle: &Expression) -> Option<Rate> {
    let all = expand(angle)?;
    let linear = |m: &Monomial| m.x == 0 && m.velocity == 0 && m.atoms.len() == 1;
    let in_time = |m: &Monomial| linear(m) && m.atoms.get("t") == Some(&1);
    let highest = all.terms.keys().map(|m| m.order).max()?;
    all.terms.keys().all(in_time).then(|| (0..=highest).map(|n| of_order(&all, n)).collect())
}

fn of_order(all: &Monomials, n: u32) -> Expression {
    all.coefficient(|m| m.order == n)
}

/// The rates at order zero of all angles: what must have a value.
pub(super) fn leading_rates(equations: &[Expression]) -> Result<Vec<Expression>, ResonanceError> {
    let nodes = equations.iter().flat_map(Expression::nodes).filter(|e| is_wave(e));
    nodes.map(|wave| Ok(angle_of(wave)?.swap_remove(0))).collect()
}

fn angle_of(wave: &Expression) -> Result<Rate, ResonanceError> {
    let refused = || ResonanceError::NotAForce { term: super::shown(wave) };
    let Expression::Function(_, angle) = wave else { return Err(refused()) };
    rate(angle).ok_or_else(refused)
}

/// The phase of all forces, and the equations with cos(m Omega t) in the place of every force: with the
/// detuning taken out.
pub(super) fn phase(equations: &[Expression]) -> Result<(Phase, Vec<Expression>), ResonanceError> {
    let mut found: Vec<(Rational, Rate)> = Vec::new();
    for wave in equations.iter().flat_map(Expression::nodes).filter(|e| is_wave(e)) {
        let mut rate = angle_of(wave)?;
        let slow = || ResonanceError::NotAForce { term: super::shown(wave) };
        let leading = rate.remove(0).as_number().filter(|q| !q.is_zero()).ok_or_else(slow)?;
        found.push((leading, rate));
    }
    let Some((first, detuning)) = found.first() else {
        return Ok((Phase { rate: Rational::new(), detuning: Vec::new() }, equations.to_vec()));
    };
    // A harmonic of the same phase is detuned in the same ratio.
    for (rate, own) in &found {
        let ratio = Rational::from(rate / first);
        let orders = own.len().max(detuning.len());
        let at = |list: &Rate, n: usize| list.get(n).cloned().unwrap_or_else(|| 0.into());
        let same = (0..orders).all(|n| {
            let gap = at(own, n) - Expression::Number(ratio.clone()) * at(detuning, n);
            expand(&gap).is_some_and(|all| all.terms.is_empty())
        });
        if !same {
            return Err(ResonanceError::SecondPhase);
        }
    }
    let omega = found.iter().fold(Rational::new(), |omega, (rate, _)| divisor(&omega, rate));
    let scale = Expression::Number(Rational::from(&omega / first));
    let detuning = detuning.iter().map(|sigma| (scale.clone() * sigma.clone()).canonical());
    let phase = Phase { rate: omega, detuning: detuning.collect() };
    let rewritten = |e: &Expression| {
        let (Expression::Function(function, _), true) = (e, is_wave(e)) else { return None };
        let leading = angle_of(e).ok()?.swap_remove(0).as_number()?;
        Some((Expression::Number(leading) * Expression::Time).apply(*function))
    };
    Ok((phase, equations.iter().map(|e| e.map(&rewritten)).collect()))
}

/// The largest rational number of which both are whole multiples; of 0 and q, |q|.
fn divisor(p: &Rational, q: &Rational) -> Rational {
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
