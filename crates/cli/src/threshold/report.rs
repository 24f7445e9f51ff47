//! The numbers at one point, and their presentation.

use super::request::Request;
use super::sweep::Table;
use crate::derive::number_json;
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::Exact;
use lindstedt::equation::print::Style;
use lindstedt::equation::{Expression, Text};
use lindstedt::number::ball::{Ball, Balls};
use lindstedt::number::certified;
use lindstedt::{Number, Status};
use lindstedt_melnikov::{Branch, MelnikovError, StickSlip, Verdict};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The widest table printed in text.
const PRINTED_POINTS: usize = 1000;
/// What is undecided with so many bits is said to be: a threshold beyond all exponents.
const FEW_OR_NEVER: u32 = 8000;
/// Bits that decide how many zeros there are.
const COUNTING_BITS: u32 = 400;

/// The answer at the point of the request.
pub struct Answer {
    pub problem: String,
    pub at: Vec<(Text, String)>,
    /// gamma in the equation: the whole coefficient of the (lowest) harmonic.
    pub amplitude: String,
    /// With `cusp` where there is one.
    pub numbers: Vec<(&'static str, Number)>,
    pub zeros: Vec<Number>,
    pub zeros_of: Option<(String, bool)>,
    pub touching_b: Option<String>,
    pub validity: String,
    pub distances: [Number; 2],
    pub tangle: String,
    /// Of a file: its orbits with their thresholds, and how they were checked.
    pub orbits: Vec<Json>,
    /// Resonances, if asked for.
    pub subharmonics: Option<Vec<Json>>,
    /// What gamma_c is in the symbols of the problem.
    pub harmonic: Option<Harmonic>,
    pub remarks: Vec<String>,
}

/// The force that gamma is the amplitude of.
pub struct Harmonic {
    term: String,
    coefficient: String,
    /// The parameter that the coefficient is a multiple of, and its threshold.
    parameter: Option<(String, Number)>,
}

impl Harmonic {
    /// `over`: gamma_c divided by the absolute value of a factor.
    pub fn new(
        request: &Request,
        gamma: Option<&(&str, Number)>,
        over: &dyn Fn(&Exact) -> Result<Number, Failure>,
    ) -> Result<Option<Self>, Failure> {
        let Some(lowest) = &request.lowest else { return Ok(None) };
        let shown = |e: &Expression| e.print(request.small(), Style::Text);
        let parameter = match &lowest.parameter {
            Some((name, factor)) => {
                let unit = factor.abs().as_rational().is_some_and(|q| *q == 1);
                let same = gamma.filter(|_| unit).map(|(_, number)| number.clone());
                Some((name.clone(), same.map_or_else(|| over(factor), Ok)?))
            }
            None => None,
        };
        let (term, coefficient) = (shown(&lowest.term), shown(&lowest.coefficient));
        Ok(Some(Self { term, coefficient, parameter }))
    }

    /// `gamma/m, the coefficient of cos(omega*t) in x''`.
    fn words(&self) -> String {
        let Self { term, coefficient, parameter } = self;
        let alone = match parameter {
            Some(_) => "",
            None => " (a threshold of no single parameter of it)",
        };
        format!("{coefficient}, the coefficient of {term} in x''{alone}")
    }

    fn json(&self) -> Json {
        let parameter = self.parameter.as_ref();
        json!({
            "term": self.term,
            "coefficient": self.coefficient,
            "parameter": parameter.map(|(name, _)| name),
            "threshold": parameter.map(|(_, number)| number_json(number)),
        })
    }
}

impl Answer {
    pub fn new(request: &Request, digits: usize, session: &Session<'_>) -> Result<Self, Failure> {
        match (&request.point, &request.file) {
            (Some(point), _) => Self::of_point(request, point, digits, session),
            (None, Some((_, found))) => super::general::answer(request, found, digits, session),
            (None, None) => Err(MelnikovError::NoClosedForm.into()),
        }
    }

    fn of_point(
        request: &Request,
        point: &StickSlip,
        digits: usize,
        session: &Session<'_>,
    ) -> Result<Self, Failure> {
        let system = point.system()?;
        let threshold = |balls: Balls| system.threshold(balls, Branch::Positive);
        // An error of the problem is said as such; only precision is asked for again below.
        if matches!(threshold(Balls::new(200)), Err(MelnikovError::Undecided { .. })) {
            threshold(Balls::new(FEW_OR_NEVER))?;
        } else {
            threshold(Balls::new(200))?;
        }
        let signed = |balls: Balls| point.signed_threshold(balls);
        let gamma = |balls: Balls| Some(balls.abs(&signed(balls)?));
        let d = |balls: Balls| Some(threshold(balls).ok()?.dissipation);
        let f = |balls: Balls| Some(threshold(balls).ok()?.forcing);
        let at_cusp = |balls: Balls| -> Option<Ball> {
            // G at |v*| = V: the dry term is gone, v*^2 = V^2.
            point.threshold_at_cusp(balls)
        };
        let has_cusp = point.dry.sign().is_ne();
        let mut numbers = vec![
            ("gamma_c", certified(point.exact_threshold(), digits, gamma)?),
            ("signed", certified(None, digits, signed)?),
            ("D", certified(None, digits, d)?),
            ("F", certified(None, digits, f)?),
            ("V", certified(None, digits, |balls| point.loop_speed(balls))?),
        ];
        if has_cusp {
            numbers.push(("cusp", certified(None, digits, at_cusp)?));
        }
        let harmonic = Harmonic::new(request, numbers.first(), &|factor| {
            let over = |balls: Balls| balls.div(&gamma(balls)?, &balls.abs(&factor.ball(balls)));
            Ok(certified(None, digits, over)?)
        })?;
        let (zeros, zeros_of) = match &request.zeros {
            None => (Vec::new(), None),
            Some((Some(axis), name, low, high)) => {
                let found = point.zeros_in(Balls::new(COUNTING_BITS), *axis, low, high)?;
                let nth = |n: usize| {
                    certified(None, digits, |balls| {
                        point.zeros_in(balls, *axis, low, high).ok()?.zeros.get(n).cloned()
                    })
                };
                let zeros = (0..found.zeros.len()).map(nth).collect::<Result<_, _>>()?;
                (zeros, Some((name.clone(), found.complete)))
            }
            Some((None, name, low, high)) => {
                let zeros = super::general::zeros(request, name, (low, high), digits, session)?;
                (zeros, Some((name.clone(), false)))
            }
        };
        let few = digits.min(17);
        let distance = |n: usize| {
            certified(None, few, |balls| {
                let validity = system.validity(balls)?;
                Some(if n == 0 { validity.belt_speed } else { validity.tangency_distance })
            })
        };
        let eps = request.eps.to_f64();
        let verdict = system.validity(Balls::new(200)).map(|validity| validity.verdict(eps));
        Ok(Self {
            problem: request.problem.clone(),
            at: request.at.iter().map(|(name, value)| (name.clone(), value.to_string())).collect(),
            amplitude: request.gamma.to_string(),
            numbers,
            zeros,
            zeros_of,
            touching_b: point.touching_b().filter(|_| has_cusp).map(|b| b.to_string()),
            validity: validity(request, has_cusp, verdict).to_owned(),
            distances: [distance(0)?, distance(1)?],
            tangle: tangle(request, gamma(Balls::new(400))).to_owned(),
            orbits: Vec::new(),
            subharmonics: None,
            harmonic,
            remarks: request.remarks.clone(),
        })
    }

    /// `a = 1, b = 1, ...`.
    pub fn parameters(&self) -> String {
        let parts: Vec<String> = self.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        parts.join(", ")
    }

    pub fn json(&self, table: Option<&Table>, session: &Session<'_>) -> Json {
        let mut result = serde_json::Map::new();
        result.insert("problem".into(), self.problem.clone().into());
        let at: serde_json::Map<_, _> =
            self.at.iter().map(|(n, v)| (n.to_string(), Json::from(v.clone()))).collect();
        result.insert("at".into(), at.into());
        for (name, number) in &self.numbers {
            if *name != "cusp" {
                result.insert((*name).into(), number_json(number));
            }
        }
        result.insert("amplitude".into(), self.amplitude.clone().into());
        result.insert("harmonic".into(), self.harmonic.as_ref().map(Harmonic::json).into());
        result.insert("remarks".into(), self.remarks.clone().into());
        result.insert("zeros".into(), self.zeros.iter().map(number_json).collect());
        if let Some((name, complete)) = &self.zeros_of {
            result.insert("zeros_of".into(), json!({"parameter": name, "complete": complete}));
        }
        let cusp = self.numbers.iter().find(|(name, _)| *name == "cusp");
        let speed = self.numbers.iter().find(|(name, _)| *name == "V");
        if let (Some((_, cusp)), Some((_, speed))) = (cusp, speed) {
            result.insert(
                "cusp".into(),
                json!({
                    "vstar": number_json(speed),
                    "signed": number_json(cusp),
                    "touches_zero_at_b": self.touching_b,
                }),
            );
        }
        if !self.orbits.is_empty() {
            result.insert("orbits".into(), self.orbits.clone().into());
        }
        if let Some(list) = &self.subharmonics {
            result.insert("subharmonics".into(), list.clone().into());
        }
        result.insert("homoclinic_points".into(), self.tangle.clone().into());
        let [saddle, tangency] = &self.distances;
        result.insert(
            "validity".into(),
            json!({
                "verdict": self.validity,
                "distance_to_saddle": number_json(saddle),
                "distance_to_tangency": number_json(tangency),
            }),
        );
        let curve = |pick: fn(f64) -> f64| -> Json {
            let entries = table.into_iter().flat_map(Table::entries);
            entries.map(|(_, column, signed)| json!([column, pick(signed)])).collect()
        };
        let one = table.filter(|table| table.rows.len() == 1 && table.rows[0].is_nan());
        let empty = Json::Array(Vec::new());
        result.insert("curve".into(), if one.is_some() { curve(f64::abs) } else { empty });
        if let Some(table) = table {
            let status = if table.certified { "certified" } else { "estimated" };
            result.insert("curve_status".into(), status.into());
            let width = table.columns.len().max(1);
            let point = |index: &usize| match one {
                Some(_) => json!([table.columns[*index]]),
                None => json!([table.columns[index % width], table.rows[index / width]]),
            };
            let blank = |(reason, entries): (&String, &Vec<usize>)| json!({"reason": reason, "points": entries.iter().map(point).collect::<Vec<_>>()});
            let blanks: Vec<Json> = table.blanks.iter().map(blank).collect();
            result.insert("blanks".into(), blanks.into());
            if one.is_some() {
                result.insert("curve_signed".into(), curve(|signed| signed));
            } else {
                let signed: Vec<&[f64]> = table.signed.chunks(table.columns.len().max(1)).collect();
                let grid = json!({"columns": table.columns, "rows": table.rows, "signed": signed});
                result.insert("grid".into(), grid);
            }
        }
        result.insert("seconds".into(), session.elapsed().as_secs_f64().into());
        Json::Object(result)
    }

    fn lines(&self) -> Vec<(String, String)> {
        let shown = |number: &Number| match (&number.error, number.status) {
            (Some(error), Status::Estimated) => {
                format!("{} +- {error} (estimated)", number.decimal)
            }
            _ => number.decimal.clone(),
        };
        let mut lines = Vec::new();
        let has_cusp = self.numbers.iter().any(|(name, _)| *name == "cusp");
        for (name, number) in &self.numbers {
            let label = match *name {
                "signed" => "gamma_c with the sign of D",
                "D" => "D, work of friction",
                "F" => "F, work of the forcing",
                "V" if has_cusp => "V, largest speed, cusp at |v*| = V",
                "V" => "V, largest speed",
                "cusp" => "signed threshold at the cusp",
                other => other,
            };
            lines.push((label.to_owned(), shown(number)));
        }
        if let Some(harmonic) = &self.harmonic {
            lines.push(("gamma_c is a value of".to_owned(), harmonic.words()));
            if let Some((name, number)) = &harmonic.parameter
                && harmonic.coefficient != *name
            {
                lines.push((format!("gamma_c as a value of {name}"), shown(number)));
            }
        }
        if let Some(b) = &self.touching_b {
            lines.push(("cusp touches zero at b =".to_owned(), b.clone()));
        }
        for orbit in &self.orbits {
            let text = |key: &str| match &orbit[key] {
                Json::String(text) => text.clone(),
                value => value["decimal"].as_str().map_or_else(|| value.to_string(), str::to_owned),
            };
            let mark = if orbit["least"] == true { " (the least)" } else { "" };
            lines.push((format!("gamma_c, {}", text("name")), text("gamma_c") + mark));
            lines.push((format!("orbit, {}", text("name")), text("check")));
        }
        for resonance in self.subharmonics.iter().flatten() {
            let (m, around) = (&resonance["m"], resonance["around"].as_str().unwrap_or_default());
            let gamma = resonance["gamma_c"]["decimal"].as_str().unwrap_or_default();
            lines.push((format!("gamma_c of period {m}, {around}"), gamma.to_owned()));
        }
        if let Some((name, complete)) = &self.zeros_of {
            let label = format!("zero in {name}");
            lines.extend(self.zeros.iter().map(|zero| (label.clone(), shown(zero))));
            let note = if *complete { "complete" } else { "sign changes on a grid" };
            lines.push((
                format!("zeros in {name}, number"),
                format!("{} ({note})", self.zeros.len()),
            ));
        }
        lines.push(("transversal homoclinic points at gamma".to_owned(), self.tangle.clone()));
        lines.push(("validity".to_owned(), self.validity.clone()));
        lines.extend(self.remarks.iter().map(|remark| ("remark".to_owned(), remark.clone())));
        lines
    }

    pub fn text(&self, table: Option<&Table>) -> String {
        let mut text = format!("{}: {}\n\n", self.problem, self.parameters());
        for (label, value) in self.lines() {
            let _ = writeln!(text, "  {label:<40} {value}");
        }
        if let Some(exact) = self.numbers.first().and_then(|(_, number)| number.exact.as_ref()) {
            let _ = writeln!(text, "\n  gamma_c = {exact}");
        }
        let Some(table) = table else { return text };
        let status = if table.certified { "certified" } else { "estimated, in doubles" };
        let mut reasons: BTreeMap<usize, &str> = BTreeMap::new();
        for (reason, entries) in &table.blanks {
            let shown = entries.iter().take_while(|index| **index < PRINTED_POINTS);
            reasons.extend(shown.map(|index| (*index, reason.as_str())));
        }
        let blank: usize = table.blanks.values().map(Vec::len).sum();
        let without = if blank == 0 { String::new() } else { format!(", {blank} without a value") };
        let _ = writeln!(text, "\n  {} points ({status}){without}", table.signed.len());
        let heads = match table.names.as_slice() {
            [name] => format!("{name:<20}"),
            [name, row] => format!("{row:<12} {name:<20}"),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {heads} gamma_c with the sign of D");
        for (index, (row, column, signed)) in table.entries().take(PRINTED_POINTS).enumerate() {
            let row = if row.is_nan() { String::new() } else { format!("{row:<12} ") };
            let _ = match reasons.get(&index) {
                Some(reason) => writeln!(text, "  {row}{column:<20} - ({reason})"),
                None => writeln!(text, "  {row}{column:<20} {signed:?}"),
            };
        }
        if table.signed.len() > PRINTED_POINTS {
            let _ = writeln!(text, "  ... (--plot FILE.csv has all of them)");
        }
        text
    }

    pub fn markdown(&self) -> String {
        let mut text =
            format!("### {}\n\n{}\n\n| | |\n|---|---|\n", self.problem, self.parameters());
        for (label, value) in self.lines() {
            let escape = |s: &str| s.replace('|', "\\|");
            let _ = writeln!(text, "| {} | {} |", escape(&label), escape(&value));
        }
        text
    }

    pub fn latex(&self) -> String {
        let mut text = String::from("\\begin{tabular}{ll}\n");
        for (label, value) in self.lines() {
            let escape = |s: &str| s.replace('_', "\\_").replace('|', "$|$");
            let _ = writeln!(text, "{} & {} \\\\", escape(&label), escape(&value));
        }
        text.push_str("\\end{tabular}\n");
        text
    }
}

/// Without a jump there is nothing to be far from.
const SMOOTH: &str =
    "holds to first order in eps: the perturbation is smooth; no bound on eps is known here";

/// The perturbation need not be smooth: where its slope is bounded, what it does on the perturbed orbit
/// differs by O(eps) from what it does on the unperturbed one.
const BENT: &str = "holds to first order in eps: the slope of friction jumps, friction does not; no bound on \
                    eps is known here";

/// Without a perturbation there is nothing to be valid.
const UNPERTURBED: &str =
    "no statement: at eps = 0 nothing is perturbed, the stable and unstable manifolds coincide";

/// The verdict on the theory in words.
pub fn validity(request: &Request, jumps: bool, verdict: Option<Verdict>) -> &'static str {
    let bends = request.file.as_ref().is_some_and(|(_, found)| found.bends());
    match verdict {
        _ if request.eps.sign().is_eq() => UNPERTURBED,
        _ if bends => BENT,
        _ if !jumps => SMOOTH,
        Some(Verdict::Holds) => "holds: |v*| and ||v*| - V| exceed 10 eps",
        Some(Verdict::Doubtful) => {
            "doubtful: |v*| or ||v*| - V| is below 10 eps, corrections of order eps count"
        }
        _ => "fails: v* = 0 or |v*| = V, for every eps",
    }
}

/// Whether gamma exceeds the threshold.
pub fn tangle(request: &Request, threshold: Option<Ball>) -> &'static str {
    let balls = Balls::new(400);
    let excess = threshold.map(|t| balls.sub(&request.gamma.abs().ball(balls), &t));
    match excess {
        // Coinciding manifolds do not cross.
        _ if request.eps.sign().is_eq() => "none",
        Some(ball) if ball.is_positive() => "crossing",
        Some(ball) if ball.is_negative() => "none",
        _ => "undecided",
    }
}
