//! The 0-1 test on maps that are known to be regular or chaotic.

use lindstedt_simulate::{go_on, is_stationary, recurs, zero_one};

fn logistic(r: f64, count: usize) -> Vec<f64> {
    let mut x = 0.3;
    let mut step = || {
        x = r * x * (1.0 - x);
        x
    };
    (0..200).for_each(|_| {
        step();
    });
    (0..count).map(|_| step()).collect()
}

#[test]
fn the_logistic_map() {
    let k = |r| zero_one(&logistic(r, 3000), &go_on).unwrap().k;
    assert!(k(3.55).abs() < 0.05, "{}", k(3.55));
    assert!(k(3.97) > 0.99, "{}", k(3.97));
}

#[test]
fn a_quasi_periodic_series_is_regular() {
    let series: Vec<f64> = (0..3000).map(|n| (f64::from(n) * 2f64.sqrt()).cos() + 0.5).collect();
    assert!(zero_one(&series, &go_on).unwrap().k.abs() < 0.1);
}

/// The oscillation that a mean adds to M_c would drown the growth: also of a motion that is small beside the mean.
#[test]
fn a_large_mean_changes_little() {
    let series = logistic(3.97, 3000);
    let shifted: Vec<f64> = series.iter().map(|x| x + 20.0).collect();
    let (k, other) = (zero_one(&series, &go_on).unwrap().k, zero_one(&shifted, &go_on).unwrap().k);
    assert!((k - other).abs() < 1e-9, "{k} {other}");
    let small: Vec<f64> = series.iter().map(|x| 1.0 + 1e-7 * x).collect();
    let other = zero_one(&small, &go_on).unwrap().k;
    assert!((k - other).abs() < 1e-3, "{k} {other}");
}

/// A periodic motion seen once per period: what is left of it is rounding errors, whose growth means nothing.
#[test]
fn a_constant_is_regular() {
    let mut noise = logistic(3.97, 3000);
    noise.iter_mut().for_each(|x| *x = 0.4 + 1e-11 * *x);
    assert_eq!(zero_one(&noise, &go_on).unwrap().k, 0.0);
}

#[test]
fn no_answer_without_data() {
    assert!(zero_one(&[1.0; 99], &go_on).is_none());
    assert!(zero_one(&[f64::NAN; 200], &go_on).is_none());
    assert!(zero_one(&[0.0; 200], &go_on).is_some());
}

/// cos(6 n/5 + n^2/8000) e^(-n/10000): a test of every point or of every m-th has K = 1 without chaos.
#[test]
fn a_slow_transient_is_no_stationary_series() {
    let series = logistic(3.97, 3000);
    assert!(is_stationary(&series) && is_stationary(&series[..300]));
    let chirp = |n: u32| {
        let n = f64::from(n);
        (1.2 * n + n * n / 8000.0).cos() * (-n / 1e4).exp()
    };
    let transient: Vec<f64> = (0..2000).map(chirp).collect();
    assert!(!is_stationary(&transient));
    assert!(!is_stationary(&(0..2000).map(f64::from).collect::<Vec<_>>()));
    assert!(is_stationary(&[1.0; 100]));
}

/// Of few points of a rotation with harmonics K is large, since near each of them the displacements grow at first; it returns
/// to itself, as chaos does not.
#[test]
fn rotations_return_to_themselves() {
    let turn = |n: u32| std::f64::consts::TAU * f64::from(n) / 6.5 + 1.0;
    let wave = |t: f64| t.cos() + 0.6 * (2.0 * t + 1.0).cos() + 0.36 * (3.0 * t + 2.0).cos();
    let rotation: Vec<f64> = (0..134).map(|n| wave(turn(n))).collect();
    let test = zero_one(&rotation, &go_on).unwrap();
    assert!(test.k > 0.95 && test.quartiles.0 > 0.5 && is_stationary(&rotation));
    assert!(recurs(&rotation));
    let mut x = 0.3;
    let mut logistic = || {
        x = 3.9 * x * (1.0 - x);
        x
    };
    for points in [100, 400, 2000] {
        let series: Vec<f64> = (0..points).map(|_| logistic()).collect();
        assert!(!recurs(&series), "{points}");
    }
}
