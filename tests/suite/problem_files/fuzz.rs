//! From any file to an expansion of order 2 or a refusal: no panic, no runaway.
//!
//! The ordinary run is short. A long one: `LINDSTEDT_FUZZ=<cases> cargo test --release -p
//! lindstedt-tests problem_files::fuzz -- --ignored`. What it finds is added to `CORPUS`.

use lindstedt::unstable::equation::classify::Reason;
use lindstedt::{
    Error, ProblemFile, Progress, unstable::derivation::Settings, unstable::derivation::derive,
    unstable::derivation::known_values,
};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Inputs that were once interesting: each must end in an answer or an error.
const CORPUS: [&str; 18] = [
    "x'' + x + x''*k*k + eps*x",
    "x'' + x + eps*exp(eps)*x*x + 2*1/3*x^2 - k*x^2",
    "x'' + x + eps*x'*eps*eps + eps*x",
    "x'' + x + eps*x*x*exp(eps*x) + eps*k",
    "x'' + x + eps*x*x*cos(k*t) - x",
    "x'' + x + eps*0*x*x^(-1) - 1/3*eps*taylor(sin(x), 3)",
    "x'' + x + eps*x^0 = 0",
    "x'' + 0*x + eps*x^3 = 0",
    "x'' + x + eps*0*x'^3 = 0",
    "x'' + x + eps^2*x^3 = 0",
    "x'' + x + eps*(x' - x') = 0",
    "x'' - x'' + x'' + x = eps",
    "x'' + x*(1 + eps)^40 = 0",
    "x'' + x + eps*x(t - 0)^3 = 0",
    "x'' + x + eps*(x^2)^(eps) = 0",
    "x'' + x*exp(eps*ln(x^2)) = 0",
    "x'' + (x^2)^(eps)*x*(x^2)^(-eps) = 0",
    "x'' + x + eps*ln(x^2)^9*x = 0",
];

/// Everything that happens to a file.
fn run(text: &str) -> Result<(), Error> {
    let file = ProblemFile::parse(text)?;
    let again = ProblemFile::parse(&file.to_text());
    match again {
        Ok(again) => assert_eq!(
            again.problem.equation.canonical(),
            file.problem.equation.canonical(),
            "{text}"
        ),
        Err(error) => assert!(error.is_limit(), "{text}: {error}\n{}", file.to_text()),
    }
    let values = known_values(&file.problem, &BTreeMap::new());
    let parts = lindstedt::unstable::equation::classify::classify(&file.problem, &values);
    let settings = Settings { order: 2, memory: 64 << 20, ..Settings::default() };
    // The work is bounded by the primes and orders it may take.
    let mut steps = 0;
    let result = derive(&file.problem, &settings, &mut |_: Progress| {
        steps += 1;
        steps < 60
    })?;
    assert!(result.checked_orders.is_some() || result.order == 0);
    if let Ok(parts) = parts {
        // What the driver derives, the classification did not refuse; a drift may come later than
        // at order 2.
        let mut against = parts.methods[0].1.iter().filter(|r| !matches!(r, Reason::Drift(_)));
        assert!(against.next().is_none(), "{text}: {:?}", parts.methods[0]);
    }
    Ok(())
}

fn file(equation: &str, condition: &str) -> String {
    let condition =
        if condition.is_empty() { String::new() } else { format!("condition = \"{condition}\"\n") };
    format!(
        "name = \"fuzz\"\nequation = '''{equation}'''\n{condition}[parameters]\nk = {{ value = \"2/3\" }}\n\
         T = {{ value = \"1\" }}\namplitude = {{ value = \"1/2\" }}\n"
    )
}

#[test]
fn the_corpus_ends_in_answers_or_errors() {
    for equation in CORPUS {
        for condition in
            ["", "initial-amplitude", "fundamental-amplitude", "limit-cycle", "free-amplitude"]
        {
            let _ = run(&file(equation, condition));
        }
    }
}

/// A factor, a term, an equation: often expandable, often not.
fn factor() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => prop::sample::select(&["x", "x^2", "x^3", "x'", "x'^2", "x'^3", "k", "2", "1/3", "0.5", "(1 - x^2)", "(x + x')", "eps"][..])
            .prop_map(String::from),
        1 => prop::sample::select(&[
            "(x^2)^eps", "ln(x^2)", "exp(eps)", "sin(x)", "abs(x)", "sign(x)", "|x|^(1 + 2*eps)", "x(t - T)", "cos(k*t)",
            "x^(-1)", "(1 + x)^(-1)", "taylor(sin(x), 3)", "exp(eps*x)", "sqrt(x^2 + 1)", "x''", "t", "x^k", "(x^2)^k", "0",
        ][..]).prop_map(String::from),
    ]
}

fn equation() -> impl Strategy<Value = String> {
    let term = (prop::bool::ANY, prop::collection::vec(factor(), 1..4));
    let term = term.prop_map(|(weak, factors)| {
        format!("{}{}", if weak { "eps*" } else { "" }, factors.join("*"))
    });
    let linear = prop::sample::select(
        &[
            "x'' + x", "x'' + x", "x'' + x", "2*x'' + 8*x", "x'' + 2*x", "x''", "x + k*x''",
            "x'' - x",
        ][..],
    );
    let sign = prop::sample::select(&[" + ", " - ", " = "][..]);
    let weak = prop::sample::select(&[" + eps*", " - eps*", " + ", " - k*eps*"][..]);
    (linear, prop::collection::vec((weak, factor(), factor(), factor()), 1..4), sign, term)
        .prop_map(|(linear, list, sign, term)| {
            let mut text = linear.to_owned();
            for (weak, a, b, c) in list {
                text += &format!("{weak}{a}*{b}*{c}");
            }
            format!("{text}{sign}{term}")
        })
}

const CONDITIONS: [&str; 5] =
    ["", "initial-amplitude", "fundamental-amplitude", "limit-cycle", "free-amplitude"];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn any_equation_ends_in_an_answer_or_an_error(
        equation in equation(),
        condition in prop::sample::select(&CONDITIONS[..]),
    ) {
        let _ = run(&file(&equation, condition));
    }
}

/// The number of cases of a long run.
fn long() -> u32 {
    std::env::var("LINDSTEDT_FUZZ").ok().and_then(|v| v.parse().ok()).unwrap_or(1000)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: long(), max_shrink_iters: 2000, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "a long run, see the head of the file"]
    fn fuzz_for_long(equation in equation(), condition in prop::sample::select(&CONDITIONS[..])) {
        let _ = run(&file(&equation, condition));
    }
}
