//! Averaged rates of the delay loop against the recursion for the characteristic root.

use super::support::{Grid, rational, set};
use lindstedt::Exact;
use lindstedt::unstable::derivation::averaging::{
    AveragingSettings, Coefficient, RateTerm, average,
};
use lindstedt::unstable::problems;
use lindstedt_impact::flow::rates;
use lindstedt_impact::parameters::{Branch, ExactParameters};
use rug::Float;

fn check(grid: &mut Grid, label: &str, found: &[RateTerm], truth: &Float, bits: u32) {
    match found {
        [] if truth.is_zero() => {}
        [] => grid.defect(label, format!("nothing instead of {truth}")),
        [term] => match &term.coefficient {
            Coefficient::Number(number) => grid.number(label, number, truth, bits),
            other => grid.defect(label, format!("{other:?}")),
        },
        more => grid.defect(label, format!("{more:?}")),
    }
}

fn grid_of(orders: &[usize], digits: &[usize]) -> Grid {
    let mut grid = Grid::default();
    let values = ["1e-300", "1e-10", "1/3", "10", "1e300"];
    let mut sets: Vec<[&str; 5]> = Vec::new();
    let base = ["1", "13/5", "1/20", "2/25", "1/10"];
    for (position, _) in base.iter().enumerate() {
        for value in values {
            let mut set = base;
            set[position] = value;
            sets.push(set);
        }
    }
    sets.push(["1e-300", "1e-300", "1e-300", "1e-300", "1e-300"]);
    sets.push(["1e300", "1e-300", "1e300", "1e-300", "1e300"]);
    for values in sets {
        let [alpha, omega, c, a, b] = values.map(|v| Exact::Rational(rational(v)));
        let exact = ExactParameters {
            alpha,
            omega,
            periods: 2,
            restitution: rational("4/5").into(),
            wall: rational("0").into(),
            damping: c,
            force: rational("1").into(),
            displacement_gain: a,
            velocity_gain: b,
            branch: Branch::Plus,
        };
        let names = ["alpha", "omega", "c", "A", "B"];
        let mut given: Vec<(&str, &str)> = names.iter().copied().zip(values).collect();
        given.extend([("k", "2"), ("P0", "1")]);
        for &order in orders {
            for &digits in digits {
                let label = format!("{values:?} order {order} digits {digits}");
                let settings = AveragingSettings {
                    order,
                    parameters: set(&given),
                    digits,
                    ..AveragingSettings::default()
                };
                grid.cell(&label, |grid| {
                    let problem = problems::vibro_impact::problem();
                    let found = match average(&problem, &settings, &mut |_| true) {
                        Ok(found) => found,
                        Err(error) => return grid.refused(&error),
                    };
                    // The reduction of alpha T modulo 2 pi takes up to 2000 bits, and every order
                    // loses some.
                    let bits = (digits as f64 * 3.4) as u32 + 2_400 * (order as u32 + 1) + 4_000;
                    let truth = rates(&exact.certified(bits), order).terms;
                    assert_eq!(truth.len(), order + 1);
                    for (n, term) in truth.iter().enumerate() {
                        let rate = found.amplitude_rate.get(n).map_or(&[][..], Vec::as_slice);
                        let middle = |x: &lindstedt_number::real::Certified| {
                            Float::with_val(bits, x.ball().midpoint())
                        };
                        if term.re.ball().relative_accuracy_bits() > 60 || term.re.ball().is_exact()
                        {
                            check(grid, &format!("{label} R_{n}"), rate, &middle(&term.re), 50);
                        }
                        if term.im.ball().relative_accuracy_bits() > 60 {
                            check(
                                grid,
                                &format!("{label} B_{n}"),
                                &found.phase_rate[n],
                                &middle(&term.im),
                                50,
                            );
                        }
                    }
                });
            }
        }
    }
    grid
}

#[test]
fn averaged_rates() {
    grid_of(&[0, 1, 4], &[1, 16]).finish("averaged rates", 1);
}

#[test]
#[ignore = "minutes"]
fn every_averaged_rate() {
    grid_of(&[2, 10, 20], &[1, 3, 30, 300]).finish("averaged rates", 70);
}
