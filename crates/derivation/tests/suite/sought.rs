//! The edges of the tongues of Mathieu's equation against its three-term recurrence.

#![allow(clippy::unwrap_used, clippy::panic)]

use lindstedt_algebra::Rationals;
use lindstedt_coeff::print::Style;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Sought, sought};
use lindstedt_number::Exact;
use lindstedt_problem_file::ProblemFile;
use lindstedt_series::Series;
use rug::Rational;

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
    let series = |b: &lindstedt_derivation::resonance::SoughtBranch| {
        b.series.iter().map(coefficient).collect()
    };
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

/// The squares in a refusal are numbers, not multiples of the root that frequencies are counted in.
#[test]
fn a_frequency_that_is_a_root_is_refused_with_its_square() {
    let text = "equation = \"x'' + 8*x + eps*m*x - eps*x*cos(2*sqrt(8)*t)\"\n[parameters]\nm = { value = \"0\" }";
    let problem = ProblemFile::parse(text).unwrap().problem;
    let refused = sought(&problem, "m", &AveragingSettings::default(), &mut |_| true);
    let refused = refused.err().unwrap().to_string();
    assert!(refused.contains("the squares are 8"), "{refused}");
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
