//! Formulas in lines of text, and what a page must not have.

use super::summary::numbers;

/// A marked line as HTML.
fn line(text: &str) -> String {
    super::prose::line(&text.into())
}

/// The text of a line of HTML, without its tags.
fn bare(html: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for c in html.chars() {
        match c {
            '<' => inside = true,
            '>' => inside = false,
            c if !inside => text.push(c),
            _ => {}
        }
    }
    text
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
        ("$x'' + x = 0$", 3),
        ("exact, as polynomials in $x$, $x'$, $x(t-T)$", 3),
        ("the printed root is imaginary for $omega > alpha$", 2),
        ("$a = 1$ and b = 2", 2),
    ] {
        assert_eq!(formulas(text), count, "{}", line(text));
    }
    let html = line("a bound, $omega^2 = sin 1$, holds");
    assert!(
        html.starts_with("a bound, <span class=\"g\"><math>") && html.ends_with("</span> holds"),
        "{html}"
    );
    assert!(html.contains("<msup><mi>\u{3c9}</mi><mn>2</mn></msup>"), "{html}");
}

#[test]
fn structure() {
    let html = line("$D = C/sin(2*beta*lambda)*(exp(beta*c) - cos(2*beta*lambda))$");
    assert!(html.contains("<mfrac><mi>C</mi><mrow><mi class=\"f\">sin</mi>"), "{html}");
    let html = line("$b_0/b_2 < 1$");
    assert!(html.contains("<mfrac><msub><mi>b</mi><mn>0</mn></msub><msub>"), "{html}");
    let html = line("$v* = 0.4$ and $R_r*v*sin(t)$");
    assert!(html.contains("<msub><mi>v</mi><mo>\u{2217}</mo></msub>"), "{html}");
    assert!(html.contains("<mi>v</mi><mspace"), "{html}");
    let html = line("$z(t)/gamma = 2 pi k/omega$, $dx'_+ = -R_r dx'_-$");
    assert!(html.contains("<mfrac><mrow><mi>z</mi><mrow>"), "{html}");
    assert!(html.contains("<mfrac><mrow><mn>2</mn><mspace"), "{html}");
    assert!(
        html.contains("<mo>+</mo></msub>") && html.contains("<mo>\u{2212}</mo></msub>"),
        "{html}"
    );
    let html = line("$x = sqrt(2a/b)$");
    assert!(html.contains("<mfrac><mrow><mn>2</mn><mi>a</mi></mrow><mi>b</mi></mfrac>"), "{html}");
    let html = line("$S = 1 - 1/3! + x^2/(2k+1)!$");
    assert!(html.contains("<mfrac><mn>1</mn><mrow><mn>3</mn><mo"), "{html}");
    assert!(
        html.contains("<mo>)</mo></mrow><mo") || html.contains(">!</mo></mrow></mfrac>"),
        "{html}"
    );
    let html = line("$lambda = sqrt(alpha^2 - c^2/4)$");
    assert!(html.contains("<msqrt>") && html.contains("<mfrac><msup>"), "{html}");
    let html = line("$alpha0$ and $x_0''$ and $T_(l+1)$");
    assert!(html.contains("<msub><mi>\u{3b1}</mi><mn>0</mn></msub>"), "{html}");
    let primes = "<msub><mi>x</mi><mn>0</mn></msub><mo lspace=\"0\" rspace=\"0\">\u{2032}</mo>";
    assert!(html.contains(primes), "{html}");
    assert!(html.contains("<msub><mi>T</mi><mrow><mi>l</mi>"), "{html}");
    let html = line("at $n = 3$ ($delta = 1$, on the circle): 6e-13");
    assert_eq!(html.matches("<math>").count(), 4, "{html}");
    assert!(html.contains("10<sup>\u{2212}13</sup>"), "{html}");
}

/// Elements are closed in the order in which they were opened, whatever is read.
#[test]
fn elements_are_nested() {
    for text in [
        "the bracket closes after `*B*[(1 - c/B`; $z'' + alpha^2 z = eps f$",
        "$sin phi = (-1/2*(R_r + 1)*[(R_r - 1)*cos(x) + R_r*exp(beta*c))/(F*omega)*v$",
        "$((( x ]]] ^ _ / * < & > \" ''' -> ... +- a_{b$ and a $mark left open",
        "$sum_{k>=1} (-1)^(k-1) sin(2kx)/k^2 - int_0^x ln|cos t| dt$",
    ] {
        let html = line(text);
        let mut open: Vec<String> = Vec::new();
        for part in html.split('<').skip(1) {
            let tag = part.split('>').next().unwrap_or_default();
            let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
            if tag.starts_with('/') {
                assert_eq!(open.pop().as_deref(), Some(name), "{html}");
            } else if !tag.ends_with('/') {
                open.push(name.to_owned());
            }
        }
        assert!(open.is_empty(), "{open:?} {html}");
    }
}

#[test]
fn numbers_of_labels() {
    assert_eq!(numbers("b_2, (16)"), [16]);
    assert_eq!(numbers("(26), 3"), [26]);
    assert_eq!(numbers("L(2 pi)"), [2u32; 0]);
    assert_eq!(numbers("a(t), psi(t), (7)"), [7]);
}
