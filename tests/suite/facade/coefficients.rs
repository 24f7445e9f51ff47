//! Coefficients as numbers against the exact ones.

use lindstedt::unstable::algebra::Stop;
use lindstedt::unstable::evaluation::coefficients::{pendulum, power_law};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::{
    Quantity, Route, unstable::derivation::Settings, unstable::derivation::derive,
    unstable::problems,
};
use rug::Float;

/// The exact polynomials, evaluated as balls, against the recurrences in numbers.
#[test]
fn numbers_agree_with_the_exact_series() {
    let order = 9;
    let settings = Settings { order, route: Route::EnergyIntegral, ..Settings::default() };
    let one = |balls: Balls| balls.one();
    for name in ["power-law", "pendulum"] {
        let problem = problems::find(name).unwrap();
        let exact = derive(&problem, &settings, &mut |_| true).unwrap();
        let numbers = match name {
            "power-law" => power_law(order, 300, &Stop::default()),
            _ => pendulum(&one, order, 300, &Stop::default()),
        };
        for (n, number) in numbers.unwrap().iter().enumerate() {
            let ball = exact.ball(Quantity::Period, n, Balls::new(400)).unwrap();
            let error = Float::with_val(53, ball.midpoint() - number).abs();
            assert!(error < 1e-85, "{name} {n}: {error}");
        }
    }
}

/// What rounding leaves at order 40.
#[test]
fn rounding_is_below_the_bits() {
    let three = |balls: Balls| balls.from_i64(3);
    let at = |bits| pendulum(&three, 40, bits, &Stop::default()).unwrap();
    let (low, high) = (at(200), at(500));
    for (a, b) in low.iter().zip(&high) {
        let error = Float::with_val(53, a - b).abs() / Float::with_val(53, b.abs_ref());
        assert!(error < 1e-55, "{error}");
    }
}
