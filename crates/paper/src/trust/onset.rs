//! Section 3: the eps up to which Melnikov's threshold tells where the tangle begins.

use super::super::{Findings, Reader, Row, Section, Table};
use super::{ESTIMATED, Finding};
use crate::oscillator::section_three;
use crate::stick_slip::{model, parameters};
use crate::text::texts;
use lindstedt::Error;
use lindstedt_melnikov::Branch;
use lindstedt_simulate::{
    Homoclinic, Loop, Quantity, SimulateError, Tangency, TangencyLine, continue_tangency,
};
use serde::{Serialize, Serializer};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

/// The first homoclinic tangency of both loops.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OnsetPoint {
    /// The perturbation parameter.
    pub eps: f64,
    /// gamma of the right loop with its estimated error; nothing where the branch ends.
    #[serde(serialize_with = "tangency")]
    pub right: Option<(f64, f64)>,
    /// The same of the left loop.
    #[serde(serialize_with = "tangency")]
    pub left: Option<(f64, f64)>,
}

/// A tangency as `{"gamma": ..., "error": ...}`.
fn tangency<S: Serializer>(side: &Option<(f64, f64)>, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Found {
        gamma: f64,
        error: f64,
    }
    side.map(|(gamma, error)| Found { gamma, error }).serialize(serializer)
}

impl OnsetPoint {
    /// max |gamma/gamma_c - 1| over the loops, gamma_c with a slope of each.
    fn deviation(&self, threshold: f64, slopes: [f64; 2]) -> f64 {
        let part = |side: Option<(f64, f64)>, slope: f64| {
            side.map_or(0.0, |s| (s.0 / (threshold + slope * self.eps) - 1.0).abs())
        };
        part(self.right, slopes[0]).max(part(self.left, slopes[1]))
    }
}

/// Melnikov's threshold and the true onset as eps grows, at the paper's parameters. Estimated.
#[derive(Clone, Debug, Serialize)]
pub struct Onset {
    /// gamma_c of (27), corrected; it does not depend on eps.
    pub threshold: f64,
    /// The slopes of both loops at eps = 0.
    pub slopes: Vec<OnsetSlope>,
    /// The tangencies, by rising eps.
    pub points: Vec<OnsetPoint>,
    /// The class of the numbers.
    pub status: &'static str,
}

/// d gamma/d eps of a loop at eps = 0.
#[derive(Clone, Debug, Serialize)]
pub struct OnsetSlope {
    /// `right` or `left`.
    pub name: &'static str,
    /// By Melnikov's integral of second order.
    pub slope: f64,
    /// Its estimated error.
    pub error: f64,
    /// From the tangencies up to eps = 0.2, extrapolated.
    pub tangencies: f64,
    /// Its estimated error.
    pub tangencies_error: f64,
}

/// Tangencies up to this eps are extrapolated.
const NEAR_ZERO: f64 = 0.2;

/// Both loops by both routes.
fn slopes(points: &[OnsetPoint]) -> Result<Vec<OnsetSlope>, Error> {
    let one = |name, branch, side: fn(&OnsetPoint) -> Option<(f64, f64)>| {
        let found = section_three().second_order(branch).ok_or(Error::NoValue)?;
        let near = points.iter().filter(|point| point.eps <= NEAR_ZERO);
        let near = near.filter_map(|p| side(p).map(|(gamma, error)| [p.eps, gamma, error]));
        let line = TangencyLine::through(near.collect());
        let (tangencies, tangencies_error) = (line.slope, line.errors[1]);
        Ok::<_, Error>(OnsetSlope {
            name,
            slope: found.slope,
            error: found.error,
            tangencies,
            tangencies_error,
        })
    };
    Ok(vec![
        one("right", Branch::Positive, |p| p.right)?,
        one("left", Branch::Negative, |p| p.left)?,
    ])
}

/// From how small an eps the branches are followed, and where they are shown.
pub(in super::super) const FULL: &[f64] =
    &[0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0];
pub(in super::super) const QUICK: &[f64] = &[0.005, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0];

/// Orbits followed round the loop for the first tangency.
const ORBITS: u32 = 24;

/// Follows the tangencies of both loops.
pub(in super::super) fn read(
    reader: &mut Reader<'_>,
    section: &mut Section,
) -> Result<bool, Error> {
    let balls = reader.balls;
    let threshold = section_three().signed_threshold(balls).ok_or(Error::NoValue)?;
    let threshold = threshold.midpoint().to_f64().abs();
    let values = if reader.options.quick { QUICK } else { FULL };
    let mut points: Vec<OnsetPoint> =
        values.iter().map(|eps| OnsetPoint { eps: *eps, right: None, left: None }).collect();
    if !follow(reader, threshold, &mut points)? {
        return Ok(false);
    }
    let onset = Onset { threshold, slopes: slopes(&points)?, points, status: ESTIMATED };
    section.rows.push(agreement(&onset)?);
    section.tables.push(onset.table());
    reader.trust.onset = Some(onset);
    Ok(true)
}

/// Follows both loops at a time; the points beyond the end of a branch stay empty.
fn follow(
    reader: &mut Reader<'_>,
    threshold: f64,
    points: &mut [OnsetPoint],
) -> Result<bool, Error> {
    let values: Vec<f64> = points.iter().map(|point| point.eps).collect();
    let stopped = AtomicBool::new(false);
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        let branches = [Loop::Right, Loop::Left].map(|side| {
            let (sender, stopped, values) = (sender.clone(), &stopped, &values);
            scope.spawn(move || {
                let goes_on = || !stopped.load(Ordering::Relaxed);
                branch(side, threshold, values, &goes_on, &mut |eps, tangency| {
                    let sent = sender.send((side, eps, tangency.value, tangency.error)).is_ok();
                    sent && goes_on()
                })
            })
        });
        drop(sender);
        for (side, eps, value, error) in receiver {
            if let Some(point) = points.iter_mut().find(|point| point.eps == eps) {
                let found = Some((value, error));
                if side == Loop::Right { point.right = found } else { point.left = found }
            }
            let name = if side == Loop::Right { "right" } else { "left" };
            if !reader.goes_on(&format!("tangency of the {name} loop, eps = {eps}")) {
                stopped.store(true, Ordering::Relaxed);
            }
        }
        for branch in branches {
            match branch.join() {
                Ok(
                    Ok(())
                    | Err(Error::Simulate(SimulateError::NoTangency { .. } | SimulateError::Stopped)),
                ) => {}
                Ok(Err(error)) => return Err(error),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(!stopped.load(Ordering::Relaxed))
    })
}

/// Follows the first tangency of one loop from the first value of eps on.
fn branch(
    side: Loop,
    threshold: f64,
    values: &[f64],
    goes_on: &dyn Fn() -> bool,
    observer: &mut dyn FnMut(f64, &Tangency) -> bool,
) -> Result<(), Error> {
    let Some(&first) = values.first() else { return Ok(()) };
    let (model, mut parameters) = (model()?, parameters()?);
    parameters.set("eps", Quantity::Float(rug::Float::with_val(53, first)));
    let homoclinic = Homoclinic {
        model: &model,
        parameters: &parameters,
        name: "gamma",
        period: PI,
        side,
        // Near the saddle x'' = x + eps (gamma cos 2t + ...): some tenths of eps on the left.
        guess: [-0.35 * first, 0.0],
    };
    // Close to Melnikov's value for so small an eps.
    let bracket = (0.97 * threshold, 1.02 * threshold);
    let tick = || if goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    let start = homoclinic.first_tangency(bracket, ORBITS, &tick)?;
    let start = (start.value, start.phase);
    continue_tangency(&homoclinic, ("eps", values), start, &tick, &mut |eps, tangency| {
        if observer(eps, tangency) { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    Ok(())
}

/// Three decimals, cut off: what holds up to eps holds up to the number shown, too.
fn cut_off(eps: f64) -> String {
    format!("{:.3}", (1e3 * eps).floor() / 1e3)
}

impl Onset {
    /// The eps up to which both loops keep within this share of the threshold, linear between the
    /// points computed; nothing when all of them do.
    #[must_use]
    pub fn reach(&self, share: f64) -> Option<f64> {
        self.reach_with(share, [0.0; 2])
    }

    /// The same of the threshold with a slope for each loop.
    fn reach_with(&self, share: f64, slopes: [f64; 2]) -> Option<f64> {
        let mut before = (0.0, 0.0);
        for point in &self.points {
            let now = (point.eps, point.deviation(self.threshold, slopes));
            if now.1 > share {
                let part = (share - before.1) / (now.1 - before.1);
                return Some(before.0 + part * (now.0 - before.0));
            }
            before = now;
        }
        None
    }

    /// Mean of the two loops at the smallest eps.
    fn limit(&self) -> Option<(f64, f64)> {
        let first = self.points.first()?;
        Some((first.eps, (first.right?.0 + first.left?.0) / 2.0))
    }

    pub(super) fn finding(&self) -> Finding {
        let reach_with = |share: f64, slopes: [f64; 2]| {
            let eps = self.reach_with(share, slopes);
            let eps = eps.map_or("every $eps$ computed".to_owned(), |eps| {
                format!("$eps = {}$", cut_off(eps))
            });
            format!("to {:.0} % up to {eps}", 100.0 * share)
        };
        let reach = |share: f64| reach_with(share, [0.0; 2]);
        let limit = self.limit().map_or_else(String::new, |(eps, mean)| {
            format!(
                "as $eps$ goes to 0: at $eps = {eps}$ the mean of the two loops is {mean:.7}, the \
                     threshold {:.7}",
                self.threshold
            )
        });
        let ratio = |x: f64| format!("{x:.5} ({:+.1} %)", 100.0 * (x / self.threshold - 1.0));
        let last = self.points.iter().rev().find_map(|p| Some((p.eps, p.right?.0, p.left?.0)));
        let end = last.map_or_else(String::new, |(eps, right, left)| {
            format!(
                "at the $eps = {eps}$ at which the paper's observations are found the tangencies that are the \
                 first ones at small $eps$ lie at {} for the right loop and {} for the left one, where others \
                 have come before it",
                ratio(right),
                ratio(left)
            )
        });
        Finding {
            section: 3,
            method: "Melnikov's threshold with dry friction, (27) corrected".into(),
            trusted: texts([
                limit,
                format!(
                    "at the paper's parameters the first tangency of both loops is the threshold \
                     {}, {} and {}: first order in $eps$, of opposite sign on the two loops",
                    reach(0.01),
                    reach(0.05),
                    reach(0.1)
                ),
                self.second_order(&reach_with),
            ]),
            not_trusted: texts([
                end,
                "chaos seen near 0.65 at $eps = 1$ comes from period doubling of an orbit inside one \
                 well; the agreement of the numbers is a coincidence"
                    .to_owned(),
                "at $v* = 0$ and $|v*| = a/sqrt(2b)$, where the loop touches the switching line"
                    .to_owned(),
            ]),
            class: "estimated: tangencies by following the unstable manifold, event by event, in \
                    doubles; the $eps$ of a deviation by linear interpolation between the points".into(),
        }
    }

    /// The slopes, and what they are good for.
    fn second_order(&self, reach: &dyn Fn(f64, [f64; 2]) -> String) -> String {
        let [right, left] = self.slopes.as_slice() else { return String::new() };
        let both = [right.slope, left.slope];
        format!(
            "to second order it is ${:.5} {:+.7} eps$ on the right loop, ${:.5} {:+.7} eps$ on the left one, by Melnikov's \
             integral of second order; the tangencies extrapolate to the slopes {:+.5} and {:+.5}; with them it is {} and {}",
            self.threshold,
            right.slope,
            self.threshold,
            left.slope,
            right.tangencies,
            left.tangencies,
            reach(0.01, both),
            reach(0.1, both)
        )
    }

    fn table(&self) -> Table {
        let shown =
            |value: Option<(f64, f64)>| value.map_or("none".to_owned(), |v| format!("{:.7}", v.0));
        let deviation = |value: Option<(f64, f64)>| {
            let change = |v: (f64, f64)| format!("{:+.3}", 100.0 * (v.0 / self.threshold - 1.0));
            value.map_or("-".to_owned(), change)
        };
        let row = |p: &OnsetPoint| {
            vec![
                p.eps.to_string(),
                shown(p.right),
                deviation(p.right),
                shown(p.left),
                deviation(p.left),
            ]
        };
        let columns =
            ["$eps$", "$gamma$, right loop", "deviation %", "$gamma$, left loop", "deviation %"];
        Table {
            name: "tangencies".to_owned(),
            title: "The homoclinic tangency that is the first one at small $eps$, against Melnikov's threshold (estimated)".into(),
            columns: texts(columns),
            rows: self.points.iter().map(row).map(texts).collect(),
            notes: texts([
                format!(
                    "$a = b = 1$, $alpha = beta = T0 = 0.3$, $omega = 2$, $v* = 0.4$; threshold {:.7} for \
                     every $eps$",
                    self.threshold
                ),
                "followed from the smallest $eps$ on, so at larger $eps$ other tangencies may come before it: \
                 on the left loop they do at $eps = 1$"
                    .to_owned(),
            ]),
        }
    }
}

/// What agreement of an onset with the prediction is worth the name.
const GOOD: f64 = 0.1;

/// The row of the conclusion: whether the onset at eps = 1 is the predicted one.
fn agreement(onset: &Onset) -> Result<Row, Error> {
    let last = onset.points.last().ok_or(Error::NoValue)?;
    let shown =
        |side: Option<(f64, f64)>| side.map_or("none".to_owned(), |s| format!("{:.5}", s.0));
    let far =
        |side: Option<(f64, f64)>| side.is_none_or(|s| (s.0 / onset.threshold - 1.0).abs() > GOOD);
    let findings = Findings::holds(!far(last.right) && !far(last.left));
    Ok(Row::new(
        "good agreement",
        "the obtained results illustrate practically a good agreement with the analytical \
                  prediction",
        format!(
            "$gamma_c = {:.5}$; the tangency that is the first one at small $eps$, followed to $eps = {}$: \
             $gamma = {}$ (right loop), {} (left loop) (estimated)",
            onset.threshold,
            last.eps,
            shown(last.right),
            shown(last.left)
        ),
        "unstable manifold of the saddle orbit, followed event by event",
        &findings,
        format!(
            "the orbit that becomes chaotic near 0.65 stays in the right well, whose loop is first \
             tangent at {} (estimated); what is seen near 0.65 is not what (27) predicts",
            shown(last.right)
        ),
    ))
}
