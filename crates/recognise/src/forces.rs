//! The terms of Melnikov's form, and the harmonic forces among them.

use crate::bound::PI;
use crate::in_pi::InPi;
use crate::refusal::Why;
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Function};
use lindstedt_melnikov::{Forcing, Harmonic};
use lindstedt_number::Exact;
use rug::{Integer, Rational};

/// Harmonics k omega up to this k.
const LARGEST_HARMONIC: u32 = 10_000;

/// What a term can be.
pub(crate) enum Kind {
    Force,
    Friction,
    Harmonic,
}

pub(crate) fn kind(all: &Monomials, m: &Monomial) -> Result<Kind, Why> {
    let atoms = || m.atoms.keys().filter_map(|key| all.atoms.get(key));
    let holds = |e: &Expression| atoms().any(|atom| atom.contains(e));
    let any = |wanted: &dyn Fn(&Expression) -> bool| atoms().any(|a| a.find(wanted).is_some());
    if any(&Expression::is_delayed) {
        return Err(Why::Delay);
    }
    if any(&|e| matches!(e, Expression::Formal(..))) {
        return Err(Why::Formal);
    }
    if holds(&Expression::Small) {
        return Err(Why::SmallInside);
    }
    let time = holds(&Expression::Time);
    let velocity = m.velocity > 0 || holds(&Expression::VELOCITY);
    let position = m.x > 0 || holds(&Expression::DISPLACEMENT);
    match m.order {
        0 if time || velocity => Err(Why::NotSmall),
        0 => Ok(Kind::Force),
        1 if time => {
            let harmonic = m.atoms.values().eq(&[1]) && atoms().all(|e| angle(e).is_some());
            if !harmonic || velocity || m.x > 1 {
                Err(Why::NotHarmonic)
            } else {
                Ok(Kind::Harmonic)
            }
        }
        1 if position => Err(Why::DependsOnPosition),
        1 => Ok(Kind::Friction),
        _ => Err(Why::HigherOrder),
    }
}

/// (terms in t, terms without) of the argument of a sine or cosine of omega t + phase.
fn angle(e: &Expression) -> Option<(Monomials, Monomials)> {
    let Expression::Function(Function::Sin | Function::Cos, argument) = e else { return None };
    let all = expand(argument)?;
    let (mut frequency, mut phase) = (Monomials::default(), Monomials::default());
    for (m, q) in all.terms {
        (m.order == 0 && m.x == 0 && m.velocity == 0).then_some(())?;
        let part = match m.atoms.iter().next() {
            None => &mut phase,
            Some((key, 1)) if key == "t" && m.atoms.len() == 1 => &mut frequency,
            Some(_) => return None,
        };
        part.terms.insert(m, q);
    }
    (!frequency.terms.is_empty()).then_some((frequency, phase))
}

fn sum(part: &Monomials) -> Option<InPi> {
    let mut sum = InPi::default();
    part.terms.iter().try_for_each(|(m, q)| sum.add(m, q))?;
    Some(sum)
}

/// omega of a bound sine or cosine of omega t + phase, with its sign.
pub(crate) fn frequency(atom: &Expression) -> Option<Exact> {
    sum(&angle(atom)?.0)?.value()
}

/// The frequency of a force whose amplitude is zero at the values given.
pub(crate) fn silent_frequency(bound: &Expression) -> Option<Exact> {
    let term = bound.find(&|e| angle(e).is_some())?;
    Some(frequency(term)?.abs())
}

/// One harmonic force g x^p cos(omega t + phase).
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub omega: Exact,
    /// In radians; nothing where it is a sum of a rational number and a multiple of pi.
    phase: Option<Exact>,
    size: Exact,
    parametric: bool,
}

impl Term {
    pub fn new(all: &Monomials, m: &Monomial, q: &Rational) -> Option<Self> {
        let atom = all.atoms.get(m.atoms.keys().next()?)?;
        let (frequency, phase) = angle(atom)?;
        let omega = sum(&frequency)?.value()?;
        let mut phase = sum(&phase)?;
        // cos(-z) = cos z.
        if omega.sign().is_lt() {
            phase = phase.neg();
        }
        if matches!(atom, Expression::Function(Function::Sin, _)) {
            let quarter = if omega.sign().is_lt() { 1 } else { -1 };
            let mut turn = InPi::of(&Expression::parameter(PI))?;
            turn = turn.scaled(&Rational::from((quarter, 2)));
            phase = phase.plus(&turn);
        }
        let mut size = InPi::default();
        size.add(m, q)?;
        Some(Self {
            omega: omega.abs(),
            phase: phase.value(),
            size: size.value()?,
            parametric: m.x == 1,
        })
    }
}

/// The force of unit lowest amplitude, and that amplitude; terms by rising frequency.
pub(crate) fn forcing(terms: &[Term]) -> Result<(Forcing, Exact), Why> {
    let first = terms.first().ok_or(Why::NotHarmonic)?;
    if terms.iter().any(|t| t.parametric) {
        return match terms {
            [only] => Ok((Forcing::Parametric { omega: only.omega.clone() }, only.size.clone())),
            _ => Err(Why::Parametric),
        };
    }
    if let [only] = terms {
        return Ok((Forcing::single(only.omega.clone()), only.size.clone()));
    }
    let weights: Option<Vec<Rational>> = terms.iter().map(|t| t.size.ratio(&first.size)).collect();
    let weights = weights.ok_or(Why::Irrational)?;
    let ratios: Option<Vec<Rational>> = terms.iter().map(|t| t.omega.ratio(&first.omega)).collect();
    let Some(ratios) = ratios else {
        // A rational number and a rational multiple of pi have no common period.
        if terms.len() > 2 {
            return Err(Why::NotHarmonic);
        }
        let list = terms.iter().zip(weights).map(|(t, w)| (t.omega.clone(), Exact::Rational(w)));
        return Ok((Forcing::Incommensurate(list.collect()), first.size.clone()));
    };
    // The work of several harmonics has other extrema below than above.
    if first.size.sign().is_lt() {
        return Err(Why::NegativeForce);
    }
    // omega_i = ratio_i omega_1 = k_i omega with the largest omega.
    let common = ratios.iter().fold(Integer::from(1), |c, r| c.lcm(r.denom()));
    let whole: Vec<Integer> =
        ratios.iter().map(|r| Integer::from(&common / r.denom()) * r.numer()).collect();
    let divisor = whole.iter().fold(Integer::new(), |d, k| d.gcd(k));
    let omega = first.omega.times(&Rational::from((divisor.clone(), common)));
    let mut harmonics = Vec::new();
    for ((term, k), weight) in terms.iter().zip(whole).zip(weights) {
        let order = (k / &divisor).to_u32().filter(|k| *k <= LARGEST_HARMONIC);
        harmonics.push(Harmonic {
            order: order.ok_or(Why::NotHarmonic)?,
            weight: Exact::Rational(weight),
            phase: term.phase.clone().ok_or(Why::Irrational)?,
        });
    }
    Ok((Forcing::Harmonics { omega, harmonics }, first.size.clone()))
}
