//! What is asked: exact parameters, sweeps, prediction.

use crate::arguments::{KickChoice, PredictorChoice, StabilityOptions, VariantChoice};
use crate::failure::Failure;
use crate::session::parameters;
use lindstedt::Value;
use lindstedt::problems::vibro_impact;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::chart::{Axis, Plan, Predictor, Swept};
use lindstedt_impact::parameters::{Branch, Exact, ExactParameters};
use lindstedt_impact::prediction::Variant;
use lindstedt_impact::report;
use std::path::Path;

/// The parameters that can be swept, by name.
const SWEPT: [(&str, Swept); 8] = [
    ("alpha", Swept::Alpha),
    ("omega", Swept::Omega),
    ("R_r", Swept::Restitution),
    ("s", Swept::Wall),
    ("c", Swept::Damping),
    ("P0", Swept::Force),
    ("A", Swept::DisplacementGain),
    ("B", Swept::VelocityGain),
];

pub struct Request {
    pub parameters: ExactParameters,
    /// All parameters with their values as text, in the order of the card.
    pub at: Vec<(String, String)>,
    /// Names and axes of the sweeps.
    pub sweeps: Vec<(&'static str, Axis)>,
    pub predictor: PredictorChoice,
    pub variant: VariantChoice,
    pub order: usize,
    pub kick: Kick,
}

/// The parameters given and the defaults of the others, and all of them as text in the order of
/// the card.
pub fn exact_parameters(
    set: &[String],
) -> Result<(ExactParameters, Vec<(String, String)>), Failure> {
    let (branches, numbers): (Vec<String>, Vec<String>) =
        set.iter().cloned().partition(|item| item.trim().starts_with("branch="));
    let branch = match branches.as_slice() {
        [] => Branch::Plus,
        [only] => match only.trim().trim_start_matches("branch=").trim() {
            "+" | "plus" => Branch::Plus,
            "-" | "minus" => Branch::Minus,
            other => {
                let message = format!("branch is + or -, not {other:?}");
                return Err(Failure::usage("set", message, "--set branch=-"));
            }
        },
        _ => return Err(Failure::usage("set", "branch is set twice".to_owned(), "")),
    };
    let mut given = parameters(&numbers)?;
    let mut at = Vec::new();
    let mut values = std::collections::BTreeMap::new();
    for card in vibro_impact::problem().parameters {
        if card.name == "branch" {
            let sign = if branch == Branch::Plus { "+" } else { "-" };
            at.push(("branch".to_owned(), sign.to_owned()));
            continue;
        }
        let value = match given.remove(&*card.name) {
            Some(value) => value,
            None => Value::parse(&card.default)?,
        };
        at.push((card.name.to_string(), value.to_string()));
        values.insert(card.name.to_string(), value);
    }
    if let Some(name) = given.keys().next() {
        let known: Vec<&str> = at.iter().map(|(name, _)| name.as_str()).collect();
        let message = format!("vibro-impact has no parameter {name:?}");
        let hint = format!("it has {}; T = 2 pi k/omega follows", known.join(", "));
        return Err(Failure::usage("unknown-parameter", message, &hint));
    }
    let get = |name: &str| match values.get(name) {
        Some(Value::Rational(q)) => Exact::Rational(q.clone()),
        Some(Value::PiTimes(q)) => Exact::PiMultiple(q.clone()),
        None => Exact::from((0, 1)),
    };
    let whole = values.get("k").and_then(Value::as_rational);
    let periods = whole.filter(|q| q.is_integer()).and_then(|q| q.numer().to_u32());
    let periods = periods.filter(|&k| k > 0).ok_or_else(|| {
        Failure::usage("parameter", "k must be a positive integer".to_owned(), "--set k=2")
    })?;
    let parameters = ExactParameters {
        alpha: get("alpha"),
        omega: get("omega"),
        periods,
        restitution: get("R_r"),
        wall: get("s"),
        damping: get("c"),
        force: get("P0"),
        displacement_gain: get("A"),
        velocity_gain: get("B"),
        branch,
    };
    parameters.to_f64().validate()?;
    Ok((parameters, at))
}

impl Request {
    pub fn read(options: &StabilityOptions) -> Result<Self, Failure> {
        if options.problem != "vibro-impact" {
            let shown: String = options.problem.chars().take(60).collect();
            let message = format!("no impact orbit in {shown:?}");
            return Err(Failure::usage("unknown-problem", message, "known: vibro-impact"));
        }
        let (parameters, at) = exact_parameters(&options.set)?;
        let sweeps: Vec<(&'static str, Axis)> =
            options.sweep.iter().map(|text| axis(text)).collect::<Result<_, _>>()?;
        if sweeps.len() > 2 {
            return Err(Failure::usage("range", "at most two sweeps".to_owned(), ""));
        }
        if let [(first, _), (second, _)] = sweeps.as_slice()
            && first == second
        {
            return Err(Failure::usage("range", format!("{first} is swept twice"), ""));
        }
        if !options.plot.is_empty() && sweeps.is_empty() {
            let hint = "for example --sweep A=-0.3..0.3:201 --sweep B=-0.3..0.3:201";
            return Err(Failure::usage("plot", "--plot needs a --sweep".to_owned(), hint));
        }
        let is = |path: &Path, kind: &str| {
            path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind))
        };
        if let Some(path) = options.plot.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
            let message = format!("cannot plot to {}", path.display());
            return Err(Failure::usage("plot", message, "the name must end in .svg or .csv"));
        }
        let svg = options.plot.iter().any(|path| is(path, "svg"));
        if svg && sweeps.len() != 2 {
            let message = "a chart needs two sweeps".to_owned();
            return Err(Failure::usage("plot", message, "or write a .csv table"));
        }
        Ok(Self {
            parameters,
            at,
            sweeps,
            predictor: options.predictor,
            variant: options.variant,
            order: options.order as usize,
            kick: match options.kick {
                KickChoice::None => Kick::None,
                KickChoice::Mean => Kick::Mean,
                KickChoice::Before => Kick::Before,
                KickChoice::After => Kick::After,
            },
        })
    }

    /// The question about one point. The impact-aware prediction stands beside the plain one.
    pub fn point(&self) -> report::Request {
        report::Request {
            variant: self.plain_variant(),
            order: self.order,
            kick: self.kick,
            ..report::Request::default()
        }
    }

    fn plain_variant(&self) -> Variant {
        match self.variant {
            VariantChoice::E | VariantChoice::ImpactAware => Variant::E,
            VariantChoice::S => Variant::S,
            VariantChoice::P => Variant::P,
        }
    }

    /// The question about a chart.
    pub fn plan(&self) -> Option<Plan> {
        let (_, columns) = *self.sweeps.first()?;
        let rows = match self.sweeps.get(1) {
            Some(&(_, rows)) => rows,
            None => self.single_row(columns.parameter),
        };
        let predictor = match self.variant {
            VariantChoice::ImpactAware => Predictor::ImpactAware(self.kick),
            _ => Predictor::Kbm(self.plain_variant()),
        };
        Some(Plan {
            columns,
            rows,
            predictor: (self.predictor != PredictorChoice::Exact)
                .then_some((predictor, self.order)),
            exact: (self.predictor != PredictorChoice::Kbm).then_some(self.kick),
            radius: false,
        })
    }

    /// A second axis of one point where there is one sweep.
    fn single_row(&self, swept: Swept) -> Axis {
        let base = self.parameters.to_f64();
        let (parameter, value) = if swept == Swept::VelocityGain {
            (Swept::DisplacementGain, base.displacement_gain)
        } else {
            (Swept::VelocityGain, base.velocity_gain)
        };
        Axis { parameter, low: value, high: value, count: 1 }
    }

    /// The value of a swept parameter at the point asked for.
    pub fn base(&self, swept: Swept) -> f64 {
        let p = self.parameters.to_f64();
        match swept {
            Swept::Alpha => p.alpha,
            Swept::Omega => p.omega,
            Swept::Restitution => p.restitution,
            Swept::Wall => p.wall,
            Swept::Damping => p.damping,
            Swept::Force => p.force,
            Swept::DisplacementGain => p.displacement_gain,
            Swept::VelocityGain => p.velocity_gain,
        }
    }

    pub fn kick_name(&self) -> &'static str {
        match self.kick {
            Kick::None => "none",
            Kick::Mean => "mean",
            Kick::Before => "before",
            Kick::After => "after",
        }
    }

    pub fn variant_name(&self) -> &'static str {
        match self.variant {
            VariantChoice::E => "E",
            VariantChoice::S => "S",
            VariantChoice::P => "P",
            VariantChoice::ImpactAware => "impact-aware",
        }
    }
}

/// NAME=LO..HI:COUNT.
fn axis(text: &str) -> Result<(&'static str, Axis), Failure> {
    let bad = || {
        let message = format!("cannot read the sweep {text:?}");
        Failure::usage("range", message, "NAME=LO..HI:COUNT, for example A=-0.3..0.3:201")
    };
    let (name, range) = text.split_once('=').ok_or_else(bad)?;
    let found = SWEPT.iter().find(|(known, _)| *known == name.trim());
    let &(name, parameter) = found.ok_or_else(|| {
        let known: Vec<&str> = SWEPT.iter().map(|(name, _)| *name).collect();
        let message = format!("{:?} cannot be swept", name.trim());
        Failure::usage("unknown-parameter", message, &format!("known: {}", known.join(", ")))
    })?;
    let (range, count) = range.rsplit_once(':').ok_or_else(bad)?;
    let (low, high) = range.split_once("..").ok_or_else(bad)?;
    let number = |text: &str| -> Result<f64, Failure> {
        let exact = match Value::parse(text)? {
            Value::Rational(q) => Exact::Rational(q),
            Value::PiTimes(q) => Exact::PiMultiple(q),
        };
        Some(exact.to_f64()).filter(|x| x.is_finite()).ok_or_else(bad)
    };
    let count: usize = count.trim().parse().map_err(|_| bad())?;
    if count == 0 || count > 100_000 {
        return Err(bad());
    }
    Ok((name, Axis { parameter, low: number(low)?, high: number(high)?, count }))
}
