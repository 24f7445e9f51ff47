//! Reading the arguments of `threshold`.

use crate::arguments::ThresholdOptions;
use crate::failure::Failure;
use crate::recognised::Source;
use crate::session::parameters;
use lindstedt::Exact;
use lindstedt::algebra::Stop;
use lindstedt::equation::Text;
use lindstedt::equation::print::Style;
use lindstedt::number::ball::{Ball, Balls};
use lindstedt::problems::stick_slip;
use lindstedt::recognise::{LowestHarmonic, MelnikovProblem, all_values};
use lindstedt_melnikov::{Axis, Class, StickSlip};
use rug::Rational;
use std::path::Path;

/// The most values of one axis.
const MOST_VALUES: u64 = 1_000_000;

/// A swept parameter.
pub struct Sweep {
    /// The parameter of section 3 that it is; nothing for other parameters of a file.
    pub axis: Option<Axis>,
    pub name: String,
    /// The values, exact where the ends are rational.
    pub values: Vec<Exact>,
}

/// What is asked.
pub struct Request {
    pub problem: String,
    /// The oscillator of section 3, which the equation of a file may be too.
    pub point: Option<StickSlip>,
    /// A problem file, and what was found in it.
    pub file: Option<(Source, MelnikovProblem)>,
    pub gamma: Exact,
    pub eps: Exact,
    /// What gamma and gamma_c are in the symbols of the problem.
    pub lowest: Option<LowestHarmonic>,
    /// What was set without an effect, or is zero.
    pub remarks: Vec<String>,
    /// Every parameter as it stands, in the order of the data card.
    pub at: Vec<(Text, Exact)>,
    /// One, or two: the first is the horizontal axis of a figure.
    pub sweeps: Vec<Sweep>,
    /// Parameter, its name, and the range.
    pub zeros: Option<(Option<Axis>, String, Exact, Exact)>,
}

pub fn axis(name: &str) -> Option<Axis> {
    Some(match name {
        "a" => Axis::A,
        "b" => Axis::B,
        "T0" => Axis::Dry,
        "alpha" => Axis::Alpha,
        "beta" => Axis::Beta,
        "omega" => Axis::Omega,
        "vstar" => Axis::BeltSpeed,
        _ => return None,
    })
}

fn parse(text: &str) -> Result<Exact, Failure> {
    Ok(Exact::parse(text)?)
}

fn usage(what: &str, text: &str) -> Failure {
    let hint = "NAME=LO..HI:COUNT or NAME=V1,V2,... for --sweep, NAME=LO..HI for --zeros";
    let shown: String = text.chars().take(60).collect();
    Failure::usage("range", format!("cannot read the {what} {shown:?}"), hint)
}

/// The parameter of a range, which parameter of section 3 it is, and the range.
fn named<'a>(
    what: &str,
    text: &'a str,
    file: Option<&(Source, MelnikovProblem)>,
) -> Result<(Option<Axis>, &'a str, &'a str), Failure> {
    let (name, range) = text.split_once('=').ok_or_else(|| usage(what, text))?;
    let name = name.trim();
    let unknown = |known: &str| {
        let message = format!("{name:?} cannot be varied");
        Failure::usage("unknown-parameter", message, known)
    };
    if let Some((source, _)) = file {
        source.sweep(text)?;
    }
    let Some((source, found)) = file else {
        let axis = axis(name).ok_or_else(|| unknown("a, b, T0, alpha, beta, omega, vstar"))?;
        return Ok((Some(axis), name, range));
    };
    if !source.values.contains_key(name) || *name == *source.problem.small {
        let known: Vec<String> = source.at().into_iter().map(|(name, _)| name).collect();
        return Err(unknown(&known.join(", ")));
    }
    Ok((found.axis(&source.problem, &source.values, name), name, range))
}

impl Sweep {
    fn read(text: &str, file: Option<&(Source, MelnikovProblem)>) -> Result<Self, Failure> {
        let text = match file {
            Some((source, _)) => &*source.sweep(text)?,
            None => text,
        };
        let (axis, name, range) = named("sweep", text, file)?;
        let name = name.to_owned();
        let Some((low, rest)) = range.split_once("..") else {
            let values = range.split(',').map(parse).collect::<Result<_, _>>()?;
            return Ok(Self { axis, name, values });
        };
        let (high, count) = rest.rsplit_once(':').ok_or_else(|| usage("sweep", text))?;
        let count: u64 = count.trim().parse().map_err(|_| usage("sweep", text))?;
        if count == 0 || count > MOST_VALUES {
            let message = format!("a sweep has 1 to {MOST_VALUES} values, not {count}");
            return Err(Failure::usage("range", message, ""));
        }
        let (low, high) = (exact(&parse(low)?), exact(&parse(high)?));
        let steps = Rational::from(count.saturating_sub(1).max(1));
        let width = Rational::from(&high - &low) / steps;
        let node = |i: u64| Exact::Rational((&width * Rational::from(i)) + &low);
        Ok(Self { axis, name, values: (0..count).map(node).collect() })
    }
}

/// The number, or the double next to it where it is a multiple of pi.
fn exact(value: &Exact) -> Rational {
    let nearest = || Rational::from_f64(value.to_f64()).unwrap_or_default();
    value.as_rational().cloned().unwrap_or_else(nearest)
}

impl Request {
    pub fn read(options: &ThresholdOptions) -> Result<Self, Failure> {
        let Known { problem, point, file, gamma, eps, lowest, remarks, at } =
            if options.problem.ends_with(".toml") { of_file(options)? } else { built_in(options)? };
        if options.sweep.len() > 2 {
            let message = "at most two sweeps".to_owned();
            return Err(Failure::usage("range", message, ""));
        }
        let sweeps: Vec<Sweep> = options
            .sweep
            .iter()
            .map(|text| Sweep::read(text, file.as_ref()))
            .collect::<Result<_, _>>()?;
        if let [first, second] = sweeps.as_slice()
            && first.name == second.name
        {
            let message = format!("{} is swept twice", first.name);
            return Err(Failure::usage("range", message, ""));
        }
        if !options.plot.is_empty() && sweeps.is_empty() {
            let message = "--plot needs a --sweep".to_owned();
            return Err(Failure::usage("plot", message, "for example --sweep vstar=0..1:400"));
        }
        let is = |path: &Path, kind: &str| {
            path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind))
        };
        if let Some(path) = options.plot.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
            let message = format!("cannot plot to {}", path.display());
            return Err(Failure::usage("plot", message, "the name must end in .svg or .csv"));
        }
        let zeros = match &options.zeros {
            None => None,
            Some(text) => {
                let (axis, name, range) = named("range", text, file.as_ref())?;
                let (low, high) = range.split_once("..").ok_or_else(|| usage("range", text))?;
                Some((axis, name.to_owned(), parse(low)?, parse(high)?))
            }
        };
        Ok(Self { problem, point, file, gamma, eps, lowest, remarks, at, sweeps, zeros })
    }

    /// The same request, whose orbits of files are followed until asked to stop.
    pub fn watched(mut self, stop: &Stop) -> Self {
        self.file = self.file.map(|(source, found)| (source, found.watched(stop)));
        self
    }

    /// The oscillator of section 3 with other values of swept parameters, where all of them are its own.
    pub fn changed(&self, changes: &[(&Sweep, &Exact)]) -> Option<StickSlip> {
        let change = |point: StickSlip, (sweep, value): &(&Sweep, &Exact)| {
            Some(point.with(sweep.axis?, (*value).clone()))
        };
        changes.iter().try_fold(self.point.clone()?, change)
    }

    /// The signed threshold with other values of swept parameters, or why there is none; of several
    /// orbits that of the least threshold.
    pub fn signed(&self, balls: Balls, changes: &[(&Sweep, &Exact)]) -> Result<Ball, String> {
        let undecided = || format!("not decided with {} bits", balls.bits());
        if let Some(point) = self.changed(changes) {
            match (point.check(), &self.file) {
                (Ok(()), _) => return point.signed_threshold(balls).ok_or_else(undecided),
                (Err(error), None) => return Err(error.to_string()),
                // With these values the equation of the file may be another one that is taken.
                (Err(_), Some(_)) => {}
            }
        }
        let (source, _) = self.file.as_ref().ok_or_else(undecided)?;
        let mut values = source.values.clone();
        for (sweep, value) in changes {
            values.insert(sweep.name.clone(), (*value).clone());
        }
        let found = MelnikovProblem::new(&source.problem, &values);
        let found = found.map_err(|refusal| source.reason(&refusal))?;
        let orbits = found.thresholds(balls).map_err(|error| error.to_string())?;
        let least = |a: &Ball, b: &Ball| a.midpoint().total_cmp(b.midpoint());
        let least = orbits.iter().min_by(|a, b| least(&a.threshold.gamma, &b.threshold.gamma));
        least.map(|orbit| orbit.threshold.signed.clone()).ok_or_else(undecided)
    }

    /// The name of the small parameter.
    pub fn small(&self) -> &str {
        self.file.as_ref().map_or("eps", |(source, _)| &source.problem.small)
    }

    /// Whether every swept parameter is one of section 3, and the equation of a file stays that of
    /// section 3.
    pub fn is_fast(&self) -> bool {
        let positive = |sweep: &Sweep| sweep.values.iter().all(|value| value.sign().is_gt());
        let stays = |sweep: &Sweep| match sweep.axis {
            Some(Axis::A | Axis::B | Axis::Omega) => self.file.is_none() || positive(sweep),
            axis => axis.is_some(),
        };
        self.point.is_some() && self.sweeps.iter().all(stays)
    }

    /// How the numbers are known.
    pub fn class(&self) -> Class {
        self.file.as_ref().map_or(Class::Certified, |(_, found)| found.class())
    }
}

/// What the problem says.
struct Known {
    problem: String,
    point: Option<StickSlip>,
    file: Option<(Source, MelnikovProblem)>,
    gamma: Exact,
    eps: Exact,
    lowest: Option<LowestHarmonic>,
    remarks: Vec<String>,
    at: Vec<(Text, Exact)>,
}

/// That the small parameter was set, and forces that are zero.
fn remarks(small: &str, jumps: bool, set: bool, lowest: Option<&LowestHarmonic>) -> Vec<String> {
    let mut remarks = Vec::new();
    if set && jumps {
        remarks.push(format!(
            "{small} takes no part in gamma_c (of first order in it), only in the verdict on validity"
        ));
    } else if set {
        remarks.push(format!("{small} has no effect: gamma_c is of first order in it"));
    }
    for force in lowest.iter().flat_map(|lowest| &lowest.silent) {
        let force = force.print(small, Style::Text);
        remarks.push(format!("{force} is zero at these values and left out"));
    }
    remarks
}

fn of_file(options: &ThresholdOptions) -> Result<Known, Failure> {
    let source = Source::read(&options.problem, &options.set, &[])?;
    let found = MelnikovProblem::new(&source.problem, &source.values)
        .map_err(|refusal| source.refuse(refusal))?;
    let at = source.at().into_iter().map(|(name, value)| (Text::from(name), value));
    let small = source.problem.small.to_string();
    let eps = source.values.get(&small).cloned();
    let lowest = LowestHarmonic::find(&source.problem, &source.values);
    let set = parameters(&options.set)?.contains_key(&small);
    let remarks = remarks(&small, found.jumps(), set, lowest.as_ref());
    Ok(Known {
        lowest,
        remarks,
        problem: source.problem.name.to_string(),
        point: found.stick_slip(),
        gamma: found.amplitude.clone(),
        eps: eps.unwrap_or_else(|| Exact::from(1)),
        at: at.collect(),
        file: Some((source, found)),
    })
}

fn built_in(options: &ThresholdOptions) -> Result<Known, Failure> {
    if options.problem != "stick-slip" {
        let shown: String = options.problem.chars().take(60).collect();
        let message = format!("no threshold for {shown:?}");
        let hint = "known: stick-slip, or the path of a problem file (.toml)";
        return Err(Failure::usage("unknown-problem", message, hint));
    }
    let mut set = parameters(&options.set)?;
    let card = stick_slip::problem();
    let lowest = LowestHarmonic::find(&card, &all_values(&card, &set));
    let eps_is_set = set.contains_key("eps");
    let mut at = Vec::new();
    for card in card.parameters {
        let value = match set.remove(&*card.name) {
            Some(value) => value,
            None => parse(&card.default)?,
        };
        at.push((card.name, value));
    }
    if let Some(name) = set.keys().next() {
        let known: Vec<&str> = at.iter().map(|(name, _)| &**name).collect();
        let message = format!("stick-slip has no parameter {name:?}");
        let hint = format!("it has {}", known.join(", "));
        return Err(Failure::usage("unknown-parameter", message, &hint));
    }
    let mut point = StickSlip::paper();
    for (name, value) in &at {
        if let Some(axis) = axis(name) {
            point = point.with(axis, value.clone());
        }
    }
    point.check()?;
    let get = |wanted: &str| {
        let value = at.iter().find(|(name, _)| name == wanted).map(|(_, value)| value.clone());
        value.unwrap_or_else(|| Exact::from(0))
    };
    let (gamma, eps) = (get("gamma"), get("eps"));
    let remarks = remarks("eps", point.dry.sign().is_ne(), eps_is_set, lowest.as_ref());
    Ok(Known {
        problem: "stick-slip".to_owned(),
        point: Some(point),
        file: None,
        gamma,
        eps,
        lowest,
        remarks,
        at,
    })
}
