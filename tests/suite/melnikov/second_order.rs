//! The threshold to second order: Melnikov's integral against the tangencies of the manifolds.

use lindstedt::threshold::SecondOrderThreshold;
use lindstedt::{Error, Kind, Number, Oscillator, Refusal, Threshold, Work};

fn second_order(equation: &str) -> Result<Vec<SecondOrderThreshold>, Error> {
    let question = Threshold { second_order: true, ..Threshold::default() };
    let work = Work { digits: 12, ..Work::default() };
    Ok(Oscillator::parse(equation)?.threshold(&question, &work)?.value.second_order)
}

fn parts(number: &Number) -> (f64, f64) {
    (number.decimal.parse().unwrap(), number.error.as_ref().unwrap().parse().unwrap())
}

/// Both routes give the intercept and the slope, within their own errors; those of the manifolds are not ten times
/// too large.
#[test]
fn the_integral_is_the_slope_of_the_tangencies() {
    let list = second_order("x'' - x + x^2 = eps*(cos(t) - x' - x'^2)").unwrap();
    let followed = list[0].manifolds.as_ref().unwrap();
    let pairs = [(&list[0].gamma_c, &followed.gamma_c), (&list[0].slope, &followed.slope)];
    for (one, other) in pairs {
        // b is printed to the digits that its error leaves.
        let decimals = other.decimal.split('.').next_back().map_or(0, str::len);
        let rounding = 0.5 / 10f64.powi(decimals.try_into().unwrap());
        let ((a, error), (b, other)) = (parts(one), parts(other));
        let miss = (a - b).abs();
        assert!(miss <= error + other, "{a} +- {error}, {b} +- {other}");
        assert!(other <= 10.0 * (miss + error + rounding), "{a}, {b} +- {other}");
    }
    assert!((parts(&list[0].slope).0 + 0.367_607_8).abs() < 1e-6, "{:?}", list[0].slope);
}

/// Orbits from saddle to saddle have the integral alone; what has no second order is refused.
#[test]
fn what_has_none_is_named() {
    let upper = &second_order("x'' + x - x^3 = eps*(cos(2*t) - x')").unwrap()[0];
    assert!(upper.manifolds.is_none() && upper.not_followed.is_some());
    for (equation, word) in [
        ("x'' - x + x^3 = eps*(cos(t) + cos(pi*t) - x')", "no common period"),
        ("x'' - x + x^3 = eps*(cos(t) - sign(x'))", "v* = 0"),
    ] {
        let refused = second_order(equation).unwrap_err();
        assert_eq!(refused.kind(), Kind::NoAnswer, "{equation}");
        assert!(refused.to_string().contains(word), "{refused}");
    }
}

/// The work of the force has two equal maxima in a period, sin t_0 + 0.67 sin 3 t_0 but for a factor: two tangencies of
/// different slopes, of which the first is the threshold on either side of eps = 0. The manifolds meet it, also t -> -t.
#[test]
fn of_equal_extrema_the_first_counts() {
    for equation in [
        "x'' - x + x^2 = eps*(cos(t) + 40*cos(3*t) - x' - x'^2)",
        "x'' - x + x^2 = eps*(x' - x'^2 + cos(t) + 40*cos(3*t))",
    ] {
        let list = second_order(equation).unwrap();
        let slopes = [Some(&list[0].slope), list[0].slope_below.as_ref()].map(Option::unwrap);
        let [above, below] = slopes.map(|slope| parts(slope).0);
        assert!(above < below - 1e-3, "{list:?}");
        let followed = parts(&list[0].manifolds.as_ref().unwrap().slope).0;
        assert!((followed - above).abs() < 1e-6, "{equation}: {followed}, {above}, {below}");
    }
}
