//! All branches that pass given values, their changes in a plane, and where a start leads.

use super::{amplitude, at, course, duffing, term, value, van_der_pol};
use lindstedt_number::Exact;
use lindstedt_orbit::steady::{Change, Course, Fate, Flow, Limits, Plane, Survey, settle};

/// At s = 1 the start decides between the two stable states.
#[test]
fn starts_settle_on_different_branches() {
    let system = duffing().system(&at(&["1", "1/10", "1", "1/2"]));
    let fate = |start: [f64; 2]| settle(&system, &start, 1.0, 1000.0, &Default::default());
    let (Fate::Steady(low), Fate::Steady(high)) = (fate([0.0, 0.0]), fate([0.8, 0.0])) else {
        unreachable!()
    };
    assert!(amplitude(&low) < 0.5 && amplitude(&high) > 1.0);
}

/// Below the cusp: the branch near zero and the closed one, each once; two folds.
#[test]
fn a_closed_branch_is_found_once() {
    let flow = van_der_pol();
    let samples = ["-1/10", "0", "1/10"].map(|text| Exact::parse(text).unwrap());
    let values = vec![None, value("1/2")];
    let course = course(2, [-1.0, 1.0], 0.01);
    let limits = Limits::default();
    let survey = Survey { flow: &flow, values, samples: samples.to_vec(), course, limits };
    let response = survey.run().unwrap();
    let closed: Vec<bool> = response.branches.iter().map(|branch| branch.closed).collect();
    assert_eq!(closed.iter().filter(|closed| **closed).count(), 1);
    assert_eq!(closed.len(), 2);
    let counts: Vec<usize> = response.searches.iter().map(|(_, found)| found.zeros.len()).collect();
    assert_eq!(counts, [3, 3, 3]);
    let folds: Vec<_> = response.changes.iter().filter(|c| c.change == Change::Fold).collect();
    assert_eq!(folds.len(), 2);
    assert!(folds.iter().all(|fold| fold.proved.is_some()));
}

/// The closed branch, |s| < 0.126, lies between all values looked at: its folds are found themselves.
#[test]
fn a_closed_branch_between_the_values_is_found() {
    let flow = van_der_pol();
    let survey = |force: &str| {
        let samples = ["-1", "-3/7", "3/7", "1"].map(|text| Exact::parse(text).unwrap()).to_vec();
        let (values, course, limits) =
            (vec![None, value(force)], course(2, [-1.0, 1.0], 0.01), Limits::default());
        Survey { flow: &flow, values, samples, course, limits }.run().unwrap()
    };
    let response = survey("1/2");
    let closed = response.branches.iter().filter(|branch| branch.closed).count();
    assert_eq!((response.branches.len(), closed), (2, 1));
    // 15 000 where the moduli are not looked at first.
    assert!(response.no_closed_missing && response.boxes < 2_000, "{}", response.boxes);
    let folds: Vec<_> = response.changes.iter().filter(|c| c.change == Change::Fold).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        // At a fold both y (1/4 + s^2 - y/2 + y^2/4) = F^2/16 of y = |w|^2 and its derivative by y hold.
        let place = fold.proved.as_ref().unwrap().middle();
        let (y, s) = (place[0].powi(2) + place[1].powi(2), place[2]);
        let y_derivative = 0.25 + s * s - y + 0.75 * y * y;
        assert!(y_derivative.abs() < 1e-12 && (s.abs() - 0.126).abs() < 1e-3, "{s}");
    }
    // Above both closed branch and folds are gone but for those of the one branch.
    assert!(survey("3/2").branches.iter().all(|branch| !branch.closed));
}

/// The pitchfork of an oscillator at twice whose frequency another one is forced: the branch that leaves it turns back there,
/// which is no fold. By hand: |w_2|^2 is where (m + i s_1)... has modulus 2 |w_2|, two crossings, no more.
#[test]
fn a_pitchfork_is_listed_once() {
    // x'' + x + eps (2 m x' + x y) = 0, y'' + 4 y + eps (y + 2 m y' + x^2) = eps F cos((2 + eps s) t) of order one.
    let first = vec![
        term(&[1, 0, 0, 0], &[0], (-1, 10), (0, 1)),
        term(&[1, 0, 0, 0], &[1], (0, 1), (-1, 2)),
        term(&[0, 1, 1, 0], &[0], (0, 1), (1, 2)),
    ];
    let second = vec![
        term(&[0, 0, 1, 0], &[0], (-1, 10), (1, 4)),
        term(&[0, 0, 1, 0], &[1], (0, 1), (-1, 1)),
        term(&[2, 0, 0, 0], &[0], (0, 1), (1, 4)),
        term(&[0, 0, 0, 0], &[0], (0, 1), (-8, 8)),
    ];
    let flow = Flow::of_complex(&[first, second], &["s"]);
    let samples = ["-2", "0", "2"].map(|text| Exact::parse(text).unwrap()).to_vec();
    let course = Course { reach: 7.0, unknowns: 4, ..course(4, [-2.0, 2.0], 1.0 / 60.0) };
    let limits = Limits { modulus: Some(7.0), ..Limits::default() };
    let response =
        Survey { flow: &flow, values: vec![None], samples, course, limits }.run().unwrap();
    let kinds: Vec<Change> = response.changes.iter().map(|c| c.change).collect();
    assert_eq!(kinds, [Change::Crossing; 2], "{:?}", response.changes);
    for crossing in &response.changes {
        // On w_1 = 0: w_2 = i/(-1/10 + i (1/4 - s)), and |w_2|/2 = |1/10 + i s/2|.
        let s = crossing.at[4];
        let square = (0.01 + (0.25 - s).powi(2)).recip();
        assert!((0.25 * square - (0.01 + 0.25 * s * s)).abs() < 1e-12, "{s}");
        assert!(crossing.at[..2].iter().all(|x| x.abs() < 1e-9));
    }
    assert!(!response.no_closed_missing);
}

/// The lock-in of van der Pol's oscillator in the plane of detuning and force: one cusp and one Bogdanov-Takens point on each
/// side, curves of folds and of Hopf points.
#[test]
fn lock_in_diagram() {
    let flow = van_der_pol();
    let exact = |list: &[&str]| list.iter().map(|text| Exact::parse(text).unwrap()).collect();
    let samples: [Vec<Exact>; 2] = [exact(&["0", "1/5", "2/5"]), exact(&["1/2", "6/5"])];
    let plane = Plane {
        flow: &flow,
        values: vec![None, None],
        open: [0, 1],
        samples,
        course: course(2, [-1.0, 1.0], 5e-3),
        second: [0.1, 2.0],
        limits: Limits::default(),
    };
    let diagram = plane.run().unwrap();
    let count = |change| diagram.corners.iter().filter(|corner| corner.0 == change).count();
    assert_eq!((count(Change::Cusp), count(Change::BogdanovTakens)), (2, 2));
    for (change, zero) in &diagram.corners {
        let place = zero.middle();
        // Guckenheimer and Holmes: sigma = 2 s, gamma = F/2.
        let known = match change {
            Change::Cusp => (1.0 / 3f64.sqrt(), (8.0f64 / 27.0).sqrt()),
            _ => (0.5, 0.5),
        };
        assert!((2.0 * place[2].abs() - known.0).abs() < 1e-12, "{change:?} {place:?}");
        assert!((0.5 * place[3] - known.1).abs() < 1e-12);
    }
    let of = |change| diagram.curves.iter().filter(|curve| curve.change == change).count();
    assert!(of(Change::Fold) >= 1 && of(Change::Hopf) >= 2, "{}", of(Change::Hopf));
}
