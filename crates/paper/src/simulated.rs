//! What section 3 reports of its simulations, simulated again.

use super::stick_slip::{model, parameters};
use super::{Reader, Row, Section, Table, plain};
use crate::text::texts;
use lindstedt::Error;
use lindstedt_simulate::{
    DiagramSettings, Doubles, Integrator, LyapunovExponent, LyapunovSettings, Model, Point,
    Quantity, Report, Segment, Settings, Sweep, System, diagram, go_on, largest_lyapunov_exponents,
    zero_one,
};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Attractors coexist: this is on the side of the large orbit in the right well, which sticks.
const START: [f64; 2] = [0.11, 0.05];
/// Two points of the section that are so near are the same.
const SAME: f64 = 1e-5;
/// The longest period looked for, in periods of the forcing.
const LONGEST: usize = 64;

/// Digits of the integrations: four or five are shown, and chaos forgets the others.
const DIGITS: u32 = 12;

/// A long orbit at one gamma.
struct Orbit {
    gamma: &'static str,
    /// Periods of the forcing after which it closes; nothing if it does not.
    period: Option<usize>,
    exponent: f64,
    /// Its estimated standard error.
    error: f64,
    /// Share of the time stuck.
    stuck: f64,
    least: f64,
    largest: f64,
    /// Growth rate of the 0-1 test, of every second point of the section.
    growth: f64,
}

/// The systems of all orbits.
fn compile(model: &Model) -> Result<Vec<System<Doubles>>, Error> {
    let system = |gamma| {
        let mut parameters = parameters()?;
        parameters.set("gamma", number(gamma)?);
        Ok(model.compile(Doubles, &parameters)?)
    };
    GAMMAS.into_iter().map(system).collect()
}

fn number(gamma: &str) -> Result<Quantity, Error> {
    Quantity::parse(gamma).ok_or(Error::NoValue)
}

/// The points of the section of every orbit, once per period of the forcing.
fn sections(transient: u32, kept: u32) -> Result<Vec<Vec<[f64; 2]>>, Error> {
    let (model, parameters) = (model()?, parameters()?);
    let values = GAMMAS.into_iter().map(number).collect::<Result<Vec<_>, _>>()?;
    let sweep = Sweep { model: &model, parameters: &parameters, name: "gamma", values: &values };
    let settings = DiagramSettings {
        time: 0.0,
        start: START.to_vec(),
        section: lindstedt_simulate::Section::Period(PI),
        periods: Vec::new(),
        transient,
        kept: kept.max(1),
        follow: false,
        integration: Settings::for_digits(DIGITS),
    };
    let mut found = Vec::new();
    diagram(&sweep, &Doubles, &settings, 0..ORBITS, &go_on, &mut |column| {
        let states = |points: Vec<Point<f64>>| {
            points.iter().map(|point| [point.state[0], point.state[1]]).collect()
        };
        found.push(column.points.map(states));
        ControlFlow::Continue(())
    });
    Ok(found.into_iter().collect::<Result<_, _>>()?)
}

/// The largest Lyapunov exponent of every orbit.
fn exponents(transient: u32, kept: u32) -> Result<Vec<LyapunovExponent>, Error> {
    let integration = Settings::for_digits(DIGITS);
    let averaging = LyapunovSettings { interval: PI, transient, averaged: kept, integration };
    let systems = compile(&model()?.linearised())?;
    let systems: Vec<_> = systems.iter().collect();
    let found = largest_lyapunov_exponents(&systems, &0.0, &START, &averaging, &mut |_| go_on());
    found.into_iter().map(|exponent| exponent?.ok_or(Error::NoValue)).collect()
}

impl Orbit {
    fn new(
        gamma: &'static str,
        system: &System<Doubles>,
        points: &[[f64; 2]],
        exponent: LyapunovExponent,
    ) -> Result<Self, Error> {
        let first = points.first().copied().ok_or(Error::NoValue)?;
        let near = |p: &[f64; 2]| (p[0] - first[0]).abs() + (p[1] - first[1]).abs() < SAME;
        let period = (1..=LONGEST).find(|n| points.get(*n).is_some_and(near));
        let watched = u32::try_from(points.len()).map_or(WATCHED, |kept| kept.min(WATCHED));
        let (stuck, least, largest) = on_the_way(system, first, watched)?;
        let every_second: Vec<f64> = points.iter().step_by(2).map(|p| p[0]).collect();
        Ok(Self {
            gamma,
            period,
            exponent: exponent.value,
            error: exponent.error,
            stuck,
            least,
            largest,
            growth: zero_one(&every_second, &go_on).map_or(f64::NAN, |test| test.k),
        })
    }

    /// An exponent is positive when it is many standard errors above zero.
    fn is_chaotic(&self) -> bool {
        self.period.is_none() && self.exponent > 5.0 * self.error
    }

    fn is_periodic(&self) -> bool {
        self.period.is_some() && self.exponent < 0.0
    }

    /// Both wells are at +-1.
    fn visits_both_wells(&self) -> bool {
        self.least < -0.5 && self.largest > 0.5
    }

    fn shown_period(&self) -> String {
        self.period.map_or("none".to_owned(), |n| n.to_string())
    }

    fn exponent_text(&self) -> String {
        format!("largest Lyapunov exponent {} (estimated)", self.shown_exponent())
    }

    fn shown_exponent(&self) -> String {
        format!("{:+.4} +- {:.0e}", self.exponent, self.error)
    }
}

/// The share of time stuck, and the range of x, over some periods of the forcing.
fn on_the_way(
    system: &System<Doubles>,
    start: [f64; 2],
    periods: u32,
) -> Result<(f64, f64, f64), Error> {
    let mut flow = Integrator::new(system, &0.0, &start, Settings::for_digits(DIGITS))?;
    let (mut stuck, mut least, mut largest) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
    let end = PI * f64::from(periods.max(1));
    flow.advance(&end, &mut |report| {
        if let Report::Segment(segment) = report {
            if segment.modes.contains(&0) {
                stuck += *segment.length;
            }
            for x in [segment.value(0, segment.length), turning_point(segment)] {
                least = least.min(x);
                largest = largest.max(x);
            }
        }
        ControlFlow::Continue(())
    })?;
    Ok((stuck / end, least, largest))
}

/// x where x' changes its sign within a step, by bisection; x at its end where it does not.
fn turning_point(segment: &Segment<'_, Doubles>) -> f64 {
    let (mut low, mut high) = (0.0, *segment.length);
    let rising = |s: &f64| segment.value(1, s) > 0.0;
    let before = rising(&low);
    if rising(&high) != before {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if rising(&middle) == before { low = middle } else { high = middle }
        }
    }
    segment.value(0, &high)
}

/// Periods over which the share stuck and the range of x are taken.
const WATCHED: u32 = 300;

/// How many orbits are followed.
pub(super) const ORBITS: usize = 4;
/// The values of gamma: those of the paper, and one after the first doubling.
const GAMMAS: [&str; ORBITS] = ["0.6", "0.615", "0.65", "1.2"];
const EPS: &str = "at $eps = 1$: the paper names no value";

/// Reads what is reported of the simulations.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let (transient, kept) = reader.options.periods;
    for gamma in GAMMAS {
        if !reader.goes_on(&format!("simulation at gamma = {gamma}")) {
            return Ok(false);
        }
    }
    let (points, exponents) =
        rayon::join(|| sections(transient, kept), || exponents(transient, kept));
    let (points, exponents, systems) = (points?, exponents?, compile(&model()?)?);
    let parts = GAMMAS.into_par_iter().zip(systems).zip(points).zip(exponents);
    let orbit = |(((gamma, system), points), exponent): (((_, _), Vec<_>), _)| {
        Orbit::new(gamma, &system, &points, exponent)
    };
    let orbits: Vec<Orbit> = parts.map(orbit).collect::<Result<_, _>>()?;
    let [periodic, doubled, slight, wells] = &orbits[..] else { return Err(Error::NoValue) };
    let watched = kept.min(WATCHED);
    section.rows.extend(periodic_rows(periodic, doubled));
    section.rows.extend(chaotic_rows(slight, wells, watched));
    section.rows.push(sticks_row([periodic, slight, wells]));
    section.tables.push(table(&orbits, transient, kept));
    Ok(true)
}

/// The periodic orbit and its doubling.
fn periodic_rows(periodic: &Orbit, doubled: &Orbit) -> [Row; 2] {
    let closes = |o: &Orbit| {
        let shown = o.shown_period();
        format!("at $gamma = {}$ the orbit closes after {shown} periods of the forcing", o.gamma)
    };
    [
        plain(
            "$gamma = 0.6$",
            "for $gamma = 0.6$ we have obtained a periodic orbit",
            closes(periodic),
            periodic.exponent_text(),
            periodic.is_periodic(),
            &format!("{EPS}; $x(0) = {}$, $x'(0) = {}$: attractors coexist", START[0], START[1]),
        ),
        plain(
            "doubling",
            "with an increase in $gamma$ it doubles its period",
            format!("{}; {}", closes(periodic), closes(doubled)),
            doubled.exponent_text(),
            doubled.period == periodic.period.map(|n| 2 * n),
            "the same attractor at two values of $gamma$",
        ),
    ]
}

/// Chaos in one well and in both; the range of x was `watched` over so many periods.
fn chaotic_rows(slight: &Orbit, wells: &Orbit, watched: u32) -> [Row; 2] {
    let range =
        |o: &Orbit| format!("${:.3} < x < {:.3}$ over {watched} periods", o.least, o.largest);
    [
        plain(
            "$gamma = 0.65$",
            "closely to 0.65 a very slight chaotic behaviour has been observed",
            slight.exponent_text(),
            format!(
                "0-1 test on every second point of the section: $K = {:.3}$ (estimated)",
                slight.growth
            ),
            slight.is_chaotic() && slight.growth > 0.9,
            &format!(
                "in one well only: {} (estimated), by period doubling; not the tangle that (27) is \
                 about",
                range(slight)
            ),
        ),
        plain(
            "$gamma = 1.2$",
            "for $gamma = 1.2$ two-well potential chaos is shown",
            wells.exponent_text(),
            format!("{}: both wells (estimated)", range(wells)),
            wells.is_chaotic() && wells.visits_both_wells(),
            EPS,
        ),
    ]
}

fn sticks_row(orbits: [&Orbit; 3]) -> Row {
    let [periodic, slight, wells] = orbits.map(|o| o.stuck);
    plain(
        "sticks",
        "in all of the phase portraits the cusps corresponding to the sticks are visible",
        format!(
            "share of the time stuck: {periodic:.3}, {slight:.3} and {wells:.3} at $gamma = 0.6$, 0.65 and \
             1.2 (estimated)"
        ),
        "events of the integration: sticking where $x' = v*$ and the force is below $eps T0$",
        [periodic, slight, wells].iter().all(|stuck| *stuck > 0.0),
        "Fig. 1 itself prints no parameters",
    )
}

fn table(orbits: &[Orbit], transient: u32, kept: u32) -> Table {
    let columns = [
        "$gamma$",
        "period",
        "Lyapunov exponent",
        "$K$ of the 0-1 test",
        "stuck",
        "least $x$",
        "largest $x$",
    ];
    let row = |o: &Orbit| {
        vec![
            o.gamma.to_owned(),
            o.shown_period(),
            o.shown_exponent(),
            format!("{:.3}", o.growth),
            format!("{:.3}", o.stuck),
            format!("{:.4}", o.least),
            format!("{:.4}", o.largest),
        ]
    };
    Table {
        name: "simulations".to_owned(),
        title: "The orbits of the text, simulated at $eps = 1$ (estimated)".into(),
        columns: texts(columns),
        rows: orbits.iter().map(row).map(texts).collect(),
        notes: texts([
            format!("{transient} periods of the forcing left out, {kept} averaged over; doubles"),
            "the period is in periods of the forcing, the exponent per unit of time with its \
             standard error; $K$ of every second stroboscopic point, near 1 for chaos"
                .to_owned(),
            format!("stuck, least and largest $x$ over {} periods", kept.min(WATCHED)),
        ]),
    }
}
