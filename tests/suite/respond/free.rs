//! Motions without a force.

use super::{ask, decimals, to_order};
use lindstedt::grid::Axis;
use lindstedt::respond::State;
use lindstedt::verify::Verdict;
use lindstedt::{Oscillator, Refusal, Respond, Status, Stop, Verify, Work};
use rug::Rational;

/// Motions that lock and normal modes against periodic orbits of the equations: amplitudes to O(eps^N), frequencies to one order more.
#[test]
fn free_motions_against_periodic_orbits() {
    let pair = "x'' + x = eps*((1 - x^2)*x' + (y' - x')/5); y'' + (1 + eps/10)*y = eps*((1 - y^2)*y' + (x' - y')/5)";
    let spring = "x'' + x + eps*(x*y + x^3/5); y'' + 4*y + eps*x^2/2";
    // Equal amplitudes by symmetry: only frequencies differ, and their slopes count.
    let turning = "x'' + x + eps*(x^3/5 - y'/2); y'' + y + eps*(y^3/5 + x'/2)";
    for (equation, states) in [(pair, 4), (spring, 3), (turning, 2)] {
        let case = Oscillator::parse(equation).unwrap();
        for order in 1..=3 {
            let small = [20, 40, 80].map(|n| Rational::from((1, n))).to_vec();
            let question = Verify { order, small, samples: 4, ..Verify::default() };
            let found = case.verify(&question, &Work::default()).unwrap().value.steady.unwrap();
            assert_eq!(found.states.len(), states);
            for state in &found.states {
                let slope = state.observed_order;
                // The second unknown alone moves as a linear one: nothing is left to differ.
                let alone = state.amplitudes[0].value == 0.0;
                assert!(
                    alone || (slope.unwrap() - order as f64).abs() < 0.15,
                    "{order}: {state:?}"
                );
                let [a, b] = [1, 2].map(|k| state.table[k].frequency);
                let falls =
                    a.zip(b).is_none_or(|(a, b)| (a.value / b.value).log2() > order as f64 + 0.6);
                assert!(falls && state.table.iter().all(|line| line.orbit), "{order}: {state:?}");
            }
        }
    }
}

/// Orbits that rates of order eps^2 alone tell from their neighbours: what integration leaves of them is no difference.
#[test]
fn noise_of_integration_is_no_difference() {
    let case = Oscillator::parse("x'' + x + eps*(x^3 + y^2); y'' + y + eps*(y^3 + 2*x*y)").unwrap();
    let small = [4000, 8000].map(|n| Rational::from((1, n))).to_vec();
    let question = Verify { order: 2, small, samples: 2, ..Verify::default() };
    let found = case.verify(&question, &Work::default()).unwrap().value.steady.unwrap();
    assert_ne!(found.verdict, Verdict::Disagrees, "{}", found.reason);
}

/// Two oscillators of van der Pol with dampers between them, to order one by hand: with w_j = (a_j/2) e^{i phi_j},
///
///   a_1' = (eps/2) (a_1 - a_1^3/4 + k (a_2 cos phi - a_1)),   phi' = (eps/2) (s - k (a_1/a_2 + a_2/a_1) sin phi),
///
/// so that equal amplitudes have a^2 = 4 (1 - k (1 - cos phi)), sin phi = s/(2 k): in step and in opposition without detuning,
/// none beyond |s| = 2 k, where a^2 = 4 (1 - k). Others have a_1^2 + a_2^2 = 4 (1 - k) at s = 0, phi = pi and a_1 a_2 = 4 k.
#[test]
fn two_self_excited_unknowns_lock() {
    let pair = "x'' + x = eps*((1 - x^2)*x' + k*(y' - x')); y'' + (1 + eps*s)*y = eps*((1 - y^2)*y' + k*(x' - y'))";
    let found = ask(pair, &[("eps", "1/10"), ("k", "1/5"), ("s", "0")], &to_order(1));
    let states = &found.states[0];
    assert!(states.count_proved && found.complete && states.count == 5);
    let mut squares: Vec<_> = states.list.iter().map(|it| decimals(&it.amplitudes)).collect();
    squares.iter_mut().flatten().for_each(|a| *a *= *a);
    let known = [[4.0, 4.0], [2.4, 2.4], [0.0, 0.0]];
    for pair in known {
        assert!(
            squares.iter().any(|it| (it[0] - pair[0]).hypot(it[1] - pair[1]) < 1e-9),
            "{squares:?}"
        );
    }
    let uneven =
        |it: &&Vec<f64>| (it[0] * it[1] - 0.64).abs() < 1e-9 && (it[0] + it[1] - 3.2).abs() < 1e-9;
    assert_eq!(squares.iter().filter(uneven).count(), 2, "{squares:?}");
    // Trace of the linear flow without the exponent 0: eps (1 - a^2/2 - k) for each unknown.
    for state in states.list.iter().filter(|it| it.frequency.is_some()) {
        let sum: f64 = state.exponents.iter().map(|[re, _]| re.value).sum();
        let squares: f64 = decimals(&state.amplitudes).iter().map(|a| a * a).sum();
        assert!((sum - 0.1 * (1.6 - squares / 2.0)).abs() < 1e-9 && state.exponents.len() == 3);
        assert_eq!(state.stable, Some((squares - 8.0).abs() < 1e-9));
    }
    let question = Respond { sweep: Some(Axis::parse("s=-1..1:60").unwrap()), ..to_order(1) };
    let found = ask(pair, &[("eps", "1/10"), ("k", "1/4")], &question);
    let mut folds: Vec<f64> =
        found.folds.iter().map(|it| decimals(std::slice::from_ref(&it.value))[0]).collect();
    folds.sort_by(f64::total_cmp);
    assert!(folds.len() == 2 && (folds[0] + 0.5).abs() < 1e-9 && (folds[1] - 0.5).abs() < 1e-9);
    assert_eq!(found.folds[0].value.status, Status::Proved);
    assert_eq!(found.branches.iter().filter(|branch| branch.closed).count(), 1);
}

/// Where the second unknown nearly moves alone at twice the frequency, w_2 > 0 leaves w_1 its sign: w_1 and -w_1 are one motion, half a period
/// apart. Before a mode is born of the other one there are four, beyond three.
#[test]
fn motions_half_a_period_apart_are_one() {
    let spring = "x'' + x + eps*(x*y + x^3); y'' + 4*y + eps*(x^2/2 + y)";
    for (amplitude, count) in [("99/100", 4), ("101/100", 3)] {
        let states = ask(spring, &[("eps", "1/10"), ("amplitude", amplitude)], &to_order(2));
        assert_eq!((states.states[0].count, states.states[0].count_proved), (count, true));
    }
}

/// The potential of Henon and Heiles has eight normal modes at low energy (Churchill, Pecelli and Rod 1979): to order two those
/// in a plane are a circle, from order four on three pass through the saddles' directions and three do not, and two turn.
#[test]
fn eight_normal_modes() {
    let wells = "x'' + x + 2*eps*x*y; y'' + y + eps*(x^2 - y^2)";
    let values = [("eps", "1/10"), ("amplitude", "1")];
    let states = ask(wells, &values, &to_order(4)).states.remove(0);
    assert!(states.count_proved && states.count == 8);
    let unstable = states.list.iter().filter(|it| it.stable == Some(false)).count();
    assert_eq!((unstable, states.list.iter().filter(|it| it.stable.is_none()).count()), (3, 5));
    let turning: Vec<_> = states
        .list
        .iter()
        .filter(|it| {
            let phases: Vec<f64> =
                it.phases.iter().flatten().map(|p| p.decimal.parse().unwrap()).collect();
            phases.iter().any(|p: &f64| (p.abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-9)
        })
        .collect();
    assert_eq!(turning.len(), 2);
    // K_4 = (1/48) (-5 R^4 + 28 L^2), eps^2 K_4 by the action R^2/2, L = R^2/2 of the turning ones, R^2 = 1:
    // nu = 1 + eps^2 (-5 + 7)/12; in the plane 1 - eps^2 5/12.
    for state in &states.list {
        let known =
            if turning.iter().any(|it| std::ptr::eq(*it, state)) { 1.0 / 6.0 } else { -5.0 / 12.0 };
        let rate = (state.frequency.unwrap().value - 1.0) / 0.01;
        assert!((rate - known).abs() < 5e-3, "{rate} {known}");
    }
    let remarks = "energy is conserved";
    let refused = Oscillator::parse(wells).unwrap().set("eps", "1/10").unwrap();
    let refused = refused.respond(&Respond::default(), &Work::default()).unwrap_err();
    assert!(refused.to_string().contains(remarks) && refused.hint().contains("--sweep amplitude"));
}

/// Families of other energies than masses in a potential have. In an isotropic one with gyroscopic terms motions on circles have
/// omega^2 +- 2 eps omega = 1 + eps a^2. Where the second unknown has a negative energy, motions have to order one
/// 3/4 (a_1^2 - a_2^2) = -(r + 1/r), r = +-a_2/a_1; on a_1 = a_2, where the energy is zero, amplitudes grow, and there is none.
#[test]
fn families_of_other_energies() {
    let circles = "x'' + x + eps*(x*(x^2 + y^2) - 2*y'); y'' + y + eps*(y*(x^2 + y^2) + 2*x')";
    let values = [("eps", "1/100"), ("amplitude", "1")];
    let mut states = ask(circles, &values, &to_order(4)).states.remove(0);
    assert!(states.count_proved && states.count == 2);
    let rate = |state: &State| state.frequency.unwrap().value;
    states.list.sort_by(|one, other| rate(one).total_cmp(&rate(other)));
    for (state, sign) in states.list.iter().zip([1.0, -1.0]) {
        let omega = -sign * 0.01 + f64::sqrt(1e-4 + 1.0 + 0.005);
        let found = state.frequency.unwrap().value;
        assert!((found - omega).abs() < 1e-9, "{found} {omega}");
        let [a, b] = decimals(&state.amplitudes)[..] else { panic!("two") };
        assert!((a * a - 0.5).abs() < 1e-9 && (b * b - 0.5).abs() < 1e-9);
    }
    let indefinite = "x'' + x + eps*(x^3 + y); y'' + y + eps*(-x + y^3)";
    for (amplitude, count) in [("1", 0), ("3", 4)] {
        let values = [("eps", "1/10"), ("amplitude", amplitude)];
        let states = ask(indefinite, &values, &to_order(1)).states.remove(0);
        assert!(states.count_proved && states.count == count, "{states:?}");
        for state in &states.list {
            let [a, b] = decimals(&state.amplitudes)[..] else { panic!("two") };
            let off = 0.75 * (a * a - b * b);
            let sum = b / a + a / b;
            assert!((off.abs() - sum).abs() < 1e-9 && (a * a + b * b - 9.0).abs() < 1e-9);
        }
    }
    let reversible = Oscillator::parse("x'' + x + eps*(x*x'^2 + 2*y); y'' + y + eps*(2*x + y^3)");
    let refused = reversible.unwrap().set("eps", "1/10").unwrap();
    let refused = refused.respond(&to_order(1), &Work::default()).unwrap_err();
    assert!(refused.to_string().contains("no energy is known"), "{refused}");
    // A form that damping of order two does not keep makes no families.
    let damped = "x'' + x + 2*eps*x*y + eps^2*x'; y'' + 4*y + eps*x^2 + eps^2*y'";
    let damped = Oscillator::parse(damped).unwrap().set("eps", "1/10").unwrap();
    let refused = damped.respond(&to_order(2), &Work::default()).unwrap_err();
    assert!(refused.to_string().contains("no bound"), "{refused}");
    // Products of velocities: the modes are chosen without, where these do not vary.
    let products = "x'' + x + eps*((1 + 2*k^2)*x^3 - k*y^3); y'' + y + eps*(y^3 - k*x^3)";
    let states = ask(products, &[("k", "1"), ("eps", "1/10"), ("amplitude", "1")], &to_order(1));
    assert!(states.states[0].count_proved && states.states[0].count > 0);
    let products = Oscillator::parse(products).unwrap().set("eps", "1/10").unwrap();
    let products = products.set("amplitude", "1").unwrap();
    let sweep = Some(Axis::parse("k=1..2:3").unwrap());
    let question = Respond { sweep, ..to_order(1) };
    let refused = products.respond(&question, &Work::default()).unwrap_err();
    assert!(refused.to_string().contains("products of velocities"), "{refused}");
}

/// Motions are born of rest where its exponents pass zero. Of two oscillators of van der Pol with dampers k between them these are to
/// order one (1 - k)/2 +- sqrt(k^2/4 - s^2/16), so that at k = 3/2 motion dies at s^2 = 8, and without detuning, p in the place of 1,
/// it begins at p = 0 in step and at p = 2 k in opposition. None of these is a fold, and no branch is closed.
#[test]
fn motions_are_born_of_rest() {
    let pair = "x'' + x = eps*((p - x^2)*x' + k*(y' - x')); y'' + (1 + eps*s)*y = eps*((p - y^2)*y' + k*(x' - y'))";
    let root = 8.0f64.sqrt();
    let cases = [
        ([("k", "3/2"), ("p", "1")], "s=-7/2..7/2:3", [-root, root], 2),
        ([("k", "1/4"), ("s", "0")], "p=-1..1:3", [0.0, 0.5], 4),
    ];
    for (values, sweep, known, branches) in cases {
        let question = Respond { sweep: Some(Axis::parse(sweep).unwrap()), ..to_order(1) };
        let found = ask(pair, &[&values[..], &[("eps", "1/10")]].concat(), &question);
        let mut born: Vec<f64> =
            found.hopf.iter().map(|it| decimals(std::slice::from_ref(&it.value))[0]).collect();
        born.sort_by(f64::total_cmp);
        let near = born.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(born.len() == 2 && near && found.folds.is_empty(), "{sweep}: {born:?}");
        assert!(found.branches.len() == branches && found.branches.iter().all(|it| !it.closed));
    }
}

/// Of two equal springs modes of unequal amplitudes are born of those of equal ones in a pitchfork: to order one they have
/// a_1 a_2 = 4 |k|/3, and a_1^2 + a_2^2 = A^2 = 1 allows |k| <= 3/8. There are no folds.
#[test]
fn a_pitchfork_of_modes_is_no_fold() {
    let springs = "x'' + x + eps*(x^3 + k*(x - y)); y'' + y + eps*(k*(y - x) + y^3)";
    let without_folds = |sweep: &str, order: usize| {
        let sweep =
            Respond::read_sweep(&Oscillator::parse(springs).unwrap(), sweep, &Stop::default())
                .unwrap();
        let question = Respond { sweep: Some(sweep), ..to_order(order) };
        let found = ask(springs, &[("eps", "1/10"), ("amplitude", "1")], &question);
        assert!(found.folds.is_empty(), "{order}: {:?}", found.folds);
        found
    };
    let found = without_folds("k=-1..1:3", 1);
    // From more values branches are followed that turn beside the pitchfork.
    without_folds("k=-1..1", 2);
    let mut at: Vec<f64> =
        found.crossings.iter().map(|it| decimals(std::slice::from_ref(&it.value))[0]).collect();
    at.sort_by(f64::total_cmp);
    assert!((at[0] + 0.375).abs() < 1e-9 && (at[at.len() - 1] - 0.375).abs() < 1e-9, "{at:?}");
}

/// What changes of the motions of two unknowns, by hand at order one. Modes of one unknown alone, of amplitude 1, meet others where
/// s = -+3/4 (1 - k) or -+(3/4 - k/4); there is no fold. Where the conserved energy lacks an unknown, at m = 0, nothing crosses:
/// with springs m (x - y) and y - x modes only meet at m = -1, and with m x y^2 at m = 1. And rest, a double exponent for all s, is
/// a centre whose real parts are those of rounding; where it is damped by s motions are born once, at s = 0.
#[test]
fn what_changes_is_no_artefact() {
    let crossed = "x'' + (1 + eps*s)*x + eps*(x^3 + x*y^2/4); y'' + y + eps*(x^2*y/4 + y^3)";
    let springs = "x'' + x + eps*m*(x - y); y'' + y + eps*(y - x)";
    let driven = "x'' + x + eps*m*y^2*x; y'' + y + eps*(x^2*y + y^3)";
    let double = "x'' + x + eps*(3*x - 2*y + s*x + x^2*x'); y'' + y + eps*(2*x - y + s*y + y^2*y')";
    let damped =
        "x'' + x + eps*(3*x - 2*y + s*x' + x^2*x'); y'' + y + eps*(2*x - y + s*y' + y^2*y')";
    let family = ("amplitude", "1");
    for (equation, values, sweep, known) in [
        (crossed, &[family][..], "s=-3..3:41", &[-0.6875, -0.5625, 0.5625, 0.6875][..]),
        (springs, &[family], "m=-1/7..1:40", &[]),
        (driven, &[family], "m=-1..1:41", &[1.0]),
        (double, &[], "s=1..2:20", &[]),
        (damped, &[], "s=-1..1:20", &[]),
    ] {
        let question = Respond { sweep: Some(Axis::parse(sweep).unwrap()), ..to_order(1) };
        let found = ask(equation, &[values, &[("eps", "1/10")]].concat(), &question);
        let births = usize::from(equation == damped);
        assert!(found.folds.is_empty() && found.hopf.len() == births, "{sweep}: {:?}", found.hopf);
        let values = found.crossings.iter().map(|it| decimals(std::slice::from_ref(&it.value))[0]);
        let mut at: Vec<f64> = values.collect();
        at.sort_by(f64::total_cmp);
        let near = at.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(at.len() == known.len() && near, "{sweep}: {at:?}");
    }
}

/// Motions proved in boxes that shrink little at first, with the amplitudes of another averaging and Newton's method in doubles;
/// of the third the exponents of rest are those of a matrix with which the QR algorithm alone goes round for ever.
#[test]
fn motions_in_wide_boxes_have_their_digits() {
    let damped =
        "x'' + x + eps*(-3/4*x*y - x'/5 + x^2*x' + y'); y'' + y + eps*(y'/5 + y^2*y' - x/2)";
    let springs = "x'' + x + eps*(6*x^3 - 4*x*y^2 + 3*x*y - 3*y/4); y'' + y + eps*(-4*x^2*y + 3*x^2/2 - 3*x/4 + 8*y^3)";
    let rotating = "x'' + x + eps*(-(1 - x^2)*x' + y + y'/3); y'' + y + eps*((1/5 + y^2)*y' - x/2)";
    let half = ("amplitude", "1/2");
    for (equation, values, order, known) in [
        (damped, &[("eps", "1/20")][..], 2, [1.650452, 1.135380]),
        (springs, &[("eps", "1/20"), half][..], 2, [0.363218, 0.343617]),
        (rotating, &[("eps", "1/10")][..], 1, [2.556326, 1.562108]),
    ] {
        let found = ask(equation, values, &to_order(order));
        let states = &found.states[0];
        assert!(states.count_proved && states.count == 2, "{equation}");
        let near = |it: &&Vec<f64>| {
            it.iter().zip(known).all(|(a, known): (&f64, f64)| (a - known).abs() < 1e-6)
        };
        let shown: Vec<_> = states.list.iter().map(|it| decimals(&it.amplitudes)).collect();
        assert_eq!(shown.iter().filter(near).count(), 1, "{shown:?}");
    }
}

/// The amplitude is that of families, or a parameter of the equations, and never both.
#[test]
fn an_amplitude_without_a_family_is_refused() {
    let locked =
        "x'' + x + eps*((x^2 - 1)*x' + (x - y)/4); y'' + y + eps*((y^2 - 1)*y' + (y - x)/4)";
    let taken = "x'' + x + eps*(amplitude*x^3 + (x - y)/4); y'' + y + eps*(y^3 + (y - x)/4)";
    for (equation, code) in [(locked, "parameter"), (taken, "symbol-taken")] {
        let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
        let case = case.set("amplitude", "2").unwrap();
        assert_eq!(case.respond(&to_order(1), &Work::default()).unwrap_err().code(), code);
    }
}
