//! The presentation of an evaluation.

use super::flag;
use super::trajectory::Table;
use crate::arguments::Resum;
use crate::session::Session;
use crate::session::number_json;
use lindstedt::Number;
use lindstedt::equation::Problem;
use lindstedt::evaluate::{Evaluation, kind_name, method_name, rounded};
use lindstedt::series::resummation::{Complex, Growth};
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// An evaluation and what was asked for.
pub struct Report<'a> {
    pub problem: &'a Problem,
    pub result: &'a Evaluation,
    pub resum: Resum,
    pub solution: Option<&'a Table>,
}

/// A double for a picture.
fn pair(z: &Complex) -> Json {
    json!([z.re.to_f64(), z.im.to_f64()])
}

fn optional(number: Option<&Number>) -> Json {
    number.map_or(Json::Null, number_json)
}

/// One decimal more than the first that is in doubt: what rounding adds is below the error.
fn decimals(error: &rug::Float) -> usize {
    let places = if error.is_zero() { 30.0 } else { 1.0 - error.clone().log10().to_f64() };
    places.floor().clamp(0.0, 30.0) as usize
}

/// The error with that of rounding the value to [`decimals`], rounded up.
fn stated(error: &rug::Float) -> String {
    let rounding = 0.5 * 10f64.powi(-(decimals(error) as i32));
    format!("{:.1e}", (error.to_f64() + rounding) * 1.06)
}

impl Report<'_> {
    pub fn json(&self, session: &Session<'_>) -> Json {
        let result = self.result;
        let at: serde_json::Map<String, Json> = result
            .at
            .iter()
            .map(|(name, value)| ((*name).to_owned(), Json::from(value.to_string())))
            .collect();
        let resummed = &result.resummed;
        let tried: Vec<Json> = resummed
            .tried
            .iter()
            .map(|(method, found)| match found {
                Ok(error) if error.is_finite() => {
                    json!({"resum": flag(*method), "error": format!("{error:.2e}")})
                }
                Ok(_) => json!({"resum": flag(*method), "error": null}),
                Err(reason) => json!({"resum": flag(*method), "refused": reason.to_string()}),
            })
            .collect();
        let growth = match resummed.growth {
            Growth::Entire => json!({"kind": "entire"}),
            Growth::Radius { .. } => {
                let [radius, error] = result
                    .estimated_radius()
                    .map_or_else(Default::default, |(radius, error)| rounded(radius, error));
                let double = |text: &str| text.parse::<f64>().ok();
                json!({"kind": "radius", "radius": double(&radius), "error": double(&error)})
            }
            Growth::Factorial { rate } => json!({"kind": "factorial", "rate": rate}),
            _ => json!({"kind": "undecided"}),
        };
        let best = result.best_truncation.as_ref();
        json!({
            "problem": self.problem.name,
            "at": at,
            "order": result.order,
            "resum": flag(resummed.method),
            "period": optional(result.period.as_ref()),
            "frequency": optional(result.frequency.as_ref()),
            "exact_period": optional(result.exact_period.as_ref()),
            "verdict": result.verdict,
            "true_error": result.true_error,
            "asked": if self.resum == Resum::Auto { "auto" } else { flag(resummed.method) },
            "quantity": format!("T/(2*pi) as a series in {}", result.variable),
            "degrees": resummed.outcome.degrees.map(|(l, m)| json!([l, m])),
            "tried": tried,
            "coefficients": growth,
            "best_truncation": best.map(|(order, number)| json!({"order": order, "period": optional(number.as_ref())})),
            "singularity": self.singularity(),
            "pade": result.picture.as_ref().map(|picture| json!({
                "poles": picture.poles.iter().map(|p| json!({"at": pair(&p.at), "residue": pair(&p.residue), "doublet": p.doublet})).collect::<Vec<_>>(),
                "zeros": picture.zeros.iter().map(pair).collect::<Vec<_>>(),
            })),
            "solution": self.solution.map(Table::json),
            "seconds": session.elapsed().as_secs_f64(),
        })
    }

    /// The nearest singularity with as many digits as the approximants agree upon.
    fn singularity(&self) -> Json {
        let Some(found) = &self.result.resummed.singularity else { return Json::Null };
        json!({
            "at": [self.digits(&found.at.re, &found.error), self.digits(&found.at.im, &found.error)],
            "error": stated(&found.error),
            "exponent": self.digits(&found.exponent, &found.exponent_error),
            "exponent_error": stated(&found.exponent_error),
            "kind": kind_name(found.kind),
            "status": "estimated",
        })
    }

    fn digits(&self, x: &rug::Float, error: &rug::Float) -> String {
        let places = decimals(error);
        let scaled = rug::Float::with_val(x.prec(), x);
        if scaled.clone().abs() <= error.clone() {
            "0".to_owned()
        } else {
            format!("{:.*}", places, Fixed(&scaled))
        }
    }

    fn lines(&self) -> Vec<(String, String)> {
        let result = self.result;
        let shown = |number: &Option<Number>| match number {
            None => "not one digit".to_owned(),
            Some(number) => match &number.error {
                Some(error) if result.has_no_estimate() => {
                    format!("{} +- {error} (by the closed form)", number.decimal)
                }
                Some(error) => format!("{} +- {error} (estimated)", number.decimal),
                None => format!("{} (no estimate from so few coefficients)", number.decimal),
            },
        };
        let mut lines = vec![
            ("period T".to_owned(), shown(&result.period)),
            ("frequency 2*pi/T".to_owned(), shown(&result.frequency)),
        ];
        if let Some(exact) = &result.exact_period {
            let form = exact.exact.as_deref().unwrap_or("");
            lines.push(("exact period".to_owned(), format!("{} = {form}", exact.decimal)));
        }
        if let Some(error) = &result.true_error {
            lines.push(("true error of T".to_owned(), error.clone()));
        }
        let resummed = &result.resummed;
        let how = format!(
            "{} of T/(2*pi) in {}, order {}",
            method_name(resummed.method),
            result.variable,
            result.order
        );
        lines.push(("summed".to_owned(), how));
        for (name, outcome) in result.tried() {
            lines.push((format!("  {name}"), outcome));
        }
        if let Some(found) = &resummed.singularity {
            let (re, im) =
                (self.digits(&found.at.re, &found.error), self.digits(&found.at.im, &found.error));
            let place = if im == "0" { re } else { format!("{re} +- {im}*i") };
            let exponent = self.digits(&found.exponent, &found.exponent_error);
            let kind = kind_name(found.kind);
            lines.push((
                "nearest singularity".to_owned(),
                format!("{place}, {kind} (exponent {exponent}), error {}", stated(&found.error)),
            ));
        }
        if let Some(picture) = &result.picture {
            let doublets = picture.poles.iter().filter(|p| p.doublet).count();
            let text = format!(
                "{} poles, {doublets} of them in doublets with a zero, {} zeros",
                picture.poles.len(),
                picture.zeros.len()
            );
            lines.push(("diagonal Pade".to_owned(), text));
        }
        lines.push(("verdict".to_owned(), result.verdict.clone()));
        lines
    }

    fn heading(&self) -> String {
        let parts: Vec<String> = self.result.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        format!("{}: {}", self.problem.name, parts.join(", "))
    }

    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n", self.heading());
        for (label, value) in self.lines() {
            let _ = writeln!(text, "  {label:<24} {value}");
        }
        if let Some(table) = self.solution {
            text.push_str(&table.text());
        }
        text
    }

    pub fn markdown(&self) -> String {
        let mut text = format!("### {}\n\n| | |\n|---|---|\n", self.heading());
        for (label, value) in self.lines() {
            let escape = |s: &str| s.trim().replace('|', "\\|").replace('*', "\\*");
            let _ = writeln!(text, "| {} | {} |", escape(&label), escape(&value));
        }
        if let Some(table) = self.solution {
            text.push_str("\n| t | x | error |\n|---|---|---|\n");
            for [time, value, error] in table.rows() {
                let _ = writeln!(text, "| {time} | {value} | {error} |");
            }
        }
        text
    }

    pub fn latex(&self) -> String {
        let mut text = String::from("\\begin{tabular}{lp{0.7\\textwidth}}\n");
        for (label, value) in self.lines() {
            let escape =
                |s: &str| s.trim().replace('_', "\\_").replace('^', "\\^{}").replace('|', "$|$");
            let _ = writeln!(text, "{} & {} \\\\", escape(&label), escape(&value));
        }
        text.push_str("\\end{tabular}\n");
        if let Some(table) = self.solution {
            text.push_str("\\begin{tabular}{lll}\nt & x & error \\\\\n");
            for [time, value, error] in table.rows() {
                let _ = writeln!(text, "{time} & {value} & {error} \\\\");
            }
            text.push_str("\\end{tabular}\n");
        }
        text
    }
}

/// A float with a fixed number of decimals.
struct Fixed<'a>(&'a rug::Float);

impl std::fmt::Display for Fixed<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let places = f.precision().unwrap_or(6);
        let scale =
            rug::Integer::from(rug::Integer::u_pow_u(10, u32::try_from(places).unwrap_or(30)));
        let shifted = rug::Float::with_val(self.0.prec() + 128, self.0 * &scale).round();
        let Some(integer) = shifted.to_integer() else { return write!(f, "{}", self.0) };
        let digits = format!("{:0>width$}", integer.clone().abs().to_string(), width = places + 1);
        let (whole, fraction) = digits.split_at(digits.len() - places);
        let sign = if integer < 0 { "-" } else { "" };
        if places == 0 { write!(f, "{sign}{whole}") } else { write!(f, "{sign}{whole}.{fraction}") }
    }
}
