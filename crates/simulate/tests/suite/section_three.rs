//! Section 3 at eps = 1: the period-2 stick-slip orbit, its doublings, chaos in one and in two
//! wells, by orbits, exponents and the 0-1 test. Reference numbers: an independent event code.

use crate::common::{parameters, stick_slip};
use lindstedt_simulate::{
    Doubles, Integrator, LyapunovExponent, LyapunovSettings, PoincareMap, Point, Report, Section,
    Settings, System, go_on, largest_lyapunov_exponent, zero_one,
};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// On the large right-well orbit's side.
const START: [f64; 2] = [0.11, 0.05];

fn system(gamma: &str, linearised: bool) -> System<Doubles> {
    let model = stick_slip();
    let model = if linearised { model.linearised() } else { model };
    model.compile(Doubles, &parameters(&[("gamma", gamma)])).unwrap()
}

fn orbit(gamma: &str, transient: usize, kept: usize) -> Vec<Point<f64>> {
    let system = system(gamma, false);
    let settings = Settings::for_digits(16);
    let mut map = PoincareMap::new(&system, &0.0, &START, Section::Period(PI), settings).unwrap();
    let mut next = || map.next_point(&go_on).unwrap().unwrap();
    (0..transient).for_each(|_| drop(next()));
    (0..kept).map(|_| next()).collect()
}

/// The number of forcing periods after which the orbit closes to 1e-5, up to 64; 0: not.
fn period(gamma: &str, transient: usize) -> usize {
    let points = orbit(gamma, transient, 65);
    let closes = |n: &usize| {
        let (a, b) = (&points[0].state, &points[*n].state);
        (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-5
    };
    (1..=64).find(closes).unwrap_or(0)
}

fn exponent(gamma: &str, averaged: u32) -> LyapunovExponent {
    let integration = Settings::for_digits(16);
    let settings = LyapunovSettings { interval: PI, transient: 500, averaged, integration };
    let go_on = &mut |_| ControlFlow::Continue(());
    let system = system(gamma, true);
    largest_lyapunov_exponent(&system, &0.0, &START, &settings, go_on).unwrap().unwrap()
}

fn growth(gamma: &str, count: usize, stride: usize) -> f64 {
    let x: Vec<f64> = orbit(gamma, 500, count).iter().map(|point| point.state[0]).collect();
    let x: Vec<f64> = x.into_iter().step_by(stride).collect();
    zero_one(&x, &go_on).unwrap().k
}

#[test]
fn a_period_two_stick_slip_orbit_in_the_right_well() {
    assert_eq!(period("0.6", 1000), 2);
    let system = system("0.6", false);
    let start = &orbit("0.6", 1000, 1)[0].state;
    let settings = Settings::for_digits(16);
    let mut flow = Integrator::new(&system, &0.0, start, settings).unwrap();
    let (mut stuck, mut least) = (0.0, f64::INFINITY);
    flow.advance(&(2.0 * PI), &mut |report| {
        if let Report::Segment(segment) = report {
            if segment.modes == [0] {
                stuck += segment.length;
            }
            least = least.min(segment.value(0, segment.length));
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    let share = stuck / (2.0 * PI);
    println!("stuck {share}, least x {least}");
    assert!((share - 0.27).abs() < 0.01 && least > 0.0);
}

#[test]
fn it_doubles_before_0_605() {
    assert_eq!(period("0.603", 1000), 2);
    assert_eq!(period("0.605", 1500), 4);
}

#[test]
fn exponents_and_growth_rates() {
    let regular = exponent("0.6", 500);
    assert!((regular.value + 0.0185).abs() < 5e-4, "{regular:?}");
    let slight = exponent("0.65", 1000);
    assert!((slight.value - 0.072).abs() < 0.02, "{slight:?}");
    let wells = exponent("1.2", 1000);
    assert!((wells.value - 0.185).abs() < 0.04, "{wells:?}");
    // Two bands at 0.65: every second point.
    let k = growth("0.65", 2000, 2);
    assert!(k > 0.95, "{k}");
    let k = growth("0.6", 1000, 2);
    assert!(k.abs() < 0.5, "{k}");
}

/// Bisects the first value with a longer period than `known`.
fn doubling(known: usize, mut low: f64, mut high: f64) -> f64 {
    while high - low > 1e-4 {
        let middle = (low + high) / 2.0;
        let found = period(&format!("{middle:.6}"), 6000);
        if found <= known { low = middle } else { high = middle }
    }
    high
}

#[test]
#[ignore = "a minute"]
fn doublings_at_0_604_and_0_627() {
    let (first, second) = (doubling(2, 0.603, 0.605), doubling(4, 0.626, 0.628));
    println!("{first} {second}");
    assert!((first - 0.604).abs() < 5e-4 && (second - 0.627).abs() < 5e-4);
    assert_eq!(period("0.6285", 6000), 16);
    for (gamma, known) in [("0.645", 6), ("0.675", 6), ("0.75", 4), ("0.85", 2)] {
        assert_eq!(period(gamma, 3000), known, "{gamma}");
    }
}

#[test]
#[ignore = "a minute"]
fn chaos_from_0_631() {
    for (gamma, known, error) in [("0.65", 0.072, 0.003), ("1.2", 0.185, 0.005)] {
        let exponent = exponent(gamma, 30_000);
        println!("{gamma} {exponent:?}");
        assert!((exponent.value - known).abs() < error);
    }
    let (before, after) = (exponent("0.63", 10_000), exponent("0.631", 10_000));
    println!("{before:?} {after:?}");
    assert!(before.value < -0.01 && after.value > 0.01);
    let (slight, wells) = (growth("0.65", 6000, 2), growth("1.2", 3000, 1));
    println!("{slight} {wells}");
    assert!((slight - 0.998).abs() < 0.002 && (wells - 0.998).abs() < 0.002);
    let orbit = orbit("1.2", 100, 3000);
    assert!(orbit.iter().any(|point| point.state[0] < -0.5));
    assert!(orbit.iter().any(|point| point.state[0] > 0.5));
}

/// The chaos that Melnikov's method is about begins at the tangency of the right loop, 1.10867:
/// above, orbits of the right well leave it, below they do not within 30000 periods.
#[test]
#[ignore = "a minute"]
fn jumping_between_the_wells_begins_at_the_tangency() {
    for (gamma, leaves) in [("1.108", false), ("1.11", true)] {
        let orbit = orbit(gamma, 0, 30_000);
        let first = orbit.iter().position(|point| point.state[0] < -0.5);
        println!("{gamma} {first:?}");
        assert_eq!(first.is_some(), leaves);
    }
}
