//! Delays at resonance and between several unknowns, several phases, irrational modes, against the time domain.

use lindstedt::grid::Axis;
use lindstedt::verify::Verdict;
use lindstedt::{Oscillator, Respond, Verify, Work};

fn case(equation: &str, values: &[(&str, &str)]) -> Oscillator {
    let set = |case: Oscillator, (name, value): &(&str, &str)| case.set(name, value).unwrap();
    values.iter().fold(Oscillator::parse(equation).unwrap(), set)
}

fn slope(case: &Oscillator, order: usize) -> f64 {
    let small = Verify::read_small("1/100,1/200,1/400").unwrap();
    let question = Verify { order, small, ..Verify::default() };
    let found = case.verify(&question, &Work::default()).unwrap().value;
    assert_eq!(found.verdict, Verdict::Agrees);
    found.observed_order.unwrap()
}

/// x_N along the truncated flow, the past included, misses the solution by O(eps^(N + 1)).
#[test]
fn motions() {
    let primary = "x'' + x + eps*(x'/5 + x^3 + k*x(t - T)) = eps*F*cos((1 + eps*sigma)*t)";
    let values = [("k", "1/5"), ("F", "1/2"), ("sigma", "1")];
    let forced = |delay| case(primary, &[&values[..], &[("T", delay)]].concat());
    for order in 1..=3 {
        let found = slope(&forced("1"), order);
        assert!((found - order as f64 - 1.0).abs() < 0.05, "order {order}: {found}");
    }
    for equation in [
        // Internal resonance 1:2 through delayed values.
        "x'' + x + eps*(y(t - 1)*x + x'/10); y'' + 4*y + eps*x(t - 2)^2 = 0",
        // Modes with the frequencies 1 and sqrt 3; a delayed velocity.
        "x'' + 2*x - y + eps*(x^3/2 + y'(t - 1)); y'' + 2*y - x",
        "x'' + x + eps*(x'/5 + y(t - 1)); y'' + 2*y + eps*x^2 = 0",
        // Phases at t = 0 of one force and of several, with detunings of their own.
        "x'' + x + eps*(x'/5 + x^3) = eps*cos(t + 1/2)",
        "x'' + x + eps*(x'/5 + x^3) = eps*(cos(t + 1/2) + x*cos(2*t + 1/3))",
        "x'' + x + eps*(x'/5 + x^3) = eps*(cos((1 + eps)*t + 1/2) + x*cos((2 + 3*eps)*t + 1/3))",
    ] {
        let found = slope(&case(equation, &[]), 2);
        assert!((found - 3.0).abs() < 0.05, "{equation}: {found}");
    }
    let found = slope(&forced("pi"), 2);
    assert!((found - 3.0).abs() < 0.05, "T = pi: {found}");
}

/// N orders of the slow flow give the steady amplitude to O(eps^N): against the equation integrated over 400 periods.
#[test]
fn steady_amplitudes() {
    let equation = "x'' + x + eps*(x' + x^3 + x(t - 1)/5) = eps*cos((1 + eps*sigma)*t)";
    let near = ["49999997/100000000", "49999998/100000000", "49999999/100000000", "1/2"].join(",");
    let ask = |small: &str, order: usize| {
        let sweep = Some(Axis::parse(&format!("sigma={near}")).unwrap());
        let question =
            Respond { sweep, follow: order == 1, order: Some(order), ..Respond::default() };
        case(equation, &[("eps", small)]).respond(&question, &Work::default()).unwrap().value
    };
    let mut errors = [[0.0; 3]; 3];
    for (k, small) in ["1/5", "1/10", "1/20"].into_iter().enumerate() {
        let mut truth = None;
        for order in 1..=3 {
            let found = ask(small, order);
            let read = || found.followed.as_ref()?[0].last()?.amplitudes.as_ref()?.first().copied();
            let truth = *truth.get_or_insert_with(|| read().unwrap().value);
            let state = &found.states.last().unwrap().list[0];
            assert!(found.states.last().unwrap().count_proved);
            let amplitude: f64 = state.amplitudes[0].decimal.parse().unwrap();
            errors[order - 1][k] = (amplitude - truth).abs();
        }
    }
    for (order, [_, b, c]) in (1..).zip(errors) {
        let slope = (b / c).log2();
        assert!((slope - f64::from(order)).abs() < 0.25, "order {order}: {errors:?}");
    }
}

/// Delays 7/4 and 1/3, of which the common unit is small: all five states with proof, amplitudes to O(eps^N) and exponents to
/// O(eps^(N + 1)). The truth is that of harmonic balance of the equation with the odd harmonics to 15 and of Hill's
/// determinant about it, in Python: the larger amplitude and the exponent with a positive imaginary part, the smaller one
/// and the positive exponent.
#[test]
fn delays_of_a_small_common_unit() {
    let equation =
        "x'' + x + eps*(x^3 + x'/10 - x(t - 7/4)/6) = eps*h*x(t - 1/3)*cos((2 + eps*sigma)*t)";
    let truth = [
        ("1/40", [1.0924804838922932, -3.2522469988351e-3, 1.49218117954280e-2]),
        ("1/80", [1.092413204148088, -1.6380855327640e-3, 7.4935701493237e-3]),
    ];
    let small =
        [[0.24464323863617635, 1.4744707839157e-3], [0.2456961909957723, 7.428120224875e-4]];
    for order in 1..=4 {
        let mut errors = [[0.0f64; 2]; 4];
        for (k, ((eps, large), small)) in truth.into_iter().zip(small).enumerate() {
            let case = case(equation, &[("eps", eps), ("h", "1"), ("sigma", "1/2")]);
            let question = Respond { order: Some(order), ..Respond::default() };
            let found = case.respond(&question, &Work::default()).unwrap().value;
            let states = &found.states[0];
            assert_eq!((states.count, states.count_proved), (5, true), "order {order}, {eps}");
            let amplitude = |j: usize| states.list[j].amplitudes[0].decimal.parse::<f64>().unwrap();
            let exponent = |j: usize| states.list[j].exponents[0].map(|part| part.value);
            errors[0][k] = (amplitude(0) - large[0]).abs();
            errors[1][k] = (amplitude(2) - small[0]).abs();
            let [re, im] = exponent(0);
            errors[2][k] = (re - large[1]).hypot(im.abs() - large[2]);
            errors[3][k] = (exponent(2)[0] - small[1]).abs();
        }
        for (k, [a, b]) in errors.into_iter().enumerate() {
            let slope = (a / b).log2() - f64::from(u8::from(k > 1));
            assert!((slope - order as f64).abs() < 0.3, "order {order}: {errors:?}");
        }
    }
}

/// Points of a period; odd.
const POINTS: usize = 15;

/// The first harmonic of the periodic solution of x'' + x + eps (x' + x^3 + x y(t - 1)) = eps cos(w t),
/// y'' + 2 y + eps (y' + 4 x^2 + y^3) = 0, w = 1 + eps/2, by collocation with trigonometric polynomials and Newton's method.
fn collocated(eps: f64, [amplitude, phase]: [f64; 2]) -> f64 {
    let w = 1.0 + eps / 2.0;
    let n = POINTS;
    let at = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let rows = || 0..n;
    // The derivative by w t, and the value at w t - w.
    let slope = |j: usize, k: usize| match j as i32 - k as i32 {
        0 => 0.0,
        d => (if d % 2 == 0 { 0.5 } else { -0.5 }) / ((at(j) - at(k)) / 2.0).sin(),
    };
    let late = |j: usize, k: usize| {
        let s = at(j) - at(k) - w;
        (n as f64 * s / 2.0).sin() / (n as f64 * (s / 2.0).sin())
    };
    let twice = |j: usize, k: usize| rows().map(|l| slope(j, l) * slope(l, k)).sum::<f64>();
    let linear = |square: f64, j: usize, k: usize| {
        let own = if j == k { square } else { 0.0 };
        w * w * twice(j, k) + own + eps * w * slope(j, k)
    };
    let mut z: Vec<f64> = rows().map(|k| amplitude * (at(k) + phase).cos()).collect();
    z.resize(2 * n, 0.0);
    for _ in 0..8 {
        let (x, y) = z.split_at(n);
        let y_late: Vec<f64> = rows().map(|j| rows().map(|k| late(j, k) * y[k]).sum()).collect();
        let mut system = vec![vec![0.0; 2 * n + 1]; 2 * n];
        for j in rows() {
            for k in rows() {
                let own = if j == k { 1.0 } else { 0.0 };
                let [first, second] = [linear(1.0, j, k), linear(2.0, j, k)];
                system[j][k] = first + own * eps * (3.0 * x[j] * x[j] + y_late[j]);
                system[j][n + k] = eps * x[j] * late(j, k);
                system[n + j][k] = own * eps * 8.0 * x[j];
                system[n + j][n + k] = second + own * eps * 3.0 * y[j] * y[j];
                system[j][2 * n] += first * x[k];
                system[n + j][2 * n] += second * y[k];
            }
            system[j][2 * n] += eps * (x[j].powi(3) + x[j] * y_late[j] - at(j).cos());
            system[n + j][2 * n] += eps * (4.0 * x[j] * x[j] + y[j].powi(3));
        }
        z.iter_mut().zip(solved(system)).for_each(|(z, step)| *z -= step);
    }
    let part = |f: fn(f64) -> f64| rows().map(|k| z[k] * f(at(k))).sum::<f64>();
    2.0 / n as f64 * part(f64::cos).hypot(part(f64::sin))
}

/// The solution of a linear system, the last column on the right.
fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|a, b| rows[*a][i].abs().total_cmp(&rows[*b][i].abs())).unwrap();
        rows.swap(i, pivot);
        let row = rows[i].clone();
        for other in rows.iter_mut().enumerate().filter(|(k, _)| *k != i).map(|(_, row)| row) {
            let factor = other[i] / row[i];
            other.iter_mut().zip(&row).for_each(|(a, b)| *a -= factor * b);
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}

/// A mode of the frequency sqrt 2 that the force does not meet and the other one drives, with a delay: N orders of the slow flow
/// give the amplitude of the periodic solution to O(eps^N).
#[test]
fn irrational_modes() {
    let equation = "x'' + x + eps*(x' + x^3 + x*y(t - 1)) = eps*cos((1 + eps/2)*t); \
                    y'' + 2*y + eps*(y' + 4*x^2 + y^3)";
    for order in 1..=3 {
        let error = |text: &str, eps: f64| {
            let question = Respond { order: Some(order), ..Respond::default() };
            let found = case(equation, &[("eps", text)]).respond(&question, &Work::default());
            let found = found.unwrap();
            let states = &found.value.states[0];
            assert_eq!((states.count, states.count_proved), (1, true));
            assert_eq!(found.header.tier, "certified");
            let state = &states.list[0];
            let read = |text: &str| text.parse::<f64>().unwrap();
            let amplitude = read(&state.amplitudes[0].decimal);
            let phase = read(&state.phases[0].as_ref().unwrap().decimal);
            (amplitude - collocated(eps, [amplitude, phase])).abs()
        };
        let [a, b] = [error("1/160", 0.00625), error("1/320", 0.003125)];
        let slope = (a / b).log2();
        println!("order {order}: {a:e} {b:e}, slope {slope:.2}");
        assert!(slope > order as f64 - 0.25, "order {order}: {a:e} {b:e}");
    }
}
