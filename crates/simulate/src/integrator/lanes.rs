//! Several integrations in doubles side by side: the Taylor series of all at once, the rest of a step one by one.
//!
//! An operation of a level waits for the one before it; eight integrations that differ in their constants and states
//! wait together. In every lane the operations and their order are those of [`Doubles`], so the numbers are the same
//! bit by bit, whatever is in the other lanes. Who slides, rests or has a past takes his step alone.

use super::arithmetic::Arithmetic;
use super::real::{Doubles, Places, Real};
use super::{Integrator, Next, Tick, Together};
use crate::error::SimulateError;
use crate::past::Clock;
use crate::probe::Probe;
use crate::tape::{Moment, Rows, Tape};

const LANES: usize = Doubles::LANES;

type Lane = [f64; LANES];

/// The arithmetic of [`Doubles`] in every lane.
#[derive(Clone, Copy, Debug)]
struct Lanes;

#[inline(always)]
fn each(f: impl FnMut(usize) -> f64) -> Lane {
    std::array::from_fn(f)
}

/// sum <- sum + a b.
#[inline(always)]
fn add_product(sum: &mut Lane, a: &Lane, b: &Lane) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum += a * b;
    }
}

impl Places for Lanes {
    type Element = Lane;

    #[inline(always)]
    fn zero(&self) -> Lane {
        [0.0; LANES]
    }
    #[inline(always)]
    fn double(&self, x: f64) -> Lane {
        [x; LANES]
    }
    #[inline(always)]
    fn set(&self, to: &mut Lane, x: &Lane) {
        *to = *x;
    }
    #[inline(always)]
    fn set_zero(&self, to: &mut Lane) {
        *to = [0.0; LANES];
    }
    #[inline(always)]
    fn add(&self, to: &mut Lane, a: &Lane, b: &Lane) {
        *to = each(|l| a[l] + b[l]);
    }
    #[inline(always)]
    fn subtract(&self, to: &mut Lane, a: &Lane, b: &Lane) {
        *to = each(|l| a[l] - b[l]);
    }
    #[inline(always)]
    fn multiply(&self, to: &mut Lane, a: &Lane, b: &Lane) {
        *to = each(|l| a[l] * b[l]);
    }
    #[inline(always)]
    fn divide(&self, to: &mut Lane, a: &Lane, b: &Lane) {
        *to = each(|l| a[l] / b[l]);
    }
    #[inline(always)]
    fn increase(&self, to: &mut Lane, a: &Lane) {
        *to = each(|l| to[l] + a[l]);
    }
    #[inline(always)]
    fn accumulate(&self, to: &mut Lane, a: &Lane, b: &Lane) {
        add_product(to, a, b);
    }
    #[inline(always)]
    fn scale(&self, to: &mut Lane, a: &Lane) {
        *to = each(|l| to[l] * a[l]);
    }
    #[inline(always)]
    fn times_integer(&self, to: &mut Lane, n: i32) {
        *to = to.map(|x| x * f64::from(n));
    }
    #[inline(always)]
    fn over_integer(&self, to: &mut Lane, n: u32) {
        *to = to.map(|x| x / f64::from(n));
    }
    #[inline(always)]
    fn exp(&self, to: &mut Lane, x: &Lane) {
        *to = x.map(f64::exp);
    }
    #[inline(always)]
    fn ln(&self, to: &mut Lane, x: &Lane) {
        *to = x.map(f64::ln);
    }
    #[inline(always)]
    fn sin(&self, to: &mut Lane, x: &Lane) {
        *to = x.map(f64::sin);
    }
    #[inline(always)]
    fn cos(&self, to: &mut Lane, x: &Lane) {
        *to = x.map(f64::cos);
    }
    #[inline(always)]
    fn power(&self, to: &mut Lane, x: &Lane, p: &Lane) {
        *to = each(|l| x[l].powf(p[l]));
    }
    /// The four partial sums of [`Doubles`].
    #[inline(always)]
    fn convolve(&self, to: &mut Lane, a: &[Lane], b: &[Lane]) {
        let mut sums = [[0.0; LANES]; 4];
        let (left, left_rest) = a.as_chunks::<4>();
        let (right_rest, right) = b.as_rchunks::<4>();
        for (x, y) in left.iter().zip(right.iter().rev()) {
            for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y.iter().rev())) {
                add_product(sum, x, y);
            }
        }
        let mut rest = [-0.0; LANES];
        for (x, y) in left_rest.iter().zip(right_rest.iter().rev()) {
            add_product(&mut rest, x, y);
        }
        let [a, b, c, d] = &sums;
        *to = each(|l| (a[l] + b[l]) + (c[l] + d[l]) + rest[l]);
    }
}

impl Arithmetic for Lanes {
    type Mode = Lane;

    #[inline(always)]
    fn slides(&self, _: Lane) -> bool {
        false
    }
    #[inline(always)]
    fn leaps(&self, _: Lane) -> bool {
        false
    }
    #[inline(always)]
    fn times_sign(&self, to: &mut Lane, mode: Lane) {
        self.scale(to, &mode);
    }
    #[inline(always)]
    fn is_zero(&self, _: &Lane) -> bool {
        false
    }
}

/// The series of integrations side by side.
struct Group {
    tape: Tape<Lane>,
    right_sides: Vec<usize>,
    rows: Rows<Lane>,
    probe: Probe<Lane>,
    order: usize,
    /// The rows that a step reads.
    read: Vec<usize>,
    arch: pulp::Arch,
}

impl<'s> Integrator<'s, Doubles> {
    /// Several integrations of one model; nothing where they differ in more than constants, states and times.
    pub(super) fn side_by_side(flows: &[&Self]) -> Option<Box<dyn Together<Doubles>>> {
        let first = flows.first()?;
        let same = |flow: &&&Self| {
            flow.past.is_none()
                && flow.series.order == first.series.order
                && flow.system.right_sides == first.system.right_sides
        };
        if !(2..=LANES).contains(&flows.len()) || !flows.iter().all(|flow| same(&flow)) {
            return None;
        }
        let tapes: Vec<_> = flows.iter().map(|flow| &flow.system.tape).collect();
        let join = |c: usize| {
            each(|l| *tapes.get(l).unwrap_or(&tapes[0]).constants.get(c).unwrap_or(&0.0))
        };
        let tape = Tape::side_by_side(&tapes, &Lanes, join)?;
        let read: Vec<usize> = (0..tape.states).chain(tape.needed.iter().copied()).collect();
        Some(Box::new(Group {
            read,
            right_sides: first.system.right_sides.clone(),
            rows: Rows::new(tape.rows(), first.series.order + 1, &Lanes.zero()),
            probe: Probe::new(tape.rows(), first.system.variables, &Lanes.zero()),
            order: first.series.order,
            tape,
            arch: pulp::Arch::new(),
        }))
    }

    /// Whether nothing but the recurrences makes the series.
    fn is_plain(&self) -> bool {
        self.phase.contact.is_none() && self.phase.modes.iter().all(|mode| mode.abs() == 1)
    }
}

/// Those that take a step of series alone, with their targets.
type Plain<'f, 's> = [Option<(&'f mut Integrator<'s, Doubles>, f64)>];

impl Group {
    /// [`crate::series::Series::expand`] of those that ask for it, and the probe at the end of their steps.
    fn expand(&mut self, flows: &mut Plain<'_, '_>) {
        fn of(flows: &Plain<'_, '_>, read: &dyn Fn(&Integrator<'_, Doubles>) -> f64) -> Lane {
            each(|l| flows.get(l).and_then(Option::as_ref).map_or(1.0, |(flow, _)| read(flow)))
        }
        for state in 0..self.tape.states {
            *self.rows.at_mut(state, 0) = of(flows, &|flow| flow.state[state]);
        }
        let time = of(flows, &|flow| flow.clock.high);
        let switches = flows.iter().flatten().map(|(flow, _)| flow.phase.modes.len()).max();
        let mode = |switch: usize| of(flows, &|flow| f64::from(flow.phase.modes[switch]));
        let modes: Vec<Lane> = (0..switches.unwrap_or(0)).map(mode).collect();
        let arch = self.arch;
        arch.dispatch(Levels { group: self, time, modes: &modes });
        let mut lengths = [1.0; LANES];
        for (lane, (flow, target)) in active(flows) {
            flow.series.take(&self.read, |row| self.rows.row(row).iter().map(|lanes| lanes[lane]));
            flow.expanded = true;
            let remaining = Clock::new(&Doubles, target).since(&Doubles, &flow.clock);
            let step = flow.series.step(flow.system, flow.log2_tolerance);
            lengths[lane] = step.map_or(f64::NAN, |step| step.min(remaining));
        }
        let end = each(|l| time[l] + lengths[l]);
        arch.dispatch(Ends { group: self, time: end, lengths, modes: &modes });
        for (lane, (flow, _)) in active(flows) {
            let own = |lanes: &Lane| lanes[lane];
            let rows = self.probe.rows.data.iter().map(own);
            flow.series.take_probe(lengths[lane], rows, self.probe.defects.iter().map(own));
        }
    }
}

fn active<'a, 'f, 's>(
    flows: &'a mut Plain<'f, 's>,
) -> impl Iterator<Item = (usize, &'a mut (&'f mut Integrator<'s, Doubles>, f64))> {
    flows.iter_mut().enumerate().filter_map(|(lane, flow)| Some((lane, flow.as_mut()?)))
}

/// All levels from level 0 of the states, by the widest vectors that the processor has: the same operations on every
/// number, and the same bits, by any.
struct Levels<'g> {
    group: &'g mut Group,
    time: Lane,
    modes: &'g [Lane],
}

impl pulp::NullaryFnOnce for Levels<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { group, time, modes } = self;
        let (mut sum, mut scratch) = (Lanes.zero(), Lanes.zero());
        for n in 0..=group.order {
            let (sum, scratch) = (&mut sum, &mut scratch);
            let mut moment = Moment { time: &time, modes, sum, scratch };
            group.tape.level(&Lanes, &mut group.rows, n, &mut moment);
            if n == group.order {
                break;
            }
            for (state, right) in group.right_sides.iter().enumerate() {
                let next = group.rows.at(*right, n).map(|f| f / f64::from(n as u32 + 1));
                *group.rows.at_mut(state, n + 1) = next;
            }
        }
    }
}

/// The places at the ends of steps, likewise.
struct Ends<'g> {
    group: &'g mut Group,
    time: Lane,
    lengths: Lane,
    modes: &'g [Lane],
}

impl pulp::NullaryFnOnce for Ends<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { group: Group { tape, right_sides, rows, probe, .. }, time, lengths, modes } =
            self;
        let (sum, scratch) = (&mut Lanes.zero(), &mut Lanes.zero());
        let mut moment = Moment { time: &time, modes, sum, scratch };
        probe.place(&Lanes, (tape, right_sides), rows, &lengths, &mut moment);
    }
}

impl Together<Doubles> for Group {
    fn round(
        &mut self,
        flows: &mut [(&mut Integrator<'_, Doubles>, Option<f64>)],
        tick: &Tick<'_>,
    ) -> Vec<Result<Next, SimulateError>> {
        let mut plain: Vec<_> = flows
            .iter_mut()
            .map(|(flow, target)| {
                let moves = target.is_some_and(|target| !flow.has_reached(&target));
                (moves && flow.is_plain()).then_some((&mut **flow, (*target)?))
            })
            .collect();
        // One has nobody to wait with.
        if plain.iter().flatten().count() > 1 {
            self.expand(&mut plain);
        }
        let step = |(flow, target): &mut (&mut Integrator<'_, Doubles>, Option<f64>)| {
            target.map_or(Ok(Next::Idle), |target| flow.next(&target, tick))
        };
        flows.iter_mut().map(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::{Settings, go_on};
    use crate::quantity::{Parameters, Quantity};
    use crate::system::Model;
    use lindstedt_equation::{Expression, Function};

    /// What a round does: one series for all, and one step each; the states after it are those of a step alone.
    #[test]
    fn a_round_is_a_step_of_each() {
        let (x, k) = (Expression::DISPLACEMENT, Expression::parameter("k"));
        let wave = (k.clone() * Expression::Time).apply(Function::Cos);
        let equation =
            Expression::ACCELERATION + x.clone() + k * x.clone() * x.clone() * x.clone() - wave;
        let model = Model::second_order(&equation).unwrap();
        let system = |k: i64| {
            let parameters = Parameters::new().with("k", Quantity::from(k));
            model.compile(Doubles, &parameters).unwrap()
        };
        let systems: Vec<_> = (2..7).map(system).collect();
        let settings = Settings::for_digits(16);
        let start = |system| Integrator::new(system, &0.1, &[0.3, 0.2], settings).unwrap();
        let mut flows: Vec<_> = systems.iter().map(start).collect();
        let mut alone = flows.clone();
        let mut group = Doubles::together(&flows.iter().collect::<Vec<_>>()).unwrap();
        // The second has no target, the third has reached its own.
        let targets = [Some(9.0), None, Some(0.1), Some(9.0), Some(0.2)];
        let mut pairs: Vec<_> = flows.iter_mut().zip(targets).collect();
        let told: Vec<_> =
            group.round(&mut pairs, &go_on).into_iter().map(Result::unwrap).collect();
        assert_eq!(told, [Next::Moved, Next::Idle, Next::Reached, Next::Moved, Next::Moved]);
        for ((flow, alone), target) in flows.iter().zip(&mut alone).zip(targets) {
            if let Some(target) = target {
                alone.next(&target, &go_on).unwrap();
            }
            assert_eq!((flow.state(), flow.time()), (alone.state(), alone.time()));
            assert_eq!(flow.work().steps, alone.work().steps);
            // Every coefficient that a step reads: the last ones do not reach the state.
            for row in (0..2).chain(flow.system.tape.needed.iter().copied()) {
                assert_eq!(flow.series.rows.row(row), alone.series.rows.row(row));
            }
            // And the right sides at its end.
            let end = |flow: &Integrator<'_, Doubles>| flow.series.probe.clone();
            let (own, other) = (end(flow), end(alone));
            assert_eq!((own.rows.data, own.defects), (other.rows.data, other.defects));
        }
        let other = system(2);
        let one = Model::second_order(&(Expression::ACCELERATION + x)).unwrap();
        let one = one.compile(Doubles, &Parameters::new()).unwrap();
        assert!(Doubles::together(&[&start(&other)]).is_none());
        assert!(Doubles::together(&[&start(&other), &start(&one)]).is_none());
    }
}
