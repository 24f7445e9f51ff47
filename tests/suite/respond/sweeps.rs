//! Branches and curves over parameters.

use super::{ask, decimals, to_order};
use lindstedt::grid::Axis;
use lindstedt::respond::{Point, Response, State, States};
use lindstedt::unstable::algebra::Stop;
use lindstedt::{Oscillator, Respond, Status, Work};
use rug::Rational;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The detuning follows from omega; a curve over omega is that over sigma.
#[test]
fn sweeps_of_the_frequency() {
    let question = |text| Respond { sweep: Some(Axis::parse(text).unwrap()), ..to_order(2) };
    let set = [("eps", "1/10")];
    let by_sigma = "x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2";
    let by_sigma = ask(by_sigma, &set, &question("sigma=-1..3:50"));
    let by_omega = "x'' + x + eps*(x'/5 + x^3) = eps*cos(omega*t)/2";
    let by_omega = ask(by_omega, &set, &question("omega=9/10..13/10:50"));
    assert_eq!((by_sigma.folds.len(), by_omega.folds.len()), (2, 2));
    for (a, b) in by_sigma.folds.iter().zip(&by_omega.folds) {
        let [a, b] = [&a.value, &b.value].map(|value| value.decimal.parse::<f64>().unwrap());
        assert!((1.0 + 0.1 * a - b).abs() < 1e-12);
    }
}

/// A frequency is answered alone as in a range: around the resonance of the lowest order that couples the force. At 1/2 the
/// cube couples none, so that a range may pass it.
#[test]
fn one_frequency_and_a_range() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*cos(omega*t)/2";
    let sweep = |text| Respond { sweep: Some(Axis::parse(text).unwrap()), ..to_order(2) };
    for (text, at) in [("omega=1/2..7/5:201", "23/20"), ("omega=23/20,6/5,5/4", "6/5")] {
        let range = ask(equation, &[("eps", "1/10")], &sweep(text));
        let at: Rational = at.parse().unwrap();
        let of = |states: &&States| {
            let value = states.value.as_ref().unwrap().decimal.parse::<f64>().unwrap();
            (value - at.to_f64()).abs() < 1e-9
        };
        let set = [("eps", "1/10"), ("omega", &*at.to_string())];
        let alone = ask(equation, &set, &to_order(2));
        let amplitudes = |states: &States| -> Vec<f64> {
            let first = |state: &State| state.amplitudes[0].decimal.parse().unwrap();
            states.list.iter().map(first).collect()
        };
        let own = amplitudes(&alone.states[0]);
        match range.states.iter().find(of) {
            Some(states) => assert_eq!(amplitudes(states).len(), own.len()),
            // Between two values searched: on the branch.
            None => {
                let near = |a: f64| {
                    let gap = |point: &Point| {
                        (point.value.value - at.to_f64()).hypot(point.amplitudes[0].value - a)
                    };
                    let points = range.branches.iter().flat_map(|branch| &branch.points);
                    points.map(gap).fold(f64::INFINITY, f64::min)
                };
                assert!(own.iter().all(|a| near(*a) < 0.02), "{own:?}");
            }
        }
    }
    let refused = |omega: &str| {
        let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
        let case = case.set("omega", omega).unwrap();
        case.respond(&to_order(2), &Work::default()).unwrap_err().to_string()
    };
    // At resonances of the force where the cube couples nothing, and beside none.
    for omega in ["1/2", "2", "5"] {
        assert!(refused(omega).contains("no resonance couples"), "{omega}");
    }
}

/// Combination resonance of 1 and 2 over the detuning: at the values searched the motions are those of single values, and
/// branches pass them.
#[test]
fn combination_resonance_over_the_detuning() {
    let equation = "x'' + x + eps*(x'/5 + x^3 + 2*y*cos((3 + eps*sigma)*t)); \
                    y'' + 4*y + eps*(y'/5 + y^3 + 2*x*cos((3 + eps*sigma)*t))";
    let sweep = Some(Axis::parse("sigma=-1,1/2,2").unwrap());
    let found = ask(equation, &[("eps", "1/10")], &Respond { sweep, ..to_order(1) });
    for states in &found.states {
        let sigma = states.value.as_ref().unwrap();
        let alone = ask(equation, &[("eps", "1/10"), ("sigma", &sigma.decimal)], &to_order(1));
        let alone = &alone.states[0];
        assert_eq!((states.count, states.count_proved), (alone.count, true), "{sigma}");
        for (state, own) in states.list.iter().zip(&alone.list) {
            let gap = |(a, b): (f64, f64)| (a - b).abs();
            let pairs = decimals(&state.amplitudes).into_iter().zip(decimals(&own.amplitudes));
            assert!(pairs.map(gap).all(|gap| gap < 1e-9), "{sigma}");
            // On a branch.
            let a = decimals(&state.amplitudes);
            let value: f64 = sigma.decimal.parse().unwrap();
            let gap = |point: &Point| {
                let [b, c] = [0, 1].map(|j| point.amplitudes[j].value - a[j]);
                b.hypot(c) + (point.value.value - value).abs()
            };
            let points = found.branches.iter().flat_map(|branch| &branch.points);
            let near = points.map(gap).fold(f64::INFINITY, f64::min);
            assert!(near < 0.15, "{sigma}: {a:?} {near}");
        }
    }
    let moving = found.states.iter().map(|states| states.list.len()).max();
    assert!(moving > Some(1) && found.branches.len() > 1);
    // Rest loses its stability at mu^2 + sigma^2/4 = h^2/(16 nu_1 nu_2); no fold is there.
    let edge = 2.0 * (0.125f64 - 0.01).sqrt();
    let hopf: Vec<f64> = found.hopf.iter().map(|it| it.value.decimal.parse().unwrap()).collect();
    assert!(hopf.len() == 2 && hopf.iter().all(|s| (s.abs() - edge).abs() < 1e-6), "{hopf:?}");
    assert_eq!(found.folds.len(), 0);
}

/// The equation itself, integrated along the frequency, lies on the upper branch upwards and on the lower one downwards.
#[test]
fn what_follows_the_sweep_lies_on_the_branches() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*cos(omega*t)/2";
    let sweep = Some(Axis::parse("omega=21/20,11/10,23/20").unwrap());
    let found = ask(equation, &[("eps", "1/10")], &Respond { sweep, follow: true, ..to_order(4) });
    let [up, down] = found.followed.as_ref().unwrap();
    let known = |states: usize, state: usize| -> f64 {
        found.states[states].list[state].amplitudes[0].decimal.parse().unwrap()
    };
    let read = |list: &[lindstedt::respond::Reading], k: usize| {
        list[k].amplitudes.as_ref().unwrap()[0].value
    };
    assert_eq!(found.states[1].count, 3);
    // 100 periods leave e^(-2 pi) of the way from one value to the next, two thousandths: after a jump they are not enough.
    let pairs =
        [(read(up, 1), known(1, 0)), (read(down, 1), known(1, 2)), (read(down, 2), known(0, 0))];
    for (read, known) in pairs {
        assert!((read - known).abs() < 5e-4, "{read} {known}");
    }
}

/// Upwards the motion falls onto the lower branch between omega = 9/8 and 23/20, and is read when it has come to rest there.
#[test]
fn a_jump_is_followed_to_its_end() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*cos(omega*t)/2";
    let sweep = Some(Axis::parse("omega=1..1.2:9").unwrap());
    let found = ask(equation, &[("eps", "1/10")], &Respond { sweep, follow: true, ..to_order(4) });
    let [up, _] = found.followed.as_ref().unwrap();
    let read = up[6].amplitudes.as_ref().unwrap()[0].value;
    let lowest = found.states[6].list.last().unwrap();
    let known: f64 = lowest.amplitudes[0].decimal.parse().unwrap();
    assert!((read - known).abs() < 5e-4, "{read} {known}");
}

/// A damping of eps^3 does not come to rest within the periods that are looked at: no values, and a remark.
#[test]
fn what_does_not_settle_is_said() {
    let equation = "x'' + x + eps*(mu*x' + x^3) = eps*cos(omega*t)/2";
    let remarks = |mu: &str| {
        let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
        let case = case.set("mu", mu).unwrap();
        let sweep = Some(Axis::parse("omega=1,21/20").unwrap());
        let question = Respond { sweep, follow: true, ..to_order(1) };
        let answer = case.respond(&question, &Work::default()).unwrap();
        let said = |remark: &lindstedt::Remark| remark.0.starts_with("--follow: at 4 of 4 values");
        answer.remarks.iter().any(said)
    };
    assert_eq!(["1/100", "1/5"].map(remarks), [true, false]);
}

/// Where rest alone is stable the motion decays to it and is read as zero; stopped on the way, what is read stays with the branches.
#[test]
fn decays_to_rest_are_followed() {
    let equation = "x'' + x + eps*(x'/5 + x^3 + 2*x*cos((2 + eps*sigma)*t)) = 0";
    let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
    let sweep = Some(Axis::parse("sigma=-3,0,2").unwrap());
    let question = Respond { sweep, follow: true, ..to_order(2) };
    let run = |stop| {
        let work = Work { stop, ..Work::default() };
        case.respond(&question, &work).unwrap()
    };
    let count = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&count);
    let found = run(Stop::new(move || counter.fetch_add(1, Ordering::SeqCst) == u64::MAX));
    let read = |list: &[lindstedt::respond::Reading]| -> Vec<f64> {
        list.iter().map(|it| it.amplitudes.as_ref().unwrap()[0].value).collect()
    };
    let [up, down] = found.value.followed.as_ref().unwrap();
    let (up, down) = (read(up), read(down));
    assert!(up[0] == 0.0 && up[1] > 0.5 && up[2] > up[1] && down[2] == 0.0, "{up:?} {down:?}");
    let (asked, counter) = (count.load(Ordering::SeqCst), AtomicU64::new(0));
    let late = asked * 3 / 4;
    let found = run(Stop::new(move || counter.fetch_add(1, Ordering::SeqCst) >= late));
    assert!(matches!(found.standing, lindstedt::Standing::Stopped { .. }));
    let [up, down] = found.value.followed.as_ref().unwrap();
    assert!(!up.is_empty() && down.len() < 3 && !found.value.branches.is_empty());
}

/// Locked motion in closed branches between the values of the sweep: that of one unknown is found, of several it is remarked that
/// one may be missing.
#[test]
fn closed_branches_between_the_values() {
    let ask = |equation: &str, sweep: &str| {
        let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
        let question = Respond { sweep: Some(Axis::parse(sweep).unwrap()), ..to_order(1) };
        let question = Respond { amplitude: Some("14".parse().unwrap()), ..question };
        case.respond(&question, &Work::default()).unwrap()
    };
    let is_said = |answer: &lindstedt::Answer<Response>| {
        answer.remarks.iter().any(|remark| remark.0.contains("closed branches"))
    };
    let one = ask("x'' + x = eps*((1 - x^2)*x' + cos((1 + eps*sigma)*t)/2)", "sigma=-1..1:8");
    let closed = one.value.branches.iter().filter(|branch| branch.closed).count();
    assert_eq!((one.value.branches.len(), closed), (2, 1));
    let number = |text: &str| text.parse::<f64>().unwrap();
    for (fold, known) in one.value.folds.iter().zip([-0.126_039_75, 0.126_039_75]) {
        assert!((number(&fold.value.decimal) - known).abs() < 1e-8, "{}", fold.value.decimal);
        assert_eq!(fold.value.status, Status::Proved);
    }
    assert!(one.value.folds.len() == 2 && !is_said(&one));
    let two = ask(
        "x'' + x + eps*(x'/5 + x*y) = 0; \
         y'' + 4*y + eps*(y + y'/5 + x^2) = 8*eps*cos((2 + eps*s)*t)",
        "s=-2..2:17",
    );
    assert!(two.value.folds.is_empty() && is_said(&two));
    assert_eq!(two.value.crossings.len(), 2);
    for crossing in &two.value.crossings {
        assert!(crossing.value.decimal.len() < 18, "{}", crossing.value.decimal);
        assert_eq!(crossing.value.status, Status::Estimated);
    }
}

/// The same divergence in every state of a sweep of the small parameter itself, of negative values as well, and of all states
/// those are stable that the values set one by one have stable.
#[test]
fn sweeps_of_the_small_parameter() {
    let one = "x'' + x + eps*(x'/10 + x^3) = eps*cos((1 + eps)*t)";
    let two = "x'' + x + eps*(x'/5 + x^3 + x^2*y) = eps*cos((1 + eps)*t)/2; \
               y'' + 9*y + eps*(y'/10 + y + x*y^2) = 0";
    for (equation, divergence) in [(one, 0.1), (two, 0.3)] {
        for (values, positive) in [("1/50,1/20", 1.0), ("-1/20,-1/50", -1.0)] {
            let sweep = Some(Axis::parse(&format!("eps={values}")).unwrap());
            let amplitude = Some("3".parse().unwrap());
            let question = Respond { amplitude, ..to_order(2) };
            let swept = ask(equation, &[], &Respond { sweep, ..question.clone() });
            for (states, value) in swept.states.iter().zip(values.split(',')) {
                let small: Rational = value.parse().unwrap();
                let stable = |list: &[State]| list.iter().map(|it| it.stable).collect::<Vec<_>>();
                let alone = ask(equation, &[("eps", value)], &question);
                assert_eq!(stable(&states.list), stable(&alone.states[0].list), "{value}");
                assert_eq!(states.list[0].stable, Some(positive > 0.0), "{value}");
                for state in &states.list {
                    let sum: f64 = state.exponents.iter().map(|[re, _]| re.value).sum();
                    let error = (sum + divergence * small.to_f64()).abs();
                    assert!(error < 3.0 * small.to_f64().abs().powi(3), "{value}: {sum}");
                }
            }
        }
    }
}

/// The cusp of the primary resonance by its closed form (Nayfeh and Mook, chapter 4), whichever values the curves of folds are begun at.
#[test]
fn the_cusp_is_found_from_any_columns() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)";
    for [sigma, force] in [["0,1/2,1", "1/10,1"], ["0..1:5", "0..1:5"], ["0,3", "1/10,1"]] {
        let axis = |name, values| Some(Axis::parse(&format!("{name}={values}")).unwrap());
        let (sweep, second) = (axis("sigma", sigma), axis("F", force));
        let found = ask(equation, &[("eps", "1/10")], &Respond { sweep, second, ..to_order(1) });
        let [cusp] = &found.cusps[..] else { panic!("{sigma}, {force}: {}", found.cusps.len()) };
        let value = |k: usize| cusp.values[k].decimal.parse::<f64>().unwrap();
        // mu = 1/10, alpha = 1: sigma = sqrt 3 mu, F^2 = 256 mu^3/(9 sqrt 3 alpha).
        let root = 3f64.sqrt();
        assert!((value(0) - 0.1 * root).abs() < 1e-12);
        assert!((value(1) - (0.256 / (9.0 * root)).sqrt()).abs() < 1e-12);
    }
}

/// Curves in the plane of two parameters are the same whichever of the two is named first, and each is one: mirror states of a
/// parametric force have one, and curves of Hopf points end at Bogdanov-Takens points. Folds of the first lie at h = 2/5 for all
/// sigma > 0: (3a^2/4 - sigma)^2 = h^2/4 - 4 mu^2.
#[test]
fn curves_do_not_depend_on_the_order_of_the_sweeps() {
    let parametric = "x'' + x + eps*(x'/5 + x^3) + eps*h*x*cos((2 + eps*sigma)*t)";
    for (equation, [first, second], folds, hopf) in [
        (parametric, ["sigma=1/2,1,2", "h=1/10,3/10,1/2,1"], 1, 0),
        (
            "x'' + x + eps*(x'/5 + x^3/3 + x^2) = eps*F*cos((1 + eps*sigma)*t)",
            ["sigma=-2,1/2,3", "F=1/10,1,2"],
            1,
            0,
        ),
        (
            "x'' + x = eps*((1 - x^2)*x' - x^3/2 + h*x*cos((2 + eps*sigma)*t))",
            ["sigma=-1,1,3", "h=1/5,3/2,3"],
            0,
            1,
        ),
    ] {
        let axis = |text: &str| Some(Axis::parse(text).unwrap());
        let found = [[first, second], [second, first]].map(|[a, b]| {
            let question = Respond { sweep: axis(a), second: axis(b), ..to_order(1) };
            ask(equation, &[("eps", "1/10")], &question)
        });
        let counts = |it: &Response| {
            let of = |kind| it.curves.iter().filter(|curve| curve.kind == kind).count();
            [of("fold"), of("hopf"), it.cusps.len(), it.bogdanov_takens.len()]
        };
        let [one, other] = found.each_ref().map(counts);
        assert_eq!(one, other, "{equation}");
        println!("{equation}: {one:?}");
        assert!(one[0] >= folds && one[1] >= hopf, "{equation}: {one:?}");
        for curve in found.iter().flat_map(|it| &it.curves).filter(|curve| !curve.closed) {
            let [a, .., b] = &curve.points[..] else { panic!("no curve") };
            assert!((0..2).any(|k| (a[k].value - b[k].value).abs() > 1e-6), "{equation}: back");
        }
        if equation == parametric {
            assert_eq!(one, [1, 0, 0, 0]);
            let points = found[0].curves[0].points.iter();
            assert!(points.clone().all(|[_, h]| (h.value - 0.4).abs() < 1e-9));
            let ends = points.map(|[sigma, _]| sigma.value);
            assert!(ends.clone().fold(f64::MIN, f64::max) > 2.0 - 1e-9);
        }
    }
}

/// A sweep beside an irrational mode, x = q_1 + q_2, y = q_1 - q_2 with the frequencies 1 and sqrt 3: at order one the force
/// of 1/2 and the damping of 1/10 on the first mode, 3 a^2/8 of the cubic spring shared by the two coordinates,
/// ((a/20)^2 + (sigma a - 3 a^3/16)^2) = (1/4)^2, of which the folds are the zeros of the derivative by a^2.
#[test]
fn sweeps_beside_an_irrational_mode() {
    let equation =
        "x'' + 2*x - y + eps*(x'/10 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*y'/10";
    let sweep = Some(Axis::parse("sigma=-1..6:60").unwrap());
    let found = ask(equation, &[("eps", "1/10")], &Respond { sweep, ..to_order(1) });
    assert!(found.states.iter().all(|states| states.count_proved));
    assert_eq!(found.folds.len(), 2);
    for fold in &found.folds {
        let number = |n: &lindstedt::Number| n.decimal.parse::<f64>().unwrap();
        let (sigma, r) = (number(&fold.value), number(&fold.amplitudes[0]).powi(2));
        let off = sigma - 3.0 / 16.0 * r;
        let curve = (0.0025 + off * off) * r - 1.0 / 16.0;
        let slope = 0.0025 + off * off - 3.0 / 8.0 * r * off;
        assert!(curve.abs() < 1e-10 && slope.abs() < 1e-10, "{sigma} {r}: {curve:e} {slope:e}");
        assert_eq!(number(&fold.amplitudes[1]), 0.0);
    }
}

/// Principal parametric resonance, mu^2 + (sigma - 3 a^2/8)^2 = h^2/16 at order one: motions are born of rest at a = 0, where the branch
/// that turns in them is no fold, and at mu = 0 the divergence -2 mu of the slow flow is zero everywhere: centres, no Hopf point.
#[test]
fn pitchforks_of_rest_are_no_folds() {
    let equation = "x'' + x + eps*(2*mu*x' + x^3 + x*cos((2 + eps*sigma)*t)) = 0";
    let edge = (0.25f64 - 0.04).sqrt();
    for (set, sweep, edge) in
        [(("mu", "1/10"), "sigma=-2..2:5", edge), (("sigma", "0"), "mu=-1..1:5", 0.25)]
    {
        let sweep = Some(Axis::parse(sweep).unwrap());
        let question = Respond { sweep, amplitude: Some("4".parse().unwrap()), ..to_order(1) };
        let found = ask(equation, &[("eps", "1/10"), set], &question);
        assert_eq!((found.folds.len(), found.hopf.len(), found.crossings.len()), (0, 0, 2));
        for (crossing, known) in found.crossings.iter().zip([-edge, edge]) {
            let at: f64 = crossing.value.decimal.parse().unwrap();
            assert!((at - known).abs() < 1e-9, "{at}");
            assert_eq!(decimals(&crossing.amplitudes), [0.0]);
        }
    }
}

/// A sign that continuation changes where it steps over to another branch beside a crossing is no crossing: there is one, at rest, and
/// the numbers of states on either side of it are those of a search.
#[test]
fn one_crossing_is_one() {
    let equation = "x'' + x + eps*(x'/5 + x^3 + h*x*cos((2 + eps*sigma)*t)) = 0";
    let amplitude: Option<lindstedt::Exact> = Some("3".parse().unwrap());
    for (order, sigma) in [(2, "-1"), (3, "-4/5")] {
        let set = [("eps", "1/10"), ("sigma", sigma)];
        let sweep = Some(Axis::parse("h=0..4:5").unwrap());
        let question = Respond { amplitude: amplitude.clone(), ..to_order(order) };
        let found = ask(equation, &set, &Respond { sweep, ..question.clone() });
        let [crossing] = &found.crossings[..] else { panic!("{:?}", found.crossings) };
        assert_eq!((found.folds.len(), decimals(&crossing.amplitudes)), (0, vec![0.0]));
        let at: f64 = crossing.value.decimal.parse().unwrap();
        for (beside, count) in [(-1e-5, 1), (1e-5, 3)] {
            let h = format!("{:.12}", at + beside);
            let alone = ask(equation, &[set[0], set[1], ("h", &*h)], &question);
            assert_eq!((alone.states[0].count, alone.states[0].count_proved), (count, true));
        }
    }
}

/// At eps = 0 every amplitude is steady: no range of eps holds that.
#[test]
fn a_range_of_the_small_parameter_is_of_one_sign() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)";
    let case = Oscillator::parse(equation).unwrap().set("F", "1/2").unwrap();
    let case = case.set("sigma", "1").unwrap();
    let asked = |axis: &str, second: Option<&str>| {
        let [sweep, second] = [Some(axis), second].map(|it| it.map(|it| Axis::parse(it).unwrap()));
        case.clone().respond(&Respond { sweep, second, ..to_order(1) }, &Work::default())
    };
    for axis in ["eps=-1/10..1/10:3", "eps=0..1/10:3", "eps=-1/10..0:3", "eps=-1/20,1/20"] {
        let refused = asked(axis, None).unwrap_err().to_string();
        assert!(refused.contains("holds 0"), "{axis}: {refused}");
    }
    assert!(asked("sigma=0..1:3", Some("eps=0..1/10:3")).is_err());
    assert!(asked("eps=1/100..1/10:3", None).is_ok());
}
