//! Section 4: the true error of the period against the order of the delta expansion.

use super::super::tables::{Quantity, Tabled, Truncations};
use super::super::{Reader, Section};
use super::Finding;
use crate::text::texts;
use lindstedt::Error;
use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::resummation::Map;
use rug::{Float, Rational};
use serde::{Serialize, Serializer};

/// The error of T, cut off after each order, at one value of delta.
#[derive(Clone, Debug, Serialize)]
pub struct Truncation {
    /// "n = 3" or "pendulum".
    pub name: String,
    /// delta.
    #[serde(serialize_with = "exactly")]
    pub delta: Rational,
    /// |T_N/T - 1| of the partial sum of order N, at index N. Certified, rounded to a double.
    pub errors: Vec<f64>,
    /// The same coefficients, re-expanded in u = delta/(1 + delta) with the factor sqrt(1 - u);
    /// empty for the pendulum. Estimated: no rounding errors are bounded.
    #[serde(rename = "errors_in_u")]
    pub resummed: Vec<f64>,
}

/// A rational number as it is written.
fn exactly<S: Serializer>(q: &Rational, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(q)
}

impl Truncation {
    /// The order with the smallest error of the partial sum.
    #[must_use]
    pub fn best(&self) -> Option<(usize, f64)> {
        self.errors.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn last(&self) -> Option<(usize, f64)> {
        self.errors.iter().copied().enumerate().next_back()
    }
}

fn errors(
    sums: impl Iterator<Item = Option<Ball>>,
    exact: &Ball,
    balls: Balls,
) -> Option<Vec<f64>> {
    sums.map(|sum| Some(balls.div(&balls.sub(&sum?, exact), exact)?.abs_upper().to_f64())).collect()
}

/// The errors of n = 3, 5, 7, 9 and of the pendulum.
pub(in super::super) fn read(reader: &mut Reader<'_>, _: &mut Section) -> Result<bool, Error> {
    let balls = reader.balls;
    let truncation = |of: &Tabled| {
        let sums = (0..=of.order).map(|k| of.series.period(Quantity::Period, k, &of.delta));
        let is_power_law = of.name != "pendulum";
        let resummed = is_power_law.then(|| uniform(&of.series, &of.delta, &of.exact, balls));
        Some(Truncation {
            name: of.name.clone(),
            errors: errors(sums, &of.exact, balls)?,
            resummed: resummed.unwrap_or_default(),
            delta: of.delta.clone(),
        })
    };
    let list = reader.tabled.iter().map(truncation).collect::<Option<_>>();
    reader.trust.truncations = list.ok_or(Error::NoValue)?;
    Ok(true)
}

/// Partial sums of sqrt(1 - u) T(u), u = delta/(1 + delta), divided by sqrt(1 - u).
fn uniform(series: &Truncations, delta: &Rational, exact: &Ball, balls: Balls) -> Vec<f64> {
    let bits = balls.bits();
    let coefficients: Vec<Float> =
        series.coefficients(Quantity::Period).iter().map(Ball::midpoint).cloned().collect();
    let map = Map::Rational { scale: Float::with_val(bits, 1) };
    let half = Float::with_val(bits, 0.5);
    let terms = map.expand(&coefficients, &half, bits, &Stop::default());
    let u = Float::with_val(bits, delta / Rational::from(delta + 1u32));
    let root = Float::with_val(bits, 1 - &u).sqrt();
    let turn = Float::with_val(bits, rug::float::Constant::Pi) * 2u32;
    let (mut sum, mut power) = (Float::new(bits), Float::with_val(bits, 1));
    let error = |term: Float| {
        sum += Float::with_val(bits, &term * &power);
        power *= &u;
        let period = Float::with_val(bits, &sum / &root) * &turn;
        (period / exact.midpoint() - 1u32).abs().to_f64()
    };
    terms.into_iter().map(error).collect()
}

pub(super) fn finding(list: &[Truncation]) -> Option<Finding> {
    let named = |name: &str| list.iter().find(|t| t.name == name);
    let (cubic, pendulum) = (named("n = 3")?, named("pendulum")?);
    Some(Finding {
        section: 4,
        method: "The small $delta$ method, $T$ cut off after order $N$".into(),
        trusted: texts(trusted(list, cubic, pendulum)?),
        not_trusted: texts(not_trusted(list, pendulum)?),
        class: "errors of partial sums certified, of the re-expanded series estimated (rounding \
                errors not bounded)"
            .into(),
    })
}

/// A relative error in words.
fn share(error: f64) -> String {
    match error {
        e if e < 1e-4 => format!("{e:.0e}"),
        e if e < 2.0 => format!("{:.2} %", 100.0 * e),
        e => format!("{e:.0} times $T$"),
    }
}

fn trusted(list: &[Truncation], cubic: &Truncation, pendulum: &Truncation) -> Option<[String; 3]> {
    let at =
        |t: &Truncation, order: usize| t.errors.get(order).map_or("?".to_owned(), |e| share(*e));
    let (best, least) = pendulum.best()?;
    let resummed = |t: &Truncation| Some(format!("{} at ${}$", share(*t.resummed.last()?), t.name));
    let resummed: Vec<String> = list.iter().filter_map(resummed).collect();
    let highest = cubic.last()?.0;
    Some([
        format!(
            "$n = 3$ ($delta = 1$, on the circle of convergence): {} at order 1, {} at order 2, {} \
             at order {highest}",
            at(cubic, 1),
            at(cubic, 2),
            at(cubic, highest)
        ),
        format!(
            "the pendulum at amplitude 1 up to order {best}: {} there, {} at order 1",
            share(least),
            at(pendulum, 1)
        ),
        format!(
            "the same coefficients in $u = delta/(1 + delta)$ with the factor $sqrt(1 - u)$, for \
             every $n$ computed: at order {highest} {}",
            resummed.join(", ")
        ),
    ])
}

fn not_trusted(list: &[Truncation], pendulum: &Truncation) -> Option<[String; 2]> {
    let diverging = |t: &Truncation| {
        let ((best, least), (last, error)) = (t.best()?, t.last()?);
        let (least, error) = (share(least), share(error));
        Some(format!("${}$: {least} at order {best}, {error} at order {last}", t.name))
    };
    let outside: Vec<String> = list.iter().filter(|t| t.delta > 1).filter_map(diverging).collect();
    let ((best, _), (last, error)) = (pendulum.best()?, pendulum.last()?);
    Some([
        format!(
            "outside the circle $|delta| = 1$ the series in $delta$ diverges: {}",
            outside.join("; ")
        ),
        format!(
            "the pendulum beyond order {best}: the series is asymptotic, at order {last} the \
             error is {}",
            share(error)
        ),
    ])
}
