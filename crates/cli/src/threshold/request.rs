//! Reading the arguments of `threshold`.

use crate::arguments::ThresholdOptions;
use crate::failure::Failure;
use crate::session::parameters;
use lindstedt::Value;
use lindstedt::equation::Text;
use lindstedt::problems::stick_slip;
use lindstedt_melnikov::{Axis, Real, StickSlip};
use rug::Rational;
use std::path::Path;

/// The most values of one axis.
const MOST_VALUES: u64 = 1_000_000;

/// A swept parameter.
pub struct Sweep {
    pub axis: Axis,
    pub name: String,
    /// The values, exact where the ends are rational.
    pub values: Vec<Real>,
}

/// What is asked.
pub struct Request {
    pub point: StickSlip,
    pub gamma: Real,
    pub eps: Real,
    /// Every parameter as it stands, in the order of the data card.
    pub at: Vec<(Text, Real)>,
    /// One, or two: the first is the horizontal axis of a figure.
    pub sweeps: Vec<Sweep>,
    /// Parameter, its name, and the range.
    pub zeros: Option<(Axis, String, Real, Real)>,
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

pub fn real(value: Value) -> Real {
    match value {
        Value::Rational(q) => Real::Rational(q),
        Value::PiTimes(q) => Real::pi_multiple(q),
    }
}

fn parse(text: &str) -> Result<Real, Failure> {
    Ok(real(Value::parse(text)?))
}

fn usage(what: &str, text: &str) -> Failure {
    let hint = "NAME=LO..HI:COUNT or NAME=V1,V2,... for --sweep, NAME=LO..HI for --zeros";
    let shown: String = text.chars().take(60).collect();
    Failure::usage("range", format!("cannot read the {what} {shown:?}"), hint)
}

fn named<'a>(what: &str, text: &'a str) -> Result<(Axis, &'a str, &'a str), Failure> {
    let (name, range) = text.split_once('=').ok_or_else(|| usage(what, text))?;
    let name = name.trim();
    let axis = axis(name).ok_or_else(|| {
        let message = format!("{name:?} cannot be varied");
        Failure::usage("unknown-parameter", message, "a, b, T0, alpha, beta, omega, vstar")
    })?;
    Ok((axis, name, range))
}

impl Sweep {
    fn read(text: &str) -> Result<Self, Failure> {
        let (axis, name, range) = named("sweep", text)?;
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
        let node = |i: u64| Real::Rational((&width * Rational::from(i)) + &low);
        Ok(Self { axis, name, values: (0..count).map(node).collect() })
    }
}

/// The number, or the double next to it where it is a multiple of pi.
fn exact(value: &Real) -> Rational {
    let nearest = || Rational::from_f64(value.to_f64()).unwrap_or_default();
    value.as_rational().cloned().unwrap_or_else(nearest)
}

impl Request {
    pub fn read(options: &ThresholdOptions) -> Result<Self, Failure> {
        if options.problem != "stick-slip" {
            let shown: String = options.problem.chars().take(60).collect();
            let message = format!("no threshold for {shown:?}");
            return Err(Failure::usage("unknown-problem", message, "known: stick-slip"));
        }
        let mut set = parameters(&options.set)?;
        let mut at = Vec::new();
        for card in stick_slip::problem().parameters {
            let value = match set.remove(&*card.name) {
                Some(value) => real(value),
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
            value.unwrap_or_else(|| Real::from(0))
        };
        let (gamma, eps) = (get("gamma"), get("eps"));
        if options.sweep.len() > 2 {
            let message = "at most two sweeps".to_owned();
            return Err(Failure::usage("range", message, ""));
        }
        let sweeps: Vec<Sweep> =
            options.sweep.iter().map(|text| Sweep::read(text)).collect::<Result<_, _>>()?;
        if let [first, second] = sweeps.as_slice()
            && first.axis == second.axis
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
                let (axis, name, range) = named("range", text)?;
                let (low, high) = range.split_once("..").ok_or_else(|| usage("range", text))?;
                Some((axis, name.to_owned(), parse(low)?, parse(high)?))
            }
        };
        Ok(Self { point, gamma, eps, at, sweeps, zeros })
    }
}
