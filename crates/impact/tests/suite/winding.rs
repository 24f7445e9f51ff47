//! The walk around the circle, and the flight of an equivalent flow.

use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::equivalent::{Drive, equivalent_orbit};
use lindstedt_impact::flow::Flow;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, Parameters};
use lindstedt_impact::winding::{Walk, safe_step, walk, zero_count};
use lindstedt_number::complex::Complex;

/// On the disc of a safe step G stays within its budget, so no turn can be missed.
#[test]
fn a_step_stays_within_its_budget() {
    let mut longest = 0.0_f64;
    for n in 0..60 {
        let spread = f64::from(n % 7) / 3.0 - 1.0;
        let parameters = Parameters {
            alpha: 1.0,
            omega: 2.0 + f64::from(n) / 20.0,
            periods: 1 + n % 3,
            restitution: 0.8,
            wall: -0.2,
            damping: 0.1,
            force: 1.0,
            displacement_gain: 0.4 * spread,
            velocity_gain: -0.3 * spread,
            branch: Branch::Plus,
        };
        let found = orbit(&parameters).ok();
        let Some(found) = found else { continue };
        let g = Characteristic::new(&parameters, &found, Kick::Mean);
        for m in 0..40 {
            let (sin, cos) = (std::f64::consts::PI * f64::from(m) / 40.0).sin_cos();
            let w = Complex::new(cos, sin);
            let (value, slope) = g.value_and_slope(&w);
            let size = value.modulus();
            let step = safe_step(&g, &w, size, slope.modulus());
            for k in 0..24 {
                let (sin, cos) = (f64::from(k) * 0.27).sin_cos();
                let there = w.clone() + Complex::new(step * cos, step * sin);
                let change = (g.value_and_slope(&there).0 - &value).modulus() / size;
                assert!(change < 0.91, "{parameters:?} {change}");
                longest = longest.max(change);
            }
        }
    }
    assert!(longest > 0.3, "the steps are needlessly short: {longest}");
}

fn flight_with_gain(displacement_gain: f64) -> Characteristic<f64> {
    let parameters = Parameters {
        alpha: 1.0,
        omega: 2.6,
        periods: 1,
        restitution: 0.8,
        wall: 0.0,
        damping: 0.1,
        force: 1.0,
        displacement_gain,
        velocity_gain: 0.0,
        branch: Branch::Plus,
    };
    Characteristic::new(&parameters, &orbit(&parameters).unwrap(), Kick::None)
}

/// |G| up to 1e200: the product of two values is out of range. Against steps of equal length.
#[test]
fn large_values_are_counted() {
    let g = flight_with_gain(4000.0);
    let steps = 100_000;
    let argument = |n: i32| {
        let (sin, cos) = (std::f64::consts::PI * f64::from(n) / f64::from(steps)).sin_cos();
        let value = g.value_and_slope(&Complex::new(10.0 * cos, 10.0 * sin)).0;
        assert!(value.re.hypot(value.im) < 1e300);
        value.im.atan2(value.re)
    };
    let whole = std::f64::consts::TAU;
    let turn = |n: i32| {
        let change = argument(n + 1) - argument(n);
        change - whole * (change / whole).round()
    };
    let angle: f64 = (0..steps).map(turn).sum();
    let zeros = (2.0 * angle / whole).round() as u32;
    assert!(zeros > 20, "{zeros}");
    assert_eq!(zero_count(&g, 10.0).map(|count| count.zeros), Some(zeros));
}

/// exp(1e10) on the circle ends the walk before it begins.
#[test]
fn values_out_of_range_are_found_at_once() {
    assert!(walk(&flight_with_gain(1e20), 1.0) == Walk::OutOfRange);
}

/// By differences: the flight begins and ends at the wall, with the velocities and the accelerations of the orbit.
#[test]
fn the_flight_is_consistent() {
    let drive = Drive {
        omega: 1.7_f64,
        period: 2.0 * std::f64::consts::PI / 1.7,
        restitution: 0.6,
        wall: 0.1,
        forced_amplitude: 0.8,
        branch: Branch::Plus,
    };
    let flow = Flow { growth_rate: -0.13, frequency: 0.9 };
    let orbit = equivalent_orbit(&flow, &drive).unwrap();
    let x = |t: f64| {
        let (sin, cos) = (flow.frequency * t).sin_cos();
        let free = (flow.growth_rate * t).exp() * (orbit.cosine * cos + orbit.sine * sin);
        orbit.forced_amplitude * (drive.omega * t + orbit.phase_angle()).cos() + free
    };
    for (t, velocity, acceleration) in [
        (0.0, -0.6 * orbit.velocity, orbit.acceleration_after),
        (drive.period, orbit.velocity, orbit.acceleration_before),
    ] {
        let (h, here) = (1e-4, x(t));
        let (before, after) = (x(t - h), x(t + h));
        assert!((here - 0.1).abs() < 1e-14);
        assert!(((after - before) / (2.0 * h) - velocity).abs() < 1e-7);
        assert!(
            ((after - here) - (here - before) - acceleration * h * h).abs() < 1e-6 * h * h + 1e-15
        );
    }
}
