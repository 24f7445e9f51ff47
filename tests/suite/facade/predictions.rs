//! How long the next order takes.

use lindstedt::trade::{Method, predict};

/// Nothing from milliseconds; 0.1 s and 0.4 s at orders 2 and 4 are 25.6 s at order 10; a run
/// that was broken off ends its method.
#[test]
fn predictions() {
    let exact = Method::Exact { digits: 30 };
    assert_eq!(predict(&exact, &[(2, 0.0001), (4, 0.003)], Some(32)), None);
    assert_eq!(predict(&exact, &[(2, 0.04), (4, 0.4)], Some(10)), None);
    let seconds = predict(&exact, &[(2, 0.1), (4, 0.4)], Some(10));
    assert!(seconds.is_some_and(|s| (s - 25.6).abs() < 1e-9), "{seconds:?}");
    assert_eq!(predict(&exact, &[(2, f64::INFINITY)], Some(10)), Some(f64::INFINITY));
    assert_eq!(predict(&Method::Doubles, &[(2, 0.1), (4, 0.4)], Some(10)), None);
}
