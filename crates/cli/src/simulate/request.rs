//! Reading the arguments of `simulate`.

use super::motion::{End, Plan};
use super::setup::Setup;
use crate::arguments::{Figure, Section, SimulateOptions};
use crate::failure::Failure;
use lindstedt::Exact;
use lindstedt::simulate::Quantity;
use rug::Rational;

/// The most values of a range.
const MOST_VALUES: u64 = 100_000;
/// Where nothing is said: so many impacts, periods, or units of time.
const IMPACTS: u32 = 20;
const PERIODS: u32 = 20;
/// Samples over a given time.
const INTERVALS: u32 = 20;

fn number(what: &'static str, text: &str) -> Result<Quantity, Failure> {
    let wrong = |_| {
        let message = format!("{:?} is no number", text.chars().take(60).collect::<String>());
        Failure::usage(what, message, "exact values: 3, -1/3, 0.1, pi/4")
    };
    Exact::parse(text).map(Quantity::from).map_err(wrong)
}

/// `LO..HI:COUNT`, in order.
pub fn range(what: &'static str, text: &str) -> Result<Vec<Quantity>, Failure> {
    let usage = |message: String| Failure::usage(what, message, "LO..HI:COUNT, as in 0..1:11");
    let wrong = || usage(format!("{text:?} is no range"));
    let (low, rest) = text.split_once("..").ok_or_else(wrong)?;
    let (high, count) = rest.rsplit_once(':').ok_or_else(wrong)?;
    let count: u64 = count.trim().parse().map_err(|_| wrong())?;
    if count == 0 || count > MOST_VALUES {
        return Err(usage(format!("a range has 1 to {MOST_VALUES} values, not {count}")));
    }
    let (low, high) = (number(what, low)?, number(what, high)?);
    if high.float(4000) < low.float(4000) {
        return Err(usage(format!("{text:?} does not increase")));
    }
    let steps = count.saturating_sub(1).max(1);
    let node = |i: u64| match (low.rational(), high.rational()) {
        (Some(a), Some(b)) => Quantity::from((b - &a) * Rational::from((i, steps)) + a),
        _ => {
            let (a, b) = (low.float(4000), high.float(4000));
            Quantity::Float((b - &a) * Rational::from((i, steps)) + a)
        }
    };
    Ok((0..count).map(node).collect())
}

/// What a figure shows where nothing is said.
pub fn figure(options: &SimulateOptions, setup: &Setup) -> Result<Figure, Failure> {
    if options.figure.is_some() && options.plot.is_empty() {
        let message = "a figure needs a file".to_owned();
        return Err(Failure::usage("figure", message, "--plot FILE.svg"));
    }
    let usual = match (&options.sweep, options.section) {
        (Some(_), _) => Figure::Bifurcation,
        (None, Some(_)) => Figure::Section,
        (None, None) if setup.wall => Figure::Time,
        (None, None) => Figure::Phase,
    };
    let figure = options.figure.unwrap_or(usual);
    if (figure == Figure::Bifurcation) != options.sweep.is_some() {
        let message = "a bifurcation diagram needs --sweep, and --sweep is one".to_owned();
        return Err(Failure::usage("figure", message, "--sweep gamma=0.5..1:400"));
    }
    Ok(figure)
}

/// The section asked for or needed.
pub fn section(options: &SimulateOptions, setup: &Setup) -> Result<Option<Section>, Failure> {
    let wanted = options.sweep.is_some() || options.figure == Some(Figure::Section);
    let usual = match &setup.forcing {
        _ if setup.wall => Section::Impact,
        Some(_) => Section::Stroboscopic,
        None => Section::Velocity,
    };
    let section = options.section.or(wanted.then_some(usual));
    if section == Some(Section::Stroboscopic) && setup.orbit.is_some() {
        let message = "the impacts of the orbit come at the times of this section, where x' jumps";
        return Err(Failure::usage("section", message.to_owned(), "--section impact, or --state"));
    }
    let reason = match section {
        Some(Section::Stroboscopic) if setup.forcing.is_none() => "no force with one period",
        Some(Section::Impact) if !setup.wall => "no wall",
        _ => return Ok(section),
    };
    let message = format!("{} has {reason}", setup.name);
    Err(Failure::usage("section", message, "--section velocity"))
}

/// `--sweep`: NAME alone has the range of the file.
pub fn sweep(text: &str, setup: &Setup) -> Result<String, Failure> {
    match setup.ranges.get(text.trim()) {
        Some(range) => Ok(format!("{}={range}", text.trim())),
        None => Ok(text.to_owned()),
    }
}

/// `X,V`.
pub fn state(options: &SimulateOptions) -> Result<Option<[Quantity; 2]>, Failure> {
    let Some(text) = &options.state else { return Ok(None) };
    let parts: Vec<&str> = text.split(',').collect();
    let [x, v] = parts[..] else {
        let message = format!("{text:?} is not X,V");
        return Err(Failure::usage("state", message, "--state 1,-1/2"));
    };
    Ok(Some([number("state", x)?, number("state", v)?]))
}

/// `--perturb`.
pub fn perturbation(options: &SimulateOptions) -> Result<Option<Rational>, Failure> {
    let Some(text) = &options.perturb else { return Ok(None) };
    let value = number("perturb", text)?.rational().filter(|q| !q.is_zero());
    let wrong =
        || Failure::usage("perturb", "no rational number but zero".into(), "--perturb 1e-6");
    value.map(Some).ok_or_else(wrong)
}

/// What to integrate.
pub fn plan(options: &SimulateOptions, setup: Setup) -> Result<Plan, Failure> {
    let usage = |code, message: &str| Err(Failure::usage(code, message.to_owned(), ""));
    let periods = |n: u32| match &setup.forcing {
        Some(period) => End::Time(times(period, n)),
        None => End::Maxima(n),
    };
    let asked = options.times.as_deref().map_or(Ok(Vec::new()), |text| range("times", text))?;
    let end = match (&options.until, options.periods, options.impacts) {
        (Some(text), ..) => End::Time(number("until", text)?),
        (_, Some(n), _) => periods(n),
        (.., Some(_)) if !setup.wall => {
            return usage("impacts", "there is no wall; use --until or --periods");
        }
        (.., Some(n)) => End::Impacts(n),
        // As long as it takes.
        _ if asked.last().is_some_and(|last| last.float(64) > 0) => {
            End::Time(asked.last().cloned().unwrap_or_else(|| Quantity::from(0)))
        }
        _ if setup.wall => End::Impacts(IMPACTS),
        _ if setup.forcing.is_some() => periods(PERIODS),
        _ => End::Time(Quantity::from(i64::from(PERIODS))),
    };
    let empty = match &end {
        End::Time(time) => time.float(64) <= 0,
        End::Maxima(n) | End::Impacts(n) => *n == 0,
    };
    if empty {
        return usage("until", "the end is not after the start");
    }
    if let (Some(last), End::Time(time)) = (asked.last(), &end)
        && last.float(64) > time.float(64)
    {
        return usage("times", "times go on after the end: --until, --periods");
    }
    let sampled = match (&options.times, &end) {
        (Some(_), _) => asked,
        (None, End::Time(time)) => (0..=INTERVALS).map(|k| part(time, k)).collect(),
        _ => Vec::new(),
    };
    if sampled.first().is_some_and(|first| first.float(64) < 0) {
        return usage("times", "times begin at 0");
    }
    let section = section(options, &setup)?;
    if options.skip.is_some() && section.is_none() {
        return usage("skip", "--skip leaves out points of a section: --section");
    }
    let drawn = !options.plot.is_empty();
    let skip = options.skip.unwrap_or(0) as usize;
    Ok(Plan { setup, end, times: sampled, section, skip, drawn, cut: None })
}

fn times(q: &Quantity, n: u32) -> Quantity {
    q.times(&Rational::from(n))
}

fn part(q: &Quantity, k: u32) -> Quantity {
    q.times(&Rational::from((k, INTERVALS)))
}
