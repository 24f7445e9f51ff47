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
mod oscillator;
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

/// What the tests of single rules reach: no part of the interface.
#[doc(hidden)]
pub mod rules {
    pub use crate::page::{latex, numbers, numeric};
    pub use crate::vibro_impact::{completions, parse};
}

pub use compare::Decimal;
pub use oscillator::section_three;
pub use printed::{PrintedForm, printed_forms};
pub use reading::Paper;
pub use text::{Part, Text};
pub use trust::Trust;
pub use values::{Row, Section, Table};
pub use verdict::{Findings, Verdict};
pub use vibro_impact::reread;

use lindstedt::{Error, Stop};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::digits::decimal;
use std::sync::mpsc::{RecvTimeoutError, SyncSender, channel, sync_channel};
use std::time::Duration;

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
/// comes next; when it returns `false`, or when `stop` says so, the work stops with the rows finished so far.
/// `stop` is not waited for: after a tenth of a second a step in progress is left to its thread, which ends with it.
///
/// # Errors
/// [`Error`] when the engine cannot derive what the paper claims, or cannot reach the digits.
///
/// # Example
/// ```no_run
/// use lindstedt::Stop;
/// use lindstedt_paper::{Options, Verdict, read};
/// let paper = read(Options::QUICK, &Stop::default(), &mut |_| true)?;
/// let section = paper.section(4).ok_or("no such section")?;
/// let row = section.row("(42)").ok_or("no such row")?;
/// assert_eq!(row.verdict, Verdict::Wrong);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(
    options: Options,
    stop: &Stop,
    observer: &mut dyn FnMut(&str) -> bool,
) -> Result<Paper, Error> {
    let (sender, receiver) = channel();
    let workers: Vec<_> = (SECTIONS.iter().enumerate())
        .map(|(place, entry)| {
            let sender = sender.clone();
            std::thread::spawn(move || {
                let told =
                    read_section(options, entry, &|event| sender.send((place, event)).is_ok());
                // An error means that nobody waits any more.
                let _ = sender.send((place, Event::Ended(Box::new(told))));
            })
        })
        .collect();
    drop(sender);
    let mut parts: Vec<Option<Read>> = SECTIONS.iter().map(|_| None).collect();
    let (mut goes_on, mut left) = (true, PATIENCE);
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok((_, Event::Next(what, answer))) => {
                goes_on = goes_on && !stop.asked() && observer(&what);
                let _ = answer.send(goes_on);
            }
            Ok((place, Event::Finished(read))) => parts[place] = Some(*read),
            Ok((place, Event::Ended(read))) => parts[place] = Some((*read)?),
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) if stop.asked() => match left.checked_sub(LOOK) {
                Some(less) => left = less,
                None => break,
            },
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
    for worker in workers.into_iter().filter(std::thread::JoinHandle::is_finished) {
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    }
    let (schema, trust) = (lindstedt::SCHEMA, Trust::default());
    let complete = parts.iter().all(|part| part.as_ref().is_some_and(|part| part.2));
    let mut paper = Paper { schema, trust, sections: Vec::new(), complete };
    for (section, trust, _) in parts.into_iter().flatten() {
        paper.trust.add(trust);
        if !section.rows.is_empty() {
            paper.sections.push(section);
        }
    }
    paper.trust.conclude();
    Ok(paper)
}

/// How long a step in progress is waited for when the work is to stop.
const PATIENCE: Duration = Duration::from_millis(100);

/// How often the caller's question is asked while nothing is said.
const LOOK: Duration = Duration::from_millis(10);

/// A section, what it says about trust, and whether it is complete.
type Read = (Section, Trust, bool);

/// What the thread of a section says.
enum Event {
    /// What comes next, and where the answer is awaited, whether to go on.
    Next(String, SyncSender<bool>),
    /// A part is finished: all so far.
    Finished(Box<Read>),
    /// The section is at its end.
    Ended(Box<Result<Read, Error>>),
}

/// One section; `tell` takes what is said to the one that called, and says whether it still listens.
fn read_section(
    options: Options,
    (number, title, parts): &Entry,
    tell: &dyn Fn(Event) -> bool,
) -> Result<Read, Error> {
    // The observer belongs to the thread that called: it is asked, and waited for.
    let mut observer = |what: &str| {
        let (answer, answered) = sync_channel(1);
        tell(Event::Next(what.to_owned(), answer)) && answered.recv().unwrap_or(false)
    };
    let (balls, trust) = (Balls::new(BITS), Trust::default());
    let observer = &mut observer;
    let mut reader = Reader { options, balls, observer, trust, sample: None, tabled: Vec::new() };
    let mut section = Section { number: *number, title, rows: Vec::new(), tables: Vec::new() };
    for (what, part) in *parts {
        if !reader.goes_on(what) || !part(&mut reader, &mut section)? {
            return Ok((section, reader.trust, false));
        }
        let so_far = Event::Finished(Box::new((section.clone(), reader.trust.clone(), false)));
        if !tell(so_far) {
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
