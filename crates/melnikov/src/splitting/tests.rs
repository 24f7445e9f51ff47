//! The slope of the threshold against homoclinic tangencies found by following the manifolds.

#![allow(clippy::unwrap_used)]

use super::{Connection, SecondOrder, Splitting};
use std::f64::consts::PI;

/// The paper's oscillator at its point.
fn stick_slip(middle: f64) -> SecondOrder {
    let friction = |_: f64, v: f64| {
        let w = v - 0.4;
        Some([0.3 * w.signum() - 0.3 * w + 0.3 * w.powi(3), 0.0, -0.3 + 0.9 * w * w])
    };
    let splitting = Splitting {
        force: &|x| Some([x - x.powi(3), 1.0 - 3.0 * x * x]),
        drive: &|t, _, _| Some([(2.0 * t).cos(), 0.0, 0.0]),
        friction: &friction,
        period: PI,
        harmonics: 1,
        kink: Some(0.4),
    };
    splitting.second_order(&Connection { saddles: [0.0, 0.0], middle }).unwrap()
}

/// Tangencies by an independent event code, 7 decimals, at eps = 0.005, 0.01, 0.05: the slope by Neville's scheme.
#[test]
fn stick_slip_against_tangencies() {
    let gamma_0 = 0.637_071_342_848_163_6;
    let right = [(0.005, 0.638_071_4), (0.01, 0.639_078_5), (0.05, 0.647_386_2)];
    let left = [(0.005, 0.636_078_2), (0.01, 0.635_092_1), (0.05, 0.627_455_0)];
    for (middle, table) in [(2f64.sqrt(), right), (-2f64.sqrt(), left)] {
        let found = stick_slip(middle);
        let quotient = table.map(|(eps, gamma)| (eps, (gamma - gamma_0) / eps));
        let line = |a: (f64, f64), b: (f64, f64)| a.1 - a.0 * (b.1 - a.1) / (b.0 - a.0);
        let (near, far) = (line(quotient[0], quotient[1]), line(quotient[1], quotient[2]));
        println!("{found:?} {near} {far}");
        assert!((found.signed - gamma_0).abs() < 1e-9, "{found:?}");
        assert!((found.slope - near).abs() < 1e-4 && found.error < 1e-6, "{found:?} {near} {far}");
    }
}
