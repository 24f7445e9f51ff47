//! Slow flows against orbits of the full equation.

use super::{ask, to_order};
use lindstedt::grid::Axis;
use lindstedt::unstable::orbit::{Field, Kind, Request, Start, prove};
use lindstedt::{Oscillator, Respond, Verify, Work};
use rug::Rational;

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

/// The response to a strong force is the state of rest: where the orders of its exponents grow, that is said. At eps = 1/5 they are
/// -0.02 +- 0.2032 i (Newton and the monodromy matrix of the equation), and +- 59.3 i at order 2.
#[test]
fn exponents_of_rest_whose_orders_grow_are_doubted() {
    let asked = |force: &str| {
        let equation = "x'' + x + eps*(x'/5 + x^3) = F*cos(t/2)";
        let case = Oscillator::parse(equation).unwrap().set("eps", "1/5").unwrap();
        let case = case.set("F", force).unwrap();
        let answer = case.respond(&to_order(2), &Work::default()).unwrap();
        answer.remarks.iter().any(|it| it.0.contains("an order of the slow flow adds"))
    };
    assert_eq!(["4", "1/10"].map(asked), [true, false]);
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

/// Six resonances in time: N orders of the slow flow leave a remainder of order N + 1.
#[test]
fn remainders_of_six_resonances() {
    for (equation, most) in [
        // Primary, principal parametric, subharmonic 1/3, superharmonic 3, lock-in, one to two.
        ("x'' + x + eps*(3/5*x + 2/7*x' + x^3) = eps*cos(t)/2", 4),
        ("x'' + x + eps*(x'/5 + x^3 + x*cos(2*t)) = 0", 4),
        ("x'' + x + eps*(x^3 + x'/20) = 5*cos((3 + 2*eps)*t)", 4),
        ("x'' + x + eps*(x^3 + x'/5) = cos(t/3)", 4),
        ("x'' + x = eps*(1 - x^2)*x' + eps*cos(t)", 4),
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

/// At a Bogdanov-Takens point of order one the states beside it move by the root of what is left out: by terms of order N - 1/2.
#[test]
fn states_beside_a_fold_lose_half_an_order() {
    let case = Oscillator::parse("x'' + x - eps*(1 - x^2)*x' = eps*cos((1 + eps/4)*t)").unwrap();
    let found = case.verify(&Verify { order: 2, ..Verify::default() }, &Work::default()).unwrap();
    let steady = found.value.steady.unwrap();
    let mut slopes: Vec<f64> = steady.states.iter().map(|it| it.observed_order.unwrap()).collect();
    slopes.sort_by(f64::total_cmp);
    let near =
        slopes.iter().zip([1.5, 1.5, 2.0]).all(|(slope, known)| (slope - known).abs() < 0.05);
    assert!(slopes.len() == 3 && near, "{slopes:?}");
    assert!(steady.reason.contains("order 2 (1 of 3)") && steady.reason.contains("1/2"));
    assert!(steady.reason.starts_with("agrees: "));
}
