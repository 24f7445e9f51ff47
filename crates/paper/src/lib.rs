//! The paper, re-read by machine: what is printed, what the engine derives, what an independent
//! route says, and a verdict that is computed from the three.
//!
//! The paper is J. Awrejcewicz and I. Andrianov's survey of asymptotic approaches to strongly
//! nonlinear and non-smooth systems. Only what it prints is written down here; everything beside
//! it is computed. A further section of the paper adds modules with functions that push [`Row`]s
//! and [`Table`]s, and an entry in `SECTIONS`.

#![warn(clippy::too_many_lines)]

mod compare;
mod lobachevsky;
mod melnikov;
mod numbers;
mod orders;
pub mod page;
mod pendulum;
mod pendulum_numbers;
mod pendulum_results;
mod periods;
mod power_law;
mod printed;
mod reading;
mod simulated;
mod stick_slip;
mod tables;
mod text;
pub mod trust;
mod values;
mod verdict;
mod vibro_impact;

pub use compare::Decimal;
pub use printed::{PrintedForm, printed_forms};
pub use reading::Paper;
pub use text::{Part, Text};
pub use trust::Trust;
pub use values::{Row, Section, Table};
pub use verdict::{Findings, Verdict};
pub use vibro_impact::reread;

use lindstedt::Error;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::digits::decimal;
use std::sync::mpsc::{SyncSender, channel, sync_channel};

/// How far to go.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The order to which the expansions are derived and checked, at least 2.
    pub order: usize,
    /// The order up to which the tables go, at least 6.
    pub table_order: usize,
    /// Gains of each kind for which predictions of stability are compared with the truth.
    pub grid: usize,
    /// Gains of each kind in the charts of the region of stability.
    pub chart: usize,
    /// Periods of the forcing in the simulations: left out, averaged over.
    pub periods: (u32, u32),
    /// Fewer points where a curve is followed.
    pub quick: bool,
}

impl Options {
    /// A minute of work at most.
    pub const FULL: Self = Self {
        order: 10,
        table_order: 20,
        grid: 21,
        chart: 121,
        periods: (2000, 10_000),
        quick: false,
    };
    /// A few seconds.
    pub const QUICK: Self =
        Self { order: 4, table_order: 14, grid: 7, chart: 41, periods: (500, 1000), quick: true };

    /// How often the observer of [`read`] is called when nothing stops it.
    #[must_use]
    pub fn steps(&self) -> usize {
        let parts: usize = SECTIONS.iter().map(|(_, _, parts)| parts.len()).sum();
        let derivations = 2 * self.order.max(2);
        parts + derivations + self.inner_steps()
    }

    /// Steps within parts: orbits, tangencies of two loops, simulations, tables.
    fn inner_steps(&self) -> usize {
        let values = if self.quick { trust::QUICK_STEPS } else { trust::FULL_STEPS };
        vibro_impact::ORBITS_READ + 2 * values + simulated::ORBITS + tables::TABLES
    }
}

/// The precision of every comparison. Two numbers of the size of a period that differ are told
/// apart by some 50 digits, all decimals shown have fewer than 30.
const BITS: u32 = 256;

/// What the parts of a section share.
struct Reader<'a> {
    options: Options,
    balls: Balls,
    observer: &'a mut dyn FnMut(&str) -> bool,
    trust: Trust,
    /// Counted in section 2, before the charts.
    sample: Option<trust::Sample>,
    /// Computed for the tables of section 4, before the errors by order.
    tabled: Vec<tables::Tabled>,
}

impl Reader<'_> {
    /// Says what comes next; false when the work must stop.
    fn goes_on(&mut self, what: &str) -> bool {
        (self.observer)(what)
    }
}

/// Reads the paper (sections 2 to 4): derives, compares, tabulates.
///
/// The sections are read side by side, one thread each. `observer` is told, on the calling thread, what
/// comes next; when it returns `false` the work stops with the rows finished so far.
///
/// # Errors
/// [`Error`] when the engine cannot derive what the paper claims, or cannot reach the digits.
///
/// # Example
/// ```
/// use lindstedt_paper::{Options, Verdict, read};
/// let paper = read(Options::QUICK, &mut |_| true)?;
/// let section = paper.section(4).ok_or("no such section")?;
/// let row = section.row("(42)").ok_or("no such row")?;
/// assert_eq!(row.verdict, Verdict::Wrong);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(options: Options, observer: &mut dyn FnMut(&str) -> bool) -> Result<Paper, Error> {
    let mut goes_on = true;
    let parts = std::thread::scope(|scope| {
        let (sender, receiver) = channel::<(String, SyncSender<bool>)>();
        let workers: Vec<_> = (SECTIONS.iter())
            .map(|entry| {
                let sender = sender.clone();
                scope.spawn(move || {
                    // The observer belongs to the thread that called: it is asked, and waited for.
                    let mut ask = |what: &str| {
                        let (answer, answered) = sync_channel(1);
                        let asked = sender.send((what.to_owned(), answer));
                        asked.is_ok() && answered.recv().unwrap_or(false)
                    };
                    read_section(options, entry, &mut ask)
                })
            })
            .collect();
        drop(sender);
        for (what, answer) in receiver {
            goes_on = goes_on && observer(&what);
            // An error means that nobody waits any more.
            let _ = answer.send(goes_on);
        }
        let join = |worker: std::thread::ScopedJoinHandle<'_, _>| match worker.join() {
            Ok(section) => section,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        workers.into_iter().map(join).collect::<Result<Vec<_>, Error>>()
    })?;
    let (schema, trust) = (lindstedt::SCHEMA, Trust::default());
    let mut paper = Paper { schema, trust, sections: Vec::new(), complete: true };
    for (section, trust, complete) in parts {
        paper.trust.add(trust);
        paper.complete &= complete;
        if !section.rows.is_empty() {
            paper.sections.push(section);
        }
    }
    paper.trust.conclude();
    Ok(paper)
}

/// One section, what it says about trust, and whether it is complete.
fn read_section(
    options: Options,
    (number, title, parts): &Entry,
    observer: &mut dyn FnMut(&str) -> bool,
) -> Result<(Section, Trust, bool), Error> {
    let balls = Balls::new(BITS);
    let trust = Trust::default();
    let mut reader = Reader { options, balls, observer, trust, sample: None, tabled: Vec::new() };
    let mut section = Section { number: *number, title, rows: Vec::new(), tables: Vec::new() };
    for (what, part) in *parts {
        if !reader.goes_on(what) || !part(&mut reader, &mut section)? {
            return Ok((section, reader.trust, false));
        }
    }
    Ok((section, reader.trust, true))
}

/// What is read: number and title of a section, and its parts with their names.
const SECTIONS: &[Entry] = &[
    (
        2,
        "Stability improvement of periodic vibro-impact processes",
        &[
            ("the vibro-impact oscillator, (1)-(4)", vibro_impact::read_equation),
            ("averaging, (5)-(7)", vibro_impact::read_averaging),
            ("the periodic orbit, (8)", vibro_impact::read_orbit),
            ("the impact map, (9)-(16)", vibro_impact::read_perturbation),
            ("stability, (17)", vibro_impact::read_stability),
            ("the region of stability", trust::read_region),
        ],
    ),
    (
        3,
        "Prediction of stick-slip chaos",
        &[
            ("the stick-slip oscillator, (18)-(21)", stick_slip::read_equation),
            ("Melnikov's function, (22)-(27)", melnikov::read_formulas),
            ("its numbers", melnikov::read_numbers),
            ("the thresholds", stick_slip::read_table),
            ("the simulations", simulated::read),
            ("the onset against Melnikov's threshold", trust::read_onset),
        ],
    ),
    (
        4,
        "Strongly nonlinear systems",
        &[
            ("the power law, (28)-(42)", power_law::read),
            ("its numbers", numbers::read),
            ("the pendulum, (43)-(51)", pendulum::read),
            ("the tables", tables::read),
            ("the errors by order", trust::read_truncation),
        ],
    ),
];

/// A part of a section: adds to it; false when it was stopped.
type Step = fn(&mut Reader<'_>, &mut Section) -> Result<bool, Error>;

/// A part with what the observer is told.
type NamedPart = (&'static str, Step);

/// Number, title and parts of a section.
type Entry = (u32, &'static str, &'static [NamedPart]);

/// A row whose statement holds or does not.
fn plain(
    label: &str,
    printed: &str,
    derived: impl Into<Text>,
    independent: impl Into<Text>,
    holds: bool,
    evidence: &str,
) -> Row {
    Row::new(label, printed, derived, independent, &Findings::holds(holds), evidence)
}

/// A number with so many certified digits, if it has them.
fn show(ball: &Ball, digits: usize) -> String {
    decimal(ball, digits).unwrap_or_else(|| "?".to_owned())
}
