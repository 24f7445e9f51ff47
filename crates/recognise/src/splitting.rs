//! x'' = f(x) + eps (gamma d - h) at the values of its parameters: the threshold to second order on every orbit,
//! and the equation with gamma free for whoever follows its manifolds.

use crate::bound::{bind, multiply_out, of_value, rest};
use crate::forces::{Kind, kind};
use crate::local::Point;
use crate::lowest::LowestHarmonic;
use crate::melnikov::MelnikovProblem;
use crate::numeric::NumericOrbit;
use crate::reading::Unperturbed;
use crate::refusal::{Refusal, Why};
use lindstedt_algebra::Stop;
use lindstedt_equation::monomials::Monomials;
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::splitting::{Connection, SecondOrder, Splitting};
use lindstedt_melnikov::{Forcing, Verdict};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use rug::Rational;
use std::collections::BTreeMap;

/// The name of gamma in [`SplittingProblem::equation`].
pub const GAMMA: &str = "gamma";

/// A problem in the form that [`Splitting`] takes.
#[derive(Clone, Debug)]
pub struct SplittingProblem {
    force: Expression,
    drive: Expression,
    friction: Expression,
    omega: f64,
    harmonics: u32,
    kink: Option<f64>,
    orbits: NumericOrbit,
}

/// The threshold of one orbit to second order.
#[derive(Clone, Debug)]
pub struct OrbitSplitting {
    /// Which orbit.
    pub name: &'static str,
    /// The orbit.
    pub orbit: Connection,
    /// gamma_0 and gamma_1; nothing where they were not found.
    pub found: Option<SecondOrder>,
}

impl SplittingProblem {
    /// From a problem, the values of its parameters and what Melnikov's method found in it.
    ///
    /// # Errors
    /// [`Refusal::NoPeriod`] for forces without a common period, [`Refusal::Tangent`] where v* = 0 or |v*| = V and
    /// friction jumps or bends there, [`Refusal::SilentForces`], [`Refusal::NoOrbit`].
    pub fn new(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        found: &MelnikovProblem,
    ) -> Result<Self, Refusal> {
        if found.amplitude.sign().is_eq() {
            return Self::silent(problem, values);
        }
        let (omega, harmonics) = match &found.perturbation.forcing {
            Forcing::Harmonics { omega, harmonics } => {
                (omega.to_f64(), harmonics.iter().map(|h| h.number).max().unwrap_or(1))
            }
            _ => return Err(Refusal::NoPeriod),
        };
        let kink = if found.jumps() || found.bends() { kink(found)? } else { None };
        let all = multiply_out(&bind(&rest(problem)?, values))?;
        let [mut force, mut drive, mut friction] = [(); 3].map(|()| Vec::new());
        let mut of_x = Monomials { atoms: all.atoms.clone(), ..Monomials::default() };
        for (m, q) in &all.terms {
            let refused = |why: Why| Refusal::Term { term: Box::new(all.tree(m, q)), why };
            let mut bare = m.clone();
            bare.order = 0;
            match kind(&all, m).map_err(refused)? {
                Kind::Force => {
                    of_x.terms.insert(m.clone(), Rational::from(-q));
                    force.push(all.tree(&bare, &Rational::from(-q)));
                }
                Kind::Harmonic => drive.push(all.tree(&bare, &Rational::from(-q))),
                Kind::Friction | Kind::Damping => friction.push(all.tree(&bare, q)),
            }
        }
        let orbits = NumericOrbit::find(&of_x)?;
        let sum = |terms| Expression::Sum(terms).canonical();
        let drive = (sum(drive) * of_value(&found.amplitude).pow(-1)).canonical();
        let (force, friction) = (sum(force), sum(friction));
        Ok(Self { force, drive, friction, omega, harmonics, kink, orbits })
    }

    /// Where the force is zero: as it is at another value of its parameter.
    fn silent(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Self, Refusal> {
        let lowest = LowestHarmonic::find(problem, values).and_then(|lowest| lowest.parameter);
        let (name, _) = lowest.ok_or(Refusal::SilentForces)?;
        let mut values = values.clone();
        values.insert(name, Exact::from(1));
        let found = MelnikovProblem::new(problem, &values)?;
        if found.amplitude.sign().is_eq() {
            return Err(Refusal::SilentForces);
        }
        Self::new(problem, &values, &found)
    }

    /// 2 pi/omega, the period of the force.
    #[must_use]
    pub fn period(&self) -> f64 {
        2.0 * std::f64::consts::PI / self.omega
    }

    /// x'' - f + eps (h - gamma d) with gamma and eps free.
    #[must_use]
    pub fn equation(&self) -> Expression {
        let perturbation =
            self.friction.clone() - Expression::parameter(GAMMA) * self.drive.clone();
        Expression::ACCELERATION - self.force.clone() + Expression::Small * perturbation
    }

    /// Every orbit: right loop before left, upper before lower. Estimated; once `stop` says so none is found.
    #[must_use]
    pub fn orbits(&self, stop: &Stop) -> Vec<OrbitSplitting> {
        let splitting = Splitting {
            force: &|x| Point::at(0.0, x, 0.0).local(&self.force).map(|[f, slope, _]| [f, slope]),
            drive: &|t, x, v| Point::at(t, x, v).local(&self.drive),
            friction: &|x, v| Point::at(0.0, x, v).local(&self.friction),
            period: self.period(),
            harmonics: self.harmonics,
            kink: self.kink,
            stop,
        };
        let one = |(name, orbit): (&'static str, Connection)| OrbitSplitting {
            name,
            orbit,
            found: splitting.second_order(&orbit),
        };
        self.orbits.connections().map(one).collect()
    }
}

/// v*, where the unperturbed orbits pass it with a speed; nothing where they rest at it, and only bend.
fn kink(found: &MelnikovProblem) -> Result<Option<f64>, Refusal> {
    let scale = match &found.unperturbed {
        Unperturbed::Closed { scale, .. } => scale.to_f64(),
        Unperturbed::Numeric(_) => 1.0,
    };
    match found.verdict(Balls::new(200), 0.0) {
        Some(Verdict::Fails) | None if found.jumps() => Err(Refusal::Tangent),
        _ if found.perturbation.belt_speed.sign().is_eq() => Ok(None),
        _ => Ok(Some(found.perturbation.belt_speed.to_f64() * scale)),
    }
}
