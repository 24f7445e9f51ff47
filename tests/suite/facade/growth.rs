//! Growth of a perturbation, as long as it is linear; values as they are written.

use lindstedt::Exact;
use lindstedt::formulas::growth::{grows, linear, verdict};
use lindstedt::formulas::shown;
use rug::{Float, Rational};

fn series(ratio: f64, count: i32) -> Vec<Float> {
    (0..count).map(|n| Float::with_val(80, ratio.powi(n))).collect()
}

#[test]
fn growth_is_told_from_decay_and_from_neither() {
    assert_eq!(grows(&series(-1.05, 40)), Some(true));
    assert_eq!(grows(&series(0.9, 40)), Some(false));
    assert_eq!(grows(&series(-1.0, 40)), None);
    assert_eq!(grows(&series(2.0, 11)), None);
}

/// Ratios -1.6 and -1.2 in turn: 1.6*1.2 = 1.3856^2. A constant ratio needs no mean.
#[test]
fn alternating_ratios_have_a_mean() {
    let at = |n: i32| 1e-6 * (-1.6f64).powi((n + 1) / 2) * (-1.2f64).powi(n / 2);
    let turns: Vec<Float> = (0..21).map(|n| Float::with_val(80, at(n))).collect();
    let words = verdict(&turns, turns.len());
    assert!(words.contains("grows, last ratio -1.20000000"), "{words}");
    assert!(words.contains("geometric mean of the last 10: 1.385641 per impact"), "{words}");
    assert!(!verdict(&series(-1.05, 40), 40).contains("mean"));
}

/// Saturated at one: half the perturbation comes there later, and only what is before counts.
#[test]
fn saturated_deviations_do_not_count() {
    let run = |start: f64| -> Vec<Float> {
        let grown = |n: i32| start * 1.5f64.powi(n);
        (0..60).map(|n| Float::with_val(80, grown(n) / (1.0 + grown(n)))).collect()
    };
    let (all, half) = (run(1e-3), run(5e-4));
    let count = linear(&all, &half, &all);
    assert!((5..12).contains(&count), "{count}");
    let (all, half) = (run(1e-6), run(5e-7));
    let count = linear(&all, &half, &all);
    assert!((20..30).contains(&count) && grows(&all[..count]) == Some(true), "{count}");
}

#[test]
fn values_as_they_are_written() {
    let q = |p: i64, r: i64| Rational::from((p, r));
    for (value, text) in [(q(3, 5), "0.6"), (q(-1, 40), "-0.025"), (q(7, 1), "7"), (q(1, 3), "1/3")]
    {
        assert_eq!(shown(&value.into()), text);
    }
    for (value, text) in [(q(1, 1), "pi"), (q(0, 1), "0"), (q(3, 4), "3/4*pi"), (q(-2, 1), "-2*pi")]
    {
        assert_eq!(shown(&Exact::pi_times(value).into()), text);
    }
}
