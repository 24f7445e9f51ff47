//! What is worth its time.

use super::{Plan, Recommendation, Row};

/// The indices of the rows that no other row beats in both time and true error, from the fastest
/// to the most accurate. Of equal rows the first stays.
///
/// O(n log n).
#[must_use]
pub fn pareto(rows: &[Row]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    let key = |i: &usize| rows.get(*i).map_or((f64::NAN, f64::NAN), |r| (r.seconds, r.true_error));
    order.sort_by(|a, b| {
        let ((s, e), (t, f)) = (key(a), key(b));
        s.total_cmp(&t).then(e.total_cmp(&f)).then(a.cmp(b))
    });
    let mut least = f64::INFINITY;
    order.retain(|i| {
        let better = key(i).1 < least;
        if better {
            least = key(i).1;
        }
        better
    });
    order
}

/// The fastest row whose *stated* relative error is at most `error`: what a user can know who does
/// not know the truth. Of equally fast rows the first.
#[must_use]
pub fn recommend(rows: &[Row], error: f64) -> Option<usize> {
    fastest(rows, error, |row| row.seconds)
}

/// As [`recommend`], by the time for one more value of the small parameter.
#[must_use]
pub fn recommend_for_many(rows: &[Row], error: f64) -> Option<usize> {
    fastest(rows, error, |row| row.seconds_again)
}

/// The row with the least stated error among those that take at most so many seconds; of equally
/// accurate ones the fastest. Nothing where none of them states an error.
#[must_use]
pub fn most_accurate(rows: &[Row], seconds: f64) -> Option<usize> {
    let good = rows.iter().enumerate();
    let good = good.filter(|(_, row)| row.seconds <= seconds && row.stated_error.is_finite());
    let order = |a: &Row, b: &Row| {
        a.stated_error.total_cmp(&b.stated_error).then(a.seconds.total_cmp(&b.seconds))
    };
    good.min_by(|(_, a), (_, b)| order(a, b)).map(|(i, _)| i)
}

fn fastest(rows: &[Row], error: f64, time: impl Fn(&Row) -> f64) -> Option<usize> {
    let good = rows.iter().enumerate().filter(|(_, row)| row.stated_error <= error);
    good.min_by(|(_, a), (_, b)| time(a).total_cmp(&time(b))).map(|(i, _)| i)
}

impl Plan {
    /// The rows for the error and the time asked for: with both the time limits the row for the error,
    /// and that for many values by the time of each, which may be bought with a longer derivation.
    pub(super) fn recommended(&self, rows: &[Row]) -> Option<Recommendation> {
        let (error, seconds) = (self.error, self.seconds);
        error.or(seconds)?;
        let most = seconds.unwrap_or(f64::INFINITY);
        let row = |index: Option<usize>| rows.get(index?).cloned();
        Some(Recommendation {
            error,
            seconds,
            row: row(error.and_then(|e| recommend(rows, e))).filter(|row| row.seconds <= most),
            for_many: row(error.and_then(|e| recommend_for_many(rows, e)))
                .filter(|row| row.seconds_again <= most),
            within: row(seconds.and_then(|s| most_accurate(rows, s))),
            fastest: row(recommend(rows, f64::MAX)),
        })
    }
}
