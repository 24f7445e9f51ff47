//! Section 3, the formulas (22)-(27) and the numbers of its text.

use super::printed::{COMPARED_AT, PrintedForm, printed_forms};
use super::{Decimal, Reader, Row, Section, plain, show};
use crate::oscillator::{oscillator, section_three};
use lindstedt::{DerivationError, Error};
use lindstedt_melnikov::{
    Branch, Friction, MelnikovError, PolynomialFriction, StickSlip, quadrature_dissipation,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// Digits of the numbers of the text.
const DIGITS: usize = 20;
/// Bits of the quadratures.
const QUADRATURE_BITS: u32 = 100;

/// The error of the other crate as one of this.
pub(super) fn failed(error: MelnikovError) -> Error {
    match error {
        MelnikovError::Undecided { bits } => {
            DerivationError::NotEnoughBits { bits, best: None }.into()
        }
        _ => Error::NoValue,
    }
}

/// Reads the formulas: every comparison with a quadrature or a derivative becomes a row.
pub(super) fn read_formulas(_: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let list = printed_forms().map_err(failed)?;
    let quadrature = list.iter().find(|c| c.equation == "(24)").and_then(|c| c.printed_value);
    for (index, comparison) in list.iter().enumerate() {
        let of_this = |c: &&PrintedForm| c.equation == comparison.equation;
        let before = list[..index].iter().filter(of_this).count();
        let label = match list.iter().filter(of_this).count() {
            0 | 1 => comparison.equation.to_owned(),
            _ => format!("{}, {}", comparison.equation, before + 1),
        };
        section.rows.push(row(label, comparison, quadrature));
    }
    Ok(true)
}

/// A comparison as a row. A double has 15 digits; nine were compared.
fn row(label: String, comparison: &PrintedForm, quadrature: Option<f64>) -> Row {
    let estimate = |x: f64| format!("{x:.9} (estimated)");
    let derived = comparison.derived_value;
    let independent = match comparison.equation {
        "(22)" | "(23)" => "the derivative of $x_0$ by differences".to_owned(),
        _ if quadrature.is_some_and(|q| (q - derived).abs() < 1e-9) => {
            quadrature.map_or_else(String::new, |q| format!("quadrature of (24): {}", estimate(q)))
        }
        _ => String::new(),
    };
    let findings = &comparison.findings;
    let gives = match comparison.printed_value {
        Some(_) if findings.holds => "as printed it gives the same".to_owned(),
        Some(value) => format!("as printed it gives {}", estimate(value)),
        None => "as printed it has no real value".to_owned(),
    };
    Row::new(
        label,
        comparison.printed,
        estimate(derived),
        independent,
        findings,
        if comparison.printed.contains("$b = 5$") {
            format!("{gives}; {}", comparison.correct)
        } else if comparison.printed.contains("at $v* =") {
            let others = COMPARED_AT.replace("$v* = 0.5$, ", "");
            format!("{gives}; {}; at this $v*$ and {others}", comparison.correct)
        } else {
            format!("{gives}; {}; at {COMPARED_AT}", comparison.correct)
        },
    )
}

/// D by quadrature, as an estimate.
fn work(oscillator: &StickSlip) -> Result<rug::Float, Error> {
    let law = PolynomialFriction::cubic(
        oscillator.dry.clone(),
        &oscillator.alpha,
        oscillator.beta.clone(),
    );
    let estimate = quadrature_dissipation(
        QUADRATURE_BITS,
        &oscillator.potential(),
        &Friction::Polynomial(law),
        Branch::Positive,
        &oscillator.belt_speed,
    );
    Ok(estimate.map_err(failed)?.value)
}

/// Reads the numbers of the text.
pub(super) fn read_numbers(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let balls = reader.balls;
    section.rows.push(threshold(balls)?);
    let zeros = oscillator(5, Exact::from(0)).zeros(balls).map_err(failed)?;
    let printed = ["0.310429", "0.557204"];
    for (index, text) in printed.into_iter().enumerate() {
        section.rows.push(zero(text, zeros.get(index), zeros.len(), balls)?);
    }
    section.rows.push(cusps(&printed, balls)?);
    section.rows.push(touching(balls).ok_or(Error::NoValue)?);
    Ok(true)
}

/// gamma_c = 0.65.
fn threshold(balls: Balls) -> Result<Row, Error> {
    let paper = section_three();
    let value = balls.abs(&paper.signed_threshold(balls).ok_or(Error::NoValue)?);
    let printed = Decimal::new("0.65").ok_or(Error::NoValue)?;
    let system = paper.system().map_err(failed)?;
    let forcing = system.threshold(balls, Branch::Positive).map_err(failed)?.forcing;
    let second = rug::Float::with_val(QUADRATURE_BITS, work(&paper)? / forcing.midpoint());
    let sources = sources(&paper, &value, balls)?;
    let source = sources.iter().find(|(_, value)| printed.shows(value));
    let mut findings = printed.compare(&value);
    findings.reproduced = Some(source.is_some());
    // A slip of one digit is made once. The text repeats this number: "closely to gamma_c = 0.65".
    let digit = findings.correction.take();
    Ok(Row::new(
        "$gamma_c$",
        "$a = b = 1$, $alpha = beta = T0 = 0.3$, $omega = 2$, $v* = 0.4$: $gamma_c = 0.65$, printed \
                  twice",
        format!("$gamma_c = {}$", show(&value, DIGITS)),
        format!(
            "$D$ by quadrature: {} (estimated)",
            show(&balls.from_parts(&second, &rug::Float::new(53)), DIGITS)
        ),
        &findings,
        format!(
            "0.65 is {}; {}; near $v* = 0.4$ the curve is flat, its smooth extrema are {}",
            source.map_or_else(
                || {
                    let tried: Vec<&str> = sources.iter().map(|(name, _)| *name).collect();
                    format!("given by none of the formulas tried: {}", tried.join("; "))
                },
                |(name, _)| (*name).to_owned()
            ),
            digit.map_or_else(
                || "more than one digit differs".to_owned(),
                |digit| format!("{digit}, but such a slip is not made twice")
            ),
            extremes(&paper, balls)?.join(" and ")
        ),
    ))
}

/// What else might be meant: a term left out of (27). At a = b = 1 the factors that are misprinted
/// in (26) and (27) are all 1.
fn sources(
    paper: &StickSlip,
    value: &Ball,
    balls: Balls,
) -> Result<Vec<(&'static str, Ball)>, Error> {
    let (none, rest) = (Exact::from(0), || paper.clone());
    let without = [
        ("(27) without $T0$", StickSlip { dry: none.clone(), ..rest() }),
        ("(27) without $alpha$", StickSlip { alpha: none.clone(), ..rest() }),
        ("(27) without $beta$", StickSlip { beta: none, ..rest() }),
    ];
    let quartic =
        ("(25) as printed, without the $beta sech^4 tanh^4$ term", without_quartic(balls));
    let parts = without.map(|(name, case)| (name, case.signed_threshold(balls)));
    let mut list = vec![("(27)", value.clone())];
    for (name, part) in [quartic].into_iter().chain(parts) {
        list.push((name, balls.abs(&part.ok_or(Error::NoValue)?)));
    }
    Ok(list)
}

/// The smooth extrema of the threshold over v*.
fn extremes(paper: &StickSlip, balls: Balls) -> Result<Vec<String>, Error> {
    let value = |v: &Ball| {
        let belt_speed = Exact::from(v.midpoint().to_rational()?);
        let there = StickSlip { belt_speed, ..paper.clone() };
        Some(show(&there.signed_threshold(balls)?, 6))
    };
    let stationary = paper.stationary_points(balls).map_err(failed)?;
    stationary.iter().map(value).collect::<Option<_>>().ok_or(Error::NoValue)
}

/// The threshold of the paper's point without the part (32/35) beta V^3 of G: what (25) leaves
/// out. The derived value is linear in the dry, alpha and beta terms; at v* = 0 beta has this part
/// alone.
fn without_quartic(balls: Balls) -> Option<Ball> {
    let paper = section_three();
    let none = || Exact::from(0);
    let quartic = StickSlip { dry: none(), alpha: none(), belt_speed: none(), ..paper.clone() };
    Some(balls.sub(&paper.signed_threshold(balls)?, &quartic.signed_threshold(balls)?))
}

/// A printed zero at b = 5.
fn zero(text: &'static str, zero: Option<&Ball>, count: usize, balls: Balls) -> Result<Row, Error> {
    let printed = Decimal::new(text).ok_or(Error::NoValue)?;
    let zero = zero.ok_or(Error::NoValue)?;
    let near = Rational::from((1, 1_000_000));
    let sides = [
        work(&oscillator(5, Exact::from(Rational::from(printed.value() - &near))))?,
        work(&oscillator(5, Exact::from(Rational::from(printed.value() + &near))))?,
    ];
    let mut findings = printed.compare(zero);
    findings.holds &= sides[0].is_sign_negative() != sides[1].is_sign_negative();
    let residual = oscillator(5, Exact::from(printed.value().clone())).g(balls);
    let shown = |x: &rug::Float| x.to_string_radix(10, Some(3));
    Ok(Row::new(
        format!("$v* = {text}$"),
        format!("$b = 5$: $gamma = 0$ at $v* = {text}$"),
        format!("$v* = {}$", show(zero, DIGITS)),
        format!(
            "$D$ by quadrature at the printed value -+ 1e-6: {} and {} (estimated)",
            shown(&sides[0]),
            shown(&sides[1])
        ),
        &findings,
        format!(
            "$G$ there is {}; (27) has {count} zeros in $v* >= 0$, and the list is complete",
            residual.map_or_else(|| "?".to_owned(), |g| show(&g, 3))
        ),
    ))
}

/// "Two cusps": whether the slopes on both sides of a place differ.
fn cusps(printed: &[&'static str; 2], balls: Balls) -> Result<Row, Error> {
    let five = |v: Rational| oscillator(5, Exact::from(v));
    let cusp = five(Rational::new()).loop_speed(balls).ok_or(Error::NoValue)?;
    let slopes = |v: &Rational| -> Option<[Ball; 2]> {
        let h = Rational::from((1, 1_000_000_000));
        let at = |v: Rational| five(v).signed_threshold(balls);
        let middle = at(v.clone())?;
        let left = balls.sub(&middle, &at(Rational::from(v - &h))?);
        let right = balls.sub(&at(Rational::from(v + &h))?, &middle);
        let per = |ball: &Ball| balls.mul_rational(ball, &Rational::from(h.recip_ref()));
        Some([per(&left), per(&right)])
    };
    let far_apart = |[left, right]: &[Ball; 2]| {
        let gap = balls.abs(&balls.sub(left, right));
        let hundredth = Rational::from((1, 100));
        balls.sub(&gap, &balls.mul_rational(&balls.abs(right), &hundredth)).is_positive()
    };
    let mut holds = true;
    let mut found = Vec::new();
    for text in printed {
        let v = Decimal::new(text).ok_or(Error::NoValue)?;
        let pair = slopes(v.value()).ok_or(Error::NoValue)?;
        // Through zero with a slope: a corner of |gamma|.
        let crosses = pair.iter().all(Ball::is_positive) || pair.iter().all(Ball::is_negative);
        holds &= crosses && !far_apart(&pair);
        found.push(format!("{} and {} at {text}", show(&pair[0], 6), show(&pair[1], 6)));
    }
    let v = cusp.midpoint().to_rational().ok_or(Error::NoValue)?;
    let pair = slopes(&v).ok_or(Error::NoValue)?;
    let there = if far_apart(&pair) { "a cusp" } else { "no cusp" };
    found.push(format!("{} and {} at $V$: {there}", show(&pair[0], 6), show(&pair[1], 6)));
    Ok(plain(
        "two cusps",
        "$b = 5$: two cusps, at $v* = 0.310429$ and $v* = 0.557204$",
        format!("the cusp is at $v* = V = a/sqrt(2b) = {}$", show(&cusp, DIGITS)),
        format!(
            "difference quotients of the signed curve to the left and to the right, step 1e-9 (estimated): {}",
            found.join("; ")
        ),
        holds,
        "right if a corner is called a cusp: these are corners of $|gamma|$, where the signed curve goes through \
         zero; the cusp that stays one with the sign is at $V$, with an infinite slope from the left",
    ))
}

/// The cusp can be brought to gamma = 0 by b.
fn touching(balls: Balls) -> Option<Row> {
    let paper = section_three();
    let b = paper.touching_b()?;
    let at =
        |b: Rational| StickSlip { b: Exact::from(b), ..paper.clone() }.threshold_at_cusp(balls);
    let near = Rational::from((1, 1000));
    let below = at(Rational::from(&b - &near))?;
    let above = at(Rational::from(&b + &near))?;
    let five = at(Rational::from(5))?;
    let holds = at(b.clone())?.contains_zero() && below.is_positive() && above.is_negative();
    Some(plain(
        "the cusp touches",
        "by the parameter $b$ the cusp can touch the horizontal coordinate, $gamma = 0$",
        format!("it does at $b = 129 a^2 beta/(70 alpha) = {b}$"),
        format!(
            "$gamma$ at the cusp, signed: {} at $b - 1/1000$, {} at $b + 1/1000$",
            show(&below, 6),
            show(&above, 6)
        ),
        holds,
        &format!("not at $b = 5$: there it is {}", show(&five, DIGITS)),
    ))
}
