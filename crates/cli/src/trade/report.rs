//! The measured rows as text, JSON and CSV.

use super::Wanted;
use crate::arguments::Format;
use lindstedt::equation::print::Style;
use lindstedt::trade::{LeftOut, Plan, Reason, Row, Summation, Trade, pareto};
use serde_json::{Value as Json, json};
use std::fmt::Write;

const MEMORY: &str = "estimated: numbers kept at once times their size";
const AGAIN: &str = "for one more value of the small parameter";
const ERRORS: &str = "relative errors of the period";

/// Where the row's method has harmonics instead of digits.
fn harmonics(row: &Row) -> Option<usize> {
    match row.method {
        lindstedt::trade::Method::Fourier { harmonics } => Some(harmonics),
        _ => None,
    }
}

/// How the series is summed, as after `--resum`.
fn summed(row: &Row) -> Option<&'static str> {
    row.summation.as_ref().map(Summation::name)
}

fn row_json(row: &Row, on_front: bool) -> Json {
    json!({
        "tier": row.method.name(),
        "order": row.order,
        "digits": row.method.digits(),
        "harmonics": harmonics(row),
        "summed": summed(row),
        "seconds": row.seconds,
        "seconds_again": row.seconds_again,
        "memory_bytes": row.bytes,
        "period": period(row),
        "true_error": row.true_error,
        "stated_error": row.stated_error.is_finite().then_some(row.stated_error),
        "pareto": on_front,
    })
}

/// The digits that the stated error supports, and two more; without one, all.
fn period(row: &Row) -> String {
    if !row.stated_error.is_finite() {
        return row.period.to_string_radix(10, None);
    }
    let digits = (-row.stated_error.max(1e-300).log10()).max(0.0) as usize + 3;
    row.period.to_string_radix(10, Some(digits.min(row.period.prec() as usize * 3 / 10).max(2)))
}

fn reason(reason: &Reason, plan: &Plan) -> String {
    match reason {
        Reason::TooLong => format!("longer than {} s", plan.run_seconds),
        Reason::Predicted(s) if s.is_infinite() => "a lower order takes too long".to_owned(),
        Reason::Predicted(s) if *s > 1e4 => "predicted to take hours".to_owned(),
        Reason::Predicted(s) => format!("predicted to take {s:.0} s"),
        Reason::Refused(error) => error.to_string(),
        Reason::NotIntegrated(error) => error.to_string(),
        _ => "left out".to_owned(),
    }
}

/// The value of the small parameter, exact where it is rational.
fn small(trade: &Trade) -> String {
    let decimal = || trade.truth.small.to_string_radix(10, Some(30));
    trade.truth.rational_small.as_ref().map_or_else(decimal, ToString::to_string)
}

pub fn json(trade: &Trade, plan: &Plan, wanted: Wanted) -> Json {
    let front = pareto(&trade.rows);
    let rows: Vec<Json> =
        trade.rows.iter().enumerate().map(|(i, row)| row_json(row, front.contains(&i))).collect();
    let left = |left: &LeftOut| {
        json!({
            "tier": left.method.name(),
            "order": left.order,
            "digits": left.method.digits(),
            "reason": reason(&left.reason, plan),
        })
    };
    let at: serde_json::Map<String, Json> =
        trade.truth.at.iter().map(|(k, v)| (k.clone(), json!(v.to_string()))).collect();
    let row = |i: Option<usize>| {
        let i = i?;
        Some(row_json(trade.rows.get(i)?, front.contains(&i)))
    };
    let recommendation = wanted.is_some().then(|| {
        json!({
            "error": wanted.error,
            "seconds": wanted.seconds,
            "row": row(wanted.best(&trade.rows)),
            "for_many": row(wanted.best_for_many(&trade.rows)),
            "within": row(wanted.within(&trade.rows)),
        })
    });
    let digits = trade.truth.period.prec() as usize * 3 / 10 - 18;
    json!({
        "problem": trade.problem.name,
        "at": at,
        "parameter": trade.problem.small,
        "small": small(trade),
        "period": trade.truth.period.to_string_radix(10, Some(digits)),
        "period_error": trade.truth.uncertainty,
        "source": trade.truth.source,
        "errors": ERRORS,
        "memory": MEMORY,
        "repeats": plan.repeats,
        "rows": rows,
        "pareto": front,
        "left_out": trade.left_out.iter().map(left).collect::<Vec<_>>(),
        "recommendation": recommendation,
        "finished": trade.finished,
    })
}

pub fn csv(trade: &Trade) -> String {
    let front = pareto(&trade.rows);
    let mut text =
        "tier,order,digits,harmonics,summed,seconds,seconds_again,memory_bytes,true_error,stated_error,pareto\n"
            .to_owned();
    let number = |n: Option<usize>| n.map_or(String::new(), |n| n.to_string());
    for (i, row) in trade.rows.iter().enumerate() {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{:e},{:e},{},{:e},{:e},{}",
            row.method.name(),
            number(row.order),
            row.method.digits(),
            number(harmonics(row)),
            summed(row).unwrap_or(""),
            row.seconds,
            row.seconds_again,
            row.bytes,
            row.true_error,
            row.stated_error,
            u8::from(front.contains(&i)),
        );
    }
    text
}

/// 1.2 us, 34 ms, 5.6 s.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{s:.1e} s"),
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e4 => format!("{b:.0} B"),
        b if b < 1e7 => format!("{:.0} kB", b / 1e3),
        b => format!("{:.0} MB", b / 1e6),
    }
}

fn precision(row: &Row) -> String {
    harmonics(row)
        .map_or_else(|| format!("{} digits", row.method.digits()), |n| format!("{n} harm."))
}

pub fn text(trade: &Trade, plan: &Plan, wanted: Wanted, format: Format) -> String {
    let mut text = String::new();
    let at: Vec<String> = trade.truth.at.iter().map(|(k, v)| format!("{k} = {v}")).collect();
    let equation = trade.problem.equation.print(&trade.problem.small, Style::Text);
    let digits = (trade.truth.period.prec() as usize * 3 / 10 - 18).min(40);
    let _ = writeln!(text, "{}: {equation} = 0 at {}", trade.problem.name, at.join(", "));
    let _ = writeln!(
        text,
        "T = {} ({}); {ERRORS}; time: best of {}; again: {AGAIN}; memory {MEMORY}; * is on the Pareto front.",
        trade.truth.period.to_string_radix(10, Some(digits)),
        trade.truth.source,
        plan.repeats,
    );
    let (gap, end) = match format {
        Format::Markdown => (" | ", " |"),
        Format::Latex => (" & ", " \\\\"),
        _ => ("  ", ""),
    };
    let begin = if format == Format::Markdown { "| " } else { "" };
    let line = |cells: [String; 9], text: &mut String| {
        let widths = [16, 5, 10, 12, 10, 10, 9, 11, 12];
        let cells: Vec<String> =
            cells.iter().zip(widths).map(|(c, w)| format!("{c:<w$}")).collect();
        let _ = writeln!(text, "{begin}{}{end}", cells.join(gap).trim_end());
    };
    let titles = [
        "tier",
        "order",
        "precision",
        "summed",
        "time",
        "again",
        "memory",
        "true error",
        "stated error",
    ];
    match format {
        Format::Markdown => text.push('\n'),
        Format::Latex => text.push_str("\\begin{tabular}{lllllllll}\n"),
        _ => {}
    }
    line(titles.map(str::to_owned), &mut text);
    if format == Format::Markdown {
        text.push_str("|---|---|---|---|---|---|---|---|---|\n");
    }
    let front = pareto(&trade.rows);
    for (i, row) in trade.rows.iter().enumerate() {
        let mark = if front.contains(&i) { "*" } else { "" };
        let cells = [
            format!("{}{mark}", row.method.name()),
            row.order.map_or(String::new(), |n| n.to_string()),
            precision(row),
            summed(row).unwrap_or("").to_owned(),
            duration(row.seconds),
            duration(row.seconds_again),
            size(row.bytes),
            format!("{:.1e}", row.true_error),
            stated(row),
        ];
        line(cells, &mut text);
    }
    if format == Format::Latex {
        text.push_str("\\end{tabular}\n");
    }
    for left in &trade.left_out {
        let order = left.order.map_or(String::new(), |n| format!(", order {n}"));
        let (name, digits) = (left.method.name(), left.method.digits());
        let why = reason(&left.reason, plan);
        let _ = writeln!(text, "Left out: {name}, {digits} digits{order}: {why}.");
    }
    if wanted.is_some() {
        let _ = writeln!(text, "{}", advice(trade, wanted));
    }
    text
}

fn stated(row: &Row) -> String {
    match row.stated_error {
        e if e.is_finite() => format!("{e:.1e}"),
        _ => "none".to_owned(),
    }
}

/// The fastest run that states an error.
fn fastest(rows: &[Row]) -> Option<usize> {
    let states = |i: &usize| rows.get(*i).is_some_and(|row| row.stated_error.is_finite());
    let seconds = |i: &usize| rows.get(*i).map_or(f64::INFINITY, |row| row.seconds);
    (0..rows.len()).filter(states).min_by(|a, b| seconds(a).total_cmp(&seconds(b)))
}

fn advice(trade: &Trade, wanted: Wanted) -> String {
    let row = |i: Option<usize>| trade.rows.get(i?);
    let name = |row: &Row| {
        let order = row.order.map_or(String::new(), |n| format!(", order {n}"));
        let sum = summed(row).map_or(String::new(), |s| format!(", summed by {s}"));
        let sum = sum.replace("by none", "as it stands");
        let (name, precision) = (row.method.name(), precision(row));
        format!("{name}{order}, {precision}{sum} (states {})", stated(row))
    };
    let mut lines = Vec::new();
    if let Some(error) = wanted.error {
        match (row(wanted.best(&trade.rows)), row(wanted.best_for_many(&trade.rows))) {
            (Some(one), Some(many)) => {
                lines.push(format!("For {error:e} in {}: {}.", duration(one.seconds), name(one)));
                lines.push(format!(
                    "For {error:e} at many values, {} each after {}: {}.",
                    duration(many.seconds_again),
                    duration(many.seconds),
                    name(many)
                ));
            }
            _ if wanted.seconds.is_some() => {
                lines.push(format!("For {error:e}: no run here states it in that time."));
            }
            _ => lines.push(format!("For {error:e}: no run here states so small an error.")),
        }
    }
    if let Some(seconds) = wanted.seconds {
        lines.push(match row(wanted.within(&trade.rows)) {
            Some(best) => format!("Within {}: {}.", duration(seconds), name(best)),
            None => match row(fastest(&trade.rows)) {
                Some(fast) => format!(
                    "Within {}: no run here; the fastest that states an error takes {}: {}.",
                    duration(seconds),
                    duration(fast.seconds),
                    name(fast)
                ),
                None => format!("Within {}: no run here states an error.", duration(seconds)),
            },
        });
    }
    lines.join("\n")
}
