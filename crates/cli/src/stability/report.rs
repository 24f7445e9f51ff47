//! One point: the true orbit, the prediction and the truth, as JSON and as text.

use super::chart::Grid;
use super::request::Request;
use crate::arguments::{Format, PredictorChoice};
use crate::averaging::{convergence_json, divergence};
use crate::derive::number_json;
use lindstedt::Number;
use lindstedt::number::complex::Complex;
use lindstedt::number::real::Real;
use lindstedt_impact::equivalent::EquivalentOrbit;
use lindstedt_impact::map::Verdict;
use lindstedt_impact::report::StabilityReport;
use serde_json::{Map, Value as Json, json};
use std::fmt::Write;

pub struct Answer {
    problem: String,
    canonical: Option<Map<String, Json>>,
    request_at: Map<String, Json>,
    body: Map<String, Json>,
    /// Whether the orbit exists: with a penetrating flight it does not, with a touching one it is
    /// not decided.
    pub exists: Option<bool>,
    pub warnings: Vec<String>,
}

fn exists<S>(report: &StabilityReport<S>) -> Option<bool> {
    match &report.orbit {
        Ok(found) => found.penetrates.map(|penetrates| !penetrates),
        Err(_) => Some(false),
    }
}

/// Writes numbers of one report.
struct Writer<'a, S>(&'a dyn Fn(&S) -> Number);

impl<S: Real> Writer<'_, S> {
    fn number(&self, x: &S) -> Json {
        number_json(&(self.0)(x))
    }
    fn pair(&self, z: &Complex<S>) -> Json {
        json!([self.number(&z.re), self.number(&z.im)])
    }
    fn orbit(&self, orbit: &EquivalentOrbit<S>) -> Json {
        json!({
            "exists": true,
            "impact_velocity": self.number(&orbit.velocity),
            "phase": self.number(&orbit.phase_angle()),
            "C": self.number(&orbit.cosine),
            "D": self.number(&orbit.sine),
        })
    }
}

const RETURN_MAP: &str = "The truth: growth of the piecewise linear return map (B is not 0: the \
                          characteristic function G and its multipliers are an approximation)";

/// What the multipliers are for B != 0, whatever is known of their digits.
const ROOTS_OF_G: &str = "zeros of G, which approximates the return map; their digits are those of \
                          the zeros, not of multipliers of the map";

const PENETRATES: &str = "no orbit: the flight passes through the wall";

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Neutral => "undecided: a multiplier on or near the unit circle",
    }
}

fn stable(verdict: Verdict) -> Json {
    match verdict {
        Verdict::Stable => json!(true),
        Verdict::Unstable => json!(false),
        Verdict::Neutral => Json::Null,
    }
}

fn refused(error: &dyn std::fmt::Display) -> Json {
    json!({"exists": false, "reason": error.to_string()})
}

impl Answer {
    pub fn new<S: Real>(
        request: &Request,
        report: &StabilityReport<S>,
        number: &dyn Fn(&S) -> Number,
    ) -> Self {
        let w = Writer(number);
        let mut body = Map::new();
        let mut warnings = Vec::new();
        body.insert("orbit".to_owned(), orbit(&w, report, &mut warnings));
        if request.predictor != PredictorChoice::Exact {
            body.insert("kbm".to_owned(), prediction(&w, request, report, &mut warnings));
        }
        if let Some(aware) = &report.impact_aware
            && request.predictor != PredictorChoice::Exact
        {
            let aware = match aware {
                Ok(found) => json!({
                    "multipliers": found.multipliers.iter().map(|z| {
                        let z = z.to_f64();
                        json!([number_json(&Number::double(z.re)), number_json(&Number::double(z.im))])
                    }).collect::<Vec<_>>(),
                    "stable": stable(found.verdict()),
                    "order": request.order,
                    "status": "estimated",
                }),
                Err(error) => json!({"reason": error.to_string()}),
            };
            body.insert("impact_aware".to_owned(), aware);
        }
        if request.predictor != PredictorChoice::Kbm {
            body.insert("exact".to_owned(), exact(&w, request, report));
        }
        let object = |list: &Vec<(String, String)>| -> Map<String, Json> {
            list.iter().map(|(name, value)| (name.clone(), json!(value))).collect()
        };
        warnings.extend(request.remark.clone());
        Self {
            problem: request.problem.clone(),
            canonical: request.canonical.as_ref().map(object),
            request_at: object(&request.at),
            body,
            exists: exists(report),
            warnings,
        }
    }

    pub fn json(&self, grid: Option<&Grid>) -> Json {
        let mut all = Map::new();
        all.insert("problem".to_owned(), json!(self.problem));
        all.insert("at".to_owned(), Json::Object(self.request_at.clone()));
        if let Some(canonical) = &self.canonical {
            all.insert("canonical".to_owned(), Json::Object(canonical.clone()));
        }
        all.extend(self.body.clone());
        all.insert("grid".to_owned(), grid.map_or(Json::Null, Grid::json));
        all.insert("warnings".to_owned(), json!(self.warnings));
        if self.exists != Some(true) && grid.is_none() {
            let code = if self.exists.is_some() { "no-orbit" } else { "undecided" };
            let message = self.warnings.first();
            all.insert("error".to_owned(), json!({"code": code, "message": message, "hint": ""}));
        }
        Json::Object(all)
    }

    pub fn text(&self, format: Format, grid: Option<&Grid>) -> String {
        let listed = |map: &Map<String, Json>| -> String {
            let one = |(name, value): (&String, &Json)| {
                format!("{name} = {}", value.as_str().unwrap_or_default())
            };
            map.iter().map(one).collect::<Vec<_>>().join(", ")
        };
        let mut text = String::new();
        let fence = match format {
            Format::Markdown => "```\n",
            Format::Latex => "\\begin{verbatim}\n",
            _ => "",
        };
        text += fence;
        let _ = writeln!(text, "{} at {}\n", self.problem, listed(&self.request_at));
        if let Some(canonical) = &self.canonical {
            let _ = writeln!(text, "As the oscillator of section 2: {}\n", listed(canonical));
        }
        let titles = [
            ("orbit", "The orbit of the true system (without perturbation the loop is silent)"),
            ("kbm", "What averaging predicts (not the stability of the delayed system)"),
            ("impact_aware", "Averaging that knows of the impact within the delay (estimated)"),
            ("exact", "The truth: zeros of the characteristic function G in the unit disc"),
        ];
        for (key, title) in titles {
            if let Some(Json::Object(map)) = self.body.get(key) {
                // For B != 0 the return map is only piecewise linear: it decides.
                let mapped = map.contains_key("return_map");
                let title = if mapped { RETURN_MAP } else { title };
                let _ = writeln!(text, "{title}");
                for (name, value) in map {
                    let _ = writeln!(text, "  {name}: {}", plain(value));
                }
                text.push('\n');
            }
        }
        if let Some(grid) = grid {
            let _ = writeln!(text, "{}", grid.summary());
            if let Some(picture) = grid.picture() {
                let _ = writeln!(text, "{picture}");
            }
        }
        text += match format {
            Format::Markdown => "```\n",
            Format::Latex => "\\end{verbatim}\n",
            _ => "",
        };
        text
    }
}

fn orbit<S: Real>(
    w: &Writer<'_, S>,
    report: &StabilityReport<S>,
    warnings: &mut Vec<String>,
) -> Json {
    let found = match &report.orbit {
        Ok(found) => found,
        Err(error) => {
            warnings.push(format!("no orbit: {error}"));
            return refused(error);
        }
    };
    match found.penetrates {
        Some(false) => {}
        Some(true) => warnings.push(PENETRATES.to_owned()),
        None => warnings.push("it is not decided whether the flight passes the wall".to_owned()),
    }
    let form = |part: &dyn Fn(&lindstedt_impact::report::FormReport<S>) -> Json| {
        found.form.as_ref().map_or(Json::Null, part)
    };
    json!({
        "exists": exists(report),
        "impact_velocity": w.number(&found.orbit.velocity),
        "phase": form(&|f| w.number(&f.phase)),
        "C": form(&|f| w.number(&f.cosine)),
        "D": form(&|f| w.number(&f.sine)),
        "penetrates": found.penetrates,
        "clearance": found.clearance.as_ref().map(|c| w.number(&c.margin)),
        "force_phase": w.number(&found.orbit.force_angle()),
        "acceleration_before": w.number(&found.orbit.acceleration_before),
        "acceleration_after": w.number(&found.orbit.acceleration_after),
        "saltation": w.number(&found.orbit.saltation),
        "discriminant": w.number(&found.orbit.discriminant),
    })
}

fn prediction<S: Real>(
    w: &Writer<'_, S>,
    request: &Request,
    report: &StabilityReport<S>,
    warnings: &mut Vec<String>,
) -> Json {
    let convergence = &report.convergence;
    if convergence.diverges() {
        warnings.push(divergence(convergence));
    }
    let mismatch = report.mismatch.as_ref().map(Real::to_f64);
    let at = &request.parameters;
    // Without gains there is no loop whose delay an impact could fall in.
    let has_loop = [&at.displacement_gain, &at.velocity_gain].iter().any(|k| k.to_f64() != 0.0);
    if has_loop && mismatch.is_some_and(|m| m > 1.0) {
        warnings.push(
            "the mismatch is above 1: averaging ignores the impact within the delay and is not \
             to be believed here"
                .to_owned(),
        );
    }
    let mut map = Map::new();
    map.insert("order".to_owned(), json!(request.order));
    map.insert("variant".to_owned(), json!(request.variant_name()));
    if let Some(flow) = &report.flow {
        map.insert("R".to_owned(), w.number(&flow.growth_rate));
        map.insert("alpha0".to_owned(), w.number(&flow.frequency));
    }
    match &report.kbm {
        Err(error) => {
            map.insert("orbit".to_owned(), refused(error));
            map.insert("stable".to_owned(), Json::Null);
        }
        Ok(found) => {
            let p = &found.prediction;
            if let Some(b) = &p.polynomial {
                map.insert("b2".to_owned(), w.number(&b.quadratic));
                map.insert("b1".to_owned(), w.number(&b.linear));
                map.insert("b0".to_owned(), w.number(&b.constant));
            }
            map.insert("trace".to_owned(), w.number(&p.map.trace));
            map.insert("determinant".to_owned(), w.number(&p.map.determinant));
            let multipliers: Vec<Json> = p.map.multipliers().iter().map(|z| w.pair(z)).collect();
            map.insert("multipliers".to_owned(), json!(multipliers));
            map.insert("stable".to_owned(), stable(found.verdict));
            map.insert("verdict".to_owned(), json!(word(found.verdict)));
            let orbit = p.orbit.as_ref().map_or(Json::Null, |orbit| w.orbit(orbit));
            map.insert("orbit".to_owned(), orbit);
        }
    }
    map.insert("mismatch".to_owned(), report.mismatch.as_ref().map_or(Json::Null, |m| w.number(m)));
    map.insert("residual".to_owned(), report.residual.as_ref().map_or(Json::Null, |r| w.number(r)));
    map.insert("convergence".to_owned(), convergence_json(convergence));
    Json::Object(map)
}

fn exact<S: Real>(w: &Writer<'_, S>, request: &Request, report: &StabilityReport<S>) -> Json {
    let Some(found) = &report.exact else {
        return json!({"stable": null, "verdict": "no orbit"});
    };
    let standing = exists(report);
    // For B != 0 the return map is piecewise linear; iterating it is what decides.
    let kicked = found.growth.as_ref();
    let verdict = match kicked.map(|growth| growth.verdict()) {
        Some(Verdict::Neutral) | None => found.verdict,
        Some(decided) => decided,
    };
    let mut map = Map::new();
    // The multipliers of a flight through the wall are those of a system without wall on the way.
    let (answer, words) = match standing {
        Some(true) => (stable(verdict), word(verdict)),
        Some(false) => (Json::Null, PENETRATES),
        None => (Json::Null, "undecided: the flight touches the wall"),
    };
    map.insert("stable".to_owned(), answer);
    map.insert("verdict".to_owned(), json!(words));
    match &found.multipliers {
        Ok(list) => {
            let pairs: Vec<Json> = list.values.iter().map(|z| w.pair(z)).collect();
            map.insert("multipliers".to_owned(), json!(pairs));
            if kicked.is_some() {
                map.insert("multipliers_of".to_owned(), json!(ROOTS_OF_G));
            }
            map.insert("complete_to_modulus".to_owned(), json!(list.complete_to));
        }
        Err(error) => {
            map.insert("multipliers".to_owned(), json!([]));
            map.insert("multipliers_missing".to_owned(), json!(error.to_string()));
        }
    }
    map.insert("zeros_in_unit_disc".to_owned(), json!(found.zeros_in_unit_disc));
    let kick = if kicked.is_some() { request.kick_name() } else { "none" };
    map.insert("kick".to_owned(), json!(kick));
    if let Some(growth) = kicked {
        map.insert(
            "return_map".to_owned(),
            json!({
                "growth_per_impact": growth.rate,
                "spread": growth.spread,
                "error": growth.spread,
                "status": "estimated",
                "verdict": word(growth.verdict()),
            }),
        );
    }
    Json::Object(map)
}

/// A value of the report on one line.
fn plain(value: &Json) -> String {
    match value {
        Json::Null => "-".to_owned(),
        Json::Bool(yes) => (if *yes { "yes" } else { "no" }).to_owned(),
        Json::String(text) => text.clone(),
        Json::Array(list) => {
            let complex = |item: &Json| match item.as_array().map(Vec::as_slice) {
                Some([re, im]) => {
                    let (re, im) = (plain(re), plain(im));
                    if im == "0" { re } else { format!("{re} + ({im})*i") }
                }
                _ => plain(item),
            };
            list.iter().map(complex).collect::<Vec<_>>().join("\n    ")
        }
        Json::Object(map) => match map.get("decimal").and_then(Json::as_str) {
            Some(decimal) => decimal.to_owned(),
            None => {
                // A difference of two doubles that agree says nothing of digits.
                let says = |(name, inner): &(&String, &Json)| {
                    !(["spread", "error"].contains(&name.as_str()) && inner.as_f64() == Some(0.0))
                };
                let items = map.iter().filter(says);
                let items = items.map(|(name, inner)| format!("{name} {}", plain(inner)));
                items.collect::<Vec<_>>().join(", ")
            }
        },
        // Estimates: six digits are plenty.
        Json::Number(number) if number.is_f64() => {
            number.as_f64().map_or_else(String::new, |x| match x.abs() {
                size if size != 0.0 && !(1e-3..1e6).contains(&size) => format!("{x:.5e}"),
                _ => format!("{x:.6}"),
            })
        }
        other => other.to_string(),
    }
}
