//! The numbers below (51).

use super::numbers::{approximation, percent, times_two_pi, truncations};
use super::tables::{QUANTITIES, Truncations};
use super::{Decimal, Row, periods, plain, show};
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// (51) as printed, at amplitude 1.
pub(super) fn fifty_one(balls: Balls) -> Option<Ball> {
    let one = balls.one();
    let (sine, cosine) = (balls.sin(&one), balls.cos(&one));
    let first = balls.mul_power_of_two(&balls.sub(&sine, &cosine), -1);
    let factor = balls.div(&balls.ln_2(), &balls.pi())?;
    let term = balls.mul(&balls.div(&first, &sine)?, &factor);
    Some(times_two_pi(&balls.sub(&one, &term), balls))
}

/// The numbers below (51).
pub(super) fn rows(balls: Balls) -> Option<Vec<Row>> {
    let one = Rational::from(1);
    let exact = periods::pendulum_period(&one, balls)?;
    let series = Truncations::pendulum(4, balls)?;
    let period = QUANTITIES[0];
    let (zeroth, first) = (series.period(period, 0, &one)?, series.period(period, 1, &one)?);
    let as_printed = fifty_one(balls)?;
    let root = balls.sqrt(&balls.sin(&balls.one()))?;
    let mut sources = vec![
        ("(51) as printed".to_owned(), as_printed.clone()),
        ("(51) with the missing $1/omega$".to_owned(), balls.div(&as_printed, &root)?),
    ];
    sources.extend(truncations(&series, &one));
    let off = |value: &Ball| Some(show(&percent(value, &exact, balls)?, 3));
    let ball = |printed: &Decimal| balls.from_rational(printed.value());
    let exact_text = format!("exact {} (AGM)", show(&exact, 12));
    let [numerical, zero, first_printed, half] = ["6.6", "6.8", "6.57", "0.5"].map(Decimal::new);
    let (numerical, zero, first_printed, half) = (numerical?, zero?, first_printed?, half?);

    // Does the claim of 0.5 % hold with the printed 6.6, and with the correct value?
    let own = percent(&ball(&first_printed), &ball(&numerical), balls)?;
    let true_error = percent(&ball(&first_printed), &exact, balls)?;
    let correct = numerical.correct(&exact)?;
    let mut rows = vec![Row::new(
        "$T$ numerical",
        "the numerical period of (43) is $T = 6.6$",
        format!("$T = {}$ at amplitude 1", show(&exact, 12)),
        format!(
            "hypergeometric series: {}",
            show(&periods::pendulum_period_by_series(&one, balls)?, 12)
        ),
        &numerical.compare(&exact),
        format!(
            "{}, rounded it is {correct}; the error of 0.5 % given for 6.57 rests on 6.6 ({} %, in truth {} %)",
            numerical.shows_as(&exact).unwrap_or("neither rounded nor cut off"),
            show(&own, 2),
            show(&true_error, 3)
        ),
    )];
    rows.push(Row::new(
        "$T$ order 0",
        "the approximation of order 0 gives $T = 6.8$",
        format!("$2 pi/omega = {}$, off by {} %", show(&zeroth, 8), off(&zeroth)?),
        exact_text.clone(),
        &zero.compare(&zeroth),
        format!(
            "the printed decimals are the value, {}",
            zero.shows_as(&zeroth).unwrap_or("neither rounded nor cut off")
        ),
    ));
    let linear = times_two_pi(&balls.one(), balls);
    let better = balls.sub(&percent(&linear, &exact, balls)?, &percent(&zeroth, &exact, balls)?);
    rows.push(plain(
        "better than $2 pi$",
        "order 0 is better than $T = 2 pi$",
        format!("$2 pi/omega$ is off by {} %, $2 pi$ by {} %", off(&zeroth)?, off(&linear)?),
        exact_text.clone(),
        better.is_positive(),
        "the two errors, enclosed",
    ));
    let (findings, _) = approximation(&first_printed, &first, &sources);
    rows.push(Row::new(
        "$T$ order 1",
        "the first approximation gives $T = 6.57$",
        format!("order 1 of $T$: {}, off by {} %", show(&first, 8), off(&first)?),
        exact_text.clone(),
        &findings,
        match sources.iter().find(|(_, value)| first_printed.shows(value)) {
            Some((source, value)) => format!(
                "6.57 is {source}, {}, {}",
                show(value, 6),
                first_printed.shows_as(value).unwrap_or_default()
            ),
            None => format!("given by none of the {} formulas tried", sources.len()),
        },
    ));
    let derived_error = percent(&first, &exact, balls)?;
    let mut findings = half.compare(&derived_error);
    findings.holds |= half.shows(&true_error);
    findings.reproduced = Some(half.shows(&own));
    rows.push(Row::new(
        "0.5 %",
        "practically exact, the error is approximately 0.5 %",
        format!("error of the derived first approximation: {} %", show(&derived_error, 3)),
        exact_text,
        &findings,
        format!(
            "6.57 is off by {} % from the exact period, by {} % from the printed 6.6",
            show(&true_error, 3),
            show(&own, 2)
        ),
    ));
    Some(rows)
}
