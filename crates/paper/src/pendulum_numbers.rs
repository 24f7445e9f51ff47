//! The numbers below (51).

use super::numbers::{Numbers, percent, times_two_pi, truncations};
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

/// The period at amplitude 1 with its approximations.
struct Pendulum {
    numbers: Numbers,
    zeroth: Ball,
    first: Ball,
    /// The error of the printed first approximation: of the printed numerical period, and in truth.
    own: Ball,
    true_error: Ball,
}

/// The numerical period, the approximations of order 0 and 1, and the error in percent, as printed.
const PRINTED: [&str; 4] = ["6.6", "6.8", "6.57", "0.5"];

/// The numbers below (51).
pub(super) fn rows(balls: Balls) -> Option<Vec<Row>> {
    let pendulum = Pendulum::new(balls)?;
    let [numerical, zeroth, first, half] = PRINTED.map(Decimal::new);
    Some(vec![
        pendulum.numerical_row(&numerical?)?,
        pendulum.zeroth_row(&zeroth?)?,
        pendulum.better_row()?,
        pendulum.first_row(&first?)?,
        pendulum.error_row(&half?)?,
    ])
}

impl Pendulum {
    fn new(balls: Balls) -> Option<Self> {
        let one = Rational::from(1);
        let exact = periods::pendulum_period(&one, balls)?;
        let series = Truncations::pendulum(4, balls)?;
        let [zeroth, first] = [0, 1].map(|order| series.period(QUANTITIES[0], order, &one));
        let as_printed = fifty_one(balls)?;
        let root = balls.sqrt(&balls.sin(&balls.one()))?;
        let completed = balls.div(&as_printed, &root)?;
        let mut sources = vec![
            ("(51) as printed".to_owned(), as_printed),
            ("(51) with the missing $1/omega$".to_owned(), completed),
        ];
        sources.extend(truncations(&series, &one));
        let exact_text = format!("exact {} (AGM)", show(&exact, 12));
        let numbers = Numbers { balls, exact, exact_text, sources };
        // Does the claim of 0.5 % hold with the printed 6.6, and with the correct value?
        let [numerical, _, printed, _] =
            PRINTED.map(|text| Some(numbers.ball(&Decimal::new(text)?)));
        let (numerical, printed) = (numerical?, printed?);
        let own = percent(&printed, &numerical, balls)?;
        let true_error = numbers.error(&printed)?;
        Some(Self { zeroth: zeroth?, first: first?, own, true_error, numbers })
    }

    fn numerical_row(&self, printed: &Decimal) -> Option<Row> {
        let Numbers { exact, balls, .. } = &self.numbers;
        let by_series = periods::pendulum_period_by_series(&Rational::from(1), *balls)?;
        Some(Row::new(
            "$T$ numerical",
            "the numerical period of (43) is $T = 6.6$",
            format!("$T = {}$ at amplitude 1", show(exact, 12)),
            format!("hypergeometric series: {}", show(&by_series, 12)),
            &printed.compare(exact),
            format!(
                "{}, rounded it is {}; the error of 0.5 % given for 6.57 rests on 6.6 ({} %, in truth {} %)",
                shown_as(printed, exact),
                printed.correct(exact)?,
                show(&self.own, 2),
                show(&self.true_error, 3)
            ),
        ))
    }

    fn zeroth_row(&self, printed: &Decimal) -> Option<Row> {
        let zeroth = &self.zeroth;
        Some(Row::new(
            "$T$ order 0",
            "the approximation of order 0 gives $T = 6.8$",
            format!("$2 pi/omega = {}$, off by {}", show(zeroth, 8), self.numbers.off(zeroth)?),
            &*self.numbers.exact_text,
            &printed.compare(zeroth),
            format!("the printed decimals are the value, {}", shown_as(printed, zeroth)),
        ))
    }

    fn better_row(&self) -> Option<Row> {
        let Numbers { balls, exact_text, .. } = &self.numbers;
        let linear = times_two_pi(&balls.one(), *balls);
        let better = balls.sub(&self.numbers.error(&linear)?, &self.numbers.error(&self.zeroth)?);
        let off = [&self.zeroth, &linear].map(|value| self.numbers.off(value));
        let [zeroth, linear] = off;
        Some(plain(
            "better than $2 pi$",
            "order 0 is better than $T = 2 pi$",
            format!("$2 pi/omega$ is off by {}, $2 pi$ by {}", zeroth?, linear?),
            &**exact_text,
            better.is_positive(),
            "the two errors, enclosed",
        ))
    }

    fn first_row(&self, printed: &Decimal) -> Option<Row> {
        let first = &self.first;
        let (findings, source) = self.numbers.approximation(printed, first);
        Some(Row::new(
            "$T$ order 1",
            "the first approximation gives $T = 6.57$",
            format!("order 1 of $T$: {}, off by {}", show(first, 8), self.numbers.off(first)?),
            &*self.numbers.exact_text,
            &findings,
            match source {
                Some((source, value)) => format!(
                    "6.57 is {source}, {}, {}",
                    show(value, 6),
                    printed.shows_as(value).unwrap_or_default()
                ),
                None => {
                    format!("given by none of the {} formulas tried", self.numbers.sources.len())
                }
            },
        ))
    }

    fn error_row(&self, printed: &Decimal) -> Option<Row> {
        let derived = self.numbers.error(&self.first)?;
        let mut findings = printed.compare(&derived);
        findings.holds |= printed.shows(&self.true_error);
        findings.reproduced = Some(printed.shows(&self.own));
        Some(Row::new(
            "0.5 %",
            "practically exact, the error is approximately 0.5 %",
            format!("error of the derived first approximation: {} %", show(&derived, 3)),
            &*self.numbers.exact_text,
            &findings,
            format!(
                "6.57 is off by {} % from the exact period, by {} % from the printed 6.6",
                show(&self.true_error, 3),
                show(&self.own, 2)
            ),
        ))
    }
}

/// How printed decimals are the value, in words.
fn shown_as(printed: &Decimal, value: &Ball) -> &'static str {
    printed.shows_as(value).unwrap_or("neither rounded nor cut off")
}
