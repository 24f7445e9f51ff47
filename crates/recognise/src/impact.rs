//! x'' + c x' + alpha^2 x = P0 cos(omega t) + A (x - x_T) + B (x' - x'_T) between impacts, from the
//! terms of an equation with a wall.

use crate::bound::{bind, missing, multiply_out, named, of_value, rest};
use crate::in_pi::InPi;
use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::{Monomial, Monomials, angle};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Crossing, Expression, Function, Problem, Synchronous, Unknown};
use lindstedt_impact::parameters::{Branch, ExactParameters};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// An impact oscillator in the form of section 2.
///
/// With x'' + g x' + k x + a x(t - T) + b x'(t - T) = force + f_0 the canonical numbers are A = a,
/// B = b, alpha^2 = k + a, c = g + b; a constant force moves the wall by -f_0/alpha^2, a wall below
/// is turned over with x -> -x, and a factor of x'' is divided out. The orders of A, B, c in the
/// small parameter are the canonical ones (1), whatever they are in the file: only the averaged
/// prediction knows of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImpactProblem {
    /// The canonical parameters.
    pub parameters: ExactParameters,
    /// Whether a term of the loop or the damping has another order in the file.
    pub other_orders: bool,
}

/// The coefficients of a linear equation.
#[derive(Default)]
struct Linear {
    stiffness: InPi,
    damping: InPi,
    delayed: InPi,
    delayed_velocity: InPi,
    constant: InPi,
    /// cos(omega t), sin(omega t).
    force: [InPi; 2],
    /// omega, and the argument that it stands in.
    frequency: Option<InPi>,
    angle: Option<Expression>,
    /// The time of the delayed terms.
    delay: Option<Expression>,
    other_orders: bool,
}

/// The equation, divided as the terms want it, if all that it and the wall mention has a value.
fn rest_within(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Expression, Refusal> {
    let wall = problem.impact.as_ref().ok_or(Refusal::NoWall)?;
    let tie = problem.synchronous.as_ref();
    let rest = rest(problem)?;
    let mut used = rest.parameters();
    used.extend(wall.position.parameters());
    used.extend(wall.restitution.parameters());
    used.extend(tie.iter().flat_map(|t| [t.periods.to_string(), t.frequency.to_string()]));
    used.retain(|name| tie.is_none_or(|tie| tie.delay != *name));
    missing(&used, values)?;
    Ok(rest)
}

impl ImpactProblem {
    /// Reads the equation and the wall of a problem with the values of its parameters. `periods`
    /// is k where the file has no delay that says it.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit.
    pub fn new(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        periods: Option<u32>,
        branch: Branch,
    ) -> Result<Self, Refusal> {
        let rest = rest_within(problem, values)?;
        // The delay that is tied to the force keeps its name.
        let bound = bind(&rest, values);
        let all = multiply_out(&bound)?;
        let refuse = |m: &Monomial, q: &Rational, why| {
            named(&rest, values, (all.tree(m, q), why), &|all, m| shape(all, m).err())
        };
        // eps = 1 in the end, unless the file or its reader says otherwise.
        let small = values.get(&*problem.small).and_then(Exact::as_rational).cloned();
        let linear = Linear::read(&all, &small.unwrap_or_else(|| Rational::from(1)), &refuse)?;
        let tie = problem.synchronous.as_ref();
        let tied = |tie: &Synchronous| {
            values.get(&*tie.frequency).and_then(|value| InPi::of(&of_value(value)))
        };
        let omega = linear.frequency.clone().or_else(|| tie.and_then(tied));
        let omega = omega.ok_or(Refusal::NoForce)?;
        let tie = tie.filter(|tie| tied(tie).as_ref() == Some(&omega));
        let periods = linear.periods((tie, values), &omega, periods)?;
        linear.parameters(problem, values, omega, periods, branch)
    }

    /// The same with one parameter of the file changed must change one canonical parameter into
    /// it, at three more values, and nothing else: then the one is a name of the other.
    #[must_use]
    pub fn names(
        &self,
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        name: &str,
        periods: Option<u32>,
    ) -> Option<lindstedt_impact::parameters::Swept> {
        let known = values.get(name)?.clone();
        let probes = [(1009, 733), (2003, 1511), (389, 617)].map(Rational::from);
        let renamed = |swept| {
            let same = |value: &Exact, found: &Self| {
                let mut changed = self.parameters.clone();
                *changed.slot(swept) = value.clone();
                changed == found.parameters
            };
            same(&known, self)
                && probes.iter().all(|q| {
                    let mut values = values.clone();
                    values.insert(name.to_owned(), Exact::Rational(q.clone()));
                    let found = Self::new(problem, &values, periods, self.parameters.branch);
                    found.is_ok_and(|found| same(&Exact::Rational(q.clone()), &found))
                })
        };
        let list = lindstedt_impact::parameters::Swept::ALL;
        list.into_iter().map(|(_, swept)| swept).find(|swept| renamed(*swept))
    }
}

impl Linear {
    /// The coefficients at this value of the small parameter.
    fn read(
        all: &Monomials,
        small: &Rational,
        refuse: &dyn Fn(&Monomial, &Rational, Why) -> Refusal,
    ) -> Result<Self, Refusal> {
        let mut linear = Self::default();
        for (m, q) in &all.terms {
            let q = &(0..m.order).fold(q.clone(), |q, _| q * small);
            let found = shape(all, m).map_err(|why| refuse(m, q, why))?;
            let loops = matches!(found, Shape::Velocity | Shape::Delayed(..));
            linear.other_orders |= loops && m.order != 1;
            let slot = linear.slot(found).map_err(|why| refuse(m, q, why))?;
            let bare = Monomial { parameters: m.parameters.clone(), ..Monomial::default() };
            slot.add(&bare, q).ok_or_else(|| refuse(m, q, Why::Irrational))?;
        }
        Ok(linear)
    }

    /// Where the coefficient of a term belongs; all delays are one, and all forces.
    fn slot(&mut self, found: Shape) -> Result<&mut InPi, Why> {
        Ok(match found {
            Shape::Constant => &mut self.constant,
            Shape::Displacement => &mut self.stiffness,
            Shape::Velocity => &mut self.damping,
            Shape::Delayed(time, velocity) => {
                if self.delay.as_ref().is_some_and(|known| *known != time) {
                    return Err(Why::OtherDelay);
                }
                self.delay = Some(time);
                if velocity { &mut self.delayed_velocity } else { &mut self.delayed }
            }
            Shape::Force(argument, sine) => {
                let omega = angular_frequency(&argument).ok_or(Why::Irrational)?;
                // A cosine and a sine of one angle add up.
                if self.angle.as_ref().is_some_and(|known| *known != argument) {
                    return Err(Why::OtherFrequency);
                }
                (self.frequency, self.angle) = (Some(omega), Some(argument));
                let [cosine_part, sine_part] = &mut self.force;
                if sine { sine_part } else { cosine_part }
            }
        })
    }

    /// k: what the tie of the delay to the force says, if there is one, else what the delay says,
    /// else `without`.
    fn periods(
        &self,
        (tie, values): (Option<&Synchronous>, &BTreeMap<String, Exact>),
        omega: &InPi,
        without: Option<u32>,
    ) -> Result<u32, Refusal> {
        let whole = |tie: &Synchronous| {
            let zero = Exact::Rational(Rational::new());
            let value = values.get(&*tie.periods).unwrap_or(&zero);
            let k = value.as_rational().filter(|q| q.is_integer()).and_then(|q| q.numer().to_u32());
            k.filter(|k| *k > 0).ok_or_else(|| Refusal::Periods { value: value.to_string() })
        };
        match (&self.delay, tie) {
            (Some(time), Some(tie)) if *time == Expression::parameter(&tie.delay) => whole(tie),
            (None, Some(tie)) if values.contains_key(&*tie.periods) => whole(tie),
            (Some(time), _) => periods_of(time, omega).ok_or_else(|| Refusal::Term {
                term: Box::new(Expression::DISPLACEMENT.delayed(time.clone())),
                why: Why::OtherDelay,
            }),
            (None, _) => Ok(without.unwrap_or(1)),
        }
    }

    fn parameters(
        &self,
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        omega: InPi,
        periods: u32,
        branch: Branch,
    ) -> Result<ImpactProblem, Refusal> {
        let wall = problem.impact.as_ref().ok_or(Refusal::NoWall)?;
        let irrational = |term: &Expression| Refusal::Term {
            term: Box::new(term.clone()),
            why: Why::Irrational,
        };
        let exact = |c: &InPi, term: &Expression| c.value().ok_or_else(|| irrational(term));
        let square = self.stiffness.plus(&self.delayed);
        let no_stiffness =
            || Refusal::NoStiffness { value: square.expression().print("eps", Style::Text) };
        let alpha = square.root().filter(|_| !square.is_zero()).ok_or_else(no_stiffness)?;
        let x = Expression::DISPLACEMENT;
        let constant = |e: &Expression| InPi::of(&bind(e, values)).ok_or_else(|| irrational(e));
        let mut position = constant(&wall.position)?;
        if !self.constant.is_zero() {
            // x = y - constant/alpha^2.
            let square = square.value().and_then(|v| v.as_rational().cloned());
            let square = square.ok_or_else(|| irrational(&x))?;
            position = position.plus(&self.constant.scaled(&square.recip()));
        }
        if wall.crossing == Crossing::Falling {
            position = position.neg();
        }
        let [cosine, sine] = &self.force;
        let force = match (cosine.value(), sine.value()) {
            (Some(p), _) if sine.is_zero() => p,
            (_, Some(q)) if cosine.is_zero() => q,
            (Some(Exact::Rational(p)), Some(Exact::Rational(q))) => {
                let square = Rational::from(p.square_ref()) + Rational::from(q.square_ref());
                Exact::root(square)
            }
            _ => return Err(Refusal::NoForce),
        };
        // A phase of pi.
        let force = force.abs();
        let velocity = Expression::VELOCITY;
        let parameters = ExactParameters {
            alpha,
            omega: exact(&omega, &Expression::Time)?,
            periods,
            restitution: exact(&constant(&wall.restitution)?, &wall.restitution)?,
            wall: exact(&position, &wall.position)?,
            damping: exact(&self.damping.plus(&self.delayed_velocity), &velocity)?,
            force,
            displacement_gain: exact(&self.delayed, &x)?,
            velocity_gain: exact(&self.delayed_velocity, &velocity)?,
            branch,
        };
        Ok(ImpactProblem { parameters, other_orders: self.other_orders })
    }
}

/// What a term can be.
enum Shape {
    Constant,
    Displacement,
    Velocity,
    /// The delay, and whether it is that of x'.
    Delayed(Expression, bool),
    /// The argument, and whether of a sine.
    Force(Expression, bool),
}

fn shape(all: &Monomials, m: &Monomial) -> Result<Shape, Why> {
    let atoms: Vec<(&Expression, u32)> =
        m.atoms.iter().filter_map(|(key, n)| Some((all.atoms.get(key)?, *n))).collect();
    match (m.x, m.velocity, atoms.as_slice()) {
        (0, 0, []) => Ok(Shape::Constant),
        (1, 0, []) => Ok(Shape::Displacement),
        (0, 1, []) => Ok(Shape::Velocity),
        (0, 0, [(Expression::Unknown(Unknown { derivative, delay: Some(delay), .. }), 1)])
            if *derivative < 2 =>
        {
            Ok(Shape::Delayed((**delay).clone(), *derivative == 1))
        }
        (0, 0, [(Expression::Function(function @ (Function::Cos | Function::Sin), z), 1)])
            if linear_in_time(z) =>
        {
            Ok(Shape::Force((**z).clone(), *function == Function::Sin))
        }
        (0, 0, list) if list.iter().all(|(e, _)| e.contains(&Expression::Time)) => {
            Err(Why::NotHarmonic)
        }
        _ => Err(Why::NotLinear),
    }
}

/// Whether the argument of a harmonic force is omega t + phase: the phase moves the clock only.
#[must_use]
pub fn linear_in_time(argument: &Expression) -> bool {
    angle(argument).is_some_and(|(rate, start)| {
        rate.terms.keys().chain(start.terms.keys()).all(|m| m.order == 0)
    })
}

/// |omega| of omega t + phase; nothing for one that is neither rational nor a multiple of pi.
fn angular_frequency(argument: &Expression) -> Option<InPi> {
    let mut omega = InPi::default();
    angle(argument)?.0.terms.iter().try_for_each(|(m, q)| omega.add(m, q))?;
    let value = omega.value()?;
    Some(if value.sign().is_lt() { omega.neg() } else { omega })
}

/// k of T = 2 pi k/omega.
fn periods_of(delay: &Expression, omega: &InPi) -> Option<u32> {
    let time = InPi::of(delay)?.value()?;
    let turns = match (time, omega.value()?) {
        (Exact::PiTimes(t), Exact::Rational(w)) | (Exact::Rational(t), Exact::PiTimes(w)) => {
            t * w / 2u32
        }
        _ => return None,
    };
    (turns.is_integer() && turns > 0).then(|| turns.numer().to_u32()).flatten()
}
