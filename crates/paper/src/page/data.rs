//! The measurements of the summary as data.

use super::field;
use crate::Trust;
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// The measurements behind the summary.
pub fn json(trust: &Trust) -> Json {
    let findings: Vec<Json> = trust
        .findings()
        .into_iter()
        .map(|f| {
            json!({
                "section": f.section, "method": f.method, "trusted": f.trusted,
                "not_trusted": f.not_trusted, "class": f.class,
            })
        })
        .collect();
    let region = trust.region.as_ref().map(|region| {
        let rate = |r: &crate::trust::Rate| {
            json!({"rule": r.rule, "compared": r.compared, "equal": r.equal, "rate": r.share()})
        };
        json!({
            "points": region.sample.points, "stable": region.sample.stable,
            "rules": region.sample.rates.iter().map(rate).collect::<Vec<_>>(),
            "chart_orbit": region.orbit, "status": "estimated",
        })
    });
    let onset = trust.onset.as_ref().map(|onset| {
        let side = |s: Option<(f64, f64)>| s.map(|s| json!({"gamma": s.0, "error": s.1}));
        let points = onset
            .points
            .iter()
            .map(|p| json!({"eps": p.eps, "right": side(p.right), "left": side(p.left)}));
        json!({
            "threshold": onset.threshold, "points": points.collect::<Vec<_>>(),
            "status": "estimated",
        })
    });
    let truncations = trust.truncations.iter().map(|t| {
        json!({
            "name": t.name, "delta": t.delta.to_string(), "errors": t.errors,
            "errors_in_u": t.resummed, "best_order": t.best().map(|b| b.0),
        })
    });
    json!({
        "findings": findings, "region": region, "onset": onset,
        "truncations": truncations.collect::<Vec<_>>(),
    })
}

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
