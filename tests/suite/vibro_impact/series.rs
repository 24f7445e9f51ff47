//! The driver's averaged rates against the recursion for the characteristic root, and the partial
//! sums against the root itself.

use lindstedt::unstable::derivation::averaging::{
    Averaging, AveragingSettings, Coefficient, RateTerm, average,
};
use lindstedt::{Exact, unstable::problems};
use lindstedt_impact::flow::{characteristic_root, rates};
use lindstedt_impact::parameters::{Branch, ExactParameters};
use lindstedt_number::real::Certified;
use lindstedt_tests::Random;
use rug::{Float, Rational};
use std::collections::BTreeMap;

const BITS: u32 = 400;

/// alpha, omega, c, A, B and k; P0 = 1 and the impact do not matter for the flight.
struct Case {
    values: [Rational; 5],
    periods: u32,
}

impl Case {
    fn random(random: &mut Random) -> Self {
        let mut values = [(400, 2000), (300, 4000), (0, 300), (-300, 300), (-300, 300)]
            .map(|(low, high)| random.thousandths(low, high));
        // No resonance with the force.
        values[1] += Rational::from((1, 7919));
        Self { values, periods: 1 + (random.0 % 3) as u32 }
    }

    fn averaged(&self, order: usize, digits: usize) -> Averaging {
        let names = ["alpha", "omega", "c", "A", "B"];
        let mut parameters: BTreeMap<String, Exact> = BTreeMap::new();
        for (name, value) in names.iter().zip(&self.values) {
            parameters.insert((*name).to_owned(), Exact::Rational(value.clone()));
        }
        parameters.insert("k".to_owned(), Exact::Rational(self.periods.into()));
        parameters.insert("P0".to_owned(), Exact::Rational(1.into()));
        let settings =
            AveragingSettings { order, parameters, digits, ..AveragingSettings::default() };
        average(&problems::vibro_impact::problem(), &settings, &mut |_| true).unwrap()
    }

    /// With the loop and the damping scaled by eps.
    fn scaled(&self, eps: &Rational) -> ExactParameters {
        let [alpha, omega, c, a, b] = self.values.clone().map(Exact::Rational);
        let scale = |x: Exact| match x {
            Exact::Rational(q) => Exact::Rational(q * eps),
            other => other,
        };
        ExactParameters {
            alpha,
            omega,
            periods: self.periods,
            restitution: Rational::from((4, 5)).into(),
            wall: Rational::new().into(),
            damping: scale(c),
            force: Rational::from(1).into(),
            displacement_gain: scale(a),
            velocity_gain: scale(b),
            branch: Branch::Plus,
        }
    }
}

/// The decimals of A_n/a and B_n; a rate that vanishes has no terms.
fn number(rates: &[RateTerm]) -> Float {
    match rates {
        [] => Float::with_val(BITS, 0),
        [term] => {
            let Coefficient::Number(number) = &term.coefficient else { panic!("a number") };
            Float::with_val(BITS, Float::parse(&number.decimal).unwrap())
        }
        more => panic!("one term, not {more:?}"),
    }
}

fn middle(x: &Certified) -> Float {
    Float::with_val(BITS, x.ball().midpoint())
}

/// Orders 0 to 30 of 12 random loops, to all digits asked for; two routes without common code: the
/// phase algebra with delays, and Newton's recursion for lambda^2 + alpha^2 = eps g(lambda).
#[test]
fn rates_of_the_driver_are_the_series_of_the_root() {
    let (order, digits) = (30, 40);
    let mut random = Random(20_260);
    for trial in 0..12 {
        let case = Case::random(&mut random);
        let found = case.averaged(order, digits);
        assert!(found.is_linear() && !found.exact && found.checked_orders == order);
        let series = rates(&case.scaled(&Rational::from(1)).certified(BITS), order).terms;
        for (n, term) in series.iter().enumerate() {
            let rate = found.amplitude_rate.get(n).map_or(&[][..], Vec::as_slice);
            let parts = [(rate, &term.re), (&found.phase_rate[n], &term.im)];
            for (part, (rate, reference)) in parts.into_iter().enumerate() {
                let (found, reference) = (number(rate), middle(reference));
                let error = Float::with_val(53, &found - &reference).abs();
                let size = Float::with_val(53, reference.abs_ref());
                // Half a unit of the last digit printed.
                let bound = size * 10f64.powi(1 - digits as i32);
                assert!(error <= bound, "case {trial} {:?} order {n} part {part}", case.values);
            }
        }
    }
}

/// |sum_(j <= n) lambda_j eps^j - lambda(eps)| falls as eps^(n+1).
#[test]
fn partial_sums_approach_the_root_with_their_order() {
    let mut random = Random(3);
    for trial in 0..4 {
        let case = Case::random(&mut random);
        let found = case.averaged(6, 60);
        let error = |n: usize, eps: &Rational| -> f64 {
            let root = characteristic_root(&case.scaled(eps).certified(BITS)).unwrap();
            let mut power = Rational::from(1);
            let (mut re, mut im) = (-middle(&root.growth_rate), -middle(&root.frequency));
            for order in 0..=n {
                let rate = found.amplitude_rate.get(order).map_or(&[][..], Vec::as_slice);
                re += number(rate) * &power;
                im += number(&found.phase_rate[order]) * &power;
                power *= eps;
            }
            re.hypot(&im).to_f64()
        };
        let steps = [10, 11, 12].map(|n| Rational::from((1, 1u32 << n)));
        for n in 1..=6 {
            let errors = steps.clone().map(|eps| error(n, &eps).log2());
            for pair in errors.windows(2) {
                let slope = pair[0] - pair[1];
                println!("case {trial} order {n}: slope {slope:.4}");
                assert!((slope - n as f64 - 1.0).abs() < 0.05, "case {trial} order {n}: {slope}");
            }
        }
    }
}
