//! Rules of documents and figures.

use lindstedt_report::figure::{Axis, colours::VERDICTS};
use lindstedt_report::rules::{angle, balanced, shade};

#[test]
fn names_stand_at_whole_places() {
    let axis = Axis::named("rule", ["first", "second rule"]);
    let words = [0.0, 1.0, 1.5, 2.0, 3.0].map(|place| axis.tick(place, &(0.9..2.1)));
    assert_eq!(words, ["", "first", "", "second rule", ""]);
    assert_eq!(axis.widest(&(0.9..2.1)), 11);
    assert_eq!(Axis::linear("x").widest(&(0.0..10.0)), 2);
}

#[test]
fn verdicts_differ_in_lightness() {
    // Rec. 601.
    let mut all = VERDICTS
        .map(|(r, g, b)| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b));
    all.sort_by(f64::total_cmp);
    assert!(all.windows(2).all(|pair| pair[1] - pair[0] > 35.0), "{all:?}");
}

#[test]
fn signs_of_turns() {
    let known = ["2 eta_1 - eta_2", r"2 \eta_1 - \eta_2"];
    assert_eq!(angle("2, -1"), known);
    let known = ["-(1/2) eta_2 + eta_3", r"-\frac{1}{2} \eta_2 + \eta_3"];
    assert_eq!(angle("0, -1/2, 1"), known);
}

/// Rec. 601: in print without colours the sign and the size are still told.
#[test]
fn the_lightness_of_a_shade_rises_with_the_value() {
    let lightness = |n: i32| {
        let (r, g, b) = shade(f64::from(n) / 20.0);
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    };
    let all: Vec<f64> = (-20..=20).map(lightness).collect();
    assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
    assert!(all[0] < 60.0 && (all[20] - 170.0).abs() < 1.0 && all[40] > 220.0, "{all:?}");
}

#[test]
fn malformed_elements_are_found() {
    assert!(balanced("<math><msup><mi>x</mi><mn>2</mn></msup></math>").is_ok());
    assert!(balanced("<math><msup><mi>x</mi></msup></math>").is_err());
    assert!(balanced("<math><mi>x</math>").is_err());
}
