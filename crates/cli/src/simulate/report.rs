//! The result of a simulation as text, JSON, tables.

use super::growth::{self, shifts};
use super::motion::{End, Happening, Moment, Motion, Plan};
use crate::session::Session;
use lindstedt::number::ball::Balls;
use lindstedt::simulate::EventKind;
use rug::Float;
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// Lines of a list that are printed; files have all.
pub const PRINTED: usize = 40;

/// Title, heading, rows.
type Table = (&'static str, Vec<&'static str>, Vec<Vec<String>>);

/// A motion with the estimated errors of its numbers.
pub struct Answer<'a> {
    pub plan: &'a Plan,
    pub motion: &'a Motion,
    /// The same with 8 digits more.
    pub finer: &'a Motion,
    pub digits: u32,
    /// In doubles the two met different events: no digit of the later numbers is known.
    pub chaotic: bool,
    /// Deviations of the impact times with half the perturbation: what is linear is half as large.
    pub half: Option<Vec<Float>>,
}

/// The name of an event.
pub fn name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Impact { .. } => "impact",
        EventKind::Accumulation { .. } => "accumulation",
        EventKind::Rest { .. } => "rest",
        EventKind::Departure { .. } => "departure",
        EventKind::Switching { to: 0, .. } => "stick",
        EventKind::Switching { from: 0, .. } => "slip",
        EventKind::Switching { .. } => "switch",
        _ => "section",
    }
}

/// A value with the digits that the error leaves, `digits` at most.
fn decimal(value: &Float, error: &Float, digits: u32) -> String {
    if value.is_zero() {
        return "0".to_owned();
    }
    let size = value.clone().abs().log10().to_f64();
    let lost = if error.is_zero() { f64::NEG_INFINITY } else { error.clone().log10().to_f64() };
    let supported = (size - lost).floor().clamp(1.0, f64::from(digits));
    let ball = Balls::new(value.prec()).from_parts(value, &Float::new(53));
    let shown = lindstedt::number::digits::decimal(&ball, supported as usize);
    shown.unwrap_or_else(|| value.to_string_radix(10, Some(supported as usize)))
}

/// One digit, rounded up.
pub fn bound(error: &Float) -> String {
    let above = Float::with_val(53, error * 1.05f64);
    above.to_string_radix_round(10, Some(2), rug::float::Round::Up)
}

impl<'a> Answer<'a> {
    /// Whether both integrations met the same events (but for the impacts that one of them told
    /// apart before an accumulation and the other not, see [`align`]); nothing else can be compared.
    pub fn comparable(&self) -> bool {
        let kinds = |m: &Motion| -> Vec<EventKind> { m.events.iter().map(|e| e.kind).collect() };
        let sizes = |m: &Motion| (m.samples.len(), m.points.len(), m.complete);
        kinds(self.motion) == kinds(self.finer) && sizes(self.motion) == sizes(self.finer)
    }

    /// The largest error, relative to the larger of the value and one, as log10.
    pub fn log10_error(&self) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        let mut compare = |a: &Float, b: &Float| {
            let error = Float::with_val(64, a - b).abs()
                / Float::with_val(64, a).abs().max(&Float::with_val(64, 1));
            worst = worst.max(error.log10().to_f64());
        };
        let mut moments = |a: &Moment, b: &Moment| {
            compare(&a.time, &b.time);
            compare(&a.state[0], &b.state[0]);
            compare(&a.state[1], &b.state[1]);
        };
        moments(&self.motion.last, &self.finer.last);
        let lists = [
            (&self.motion.samples, &self.finer.samples),
            (&self.motion.points, &self.finer.points),
        ];
        for (a, b) in lists {
            a.iter().zip(b).for_each(|(a, b)| moments(a, b));
        }
        for (a, b) in self.motion.events.iter().zip(&self.finer.events) {
            compare(&a.time, &b.time);
            for (a, b) in a.before.iter().chain(&a.after).zip(b.before.iter().chain(&b.after)) {
                compare(a, b);
            }
        }
        worst
    }

    fn error(value: &Float, finer: &Float) -> Float {
        Float::with_val(53, value - finer).abs()
    }

    fn number(&self, value: &Float, finer: &Float) -> Json {
        if self.chaotic {
            let decimal = self.digits_of(value, finer);
            return json!({"exact": null, "decimal": decimal, "error": null, "status": "estimated"});
        }
        let error = Self::error(value, finer);
        json!({
            "exact": null,
            "decimal": decimal(value, &error, self.digits),
            "error": bound(&error),
            "status": "estimated",
        })
    }

    fn digits_of(&self, value: &Float, finer: &Float) -> String {
        decimal(value, &Self::error(value, finer), self.digits)
    }

    /// Ratios of consecutive deviations of the impact times from those of the periodic orbit,
    /// with their estimated errors.
    pub fn growth(&self) -> Vec<(Float, Float)> {
        let ratios = |motion: &Motion| -> Vec<Float> {
            let shifts = shifts(self.plan, motion);
            shifts.windows(2).map(|w| Float::with_val(w[0].prec(), &w[1] / &w[0])).collect()
        };
        let pairs = ratios(self.motion).into_iter().zip(ratios(self.finer));
        pairs
            .map(|(a, b)| {
                let error = Self::error(&a, &b);
                (a, error)
            })
            .collect()
    }

    /// The deviations and how many of them tell of stability.
    fn linear(&self) -> (Vec<Float>, usize) {
        let (all, finer) = (shifts(self.plan, self.motion), shifts(self.plan, self.finer));
        let linear = match &self.half {
            Some(half) if !self.chaotic => growth::linear(&all, half, &finer),
            _ => 0,
        };
        (all, linear)
    }

    fn perturbed(&self) -> bool {
        self.plan.perturbed()
    }

    /// In words.
    pub fn verdict(&self) -> String {
        let motion = self.motion;
        let time = motion.last.time.to_f64();
        let chaotic = if self.chaotic {
            "no digit is left in doubles, a motion with more digits goes elsewhere (chaos, or an unstable \
             motion); a picture; "
        } else {
            ""
        };
        let mut text = chaotic.to_owned();
        text += &if motion.complete {
            format!("reached t = {time:.6}")
        } else if let Some(reason) = &self.plan.cut {
            format!("{reason}; shown up to t = {time:.6}")
        } else {
            format!("the events that end the motion did not come before t = {time:.6}")
        };
        let count = |wanted: &str| {
            let is = |e: &&Happening| match wanted {
                "impact" => e.is_impact(),
                _ => name(e.kind) == wanted,
            };
            motion.events.iter().filter(is).count()
        };
        for what in ["impact", "accumulation", "stick"] {
            match count(what) {
                0 => {}
                n => {
                    let _ = write!(text, ", {n} {what}{}", if n == 1 { "" } else { "s" });
                }
            }
        }
        let accumulations: Vec<String> = (motion.events.iter())
            .filter(|e| matches!(e.kind, EventKind::Accumulation { .. }))
            .map(|e| format!("{:.6}", e.time.to_f64()))
            .collect();
        if let Some((first, others)) = accumulations.split_first() {
            let more = match others.len() {
                0 => String::new(),
                n => format!(" and {n} later times"),
            };
            let _ = write!(
                text,
                "; chattering: infinitely many impacts up to t = {first}{more}, then at rest at the wall"
            );
            if matches!(self.plan.end, End::Impacts(_)) {
                text += "; the last impact asked for is among them";
            }
        }
        if self.perturbed() {
            let (shifts, linear) = self.linear();
            let _ = write!(text, "; {}", growth::verdict(&shifts, linear));
        }
        if self.chaotic {
            text += "; for digits: without --f64, a shorter time; for a picture enough, for \
                     numbers --lyapunov or --zero-one";
        }
        text
    }

    pub fn json(&self, session: &Session<'_>) -> Json {
        let Self { plan, motion, finer, .. } = self;
        let at: serde_json::Map<_, _> =
            plan.setup.at.iter().map(|(n, v)| (n.clone(), v.clone().into())).collect();
        let number = |a: &Float, b: &Float| self.number(a, b);
        let moment = |(a, b): (&Moment, &Moment)| {
            json!({"t": number(&a.time, &b.time), "x": number(&a.state[0], &b.state[0]),
                   "v": number(&a.state[1], &b.state[1]), "sticking": a.stuck})
        };
        let event = |(a, b): (&Happening, &Happening)| {
            json!({"kind": name(a.kind), "t": number(&a.time, &b.time),
                   "x": number(&a.after[0], &b.after[0]),
                   "v_before": number(&a.before[1], &b.before[1]),
                   "v_after": number(&a.after[1], &b.after[1])})
        };
        let mut result = serde_json::Map::new();
        let mut put = |key: &str, value: Json| {
            result.insert(key.to_owned(), value);
        };
        put("problem", plan.setup.name.clone().into());
        put("at", at.into());
        put("digits", self.digits.into());
        put("events", motion.events.iter().zip(&finer.events).map(event).collect());
        put("samples", motion.samples.iter().zip(&finer.samples).map(moment).collect());
        put("final", moment((&motion.last, &finer.last)));
        if let Some(section) = plan.section {
            let points: Vec<[f64; 3]> = motion.points.iter().map(plain).collect();
            put(
                "section",
                json!({"kind": format!("{section:?}").to_lowercase(), "points": points, "status": "estimated"}),
            );
        }
        if self.perturbed() {
            let ratio = |(value, error): &(Float, Float)| {
                json!({"exact": null, "decimal": decimal(value, error, self.digits),
                       "error": bound(error), "status": "estimated"})
            };
            put("growth", self.growth().iter().map(ratio).collect());
            let (shifts, linear) = self.linear();
            let grows = growth::grows(shifts.get(..linear).unwrap_or_default());
            put("linear_regime", json!({"impacts": linear, "grows": grows}));
        }
        let chattering = |(a, b): (&Happening, &Happening)| {
            matches!(a.kind, EventKind::Accumulation { .. })
                .then(|| json!({"t": number(&a.time, &b.time), "then": "rest"}))
        };
        let pairs = motion.events.iter().zip(&finer.events);
        put("chattering", pairs.filter_map(chattering).collect());
        put("sticking_time", number(&motion.stuck_time, &finer.stuck_time));
        let work = motion.work;
        put(
            "work",
            json!({"steps": work.steps, "rejected": work.rejected, "impacts": work.impacts}),
        );
        put("estimate", "difference to an integration with 8 digits more".into());
        put("complete", motion.complete.into());
        put("verdict", self.verdict().into());
        put("remarks", plan.setup.remarks.clone().into());
        put("seconds", session.elapsed().as_secs_f64().into());
        Json::Object(result)
    }

    fn parameters(&self) -> String {
        let parts: Vec<String> =
            self.plan.setup.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        parts.join(", ")
    }

    /// Heading and rows of each list: events, samples, section.
    fn tables(&self) -> Vec<Table> {
        let d = |a: &Float, b: &Float| self.digits_of(a, b);
        let event = |(a, b): (&Happening, &Happening)| {
            vec![
                name(a.kind).to_owned(),
                d(&a.time, &b.time),
                d(&a.after[0], &b.after[0]),
                d(&a.before[1], &b.before[1]),
                d(&a.after[1], &b.after[1]),
            ]
        };
        let moment = |(a, b): (&Moment, &Moment)| {
            vec![d(&a.time, &b.time), d(&a.state[0], &b.state[0]), d(&a.state[1], &b.state[1])]
        };
        let (motion, finer) = (self.motion, self.finer);
        let mut last = moment((&motion.last, &finer.last));
        last.push(if motion.last.stuck { "sticking" } else { "" }.to_owned());
        vec![
            (
                "events",
                vec!["event", "t", "x", "x' before", "x' after"],
                motion.events.iter().zip(&finer.events).map(event).collect(),
            ),
            (
                "samples",
                vec!["t", "x", "x'"],
                motion.samples.iter().zip(&finer.samples).map(moment).collect(),
            ),
            (
                "section",
                vec!["t", "x", "x'"],
                motion.points.iter().zip(&finer.points).map(moment).collect(),
            ),
            ("final", vec!["t", "x", "x'", ""], vec![last]),
        ]
    }

    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.plan.setup.name, self.parameters());
        for remark in &self.plan.setup.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        for (title, heading, rows) in self.tables() {
            if rows.is_empty() {
                continue;
            }
            let _ = writeln!(text, "\n{title}");
            let shown = rows.iter().take(PRINTED);
            let heading: Vec<String> = heading.iter().map(|h| (*h).to_owned()).collect();
            let lines: Vec<&Vec<String>> = [&heading].into_iter().chain(shown).collect();
            let width = |k: usize| lines.iter().filter_map(|l| l.get(k)).map(String::len).max();
            let widths: Vec<usize> = (0..heading.len()).map(|k| width(k).unwrap_or(0)).collect();
            for line in lines {
                let cells = line.iter().zip(&widths).map(|(cell, w)| format!("{cell:<w$}"));
                let cells: Vec<String> = cells.collect();
                let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
            }
            if rows.len() > PRINTED {
                let _ =
                    writeln!(text, "  ... {} in all (--format json, --plot FILE.csv)", rows.len());
            }
        }
        if self.perturbed() {
            let _ = writeln!(text, "\ngrowth per impact");
            for (value, error) in self.growth().iter().take(PRINTED) {
                let _ = writeln!(text, "  {}", decimal(value, error, self.digits));
            }
        }
        let _ = writeln!(
            text,
            "\n  {} ({} steps; digits estimated by 8 more)",
            self.verdict(),
            self.motion.work.steps
        );
        text
    }

    pub fn markdown(&self) -> String {
        let mut text = format!("### {}\n\n{}\n", self.plan.setup.name, self.parameters());
        for (title, heading, rows) in self.tables().into_iter().filter(|t| !t.2.is_empty()) {
            let _ = writeln!(
                text,
                "\n{title}\n\n| {} |\n|{}",
                heading.join(" | "),
                "---|".repeat(heading.len())
            );
            for row in rows {
                let _ = writeln!(text, "| {} |", row.join(" | "));
            }
        }
        let _ = writeln!(text, "\n{}", self.verdict());
        text
    }

    pub fn latex(&self) -> String {
        let mut text = String::new();
        for (title, heading, rows) in self.tables().into_iter().filter(|t| !t.2.is_empty()) {
            let _ =
                writeln!(text, "% {title}\n\\begin{{tabular}}{{{}}}", "l".repeat(heading.len()));
            let _ = writeln!(text, "{} \\\\ \\hline", heading.join(" & "));
            for row in rows {
                let _ = writeln!(text, "{} \\\\", row.join(" & "));
            }
            text.push_str("\\end{tabular}\n");
        }
        text
    }

    /// All points of the line, with the events.
    pub fn csv(&self) -> String {
        let mut text = format!("# {}: {}\nwhat,t,x,v\n", self.plan.setup.name, self.parameters());
        for dot in &self.motion.line {
            let what = if dot.stuck { "sticking" } else { "moving" };
            let _ = writeln!(text, "{what},{:?},{:?},{:?}", dot.time, dot.x, dot.v);
        }
        for event in &self.motion.events {
            let [x, v] = event.after.each_ref().map(Float::to_f64);
            let _ = writeln!(text, "{},{:?},{x:?},{v:?}", name(event.kind), event.time.to_f64());
        }
        for [t, x, v] in self.motion.points.iter().map(plain) {
            let _ = writeln!(text, "section,{t:?},{x:?},{v:?}");
        }
        text
    }
}

/// (t, x, x') in doubles.
pub fn plain(moment: &Moment) -> [f64; 3] {
    [moment.time.to_f64(), moment.state[0].to_f64(), moment.state[1].to_f64()]
}
