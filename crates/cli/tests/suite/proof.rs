//! Proved orbits of whole problems: against closed forms, and all that are expected.

use lindstedt::evaluate::{Language, ProofVerdict, ProvedFamily, ProvedMember, ProvedOrbit, Times};
use lindstedt::grid::Axis;
use lindstedt::motion::{Simulate, Start};
use lindstedt::{Error, Evaluate, Exact, Number, Oscillator, Refusal, Standing, Work};
use rug::Rational;

fn case(equation: &str, values: &[(&str, &str)]) -> Oscillator {
    let parse = |text: &str| match text.contains('=') {
        true => Oscillator::parse(text),
        false => Oscillator::builtin(text),
    };
    let bare = parse(equation).unwrap();
    values.iter().fold(bare, |case, (name, value)| case.set(name, value).unwrap())
}

fn proved(equation: &str, values: &[(&str, &str)]) -> Result<ProvedOrbit, Error> {
    Ok(case(equation, values).prove(&Evaluate::default(), &Work::default())?.value)
}

/// A printed decimal, exactly.
fn decimal(text: &str) -> Rational {
    Exact::parse(text).unwrap().as_rational().unwrap().clone()
}

fn middle(number: &Option<Number>) -> Rational {
    decimal(&number.as_ref().unwrap().decimal)
}

fn error(number: &Option<Number>) -> Rational {
    number.as_ref().unwrap().error.as_deref().map_or(Rational::new(), decimal)
}

/// 4 K(sin(a/2)) lies in the ball, which has 28 digits at least; the largest x is a.
#[test]
fn pendulums_contain_their_closed_form() {
    for a in ["1", "3", "157/50"] {
        let values = [("amplitude", a)];
        let orbit = proved("pendulum", &values).unwrap();
        let closed = case("pendulum", &values);
        let closed = closed.evaluate(&Evaluate::default(), &Work::default()).unwrap().value;
        let period = middle(&orbit.period);
        let distance = (middle(&closed.exact_period) - &period).abs();
        // Both are rounded to 30 digits.
        let rounding = period.clone() / decimal("1e29");
        assert!(distance <= error(&orbit.period) + rounding, "{a}: {:?}", orbit.period);
        assert!(error(&orbit.period) < period / decimal("1e28"), "{a}");
        let a: Rational = a.parse().unwrap();
        assert!((middle(&orbit.maximum) - &a).abs() <= error(&orbit.maximum), "{a}");
        assert!((middle(&orbit.minimum) + &a).abs() <= error(&orbit.minimum), "{a}");
    }
}

/// x'' + 2 sin(x/3) = 0 is the pendulum of z = x/3 with the stiffness 2/3.
#[test]
fn a_sine_is_recognised_in_the_equation() {
    let scaled = proved("x'' + 2*sin(x/3) = 0", &[("amplitude", "3")]).unwrap();
    let plain = proved("pendulum", &[]).unwrap();
    let squares = middle(&scaled.period).square() / middle(&plain.period).square();
    assert!((squares - Rational::from((3, 2))).abs() < decimal("1e-27"));
    let sum = proved("x'' + x + eps*(sin(x) - x) = 0", &[("eps", "1")]).unwrap();
    assert_eq!(sum.period.unwrap().decimal, plain.period.unwrap().decimal);
    // No multiple of x stands alone: by functions in the algebra. 4 int dx/x' by 400 midpoints in doubles.
    let mixed = proved("x'' + sin(x) + x = 0", &[("amplitude", "1")]).unwrap();
    assert!((middle(&mixed.period) - decimal("4.5827295537238")).abs() < decimal("1e-12"));
    for (equation, values) in [
        ("x'' + abs(x)*sin(x) = 0", [("amplitude", "1")]),
        ("x'' + sin(x) = 0", [("amplitude", "4")]),
        ("pendulum", [("delta", "1/2")]),
    ] {
        let refused = proved(equation, &values).unwrap_err();
        assert_eq!(refused.code(), "no-proof", "{equation}: {refused}");
    }
}

fn largest(orbit: &ProvedOrbit) -> f64 {
    middle(&orbit.maximum).to_f64()
}

fn all(orbit: ProvedOrbit) -> Vec<ProvedOrbit> {
    let mut list = vec![orbit];
    let further = std::mem::take(&mut list[0].further);
    list.extend(further);
    assert!(list.iter().all(|o| matches!(o.proof, ProofVerdict::Proved { .. })));
    list
}

/// The two stable responses and the one between them, and the responses in both wells and over the hill.
#[test]
fn responses_to_a_force_are_proved_with_every_parameter_set() {
    let duffing = "x'' + d*x' + x + x^3/2 - F*cos(13/10*t) = 0";
    let three = all(proved(duffing, &[("d", "1/10"), ("F", "3/10")]).unwrap());
    let sizes: Vec<f64> = three.iter().map(largest).collect();
    // Amplitudes by the balance of one harmonic: 0.49, 1.09, 1.49.
    let near = [0.489_414, 1.096_356, 1.516_913];
    assert!(sizes.iter().zip(near).all(|(a, b)| (a - b).abs() < 1e-6), "{sizes:?}");
    assert_eq!(sizes.len(), 3);
    for orbit in &three {
        // Liouville: e^(-d T), T = 20 pi/13.
        let product = middle(&orbit.multiplier_product).to_f64();
        assert!((product - (-2.0 * std::f64::consts::PI / 13.0).exp()).abs() < 1e-14);
        assert!((middle(&orbit.exponent_sum).to_f64() + 0.1).abs() < 1e-15);
        assert!(orbit.stable.is_none() && orbit.floquet_exponent.is_empty());
    }
    let wells = all(proved("x'' - x + x^3 + x'/4 - 1/10*cos(t) = 0", &[]).unwrap());
    let sizes: Vec<f64> = wells.iter().map(largest).collect();
    assert!(sizes.len() == 3 && sizes[0] < 0.1 && sizes[1] < -0.9 && sizes[2] > 1.0, "{sizes:?}");
}

/// A small parameter is not needed; of two limit cycles both are there, one of them unstable.
#[test]
fn limit_cycles_are_proved_without_a_small_parameter() {
    let one = proved("x'' + x + (x^2 - 1)*x' = 0", &[]).unwrap();
    assert!(one.period.unwrap().decimal.starts_with("6.663286859323130189699682"));
    assert!(one.further.is_empty());
    let two = "x'' + x + eps*(x^2 - 1)*x'*(1 - x^2/25) = 0";
    let two = all(proved(two, &[("eps", "1/10")]).unwrap());
    let stable: Vec<Option<bool>> = two.iter().map(|orbit| orbit.stable).collect();
    assert_eq!(stable, [Some(true), Some(false)]);
    // The averaged amplitudes are sqrt(26 -+ sqrt(476)), 2.045 and 6.916 (rounded).
    assert!((largest(&two[0]) - 2.045).abs() < 0.01 && (largest(&two[1]) - 6.916).abs() < 0.1);
}

/// Motions about x = 1 of x'' - x + x^3 = 0, from their least x or their largest: x = b dn(b t/sqrt 2 | m),
/// m = 2 - 2/b^2, b the largest x, over one period 2 sqrt(2) K(m)/b and no multiple of it; and of a stiff cycle.
#[test]
fn one_period_from_either_turning_point() {
    for (amplitude, period) in [
        ("1/1000", 17.281_252_191_234_7),
        ("1/5", 6.756_369_163_739_06),
        ("7/5", 6.756_369_163_739_06),
        ("2/5", 5.513_202_967_014_558),
        ("1/2", 5.156_165_363_816_425),
        ("1001/1000", 4.442_886_273_660_869),
    ] {
        let found = proved("x'' - x + x^3 = 0", &[("amplitude", amplitude)]).unwrap();
        let gap = middle(&found.period).to_f64() - period;
        assert!(gap.abs() < 1e-12, "{amplitude} {gap}");
    }
    let stiff = proved("x'' + x - 8*(1 - x^2)*x' = 0", &[]).unwrap();
    assert!((middle(&stiff.period).to_f64() - 16.038_176_232_180_5).abs() < 1e-11);
}

fn family(equation: &str, values: &[(&str, &str)], sweep: &str) -> (ProvedFamily, Standing) {
    let axis = Axis::parse(sweep).unwrap();
    let work = Work { digits: 12, ..Work::default() };
    let found = case(equation, values).prove_sweep(&Evaluate::default(), axis, &work).unwrap();
    (found.value, found.standing)
}

/// The backbone of a hardening spring: every amplitude between two of its points has an orbit.
#[test]
fn a_backbone_is_proved_without_gaps() {
    let (found, standing) = family("duffing", &[("eps", "1")], "amplitude=1..6/5:3");
    assert_eq!((found.branches.len(), standing), (1, Standing::Complete));
    let points = &found.branches[0].points;
    let frequencies: Vec<f64> =
        points.iter().map(|p| middle(&p.orbit.frequency).to_f64()).collect();
    assert!(frequencies.len() == 3 && frequencies.is_sorted(), "{frequencies:?}");
    assert!(points[..2].iter().all(|p| p.between.as_ref().is_some_and(|b| b.proved)));
    // At a point between.
    let between = proved("duffing", &[("eps", "1"), ("amplitude", "21/20")]).unwrap();
    let hull = points[0].between.as_ref().unwrap().frequency.clone();
    let distance = (middle(&hull) - middle(&between.frequency)).abs();
    assert!(distance <= error(&hull), "{hull:?}");
}

/// Beyond an equilibrium, of which nothing is proved, and beyond a separatrix the families begin anew; two cycles far
/// apart are two branches.
#[test]
fn families_begin_again_and_keep_apart() {
    let last = |equation: &str, axis: &str, wanted: Standing| {
        let (found, standing) = family(equation, &[], axis);
        assert_eq!(standing, wanted, "{equation}");
        let ends = found.branches.iter().filter_map(|branch| branch.points.last().cloned());
        let of = |p: ProvedMember| (p.value.to_string(), middle(&p.orbit.period).to_f64());
        ends.map(of).collect::<Vec<_>>()
    };
    let within = last("x'' - x + x^3 = 0", "amplitude=3/4..3/2:4", Standing::Undecided);
    // By quadrature.
    for (value, period) in [("3/4", 4.621598), ("5/4", 4.765217), ("3/2", 9.223663)] {
        let same = |(at, found): &&(String, f64)| at == value && (found - period).abs() < 1e-5;
        assert!(within.iter().any(|found| same(&found)), "{value}: {within:?}");
    }
    let cycles = last("x'' + x + (x^2-1)*(x^2-mu)*x'/10 = 0", "mu=6..9:2", Standing::Complete);
    let periods: Vec<String> = cycles.iter().map(|(_, period)| format!("{period:.5}")).collect();
    assert_eq!(periods, ["6.51221", "6.65702"], "{cycles:?}");
}

/// x(t) is enclosed: at phase 0 it is what the orbit says, later what the integrator says.
#[test]
fn displacements_of_a_proved_cycle_are_enclosed() {
    let cycle = case("van-der-pol", &[("eps", "1")]);
    let times = Some(Times::parse("0..3:2").unwrap());
    let question = Evaluate { times, ..Evaluate::default() };
    let orbit = cycle.prove(&question, &Work::default()).unwrap().value;
    let [first, last] = &orbit.solution[..] else { panic!("{:?}", orbit.solution) };
    assert_eq!(first.x, orbit.amplitude.unwrap());
    // By Taylor integration from the state at phase 0, as printed.
    let state = [&first.x, &first.velocity].map(|n| Exact::parse(&n.decimal).unwrap());
    let times = Some(Simulate::read_times("3").unwrap());
    let simulated = Simulate {
        start: Start { state: Some(state.to_vec()), ..Start::default() },
        times,
        ..Simulate::default()
    };
    let work = Work { digits: 26, ..Work::default() };
    let moved = cycle.motion(&simulated, &work).unwrap().value.last;
    for (a, b) in [(&last.x, &moved.x), (&last.velocity, &moved.v)] {
        let distance = (decimal(&a.decimal) - decimal(&b.decimal)).abs();
        let allowed = decimal(a.error.as_deref().unwrap()) + decimal("1e-24");
        assert!(distance <= allowed && allowed < decimal("2e-24"), "{a:?} {b:?}");
    }
}

/// Where the sum has few digits, x(t) and the program text are Newton's: at rest the orbit is at its
/// proved maximum.
#[test]
fn the_motion_is_that_of_newtons_orbit() {
    let cycle = case("van-der-pol", &[("eps", "2")]);
    let times = Some(Times::parse("0..1:2").unwrap());
    let question = Evaluate { times, ..Evaluate::default() };
    let work = Work { digits: 20, ..Work::default() };
    let found = cycle.evaluate(&question, &work).unwrap().value.solution.unwrap();
    assert!(found.is_by_newton());
    let largest = proved("van-der-pol", &[("eps", "2")]).unwrap().maximum;
    let rest = found.points[0].value.clone();
    assert!(
        (middle(&rest) - middle(&largest)).abs() <= error(&rest) + decimal("1e-19"),
        "{rest:?}"
    );
    assert!(error(&rest) < decimal("1e-17"));
    let code = cycle.solution_code(&Evaluate::default(), Language::Rust, 40, &work).unwrap();
    let arrays = cycle.periodic_solution(&Evaluate::default(), 40, &work).unwrap();
    assert_eq!([code.header.tier, arrays.header.tier], ["newton"; 2]);
    let code = code.value;
    let at_rest: f64 = code.terms.iter().map(|(_, c, _)| c).sum();
    assert!(
        (at_rest - middle(&largest).to_f64()).abs() <= code.deviation + 1e-13,
        "{}",
        code.deviation
    );
    assert!(code.deviation < 1e-2 && code.code.contains("Newton"));
}

/// A linear congruential generator (Knuth's constants): the same problems everywhere.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// n/20 with -20 < n < 20.
    fn fraction(&mut self) -> Rational {
        Rational::from((self.below(39) as i64 - 19, 20))
    }
}

/// A conservative oscillator with x(0) = 1, or a self-excited one, and its small parameter: 1/2, 1, 3/2 or 2.
fn random(dice: &mut Dice, self_excited: bool) -> (String, String) {
    let [a, b, c] = std::array::from_fn(|_| dice.fraction());
    let small = Rational::from((1 + dice.below(4), 2));
    let equation = match self_excited {
        true => {
            // The averaged amplitude is 2, which the exact expansion needs.
            let (b, c) = (b / 4, c / 4);
            format!("x'' + x + eps*((x^2 + ({a})*x - 1)*x' + ({b})*x^2 + ({c})*x^3) = 0")
        }
        false => {
            let c = Rational::from(c.abs_ref());
            format!("x'' + x + eps*(({a})/2*x^2 + ({b})*x*x'^2 + {c}*x^3) = 0")
        }
    };
    (equation, small.to_string())
}

/// Decimal digits that a number states.
fn digits(number: &Option<Number>) -> f64 {
    let (middle, error) = match number {
        Some(_) => (middle(number), error(number)),
        None => return 0.0,
    };
    (middle.to_f64().abs() / error.to_f64()).log10().max(0.0)
}

/// Equation, digits of the sum, of Newton's method from it, of the proof. No estimate contradicts the proof.
fn row(equation: &str, small: &str) -> (String, [f64; 3]) {
    let oscillator = case(equation, &[("eps", small)]);
    let found = oscillator.evaluate(&Evaluate::default(), &Work::default()).unwrap().value;
    let proved = oscillator.prove(&Evaluate::default(), &Work::default()).unwrap().value;
    let sum = found.improved.as_ref().map_or(found.period.clone(), |how| how.sum.clone());
    if matches!(proved.proof, ProofVerdict::Proved { .. }) {
        for estimate in [&sum, &found.period].into_iter().filter(|number| number.is_some()) {
            let distance = (middle(estimate) - middle(&proved.period)).abs();
            let allowed = error(estimate) + error(&proved.period);
            assert!(distance <= allowed, "{equation}, {small}: {estimate:?} {:?}", proved.period);
        }
    }
    let certain = match proved.proof {
        ProofVerdict::Proved { .. } => digits(&proved.period),
        _ => 0.0,
    };
    (format!("{equation}, eps = {small}"), [digits(&sum), digits(&found.period), certain])
}

/// The rows of the table whose number leaves no rest.
fn rows(each: usize) -> Vec<(String, [f64; 3])> {
    let mut dice = Dice(20);
    let problems: Vec<_> = (0..40).map(|i| random(&mut dice, i % 2 == 1)).collect();
    problems.iter().step_by(each).map(|(equation, small)| row(equation, small)).collect()
}

/// Every ninth of the forty: the sum states a few digits, Newton's method and the proof all.
#[test]
fn random_problems_have_all_digits() {
    for (name, [sum, newton, proved]) in rows(9) {
        assert!(sum < 29.0 && newton >= 28.0 && proved >= 28.0, "{name}: {sum} {newton} {proved}");
    }
}

/// What the book says of all forty; a motion that escapes has no digit at all.
#[test]
#[ignore = "the table of the book, half a minute"]
fn the_table_of_forty() {
    let rows = rows(1);
    for (name, [sum, newton, proved]) in &rows {
        println!("| `{name}` | {sum:.0} | {newton:.0} | {proved:.0} |");
    }
    let (found, escaped): (Vec<_>, Vec<_>) = rows.iter().partition(|(_, all)| all[1] > 0.0);
    assert_eq!((found.len(), escaped.len()), (33, 7));
    assert!(found.iter().all(|(_, [sum, newton, proved])| sum < newton && proved.round() >= 29.0));
    assert!(escaped.iter().all(|(_, all)| *all == [0.0; 3]));
}
