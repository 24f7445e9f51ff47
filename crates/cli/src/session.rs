//! What all commands share: format, output, progress, limits, Ctrl-C.

use crate::arguments::{Common, Format, Precision};
use crate::failure::{Failure, NO_ANSWER, UNDECIDED};
use indicatif::{ProgressBar, ProgressStyle};
use lindstedt::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// No result is printed with more digits than this: the contract of exact evaluation.
const MOST_DIGITS: u64 = 10_000;

/// One run of the program.
pub struct Session<'a> {
    common: &'a Common,
    start: Instant,
    interrupts: Arc<AtomicU32>,
    bar: ProgressBar,
}

impl<'a> Session<'a> {
    /// Starts the clock and catches Ctrl-C: the first asks the work to stop at the next order,
    /// the second ends the program.
    pub fn start(common: &'a Common) -> Self {
        let interrupts = Arc::new(AtomicU32::new(0));
        let counter = Arc::clone(&interrupts);
        let _ = ctrlc::set_handler(move || {
            if counter.fetch_add(1, Ordering::SeqCst) > 0 {
                std::process::exit(i32::from(crate::failure::INTERRUPTED));
            }
            crate::output::warn(
                "stopping after the step in progress; Ctrl-C again to stop at once",
            );
        });
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} [{elapsed}] {msg}") {
            bar.set_style(style);
        }
        Self { common, start: Instant::now(), interrupts, bar }
    }

    pub fn format(&self) -> Format {
        self.common.format
    }

    pub fn out(&self) -> Option<&Path> {
        self.common.out.as_deref()
    }

    pub fn memory(&self) -> u64 {
        self.common.limit_memory
    }

    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    pub fn interrupted(&self) -> bool {
        self.interrupts.load(Ordering::SeqCst) > 0
    }

    pub fn out_of_time(&self) -> bool {
        self.common.limit_seconds.is_some_and(|limit| self.elapsed().as_secs_f64() > limit)
    }

    /// Whether the work should go on.
    pub fn goes_on(&self) -> bool {
        !self.interrupted() && !self.out_of_time()
    }

    /// Shows what is being done.
    pub fn say(&self, message: String) {
        self.bar.set_message(message);
        self.bar.tick();
    }

    /// Clears the progress line before results are printed.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }
}

/// The number of digits asked for.
pub fn digits(precision: &Precision) -> Result<usize, Failure> {
    if precision.f64 {
        return Ok(17);
    }
    match precision.digits {
        0 => Err(Failure::usage("digits", "at least one digit is needed".into(), "--digits 30")),
        d if d > MOST_DIGITS => Err(Failure {
            exit: UNDECIDED,
            code: "digits",
            message: format!("{d} digits are more than the limit of {MOST_DIGITS}"),
            hint: "ask for fewer digits".into(),
        }),
        d => usize::try_from(d)
            .map_err(|_| Failure::usage("digits", "too many digits".into(), "--digits 30")),
    }
}

/// Reads the `--set NAME=VALUE` arguments.
pub fn parameters(list: &[String]) -> Result<BTreeMap<String, Value>, Failure> {
    let mut parameters = BTreeMap::new();
    for item in list {
        let Some((name, value)) = item.split_once('=') else {
            let message = format!("{item:?} is not NAME=VALUE");
            return Err(Failure::usage("set", message, "for example --set amplitude=1/2"));
        };
        let value = Value::parse(value)?;
        if parameters.insert(name.trim().to_owned(), value).is_some() {
            let message = format!("{name} is set twice");
            return Err(Failure::usage("set", message, ""));
        }
    }
    Ok(parameters)
}

/// The built-in problem of that name.
pub fn problem(name: &str) -> Result<lindstedt::equation::Problem, Failure> {
    lindstedt::problems::find(name).ok_or_else(|| {
        if name == lindstedt::problems::stick_slip::card().name {
            return Failure {
                exit: NO_ANSWER,
                code: "no-expansion",
                message: "stick-slip has no expansion by Lindstedt and Poincare".into(),
                hint: "Melnikov's method takes it: lindstedt threshold stick-slip".into(),
            };
        }
        let names: Vec<_> = lindstedt::problems::all().into_iter().map(|p| p.name).collect();
        let shown: String = name.chars().take(60).collect();
        let message = format!("there is no problem {shown:?}");
        Failure::usage("unknown-problem", message, &format!("known: {}", names.join(", ")))
    })
}
