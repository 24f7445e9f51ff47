//! The measurements of the figures as tables.

use super::field;
use crate::Trust;
use std::fmt::Write;

/// The data of the figures that no table has: the planes of the gains, the errors by order.
pub fn csv(trust: &Trust) -> Vec<(String, String)> {
    let mut files = Vec::new();
    if let Some(region) = &trust.region {
        let mut text = String::from("rule,A,B,predicted,true\n");
        let word = |v: Option<lindstedt_impact::map::Verdict>| {
            v.map_or(String::new(), |v| format!("{v:?}").to_lowercase())
        };
        for found in &region.charts {
            let width = found.chart.plan.columns.count;
            for (n, point) in found.chart.points.iter().enumerate() {
                let a = found.chart.plan.columns.value(n % width);
                let b = found.chart.plan.rows.value(n / width);
                let (says, is) = (word(point.predicted), word(point.exact));
                let _ = writeln!(text, "{},{a:.6},{b:.6},{says},{is}", field(found.rule));
            }
        }
        files.push(("region.csv".to_owned(), text));
    }
    if !trust.truncations.is_empty() {
        let mut text = String::from("case,delta,order,error,error_in_u\n");
        for t in &trust.truncations {
            for (n, error) in t.errors.iter().enumerate() {
                let other = t.resummed.get(n).map_or(String::new(), |e| format!("{e:.3e}"));
                let _ = writeln!(text, "{},{},{n},{error:.3e},{other}", t.name, t.delta);
            }
        }
        files.push(("orders.csv".to_owned(), text));
    }
    files
}
