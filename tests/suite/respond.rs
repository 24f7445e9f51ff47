//! Steady states at resonance against periodic orbits that are proved without any expansion, and against closed forms.

#![allow(clippy::unwrap_used, clippy::panic)]

use lindstedt::grid::Axis;
use lindstedt::respond::{Point, Response, State, States};
use lindstedt::unstable::orbit::steady::{ComplexTerm, Flow, zero_near};
use lindstedt::unstable::orbit::{Field, Kind, Request, Start, prove};
use lindstedt::{Exact, Oscillator, Refusal, Respond, Status, Verify, Work};
use rug::Rational;

fn ask(equation: &str, values: &[(&str, &str)], question: &Respond) -> Response {
    let start = Oscillator::parse(equation).unwrap();
    let set = |case: Oscillator, (name, value): &(&str, &str)| case.set(name, value).unwrap();
    let case = values.iter().fold(start, set);
    case.respond(question, &Work::default()).unwrap().value
}

fn to_order(order: usize) -> Respond {
    Respond { order: Some(order), ..Respond::default() }
}

/// N orders of the slow flow give the first harmonic of the true orbit to O(eps^N), and Liouville's trace
/// -2 eps mu to O(eps^(N + 1)).
#[test]
fn steady_amplitudes_against_proved_orbits() {
    let equation = "x'' + x + eps*(3/5*x + 2/7*x' + x^3) = eps*cos(t)/2";
    let smalls = [20, 40, 80].map(|n| Rational::from((1, n)));
    let mut errors = [[0.0f64; 3]; 4];
    let mut traces = [[0.0f64; 3]; 4];
    for (k, small) in smalls.iter().enumerate() {
        let problem = Oscillator::parse(equation).unwrap();
        let values = [("eps".to_owned(), small.clone())].into();
        let field = Field::new(&problem.problem().equation, "eps", &values).unwrap();
        let mut truth = None;
        for order in (1..=4).rev() {
            let set = [("eps", &*small.to_string())];
            let found = ask(equation, &set, &to_order(order));
            assert_eq!((found.states[0].count, found.states[0].count_proved), (1, true));
            let state = &found.states[0].list[0];
            let number = |text: &str| text.parse::<f64>().unwrap();
            let amplitude = number(&state.amplitudes[0].decimal);
            let phase = number(&state.phases[0].as_ref().unwrap().decimal);
            let truth = *truth.get_or_insert_with(|| {
                let cosines = vec![0.0, amplitude * phase.cos()];
                let sines = vec![0.0, -amplitude * phase.sin()];
                let start = Start { frequency: 1.0, cosines, sines };
                let proof = prove(&field, &Kind::Forced(1), &start, &Request::default()).unwrap();
                let (cosine, sine) = proof.harmonic(1);
                cosine.midpoint().to_f64().hypot(sine.midpoint().to_f64())
            });
            errors[order - 1][k] = (amplitude - truth).abs();
            let trace: f64 = state.exponents.iter().map(|[re, _]| re.value).sum();
            traces[order - 1][k] = (trace + 2.0 / 7.0 * small.to_f64()).abs();
        }
    }
    for order in 1..=4 {
        let [_, b, c] = errors[order - 1];
        let slope = (b / c).log2();
        println!("order {order}: {:?}, slope {slope:.2}", errors[order - 1]);
        assert!((slope - order as f64).abs() < 0.2, "order {order}: slope {slope}");
        let [a, _, c] = traces[order - 1];
        // Order one is exact.
        assert!(c < 1e-15 || (a / c).log2() / 2.0 > order as f64 + 0.8, "{:?}", traces[order - 1]);
    }
}

/// The exponents of the subharmonic states of order three at eps = 1/20 are the Floquet exponents of the orbits to five
/// digits, those of the saddle included: Newton's method on the map of a period, with its derivative by Runge and Kutta.
#[test]
fn exponents_of_subharmonic_orbits() {
    let equation = "x'' + x + eps*(x'/50 + x^3/4) = 4*cos((3 + eps*sigma)*t)";
    let found = ask(equation, &[("eps", "1/20"), ("sigma", "1/2")], &to_order(4));
    let (eps, omega) = (0.05, 3.0 + 0.05 * 0.5);
    let period = 6.0 * std::f64::consts::PI / omega;
    // x, x', and the two columns of the derivative.
    let rate = |t: f64, y: &[f64; 6]| {
        let force = 4.0 * (omega * t).cos() - y[0] - eps * (y[1] / 50.0 + y[0].powi(3) / 4.0);
        let slope = -1.0 - 0.75 * eps * y[0] * y[0];
        let column = |u: f64, v: f64| slope * u - eps * v / 50.0;
        [y[1], force, y[3], column(y[2], y[3]), y[5], column(y[4], y[5])]
    };
    let map = |x: [f64; 2]| {
        let mut y = [x[0], x[1], 1.0, 0.0, 0.0, 1.0];
        let (steps, along) = (1500, |y: &[f64; 6], k: &[f64; 6], h: f64| -> [f64; 6] {
            std::array::from_fn(|i| y[i] + h * k[i])
        });
        let h = period / f64::from(steps);
        for n in 0..steps {
            let t = h * f64::from(n);
            let a = rate(t, &y);
            let b = rate(t + h / 2.0, &along(&y, &a, h / 2.0));
            let c = rate(t + h / 2.0, &along(&y, &b, h / 2.0));
            let d = rate(t + h, &along(&y, &c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    };
    let mut saddles = 0;
    assert_eq!(found.states[0].count, 7);
    for state in &found.states[0].list {
        let a: f64 = state.amplitudes[0].decimal.parse().unwrap();
        let phase = state.phases[0].as_ref().map_or(0.0, |phi| phi.decimal.parse::<f64>().unwrap());
        let mut x = [a * phase.cos() + 4.0 / (1.0 - omega * omega), -omega / 3.0 * a * phase.sin()];
        let mut slopes = [0.0; 4];
        for _ in 0..8 {
            let [p, q, b, d, c, e] = map(x);
            slopes = [b, c, d, e];
            let determinant = (b - 1.0) * (e - 1.0) - c * d;
            let [u, v] = [p - x[0], q - x[1]];
            x[0] -= ((e - 1.0) * u - c * v) / determinant;
            x[1] -= ((b - 1.0) * v - d * u) / determinant;
        }
        let (trace, determinant) =
            (slopes[0] + slopes[3], slopes[0] * slopes[3] - slopes[1] * slopes[2]);
        let gap = trace * trace / 4.0 - determinant;
        // The largest real part of ln(multiplier)/period, and the imaginary part.
        let known = match gap > 0.0 {
            true => [(trace / 2.0 + gap.sqrt()).abs().ln() / period, 0.0],
            false => [determinant.ln() / 2.0, (-gap).sqrt().atan2(trace / 2.0)].map(|x| x / period),
        };
        let own = state.exponents.iter().map(|[re, im]| [re.value, im.value.abs()]);
        let own = own.max_by(|a, b| a[0].total_cmp(&b[0])).unwrap();
        let size = known[0].hypot(known[1]);
        let error = (own[0] - known[0]).hypot(own[1] - known[1]) / size;
        println!("a = {a}: {own:?}, {known:?}, {error:e}");
        assert!(error < 1e-5, "a = {a}: {own:?}, {known:?}");
        saddles += usize::from(known[0] > 0.0);
    }
    assert_eq!(saddles, 3);
}

/// The Bogdanov-Takens point of the forced oscillator of van der Pol at eps = 1/10: that of the stroboscopic map lies at
/// sigma = 0.2484755, F = 1.0186359 (both multipliers 1; integration with 13 digits). The errors of orders 1, 2, 3, 4 are
/// 1.9e-2, 2.7e-4, 1.6e-5, 1.3e-6.
#[test]
fn lock_in_against_the_stroboscopic_map() {
    let equation = "x'' + x = eps*((1 - x^2)*x' + F*cos((1 + eps*sigma)*t))";
    for (order, known) in [(1, 1.9e-2), (2, 2.7e-4), (3, 1.6e-5), (4, 1.3e-6)] {
        let question = Respond {
            sweep: Some(Axis::parse("sigma=0,1/5,2/5").unwrap()),
            second: Some(Axis::parse("F=4/5,6/5").unwrap()),
            ..to_order(order)
        };
        let found = ask(equation, &[("eps", "1/10")], &question);
        let [point] = &found.bogdanov_takens[..] else {
            panic!("order {order}: {:?}", found.bogdanov_takens)
        };
        let [sigma, force] =
            [&point.values[0], &point.values[1]].map(|value| value.decimal.parse::<f64>().unwrap());
        let error = (sigma - 0.2484755).hypot(force - 1.0186359);
        println!("order {order}: {error:.2e}");
        assert!((0.9 * known..1.1 * known).contains(&error), "order {order}: {error:e}");
    }
}

/// Principal parametric resonance: mu^2 + (sigma - 3 a^2/8)^2 = h^2/16 at order one, x = a cos(eta/2 + phi).
#[test]
fn parametric_states() {
    let equation = "x'' + x + eps*(x'/5 + x^3 + h*x*cos(2*(1 + eps*sigma)*t)) = 0";
    let set = [("eps", "1/10"), ("h", "1"), ("sigma", "1/4")];
    let found = ask(equation, &set, &to_order(1));
    assert_eq!((found.turns[0].as_str(), found.complete), ("1/2", true));
    let states = &found.states[0];
    // At rest; two of either amplitude, half a turn apart.
    assert_eq!((states.count, states.count_proved), (5, true));
    let root = (0.0625f64 - 0.01).sqrt();
    let known = [0.25 + root, 0.25 + root, 0.25 - root, 0.25 - root, 0.0];
    for (state, known) in states.list.iter().zip(known) {
        let a: f64 = state.amplitudes[0].decimal.parse().unwrap();
        assert!((0.375 * a * a - known).abs() < 1e-12, "{a}");
        assert_eq!(state.phases[0].is_none(), known == 0.0);
    }
    let stable: Vec<_> = states.list.iter().map(|state| state.stable).collect();
    assert_eq!(stable, [true, true, false, false, true].map(Some));
}

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

/// Three states that are each other turned by a third of a turn lie within the largest amplitude together or not at all.
#[test]
fn the_largest_amplitude_is_that_of_a_disc() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = F*cos((3 + eps*sigma)*t)";
    let set = [("eps", "1/10"), ("F", "10"), ("sigma", "1")];
    for (limit, count) in [("5.9007", 1), ("5.9009", 4)] {
        let amplitude = Some(Exact::parse(limit).unwrap());
        let found = ask(equation, &set, &Respond { amplitude, ..to_order(2) });
        let states = &found.states[0];
        assert_eq!((states.count, states.count_proved, states.at_edge), (count, true, 0));
    }
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

/// Liouville: the exponents of a state sum to the mean divergence, -eps/5 of one damped unknown and -3 eps/10 of two; N orders
/// of the slow flow leave an error of order N + 1.
#[test]
fn exponents_sum_to_the_divergence() {
    let one = "x'' + x + eps*(3/5*x + x'/5 + x^2/2 + x^3) = eps*cos(t)/2";
    let two = "x'' + x + eps*(x'/5 + x^3 + x^2*y) = eps*cos(t)/2; \
               y'' + 9*y + eps*(y'/10 + y + x*y^2) = 0";
    for (equation, divergence, orders) in [(one, 0.2, 1..=6), (two, 0.3, 1..=3)] {
        for order in orders {
            let error = |small: &str, value: f64| {
                let amplitude = Some("3/2".parse().unwrap());
                let question = Respond { amplitude, ..to_order(order) };
                let found = ask(equation, &[("eps", small)], &question);
                let state = &found.states[0].list[0];
                let sum: f64 = state.exponents.iter().map(|[re, _]| re.value).sum();
                (sum + divergence * value).abs()
            };
            let [a, b] = [error("1/10", 0.1), error("1/20", 0.05)];
            let slope = (a / b).log2();
            println!("order {order}: {a:e} {b:e}, slope {slope:.2}");
            assert!(b < 1e-15 || slope > order as f64 + 0.6, "order {order}: {a:e} {b:e}");
        }
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

/// A frequency of 4.01 is nearer to 4 than the small terms move it: the orders do not fall, and the orbit in time has the amplitudes
/// 2.2604 and 1.7038 (harmonic balance), near those of the frequency written as 4 and a detuning.
#[test]
fn a_near_resonance_is_said() {
    let asked = |y: &str, order: usize| {
        let equation = format!(
            "x'' + x + eps*(x'/10 + x*y) = eps*cos((1 + eps/5)*t); y'' + {y} + eps*(x^2 + y'/10)"
        );
        let case = Oscillator::parse(&equation).unwrap().set("eps", "1/10").unwrap();
        let question = Respond { amplitude: Some("6".parse().unwrap()), ..to_order(order) };
        let answer = case.respond(&question, &Work::default()).unwrap();
        let said = |words: &str| answer.remarks.iter().any(|it| it.0.contains(words));
        let doubts =
            [said("misses a resonance by 0.002494"), said("an order of the slow flow adds")];
        (doubts, answer.value.states[0].list[0].amplitudes.clone())
    };
    assert_eq!([1, 2, 3].map(|order| asked("4.01*y", order).0[0]), [true; 3]);
    assert_eq!([1, 3].map(|order| asked("4.01*y", order).0[1]), [false, true]);
    let (doubts, amplitudes) = asked("4*y + eps*y/10", 2);
    assert_eq!(doubts, [false, false]);
    for (a, known) in amplitudes.iter().zip([2.2604, 1.7038]) {
        assert!((a.decimal.parse::<f64>().unwrap() - known).abs() < 5e-3, "{}", a.decimal);
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

/// Of two unknowns 1:2 the start at rest leads to the one state; pairs for each unknown, or the form is said.
#[test]
fn starts_of_several_unknowns() {
    let equation = "x'' + x + eps*(x'/10 + x*y) = eps*cos((1 + eps/5)*t); y'' + 4*y + eps*(x^2 + y/10 + y'/10)";
    let question = |start: &str| Respond {
        amplitude: Some("6".parse().unwrap()),
        start: Some(Respond::read_start(start).unwrap()),
        ..to_order(2)
    };
    let leads = ask(equation, &[("eps", "1/10")], &question("0,0,0,0")).leads_to.unwrap();
    assert_eq!((leads.fate, leads.state, leads.decided), ("steady", Some(0), true));
    let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
    assert_eq!(case.respond(&question("0,0"), &Work::default()).unwrap_err().code(), "start");
    assert!(Respond::read_start("1,2,3").is_err());
}

/// A start with a velocity leads to the same state whether the frequency is sqrt(2) or the fraction 17/12 beside it, but where the
/// bound of a basin lies between the two.
#[test]
fn starts_in_the_unit_of_frequency() {
    let set = [("eps", "1/10"), ("F", "1"), ("sigma", "1")];
    let state = |square: &str, nu: &str, velocity: i32| {
        let equation =
            format!("x'' + {square}*x + eps*(x'/5 + x^3) = eps*F*cos(({nu} + eps*sigma)*t)");
        let start = Some(Respond::read_start(&format!("1,{velocity}/4")).unwrap());
        ask(&equation, &set, &Respond { start, ..to_order(1) }).leads_to.unwrap().state
    };
    let pairs: Vec<_> =
        (-16..=16).map(|v| [state("289/144", "17/12", v), state("2", "sqrt(2)", v)]).collect();
    let apart = pairs.iter().filter(|[a, b]| a != b).count();
    let bounds = pairs.windows(2).filter(|two| two[0][0] != two[1][0]).count();
    assert!(apart <= bounds && bounds > 0, "{pairs:?}");
    assert!(apart <= 1, "{pairs:?}");
}

/// Of a start at the rim of a basin the leading order does not decide. In time the first comes to rest (2400 periods), the slow flow
/// to a state of amplitude 2.24; the others leave rest, which is unstable, for a state that the force of order eps chooses.
#[test]
fn a_start_at_the_rim_is_undecided() {
    let rim = "x'' + x + eps*(x^3 + x'/20) = 8*cos((3 + eps*s)*t)";
    let rest = "x'' + x + eps*(x'/10 - x*cos(2*t) + x^3 + x^2) = 5*eps*cos(5*t)";
    for (equation, set, start, order) in [
        (rim, &[("eps", "1/20"), ("s", "5")][..], "0,0", 3),
        (rest, &[("eps", "1/10")], "0,0", 2),
        (rest, &[("eps", "1/10")], "-1/100,0", 2),
        (rest, &[("eps", "1/10")], "-1/50,0", 2),
    ] {
        let start = Some(Respond::read_start(start).unwrap());
        let found = ask(equation, set, &Respond { start, ..to_order(order) });
        assert!(!found.leads_to.unwrap().decided, "{equation}");
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

/// An unknown at rest beside the internal resonance 1:1 is pumped by x^2 y: the exponents of the variational equation about the orbit
/// of the full equation (Runge and Kutta, 300 steps a period) are positive for squares from 0.92 to 0.96. None of these is called
/// stable; the leading order of the tongue has the growth to a tenth of eps.
#[test]
fn tongues_beside_the_slow_flow() {
    for (percent, truth) in [
        (85, -0.007_143),
        (92, 0.003_832),
        (93, 0.006_918),
        (94, 0.007_830),
        (95, 0.007_023),
        (96, 0.004_165),
        (103, -0.007_143),
    ] {
        let equation = format!(
            "x'' + x + eps*(x*y^2 + x'/5 + x^3) = eps*cos(t); y'' + {percent}*y/100 + eps*(y'/7 + x^2*y + y^3)"
        );
        let found = ask(&equation, &[("eps", "1/10")], &to_order(1));
        let [state] = &found.states[0].list[..] else { panic!("{percent}") };
        let growth = state.near_resonance.map(|it| it.value);
        println!("{percent}: {growth:?}, {truth}");
        assert_eq!(state.stable, (truth < 0.0).then_some(true), "{percent}");
        assert_eq!(growth.is_some(), truth > 0.0, "{percent}");
        let off = growth.map_or(0.0, |growth| (growth - truth).abs());
        assert!(off < 0.1 * 0.1, "{percent}: {off}");
    }
}

/// Far outside the box the slow flow of order two runs off where the damping of the equation wins (a = 0.1137 in time): nothing is
/// decided there. A weakly damped motion is followed to its end; a forced van der Pol oscillator out of step beats for ever.
#[test]
fn starts_outside_the_box_are_undecided() {
    let hard = "x'' + x + eps*(x'/5 + x^3) = eps*cos((1+eps*sigma)*t)/2";
    let weak = "x'' + x + eps*(x'/1000 + x^3) = eps*cos((1+eps)*t)/2";
    let beats = "x'' + x = eps*((1 - x^2)*x' + cos((1 + 2*eps)*t))";
    for (equation, set, start, order, known) in [
        (hard, &[("sigma", "2"), ("eps", "1/10")][..], "4,4", 2, None),
        (hard, &[("sigma", "2"), ("eps", "1/10")], "1,0", 2, Some("steady")),
        (weak, &[("eps", "1/1000")], "1,0", 1, Some("steady")),
        (beats, &[("eps", "1/10")], "1,0", 1, Some("cycle")),
    ] {
        let start = Some(Respond::read_start(start).unwrap());
        let leads = ask(equation, set, &Respond { start, ..to_order(order) }).leads_to.unwrap();
        assert_eq!((leads.decided, leads.doubt.is_none()), (known.is_some(), known.is_some()));
        assert!(known.is_none_or(|fate| leads.fate == fate), "{equation}: {}", leads.fate);
    }
}

/// Six resonances in time: N orders of the slow flow leave a remainder of order N + 1. Order 4 of all six, which costs half
/// a minute, agrees as well.
#[test]
fn remainders_of_six_resonances() {
    for (equation, most) in [
        // Primary, principal parametric, subharmonic 1/3, superharmonic 3, lock-in, one to two.
        ("x'' + x + eps*(3/5*x + 2/7*x' + x^3) = eps*cos(t)/2", 3),
        ("x'' + x + eps*(x'/5 + x^3 + x*cos(2*t)) = 0", 3),
        ("x'' + x + eps*(x^3 + x'/20) = 5*cos((3 + 2*eps)*t)", 3),
        ("x'' + x + eps*(x^3 + x'/5) = cos(t/3)", 3),
        ("x'' + x = eps*(1 - x^2)*x' + eps*cos(t)", 3),
        ("x'' + x + eps*x*y = 0; y'' + 4*y + eps*x^2 = 0", 4),
    ] {
        let case = Oscillator::parse(equation).unwrap();
        for order in 1..=most {
            let small = [100, 200, 400].map(|n| Rational::from((1, n))).to_vec();
            let question = Verify { order, small, samples: 4, ..Verify::default() };
            let found = case.verify(&question, &Work::default()).unwrap().value;
            let slope = found.observed_order.unwrap();
            assert!((slope - order as f64 - 1.0).abs() < 0.1, "{equation}, order {order}: {slope}");
            let steady = found.steady.unwrap();
            let slopes: Vec<_> = steady.states.iter().filter_map(|it| it.observed_order).collect();
            let right = slopes.iter().filter(|slope| (*slope - order as f64).abs() < 0.1).count();
            // To order four nothing is left above the error of the integration.
            let any = right > 0 || order == 4;
            assert!(right == slopes.len() && any, "{equation}, order {order}: {steady:?}");
        }
    }
}

/// Motions that lock and normal modes against periodic orbits of the equations: amplitudes to O(eps^N), frequencies to one order more.
#[test]
fn free_motions_against_periodic_orbits() {
    let pair = "x'' + x = eps*((1 - x^2)*x' + (y' - x')/5); y'' + (1 + eps/10)*y = eps*((1 - y^2)*y' + (x' - y')/5)";
    let spring = "x'' + x + eps*(x*y + x^3/5); y'' + 4*y + eps*x^2/2";
    for (equation, states) in [(pair, 4), (spring, 3)] {
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

/// Twenty problems, rational, beside irrational modes, with delays, with symbols that have values: the number of their states is
/// proved for each. Equations, order, number of states.
const PROVED: [(&str, usize, usize); 20] = [
    ("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2", 2, 1),
    ("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2", 4, 1),
    ("x'' + x + eps*(x'/5 + alpha*x^3 + beta*x^2) = eps*F*cos((1 + eps*sigma)*t)", 3, 1),
    ("x'' + x + eps*(x'/5 + x^3 + 2*x*cos((2 + eps*sigma)*t)) = 0", 2, 3),
    ("x'' + x + eps*(x'/5 + x^3) = 10*cos((3 + eps)*t)", 2, 1),
    ("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t + 1/2)", 2, 1),
    ("x'' + x + eps*(x'/5 + x^3 + F*x(t - T)/5) = eps*cos((1 + eps*sigma)*t)", 3, 1),
    ("x'' + x + eps*(x'/5 + x^3 + x(t - pi/3)/5) = eps*cos((1 + eps*sigma)*t)", 3, 1),
    (
        "x'' + 2*x + eps*(x'/5 + x^3 + 2*x*y) = 0; y'' + y + eps*y'/5 = eps*cos((1 + eps*sigma)*t)",
        2,
        1,
    ),
    (
        "x'' + x + eps*(x' + x^3 + x*y) = eps*cos((1 + eps*sigma)*t); y'' + 2*y + eps*(y' + 4*x^2 + y^3)",
        1,
        1,
    ),
    (
        "x'' + x + eps*(x' + x^3 + x*y) = eps*cos((1 + eps*sigma)*t); y'' + 2*y + eps*(y' + 4*x^2 + y^3)",
        3,
        1,
    ),
    (
        "x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 3*y + eps*(y'/5 + x*y + x^2)",
        3,
        1,
    ),
    (
        "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*y'/5",
        1,
        3,
    ),
    (
        "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*y'/5",
        2,
        3,
    ),
    (
        "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*y'/5",
        3,
        3,
    ),
    (
        "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*(y'/5 + x(t - 1)/3)",
        2,
        3,
    ),
    (
        "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t); y'' + 2*y - x + eps*(y'/5 + x(t - 1)/3)",
        3,
        3,
    ),
    (
        "x'' + x + eps*(x'/5 + x^3 + y(t - 1)) = eps*cos((1 + eps*sigma)*t); y'' + 2*y + eps*(y'/5 + y^3)",
        2,
        1,
    ),
    (
        "x'' + x + eps*(x'/5 + x^3 + y^2) = eps*cos((1 + eps*sigma)*t); y'' + 3*y + eps*(y'/5 + y^3); z'' + 5*z + eps*(z'/5 + x*z)",
        2,
        1,
    ),
    (
        "x'' + x + eps*(x'/5 + alpha*x^3 + y^2) = eps*F*cos((1 + eps*sigma)*t); y'' + 3*y + eps*(y'/5 + y^3); z'' + 5*z + eps*(z'/5 + x*z)",
        3,
        1,
    ),
];

#[test]
fn what_can_be_proved_is_said_to_be() {
    let values = [
        ("eps", "1/10"),
        ("sigma", "1/2"),
        ("alpha", "1"),
        ("beta", "1/3"),
        ("F", "1"),
        ("T", "1"),
    ];
    for (equation, order, count) in PROVED {
        let start = Oscillator::parse(equation).unwrap();
        let known = start.problem().parameters.iter().map(|card| card.name.to_string());
        let known: Vec<String> = known.chain(["eps".to_owned()]).collect();
        let values = values.iter().filter(|(name, _)| known.iter().any(|it| it == name));
        let values: Vec<_> = values.copied().collect();
        let found = ask(equation, &values, &to_order(order));
        let states = &found.states[0];
        assert_eq!(
            (states.count, states.count_proved),
            (count, true),
            "order {order} of {equation}"
        );
        let proved = |state: &State| state.amplitudes.iter().all(|a| a.status == Status::Proved);
        assert!(states.list.iter().all(proved), "order {order} of {equation}");
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

/// The number of positive roots y of y (m^2 + (d - g y)^2) = c: one or, where the discriminant is positive, three, which
/// cannot be negative.
fn roots(m: f64, d: f64, g: f64, c: f64) -> usize {
    // y^3 + p y^2 + q y + r, c > 0.
    let [p, q, r] = [-2.0 * d / g, (m * m + d * d) / (g * g), -c / (g * g)];
    let discriminant =
        18.0 * p * q * r - 4.0 * p.powi(3) * r + p * p * q * q - 4.0 * q.powi(3) - 27.0 * r * r;
    if discriminant > 0.0 { 3 } else { 1 }
}

/// The number of positive roots of m^2 + (d - g y)^2 = c + e y.
fn pairs(m: f64, d: f64, g: f64, [c, e]: [f64; 2]) -> usize {
    let [half, last] = [(d * g + e / 2.0) / (g * g), (m * m + d * d - c) / (g * g)];
    let root = (half * half - last).sqrt();
    [half - root, half + root].iter().filter(|y| **y > 0.0).count()
}

/// Numbers of states of order one by hand (Nayfeh and Mook, chapters 4 to 6), w' = c - (m + i d) w + i g |w|^2 w and the like
/// with y = |w|^2, at detunings of either sign.
#[test]
fn numbers_of_states_against_the_response_polynomial() {
    type Count = fn(f64) -> usize;
    let cases: [(&str, Count); 8] = [
        ("x'' + x + eps*(x'/5 + x^3 + x^2/3) = eps*cos((1 + eps*s)*t)/2", |s| {
            roots(0.1, s, 1.5, 1.0 / 64.0)
        }),
        ("x'' + x + eps*(x'/5 + x^3 + x(t - 1)/5) = eps*cos((1 + eps*s)*t)/2", |s| {
            let (sin, cos) = 1f64.sin_cos();
            roots(0.1 - sin / 10.0, s - cos / 10.0, 1.5, 1.0 / 64.0)
        }),
        ("x'' + x + eps*(x'/5 + x^3) = 2*cos((1/3 + eps*s)*t)", |s| {
            let force = 729.0 / 8192.0 * 8.0;
            roots(0.1, 3.0 * s - 243.0 / 256.0 * 4.0, 1.5, force * force)
        }),
        ("x'' + x + eps*(x'/5 + x^3) = 10*cos((3 + eps*s)*t)", |s| {
            let force = 30.0 / 32.0;
            1 + 3 * pairs(0.1, s / 3.0 - 300.0 / 256.0, 1.5, [0.0, force * force])
        }),
        ("x'' + x + eps*(x'/5 + x^3 + x*cos(2*(1 + eps*s)*t)) = 0", |s| {
            1 + 2 * pairs(0.1, s, 1.5, [1.0 / 16.0, 0.0])
        }),
        // Modes with the frequencies 1 and sqrt 3, x = q_1 + q_2, y = q_1 - q_2: the second is damped alone.
        (
            "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*cos((1 + eps*s)*t); y'' + 2*y - x + eps*y'/5",
            |s| roots(0.1, s, 0.75, 1.0 / 64.0),
        ),
        (
            "x'' + x + eps*(x'/5 + x^3 + x*y) = eps*cos((1 + eps*s)*t)/2; y'' + 2*y + eps*(y'/5 + 4*x^2 + y^3)",
            |s| roots(0.1, s, 1.5, 1.0 / 64.0),
        ),
        // A mode that the other one detunes and nothing drives.
        (
            "x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*s)*t)/2; y'' + 16*y + eps*(y'/5 + x^2*y + y^3)",
            |s| roots(0.1, s, 1.5, 1.0 / 64.0),
        ),
    ];
    let mut numbers = std::collections::BTreeSet::new();
    for (equation, count) in cases {
        for (text, s) in [("-1", -1.0), ("1/4", 0.25), ("1", 1.0), ("7/2", 3.5)] {
            let found = ask(equation, &[("eps", "1/10"), ("s", text)], &to_order(1));
            let states = &found.states[0];
            assert!(found.complete && states.count_proved, "{equation} at {text}");
            assert_eq!(states.count, count(s), "{equation} at {text}");
            numbers.insert(states.count);
        }
    }
    assert_eq!(numbers.into_iter().collect::<Vec<_>>(), [1, 3, 5, 7]);
}

/// At eps = 1/2 the truncated series of order two has a thin shell far out on which little of it is left: what the box of order one does
/// not decide is looked for where the orders fall (two states at amplitudes of 3.2, at which they do not, are left out). A flow of order eps^2, and pairs 1:2 and 1:3 of which the terms of highest degree
/// bound nothing, have boxes by the moduli that states can have; the numbers of states are those of a box given by hand, and by
/// hand (Nayfeh and Mook, section 6.5): beside w_1 = 0 with |w_2| = F/(8 |mu + i s|) a pair with |w_2| = 2 |mu + i s/2|.
#[test]
fn boxes_where_order_one_bounds_nothing() {
    let pair = "x'' + 5*x - 4*y + eps*(x'/5 + x^3) = eps*cos((1 + eps/2)*t); \
                y'' + 5*y - 4*x + eps*y'/5 = 0";
    let found = ask(pair, &[("eps", "1/2")], &to_order(2));
    assert_eq!((found.states[0].count, found.states[0].count_proved), (1, true));
    assert!(found.amplitude_limit.value < 3.0, "{:?}", found.amplitude_limit);
    let two =
        "x'' + x + eps*(x'/5 + x*y) = 0; y'' + 4*y + eps*(y'/5 + x^2) = eps*cos((2 + eps/4)*t)";
    let three = "x'' + x + eps*(x'/10 + x^3/3 + x^2*y) = 0; \
                 y'' + 9*y + eps*(y'/10 + x^3) = 2*eps*cos((3 + eps/2)*t)";
    let scaled = "x'' + x + eps*x^2 + eps^2*(x'/5 + x^3) = eps^2*cos((1 + eps^2/2)*t)/2";
    for (equation, order, count) in
        [(two, 1, 3), (two, 2, 3), (three, 1, 7), (scaled, 2, 1), (scaled, 3, 1)]
    {
        let found = ask(equation, &[("eps", "1/10")], &to_order(order));
        let amplitude = (2.0 * found.amplitude_limit.value).to_string();
        let twice =
            Respond { amplitude: Some(Exact::parse(&amplitude).unwrap()), ..to_order(order) };
        for found in [&found, &ask(equation, &[("eps", "1/10")], &twice)] {
            let states = &found.states[0];
            assert_eq!((states.count, states.count_proved), (count, true), "{equation} {order}");
        }
        if equation == two && order == 1 {
            let read =
                |state: &State, k: usize| state.amplitudes[k].decimal.parse::<f64>().unwrap();
            let states = &found.states[0].list;
            // mu = 1/10, s = 1/4; a_j = 2 |w_j|.
            let (alone, coupled) = (0.25 / 0.1f64.hypot(0.25), 4.0 * 0.1f64.hypot(0.125));
            assert!((read(&states[2], 1) - alone).abs() < 1e-9, "{states:?} {alone}");
            assert!(states[..2].iter().all(|state| (read(state, 1) - coupled).abs() < 1e-9));
        }
    }
}

/// Two modes 1:3 in the box of order one, far out in which the truncated series says nothing: the moduli exclude almost all of it. Newton's
/// method with the slow flow itself, from a grid of moduli and phases, finds no other state.
#[test]
fn two_modes_in_the_whole_box() {
    let equation = "x'' + 5*x - 4*y + eps*(x'/5 + x^3) = eps*cos((1 + eps/2)*t); \
                    y'' + 5*y - 4*x + eps*y'/5 = 0";
    let small = Rational::from((1, 10));
    let mut known = Vec::new();
    for (order, most) in [(1, 900), (2, 1500), (3, 1700)] {
        let found = ask(equation, &[("eps", "1/10")], &to_order(order));
        let states = &found.states[0];
        println!("order {order}: {} boxes", states.boxes);
        assert_eq!((states.count, states.count_proved), (3, true), "order {order}");
        assert!(states.boxes < most, "order {order}: {} boxes", states.boxes);
        let read = |text: &str| text.parse::<f64>().unwrap();
        let at = |state: &State| -> Vec<f64> {
            let pairs = state.amplitudes.iter().zip(&state.phases);
            let state = |(a, phi): (&lindstedt::Number, &Option<lindstedt::Number>)| {
                let (sin, cos) = read(&phi.as_ref().unwrap().decimal).sin_cos();
                [cos, sin].map(|part| read(&a.decimal) / 2.0 * part)
            };
            pairs.flat_map(state).collect()
        };
        known = states.list.iter().map(at).collect();
        assert!(found.amplitude_limit.value > 7.9);
    }
    let slow = Oscillator::parse(equation).unwrap().slow_flow(3, &Work::default()).unwrap().value;
    let mode = |j: usize, turn: i64| {
        let term = |amplitudes: Vec<u32>, re: Rational, im: Rational| ComplexTerm {
            amplitudes,
            parameters: Vec::new(),
            re,
            im,
            radius: 0.0,
        };
        let mut terms = Vec::new();
        for (n, order) in slow.flow[j].iter().enumerate().skip(1) {
            let scale = (1..n).fold(Rational::from(1), |scale, _| scale * &small);
            terms.extend(order.iter().map(|t| {
                let amplitudes = t.exponents[..4].iter().map(|e| u32::try_from(*e).unwrap());
                term(amplitudes.collect(), (&t.re * &scale).into(), (&t.im * &scale).into())
            }));
        }
        // z_j = w_j e^{i k eta}, eta' = 1 + eps/2.
        let mut own = vec![0; 4];
        own[2 * j] = 1;
        terms.push(term(own, Rational::new(), Rational::from((-turn, 2))));
        terms
    };
    let system = Flow::of_complex(&[mode(0, 1), mode(1, 3)], &[]).system(&[]);
    let mut reached = [false; 3];
    for index in 0..12 * 3 * 6 * 3 {
        let [r, s] = [0.3 * (1.0 + f64::from(index % 12)), 1.1 * f64::from(index / 12 % 3)];
        let phase =
            |k: i32, n: i32| 0.3 + std::f64::consts::TAU * f64::from(index / k % n) / f64::from(n);
        let [(b, a), (d, c)] = [phase(36, 6), phase(216, 3)].map(f64::sin_cos);
        let Some(zero) = zero_near(&system, &[r * a, r * b, s * c, s * d], &[1e-3; 4]) else {
            continue;
        };
        let at = zero.middle();
        if at.chunks(2).all(|pair| pair[0].hypot(pair[1]) < 3.95) {
            let near = |known: &Vec<f64>| known.iter().zip(&at).all(|(a, b)| (a - b).abs() < 1e-9);
            reached[known.iter().position(near).unwrap()] = true;
        }
    }
    assert_eq!(reached, [true; 3]);
}

fn decimals(numbers: &[lindstedt::Number]) -> Vec<f64> {
    numbers.iter().map(|number| number.decimal.parse().unwrap()).collect()
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
