//! (17): when both roots of the characteristic polynomial lie inside the unit circle.

use crate::{Findings, Row, Section, plain};
use lindstedt::unstable::coeff::quotient::Quotients;
use lindstedt::unstable::impact::linearised::replace;
use rug::Rational;

/// Polynomials of known roots that the condition is tried on.
const SAMPLES: u32 = 20_000;

/// (17) as printed; nothing where a denominator is zero.
fn printed(b2: &Rational, b1: &Rational, b0: &Rational) -> [bool; 2] {
    let below_one = |top: &Rational, bottom: &Rational| {
        !bottom.is_zero() && Rational::from(top / bottom).abs() < 1
    };
    [below_one(b0, b2), below_one(b1, &Rational::from(b0 + b2))]
}

/// The half plane test of Moebius' image, identically in b_2, b_1, b_0: with
/// gamma = (1 + w)/(1 - w),
/// (1 - w)^2 P(gamma) = P(-1) w^2 + 2 (b_2 - b_0) w + P(1).
fn moebius_identity() -> Option<bool> {
    let q = Quotients::new(&["b2", "b1", "b0", "w", "g"], &[]);
    let p = |name: &str| q.parameter(name);
    let [b2, b1, b0, w] = ["b2", "b1", "b0", "w"].map(p);
    let (plus, minus) = (q.add(&q.integer(1), &w), q.sub(&q.integer(1), &w));
    let left = q.sum(&[
        &q.product(&[&b2, &plus, &plus]),
        &q.product(&[&b1, &plus, &minus]),
        &q.product(&[&b0, &minus, &minus]),
    ]);
    let polynomial = q.sum(&[&q.product(&[&b2, &p("g"), &p("g")]), &q.mul(&b1, &p("g")), &b0]);
    let at = |n: i64| replace(&q, &polynomial, &[("g", q.integer(n))]);
    let (at_minus, at_one) = (at(-1)?, at(1)?);
    let middle = q.product(&[&q.integer(2), &q.sub(&b2, &b0), &w]);
    let right = q.sum(&[&q.product(&[&at_minus, &w, &w]), &middle, &at_one]);
    // (17) for b_2 > 0: P(1) + P(-1) = 2 (b_0 + b_2), P(1) P(-1) = (b_0 + b_2)^2 - b_1^2.
    let sum = q.add(&b0, &b2);
    let added = q.equal(&q.add(&at_one, &at_minus), &q.mul(&q.integer(2), &sum));
    let squares = q.sub(&q.mul(&sum, &sum), &q.mul(&b1, &b1));
    let multiplied = q.equal(&q.mul(&at_one, &at_minus), &squares);
    Some(q.equal(&left, &right) && added && multiplied)
}

/// Rational numbers that look random and are the same in every run.
struct Points(u64);

impl Points {
    fn signed(&mut self) -> Rational {
        let mut next = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            i32::try_from((self.0 >> 33) % 61).unwrap_or(0)
        };
        Rational::from((next() - 30, next() % 40 + 1))
    }
}

/// How the printed conditions and the roots agree on polynomials made from their roots: the
/// number of disagreements of both together, of the first alone, of the second alone.
fn trials() -> [u32; 3] {
    let mut points = Points(17);
    let mut wrong = [0; 3];
    for n in 0..SAMPLES {
        let [scale, x, y] = std::array::from_fn(|_| points.signed());
        if scale.is_zero() {
            continue;
        }
        let square = |x: &Rational| Rational::from(x.square_ref());
        // Two real roots x, y, or the pair x +- i y.
        let (trace, determinant, inside) = if n % 2 == 0 {
            let inside = square(&x) < 1 && square(&y) < 1;
            (Rational::from(&x + &y), Rational::from(&x * &y), inside)
        } else {
            let modulus = square(&x) + square(&y);
            (Rational::from(&x * 2u32), modulus.clone(), modulus < 1)
        };
        let b1 = -trace * &scale;
        let b0 = determinant * &scale;
        let [first, second] = printed(&scale, &b1, &b0);
        for (count, says) in wrong.iter_mut().zip([first && second, first, second]) {
            *count += u32::from(says != inside);
        }
    }
    wrong
}

/// (17) and the reference below it.
pub(super) fn rows(section: &Section) -> Vec<Row> {
    let identity = moebius_identity().unwrap_or(false);
    let [both, first, second] = trials();
    let holds = identity && both == 0;
    let reference = {
        // Which numbered formula has b_0, b_1, b_2 on the left: found among the formulas read.
        let found = section.rows.iter().find(|row| row.printed.starts_with("b_0 = "));
        let defining = found.and_then(|row| Some(row.label.split_once(", ")?.1.to_owned()));
        let right = defining.as_deref() == Some("(15)");
        let correction = defining.filter(|_| !right).map(|n| format!("{n} in the place of (15)"));
        Findings { holds: right, correction, ..Findings::default() }
    };
    vec![
        plain(
            "(17)",
            "$|b_0/b_2| < 1$ and $|b_1/(b_0 + b_2)| < 1$",
            "$b_2 - b_0$, $P(1)$, $P(-1)$ of one sign, by $gamma = (1 + w)/(1 - w)$ and Hurwitz; (17) says \
             the same since $P(1) + P(-1) = 2 (b_0 + b_2)$, $P(1) P(-1) = (b_0 + b_2)^2 - b_1^2$"
                .to_owned(),
            format!("{SAMPLES} polynomials made from rational roots, exactly: {both} disagreements"),
            holds,
            &format!(
                "necessary and sufficient; each alone fails (on {first} and {second} of the \
                 polynomials). It decides the stability of the map of (8), not of (1)"
            ),
        ),
        Row::new("below (17)",
"taking into account equations (15) it is easy to find parameters that fulfil \
                      (17)",
"$b_2$, $b_1$, $b_0$ as functions of the parameters",
"",
&reference,
reference.correction.clone().unwrap_or_default(),
),
    ]
}
