//! Forces whose frequency is a number beside irrational frequencies.

use super::{ask, decimals, to_order};
use lindstedt::grid::Axis;
use lindstedt::respond::State;
use lindstedt::unstable::orbit::{Field, Kind, Request, Start, prove};
use lindstedt::{Oscillator, Respond};
use rug::Rational;

const NUMBER: &str = "x'' + 2*x + eps*(x'/5 + x^3) = eps*F*cos(omega*t)";

/// The states are those of the root with the detuning that is left, which is exact arithmetic over Q(sqrt 2), at its
/// resonance, its third and its triple.
#[test]
fn a_number_is_the_root_with_a_detuning() {
    let root = 2f64.sqrt();
    for (multiple, force, omega, own) in [
        ("", "1/2", "3/2", root),
        ("1/3*", "8", "12/25", root / 3.0),
        ("3*", "8", "9/2", 3.0 * root),
    ] {
        let small = ("eps", "1/10");
        // A strong force has a sub- and a superharmonic resonance at order one.
        let equation = NUMBER.replace("eps*F", if multiple.is_empty() { "eps*F" } else { "F" });
        let sigma = format!("{:.17}", 10.0 * (omega_of(omega) - own));
        let exact = equation.replace("omega", &format!("({multiple}sqrt(2) + eps*sigma)"));
        let of = |equation: &str, set| ask(equation, &[small, ("F", force), set], &to_order(3));
        let [number, exact] = [of(&equation, ("omega", omega)), of(&exact, ("sigma", &*sigma))]
            .map(|mut it| it.states.remove(0));
        assert!(number.count_proved && number.count == exact.count, "{omega}: {}", number.count);
        for (a, b) in number.list.iter().zip(&exact.list) {
            let [p, q] = [a, b].map(|state| decimals(&state.amplitudes)[0]);
            assert!((p - q).abs() < 1e-11 && a.stable == b.stable, "{omega}: {p} {q}");
        }
    }
}

fn omega_of(text: &str) -> f64 {
    text.parse::<Rational>().unwrap().to_f64()
}

/// N orders give the first harmonic of the proved orbit to O(eps^N).
#[test]
fn amplitudes_against_proved_orbits() {
    let mut errors = [[0.0f64; 2]; 3];
    // sqrt(2) - eps/2 to six digits.
    for (k, (small, omega)) in [("1/20", "1.389214"), ("1/40", "1.401714")].into_iter().enumerate()
    {
        let problem = Oscillator::parse(NUMBER).unwrap();
        let omega = lindstedt::Exact::parse(omega).unwrap().as_rational().unwrap().clone();
        let values = [
            ("eps", small.parse().unwrap()),
            ("F", "1/2".parse().unwrap()),
            ("omega", omega.clone()),
        ];
        let values = values.map(|(name, value): (_, Rational)| (name.to_owned(), value)).into();
        let field = Field::new(&problem.problem().equation, "eps", &values).unwrap();
        for order in 1..=3 {
            let set = [("eps", small), ("F", "1/2"), ("omega", &*omega.to_string())];
            let found = ask(NUMBER, &set, &to_order(order));
            assert_eq!((found.states[0].count, found.states[0].count_proved), (1, true));
            let state = &found.states[0].list[0];
            let amplitude = decimals(&state.amplitudes)[0];
            let phase: f64 = state.phases[0].as_ref().unwrap().decimal.parse().unwrap();
            let cosines = vec![0.0, amplitude * phase.cos()];
            let sines = vec![0.0, -amplitude * phase.sin()];
            let start = Start { frequency: omega.to_f64(), cosines, sines };
            let proof = prove(&field, &Kind::Forced(1), &start, &Request::default()).unwrap();
            let (cosine, sine) = proof.harmonic(1);
            let truth = cosine.midpoint().to_f64().hypot(sine.midpoint().to_f64());
            errors[order - 1][k] = (amplitude - truth).abs();
        }
    }
    for (order, [a, b]) in (1..).zip(errors) {
        let slope = (a / b).log2();
        println!("order {order}: {a:e} {b:e}, slope {slope:.2}");
        assert!((slope - f64::from(order)).abs() < 0.35, "order {order}: {slope}");
    }
}

/// Modes with the frequencies nu = (sqrt 5 + 1)/2 and (sqrt 5 - 1)/2, of x = q_1 + q_2, y = r_1 q_1 + r_2 q_2 with r = 2 - nu^2: of mode j
/// at order one the share w = 1/(1 + r^2) of force and spring, and the curve ((a/10)^2 + (sigma - 3 w a^2/(8 nu))^2 a^2) =
/// (w F/(2 nu))^2, sigma = (omega - nu)/eps, of which the folds are the zeros of the derivative by a^2.
#[test]
fn folds_of_two_irrational_modes() {
    let equation = "x'' + 2*x - y + eps*(x'/5 + x^3) = eps*F*cos(omega*t); y'' + y - x + eps*y'/5";
    let golden = (5f64.sqrt() + 1.0) / 2.0;
    for (nu, sweep, mode) in
        [(golden, "omega=1.5..1.9:40", 1), (golden - 1.0, "omega=0.5..0.9:40", 0)]
    {
        let sweep = Some(Axis::parse(sweep).unwrap());
        let found =
            ask(equation, &[("eps", "1/10"), ("F", "1")], &Respond { sweep, ..to_order(1) });
        assert!(found.states.iter().all(|states| states.count_proved));
        assert_eq!(found.folds.len(), 2, "{nu}");
        let share = 1.0 / (1.0 + (2.0 - nu * nu).powi(2));
        for fold in &found.folds {
            let at: f64 = fold.value.decimal.parse().unwrap();
            let amplitudes = decimals(&fold.amplitudes);
            let (sigma, s) = (10.0 * (at - nu), amplitudes[mode].powi(2));
            let bend = 3.0 * share / (8.0 * nu);
            let off = sigma - bend * s;
            let curve = (0.01 + off * off) * s - (share / (2.0 * nu)).powi(2);
            let slope = 0.01 + off * off - 2.0 * bend * s * off;
            assert!(curve.abs() < 1e-9 && slope.abs() < 1e-9, "{at} {s}: {curve:e} {slope:e}");
            assert_eq!(amplitudes[1 - mode], 0.0);
        }
    }
}

/// Combinations: rest between nu = 1 and sqrt 2, pumped by h cos(omega t) across, grows at order one with eps (-1/10 + sqrt(h^2/(16 sqrt 2) -
/// sigma^2/4)), sigma = (omega - sqrt 2 -+ 1)/eps, at the sum where both signs of the pump are alike, at the difference where they
/// are not (Nayfeh and Mook, Nonlinear Oscillations, section 5.5).
#[test]
fn combinations_of_irrational_frequencies() {
    let root = 2f64.sqrt();
    for (sign, omega, at) in [("", "12/5", root + 1.0), ("-", "21/50", root - 1.0)] {
        let equation = "x'' + x + eps*(x'/5 + x^3 + y*cos(omega*t)); \
                        y'' + 2*y + eps*(y'/5 + y^3 + (SIGN x)*cos(omega*t))";
        let equation = equation.replace("SIGN ", sign);
        let found = ask(&equation, &[("eps", "1/10"), ("omega", omega)], &to_order(1));
        let rest = |state: &&State| decimals(&state.amplitudes).iter().all(|a| *a == 0.0);
        let state = found.states[0].list.iter().find(rest).unwrap();
        let sigma = 10.0 * (omega_of(omega) - at);
        let known = 0.1 * (-0.1 + (1.0 / (16.0 * root) - sigma * sigma / 4.0).sqrt());
        let grows = state.exponents.iter().map(|[re, _]| re.value).fold(f64::MIN, f64::max);
        assert!((grows - known).abs() < 1e-9, "{omega}: {grows} {known}");
        assert_eq!(state.stable, Some(false));
    }
}
