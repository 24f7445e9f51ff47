//! Equations as people write them, and printing that reads back.

use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use lindstedt_problem_file::{Names, ParseErrorKind, locate, parse_equation, parse_expression};
use proptest::prelude::*;
use rug::Rational;

fn any() -> Names {
    let mut names = Names::any("eps");
    names.formal.insert("S".into());
    names
}

fn printed(text: &str) -> String {
    match parse_equation(text, &any()) {
        Ok(e) => e.print("eps", Style::Text),
        Err(e) => format!("{}..{}: {e} ({})", e.at.start, e.at.end, e.hint()),
    }
}

#[test]
fn equations_as_on_paper() {
    let cases = [
        ("x'' + x + eps*x^3 = 0", "x'' + x + eps*x^3"),
        ("x'' + x + eps x^3", "x'' + x + eps*x^3"),
        ("ẍ + x = ε(1 - x²)ẋ", "x'' + x - eps*(1 - x^2)*x'"),
        ("x'' + x - epsilon (1-x^2)x' = 0", "x'' + x - eps*(1 - x^2)*x'"),
        ("x'' = -x - varepsilon x**3", "x'' + x + eps*x^3"),
        ("x″ + x − ε·x³ = 0", "x'' + x - eps*x^3"),
        ("x'' + ω₀^2 x = 0", "x'' + omega0^2*x"),
        ("x'' + omega_0^2 x = 0", "x'' + omega_0^2*x"),
        ("x''(t) + x(t) + eps x(t)^3 = 0", "x'' + x + eps*x^3"),
        ("x'' + x = eps x(t-T)", "x'' + x - eps*x(t - T)"),
        ("x'' + x = eps x'(t - 2*T)", "x'' + x - eps*x'(t - 2*T)"),
        ("x'' + x + eps*x(t-1/2)^2", "x'' + x + eps*x(t - 1/2)^2"),
        ("x'' + x + eps*x(t - T1 - T2)", "x'' + x + eps*x(t - (T1 + T2))"),
        ("x'' + x (x^2)^delta = 0", "x'' + x*(x^2)^delta"),
        ("x'' + 2x/3 + 0.1x' = 2.5e-3", "x'' + 2*x*1/3 + 1/10*x' - 1/400"),
        ("x'' + 1/3 x = 0", "x'' + 1/3*x"),
        ("x'' + |x|x + |x - |x'||", "x'' + abs(x)*x + abs(x - abs(x'))"),
        ("x'' + sgn(x') + log(x^2) + sqrt(x^2 + 1)", "x'' + sign(x') + ln(x^2) + (x^2 + 1)^(1/2)"),
        ("x'' + sin x = 0", "x'' + sin(x)"),
        ("x'' + sin(x)^2 + exp(-x)", "x'' + sin(x)^2 + exp(-x)"),
        ("x'' + x - gamma cos(omega t) = 0", "x'' + x - gamma*cos(omega*t)"),
        ("x'' - -x + +x", "x'' + x + x"),
        ("x'' + -x^2", "x'' - x^2"),
        ("x'' + x^-2", "x'' + x^(-2)"),
        ("x'' + x^2^3", "x'' + x^(2^3)"),
        ("x'' + x/(1 + x^2)", "x'' + x*(1 + x^2)^(-1)"),
        ("x'' + x*S(eps*ln(x^2))", "x'' + x*S(eps*ln(x^2))"),
        ("x'' + [x^2 + x](t - T)", "x'' + x(t - T)^2 + x(t - T)"),
        ("x'' + taylor(sin(x), 5)", "x'' + x - 1/6*x^3 + 1/120*x^5"),
        ("x'' + taylor sin x to 3", "x'' + x - 1/6*x^3"),
        ("x'' + taylor(tan(x), 5)", "x'' + x + 1/3*x^3 + 2/15*x^5"),
        ("x'' + taylor(tanh x, 3)", "x'' + x - 1/3*x^3"),
        ("x'' + x taylor(1/(1 + x^2), 2)", "x'' + x*(1 - x^2 + (x^2)^2)"),
        ("x'' + taylor(sqrt(1 + x), 2)", "x'' + 1 + 1/2*x - 1/8*x^2"),
        ("x'' + taylor(ln(1 + eps*x), 2)", "x'' + eps*x - 1/2*(eps*x)^2"),
        ("2x'' + 2x", "2*x'' + 2*x"),
    ];
    for (text, expected) in cases {
        assert_eq!(printed(text), expected, "{text}");
    }
}

#[test]
fn what_has_two_readings_is_refused() {
    for text in ["x'' + 1/2x", "x'' + 1/omega x", "x'' + (x^2 + 1)(t - T)", "x'' + x²^3"] {
        let error = parse_equation(text, &any()).unwrap_err();
        assert!(matches!(error.kind, ParseErrorKind::Ambiguous { .. }), "{text}: {error}");
    }
    for text in ["x'' + sin x^2", "x'' + sin 2x", "x'' + sin omega t", "x'' + sin^2(x)"] {
        let error = parse_equation(text, &any()).unwrap_err();
        assert!(error.to_string().starts_with("expected `(`"), "{text}: {error}");
    }
}

#[test]
fn errors_say_where_and_what_instead() {
    let cases = [
        (
            "x'' + tan(x) = 0",
            "6..9: the function tan is not taken (what would work: sin(x)/cos(x), or taylor(tan(x), 9) for its Taylor polynomial)",
        ),
        ("x'' + x + eps*x^3 = 0 = 1", "22..23: a second `=` (one equation for one unknown x)"),
        (
            "x'' + x(2 t)",
            "6..12: x(2 t) is not x at an earlier time (write x(t - T) for a delay, x*(...) for a product)",
        ),
        (
            "x'' + x(t + T)",
            "6..14: x(t + T) is not x at an earlier time (write x(t - T) for a delay, x*(...) for a product)",
        ),
        ("x'' + (x", "8..8: expected `)`, found the end (close what was opened)"),
        (
            "x'' + x x2 3",
            "11..12: expected an operator or the end, found `3` (a product of two numbers or of a name and a number needs `*`)",
        ),
        ("x''' + x", "1..4: a derivative of order 3 (equations are of second order: x, x', x'')"),
        (
            "y'' + y",
            "1..3: y is no function of time, so it has no derivative (primes belong to x: x', x'')",
        ),
        ("x'' + x/0", "8..9: a division by zero ()"),
        ("x'' + 0^-1", "6..10: a division by zero ()"),
        ("x'' + x; x' = 0", "7..8: ';' has no meaning in an equation (one equation, in one line)"),
    ];
    for (text, expected) in cases {
        assert_eq!(printed(text), expected, "{text}");
    }
    let only = Names::only("eps", ["omega", "k"]);
    let message = |text: &str| {
        let e = parse_equation(text, &only).unwrap_err();
        format!("{e} ({})", e.hint())
    };
    assert_eq!(message("x'' + omga^2 x"), "the name omga is not declared (did you mean omega?)");
    // Not near: every other letter is as near to y as t, and gamma is not omega.
    for name in ["y", "kk", "gamma"] {
        let declare = format!("the name {name} is not declared (declare it: [parameters] {name} =");
        assert!(message(&format!("x'' + {name} x")).starts_with(&declare), "{name}");
    }
    assert_eq!(
        message("x'' + foo(x)"),
        "the function foo is not taken (what would work: sin, cos, exp, ln, abs, sign, sqrt; a product needs `*`)"
    );
}

/// By second derivatives, whichever x' or y' is written before them.
#[test]
fn unknowns_have_the_order_of_their_equations() {
    let of = |list: &[&str]| any().of_system(list.iter().copied()).unknowns;
    assert_eq!(of(&["x'' + 9*x + eps*z'", "y'' + 4*y", "z'' + z"]), ["x", "y", "z"]);
    assert_eq!(of(&["eps*y' + x'' + 4*x", "y'' + 9*y - eps*x'"]), ["x", "y"]);
    assert_eq!(of(&["y'' + x'' + y", "x'' - y'' + x + z'"]), ["y", "x", "z"]);
}

#[test]
fn limits_hold_without_recursion_or_memory() {
    let deep =
        |n: usize, open: &str, close: &str| format!("x'' + {}x{}", open.repeat(n), close.repeat(n));
    for text in [
        deep(100_000, "(", ")"),
        deep(2000, "(", ")"),
        deep(2000, "[", "]"),
        deep(2000, "|", "|"),
        deep(900, "sin(", ")"),
        format!("x'' + x{}", "^x".repeat(2000)),
        "x'' + x^(10^9)".into(),
        "x'' + ((x^1000)^1000)^1000".into(),
        "x'' + 10^(10^9)".into(),
        "x'' + ((9^1000)^1000)^1000".into(),
        "x'' + 1e999999999 x".into(),
        format!("x'' + {} x", "9".repeat(5000)),
        "x'' + taylor(sin(x^100), 99)".into(),
    ] {
        let error = parse_equation(&text, &any()).unwrap_err();
        let shown = &text[..text.len().min(40)];
        assert!(matches!(error.kind, ParseErrorKind::TooLarge { .. }), "{shown}: {error}");
    }
    // x(x(x(... is a product of products; it must not take 2^depth steps.
    assert!(parse_equation(&deep(60, "x(", ")"), &any()).is_ok());
    assert!(parse_equation(&deep(4000, "-", ""), &any()).is_ok());
}

#[test]
fn a_term_is_found_in_its_text() {
    let text = "x'' + x + eps*(x^2 + 3 sin( 2 x )) = 0";
    let part = (2 * Expression::DISPLACEMENT).apply(Function::Sin);
    assert_eq!(&text[locate(text, &any(), &part).unwrap()], "sin( 2 x )");
    assert_eq!(locate(text, &any(), &Expression::VELOCITY), None);
}

/// Trees of every kind of node that has a text.
pub fn tree() -> impl Strategy<Value = Expression> {
    let number = (-20i64..20, 1i64..9).prop_map(|q| Expression::Number(Rational::from(q)));
    let leaf = prop_oneof![
        number,
        Just(Expression::DISPLACEMENT),
        Just(Expression::VELOCITY),
        Just(Expression::ACCELERATION),
        Just(Expression::Time),
        Just(Expression::Small),
        prop_oneof![Just("k"), Just("R_r"), Just("P0"), Just("omega")]
            .prop_map(Expression::parameter),
    ];
    leaf.prop_recursive(5, 40, 4, |inner| {
        let functions = prop_oneof![
            Just(Function::Ln),
            Just(Function::Exp),
            Just(Function::Sin),
            Just(Function::Cos),
            Just(Function::Abs),
            Just(Function::Sign)
        ];
        let list = || prop::collection::vec(inner.clone(), 0..4);
        let delay = prop_oneof![
            Just(Expression::parameter("T")),
            Just(2 * Expression::parameter("T")),
            Just(Expression::Number(Rational::from((1, 2)))),
            Just(Expression::parameter("T") + Expression::parameter("k")),
        ];
        prop_oneof![
            list().prop_map(Expression::Sum),
            list().prop_map(Expression::Product),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| a.pow(b)),
            (functions, inner.clone()).prop_map(|(f, a)| a.apply(f)),
            inner.clone().prop_map(|a| a.formal("S")),
            (inner, delay).prop_map(|(a, d)| a.delayed(d)),
        ]
    })
}

/// Whether the parser refuses the tree for what it is, not for how it is printed.
fn is_refused(e: &Expression) -> bool {
    let bad = |e: &Expression| match e {
        Expression::Power(base, exponent) => exponent.as_number().is_some_and(|n| {
            base.as_number().is_some_and(|q| q.is_zero() && n < 0)
                || Rational::from(n.abs_ref()) > 1000
        }),
        Expression::Unknown(unknown) => unknown.derivative > 1 && unknown.delay.is_some(),
        _ => false,
    };
    e.find(&bad).is_some()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: iterations(2000), max_global_rejects: u32::MAX, rng_seed: seed(), ..ProptestConfig::default() })]

    #[test]
    fn what_is_printed_reads_back_as_the_same_tree(e in tree()) {
        prop_assume!(!is_refused(&e) && !is_refused(&e.canonical()));
        let text = e.print("eps", Style::Text);
        match parse_expression(&text, &any()) {
            Ok(back) => {
                prop_assert_eq!(back.canonical(), e.canonical(), "{}", text);
                // And what was read prints as it stood, up to the sign and number rules.
                let again = back.print("eps", Style::Text);
                let twice = parse_expression(&again, &any()).map(|e| e.canonical());
                prop_assert_eq!(twice, Ok(e.canonical()));
            }
            Err(error) => {
                let large = matches!(error.kind, ParseErrorKind::TooLarge { .. });
                prop_assert!(large, "{}: {}", text, error);
            }
        }
    }

    #[test]
    fn no_text_makes_the_parser_panic(text in "[-x'tekT0-9+*/^()|,=. \\[\\]εω²a-z]{0,60}") {
        let _ = parse_equation(&text, &any());
    }

    #[test]
    fn no_words_make_the_parser_panic(words in prop::collection::vec(prop::sample::select(&WORDS[..]), 0..40)) {
        if let Ok(e) = parse_equation(&words.concat(), &any()) {
            // What is accepted can be printed and read again.
            let text = e.print("eps", Style::Text);
            match parse_expression(&text, &any()) {
                Ok(back) => prop_assert_eq!(back.canonical(), e.canonical(), "{}", text),
                Err(error) => {
                    let large = matches!(error.kind, ParseErrorKind::TooLarge { .. });
                    prop_assert!(large, "{} from {}: {}", text, words.concat(), error);
                }
            }
        }
    }
}

const WORDS: [&str; 36] = [
    "x", "x'", "x''", "t", "(t - T)", "(", ")", "[", "]", "|", "+", "-", "*", "/", "^", "=", " ",
    "eps", "k", "2", "1/3", "0.5", "1e3", "sin", "cos(", "ln(", "abs(", "sign(", "sqrt(",
    "taylor(", ", 3)", "(t-1)", "²", "S(", "^2", "x(",
];

/// The same cases every time, unless it is a long run.
fn seed() -> proptest::test_runner::RngSeed {
    match std::env::var_os("LINDSTEDT_FUZZ") {
        Some(_) => proptest::test_runner::RngSeed::Random,
        None => proptest::test_runner::RngSeed::Fixed(1),
    }
}

/// The number of cases; LINDSTEDT_FUZZ multiplies it for a long run.
fn iterations(normal: u32) -> u32 {
    let factor = std::env::var("LINDSTEDT_FUZZ").ok().and_then(|v| v.parse().ok());
    normal.saturating_mul(factor.unwrap_or(1))
}
