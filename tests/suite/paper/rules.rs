//! Rules of verdicts and decimals, and of the page: its notation, cells and labels, and the formulas that are changed in one place.

use lindstedt::unstable::number::ball::Balls;
use lindstedt_paper::rules::{completions, latex, numbers, numeric, parse};
use lindstedt_paper::{Decimal, Findings, Text, Verdict};
use lindstedt_report::{Format, Table as Sheet, mathml};
use rug::Rational;

/// A marked line as HTML.
fn line(text: &str) -> String {
    Format::Html.line(&Text::from(text).line())
}

/// The text of a line of HTML, without its tags.
fn bare(html: &str) -> String {
    let after =
        |part: &str| part.split_once('>').map_or(part.to_owned(), |(_, text)| text.to_owned());
    html.split('<').map(after).collect()
}

fn formulas(text: &str) -> usize {
    line(text).matches("<math>").count()
}

#[test]
fn words_stay_words() {
    for text in [
        "no change of one place makes it hold",
        "neither sufficient (96 points are unstable) nor necessary",
        "the engine's law, sliding in both directions; a minute",
        "0-1 test of the series, 20000 polynomials",
        "close to 0.65 a very slight chaotic behaviour",
    ] {
        assert_eq!(formulas(text), 0, "{}", line(text));
        assert_eq!(bare(&line(text)), text);
    }
}

#[test]
fn formulas_are_found() {
    for (text, count) in [
        ("$x'' + c x' + x + eps x^3 = 0$", 5),
        ("exact, as polynomials in $x$, $x'$, $x(t-T)$", 3),
        ("the printed root is imaginary for $omega > alpha$", 1),
        ("$a = 1$ and b = 2", 1),
    ] {
        assert_eq!(formulas(text), count, "{}", line(text));
    }
    let html = line("a bound, $omega^2 = sin 1$, holds");
    assert!(
        html.starts_with("a bound, <span class=\"g\"><math>") && html.ends_with("</span> holds"),
        "{html}"
    );
    assert!(html.contains("<msup><mi>\u{3c9}</mi><mrow><mn>2</mn></mrow></msup>"), "{html}");
}

#[test]
fn structure() {
    for (text, expected) in [
        (
            "D = C/sin(2*beta*lambda)*(exp(beta*c) - cos(2*beta*lambda))",
            r"D=\frac{C}{\sin (2\,\beta \,\lambda )}\,(\exp (\beta \,c)-\cos (2\,\beta \,\lambda ))",
        ),
        ("b_0/b_2 < 1", r"\frac{b_{0}}{b_{2}}<1"),
        ("v* = 0.4", r"v_{\ast }=0.4"),
        ("R_r*v*sin(t)", r"R_{r}\,v\,\sin (t)"),
        ("z(t)/gamma = 2 pi k/omega", r"\frac{z(t)}{\gamma }=\frac{2\,\pi \,k}{\omega }"),
        ("dx'_+ = -R_r dx'_-", r"\delta x_{+}'=-R_{r}\,\delta x_{-}'"),
        ("da/dt - dx/dt", r"\frac{da}{dt}-\frac{dx}{dt}"),
        ("x = sqrt(2a/b)", r"x=\sqrt{\frac{2a}{b}}"),
        ("S = 1 - 1/3! + x^2/(2k+1)!", r"S=1-\frac{1}{3!}+\frac{x^{2}}{(2k+1)!}"),
        ("lambda = sqrt(alpha^2 - c^2/4)", r"\lambda =\sqrt{\alpha^{2}-\frac{c^{2}}{4}}"),
        ("alpha0 x_0'' T_(l+1)", r"\alpha_{0}\,x_{0}''\,T_{l+1}"),
        ("(a/b)^2 -> 6e-13", r"\left(\frac{a}{b}\right)^{2}\to 6\cdot 10^{-13}"),
    ] {
        assert_eq!(latex(text), expected, "{text}");
    }
}

/// Everything that is read can be drawn, with elements closed in the order in which they were opened.
#[test]
fn elements_are_nested() {
    for text in [
        "z'' + alpha^2 z = eps f",
        "sin phi = (-1/2*(R_r + 1)*[(R_r - 1)*cos(x) + R_r*exp(beta*c))/(F*omega)*v",
        "((( x ]]] ^ _ / * < & > \" ''' -> ... +- a_{b",
        "sum_{k>=1} (-1)^(k-1) sin(2kx)/k^2 - int_0^x ln|cos t| dt",
        "int {gamma v0(t - t0) cos(omega t) - ...} dt",
    ] {
        let drawn = mathml(&latex(text), false);
        assert!(drawn.is_ok(), "{text}: {drawn:?}");
    }
}

#[test]
fn what_is_no_number_is_an_empty_cell() {
    let sheet =
        Sheet::new(["order", "T", "error %"]).row(["1", "none", "-"]).row(["2", "-3", "-0.1"]);
    assert_eq!(numeric(sheet).csv(), "order,T,error %\n1,,\n2,-3,-0.1\n");
}

#[test]
fn numbers_of_labels() {
    assert_eq!(numbers("b_2, (16)"), [16]);
    assert_eq!(numbers("(26), 3"), [26]);
    assert_eq!(numbers("L(2 pi)"), [2u32; 0]);
    assert_eq!(numbers("a(t), psi(t), (7)"), [7]);
}

#[test]
fn formulas_are_read_and_written() {
    for text in ["-a*(b - 2*c)^2/(d*e) + cos(x + phi)", "a/b/c", "exp(-(b*c)) - (-a)"] {
        let tree = parse(text);
        assert_eq!(tree.as_ref().and_then(|t| parse(&t.print())), tree, "{text}");
    }
    for text in ["a +", "(a", "a)", "a b", "2a", "^2", ""] {
        assert!(parse(text).is_none(), "{text}");
    }
    assert_eq!(completions("a*(b - c").len(), 2);
    assert!(completions("a*(b - c)").is_empty());
}

#[test]
fn the_rules() {
    let agrees = Findings { holds: true, ..Findings::default() };
    assert_eq!(agrees.verdict(), Verdict::Agrees);
    let misprint = Findings { correction: Some("sign".into()), ..Findings::default() };
    assert_eq!(misprint.verdict(), Verdict::Misprint);
    let used = Findings { propagates: true, ..misprint };
    assert_eq!(used.verdict(), Verdict::Wrong);
    assert_eq!(
        Findings { reproduced: Some(true), ..Findings::default() }.verdict(),
        Verdict::Wrong
    );
    let lost = Findings { reproduced: Some(false), ..Findings::default() };
    assert_eq!(lost.verdict(), Verdict::NotReproducible);
    assert_eq!(Findings::default().verdict(), Verdict::Wrong);
}

#[test]
fn printed_decimals() {
    let balls = Balls::new(100);
    let value = |n: i32, d: u32| balls.from_rational(&Rational::from((n, d)));
    let shows = |text, n, d| Decimal::new(text).is_some_and(|p| p.shows(&value(n, d)));
    assert!(shows("0.67", 2, 3), "rounded");
    assert!(shows("0.66", 2, 3), "cut off");
    assert!(!shows("0.68", 2, 3) && !shows("0.65", 2, 3));
    let correct = |text, n, d| Decimal::new(text).and_then(|p| p.correct(&value(n, d)));
    assert_eq!(correct("0.05", 2, 33).as_deref(), Some("0.06"));
    assert_eq!(correct("12.50", 9999, 1000).as_deref(), Some("10.00"));
    assert_eq!(correct("8", 17, 2).as_deref(), Some("9"));
    let wide = balls.hull(&value(84, 10), &value(86, 10));
    let neither = Decimal::new("8").and_then(|p| p.correct(&wide));
    assert_eq!(neither, None, "the ends of the ball round to different sides");
    assert!(Decimal::new("pi").is_none());
    let one_digit = Decimal::new("7.4164").map(|p| p.compare(&value(74163, 10_000)));
    let last =
        |f: &Findings| f.correction.as_ref().is_some_and(|words| words.contains("last digit"));
    assert!(one_digit.is_some_and(|f| !f.holds && last(&f)));
    let two_digits = Decimal::new("7.51").map(|p| p.compare(&value(742, 100)));
    assert!(two_digits.is_some_and(|f| !f.holds && f.correction.is_none()));
}
