//! What (17) predicts, against the stability of (1): how often they agree, orbit by orbit, and
//! what the amplitude of (8) does to the multipliers.

use super::FAILED;
use crate::Text;
use crate::text::texts;
use crate::{Findings, Reader, Row, Section, Table};
use lindstedt::Error;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::equivalent::{Drive, equivalent_orbit};
use lindstedt_impact::flow::{Flow, rates};
use lindstedt_impact::kick::piecewise_stable;
use lindstedt_impact::map::Verdict as Stability;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use lindstedt_impact::prediction::{Variant, predict, predicted_flow, uncontrolled_map};
use lindstedt_impact::zeros::exact_verdict;
use lindstedt_number::Exact;
use lindstedt_number::digits::decimal;
use lindstedt_number::real::Certified;
use rayon::prelude::*;
use rug::Rational;
use serde::Serialize;

/// Orbits with alpha = P0 = 1: omega, k, R_r, s, c in hundredths (omega in tenths). The paper
/// gives no parameters; all are free of penetration, O8 lies on the lower branch.
const ORBITS: [(&str, i32, u32, i32, i32, i32); 9] = [
    ("O1", 26, 1, 80, 0, 5),
    ("O2", 26, 2, 40, 20, 5),
    ("O3", 33, 1, 60, -20, 20),
    ("O4", 20, 1, 80, -20, 10),
    ("O5", 33, 2, 80, 0, 5),
    ("O6", 44, 2, 80, -20, 10),
    ("O7", 8, 1, 80, 50, 5),
    ("O8", 44, 3, 80, 50, 10),
    ("O9", 13, 1, 80, 20, 5),
];

/// Orbits of the sample, and those of the upper branch: what is counted.
pub(crate) const ORBITS_READ: usize = ORBITS.len();
pub(crate) const SAMPLED: usize = ORBITS_READ - 1;

/// The first orbit that is unstable without the loop: its name with the parameters.
pub(crate) fn unstable_example() -> Option<(Text, Parameters<f64>)> {
    ORBITS.into_iter().filter(|entry| entry.0 != LOWER).find_map(|entry| {
        let p = parameters(entry, Branch::Plus);
        let base = p.nearest();
        let found = orbit(&base).ok()?;
        let stable = uncontrolled_map(&base, &found).verdict() == Stability::Stable;
        let (_, omega, k, restitution, wall, damping) = entry;
        let tenths = f64::from(omega) / 10.0;
        let [restitution, wall, damping] =
            [restitution, wall, damping].map(|n| f64::from(n) / 100.0);
        let name = format!(
            "orbit {} ($alpha = P0 = 1$, $omega = {tenths}$, $k = {k}$, $R_r = {restitution}$, \
             $s = {wall}$, $c = {damping}$)",
            entry.0
        );
        (!stable).then_some((name.into(), base))
    })
}

/// The orbit on the lower branch.
const LOWER: &str = "O8";

/// The largest gain.
const REACH: f64 = 0.3;
/// Flights by which the growth of the piecewise linear return map is measured.
const FLIGHTS: usize = 400;
/// A prediction that agrees on fewer points is no stability analysis.
const GOOD: f64 = 0.95;

/// The rules that are compared with the truth.
const RULES: [&str; 6] =
    ["no loop", "(17), letter", "(17), own orbit", "(17), true orbit", "R < 0", "G"];

/// Counts of a rule over the sample of orbits and gains.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    /// The rule.
    pub rule: &'static str,
    /// Points where it says something.
    pub compared: usize,
    /// Of these, points where it has the true verdict.
    pub equal: usize,
    /// equal/compared; NaN if nothing was compared.
    pub rate: f64,
}

/// The sample: orbits of the upper branch times gains.
#[derive(Clone, Debug, Serialize)]
pub struct Sample {
    /// Points (orbit, A, B).
    pub points: usize,
    /// Of these, truly stable.
    pub stable: usize,
    /// Of these, points whose growth is within its error of 1: compared with nothing.
    pub undecided: usize,
    /// The rules.
    #[serde(rename = "rules")]
    pub rates: Vec<Rate>,
}

impl Sample {
    pub(crate) fn share(&self, rule: &str) -> f64 {
        self.rates.iter().find(|rate| rate.rule == rule).map_or(f64::NAN, |rate| rate.rate)
    }

    pub(crate) fn compared(&self, rule: &str) -> usize {
        self.rates.iter().find(|rate| rate.rule == rule).map_or(0, |rate| rate.compared)
    }
}

fn parameters(
    (_, omega, periods, restitution, wall, damping): (&str, i32, u32, i32, i32, i32),
    branch: Branch,
) -> ExactParameters {
    let hundredths = |n: i32| Exact::from((n, 100));
    ExactParameters {
        alpha: Exact::from((1, 1)),
        omega: Exact::from((omega, 10)),
        periods,
        restitution: hundredths(restitution),
        wall: hundredths(wall),
        damping: hundredths(damping),
        force: Exact::from((1, 1)),
        displacement_gain: Exact::from((0, 1)),
        velocity_gain: Exact::from((0, 1)),
        branch,
    }
}

/// Whether the orbit is stable: in truth (nothing: undecided), and by every rule (nothing: it predicts nothing).
type Verdicts = (Option<bool>, [Option<bool>; RULES.len()]);

fn verdicts(p: &Parameters<f64>) -> Option<Verdicts> {
    let found = orbit(p).ok()?;
    let stable = |verdict| verdict == Stability::Stable;
    let g = |kick| stable(exact_verdict(&Characteristic::new(p, &found, kick)).0);
    let truth = if p.velocity_gain == 0.0 {
        Some(g(Kick::None))
    } else {
        piecewise_stable(p, &found, FLIGHTS).ok()?
    };
    let flow = predicted_flow(p, &rates(p, 1), 1).ok()?;
    let predicted = |variant| {
        predict(variant, p, &flow, Some(&found)).ok().map(|found| stable(found.map.verdict()))
    };
    let rules = [
        Some(stable(uncontrolled_map(p, &found).verdict())),
        predicted(Variant::P),
        predicted(Variant::E),
        predicted(Variant::S),
        Some(flow.growth_rate < 0.0),
        Some(g(Kick::Mean)),
    ];
    Some((truth, rules))
}

/// Counts over a grid.
#[derive(Clone, Copy, Default)]
struct Counts {
    points: usize,
    stable: usize,
    undecided: usize,
    compared: [usize; RULES.len()],
    equal: [usize; RULES.len()],
    /// R < 0 and unstable, R >= 0 and stable.
    against_rate: [usize; 2],
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.stable += other.stable;
        self.undecided += other.undecided;
        let pairs = self.compared.iter_mut().zip(other.compared);
        let pairs = pairs.chain(self.equal.iter_mut().zip(other.equal));
        pairs
            .chain(self.against_rate.iter_mut().zip(other.against_rate))
            .for_each(|(sum, n)| *sum += n);
    }

    fn rate(&self, rule: usize) -> Option<f64> {
        let (equal, compared) = (*self.equal.get(rule)?, *self.compared.get(rule)?);
        (compared > 0).then(|| equal as f64 / compared as f64)
    }

    fn sample(&self) -> Sample {
        let counts = RULES.into_iter().zip(self.compared).zip(self.equal);
        let rate = |((rule, compared), equal): ((_, usize), usize)| {
            let rate = equal as f64 / compared as f64;
            Rate { rule, compared, equal, rate }
        };
        let rates = counts.map(rate).collect();
        let Self { points, stable, undecided, .. } = *self;
        Sample { points, stable, undecided, rates }
    }

    fn cells(&self, name: &str) -> Vec<String> {
        let share = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{x:.3}"));
        let mut cells = vec![name.to_owned()];
        cells.push(share(Some(self.stable as f64 / self.points.max(1) as f64)));
        cells.extend((0..RULES.len()).map(|rule| share(self.rate(rule))));
        cells
    }
}

/// The grid of `side` x `side` gains.
fn count(base: &Parameters<f64>, side: i32) -> Counts {
    let gain = |n: i32| {
        // The middle is exactly zero.
        f64::from(2 * n - (side - 1)) * REACH / f64::from(side - 1)
    };
    let points: Vec<_> = (0..side * side)
        .into_par_iter()
        .filter_map(|n| {
            let mut p = base.clone();
            p.displacement_gain = gain(n % side);
            p.velocity_gain = gain(n / side);
            verdicts(&p)
        })
        .collect();
    let mut counts = Counts { points: points.len(), ..Counts::default() };
    for (truth, rules) in points {
        let Some(truth) = truth else {
            counts.undecided += 1;
            continue;
        };
        counts.stable += usize::from(truth);
        for (rule, says) in rules.into_iter().enumerate() {
            let Some(says) = says else { continue };
            counts.compared[rule] += 1;
            counts.equal[rule] += usize::from(says == truth);
            if RULES[rule] == "R < 0" && says != truth {
                counts.against_rate[usize::from(truth)] += 1;
            }
        }
    }
    counts
}

/// Adds the two tables and the statements that rest on them.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.tables.push(multipliers()?);
    let side = i32::try_from(reader.options.grid).map_err(|_| FAILED)?.max(3);
    let mut all = Counts::default();
    let mut upper = Counts::default();
    let mut rows = Vec::new();
    for entry in ORBITS {
        if !reader.goes_on(&format!("predictions and truth, orbit {}", entry.0)) {
            return Ok(false);
        }
        let branch = if entry.0 == LOWER { Branch::Minus } else { Branch::Plus };
        let counts = count(&parameters(entry, branch).nearest(), side);
        all.add(&counts);
        if branch == Branch::Plus {
            upper.add(&counts);
        }
        rows.push(counts.cells(entry.0));
    }
    rows.push(upper.cells("all but O8"));
    rows.push(all.cells("all"));
    reader.sample = Some(upper.sample());
    let rate = |rule: usize| upper.rate(rule).unwrap_or(f64::NAN);
    section.rows.extend(statements(&upper, [rate(0), rate(1), rate(2), rate(3), rate(4), rate(5)]));
    section.tables.push(agreement(rows, side, &upper));
    Ok(true)
}

/// What the text says about R and about simulations.
fn statements(counts: &Counts, rates: [f64; RULES.len()]) -> [Row; 2] {
    let [nothing, letter, own, true_orbit, by_rate, g] = rates;
    let [false_stable, false_unstable] = counts.against_rate;
    let own_points = counts.compared[2];
    let best = letter.max(own).max(true_orbit);
    let simulated =
        Findings { holds: best >= GOOD, reproduced: Some(best >= GOOD), ..Findings::default() };
    let grid = format!(
        "{} points, eight orbits, zeros of $G$ and the piecewise linear map of the delayed system, in doubles",
        counts.points
    );
    [
        Row::new(
            "$R < 0$",
            "from (8) it is seen that when $R < 0$ the assumed solution is stabilised more quickly \
                      in comparison to $R = 0$; however, a problem of stability investigation of the \
                      vibro-impact state is much more subtle",
            format!(
                "$e^(R T) < 1$ in the flight (8) where $R < 0$; as a rule for the stability of (1) the sign of \
                 $R$ would agree at {by_rate:.3} of the points (estimated)"
            ),
            grid.clone(),
            // What the paper calls more subtle must not be decided by the sign of R.
            &Findings::holds(false_stable > 0 || false_unstable > 0),
            format!(
                "it is more subtle: $R < 0$ is neither sufficient ({false_stable} points with $R < 0$ are \
                 unstable) nor necessary ({false_unstable} with $R >= 0$ are stable)"
            ),
        ),
        Row::new(
            "simulations",
            "the validity of our analytical approach has been testified by numerical \
                      simulations",
            format!(
                "(17) has the verdict of (1) at {letter:.3} (to the letter), {own:.3} (orbit of \
                 (8) with its own $R$, $alpha0$, of the {own_points} points where it exists) and \
                 {true_orbit:.3} (true orbit) of the points (estimated)"
            ),
            grid,
            &simulated,
            format!(
                "the region of (17) is not the stability region of (1): to ignore the loop is \
                 right at {nothing:.3} (estimated). (6) puts $e^(-lambda T) z(t)$ for $z(t - T)$, as if no impact \
                 lay between; with $z(t)/gamma$ in its place ($G$) the verdict is right at {g:.3} \
                 (estimated). The \
                 parameters of the cited simulations are not given"
            ),
        ),
    ]
}

fn agreement(rows: Vec<Vec<String>>, side: i32, counts: &Counts) -> Table {
    let head = |rule: &str| match rule {
        "R < 0" | "G" => format!("${rule}$"),
        _ => rule.to_owned(),
    };
    let columns = ["orbit", "truly stable"].into_iter().chain(RULES).map(head);
    Table {
        name: "agreement".to_owned(),
        title: Text::from(format!(
            "Share of {side} x {side} points $|A|$, $|B| <= 0.3$ at which a rule has the true verdict \
             (estimated)"
        )),
        columns: texts(columns),
        rows: rows.into_iter().map(texts).collect(),
        notes: texts([
            "estimated: doubles; $alpha = P0 = 1$; the paper gives no parameter set".to_owned(),
            "truth: zeros of the characteristic function $G$ of the delayed system for $B = 0$, growth \
             of the piecewise linear return map otherwise"
                .to_owned(),
            "no loop: the verdict at $A = B = 0$. (17) at order 1: to the letter (amplitudes of the \
             uncontrolled orbit, $R$ and $alpha0$ in (16)); with the orbit of (8) itself, where it \
             exists; with the saltation of the true orbit. $G$: its zeros, with the mean kick"
                .to_owned(),
            format!(
                "{} points without O8, {} of them stable{}; O8 lies on the lower branch, which no \
                 loop of this kind stabilises",
                counts.points,
                counts.stable,
                match counts.undecided {
                    0 => String::new(),
                    n => format!(", {n} undecided: their growth is within its error of 1"),
                }
            ),
        ]),
    }
}

/// The multipliers of (16) without control, with F and with the amplitude printed in (8).
fn multipliers() -> Result<Table, Error> {
    const BITS: u32 = 160;
    const DIGITS: usize = 12;
    let mut rows = Vec::new();
    for entry in ORBITS.into_iter().filter(|entry| entry.0 != LOWER) {
        let p = parameters(entry, Branch::Plus).certified(BITS);
        let failed = |_| FAILED;
        let flow = Flow::uncontrolled(&p).map_err(failed)?;
        let drive = Drive::new(&p).map_err(failed)?;
        let right = equivalent_orbit(&flow, &drive).map_err(failed)?;
        let mut printed = right.clone();
        let square = |x: &Certified| x.clone() * x;
        printed.forced_amplitude = p.force.clone() / &(square(&p.alpha) - &square(&p.omega));
        let mut cells = vec![entry.0.to_owned()];
        for form in [&right, &printed] {
            let show = |x: &Certified| decimal(x.ball(), DIGITS).unwrap_or_else(|| "?".to_owned());
            let [first, second] = form.polynomial(&flow, &drive).map().multipliers();
            let text = if first.im.ball().contains_zero() {
                format!("{}, {}", show(&first.re), show(&second.re))
            } else {
                format!("${} +- {} i$", show(&first.re), show(&first.im))
            };
            cells.push(text);
        }
        let above = Rational::from((entry.1, 10)) > 1;
        cells.insert(1, if above { "$omega > alpha$" } else { "$omega < alpha$" }.to_owned());
        rows.push(cells);
    }
    Ok(Table {
        name: "multipliers".to_owned(),
        title: "Roots of (15) without control, with $a = F$ and with $a = P0/(alpha^2 - omega^2)$"
            .into(),
        columns: texts(["orbit", "", "$a = F$", "$a$ of (8)"]),
        rows: rows.into_iter().map(texts).collect(),
        notes: texts([
            "$phi$ from $F$ in both: $a$ of (8) has the wrong sign for $omega > alpha$".to_owned()
        ]),
    })
}
