//! Branches over a parameter, and what changes on them.

use super::{amplitude, at, course, duffing, square, term, value, van_der_pol};
use lindstedt_orbit::steady::{Change, Course, Flow, Limits, Value, all_zeros, follow};
use rug::Rational;

/// The whole curve over s; both folds, where d(F^2)/d(a^2) = 0, proved.
#[test]
fn primary_resonance_branch() {
    let flow = duffing();
    let mut values = at(&["1", "1/10", "1", "1/2"]);
    values[0] = None;
    let system = flow.system(&values);
    let start = [1e-2, -0.06, -2.0];
    let branch = follow(&system, &start, &course(2, [-2.0, 4.0], 2e-3)).unwrap();
    assert!(branch.complete && !branch.closed);
    assert!(branch.points.len() > 500);
    let (first, last) = (&branch.points[0].at, branch.points.last().unwrap());
    assert!((first[2] + 2.0).abs() < 1e-12 && (last.at[2] - 4.0).abs() < 1e-12);
    for point in &branch.points {
        let (a, s) = (amplitude(&point.at), point.at[2]);
        let left = (0.01 + (s - 0.375 * a * a).powi(2)) * a * a;
        assert!((left - 0.0625).abs() < 1e-11);
        // Liouville: the trace is -2 mu.
        let trace: f64 = point.exponents.iter().map(|x| x.re).sum();
        assert!((trace + 0.2).abs() < 1e-12);
        // Unstable exactly between the folds: det = mu^2 + (s - 3c)(s - c) < 0, c = 3 a^2/8.
        let c = 0.375 * a * a;
        let determinant = 0.01 + (s - 3.0 * c) * (s - c);
        if determinant.abs() > 1e-6 {
            assert_eq!(point.is_stable(), Some(determinant > 0.0));
        }
    }
    let folds: Vec<_> = branch.points.iter().filter(|p| p.change.is_some()).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        assert_eq!(fold.change, Some(Change::Fold));
        let zero = flow.change_near(Change::Fold, &values, &fold.at).unwrap();
        let place = zero.middle();
        let (s, c) = (place[2], 0.375 * amplitude(&place).powi(2));
        assert!((0.01 + (s - 3.0 * c) * (s - c)).abs() < 1e-13);
        assert!(zero.enclosure[2].width() < 1e-12 && (s - fold.at[2]).abs() < 1e-9);
    }
}

/// Cusp: s = sqrt 3 mu, a^2 = 16 mu/(3 sqrt 3 al), F^2 = 256 mu^3/(9 sqrt 3 al).
#[test]
fn primary_resonance_cusp() {
    let flow = duffing();
    let mut values = at(&["1", "1/10", "1", "1/2"]);
    (values[0], values[3]) = (None, None);
    let root = 3f64.sqrt();
    let cusp = [0.1 * root, (256.0 * 1e-3 / (9.0 * root)).sqrt()];
    // From a fold at F = 1/2 along the curve of folds.
    let mut one = values.clone();
    one[3] = value("1/2");
    let branch = follow(&flow.system(&one), &[1e-2, -0.06, -2.0], &course(2, [-2.0, 4.0], 0.01));
    let branch = branch.unwrap();
    let fold = branch.points.iter().find(|p| p.change == Some(Change::Fold)).unwrap();
    let start = flow.change_near(Change::Fold, &one, &fold.at).unwrap().middle();
    let l = [start[3], start[4]];
    let curve = flow.conditions(Change::Fold, &values, &l).unwrap();
    let guess = [&start[..3], &[0.5], &start[3..]].concat();
    // However the points lie about it.
    for step in (0..9).map(|k| 0.02 + 0.007 * f64::from(k)) {
        let folds = follow(&curve, &guess, &course(3, [0.01, 0.6], step)).unwrap();
        assert!(folds.complete);
        let found = flow.on_folds(&values, &folds);
        assert_eq!(found.len(), 1, "{step}");
        let (change, zero) = &found[0];
        let place = zero.middle();
        assert_eq!(*change, Change::Cusp);
        assert!((place[2] - cusp[0]).abs() < 1e-12 && (place[3] - cusp[1]).abs() < 1e-12);
        assert!((amplitude(&place).powi(2) - 1.6 / (3.0 * root)).abs() < 1e-12);
    }
}

/// Guckenheimer and Holmes, section 2.1: in their units sigma = 2 s, gamma = F/2 the Bogdanov-Takens point (1/2, 1/2), the
/// cusp (1/sqrt 3, sqrt(8/27)).
#[test]
fn van_der_pol_lock_in() {
    let flow = van_der_pol();
    let free = [None, None];
    let double = flow.change_near(Change::BogdanovTakens, &free, &[-0.48, 0.52, 0.24, 0.98]);
    let double = double.unwrap().middle();
    assert!((double[2] - 0.25).abs() < 1e-13 && (double[3] - 1.0).abs() < 1e-13);
    let at = [None, value("6/5")];
    let branch =
        follow(&flow.system(&at), &[0.0, -1.2, 0.0], &course(2, [-1.0, 1.0], 5e-3)).unwrap();
    let hopf: Vec<_> = branch.points.iter().filter(|p| p.change == Some(Change::Hopf)).collect();
    assert_eq!(hopf.len(), 2);
    for point in hopf {
        let zero = flow.change_near(Change::Hopf, &at, &point.at).unwrap();
        let place = zero.middle();
        // Trace 1 - 2 |w|^2 = 0; then (1/16 + s^2)/2 = F^2/16.
        assert!((place[0].powi(2) + place[1].powi(2) - 0.5).abs() < 1e-13);
        assert!((0.5 * (0.0625 + place[2].powi(2)) - 0.09).abs() < 1e-13);
        assert!((place[2] - point.at[2]).abs() < 1e-9);
    }
    let low = [None, value("1/2")];
    let branch =
        follow(&flow.system(&low), &[0.0, -1.1, 0.0], &course(2, [-1.0, 1.0], 5e-3)).unwrap();
    // Below the cusp the locked states are a closed curve beside the one near zero.
    assert!(branch.closed);
    let folds: Vec<_> = branch.points.iter().filter(|p| p.change == Some(Change::Fold)).collect();
    assert_eq!(folds.len(), 2);
}

/// Principal parametric resonance without forcing: w = 0 loses its stability where a pair of states branches off.
#[test]
fn crossings_are_no_folds() {
    // w' = (i/4) h conj w - mu w - i s w + (3/2) i w^2 conj w; parameters s, mu, h.
    let equation = vec![
        term(&[0, 1], &[0, 0, 1], (0, 1), (1, 4)),
        term(&[1, 0], &[0, 1, 0], (-1, 1), (0, 1)),
        term(&[1, 0], &[1, 0, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0, 0], (0, 1), (3, 2)),
    ];
    let flow = Flow::of_complex(&[equation], &["s", "mu", "h"]);
    let values = [None, value("1/10"), value("1")];
    let branch =
        follow(&flow.system(&values), &[0.0, 0.0, -1.0], &course(2, [-1.0, 1.0], 0.01)).unwrap();
    let changes: Vec<_> = branch.points.iter().filter(|p| p.change.is_some()).collect();
    // mu^2 + s^2 = h^2/16.
    let edge = (0.0625f64 - 0.01).sqrt();
    assert_eq!(changes.len(), 2);
    for (point, s) in changes.iter().zip([-edge, edge]) {
        assert_eq!(point.change, Some(Change::Crossing));
        assert!((point.at[2] - s).abs() < 1e-6);
    }
    let exact = at(&["0", "1/10", "1"]);
    let found = all_zeros(&flow.system(&exact), &square(1.5), &Limits::default()).unwrap();
    assert!(found.is_proved());
    assert_eq!(found.zeros.len(), 3);
}

/// The folds of that lock-in are a closed curve, 1/4 + s^2 - y + 3 y^2/4 = 0 with y = |w|^2, passed twice, with
/// (w, F) and (-w, -F): four cusps wherever on it the points begin.
#[test]
fn cusps_of_a_closed_curve() {
    let (flow, free) = (van_der_pol(), [None, None]);
    // One of its points, with F^2/16 = y |1/2 - i s - y/2|^2 and the phase of w such that i F/4 = (1/2 - i s - y/2) w.
    let (y, s) = (0.9f64, 0.0425f64.sqrt());
    let size = (0.5 - 0.5 * y).hypot(s);
    let w = [-s / size, (0.5 - 0.5 * y) / size].map(|part| part * y.sqrt());
    let force = 4.0 * y.sqrt() * size;
    let values = [None, Some(Value::Rational(Rational::from_f64(force).unwrap()))];
    let fold = flow.change_near(Change::Fold, &values, &[w[0], w[1], s]).unwrap().middle();
    let curve = flow.conditions(Change::Fold, &free, &fold[3..5]).unwrap();
    let course = Course { second: Some((3, [-2.0, 2.0])), ..course(2, [-1.0, 1.0], 0.02) };
    let start = [&fold[..3], &[force], &fold[3..]].concat();
    let once = follow(&curve, &start, &course).unwrap();
    assert!(once.closed && once.points.len() > 100);
    for point in &once.points {
        let folds = follow(&curve, &point.at, &course).unwrap();
        let found = flow.on_folds(&free, &folds);
        let cusps = found.iter().filter(|(change, _)| *change == Change::Cusp).count();
        assert_eq!((folds.closed, cusps), (true, 4), "{:?}: {found:?}", point.at);
    }
}
