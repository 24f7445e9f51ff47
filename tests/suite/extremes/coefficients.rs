//! The coefficients of the power law: exact, by collocation, in doubles, by Fourier series.

use super::support::{Grid, rational, set};
use lindstedt::unstable::algebra::Ring;
use lindstedt::unstable::coeff::floats::Floats;
use lindstedt::unstable::derivation::numeric::{Tier, derive as derive_numbers};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::phase::lobachevsky_function::means;
use lindstedt::unstable::series::Series;
use lindstedt::{
    Route, unstable::derivation::Settings, unstable::derivation::derive, unstable::problems,
};
use rug::{Float, Rational};

/// omega^p of x'' + x (x^2)^delta = 0 at amplitude 1: (1 + delta)^(p/2) M(u)^(-p),
/// M(u) = sum mu_m u^m = Gamma function, u = delta/(1 + delta).
fn truth_at_one(power: i32, moments: &Series<Float>, bits: u32) -> Series<Float> {
    let (reals, order) = (Floats::new(bits), moments.coefficients.len() - 1);
    let of_u = moments.power(&reals, &Rational::from(-power)).unwrap().coefficients;
    let mut series = vec![reals.zero(); order + 1];
    for (j, y) in of_u.iter().enumerate() {
        // binomial(p/2 - j, k), k = 0, 1, ...
        let mut binomial = Rational::from(1);
        for (k, slot) in series.iter_mut().skip(j).enumerate() {
            *slot += Float::with_val(bits, y * &binomial);
            let top = Rational::from((power, 2)) - Rational::from(j + k);
            binomial *= top / Rational::from(k + 1);
        }
    }
    Series::truncated(series)
}

/// M.
fn moments(order: usize, bits: u32) -> Series<Float> {
    let moments = means(order, Balls::new(bits));
    Series::truncated(moments.iter().map(|mu| mu.midpoint().clone()).collect())
}

/// Times a^(p delta).
fn truth(power: i32, at_one: &Series<Float>, amplitude: &str, bits: u32) -> Vec<Float> {
    let (reals, order) = (Floats::new(bits), at_one.coefficients.len() - 1);
    let rate = Float::with_val(bits, rational(amplitude)).ln() * power;
    let mut factor = vec![reals.one()];
    for n in 1..=order {
        let next = Float::with_val(bits, &factor[n - 1] * &rate) / n as u32;
        factor.push(next);
    }
    at_one.mul(&reals, &Series::truncated(factor), order).coefficients
}

const AMPLITUDES: [&str; 3] = ["1", "1e-300", "1e300"];

fn exact_grid(orders: &[(usize, Route)], digits: &[usize]) -> Grid {
    let mut grid = Grid::default();
    for amplitude in AMPLITUDES {
        for &(order, route) in orders {
            let label = format!("order {order} a = {amplitude} {route:?}");
            let settings = Settings {
                order,
                route,
                parameters: set(&[("amplitude", amplitude)]),
                ..Settings::default()
            };
            grid.cell(&label, |grid| {
                let result =
                    match derive(&problems::find("power-law").unwrap(), &settings, &mut |_| true) {
                        Ok(result) => result,
                        Err(error) => return grid.refused(&error),
                    };
                for &digits in digits {
                    let bits = (digits as f64 * 3.4) as u32 + 300 + 80 * order as u32;
                    let moments = moments(order, bits);
                    for (series, power) in result.series.iter().zip([2, 1, -1]) {
                        let truth =
                            truth(power, &truth_at_one(power, &moments, bits), amplitude, bits);
                        for (n, truth) in truth.iter().enumerate() {
                            let label = format!("{label} {} {n} digits {digits}", series.quantity);
                            match result.number(series.quantity, n, digits) {
                                Ok(found) => grid.number(
                                    &label,
                                    &found,
                                    truth,
                                    bits - 40 * order as u32 - 100,
                                ),
                                Err(error) => grid.refused(&error),
                            }
                        }
                    }
                }
            });
        }
    }
    grid
}

fn numeric_grid(orders: &[usize], tiers: &[Tier]) -> Grid {
    let mut grid = Grid::default();
    for &order in orders {
        let bits = 2_000 + 60 * order as u32;
        let moments = moments(order, bits);
        let at_one = [2, 1, -1].map(|power| (power, truth_at_one(power, &moments, bits)));
        for amplitude in AMPLITUDES {
            let truths: Vec<_> =
                at_one.iter().map(|(power, one)| truth(*power, one, amplitude, bits)).collect();
            for &tier in tiers {
                let label = format!("order {order} a = {amplitude} {tier:?}");
                let settings = Settings {
                    order,
                    parameters: set(&[("amplitude", amplitude)]),
                    ..Settings::default()
                };
                grid.cell(&label, |grid| {
                    let problem = problems::find("power-law").unwrap();
                    let result = match derive_numbers(&problem, &settings, tier, &mut |_| true) {
                        Ok(result) => result,
                        Err(error) => return grid.refused(&error),
                    };
                    for (series, truth) in result.series.iter().zip(&truths) {
                        assert_eq!(series.coefficients.len(), truth.len());
                        for (n, ((value, error), truth)) in
                            series.coefficients.iter().zip(truth).enumerate()
                        {
                            let label = format!("{label} {} {n}", series.quantity);
                            grid.estimated(&label, value, error, truth, 1_500);
                        }
                    }
                });
            }
        }
    }
    grid
}

#[test]
fn exact_coefficients() {
    use Route::{Driver, EnergyIntegral};
    let orders = [
        (0, Driver),
        (1, Driver),
        (2, Driver),
        (5, Driver),
        (0, EnergyIntegral),
        (7, EnergyIntegral),
        (100, Driver),
        (200, EnergyIntegral),
    ];
    exact_grid(&orders, &[1, 16, 300]).finish("exact coefficients", 2);
}

#[test]
fn numeric_coefficients() {
    let tiers = [
        Tier::Doubles,
        Tier::Fourier { harmonics: 0 },
        Tier::Fourier { harmonics: 40 },
        Tier::Collocation { digits: 0 },
        Tier::Collocation { digits: 30 },
    ];
    numeric_grid(&[0, 1, 2, 20], &tiers).finish("numeric coefficients", 18);
    // Both grids round a coefficient to the same double: 1e10 for 1e-14 at order 138.
    numeric_grid(&[150], &[Tier::Doubles]).finish("numeric coefficients without a digit", 51);
}

#[test]
#[ignore = "minutes"]
fn every_coefficient() {
    use Route::{Driver, EnergyIntegral};
    let orders = [(10, Driver), (20, EnergyIntegral), (30, EnergyIntegral), (100, EnergyIntegral)];
    exact_grid(&orders, &[1, 3, 16, 20, 30, 300, 3_000]).finish("exact coefficients", 70);
    let tiers = [
        Tier::Doubles,
        Tier::Fourier { harmonics: 300 },
        Tier::Collocation { digits: 1 },
        Tier::Collocation { digits: 20 },
        Tier::Collocation { digits: 100 },
    ];
    numeric_grid(&[5, 50, 100, 200], &tiers).finish("numeric coefficients", 70);
    numeric_grid(&[0, 1, 2, 10], &[Tier::Collocation { digits: 300 }])
        .finish("numeric coefficients, 300 digits", 70);
}
