//! The numbers for n = 3 and n = 5 in the text below (42).

use super::tables::{QUANTITIES, Truncations};
use super::{Decimal, Findings, Reader, Row, Section, periods, show};
use lindstedt::Error;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// Orders up to which truncations are tried as the source of a printed number.
const TRIED: usize = 4;

/// 100 |a - b|/b.
pub(super) fn percent(a: &Ball, b: &Ball, balls: Balls) -> Option<Ball> {
    let error = balls.div(&balls.abs(&balls.sub(a, b)), b)?;
    Some(balls.mul_i64(&error, 100))
}

/// What a formula for T/(2 pi) gives.
pub(super) fn times_two_pi(value: &Ball, balls: Balls) -> Ball {
    balls.mul_i64(&balls.mul(&balls.pi(), value), 2)
}

/// Where a printed number may come from: the truncations of T, omega and omega^2 up to order 4.
pub(super) fn truncations(series: &Truncations, delta: &Rational) -> Vec<(String, Ball)> {
    let mut list = Vec::new();
    for quantity in QUANTITIES {
        for order in 0..=TRIED {
            if let Some(value) = series.period(quantity, order, delta) {
                list.push((format!("order {order} through {}", quantity.name()), value));
            }
        }
    }
    list
}

/// A printed approximation against the one it should be; `sources` are all formulas it may come
/// from.
pub(super) fn approximation(
    printed: &Decimal,
    value: &Ball,
    sources: &[(String, Ball)],
) -> (Findings, Option<String>) {
    let mut findings = printed.compare(value);
    let source = sources.iter().find(|(_, value)| printed.shows(value)).map(|(s, _)| s.clone());
    findings.reproduced = Some(source.is_some());
    (findings, source)
}

/// Reads the numbers.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.rows.extend(rows(reader.balls).ok_or(Error::NoValue)?);
    Ok(true)
}

fn rows(balls: Balls) -> Option<Vec<Row>> {
    let series = Truncations::power_law(TRIED, balls)?;
    let [exponent, one, two] = [3, 1, 2].map(Rational::from);
    let exact = periods::power_law_period(&exponent, balls)?;
    let second_route = periods::cubic_period(balls)?;
    let period = QUANTITIES[0];
    let first = series.period(period, 1, &one)?;
    let second = series.period(period, 2, &one)?;
    // (42) as printed: T/(2 pi) = 1 - 2 delta ln 2.
    let forty_two = |delta: i64| {
        let value = balls.sub(&balls.one(), &balls.mul_i64(&balls.ln_2(), 2 * delta));
        times_two_pi(&value, balls)
    };
    let mut sources = vec![("(42) as printed".to_owned(), forty_two(1))];
    sources.extend(truncations(&series, &one));
    let tried = |source: &Option<String>| match source {
        Some(source) => format!("it is {source}"),
        None => format!(
            "given by none of the {} formulas tried: (42) as printed, the truncations of orders 0 to {TRIED} \
             through $T$, $omega$ and $omega^2$",
            sources.len()
        ),
    };
    let exact_text = format!("exact {} (Gamma and AGM)", show(&exact, 8));
    let off = |value: &Ball| Some(format!("{} %", show(&percent(value, &exact, balls)?, 3)));
    let ball = |printed: &Decimal| balls.from_rational(printed.value());
    let mut rows = Vec::new();

    let printed_first = Decimal::new("6.8070")?;
    let (findings, source) = approximation(&printed_first, &first, &sources);
    rows.push(Row::new(
        "$n = 3$, first",
        "$n = 3$ ($delta = 1$): (42) yields $T = 6.8070$",
        format!("order 1 of $T$: {}, off by {}", show(&first, 6), off(&first)?),
        exact_text.clone(),
        &findings,
        format!("(42) as printed gives {}; 6.8070 is {}", show(&forty_two(1), 5), tried(&source)),
    ));

    let printed_exact = Decimal::new("7.4164")?;
    let findings = if exact.overlaps(&second_route) {
        printed_exact.compare(&exact)
    } else {
        Findings::default()
    };
    rows.push(Row::new(
        "$n = 3$, exact",
        "exact period $T = 7.4164$",
        format!("$T = {}$ by the $Gamma$ closed form", show(&exact, 20)),
        format!("$T = {}$ by the AGM", show(&second_route, 20)),
        &findings,
        findings.correction.clone().unwrap_or_default(),
    ));

    let own = percent(&ball(&printed_first), &ball(&printed_exact), balls)?;
    let eight = balls.from_i64(8);
    rows.push(Row::new(
        "$n = 3$, 8 %",
        "the error doesn't exceed 8 %",
        format!("error of the derived first approximation: {}", off(&first)?),
        exact_text.clone(),
        &Findings::holds(balls.sub(&eight, &own).is_positive()),
        format!(
            "the paper's own numbers give {} %, (42) as printed {}",
            show(&own, 3),
            off(&forty_two(1))?
        ),
    ));

    let printed_second = Decimal::new("7.5111")?;
    let (findings, source) = approximation(&printed_second, &second, &sources);
    rows.push(Row::new(
        "$n = 3$, second",
        "the next approximation gives $T = 7.5111$",
        format!("order 2 of $T$: {}, off by {}", show(&second, 6), off(&second)?),
        exact_text.clone(),
        &findings,
        format!("7.5111 is {}", tried(&source)),
    ));

    // The paper says "practically exact" again below (51), for an error of 0.5 %.
    let half = balls.from_rational(Decimal::new("0.5")?.value());
    let its_error = percent(&ball(&printed_second), &exact, balls)?;
    rows.push(Row::new(
        "$n = 3$, 7.5111",
        "7.5111 is a practically exact value",
        format!("the derived second approximation is: off by {}", off(&second)?),
        exact_text,
        &Findings::holds(balls.sub(&half, &its_error).is_positive()),
        format!(
            "7.5111 is off by {} %; below (51) the paper calls 0.5 % practically exact",
            show(&its_error, 3)
        ),
    ));

    let exact_five = periods::power_law_period(&Rational::from(5), balls)?;
    let derived_five = series.period(period, 1, &two)?;
    let error = percent(&derived_five, &exact_five, balls)?;
    let printed_five = forty_two(2);
    rows.push(Row::new("$n = 5$",
"for $n = 5$ formula (42) does not represent a real period value",
format!("(42) as printed gives {}", show(&printed_five, 5)),
format!("exact {} by the $Gamma$ function", show(&exact_five, 8)),
&Findings::holds(printed_five.is_negative()),
format!(
            "negative as for $n = 3$ already, where {} stands for 6.8070; the corrected formula gives {}, off \
             by {} %",
            show(&forty_two(1), 5),
            show(&derived_five, 6),
            show(&error, 3)
        ),
));
    Some(rows)
}
