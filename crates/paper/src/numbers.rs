//! The numbers for n = 3 and n = 5 in the text below (42).

use super::tables::{QUANTITIES, Truncations};
use super::{Decimal, Findings, Reader, Row, Section, periods, plain, show};
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

/// A period that the paper prints numbers for, with all that they may come from.
pub(super) struct Numbers {
    pub balls: Balls,
    /// The exact period.
    pub exact: Ball,
    /// The exact period with the route to it, in words.
    pub exact_text: String,
    /// All formulas that an approximation may come from.
    pub sources: Vec<(String, Ball)>,
}

impl Numbers {
    /// How far a value is off, in percent of the exact period.
    pub fn error(&self, value: &Ball) -> Option<Ball> {
        percent(value, &self.exact, self.balls)
    }

    /// The same in words.
    pub fn off(&self, value: &Ball) -> Option<String> {
        Some(format!("{} %", show(&self.error(value)?, 3)))
    }

    /// A printed decimal as a ball.
    pub fn ball(&self, printed: &Decimal) -> Ball {
        self.balls.from_rational(printed.value())
    }

    /// A printed approximation against the one it should be, and the formula that gives it.
    pub fn approximation(
        &self,
        printed: &Decimal,
        value: &Ball,
    ) -> (Findings, Option<&(String, Ball)>) {
        let source = self.sources.iter().find(|(_, value)| printed.shows(value));
        let findings = printed.compare(value);
        (Findings { reproduced: Some(source.is_some()), ..findings }, source)
    }
}

/// Reads the numbers.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.rows.extend(rows(reader.balls).ok_or(Error::NoValue)?);
    Ok(true)
}

/// What is printed for n = 3: the first approximation, the exact period, the second approximation.
const CUBIC: [&str; 3] = ["6.8070", "7.4164", "7.5111"];

fn rows(balls: Balls) -> Option<Vec<Row>> {
    let series = Truncations::power_law(TRIED, balls)?;
    let [exponent, one, two] = [3, 1, 2].map(Rational::from);
    let exact = periods::power_law_period(&exponent, balls)?;
    let mut sources = vec![("(42) as printed".to_owned(), forty_two(1, balls))];
    sources.extend(truncations(&series, &one));
    let exact_text = format!("exact {} (Gamma and AGM)", show(&exact, 8));
    let cubic = Numbers { balls, exact, exact_text, sources };
    let period = QUANTITIES[0];
    let first = series.period(period, 1, &one)?;
    let second = series.period(period, 2, &one)?;
    Some(vec![
        first_row(&cubic, &first)?,
        exact_row(&cubic)?,
        eight_percent_row(&cubic, &first)?,
        second_row(&cubic, &second)?,
        practically_exact_row(&cubic, &second)?,
        quintic_row(&series.period(period, 1, &two)?, balls)?,
    ])
}

/// (42) as printed: T/(2 pi) = 1 - 2 delta ln 2.
fn forty_two(delta: i64, balls: Balls) -> Ball {
    times_two_pi(&balls.sub(&balls.one(), &balls.mul_i64(&balls.ln_2(), 2 * delta)), balls)
}

/// Where a printed number comes from, in words.
fn tried(cubic: &Numbers, source: Option<&(String, Ball)>) -> String {
    match source {
        Some((source, _)) => format!("it is {source}"),
        None => format!(
            "given by none of the {} formulas tried: (42) as printed, the truncations of orders 0 to {TRIED} \
             through $T$, $omega$ and $omega^2$",
            cubic.sources.len()
        ),
    }
}

fn first_row(cubic: &Numbers, first: &Ball) -> Option<Row> {
    let (findings, source) = cubic.approximation(&Decimal::new(CUBIC[0])?, first);
    Some(Row::new(
        "$n = 3$, first",
        "$n = 3$ ($delta = 1$): (42) yields $T = 6.8070$",
        format!("order 1 of $T$: {}, off by {}", show(first, 6), cubic.off(first)?),
        &*cubic.exact_text,
        &findings,
        format!(
            "(42) as printed gives {}; 6.8070 is {}",
            show(&forty_two(1, cubic.balls), 5),
            tried(cubic, source)
        ),
    ))
}

fn exact_row(cubic: &Numbers) -> Option<Row> {
    let (gamma, mean) = (&cubic.exact, periods::cubic_period(cubic.balls)?);
    let printed = Decimal::new(CUBIC[1])?;
    let findings = if gamma.overlaps(&mean) { printed.compare(gamma) } else { Findings::default() };
    Some(Row::new(
        "$n = 3$, exact",
        "exact period $T = 7.4164$",
        format!("$T = {}$ by the $Gamma$ closed form", show(gamma, 20)),
        format!("$T = {}$ by the AGM", show(&mean, 20)),
        &findings,
        findings.correction.clone().unwrap_or_default(),
    ))
}

fn eight_percent_row(cubic: &Numbers, first: &Ball) -> Option<Row> {
    let balls = cubic.balls;
    let [printed, exact] = [CUBIC[0], CUBIC[1]].map(|text| Some(cubic.ball(&Decimal::new(text)?)));
    let own = percent(&printed?, &exact?, balls)?;
    Some(plain(
        "$n = 3$, 8 %",
        "the error doesn't exceed 8 %",
        format!("error of the derived first approximation: {}", cubic.off(first)?),
        &*cubic.exact_text,
        balls.sub(&balls.from_i64(8), &own).is_positive(),
        &format!(
            "the paper's own numbers give {} %, (42) as printed {}",
            show(&own, 3),
            cubic.off(&forty_two(1, balls))?
        ),
    ))
}

fn second_row(cubic: &Numbers, second: &Ball) -> Option<Row> {
    let (findings, source) = cubic.approximation(&Decimal::new(CUBIC[2])?, second);
    Some(Row::new(
        "$n = 3$, second",
        "the next approximation gives $T = 7.5111$",
        format!("order 2 of $T$: {}, off by {}", show(second, 6), cubic.off(second)?),
        &*cubic.exact_text,
        &findings,
        format!("7.5111 is {}", tried(cubic, source)),
    ))
}

/// The paper says "practically exact" again below (51), for an error of 0.5 %.
fn practically_exact_row(cubic: &Numbers, second: &Ball) -> Option<Row> {
    let half = cubic.ball(&Decimal::new("0.5")?);
    let its_error = cubic.error(&cubic.ball(&Decimal::new(CUBIC[2])?))?;
    Some(plain(
        "$n = 3$, 7.5111",
        "7.5111 is a practically exact value",
        format!("the derived second approximation is: off by {}", cubic.off(second)?),
        &*cubic.exact_text,
        cubic.balls.sub(&half, &its_error).is_positive(),
        &format!(
            "7.5111 is off by {} %; below (51) the paper calls 0.5 % practically exact",
            show(&its_error, 3)
        ),
    ))
}

fn quintic_row(derived: &Ball, balls: Balls) -> Option<Row> {
    let exact = periods::power_law_period(&Rational::from(5), balls)?;
    let printed = forty_two(2, balls);
    Some(plain(
        "$n = 5$",
        "for $n = 5$ formula (42) does not represent a real period value",
        format!("(42) as printed gives {}", show(&printed, 5)),
        format!("exact {} by the $Gamma$ function", show(&exact, 8)),
        printed.is_negative(),
        &format!(
            "negative as for $n = 3$ already, where {} stands for 6.8070; the corrected formula gives {}, off \
             by {} %",
            show(&forty_two(1, balls), 5),
            show(derived, 6),
            show(&percent(derived, &exact, balls)?, 3)
        ),
    ))
}
