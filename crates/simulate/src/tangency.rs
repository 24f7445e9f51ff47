//! Homoclinic tangencies of a periodically forced system of second order: its unstable manifold
//! continued until it comes back to the saddle.
//!
//! A point of the unstable manifold is saddle + A mu^sigma (unstable direction), 0 <= sigma < 1.
//! Its orbit leaves the saddle, goes round the well, comes back along the stable manifold and
//! turns back (inside) or passes over the saddle (outside). It is homoclinic when its unstable
//! component after many periods vanishes, and the manifolds are tangent when this happens at an
//! extremum over sigma. Only forward time is used: with sticking there is no other.

mod derivatives;

use self::derivatives::{Derivatives, Known};
use crate::error::SimulateError;
use crate::integrator::real::Doubles;
use crate::integrator::{Integrator, Settings, Tick};
use crate::linear::monodromy;
use crate::poincare::{PoincareMap, Section};
use crate::quantity::{Parameters, Quantity};
use crate::report::Report;
use crate::saddle::{Saddle, saddle};
use crate::system::{Model, System};
use rug::Float;
use std::ops::ControlFlow;

/// Which half of the unstable manifold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// Towards larger x.
    Right,
    /// Towards smaller x.
    Left,
}

/// The homoclinic loop of a saddle orbit of a forced system of second order without walls; one
/// parameter is free. Everything is in f64. All computations ask a tick at every step whether to go
/// on, and end with [`SimulateError::Stopped`] if not.
///
/// ```
/// use lindstedt_equation::{Expression, Function};
/// use lindstedt_simulate::{Homoclinic, Loop, Model, Parameters, go_on};
/// use std::f64::consts::PI;
///
/// // x'' = x - x^3 + (F cos t - x')/100: Melnikov's threshold is 4 cosh(pi/2)/(3 sqrt 2 pi).
/// let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
/// let force = Expression::parameter("F") * Expression::Time.apply(Function::Cos);
/// let equation = Expression::ACCELERATION - x.clone() + x.pow(3) + Expression::Small * (v - force);
/// let model = Model::second_order(&equation)?.with_small("eps");
/// let parameters = Parameters::new().with("eps", rug::Rational::from((1, 100)));
/// let (model, parameters, side) = (&model, &parameters, Loop::Right);
/// let (period, guess) = (2.0 * PI, [0.0, 0.0]);
/// let homoclinic = Homoclinic { model, parameters, name: "F", period, side, guess };
/// let tangency = homoclinic.first_tangency((0.7, 0.8), 24, &go_on)?;
/// let threshold = 4.0 * (PI / 2.0).cosh() / (3.0 * 2f64.sqrt() * PI);
/// assert!((tangency.value - threshold).abs() < 1e-3);
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Homoclinic<'a> {
    /// A model of second order, not linearised.
    pub model: &'a Model,
    /// The other parameters.
    pub parameters: &'a Parameters,
    /// The name of the free parameter.
    pub name: &'a str,
    /// The period of the forcing.
    pub period: f64,
    /// Which loop.
    pub side: Loop,
    /// Where Newton's method looks for the saddle at t = 0.
    pub guess: [f64; 2],
}

/// Where an orbit of the unstable manifold went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Where it began: the fraction sigma of a fundamental domain.
    pub phase: f64,
    /// y^2 - w^2 where it turned back (positive: inside) or passed over the saddle (negative),
    /// y and w the differences of x and x' from the saddle orbit; zero on the stable manifold.
    pub excess: f64,
}

/// A homoclinic tangency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangency {
    /// The value of the free parameter.
    pub value: f64,
    /// Its estimated error: the change when the orbit is followed one period less, and when it
    /// begins one period farther from the saddle (nearer, where a period is long).
    pub error: f64,
    /// The phase sigma of the tangent orbit on the unstable manifold (not reduced to [0, 1)).
    pub phase: f64,
    /// Periods from there to the end near the saddle.
    pub periods: u32,
}

/// A minimum of the excess over orbits of a fundamental domain.
#[derive(Clone, Copy)]
struct Minimum {
    phase: f64,
    margin: f64,
    /// How far below the orbits followed a parabola through them may go: a quarter of the larger rise beside the least.
    unseen: f64,
}

/// A value of the parameter with the minima there.
type Looked = (f64, Vec<Minimum>);

/// A linearised system with its saddle.
type Place = (System<Doubles>, Saddle);

/// A: small, so that the manifold is straight, but far above rounding errors.
const AMOUNT: f64 = 1e-6;
/// A is that for multipliers up to this one and smaller beyond, so that A mu is as small.
const ORDINARY: f64 = 25.0;
/// Nearer to the saddle than this nothing begins.
const NEAREST: f64 = 1e-13;
/// Looks per period.
const LOOKS: usize = 64;

impl Homoclinic<'_> {
    fn system(&self, value: f64, linearised: bool) -> Result<System<Doubles>, SimulateError> {
        let mut parameters = self.parameters.clone();
        parameters.set(self.name, Quantity::Float(Float::with_val(53, value)));
        let model = self.model.clone();
        let model = if linearised { model.linearised() } else { model };
        model.compile(Doubles, &parameters)
    }

    fn settings() -> Settings {
        Settings::for_digits(16)
    }

    fn amount(&self, saddle: &Saddle, phase: f64) -> f64 {
        let multiplier = saddle.multipliers[0];
        let amount = AMOUNT * (ORDINARY / multiplier).min(1.0) * multiplier.powf(phase);
        if self.side == Loop::Right { amount } else { -amount }
    }

    /// The saddle orbit.
    pub fn saddle(&self, value: f64, tick: &Tick<'_>) -> Result<Saddle, SimulateError> {
        saddle(&self.system(value, true)?, self.period, self.guess, Self::settings(), tick)
    }

    /// Follows `count` orbits of a fundamental domain round the loop; those that do not come back
    /// within 50 periods are left out. The signs are sure, the numbers are those at the first of 64
    /// looks per period after the event. Cost: some ten periods of integration per orbit.
    pub fn returns(
        &self,
        value: f64,
        count: u32,
        tick: &Tick<'_>,
    ) -> Result<Vec<Return>, SimulateError> {
        let saddle = self.saddle(value, tick)?;
        let system = self.system(value, false)?;
        let mut orbit = Vec::new();
        self.watch(&system, &saddle.state, tick, &mut |_, state| {
            orbit.push(state);
            orbit.len() == LOOKS
        })?;
        let sign = if self.side == Loop::Right { 1.0 } else { -1.0 };
        let mut returns = Vec::new();
        for index in 0..count {
            let phase = f64::from(index) / f64::from(count);
            let start = saddle.unstable(self.amount(&saddle, phase));
            let mut back = false;
            self.watch(&system, &start, tick, &mut |look, [x, v]| {
                let Some(known) = orbit.get(look % LOOKS) else { return true };
                let (y, w) = (sign * (x - known[0]), sign * (v - known[1]));
                back |= w < 0.0;
                let ends = back && (w > 0.0 || y < 0.0);
                if ends {
                    returns.push(Return { phase, excess: y * y - w * w });
                }
                ends
            })?;
        }
        Ok(returns)
    }

    /// x and x' of the orbit from a start at the looks of 50 periods, each with its number, until `seen` has seen
    /// enough. They are read off the series of the steps, which no look cuts.
    fn watch(
        &self,
        system: &System<Doubles>,
        start: &[f64; 2],
        tick: &Tick<'_>,
        seen: &mut dyn FnMut(usize, [f64; 2]) -> bool,
    ) -> Result<(), SimulateError> {
        let mut flow = Integrator::new(system, &0.0, start, Self::settings())?;
        let (mut look, mut stopped) = (0, false);
        flow.advance(&(50.0 * self.period), &mut |report| {
            while let Report::Segment(segment) = report {
                let time = self.period * (look + 1) as f64 / LOOKS as f64 - segment.start;
                if time > *segment.length {
                    break;
                }
                let state = [0, 1].map(|k| segment.value(k, &time.max(0.0)));
                if seen(look, state) {
                    return ControlFlow::Break(());
                }
                look += 1;
            }
            let told = tick();
            stopped |= told.is_break();
            told
        })?;
        if stopped { Err(SimulateError::Stopped) } else { Ok(()) }
    }

    /// The phase of the extremum of the excess that is nearest to zero.
    pub(crate) fn extremum(&self, value: f64, tick: &Tick<'_>) -> Result<f64, SimulateError> {
        let returns = self.returns(value, 128, tick)?;
        let neighbours = (0..returns.len()).filter_map(|k| {
            let at = |shift: usize| returns.get((k + shift) % returns.len());
            let (before, middle, after) = (at(0)?, at(1)?, at(2)?);
            let turns = (middle.excess - before.excess) * (after.excess - middle.excess) <= 0.0;
            turns.then_some(middle)
        });
        let nearest = neighbours.min_by(|a, b| a.excess.abs().total_cmp(&b.excess.abs()));
        nearest.map(|nearest| nearest.phase).ok_or(SimulateError::NoTangency { value })
    }

    /// The minima of `sign` excess over the orbits followed, the smallest first; there is one.
    fn minima(
        &self,
        (value, count, sign): (f64, u32, f64),
        tick: &Tick<'_>,
    ) -> Result<Vec<Minimum>, SimulateError> {
        let returns = self.returns(value, count, tick)?;
        let at = |k: usize| sign * returns[k % returns.len()].excess;
        let below = |k: &usize| at(*k) <= at(*k + returns.len() - 1) && at(*k) <= at(*k + 1);
        let minimum = |k: usize| {
            let margin = at(k);
            let rise = at(k + returns.len() - 1).max(at(k + 1)) - margin;
            Minimum { phase: returns[k].phase, margin, unseen: rise / 4.0 }
        };
        let mut minima: Vec<_> = (0..returns.len()).filter(below).map(minimum).collect();
        minima.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        if minima.is_empty() { Err(SimulateError::NoTangency { value }) } else { Ok(minima) }
    }

    /// The tangency between two values of the parameter, at one of which all of `count` orbits
    /// turn back (or all pass over the saddle) and at the other not: bisected to 1/64 of the
    /// bracket, then by [`Self::tangency`]. Seen from the end where all do the same it is the first
    /// one, up to what hides between the orbits followed and the values tried.
    ///
    /// Errors: [`SimulateError::NoTangency`] if the ends are of one kind.
    pub fn first_tangency(
        &self,
        (low, high): (f64, f64),
        count: u32,
        tick: &Tick<'_>,
    ) -> Result<Tangency, SimulateError> {
        for sign in [1.0, -1.0] {
            let mut pure = (low, self.minima((low, count, sign), tick)?);
            let mut mixed = (high, self.minima((high, count, sign), tick)?);
            if mixed.1[0].margin > 0.0 {
                (pure, mixed) = (mixed, pure);
            }
            if !(pure.1[0].margin > 0.0 && mixed.1[0].margin < 0.0) {
                continue;
            }
            for _ in 0..6 {
                let middle = (pure.0 + mixed.0) / 2.0;
                let minima = self.minima((middle, count, sign), tick)?;
                let end = if minima[0].margin > 0.0 { &mut pure } else { &mut mixed };
                *end = (middle, minima);
            }
            return self.first_of(pure, mixed, tick);
        }
        Err(SimulateError::NoTangency { value: low })
    }

    /// The first tangency between values that are near one another. Of minima that are almost equal the orbits followed do
    /// not tell whose tangency is the first.
    fn first_of(
        &self,
        pure: Looked,
        mixed: Looked,
        tick: &Tick<'_>,
    ) -> Result<Tangency, SimulateError> {
        let change = pure.1[0].margin - mixed.1[0].margin;
        let (middle, width) = ((pure.0 + mixed.0) / 2.0, (mixed.0 - pure.0).abs());
        let direction = mixed.0 - pure.0;
        let (value, minima) = if pure.1[0].margin < -mixed.1[0].margin { pure } else { mixed };
        let least = minima[0];
        // What the orbits followed do not see of the minimum moves its tangency by as much as the margin changes over.
        let reach = width / 2.0 + 2.0 * width * (1.0 + least.unseen / change);
        let is_near = |tangency: &Tangency| (tangency.value - middle).abs() <= reach;
        let mut first = self.tangency(value, least.phase, tick)?;
        if !is_near(&first) {
            return Err(SimulateError::NoTangency { value });
        }
        let equal = |other: &&Minimum| {
            other.margin - least.margin <= change + least.unseen.max(other.unseen)
        };
        for other in minima[1..].iter().filter(equal) {
            match self.tangency(value, other.phase, tick) {
                Err(SimulateError::Stopped) => return Err(SimulateError::Stopped),
                Ok(other) if is_near(&other) && direction * (other.value - first.value) < 0.0 => {
                    first = other;
                }
                _ => {}
            }
        }
        Ok(first)
    }

    /// The tangency near a value of the parameter and a phase: Newton's method for G = 0 and
    /// dG/dsigma = 0, G the unstable component after N periods (its derivative along sigma by the
    /// linearised flow, the others by differences), for N, N + 1, ... as the orbit comes closer to
    /// the saddle.
    ///
    /// Errors: [`SimulateError::NoTangency`] without convergence.
    pub fn tangency(
        &self,
        value: f64,
        phase: f64,
        tick: &Tick<'_>,
    ) -> Result<Tangency, SimulateError> {
        let mut periods = self.arrival(value, phase, tick)?;
        let mut known = Known::default();
        let (mut value, mut phase) = self.newton((value, phase), periods, &mut known, tick)?;
        let mut error = f64::INFINITY;
        for _ in 0..3 {
            let next = match self.newton((value, phase), periods + 1, &mut known, tick) {
                Err(SimulateError::Stopped) => return Err(SimulateError::Stopped),
                Err(failure) if error == f64::INFINITY => return Err(failure),
                Err(_) => break,
                Ok(next) => next,
            };
            let change = (next.0 - value).abs();
            if change > error {
                break;
            }
            (value, phase) = next;
            (error, periods) = (change, periods + 1);
            if error < SETTLED {
                break;
            }
        }
        // The same orbit, begun one period farther out, or nearer where that is far: how straight the manifold is.
        let saddle = self.saddle(value, tick)?;
        let nearer =
            saddle.multipliers[0] > ORDINARY && self.amount(&saddle, phase - 1.0).abs() > NEAREST;
        let begun = if nearer { (phase - 1.0, periods + 1) } else { (phase + 1.0, periods - 1) };
        let (other, _) = self.newton((value, begun.0), begun.1, &mut known, tick)?;
        Ok(Tangency { value, error: error + (other - value).abs(), phase, periods })
    }

    /// After how many periods the orbit that came back is nearest to the saddle.
    fn arrival(&self, value: f64, phase: f64, tick: &Tick<'_>) -> Result<u32, SimulateError> {
        let (saddle, system) = (self.saddle(value, tick)?, self.system(value, false)?);
        let start = saddle.unstable(self.amount(&saddle, phase));
        let section = Section::Period(self.period);
        let mut map = PoincareMap::new(&system, &0.0, &start, section, Self::settings())?;
        let (mut away, mut nearest) = (false, (f64::INFINITY, 0));
        for periods in 1..50 {
            let Some(point) = map.next_point(tick)? else { break };
            let [u, s] = saddle.coordinates(&point.state);
            let distance = u.hypot(s);
            away |= distance > AWAY;
            if away && distance < nearest.0 {
                nearest = (distance, periods);
            }
            // Nearer is better, but later amplifies rounding errors.
            if nearest.0 < NEAR || nearest.0 < AWAY && distance > AWAY {
                break;
            }
        }
        if nearest.0 < AWAY { Ok(nearest.1) } else { Err(SimulateError::NoTangency { value }) }
    }

    /// The linearised system at a value, and its saddle, looked for from a guess.
    fn at(&self, value: f64, guess: [f64; 2], tick: &Tick<'_>) -> Result<Place, SimulateError> {
        let system = self.system(value, true)?;
        let saddle = saddle(&system, self.period, guess, Self::settings(), tick)?;
        Ok((system, saddle))
    }

    /// (G, dG/dsigma).
    fn unstable_component(
        &self,
        (system, saddle): &Place,
        phase: f64,
        periods: u32,
        tick: &Tick<'_>,
    ) -> Result<[f64; 2], SimulateError> {
        let amount = self.amount(saddle, phase);
        let end = f64::from(periods) * self.period;
        let start = saddle.unstable(amount);
        let flow = monodromy(system, (&0.0, &end), &start, Self::settings(), tick)?;
        let [u, _] = saddle.coordinates(&flow.end);
        // d(start)/dsigma = amount ln(mu) (unstable direction).
        let rate = amount * saddle.multipliers[0].ln();
        let [x, v] = saddle.directions[0];
        let carried = flow.matrix.iter().map(|row| match row[..] {
            [first, second] => rate * (first * x + second * v),
            _ => f64::NAN,
        });
        let mut carried = carried.fuse();
        let tangent = [(); 2].map(|()| carried.next().unwrap_or(f64::NAN));
        Ok([u, saddle.components(tangent)[0]])
    }

    /// What Newton's method needs besides G and dG/dsigma, by differences; nothing where they were too wide, and are less
    /// wide now.
    fn derivatives(
        &self,
        (here, value, phase, g): (&Place, f64, f64, f64),
        periods: u32,
        Known { steps, .. }: &mut Known,
        tick: &Tick<'_>,
    ) -> Result<Option<Derivatives>, SimulateError> {
        let guess = here.1.state;
        let component = |place: &Place, phase| self.unstable_component(place, phase, periods, tick);
        let more = component(&self.at(value + steps.value, guess, tick)?, phase)?;
        let less = component(&self.at(value - steps.value, guess, tick)?, phase)?;
        let later = component(here, phase + steps.phase)?;
        let sooner = component(here, phase - steps.phase)?;
        // The differences stay where G is nearly linear in the value, quadratic in the phase.
        let (change, bend) = ((more[0] - less[0]).abs(), (later[0] + sooner[0] - 2.0 * g).abs());
        if change > 1e-3 || bend > 1e-3 {
            steps.value *= (1e-4 / change).min(1.0);
            steps.phase *= (1e-4 / bend).sqrt().min(1.0);
            return Ok(None);
        }
        let by_value = [0, 1].map(|k| (more[k] - less[k]) / (2.0 * steps.value));
        let curvature = (later[1] - sooner[1]) / (2.0 * steps.phase);
        Ok(Some(Derivatives { by_value, curvature }))
    }

    fn newton(
        &self,
        start: (f64, f64),
        periods: u32,
        known: &mut Known,
        tick: &Tick<'_>,
    ) -> Result<(f64, f64), SimulateError> {
        let (mut value, mut phase) = start;
        let (mut moved, mut before) = (f64::INFINITY, None);
        // The saddles of one step lie near those of the step before.
        let mut guess = self.guess;
        for _ in 0..30 {
            let here = self.at(value, guess, tick)?;
            guess = here.1.state;
            let found = self.unstable_component(&here, phase, periods, tick)?;
            // Near the saddle G grows by the multiplier in a period, and a phase is a share of one.
            let length = f64::from(periods) + phase;
            let growth = |from: f64| here.1.multipliers[0].powf(length - from);
            let kept = known.derivatives.take().map(|(from, kept)| {
                let kept = kept.times(growth(from));
                before.map_or(kept, |(last, step)| kept.corrected([last, found], step))
            });
            if let Some(kept) = &kept {
                known.steps.shorten(kept);
            }
            // Four more orbits, where they do not bring the steps down.
            let kept = kept.filter(|kept| {
                let dv = kept.step(found)[0].abs();
                dv <= FALL * moved || dv < SETTLED
            });
            let fresh = kept.is_none();
            let derivatives = match kept {
                Some(derivatives) => derivatives,
                None => {
                    let near = (&here, value, phase, found[0]);
                    match self.derivatives(near, periods, known, tick)? {
                        Some(derivatives) => derivatives,
                        None => continue,
                    }
                }
            };
            known.derivatives = Some((length, derivatives));
            let [dv, dp] = derivatives.step(found);
            if !(dv.is_finite() && dp.is_finite()) {
                break;
            }
            // Not out of the neighbourhood where G means something.
            let damping = (0.05 / dp.abs()).min(0.02 / dv.abs()).min(1.0);
            let step = [dv, dp].map(|d| damping * d);
            value += step[0];
            phase += step[1];
            before = Some((found, step));
            // The next step is smaller than this one by as much as this one than the last, and what is left when it is far
            // below the change from one number of periods to the next is nothing; or these are rounding errors.
            let ratio = (dv.abs() / moved).min(1.0);
            let settled = fresh && dv.abs() < 1e-8 && ratio >= 0.25;
            if dv.abs() < SETTLED || moved.is_finite() && ratio * dv.abs() < SETTLED || settled {
                return Ok((value, phase));
            }
            moved = dv.abs();
        }
        Err(SimulateError::NoTangency { value: start.0 })
    }
}

/// The derivatives of one step serve the next where that is smaller by this factor.
const FALL: f64 = 0.3;
/// A value is not sought any closer.
const SETTLED: f64 = 1e-12;
/// Farther than this from the saddle the coordinates tell nothing.
const AWAY: f64 = 0.4;
/// Near enough to begin with.
const NEAR: f64 = 0.05;
