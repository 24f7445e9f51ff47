//! What is asked: sweeps, prediction.

use super::known::{Computed, Known, Names, built_in, of_file};
use crate::arguments::{KickChoice, PredictorChoice, StabilityOptions, VariantChoice};
use crate::failure::Failure;
use lindstedt::Exact;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::chart::{Axis, Plan, Predictor, Swept};
use lindstedt_impact::parameters::ExactParameters;
use lindstedt_impact::prediction::Variant;
use lindstedt_impact::report;
use rug::{Float, Rational};
use std::path::Path;

/// A swept parameter: its name, its values as doubles, and its ends.
pub struct Sweep {
    pub name: String,
    /// Of a parameter of a file that is no parameter of section 2 the ends and the count only.
    pub axis: Axis,
    /// The value at the point asked for.
    pub base: f64,
    ends: [Exact; 2],
}

impl Sweep {
    /// The n-th value as the double nearest to the exact one, which decimals of few digits are.
    pub fn value(&self, n: usize) -> f64 {
        match self.exact(n) {
            Some(Exact::Rational(q)) => Float::with_val(53, q).to_f64(),
            _ => self.axis.value(n),
        }
    }

    /// The n-th value, between ends of one kind.
    pub fn exact(&self, n: usize) -> Option<Exact> {
        let steps = self.axis.count.saturating_sub(1).max(1);
        let node = |low: &Rational, high: &Rational| {
            Rational::from(high - low) * Rational::from((n, steps)) + low
        };
        Some(match &self.ends {
            [Exact::Rational(low), Exact::Rational(high)] => Exact::Rational(node(low, high)),
            [Exact::PiTimes(low), Exact::PiTimes(high)] => Exact::PiTimes(node(low, high)),
            _ => return None,
        })
    }
}

pub struct Request {
    pub problem: String,
    pub parameters: ExactParameters,
    /// The canonical parameters of a file, where they are not those of the file itself.
    pub canonical: Option<Vec<(String, String)>>,
    /// What has to be said about the file.
    pub remark: Option<String>,
    /// All parameters with their values as text, in the order of the card.
    pub at: Vec<(String, String)>,
    /// Names and axes of the sweeps.
    pub sweeps: Vec<Sweep>,
    /// The parameters of section 2 at other values of those of a file, where one is swept that these
    /// are computed from.
    pub computed: Option<Box<Computed>>,
    pub predictor: PredictorChoice,
    pub variant: VariantChoice,
    pub order: usize,
    pub kick: Kick,
}

impl Request {
    pub fn read(options: &StabilityOptions) -> Result<Self, Failure> {
        let Known { problem, parameters, canonical, remark, at, names, text, computed } =
            if options.problem.ends_with(".toml") {
                of_file(&options.problem, &options.set)?
            } else if options.problem == "vibro-impact" {
                built_in(&options.set)?
            } else {
                let shown: String = options.problem.chars().take(60).collect();
                let message = format!("no impact orbit in {shown:?}");
                let hint = "known: vibro-impact, or the path of a problem file (.toml)";
                return Err(Failure::usage("unknown-problem", message, hint));
            };
        let mut sweeps: Vec<Sweep> =
            options.sweep.iter().map(|t| sweep(&text(t)?, &*names)).collect::<Result<_, _>>()?;
        let general = sweeps.iter().any(|sweep| names(&sweep.name).is_ok_and(|n| n.0.is_none()));
        let mut parameters_of_section_2 = parameters.nearest();
        for sweep in sweeps.iter_mut().filter(|_| !general) {
            sweep.base = *parameters_of_section_2.slot(sweep.axis.parameter);
        }
        if general && let Some(sweep) = sweeps.iter().find(|sweep| sweep.exact(0).is_none()) {
            let message =
                format!("the ends of {} are not both multiples of pi, or neither", sweep.name);
            return Err(Failure::usage("range", message, ""));
        }
        if sweeps.len() > 2 {
            return Err(Failure::usage("range", "at most two sweeps".to_owned(), ""));
        }
        if let [first, second] = sweeps.as_slice()
            && (first.name == second.name
                || !general && first.axis.parameter == second.axis.parameter)
        {
            return Err(Failure::usage("range", format!("{} is swept twice", first.name), ""));
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
            problem,
            parameters,
            canonical,
            remark,
            at,
            sweeps,
            computed: computed.filter(|_| general),
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
        let columns = self.sweeps.first()?.axis;
        let second = self.sweeps.get(1).map(|sweep| sweep.axis);
        let rows = second.unwrap_or_else(|| self.single_row(columns.parameter));
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
        let base = self.parameters.nearest();
        let (parameter, value) = if swept == Swept::VelocityGain {
            (Swept::DisplacementGain, base.displacement_gain)
        } else {
            (Swept::VelocityGain, base.velocity_gain)
        };
        Axis { parameter, low: value, high: value, count: 1 }
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
fn sweep(text: &str, names: &Names) -> Result<Sweep, Failure> {
    let bad = || {
        let message = format!("cannot read the sweep {text:?}");
        Failure::usage("range", message, "NAME=LO..HI:COUNT, for example A=-0.3..0.3:201")
    };
    let (name, range) = text.split_once('=').ok_or_else(bad)?;
    let name = name.trim();
    let (parameter, base) = names(name)?;
    let parameter = parameter.unwrap_or(Swept::VelocityGain);
    let (range, count) = range.rsplit_once(':').ok_or_else(bad)?;
    let (low, high) = range.split_once("..").ok_or_else(bad)?;
    let ends = [Exact::parse(low)?, Exact::parse(high)?];
    let number = |value: &Exact| {
        let double = value.to_f64();
        Some(double).filter(|x| x.is_finite()).ok_or_else(bad)
    };
    let count: usize = count.trim().parse().map_err(|_| bad())?;
    if count == 0 || count > 100_000 {
        return Err(bad());
    }
    let axis = Axis { parameter, low: number(&ends[0])?, high: number(&ends[1])?, count };
    Ok(Sweep { name: name.to_owned(), axis, base, ends })
}
