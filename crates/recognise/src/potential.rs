//! The unperturbed force f(x): which of the potentials with a closed orbit it is.

use crate::bound::PI;
use crate::factors::Frame;
use crate::in_pi::InPi;
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::monomials::{Monomials, expand};
use lindstedt_equation::{Expression, Function};
use lindstedt_melnikov::Potential;
use lindstedt_number::Exact;
use rug::Rational;
use std::cmp::Ordering;

/// The most coefficients of a polynomial force.
const LARGEST_DEGREE: usize = 1000;

/// f(x) = sum_k f_k x^k with constants over Q\[pi\], of the terms of a sum; nothing for other forces.
pub(crate) fn polynomial(force: &Monomials) -> Option<Vec<InPi>> {
    let mut coefficients = Vec::new();
    for (m, q) in &force.terms {
        let k = usize::try_from(m.x).ok().filter(|k| *k <= LARGEST_DEGREE)?;
        (m.atoms.is_empty() && m.velocity == 0).then_some(())?;
        if coefficients.len() <= k {
            coefficients.resize(k + 1, InPi::default());
        }
        coefficients.get_mut(k)?.add(m, q)?;
    }
    while coefficients.last().is_some_and(InPi::is_zero) {
        coefficients.pop();
    }
    Some(coefficients)
}

/// The potential of y, where x = s y + constant turns x'' = f(x) into one with a closed orbit.
pub(crate) fn closed(force: &Monomials) -> Option<(Potential, Frame)> {
    if let Some(coefficients) = polynomial(force) {
        let list: Option<Vec<Exact>> = coefficients.iter().map(|c| c.value()).collect();
        return match list?.as_slice() {
            [f0, f1, f2] => quadratic(f0, f1, f2),
            [f0, f1, f2, f3] => cubic(f0, f1, f2, f3),
            [f0, f1, f2, f3, f4, f5] if [f0, f2, f4].iter().all(|f| f.sign().is_eq()) => {
                quintic(f1, f3, f5)
            }
            _ => None,
        };
    }
    sine(force)
}

/// x'' = f0 + f1 x + f2 x^2 about its saddle x_s: with y = -sgn(f2) (x - x_s),
/// y'' = a y - |f2| y^2, a = sqrt(f1^2 - 4 f0 f2).
fn quadratic(f0: &Exact, f1: &Exact, f2: &Exact) -> Option<(Potential, Frame)> {
    let a = if f0.sign().is_eq() {
        f1.abs()
    } else {
        let (f0, f1, f2) = (f0.as_rational()?, f1.as_rational()?, f2.as_rational()?);
        let square = Rational::from(f1.square_ref()) - Rational::from(f0 * f2) * 4u32;
        Exact::Rational(rational_root(&square)?)
    };
    a.sign().is_gt().then_some(())?;
    // x_s = (a - f1)/(2 f2).
    let saddle = a.ratio(f2).zip(f1.ratio(f2)).map(|(a, f1)| Exact::Rational((a - f1) / 2u32));
    let scale = Rational::from(if f2.sign().is_gt() { -1 } else { 1 });
    Some((Potential::Helmholtz { a, b: f2.abs() }, Frame { scale, shift: saddle }))
}

/// x'' = f0 + f1 x + f2 x^2 + f3 x^3, odd about x = -f2/(3 f3).
fn cubic(f0: &Exact, f1: &Exact, f2: &Exact, f3: &Exact) -> Option<(Potential, Frame)> {
    let mut shift = Rational::new();
    let slope = if f0.sign().is_eq() && f2.sign().is_eq() {
        f1.clone()
    } else {
        let (f0, f1) = (f0.as_rational()?, f1.as_rational()?);
        let (f2, f3) = (f2.as_rational()?, f3.as_rational()?);
        let centre = Rational::from(-f2) / (f3 * Rational::from(3));
        let at = |list: [&Rational; 4]| {
            list.iter().rev().fold(Rational::new(), |sum, f| sum * &centre + *f)
        };
        at([f0, f1, f2, f3]).is_zero().then_some(())?;
        let (twice, thrice) = (Rational::from(f2 * 2u32), Rational::from(f3 * 3u32));
        let slope = at([f1, &twice, &thrice, &Rational::new()]);
        shift = centre;
        Exact::Rational(slope)
    };
    let (a, b) = (slope.abs(), f3.abs());
    let potential = match (slope.sign(), f3.sign()) {
        (Ordering::Greater, Ordering::Less) => Potential::DoubleWell { a, b },
        (Ordering::Less, Ordering::Greater) => Potential::SoftDuffing { a, b },
        _ => return None,
    };
    let shift = Some(Exact::Rational(shift));
    Some((potential, Frame { scale: Rational::from(1), shift }))
}

/// x'' = f1 x + f3 x^3 + f5 x^5 is f1 y (1 - y^2)(1 - 3 y^2) with x = s y where 16 f1 f5 = 3 f3^2:
/// s^2 = -4 f1/f3.
fn quintic(f1: &Exact, f3: &Exact, f5: &Exact) -> Option<(Potential, Frame)> {
    let (f1, f3, f5) = (f1.as_rational()?, f3.as_rational()?, f5.as_rational()?);
    let tied = Rational::from(f1 * f5) * 16u32 == Rational::from(f3.square_ref()) * 3u32;
    (tied && !f3.is_zero()).then_some(())?;
    let scale = rational_root(&(Rational::from(f1 * -4i32) / f3))?;
    let frame = Frame { scale, shift: Some(Exact::from(0)) };
    f1.is_positive().then(|| (Potential::PhiSix { a: Exact::Rational(f1.clone()) }, frame))
}

/// x'' = A sin(k x + phase), or with a cosine: y = k x + phase, and half a turn more where A k > 0 and a
/// quarter more for a cosine, has y'' = -|A k| sin y.
fn sine(force: &Monomials) -> Option<(Potential, Frame)> {
    let [(m, q)] = force.terms.iter().collect::<Vec<_>>()[..] else { return None };
    let [(key, 1)] = m.atoms.iter().collect::<Vec<_>>()[..] else { return None };
    let Expression::Function(function @ (Function::Sin | Function::Cos), argument) =
        force.atoms.get(key)?
    else {
        return None;
    };
    (m.x == 0 && m.velocity == 0).then_some(())?;
    let (mut k, mut phase) = (Rational::new(), Some(InPi::default()));
    for (m, q) in &expand(argument)?.terms {
        if m.is_power(1, 0) && m.order == 0 && m.parameters.is_empty() {
            k += q;
        } else if m.is_power(0, 0) && m.order == 0 {
            phase = phase.and_then(|mut phase| phase.add(m, q).map(|()| phase));
        } else {
            return None;
        }
    }
    (!k.is_zero()).then_some(())?;
    let mut size = InPi::default();
    size.add(m, q)?;
    let slope = size.value()?.times(&k);
    let quarters = 2 * i32::from(slope.sign().is_gt()) + i32::from(*function == Function::Cos);
    let turn = InPi::of(&Expression::parameter(PI))?.scaled(&Rational::from((quarters, 2)));
    let scale = Rational::from(k.recip_ref());
    // x = (y - phase)/k.
    let shift = phase.and_then(|phase| phase.plus(&turn).value());
    let shift = shift.map(|shift| shift.times(&Rational::from(-&scale)));
    let a = slope.abs();
    a.sign().is_gt().then(|| (Potential::Pendulum { a }, Frame { scale, shift }))
}
