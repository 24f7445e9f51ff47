//! Cycles on the belt without sticking, against the equation in time and against each other.

use lindstedt::motion::{End, Motion};
use lindstedt::unstable::number::ball::{Ball, Balls};
use lindstedt::{Exact, Oscillator, Simulate, Work};
use lindstedt_melnikov::{
    BeltCycle, MelnikovError, PolynomialFriction, Region, belt_cycles, sticking_begins,
};

fn law() -> PolynomialFriction {
    let t = || Exact::from((3, 10));
    PolynomialFriction::cubic(t(), &t(), t())
}

fn cycles(b: i32, belt: &str, region: Region) -> Vec<BeltCycle> {
    let belt = Exact::parse(belt).unwrap();
    belt_cycles(Balls::new(128), &Exact::from(1), &Exact::from(b), &law(), &belt, region).unwrap()
}

fn onset(b: i32, region: Region) -> Vec<BeltCycle> {
    sticking_begins(Balls::new(128), &Exact::from(1), &Exact::from(b), &law(), region).unwrap()
}

fn f64(ball: &Ball) -> f64 {
    assert!(ball.radius().to_f64() < 1e-20);
    ball.midpoint().to_f64()
}

/// (20) without a force, from x at rest, eps = 1/100.
fn motion(b: i32, belt: &str, x: f64, time: f64) -> Motion {
    let law = format!("0.3*(sign(x' - {belt}) - (x' - {belt}) + (x' - {belt})^3)");
    let equation = format!("x'' - x + {b}*x^3 + 0.01*{law} = 0");
    let end = Some(End::Time(Exact::from_f64(time).unwrap()));
    let mut question = Simulate { end, ..Simulate::default() };
    question.start.state = Some(vec![Exact::from_f64(x).unwrap(), Exact::from(0)]);
    let work = Work { doubles: true, ..Work::default() };
    Oscillator::parse(&equation).unwrap().motion(&question, &work).unwrap().value
}

/// From rest at x to the next maximum of x, and the time it takes: the sliding law, by Runge and Kutta's rule, the last
/// step in v (Henon).
fn turn(eps: f64, b: i32, belt: f64, x: f64) -> [f64; 2] {
    let force = |x: f64, v: f64| {
        let w = v - belt;
        x - f64::from(b) * x.powi(3) - eps * 0.3 * (w.powi(3) - w - 1.0)
    };
    let in_time = |y: [f64; 3]| [1.0, y[2], force(y[1], y[2])];
    let in_speed = |y: [f64; 3]| in_time(y).map(|rate| rate / force(y[1], y[2]));
    let step = |y: [f64; 3], h: f64, rate: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let at = |k: [f64; 3], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
        let k1 = rate(y);
        let k2 = rate(at(k1, h / 2.0));
        let k3 = rate(at(k2, h / 2.0));
        let k4 = rate(at(k3, h));
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    };
    let mut y = [0.0, x, 0.0];
    loop {
        let next: [f64; 3] = step(y, 0.005, &in_time);
        if y[2] > 0.0 && next[2] <= 0.0 {
            let [t, x, _] = step(y, -y[2], &in_speed);
            return [x, t];
        }
        y = next;
    }
}

/// The return map between turning points: its fixed point, and the logarithm of its slope over the period.
#[test]
fn amplitude_and_exponent_are_those_of_the_equation() {
    for (b, belt, region) in [(1, "0.55", Region::Inside), (5, "0.53", Region::Outside)] {
        let found = cycles(b, belt, region);
        assert_eq!(found.len(), 1);
        let speed = belt.parse::<f64>().unwrap();
        let miss = |eps: f64| {
            let gap = |x: f64| turn(eps, b, speed, x)[0] - x;
            let h = 1e-3;
            let mut x = f64(&found[0].turning_points[1]);
            let slope = |x: f64| (gap(x + h) - gap(x - h)) / (2.0 * h);
            for _ in 0..6 {
                x -= gap(x) / slope(x);
            }
            let [_, period] = turn(eps, b, speed, x);
            let rate = (1.0 + slope(x)).ln() / period / eps;
            let exact = f64(&found[0].exponent);
            assert!(exact < 0.0);
            let time = period / f64(&found[0].period) - 1.0;
            [x / f64(&found[0].turning_points[1]) - 1.0, time, rate / exact - 1.0]
        };
        let (coarse, fine) = (miss(0.02), miss(0.01));
        for (c, f) in coarse.into_iter().zip(fine) {
            assert!(f.abs() < 0.02 && f.abs() < 0.6 * c.abs() + 1e-4, "b = {b}: {c} {f}");
        }
    }
}

/// Where the cycle meets the speed of the belt, and on both sides of it in time. (A belt that is slower by more than
/// about eps T0 is overtaken: the mass then passes its speed where the spring is stronger than dry friction.)
#[test]
fn sticking_begins_where_the_cycle_meets_the_belt() {
    for (b, region) in [(1, Region::Inside), (5, Region::Outside)] {
        let list = onset(b, region);
        assert_eq!(list.len(), 1, "b = {b}");
        let belt = f64(&list[0].belt_speed);
        let top = f64(&list[0].turning_points[1]);
        for (factor, sticks) in [(0.997, true), (1.003, false)] {
            let belt = format!("{:.6}", belt * factor);
            assert_eq!(cycles(b, &belt, region).len(), usize::from(!sticks), "b = {b}, {belt}");
            let motion = motion(b, &belt, top, 2000.0);
            let sticking: f64 = motion.sticking_time.decimal.parse().unwrap();
            assert_eq!(sticking > 0.0, sticks, "b = {b}, {belt}: {sticking}");
        }
    }
}

/// S_2 D' of small cycles: v_m^2 = 4 (alpha/beta - 3 v*^2)/3, born at v* = 3^(-1/2), where lambda vanishes.
#[test]
fn cycles_are_born_at_rest() {
    let found = cycles(1, "0.577", Region::Inside);
    let small = 4.0 / 3.0 * (1.0 - 3.0 * 0.577f64.powi(2));
    let speed = f64(&found[0].largest_speed);
    assert!((speed * speed / small - 1.0).abs() < 0.02, "{speed}");
    assert!(cycles(1, "0.5775", Region::Inside).is_empty());
    let b = Exact::from(0);
    let refused = belt_cycles(Balls::new(64), &b, &b, &law(), &b, Region::Inside);
    assert!(matches!(refused, Err(MelnikovError::NotPositive { .. })));
}
