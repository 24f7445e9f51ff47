//! The result does not depend on how an equation was typed.

use lindstedt::{Derivation, Oscillator, Work};
use lindstedt_tests::Random;

/// numerator/denominator eps^order x^x x'^velocity.
#[derive(Clone, Copy)]
struct Term {
    q: (i64, i64),
    order: u32,
    x: u32,
    velocity: u32,
}

const fn term(q: (i64, i64), order: u32, x: u32, velocity: u32) -> Term {
    Term { q, order, x, velocity }
}

/// Equations as lists of terms beside x''; the factor of x is 1.
const EQUATIONS: [&[Term]; 4] = [
    // Quadratic, cubic, quintic.
    &[term((1, 1), 0, 1, 0), term((2, 3), 1, 2, 0), term((5, 4), 1, 3, 0), term((-1, 7), 2, 5, 0)],
    // Van der Pol with a cubic force.
    &[term((1, 1), 0, 1, 0), term((-1, 1), 1, 0, 1), term((1, 1), 1, 2, 1), term((3, 2), 1, 3, 0)],
    // Rayleigh with a correction of order 2.
    &[term((1, 1), 0, 1, 0), term((-1, 1), 1, 0, 1), term((1, 3), 1, 0, 3), term((2, 5), 2, 3, 0)],
    // A velocity that does no work.
    &[term((1, 1), 0, 1, 0), term((1, 2), 1, 1, 2), term((-3, 1), 1, 3, 0)],
];

fn join(parts: &[String], dice: &mut Random) -> String {
    let mut parts = parts.to_vec();
    for i in (1..parts.len()).rev() {
        parts.swap(i, dice.below(i + 1));
    }
    parts.join(if dice.once_in(2) { "*" } else { " * " })
}

/// base^n in one of its ways.
fn power(base: &str, n: u32, dice: &mut Random) -> Vec<String> {
    match (n, dice.below(4)) {
        (0, _) => Vec::new(),
        (1, _) => vec![base.to_owned()],
        (n, 0) => vec![format!("{base}^{n}")],
        (n, 1) => vec![base.to_owned(); n as usize],
        (n, 2) => [vec![base.to_owned()], power(base, n - 1, dice)].concat(),
        (n, _) => vec![format!("{base}**({} + {})", n - 1, 1)],
    }
}

fn number(n: i64, d: i64, dice: &mut Random) -> String {
    match dice.below(4) {
        0 => format!("({n}/{d})"),
        1 => format!("({}/{})", 3 * n, 3 * d),
        2 => format!("({n})*({d})^(-1)"),
        _ => format!("({} + {n}/{d} - {})", 2, 2),
    }
}

/// A term, with the factor eps^order unless it is taken out, scaled.
fn written(t: Term, scale: (i64, i64), with_order: bool, dice: &mut Random) -> String {
    let mut parts = vec![number(t.q.0 * scale.0, t.q.1 * scale.1, dice)];
    if with_order {
        parts.extend(power("eps", t.order, dice));
    }
    parts.extend(power("x", t.x, dice));
    parts.extend(power("x'", t.velocity, dice));
    join(&parts, dice)
}

/// One way to write an equation.
fn rewrite(terms: &[Term], dice: &mut Random) -> String {
    let scale = [(1, 1), (2, 1), (-3, 1), (1, 2), (5, 7)][dice.below(5)];
    let inner = dice.once_in(2);
    // Scaled inside every term, or around the whole.
    let inside = if inner { scale } else { (1, 1) };
    let mut list: Vec<String> = vec![format!("({}/{}) x''", inside.0, inside.1)];
    let (first, rest): (Vec<Term>, Vec<Term>) =
        terms.iter().partition(|t| t.order == 1 && dice.once_in(2));
    for t in rest {
        if dice.below(4) == 0 {
            // In two halves.
            let half = Term { q: (t.q.0, 2 * t.q.1), ..t };
            list.push(written(half, inside, true, dice));
            list.push(written(half, inside, true, dice));
        } else {
            list.push(written(t, inside, true, dice));
        }
    }
    if !first.is_empty() {
        let factored: Vec<String> =
            first.into_iter().map(|t| written(t, inside, false, dice)).collect();
        let sum = factored.join(" + ");
        list.push(if dice.once_in(2) { format!("eps*({sum})") } else { format!("({sum}) eps") });
    }
    if dice.below(3) == 0 {
        list.push("x^3*x'".into());
        list.push("(-1)*x'*x*x^2".into());
    }
    for i in (1..list.len()).rev() {
        list.swap(i, dice.below(i + 1));
    }
    // Some terms on the right side.
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for t in list {
        if inner && dice.below(3) == 0 { right.push(format!("-({t})")) } else { left.push(t) }
    }
    let side = |list: Vec<String>| if list.is_empty() { "0".to_owned() } else { list.join(" + ") };
    let (left, right) = (side(left), side(right));
    if inner {
        format!("{left} = {right}")
    } else {
        format!("({}/{}) * ({left}) = 0", scale.0, scale.1)
    }
}

fn same(a: &Derivation, b: &Derivation, text: &str) {
    assert_eq!(a.condition, b.condition, "{text}");
    for (mine, yours) in a.series.iter().zip(&b.series) {
        assert_eq!(mine.coefficients, yours.coefficients, "{text}");
    }
    for n in 0..=3 {
        let style = lindstedt::unstable::coeff::print::Style::Text;
        assert_eq!(a.print_solution(n, style), b.print_solution(n, style), "{text}");
    }
}

#[test]
fn two_hundred_rewritings_give_identical_results() {
    let mut dice = Random(20_240_229);
    let mut texts = std::collections::BTreeSet::new();
    for terms in EQUATIONS {
        let plain: Vec<String> = terms
            .iter()
            .map(|t| format!("({}/{})*eps^{}*x^{}*x'^{}", t.q.0, t.q.1, t.order, t.x, t.velocity))
            .collect();
        let plain = Oscillator::parse(&format!("x'' + {}", plain.join(" + "))).unwrap();
        let expected = plain.derive(3, &Work::default()).unwrap().value;
        for _ in 0..50 {
            let text = rewrite(terms, &mut dice);
            let oscillator = Oscillator::parse(&text).unwrap_or_else(|e| panic!("{text}: {e}"));
            // The condition is part of the question, not of the way of writing.
            let oscillator = oscillator.under(plain.problem().conditions[0]).unwrap();
            let result = oscillator
                .derive(3, &Work::default())
                .unwrap_or_else(|e| panic!("{text}: {e}"))
                .value;
            same(&result, &expected, &text);
            texts.insert(text);
        }
    }
    assert!(texts.len() > 195, "{} different texts", texts.len());
}
