//! The terms of Melnikov's form, and the harmonic forces among them.

use crate::bound::PI;
use crate::factors::{Factors, factors, is_wave};
use crate::in_pi::InPi;
use crate::refusal::Why;
use lindstedt_algebra::common_measure;
use lindstedt_equation::monomials::{self, Monomial, Monomials};
use lindstedt_equation::{Expression, Function};
use lindstedt_melnikov::{Forcing, Harmonic};
use lindstedt_number::Exact;
use rug::Rational;
use std::cmp::Ordering;

/// Harmonics k omega up to this k.
const LARGEST_HARMONIC: u32 = 10_000;

/// What a term can be.
pub(crate) enum Kind {
    Force,
    /// Of x' alone.
    Friction,
    /// g(x) x'^j.
    Damping,
    /// g(x) cos(omega t + phase).
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
            let waves = || m.atoms.iter().filter_map(|(key, n)| Some((all.atoms.get(key)?, *n)));
            let moving = || waves().filter(|(e, _)| e.contains(&Expression::Time));
            let harmonic = moving().count() == 1 && moving().all(|(e, n)| n == 1 && is_harmonic(e));
            let still = waves().all(|(e, _)| e.contains(&Expression::Time) || is_wave(e));
            if harmonic && still && !velocity { Ok(Kind::Harmonic) } else { Err(Why::NotHarmonic) }
        }
        1 if position && atoms().all(is_wave) => Ok(Kind::Damping),
        1 if position => Err(Why::DependsOnPosition),
        1 => Ok(Kind::Friction),
        _ => Err(Why::HigherOrder),
    }
}

/// Whether it is a sine or cosine of omega t + phase.
fn is_harmonic(e: &Expression) -> bool {
    angle(e).is_some()
}

/// The harmonic function among the atoms of a force, with its key.
pub(crate) fn harmonic_atom<'a>(
    all: &'a Monomials,
    m: &'a Monomial,
) -> Option<(&'a String, &'a Expression)> {
    let mut atoms = m.atoms.keys().filter_map(|key| Some((key, all.atoms.get(key)?)));
    atoms.find(|(_, e)| is_harmonic(e))
}

/// (terms in t, terms without) of the argument of a sine or cosine of omega t + phase.
fn angle(e: &Expression) -> Option<(Monomials, Monomials)> {
    let Expression::Function(Function::Sin | Function::Cos, argument) = e else { return None };
    let (rate, start) = monomials::angle(argument)?;
    let strong = rate.terms.keys().chain(start.terms.keys()).all(|m| m.order == 0);
    strong.then_some((rate, start))
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

/// What orders forces of one frequency: the power of x, the sines and cosines of x, the harmonic function.
pub(crate) type Place = (u32, Vec<(String, u32)>, String);

/// One harmonic force h g(x) cos(omega t + phase).
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub omega: Exact,
    pub place: Place,
    /// In radians; nothing where it is a sum of a rational number and a multiple of pi.
    phase: Option<Exact>,
    size: Exact,
    factors: Factors,
}

impl Term {
    pub fn new(all: &Monomials, m: &Monomial, q: &Rational) -> Result<Self, Why> {
        let (key, atom) = harmonic_atom(all, m).ok_or(Why::NotHarmonic)?;
        let factors = factors(all, m, Some(key)).ok_or(Why::PositionFactor)?;
        let others = m.atoms.iter().filter(|(other, _)| *other != key);
        let others = others.map(|(key, n)| (key.clone(), *n)).collect();
        let place = (m.x, others, key.clone());
        let (frequency, phase) = angle(atom).ok_or(Why::NotHarmonic)?;
        let omega = sum(&frequency).and_then(|sum| sum.value()).ok_or(Why::IrrationalFrequency)?;
        let known = || {
            let mut phase = sum(&phase)?;
            // cos(-z) = cos z.
            if omega.sign().is_lt() {
                phase = phase.neg();
            }
            if matches!(atom, Expression::Function(Function::Sin, _)) {
                let quarter = if omega.sign().is_lt() { 1 } else { -1 };
                let turn = InPi::of(&Expression::parameter(PI))?;
                phase = phase.plus(&turn.scaled(&Rational::from((quarter, 2))));
            }
            let mut size = InPi::default();
            size.add(m, q)?;
            Some((phase.value(), size.value()?))
        };
        let (phase, size) = known().ok_or(Why::Irrational)?;
        Ok(Self { omega: omega.abs(), place, phase, size, factors })
    }

    /// By frequency, then by place.
    pub fn before(&self, other: &Self) -> Ordering {
        let (a, b) = (self.omega.to_f64(), other.omega.to_f64());
        a.total_cmp(&b).then_with(|| self.place.cmp(&other.place))
    }
}

/// The force of unit lowest amplitude, and that amplitude; terms by rising frequency.
pub(crate) fn forcing(terms: &[Term]) -> Result<(Forcing, Exact), Why> {
    let first = terms.first().ok_or(Why::NotHarmonic)?;
    // Frequencies with a common period.
    let mut groups: Vec<Vec<&Term>> = Vec::new();
    for term in terms {
        let known = groups.iter_mut().find(|group| term.omega.ratio(&group[0].omega).is_some());
        match known {
            Some(group) => group.push(term),
            None => groups.push(vec![term]),
        }
    }
    let harmonics = |group: &Vec<&Term>| in_harmonics(group, &first.size);
    let mut parts = groups.iter().map(harmonics).collect::<Result<Vec<_>, _>>()?;
    let forcing = match parts.pop() {
        Some((omega, harmonics)) if parts.is_empty() => Forcing::Harmonics { omega, harmonics },
        last => {
            parts.extend(last);
            Forcing::Incommensurate(parts)
        }
    };
    // The work of several frequencies has other extrema below than above.
    let several = |group: &Vec<&Term>| group.iter().any(|term| term.omega != group[0].omega);
    if first.size.sign().is_lt() && groups.iter().any(several) {
        return Err(Why::NegativeForce);
    }
    Ok((forcing, first.size.clone()))
}

/// omega_i = ratio_i omega_1 = k_i omega with the largest omega, sizes in units of `unit`.
fn in_harmonics(group: &[&Term], unit: &Exact) -> Result<(Exact, Vec<Harmonic>), Why> {
    let first = group.first().ok_or(Why::NotHarmonic)?;
    let ratios: Option<Vec<Rational>> = group.iter().map(|t| t.omega.ratio(&first.omega)).collect();
    let ratios = ratios.ok_or(Why::NotHarmonic)?;
    let measure = ratios.iter().fold(Rational::new(), |q, ratio| common_measure(&q, ratio));
    let omega = first.omega.times(&measure);
    let mut harmonics = Vec::new();
    for (term, ratio) in group.iter().zip(ratios) {
        let number = (ratio / &measure).numer().to_u32().filter(|k| *k <= LARGEST_HARMONIC);
        let number = number.ok_or(Why::NotHarmonic)?;
        let size = term.size.ratio(unit).ok_or(Why::Irrational)?;
        // The phase of a force alone is the origin of time.
        let phase = if group.len() == 1 { Some(Exact::from(0)) } else { term.phase.clone() };
        let phase = phase.ok_or(Why::Irrational)?;
        harmonics.extend(term.factors.iter().map(|(factor, q)| Harmonic {
            number,
            weight: Exact::Rational(Rational::from(q * &size)),
            phase: phase.clone(),
            factor: factor.clone(),
        }));
    }
    Ok((omega, harmonics))
}
