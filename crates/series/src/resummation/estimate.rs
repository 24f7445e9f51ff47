//! Error estimates from the terms of a series and from the agreement of neighbouring approximants.

use super::pade::log2;
use rug::Float;
use rug::float::Special;
use rug::ops::Pow;

/// The least number of an approximant whose error is estimated.
const FEWEST: usize = 6;

/// A value with an estimated error.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The value.
    pub value: Float,
    /// The estimated bound of |value - true value| (53 bits), at least the last disagreement;
    /// infinite where nothing can be said.
    pub error: Float,
}

/// A value by one method.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The value with its error estimate.
    pub estimate: Estimate,
    /// The highest order of the series that is used.
    pub order: usize,
    /// Degrees of the numerator and the denominator, for the methods with Pade approximants.
    pub degrees: Option<(usize, usize)>,
    /// What means something only where a method that shares no approximants with this one agrees; nothing where there is
    /// none.
    pub tentative: Option<Tentative>,
    /// The order of the smallest term, where the series was cut there because it diverges.
    pub smallest_term: Option<usize>,
}

/// Of a sequence of approximants what is compared with that of another method.
#[derive(Clone, Debug)]
pub struct Tentative {
    /// A less cautious estimate of the error; infinite where there is none.
    pub error: Float,
    /// The approximant of one order less.
    pub before: Float,
    /// By what the error falls from one order to the next, at most 1.
    pub ratio: f64,
    /// The largest distance from the neighbours in the table of approximants, where they were looked at: two of the same order, with a
    /// denominator of one degree more and less, and the last two before.
    pub beside: Option<Float>,
}

impl Tentative {
    /// The same of all approximants times a factor.
    #[must_use]
    pub(super) fn scaled(mut self, factor: &Float) -> Self {
        let size = Float::with_val(53, factor.abs_ref());
        self.before *= factor;
        self.error *= &size;
        self.beside = self.beside.map(|beside| beside * size);
        self
    }
}

/// |a - b| in 53 bits.
pub(super) fn distance(a: &Float, b: &Float) -> Float {
    Float::with_val(53, a - b).abs()
}

/// The largest distance of `list` from `value`.
fn spread(list: &[Float], value: &Float) -> Option<Float> {
    list.iter().map(|v| distance(v, value)).reduce(|a, b| a.max(&b))
}

/// The last of a sequence of approximants, with an estimate of its error.
///
/// Two judgments, of which the smaller counts, but at least the distance from the two approximants
/// before:
///
/// The logarithms of the two-step differences |v_k - v_(k-2)| (neighbours on a staircase are of
/// two kinds) are fitted by a line a + b k. For errors that fall like q^k on the whole it has the
/// slope ln q, and the error is the sum of the differences to come,
///
///   |error| <= 4 exp(a + b (N + 1) + 3 d)/(1 - exp b),
///
/// d the standard deviation of a prediction at N + 1 from the n points, s sqrt(1 + 1/n +
/// (N + 1 - m)^2/sum (k - m)^2), s that of the points from the line: approximants whose
/// differences fall evenly are believed more than those that agree by luck. The line is read at
/// N + 1, where the difference is about the error of the approximant before the last one.
///
/// One value that stands apart spoils the line, but not the spread s1 of the four values before
/// the last one: with the spread s2 of the four before these, s2/s1 - 1 = q^-4 and the error is
/// s1/(s2/s1 - 2). Sixteen times s1 times the larger of 1 and 1/(s2/s1 - 2), with N as the most.
///
/// Infinite where neither says anything (b >= 0 and s2 < s1: the sequence does not settle) and for
/// approximants below number six.
/// Nothing for fewer than two values.
///
/// What fools it: errors that oscillate with a period of more than some ten approximants, and
/// sequences that converge to something else.
pub(super) fn settle(values: &[Float], number: usize) -> Option<Estimate> {
    let (value, before) = values.split_last()?;
    if before.is_empty() || !value.is_finite() {
        return None;
    }
    let step = if values.len() > 2 { 2 } else { 1 };
    let pairs = || values.iter().zip(values.iter().skip(step));
    let differences: Vec<Float> = pairs().map(|(a, b)| distance(a, b)).collect();
    let estimate = |error: Float| {
        let error = if error.is_nan() { infinity() } else { error };
        Some(Estimate { value: value.clone(), error })
    };
    if number < FEWEST {
        return estimate(infinity());
    }
    if differences.iter().rev().take(2).all(Float::is_zero) {
        return estimate(Float::new(53));
    }
    let points = differences.iter().zip(0u32..);
    let points: Vec<(f64, f64)> =
        points.filter_map(|(d, k)| Some((f64::from(k), log2(d)?))).collect();
    let by_line = by_line(&points, differences.len() as f64).unwrap_or_else(infinity);
    let error = by_spread(before, value, number).map_or(by_line.clone(), |s| s.min(&by_line));
    let near = before.get(before.len().saturating_sub(2)..).unwrap_or(before);
    estimate(spread(near, value).map_or_else(infinity, |near| error.max(&near)))
}

/// The first judgment of [`settle`]; nothing for b >= 0.
fn by_line(points: &[(f64, f64)], end: f64) -> Option<Float> {
    let line = Line::through(points)?;
    let next = line.at(end) + 3.0 * line.deviation_at(end);
    let ratio = line.slope.exp2();
    let falls = ratio < 1.0 && next.is_finite();
    falls.then(|| Float::with_val(53, next).exp2() * 4u32 / (1.0 - ratio))
}

/// A less cautious judgment of the same sequence, for where another one, independent of it, agrees:
///
///   |error| <= 4 exp(a + b (N + 2) + r l)/(1 - exp b),
///
/// r the largest of the points above the line (differences that are small by accident lie below and
/// do not count), l = sqrt(1 + 1/n + (N + 2 - m)^2/sum (k - m)^2); at least the distance from the two
/// approximants before. Of 733 sums of random functions it alone is too small for 17.
pub(super) fn tentative(values: &[Float], number: usize) -> Option<Tentative> {
    let (value, before) = values.split_last()?;
    if number < FEWEST || before.len() < 2 {
        return None;
    }
    let pairs = values.iter().zip(values.iter().skip(2));
    let points: Vec<(f64, f64)> = pairs
        .zip(0u32..)
        .filter_map(|((a, b), k)| Some((f64::from(k), log2(&distance(a, b))?)))
        .collect();
    let line = Line::through(&points)?;
    let ratio = line.slope.exp2();
    let above = points.iter().map(|p| p.1 - line.at(p.0)).fold(0.0, f64::max);
    let end = (values.len() - 1) as f64;
    let next = line.at(end) + above * line.lever(end);
    if ratio >= 1.0 || !next.is_finite() {
        return None;
    }
    let error = Float::with_val(53, next).exp2() * 4u32 / (1.0 - ratio);
    let near = before.get(before.len() - 2..)?;
    let error = error.max(&spread(near, value)?);
    Some(Tentative { error, before: before.last()?.clone(), ratio, beside: None })
}

/// The second judgment of [`settle`]; nothing with fewer than eight values before the last one.
fn by_spread(before: &[Float], value: &Float, number: usize) -> Option<Float> {
    let near = before.len().checked_sub(4)?;
    let far = near.checked_sub(4)?;
    let first = spread(before.get(near..)?, value)?;
    let second = spread(before.get(far..near)?, value)?;
    let ratio = Float::with_val(53, &second / &first).to_f64();
    let factor = 1.0 / (ratio - 2.0).max(1.0 / number as f64);
    (ratio >= 1.0).then(|| first * (16.0 * factor.max(1.0)))
}

fn infinity() -> Float {
    Float::with_val(53, Special::Infinity)
}

/// A line by least squares, with the standard deviation of the points from it.
struct Line {
    centre: (f64, f64),
    slope: f64,
    deviation: f64,
    count: f64,
    /// The mean of (x - mean x)^2.
    width: f64,
}

impl Line {
    /// Nothing for fewer than three points: two of them are no evidence.
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        if points.len() < 3 {
            return None;
        }
        let count = points.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / count;
        let centre = (mean(&|p| p.0), mean(&|p| p.1));
        let width = mean(&|p| (p.0 - centre.0).powi(2));
        let slope = mean(&|p| (p.0 - centre.0) * (p.1 - centre.1)) / width;
        let mut line = Self { centre, slope, deviation: 0.0, count, width };
        let squares: f64 = points.iter().map(|p| (p.1 - line.at(p.0)).powi(2)).sum();
        line.deviation = (squares / (count - 2.0)).sqrt();
        Some(line)
    }

    /// The standard deviation of a prediction at x.
    fn deviation_at(&self, x: f64) -> f64 {
        self.deviation * self.lever(x)
    }

    fn lever(&self, x: f64) -> f64 {
        let lever = (x - self.centre.0).powi(2) / self.width;
        (1.0 + (1.0 + lever) / self.count).sqrt()
    }

    fn at(&self, x: f64) -> f64 {
        self.centre.1 + self.slope * (x - self.centre.0)
    }
}

/// The last of a sequence of approximants; the error is the largest distance from it in the
/// sequence, times its number: for methods that converge slower than a geometric sequence, as
/// Borel's with Pade approximants of a transform with singularities near the path, where
/// [`settle`]'s line is too steep (after errors k^-p the rest is about k/p last differences).
pub(super) fn widest(values: &[Float], number: usize) -> Option<Estimate> {
    let (value, before) = values.split_last()?;
    let mut estimate = settle(values, number)?;
    let factor = u32::try_from(number.max(4)).unwrap_or(u32::MAX);
    estimate.error = estimate.error.max(&(spread(before, value)? * factor));
    Some(estimate)
}

/// |c_n x^n| for n = 1, 2, ... (53 bits): not as differences of sums, from which a term below the
/// rounding of the first one is lost.
pub(super) fn sizes(c: &[Float], x: &Float) -> Vec<Float> {
    let size = |(c, n): (&Float, u32)| (Float::with_val(64, x.pow(n)) * c).abs();
    c.iter().skip(1).zip(1u32..).map(|pair| Float::with_val(53, size(pair))).collect()
}

/// What may be missing from the partial sum after the given terms (see [`sizes`]) at |x| = `ratio` times the radius of
/// convergence (0 for an unknown one), if the terms go on as they began: below A q^n they leave
///
///   sum_{n > N} A q^n = A q^(N+1)/(1 - q).
///
/// q is the larger of `ratio` and the one between the largest terms of the middle and the last
/// third; A comes from the last third, at least three terms and two that do not vanish. Twice the
/// result; infinite for q >= 1.
///
/// Where the radius is not known, N terms do not tell q from 1 - 1/N: 1/(1 - q) is at least N, the
/// result is doubled twice more, and sums below number six have no estimate.
pub(super) fn geometric_tail(terms: &[Float], ratio: &Float, known: bool) -> Float {
    let last = terms.len();
    let nonzero =
        |from: usize, to: usize| terms.iter().take(to).skip(from).filter(|t| !t.is_zero()).count();
    let mut late = (last * 2 / 3).min(last.saturating_sub(3));
    while late > 0 && nonzero(late, last) < 2 {
        late -= 1;
    }
    let mut early = (last / 3).min(late / 2);
    while early > 0 && nonzero(early, late) == 0 {
        early -= 1;
    }
    if !known && (last < FEWEST || nonzero(early, late) == 0) {
        return infinity();
    }
    let largest = |from: usize, to: usize| {
        let list = terms.iter().take(to).skip(from);
        list.fold(Float::new(53), |a, b| a.max(b))
    };
    let (before, after) = (largest(early, late), largest(late, last));
    let mut ratio = Float::with_val(53, ratio);
    if !before.is_zero() {
        let steps = late.saturating_sub(early).max(1) as f64;
        ratio = ratio.max(&(after / before).pow(1.0 / steps));
    }
    let mut rest = Float::with_val(53, 1 - &ratio);
    if !known {
        rest = rest.min(&Float::with_val(53, 1.0 / last.max(1) as f64));
        rest /= 4u32;
    }
    if rest <= 0 || !rest.is_finite() {
        return infinity();
    }
    let scaled = terms.iter().enumerate().skip(late).map(|(i, term)| {
        let left = u32::try_from(last - i).unwrap_or(u32::MAX);
        Float::with_val(53, (&ratio).pow(left)) * term
    });
    scaled.fold(Float::new(53), |a, b| a.max(&b)) * 2u32 / rest
}

/// The partial sum up to the smallest term, and its order: what is best for a divergent series.
/// The error estimate is the largest of the smallest term and its two neighbours.
pub(super) fn best_truncation(sums: &[Float], terms: &[Float]) -> Option<(usize, Estimate)> {
    let smallest = (0..terms.len()).min_by(|&i, &j| terms[i].total_cmp(&terms[j]))?;
    let around = terms.get(smallest.saturating_sub(1)..(smallest + 2).min(terms.len()))?;
    let error = around.iter().cloned().reduce(|a, b| a.max(&b))?;
    let value = sums.get(smallest + 1)?.clone();
    Some((smallest + 1, Estimate { value, error }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The remainder of sum q^n cos(n phi) n^p at random q next to one, for slow oscillations too.
    #[test]
    fn tails_are_above_the_remainder() {
        for q in [0.3f64, 0.9, 0.99, 0.9995] {
            for phi in [0.0f64, 0.05, 0.4, 1.0, 3.1] {
                for p in [-3.0f64, -1.5, -0.5, 0.0] {
                    let term =
                        |n: i32| q.powi(n) * (f64::from(n) * phi).cos() * f64::from(n).powf(p);
                    for number in [8, 15, 30] {
                        let terms: Vec<Float> =
                            (1..=number).map(|n| Float::with_val(53, term(n).abs())).collect();
                        let found = geometric_tail(&terms, &Float::with_val(53, q), true);
                        let rest: f64 = (number + 1..80_000).map(term).sum();
                        assert!(found >= rest.abs(), "{q} {phi} {p} {number}: {found} {rest}");
                    }
                }
            }
        }
    }

    /// Errors q^k cos(k phi + psi), k^-p and 1/k!: the estimate holds for all of them.
    #[test]
    fn estimates_are_above_the_errors() {
        type Model = Box<dyn Fn(f64) -> f64>;
        let mut models: Vec<Model> = Vec::new();
        for q in [0.01f64, 0.3, 0.6, 0.9, 0.97] {
            for phi in
                [0.0f64, 0.4, 1.0, 1.57, 2.2, 3.1].into_iter().filter(|p| q < 0.9 || *p != 0.4)
            {
                models.push(Box::new(move |k| q.powf(k) * (k * phi + 0.3).cos()));
            }
        }
        for p in [1.0f64, 1.5, 3.0, 6.0] {
            models.push(Box::new(move |k| k.powf(-p)));
        }
        models.push(Box::new(|k| (1..=k as u32).map(|i| 1.0 / f64::from(i)).product()));
        let mut checked = 0;
        for (index, model) in models.iter().enumerate() {
            for number in 8..60usize {
                for before in [9usize, 12] {
                    let list: Vec<Float> = (number.saturating_sub(before).max(1)..=number)
                        .map(|k| Float::with_val(200, 1.0) + model(k as f64))
                        .collect();
                    let found = settle(&list, number).unwrap();
                    let error = model(number as f64).abs();
                    // Not below the rounding, which the caller measures, and not before anything
                    // has converged.
                    if !(1e-55..0.1).contains(&error) {
                        continue;
                    }
                    assert!(
                        found.error >= error,
                        "{number} {before} {index}: {} < {error}",
                        found.error
                    );
                    checked += 1;
                }
            }
        }
        assert!(checked > 2000, "{checked}");
    }
}
