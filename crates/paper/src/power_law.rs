//! (28)-(42): the power law.

use super::compare::{Term, compare_sums, word};
use super::orders::Case;
use super::{Reader, Row, Section, lobachevsky, periods, plain, show};
use lindstedt::{Error, Quantity, unstable::derivation::energy};
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra, Ring, Stop};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::Series;
use rug::Rational;
use rug::ops::Pow;

/// Reads (28) to (42).
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let Some(case) = Case::derive("power-law", reader)? else { return Ok(false) };
    let rows = &mut section.rows;
    rows.extend(statement_rows(&case, reader.balls).ok_or(Error::NoValue)?);
    rows.extend(order_rows(&case)?);
    rows.extend(lobachevsky::rows(reader));
    rows.extend(result_rows(&case, reader.balls).ok_or(Error::NoValue)?);
    Ok(true)
}

/// x (x^2)^delta, for x > 0.
fn force(x: &Ball, delta: &Ball, balls: Balls) -> Option<Ball> {
    let exponent = balls.add(&balls.one(), &balls.mul_i64(delta, 2));
    Some(balls.exp(&balls.mul(&exponent, &balls.ln(x)?)))
}

fn statement_rows(case: &Case, balls: Balls) -> Option<Vec<Row>> {
    let order_zero = case.algebra.add(&case.acceleration(0), case.x(0));
    Some(vec![
        period_row(balls)?,
        case.initial_row("(29)", 0, "$x(0) = 1$, $x'(0) = 0$"),
        power_row(),
        taylor_row(&case.derivation.ring, balls)?,
        plain(
            "(32)",
            "$x = sum_n x_n delta^n$",
            format!(
                "$x_0$ to $x_{}$ found, $x_1 = {}$",
                case.expansion.order(),
                case.derivation.print_solution(1, Style::Text)
            ),
            case.residual_text(),
            case.derivation.checked_orders == Some(case.expansion.order()),
            "a solution of this form exists at every order derived",
        ),
        phase_row(case)?,
        frequency_row(case)?,
        plain(
            "(35)",
            "$x_0'' + x_0 = 0$",
            format!("$x_0 = {}$", case.derivation.print_solution(0, Style::Text)),
            case.residual_text(),
            case.algebra.is_zero(&order_zero),
            "$x_0'' + x_0$ vanishes identically",
        ),
        case.initial_row("(36)", 0, "$x_0(0) = 1$, $x_0'(0) = 0$"),
    ])
}

fn period_row(balls: Balls) -> Option<Row> {
    let beta = periods::power_law_period(&Rational::from(3), balls)?;
    let lemniscate = periods::cubic_period(balls)?;
    Some(plain(
        "(28)",
        "$x'' + x^n = 0$",
        "periodic for odd $n$, with the period by Euler's integral",
        format!(
            "$n = 3$: $T = {}$ by $Gamma$, {} by the AGM",
            show(&beta, 16),
            show(&lemniscate, 16)
        ),
        beta.overlaps(&lemniscate),
        "two closed forms of the period enclose the same number to 70 digits",
    ))
}

/// (30): exactly, for integer delta, on both sides of zero.
fn power_row() -> Row {
    let points = [(2, 3), (-2, 3), (-7, 5)].map(Rational::from);
    let same = (1..=4i32).all(|delta| {
        points.iter().all(|x| {
            let square = Rational::from(x.square_ref());
            square.pow(delta) * x == Rational::from(x.pow(1 + 2 * delta))
        })
    });
    plain(
        "(30)",
        "$x'' + x^(1 + 2 delta) = 0$",
        "$x'' + x (x^2)^delta = 0$, $n = 1 + 2 delta$",
        "$x (x^2)^delta = x^(1 + 2 delta)$ for $delta = 1..4$ at rational $x$ of either sign",
        same,
        "for $x < 0$ and other $delta$ the power means $x (x^2)^delta$, as (31) says",
    )
}

/// (33): energy gives T without x(t); times omega of the driver it must be 2 pi, exactly.
fn phase_row(case: &Case) -> Option<Row> {
    let (ring, order) = (&case.derivation.ring, case.expansion.order());
    let ones = vec![ring.one(); order + 1];
    let period = Series::truncated(energy::period_over_2pi(ring, &ones, order, &Stop::default())?);
    let squared = Series::truncated(case.expansion.frequency_squared.clone());
    let frequency = squared.power(ring, &Rational::from((1, 2)))?;
    let product = period.mul(ring, &frequency, order).coefficients;
    let is_one = product.first() == Some(&ring.one())
        && product.len() == order + 1
        && product.iter().skip(1).all(|c| ring.is_zero(c));
    Some(plain(
        "(33)",
        "$t = tau/omega$",
        "all $x_n$ have the period $2 pi$ in $tau$",
        format!("the period by the energy integral times $omega$ is $2 pi$ at orders 0..{order}"),
        is_one,
        "the product of the two series is 1 in $Q[mu]$",
    ))
}

fn frequency_row(case: &Case) -> Option<Row> {
    let order = case.expansion.order();
    let exact = |n| case.derivation.exact(Quantity::FrequencySquared, n).unwrap_or_default();
    let size = u16::try_from(order).ok()?;
    let second_route =
        energy::power_law_frequency(&case.derivation.ring, 2, size, &Stop::default())?;
    Some(plain(
        "(34)",
        "$omega^2 = 1 + alpha_1 delta + alpha_2 delta^2 + ...$",
        format!("$alpha_1 = {}$, $alpha_2 = {}$", exact(1), exact(2)),
        format!("the closed-form period gives the same coefficients, orders 0..{order}"),
        exact(0) == "1" && second_route == case.expansion.frequency_squared,
        "every $omega^2$ coefficient is a constant and equals the one from the exact period",
    ))
}

/// (31): n E_n = L E_{n-1} for E = exp(delta L), L = ln(x^2).
fn taylor_row(ring: &PolynomialRing, balls: Balls) -> Option<Row> {
    let log = ring.symbol(Symbol::Parameter(0));
    let mut derived = vec![ring.one()];
    for n in 1..=2u32 {
        let previous = derived.last()?;
        derived.push(ring.scale(&ring.mul(&log, previous), &Rational::from((1, n))));
    }
    let square = ring.mul(&log, &log);
    let printed = [ring.one(), log, ring.scale(&square, &Rational::from((1, 2)))];
    let x = balls.from_rational(&Rational::from((1, 3)));
    let ln = balls.mul_i64(&balls.ln(&x)?, 2);
    let second = periods::difference(2, balls, |d| Some(balls.exp(&balls.mul(d, &ln))))?;
    let expected = balls.mul_power_of_two(&balls.square(&ln), -1);
    let near = balls.sub(&second, &expected).abs_upper() < 1e-25;
    Some(plain(
        "(31)",
        "$(x^2)^delta = 1 + delta ln(x^2) + delta^2/2 [ln(x^2)]^2 + ...$",
        "$1 + delta L + delta^2 L^2/2 + ...$, $L = ln(x^2)$, from $n E_n = L E_(n-1)$".to_owned(),
        format!(
            "second order at $x = 1/3$, differentiated numerically: {} (estimated)",
            show(&second, 12)
        ),
        derived == printed && near,
        "equal as polynomials in $L$",
    ))
}

/// The products that can stand in an order equation, for the search for a correction.
pub(super) fn vocabulary(case: &Case) -> Vec<Term<super::orders::Element>> {
    let (x0, x1, log) = (case.x(0), case.x(1), case.log());
    let log2 = case.product(&log, &log);
    let half_log = case.algebra.scale(&log, &Rational::from((1, 2)));
    vec![
        Term::new(1, "x_0 ln(x_0^2)", case.product(x0, &log)),
        Term::new(1, "x_0", x0.clone()),
        Term::new(1, "x_1 ln(x_0^2)", case.product(x1, &log)),
        Term::new(1, "x_1", x1.clone()),
        Term::new(1, "x_0 [ln(x_0^2)]^2", case.product(x0, &log2)),
        Term::new(1, "x_0 (ln x_0)^2", case.product(x0, &case.product(&half_log, &half_log))),
        Term::new(1, "x_0''", case.acceleration(0)),
        Term::new(1, "x_1''", case.acceleration(1)),
    ]
}

fn order_rows(case: &Case) -> Result<Vec<Row>, Error> {
    let words = vocabulary(case);
    let first = [word(&words, -1, "x_0 (ln x_0)^2")?, case.inertia(1, 0)];
    let second = [
        word(&words, -1, "x_1 ln(x_0^2)")?,
        word(&words, -2, "x_1")?,
        word(&words, -1, "x_0 [ln(x_0^2)]^2")?,
        case.inertia(2, 0),
        case.inertia(1, 1),
    ];
    let cosine = case.algebra.cosine();
    let forty_one = [
        Term::new(-1, "cos t ln(cos^2 t)", case.product(&cosine, &case.log())),
        Term::new(1, "alpha_1 cos t", case.scaled(&cosine, &case.expansion.frequency_squared[1])),
    ];
    let rows = vec![
        case.order_row(
            "(37)",
            (1, "$x_1'' + x_1 = -x_0 ln(x_0)^2 - alpha_1 x_0''$"),
            &first,
            &words,
            &force,
        )?,
        case.initial_row("(38)", 1, "$x_1(0) = x_1'(0) = 0$"),
        case.order_row(
            "(39)",
            (2, "$x_2'' + x_2 = -[x_1 ln(x_0^2) + 2 x_1] - x_0 [ln(x_0^2)]^2 - alpha_2 x_0'' - alpha_1 x_1''$"),
            &second,
            &words,
            &force,
        )?,
        case.initial_row("(40)", 2, "$x_2(0) = x_2'(0) = 0$"),
        plain(
            "$x_0$",
            "$x_0 = cos t$",
            format!("$x_0 = {}$", case.derivation.print_solution(0, Style::Text)),
            case.residual_text(),
            *case.x(0) == cosine,
            "the only solution of (35), (36); from here on the paper writes $t$ for $tau$",
        ),
        case.order_row(
            "(41)",
            (1, "$x_1'' + x_1 = -cos t ln(cos^2 t) + alpha_1 cos t$"),
            &forty_one,
            &words,
            &force,
        )?,
    ];
    Ok(rows)
}

/// The monomials that can stand in a result.
fn constants(ring: &PolynomialRing) -> Vec<Term<Polynomial>> {
    let (two, pi) = (ring.symbol(Symbol::LogTwo), ring.symbol(Symbol::Pi));
    vec![
        Term::new(1, "1", ring.one()),
        Term::new(1, "pi ln 2", ring.mul(&pi, &two)),
        Term::new(1, "ln 2", two),
        Term::new(1, "pi", pi),
    ]
}

fn result_rows(case: &Case, balls: Balls) -> Option<Vec<Row>> {
    let ring = &case.derivation.ring;
    let words = constants(ring);
    let coefficient =
        |quantity, n: usize| case.derivation.named(quantity)?.coefficients.get(n).cloned();
    let alpha = coefficient(Quantity::FrequencySquared, 1)?;
    let product = ring.mul(&ring.symbol(Symbol::Pi), &ring.symbol(Symbol::LogTwo));
    let printed = [Term::new(4, "pi ln 2", product)];
    let findings = compare_sums(ring, &printed, &alpha, &words);
    // alpha_1 = d omega^2/d delta at 0, by a difference of the exact period at n = 1 +- 2 delta.
    let value = case.derivation.ball(Quantity::FrequencySquared, 1, balls)?;
    let estimate = periods::frequency_squared_slope(balls)?;
    let literal = balls.mul_i64(&balls.mul(&balls.pi(), &balls.ln_2()), 4);
    let alpha_row = Row::new(
        "$alpha_1$",
        "$alpha_1 = 4 pi ln 2$",
        format!("$alpha_1 = {} = {}$", ring.print(&alpha, Style::Text), show(&value, 15)),
        format!(
            "$d(omega^2)/d(delta)$ of the $Gamma$ closed form: {} (estimated)",
            show(&estimate, 15)
        ),
        &findings,
        format!(
            "printed value {}; what must vanish is the mean of $2 cos^2 t ln(cos^2 t) - alpha_1 2 cos^2 t$, \
             not that of $ln(cos^2 t)$",
            show(&literal, 6)
        ),
    );
    let period = coefficient(Quantity::Period, 1)?;
    let printed = [Term::new(-2, "ln 2", ring.symbol(Symbol::LogTwo))];
    let findings = compare_sums(ring, &printed, &period, &words);
    let at_one = balls.sub(&balls.one(), &balls.mul_i64(&balls.ln_2(), 2));
    let at_one = balls.mul_i64(&balls.mul(&balls.pi(), &at_one), 2);
    let forty_two = Row::new(
        "(42)",
        "$T = 2 pi [1 - 2 delta ln 2]$",
        format!("$T = 2 pi [1 + delta ({})]$", ring.print(&period, Style::Text)),
        format!(
            "$-1/2 d(omega^2)/d(delta)$ of the $Gamma$ closed form: {} (estimated)",
            show(&balls.mul_power_of_two(&balls.neg(&estimate), -1), 15)
        ),
        &findings,
        format!(
            "at $delta = 1$ the printed formula gives the negative period {}; the exact one grows \
             with $delta$",
            show(&at_one, 6)
        ),
    );
    Some(vec![alpha_row, forty_two])
}
