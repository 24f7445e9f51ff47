//! The edges of the tongues of Mathieu's equation against its three-term recurrence.

use crate::delays::{C, add, mul, times};
use lindstedt_algebra::Rationals;
use lindstedt_coeff::print::Style;
use lindstedt_derivation::Progress;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Sought, SoughtBranch, sought};
use lindstedt_number::Exact;
use lindstedt_problem_file::ProblemFile;
use lindstedt_series::Series;
use rug::Rational;
use rug::ops::Pow;

const ORDER: usize = 20;

fn found(equation: &str, start: u32, order: usize) -> Sought {
    let text = format!("equation = {equation:?}\nsmall = \"q\"");
    let problem = ProblemFile::parse(&text).unwrap().problem;
    let parameters = [("a".to_owned(), Exact::Rational(start.into()))].into();
    let settings = AveragingSettings { order, parameters, ..AveragingSettings::default() };
    let found = sought(&problem, "a", &settings, &mut |_| true).unwrap();
    assert!(found.branches.iter().all(|branch| branch.checked_orders == Some(order)));
    found
}

const MATHIEU: &str = "x'' + (a - 2*q*cos(2*t))*x = 0";

fn numbers(found: &Sought) -> Vec<Vec<Rational>> {
    let coefficient = |terms: &Vec<_>| match &terms[..] {
        [] => Rational::new(),
        [single] => {
            let t: &lindstedt_phase::amplitudes::AmplitudeTerm = single;
            t.re.clone()
        }
        _ => panic!("no number"),
    };
    let series = |b: &SoughtBranch| b.series.iter().map(coefficient).collect();
    found.branches.iter().map(series).collect()
}

type Power = Series<Rational>;

fn constant(c: i64) -> Power {
    let mut list = vec![Rational::new(); ORDER + 1];
    list[0] = Rational::from(c);
    Series::truncated(list)
}

/// factor q^n/s.
fn over(n: usize, factor: i64, s: &Power) -> Power {
    let mut power = constant(0);
    let lead = s.coefficients[0].clone();
    power.coefficients[n] = factor / lead.clone();
    power.divided_by(&Rationals, &s.map(|c| Rational::from(c / &lead))).unwrap()
}

/// The recurrence (a - k^2) A_k = q (A_{k-2} + A_{k+2}) from above and from below, as continued fractions: the
/// even solutions end with 2 q^2/a (harmonics 2 k) or with 1 + q, the odd ones with nothing or with 1 - q
/// (DLMF 28.4).
fn edge(m: i64, even: bool) -> Vec<Rational> {
    let minus = |a: &Power, b: &Power| a.add(&Rationals, &b.map(|c| Rational::from(-c)));
    let mut a = constant(m * m);
    for _ in 0..=ORDER / 2 {
        let gap = |k: i64| minus(&a, &constant(k * k));
        let mut upper = gap(m + 2 * (ORDER as i64 / 2 + 1));
        for k in (1..=ORDER as i64 / 2).rev() {
            upper = minus(&gap(m + 2 * k), &over(2, 1, &upper));
        }
        let mut next = constant(m * m).add(&Rationals, &over(2, 1, &upper));
        let mut q = constant(0);
        q.coefficients[1] = Rational::from(if even { 1 } else { -1 });
        // From below.
        let mut lower: Option<Power> = match (m % 2, even) {
            (0, true) => Some(gap(0)),
            (0, false) => None,
            _ => Some(minus(&gap(1), &q)),
        };
        for k in (if m % 2 == 0 { 2..m } else { 3..m }).step_by(2) {
            let factor = if k == 2 { 2 } else { 1 };
            let below = lower.as_ref().map_or_else(|| constant(0), |s| over(2, factor, s));
            lower = Some(minus(&gap(k), &below));
        }
        next = match (m, lower) {
            (1, _) => next.add(&Rationals, &q),
            (_, None) => next,
            (_, Some(s)) => next.add(&Rationals, &over(2, if m == 2 { 2 } else { 1 }, &s)),
        };
        a = next;
    }
    a.coefficients
}

#[test]
fn tongue_edges_to_order_twenty() {
    for m in 1..=4 {
        let derived = numbers(&found(MATHIEU, m * m, ORDER));
        assert_eq!(derived, [edge(m.into(), true), edge(m.into(), false)], "m = {m}");
    }
}

/// DLMF 28.6.2 and 28.6.4, as printed there.
#[test]
fn tongue_edges_as_printed() {
    let first = found(MATHIEU, 1, 8);
    assert_eq!(
        first.print_series(&first.branches[0], Style::Text),
        "1 + q - 1/8*q^2 - 1/64*q^3 - 1/1536*q^4 + 11/36864*q^5 + 49/589824*q^6 + 55/9437184*q^7 - 83/35389440*q^8"
    );
    let second = found(MATHIEU, 4, 8);
    assert_eq!(
        second.print_series(&second.branches[0], Style::Text),
        "4 + 5/12*q^2 - 763/13824*q^4 + 1002401/79626240*q^6 - 1669068401/458647142400*q^8"
    );
}

/// x'' + (a + q cos 3t) x at a = 1: no order chooses a start, which needs no slow flow. DLMF 28.15.1 at nu = 2/3, with q there
/// = -2/9 q and a there = 4/9 a.
#[test]
fn a_linear_equation_away_from_its_tongues() {
    let problem = ProblemFile::parse("equation = \"x'' + (a + eps*cos(3*t))*x = 0\"").unwrap();
    let parameters = [("a".to_owned(), Exact::Rational(1.into()))].into();
    let settings = AveragingSettings { order: 7, parameters, ..AveragingSettings::default() };
    let mut orders = 0;
    let mut observer = |progress| {
        orders += usize::from(matches!(progress, Progress::Order(..)));
        true
    };
    let found = sought(&problem.problem, "a", &settings, &mut observer).unwrap();
    assert_eq!((orders, found.all), (2 * 7, true));
    let nu = Rational::from((4, 9));
    let [one, four, nine] = [1u32, 4, 9].map(|k| nu.clone() - k);
    let cube = Rational::from((&one).pow(3));
    let sixth = (nu.clone() * 9u32 + 58u32) * &nu + 29u32;
    let squares = [
        nu.clone(),
        Rational::from(&one * 2u32).recip(),
        (nu.clone() * 5u32 + 7u32) / (32u32 * cube.clone() * &four),
        sixth / (64u32 * cube * one.square() * four * nine),
    ];
    let mut expected = vec![Rational::new(); 8];
    for (k, c) in squares.into_iter().enumerate() {
        expected[2 * k] = Rational::from((9, 4)) * c * Rational::from((4, 81)).pow(k as u32);
    }
    assert_eq!(numbers(&found), [expected.clone(), expected]);
}

/// x_1 is an order of the motion.
#[test]
fn a_symbol_named_like_an_order_is_refused() {
    let of = |name: &str| {
        let text = format!(
            "equation = \"x'' + (a - eps*{name}*cos(2*t))*x = 0\"\n[parameters]\na = {{ value = \"1\" }}\n{name} = {{}}"
        );
        let problem = ProblemFile::parse(&text).unwrap().problem;
        sought(&problem, "a", &AveragingSettings::default(), &mut |_| true)
    };
    assert!(of("h_1").is_ok());
    let refused = of("x_1").err().unwrap().to_string();
    assert!(refused.starts_with("the answer is written with x_1, a coefficient:"), "{refused}");
}

/// The squares in a refusal are numbers, not multiples of the root that frequencies are counted in; in its time, which the
/// hint asks for, the parameter is found.
#[test]
fn a_frequency_that_is_a_root_is_refused_with_its_square() {
    let text = "equation = \"x'' + 8*x + eps*m*x - eps*x*cos(2*sqrt(8)*t)\"\n[parameters]\nm = { value = \"0\" }";
    let problem = ProblemFile::parse(text).unwrap().problem;
    let refused = sought(&problem, "m", &AveragingSettings::default(), &mut |_| true);
    let refused = refused.err().unwrap().to_string();
    assert!(refused.contains("squares are 8"), "{refused}");
    // s = sqrt(2) t; in 2 s the force is 2 Q cos(4 s) with Q = q/16: 1 + q a/8 = a_1(Q) = 1 + Q - Q^2/8.
    let own = found("x'' + 4*x + q*a*x/2 - q*x*cos(4*t)/2", 0, 2);
    let series: Vec<_> = own.branches.iter().map(|b| own.print_series(b, Style::Text)).collect();
    assert_eq!(series, ["1/2 - 1/256*q", "-1/2 - 1/256*q"]);
}

/// omega^2 = 1 + 3/4 e + 3/128 e^2 of x'' + x + e x^3, with the first harmonic 1, read backwards; with a force the
/// motion of the sine has another a.
#[test]
fn nonlinear_and_symbolic() {
    let free = found("x'' + a*x + q*h*x^3 = 0", 1, 2);
    assert_eq!(free.branches.len(), 1);
    assert_eq!(free.print_series(&free.branches[0], Style::Text), "1 - 3/4*h*q - 3/128*h^2*q^2");
    let forced = found("x'' + a*x + q*h*x^3 + q*k*x*cos(2*t) = 0", 1, 1);
    let lines = forced.branches.iter().map(|b| forced.print_series(b, Style::Text));
    assert_eq!(lines.collect::<Vec<_>>(), ["1 + (-3/4*h - 1/2*k)*q", "1 + (-3/4*h + 1/2*k)*q"]);
}

/// As many motions and coefficients as expected, whatever their order.
#[test]
fn a_shift_of_time_moves_no_edge() {
    for m in [1, 2, 3] {
        let expected = |scale: &Rational| {
            let scaled = |list: Vec<Rational>| {
                let power = |(n, c): (usize, Rational)| c * scale.clone().pow(n as u32);
                list.into_iter().take(9).enumerate().map(power).collect::<Vec<_>>()
            };
            let mut both = [edge(m.into(), true), edge(m.into(), false)].map(scaled);
            both.sort();
            both.to_vec()
        };
        for (force, scale) in [("sin(2*t)", 1), ("3*cos(2*t)+4*sin(2*t)", 5), ("cos(2*t+pi/3)", 1)]
        {
            let found = found(&format!("x'' + (a + q*({force}))*x"), m * m, 8);
            let origins: Vec<_> = found.branches.iter().map(|b| &*b.origin).collect();
            match force {
                "sin(2*t)" if m == 1 => assert_eq!(origins, ["-1/4*pi", "1/4*pi"]),
                "cos(2*t+pi/3)" => assert_eq!(origins, ["-1/6*pi", "-1/6*pi"]),
                _ => {}
            }
            let mut derived = numbers(&found);
            derived.sort();
            assert_eq!(derived, expected(&Rational::from((scale, 2))), "{force}, m = {m}");
        }
    }
}

/// The determinant of the harmonics e^{imt}, m odd, of x'' + d x' + (a + sum_k f_k e^{2ikt}) x; real for f_{-k} = conj f_k.
fn determinant(a: f64, damping: f64, f: &[C]) -> f64 {
    let entry = |i: i32, j: i32| {
        let (m, k) = (f64::from(2 * i - 15), i - j);
        let force = f.get(k.unsigned_abs() as usize).copied().unwrap_or_default();
        let own = if k == 0 { [a - m * m, damping * m] } else { [0.0; 2] };
        times(add(own, [force[0], force[1] * f64::from(k.signum())]), 1.0 / (m * m))
    };
    let mut rows: Vec<Vec<C>> = (0..16).map(|i| (0..16).map(|j| entry(i, j)).collect()).collect();
    let size = |c: C| c[0].hypot(c[1]);
    let mut product = [1.0, 0.0];
    for k in 0..16 {
        let pivot = (k..16).max_by(|i, j| size(rows[*i][k]).total_cmp(&size(rows[*j][k]))).unwrap();
        if pivot != k {
            rows.swap(k, pivot);
            product = times(product, -1.0);
        }
        let lead = rows[k].clone();
        product = mul(product, lead[k]);
        let inverse = times([lead[k][0], -lead[k][1]], size(lead[k]).powi(-2));
        for row in &mut rows[k + 1..] {
            let factor = mul(row[k], times(inverse, -1.0));
            (k..16).for_each(|j| row[j] = add(row[j], mul(factor, lead[j])));
        }
    }
    product[0]
}

/// Motions that turn: at q = 1/16 the determinant vanishes where the series say, up to what is left out.
#[test]
fn edges_of_mixtures_against_the_determinant() {
    let q = 0.0625;
    let third = std::f64::consts::FRAC_PI_3;
    let third = [third.cos() / 2.0, third.sin() / 2.0];
    let cases: [(&str, f64, [[f64; 2]; 3]); 4] = [
        ("q*(cos(2*t)+sin(4*t))*x", 0.0, [[0.0; 2], [0.5, 0.0], [0.0, -0.5]]),
        ("q*cos(2*t)*x + 3/10*q*x'", 0.3, [[0.0; 2], [0.5, 0.0], [0.0; 2]]),
        ("q*(sin(2*t)+cos(4*t))*x", 0.0, [[0.0; 2], [0.0, -0.5], [0.5, 0.0]]),
        ("q*(cos(2*t)+cos(4*t+pi/3))*x", 0.0, [[0.0; 2], [0.5, 0.0], third]),
    ];
    for (force, damping, f) in cases {
        let found = found(&format!("x'' + a*x + {force}"), 1, 8);
        assert_eq!(found.branches.len(), 2, "{force}");
        for branch in &found.branches {
            let value = |terms: &Vec<lindstedt_phase::amplitudes::AmplitudeTerm>| {
                let value = |t: &lindstedt_phase::amplitudes::AmplitudeTerm| {
                    let [_, _, _, symbols @ ..] = &t.exponents[..] else { panic!("exponents") };
                    let names = found.symbols.iter().zip(symbols);
                    let number = |(name, n): (&String, &i32)| {
                        let part = if name.starts_with("cos") { third[0] } else { third[1] };
                        (2.0 * part).powi(*n)
                    };
                    t.re.to_f64() * names.map(number).product::<f64>()
                };
                terms.iter().map(value).sum::<f64>()
            };
            let a: f64 = branch.series.iter().rev().fold(0.0, |sum, terms| sum * q + value(terms));
            let at = |a: f64| determinant(a, damping * q, &f.map(|c| c.map(|part| part * q)));
            let step = 1e-6;
            let slope = (at(a + step) - at(a - step)) / (2.0 * step);
            let error = at(a) / slope;
            assert!(error.abs() < 1e-11, "{force}: {a} is off by {error}");
        }
    }
}

/// The edges start with cos 2t -+ sin 2t, of which no rational multiple has the amplitude 1: in a linear equation any has. With
/// -t for t they change places, and eps its sign.
#[test]
fn rational_directions_of_linear_equations() {
    let found = found("x'' + (a + q*(sin(2*t) + 2/5*sin(4*t)))*x", 4, 2);
    let starts: Vec<_> = found.branches.iter().map(SoughtBranch::starts_with).collect();
    assert_eq!((found.all, starts), (true, vec!["cos - sin".to_owned(), "cos + sin".to_owned()]));
    let edge = |sign: i32| vec![4.into(), Rational::from((sign, 5)), Rational::from((97, 2400))];
    assert_eq!(numbers(&found), [edge(1), edge(-1)]);
}

/// What has no series is refused with the order, and with numbers where there are some.
#[test]
fn mixtures_that_are_not_rational() {
    let refused = |equation: &str, start: u32| {
        let problem = ProblemFile::parse(&format!("equation = {equation:?}")).unwrap().problem;
        let parameters = [("a".to_owned(), Exact::Rational(start.into()))].into();
        let settings = AveragingSettings { order: 3, parameters, ..AveragingSettings::default() };
        sought(&problem, "a", &settings, &mut |_| true).unwrap_err().to_string()
    };
    let text = refused("x'' + (a + eps*cos(2*t))*x + eps*x'/5", 1);
    assert!(text.ends_with("a_1 = -0.458258, 0.458258"), "{text}");
    let text = refused("x'' + (a + eps*(sin(2*t) + 2/5*sin(4*t)))*x + eps^2*x^3", 4);
    assert!(text.ends_with("a_1 = 0.200000, -0.200000"), "{text}");
    // Sought from damping that the force does not make good: none.
    let text = refused("x'' + (a + eps*cos(2*t))*x + 3/5*eps*x'", 1);
    assert!(text.contains("no value"), "{text}");
    let text = refused("x'' + (a + eps*(k*cos(2*t)+sin(4*t)))*x", 1);
    assert!(text.contains("below the line"), "{text}");
}

/// a_1 z + 2 zbar = 1/2 at z = e^{i theta}/2 asks for sin theta (4 cos theta - 1) = 0: two roots more than what is
/// tried, and it is told.
#[test]
fn several_harmonics_of_the_start() {
    let found = found("x'' + (a + q*4*cos(2*t))*x - q*cos(t)", 1, 2);
    let starts: Vec<_> = found.branches.iter().map(SoughtBranch::starts_with).collect();
    assert_eq!((found.all, starts), (false, vec!["cos".to_owned(), "-cos".to_owned()]));
}

/// s = -omega_2 of x'' + x + e (x^3 + s x), and the amplitude of a force, which order zero does not know.
#[test]
fn a_parameter_that_order_zero_does_not_know() {
    let problem =
        |equation: &str| ProblemFile::parse(&format!("equation = {equation:?}")).unwrap().problem;
    let settings = AveragingSettings { order: 3, ..AveragingSettings::default() };
    let series = |equation: &str, name: &str| -> Vec<String> {
        let found = sought(&problem(equation), name, &settings, &mut |_| true).unwrap();
        found.branches.iter().map(|b| found.print_series(b, Style::Text)).collect()
    };
    assert_eq!(series("x'' + x + eps*(x^3 + s*x)", "s"), ["-3/4 - 3/128*eps - 15/4096*eps^2"]);
    let force = series("x'' + x + eps*(x^3 - F*cos(t))", "F");
    assert_eq!(force, ["3/4 + 3/128*eps + 3/512*eps^2", "-3/4 - 3/128*eps - 3/512*eps^2"]);
}
