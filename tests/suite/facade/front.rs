//! What nothing beats in time and error.

use lindstedt::trade::{Method, Row, most_accurate, pareto, recommend, recommend_for_many};
use lindstedt_tests::Random;

fn rows(points: &[(f64, f64)]) -> Vec<Row> {
    let row = |&(seconds, error): &(f64, f64)| Row {
        method: Method::Doubles,
        order: Some(1),
        summation: None,
        seconds,
        seconds_again: 1.0 / seconds,
        bytes: 0,
        period: "1".to_owned(),
        true_error: error,
        stated_error: 10.0 * error,
        proved_error: None,
        pareto: false,
    };
    points.iter().map(row).collect()
}

#[test]
fn the_front_is_what_nothing_beats() {
    let points = [(3.0, 1e-9), (1.0, 1e-2), (2.0, 1e-2), (2.0, 1e-5), (4.0, 1e-9), (5.0, 0.0)];
    assert_eq!(pareto(&rows(&points)), [1, 3, 0, 5]);
    assert_eq!(pareto(&rows(&[(1.0, 1.0), (1.0, 1.0)])), [0]);
    assert_eq!(pareto(&rows(&[(1.0, f64::NAN), (2.0, 0.5)])), [1]);
    assert!(pareto(&[]).is_empty());
}

/// The definition by all pairs, on pseudo-random points.
#[test]
fn the_front_by_its_definition() {
    let mut random = Random(1);
    let mut next = || random.below(40) as f64;
    for _ in 0..50 {
        let points: Vec<(f64, f64)> = (0..30).map(|_| (next(), next())).collect();
        let front = pareto(&rows(&points));
        for (i, p) in points.iter().enumerate() {
            let beaten = points
                .iter()
                .enumerate()
                .any(|(j, q)| q.0 <= p.0 && q.1 <= p.1 && (q.0 < p.0 || q.1 < p.1 || j < i));
            assert_eq!(front.contains(&i), !beaten, "{points:?} {i}");
        }
    }
}

#[test]
fn the_fastest_that_states_enough() {
    let list = rows(&[(3.0, 1e-12), (1.0, 1e-2), (2.0, 1e-9), (2.5, 1e-10)]);
    // Stated are ten times the true errors.
    assert_eq!(recommend(&list, 1e-9), Some(3));
    assert_eq!(recommend(&list, 1.0), Some(1));
    assert_eq!(recommend(&list, 1e-20), None);
    assert_eq!(recommend_for_many(&list, 1e-3), Some(0));
    assert_eq!(most_accurate(&list, 2.5), Some(3));
    assert_eq!(most_accurate(&list, 10.0), Some(0));
    assert_eq!(most_accurate(&list, 0.5), None);
}
