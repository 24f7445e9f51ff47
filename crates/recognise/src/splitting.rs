//! x'' = f(x) + eps (gamma d - h) at the values of its parameters: the threshold to second order on every orbit,
//! and the equation with gamma free for whoever follows its manifolds.

use crate::bound::{PI, bind, multiply_out, of_value, rest};
use crate::forces::{Kind, kind};
use crate::lowest::LowestHarmonic;
use crate::melnikov::MelnikovProblem;
use crate::numeric::NumericOrbit;
use crate::reading::Unperturbed;
use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::Monomials;
use lindstedt_equation::{Expression, Function, Operations, Problem, Unknown};
use lindstedt_melnikov::splitting::{Connection, Local, SecondOrder, Splitting};
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
                (omega.to_f64(), harmonics.iter().map(|h| h.order).max().unwrap_or(1))
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

    /// Every orbit: right loop before left, upper before lower. Estimated.
    #[must_use]
    pub fn orbits(&self) -> Vec<OrbitSplitting> {
        let splitting = Splitting {
            force: &|x| local(&self.force, [0.0, x, 0.0]).map(|[f, slope, _]| [f, slope]),
            drive: &|t, x, v| local(&self.drive, [t, x, v]),
            friction: &|x, v| local(&self.friction, [0.0, x, v]),
            period: self.period(),
            harmonics: self.harmonics,
            kink: self.kink,
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

/// The value at (t, x, x') with the derivatives by x and by x'; nothing where it is not finite.
fn local(e: &Expression, at: [f64; 3]) -> Option<Local> {
    e.evaluate(&mut At(at)).filter(|local| local.iter().all(|part| part.is_finite()))
}

/// A point (t, x, x').
struct At([f64; 3]);

/// F(z) from F and F' at the value of z.
fn chain(z: Local, value: f64, slope: f64) -> Local {
    [value, slope * z[1], slope * z[2]]
}

impl Operations for At {
    type Value = Local;

    fn number(&mut self, q: &Rational) -> Option<Local> {
        Some([q.to_f64(), 0.0, 0.0])
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Local> {
        let Self([t, x, v]) = *self;
        match leaf {
            Expression::Time => Some([t, 0.0, 0.0]),
            Expression::Parameter(name) if **name == *PI => Some([std::f64::consts::PI, 0.0, 0.0]),
            Expression::Unknown(Unknown { derivative: 0, delay: None, .. }) => Some([x, 1.0, 0.0]),
            Expression::Unknown(Unknown { derivative: 1, delay: None, .. }) => Some([v, 0.0, 1.0]),
            _ => None,
        }
    }

    fn add(&mut self, a: Local, b: Local) -> Option<Local> {
        Some([0, 1, 2].map(|k| a[k] + b[k]))
    }

    fn multiply(&mut self, a: Local, b: Local) -> Option<Local> {
        Some([a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0]])
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Local> {
        let z = base.evaluate(self)?;
        if let Some(n) =
            exponent.as_number().and_then(|n| n.is_integer().then(|| n.numer().to_i32())?)
        {
            return Some(chain(z, z[0].powi(n), f64::from(n) * z[0].powi(n - 1)));
        }
        // b^n = exp(n ln b), n a number or not.
        let [n, by_x, by_v] = exponent.evaluate(self)?;
        let value = z[0].powf(n);
        let slope = n * z[0].powf(n - 1.0);
        let growth = if by_x == 0.0 && by_v == 0.0 { 0.0 } else { value * z[0].ln() };
        Some([value, slope * z[1] + growth * by_x, slope * z[2] + growth * by_v])
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Local> {
        let z = argument.evaluate(self)?;
        let (value, slope) = match function {
            Function::Ln => (z[0].ln(), z[0].recip()),
            Function::Exp => (z[0].exp(), z[0].exp()),
            Function::Sin => (z[0].sin(), z[0].cos()),
            Function::Cos => (z[0].cos(), -z[0].sin()),
            Function::Abs => (z[0].abs(), z[0].signum()),
            Function::Sign if z[0] == 0.0 => (0.0, 0.0),
            Function::Sign => (z[0].signum(), 0.0),
        };
        Some(chain(z, value, slope))
    }
}
