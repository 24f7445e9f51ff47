//! The terms of an equation sorted for Melnikov's method, and carried over to the coordinate y of its orbit.

use crate::bound::{bind, missing, multiply_out, named, rest};
use crate::factors::{Factors, Frame, factors};
use crate::forces::{Kind, Term, kind};
use crate::in_pi::InPi;
use crate::law::FrictionLaw;
use crate::numeric::NumericOrbit;
use crate::potential;
use crate::refusal::{Refusal, Why};
use crate::threshold::Perturbation;
use lindstedt_equation::monomials::{Monomial, Monomials};
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::{Damping, Factor, Forcing, Harmonic, Potential};
use lindstedt_number::Exact;
use rug::{Rational, ops::Pow};
use std::collections::BTreeMap;

/// The unperturbed oscillator.
#[derive(Clone, Debug)]
pub enum Unperturbed {
    /// One with a closed orbit, in y with x = s y + constant.
    Closed {
        /// y'' = ...
        potential: Potential,
        /// s, not 0.
        scale: Rational,
    },
    /// Any other smooth force, followed numerically.
    Numeric(Box<NumericOrbit>),
}

/// The term c g(x) x'^j of friction.
struct Part {
    factors: Factors,
    velocity: u32,
    size: Exact,
}

/// The terms of x'' + rest = 0 with values.
pub(crate) struct Terms {
    /// Without values.
    pub rest: Expression,
    pub bound: Expression,
    force: Monomials,
    friction: Monomials,
    damping: Vec<Part>,
    /// By frequency, each with the term that it is.
    pub forces: Vec<(Expression, Term)>,
}

impl Terms {
    /// Sorts the terms.
    pub fn read(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Self, Refusal> {
        if problem.impact.is_some() {
            return Err(Refusal::Wall);
        }
        let rest = rest(problem)?;
        missing(&rest.parameters(), values)?;
        let bound = bind(&rest, values);
        let all = multiply_out(&bound)?;
        let (mut force, mut friction) = (Monomials::default(), Monomials::default());
        (force.atoms, friction.atoms) = (all.atoms.clone(), all.atoms.clone());
        let (mut damping, mut forces) = (Vec::new(), Vec::new());
        for (m, q) in &all.terms {
            let refuse =
                |why| named(&rest, values, (all.tree(m, q), why), &|all, m| kind(all, m).err());
            match kind(&all, m).map_err(refuse)? {
                Kind::Force => {
                    force.terms.insert(m.clone(), Rational::from(-q));
                }
                Kind::Friction => {
                    friction.terms.insert(m.clone(), q.clone());
                }
                Kind::Damping => {
                    let (factor, coefficient) = (Factor::Power(m.x), Exact::from(0));
                    Damping { factor, velocity: m.velocity, coefficient }.check()?;
                    damping.push(part(&all, m, q).map_err(refuse)?);
                }
                Kind::Harmonic => {
                    Factor::Power(m.x).check()?;
                    let found = Term::new(&all, m, &Rational::from(-q)).map_err(refuse)?;
                    forces.push((all.tree(m, q), found));
                }
            }
        }
        forces.sort_by(|a, b| a.1.before(&b.1));
        Ok(Self { rest, bound, force, friction, damping, forces })
    }

    /// The problem in y, and whether friction jumps: on an orbit in closed form, if one is wanted and takes all factors
    /// of x, else on numeric ones.
    pub fn on_orbit(
        &self,
        forcing: Forcing,
        closed: bool,
    ) -> Result<(Unperturbed, Perturbation, bool), Refusal> {
        let off = |e: &Expression| matches!(e, Expression::Time).then(|| Expression::integer(0));
        let law = FrictionLaw::new(&self.bound.substitute(&off), &self.friction)?;
        let known = potential::closed(&self.force).filter(|_| closed);
        let closed = known.and_then(|(potential, frame)| {
            potential.check().ok()?;
            let damping = self.damping_in(&frame, &|factor| potential.takes_damping(factor))?;
            let forcing = forcing_in(&forcing, &frame, &|factor| potential.takes_force(factor))?;
            let scale = frame.scale.clone();
            Some((Unperturbed::Closed { potential, scale }, frame, damping, forcing))
        });
        let (unperturbed, frame, damping, forcing) = match closed {
            Some(found) => found,
            None => {
                let orbit = NumericOrbit::find(&self.force)?;
                let damping = self.damping_in(&Frame::identity(), &|_| true);
                let damping = damping.ok_or(Refusal::NoOrbit)?;
                (Unperturbed::Numeric(Box::new(orbit)), Frame::identity(), damping, forcing)
            }
        };
        let jumps = law.jumps();
        let (friction, belt_speed) = law.scaled(&frame.scale);
        let perturbation = Perturbation { friction, damping, forcing, belt_speed };
        Ok((unperturbed, perturbation, jumps))
    }

    /// s y'' = ... - c g(s y + shift) (s y')^j.
    fn damping_in(&self, frame: &Frame, takes: &dyn Fn(&Factor) -> bool) -> Option<Vec<Damping>> {
        let mut found = Vec::new();
        for part in &self.damping {
            let velocity = part.velocity;
            let size = Rational::from((&frame.scale).pow(i32::try_from(velocity).ok()? - 1));
            for (factor, q) in &part.factors {
                for (factor, r) in frame.moved(factor).filter(|list| list.keys().all(takes))? {
                    let weight = Rational::from(q * &r) * &size;
                    let coefficient = part.size.times(&weight);
                    found.push(Damping { factor, velocity, coefficient });
                }
            }
        }
        Some(found)
    }
}

/// A term of friction that depends on x.
fn part(all: &Monomials, m: &Monomial, q: &Rational) -> Result<Part, Why> {
    let factors = factors(all, m, None).ok_or(Why::PositionFactor)?;
    let mut size = InPi::default();
    let size = size.add(m, q).and_then(|()| size.value()).ok_or(Why::Irrational)?;
    Ok(Part { factors, velocity: m.velocity, size })
}

/// s y'' = ... + gamma g(s y + shift) cos(omega t), gamma = |s| gamma_y.
fn forcing_in(
    forcing: &Forcing,
    frame: &Frame,
    takes: &dyn Fn(&Factor) -> bool,
) -> Option<Forcing> {
    let moved = |harmonics: &[Harmonic]| {
        let mut found = Vec::new();
        for harmonic in harmonics {
            for (factor, q) in frame.moved(&harmonic.factor).filter(|l| l.keys().all(takes))? {
                let weight = harmonic.weight.times(&(q * Rational::from(frame.scale.signum_ref())));
                found.push(Harmonic { factor, weight, ..harmonic.clone() });
            }
        }
        Some(found)
    };
    Some(match forcing {
        Forcing::Harmonics { omega, harmonics } => {
            Forcing::Harmonics { omega: omega.clone(), harmonics: moved(harmonics)? }
        }
        _ => {
            let parts = forcing.parts().map(|(omega, list)| Some((omega.clone(), moved(list)?)));
            Forcing::Incommensurate(parts.collect::<Option<_>>()?)
        }
    })
}
