//! What all commands share: format, output, progress, limits, Ctrl-C.

use crate::arguments::{Common, Format, Normalisation, Precision};
use crate::failure::{FILE, Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::terminal::warn;
use crate::{Outcome, output};
use indicatif::{ProgressBar, ProgressStyle};
use lindstedt::unstable::algebra::Stop;
use lindstedt::unstable::equation::Condition;
use lindstedt::unstable::problem_file::{FileError, LARGEST_FILE, canonical_name};
use lindstedt::{
    Answer, Error, Exact, Kind, Oscillator, Progress, Refusal, Remark, Standing, Work,
};
use lindstedt_report::{Format as Written, Present};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
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
                std::process::exit(i32::from(INTERRUPTED));
            }
            warn("stopping after the step in progress; Ctrl-C again to stop at once");
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

    /// The same question for the threads of the engine.
    pub fn stop(&self) -> Stop {
        let interrupts = Arc::clone(&self.interrupts);
        let (start, limit) = (self.start, self.common.limit_seconds);
        Stop::new(move || {
            interrupts.load(Ordering::SeqCst) > 0
                || limit.is_some_and(|limit| start.elapsed().as_secs_f64() > limit)
        })
    }

    /// The means of a question.
    pub fn work(&self) -> Work {
        let bar = self.bar.clone();
        let progress = move |progress: Progress| {
            if let Some(message) = words(&progress) {
                bar.set_message(message);
            }
            bar.tick();
        };
        Work {
            memory: self.memory(),
            stop: self.stop(),
            progress: Some(Arc::new(progress)),
            ..Work::default()
        }
    }

    /// The same with the precision asked for.
    pub fn precise_work(&self, precision: &Precision) -> Result<Work, Failure> {
        let digits = u32::try_from(digits(precision)?).unwrap_or(u32::MAX);
        Ok(Work { digits, doubles: precision.f64, ..self.work() })
    }

    /// The oscillator of an argument, with the values and the normalisation asked for: an equation,
    /// the path of a problem file, or a built-in name.
    pub fn oscillator(
        &self,
        name: &str,
        set: &[String],
        normalisation: Option<Normalisation>,
    ) -> Result<Oscillator, Failure> {
        let oscillator = if name.contains(['\'', '=']) {
            Oscillator::parse(name)?
        } else if name.ends_with(".toml") {
            Oscillator::file(&read(name)?).map_err(|error| at_place(name, error))?.called(name)
        } else {
            Oscillator::builtin(name)?
        };
        let mut oscillator = oscillator;
        for (name, value) in parameters(set)? {
            oscillator = oscillator.with(&name, value);
        }
        let condition = normalisation.map(|normalisation| match normalisation {
            Normalisation::Initial => Condition::InitialAmplitude,
            Normalisation::Fundamental => Condition::FundamentalAmplitude,
            Normalisation::Free => Condition::FreeAmplitude,
        });
        Ok(match condition {
            Some(condition) => oscillator.under(condition)?,
            None => oscillator,
        })
    }

    /// Refuses figures and tables of sweeps that are not there; a figure needs so many.
    pub fn check_sweep(
        &self,
        plots: &[PathBuf],
        sweeps: usize,
        needed: usize,
    ) -> Result<(), Failure> {
        let refused =
            |message: &str, hint: &str| Err(Failure::usage("plot", message.to_owned(), hint));
        match sweeps {
            0 if !plots.is_empty() => {
                refused("--plot needs a --sweep", "for example --sweep NAME=0..1:101")
            }
            n if n < needed && plots.iter().any(|path| output::is(path, "svg")) => {
                refused("a chart needs two sweeps", "or write a .csv table")
            }
            _ => Ok(()),
        }
    }

    /// Fails now rather than after the work if what is asked for cannot be written.
    pub fn check_writable(&self, plots: &[PathBuf]) -> Result<(), Failure> {
        output::check_plots(plots)?;
        plots.iter().try_for_each(|path| output::check_file(path))?;
        self.out().map_or(Ok(()), output::check_file)
    }

    /// Prints an answer in the format asked for, writes its figures and tables, says its remarks.
    pub fn show<T: Serialize>(&self, answer: Result<Answer<T>, Error>, plots: &[PathBuf]) -> Outcome
    where
        Answer<T>: Present,
    {
        self.done();
        let answer = answer.map_err(|error| self.failure(&error))?;
        for path in plots {
            output::write_file(path, &plotted(&answer, path)?)?;
        }
        self.print(&answer)?;
        self.say_remarks(&answer.remarks);
        Ok(match answer.standing {
            Standing::Complete => 0,
            Standing::NoAnswer => NO_ANSWER,
            Standing::Undecided => UNDECIDED,
            Standing::Stopped { .. } => self.stopped(),
        })
    }

    /// Says what is to be said beside an answer.
    pub fn say_remarks(&self, remarks: &[Remark]) {
        remarks.iter().for_each(|remark| warn(&remark.0));
    }

    /// Prints what can be shown in the format asked for.
    pub fn print<A: Serialize + Present>(&self, answer: &A) -> Result<(), Failure> {
        let text = match self.format() {
            Format::Json => lindstedt_report::json(answer).map_err(|error| Failure {
                exit: UNDECIDED,
                code: "undecided",
                message: error.to_string(),
                hint: String::new(),
            })?,
            Format::Text => Written::Text.write(&answer.document()),
            Format::Latex => Written::Latex.write(&answer.document()),
            Format::Markdown => Written::Markdown.write(&answer.document()),
        };
        output::write(self.out(), &text)
    }

    /// The exit code of stopped work.
    fn stopped(&self) -> u8 {
        if self.interrupted() { INTERRUPTED } else { UNDECIDED }
    }

    /// A refusal; of stopped work with what stopped it.
    fn failure(&self, error: &Error) -> Failure {
        let failure = Failure::of(error);
        match error.kind() {
            Kind::Stopped if self.interrupted() => {
                Failure { exit: INTERRUPTED, code: "interrupted", ..failure }
            }
            Kind::Stopped => Failure { exit: UNDECIDED, code: "limit-seconds", ..failure },
            _ => failure,
        }
    }

    /// How many steps there are: from now on the bar shows what part is done.
    pub fn expect_steps(&self, steps: usize) {
        self.bar.set_length(steps as u64);
        let style = "{spinner} [{elapsed}] {bar:24} {pos}/{len} {msg}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            self.bar.set_style(style);
        }
    }

    /// Shows the next of these steps.
    pub fn step(&self, message: String) {
        self.bar.set_message(message);
        self.bar.inc(1);
    }

    /// Clears the progress line before results are printed.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }
}

/// What is being done, in words.
fn words(progress: &Progress) -> Option<String> {
    Some(match progress {
        Progress::Order(order, terms) => format!("order {order} done, {terms} terms"),
        Progress::Primes(primes) => format!("{primes} primes done"),
        Progress::Integrating(done) => format!("{done} values compared"),
        Progress::Checking => "substituting into the equation".to_owned(),
        Progress::Parts(done, all) => format!("{done} of {all} done"),
        Progress::Digits(digits) => format!("{digits} digits"),
        _ => return None,
    })
}

/// The contents of a figure or a table, as the name of the file says.
fn plotted<T>(answer: &Answer<T>, path: &Path) -> Result<String, Failure>
where
    Answer<T>: Present,
{
    let nothing = || Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: "there is nothing to draw".to_owned(),
        hint: String::new(),
    };
    if output::is(path, "csv") {
        return answer.table().map(|table| table.csv()).ok_or_else(nothing);
    }
    let figure = answer.figure().ok_or_else(nothing)?;
    figure.svg().map_err(|error| Failure { message: error.to_string(), ..nothing() })
}

/// The number of digits asked for.
fn digits(precision: &Precision) -> Result<usize, Failure> {
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
fn parameters(list: &[String]) -> Result<BTreeMap<String, Exact>, Failure> {
    let mut parameters = BTreeMap::new();
    for item in list {
        let Some((name, value)) = item.split_once('=') else {
            let message = format!("{item:?} is not NAME=VALUE");
            return Err(Failure::usage("set", message, "for example --set amplitude=1/2"));
        };
        if name.trim() == "branch" && matches!(value.trim(), "+" | "-") {
            let message = "branch has no meaning here: it chooses the root of the impact velocity, and \
                           the free flight is the same on both";
            let hint = "lindstedt stability and lindstedt simulate take it";
            return Err(Failure::usage("set", message.to_owned(), hint));
        }
        if canonical_name(name.trim()) == "pi" {
            let message = "pi is a number: it has no other value".to_owned();
            return Err(Failure::usage("set", message, ""));
        }
        let value = Exact::parse(value)?;
        // Greek letters as in a problem file.
        if parameters.insert(canonical_name(name.trim()), value).is_some() {
            let message = format!("{name} is set twice");
            return Err(Failure::usage("set", message, ""));
        }
    }
    Ok(parameters)
}

/// An error of a problem file with its path, line and column.
fn at_place(path: &str, error: Error) -> Failure {
    let failure = Failure::of(&error);
    let Error::File(FileError { kind, line, column }) = &error else { return failure };
    Failure { message: format!("{}:{line}:{column}: {kind}", shown(path)), ..failure }
}

fn shown(name: &str) -> String {
    name.chars().take(60).collect()
}

/// The text of a file, if it is a file of a reasonable size: devices, pipes and what is too large
/// are refused before anything is read.
fn read(path: &str) -> Result<String, Failure> {
    let failure = |what: String, hint: &str| Failure {
        exit: FILE,
        code: "file",
        message: format!("cannot read {}: {what}", shown(path)),
        hint: hint.into(),
    };
    let trouble = |error: std::io::Error| failure(error.to_string(), "");
    let metadata = std::fs::metadata(path).map_err(trouble)?;
    if !metadata.is_file() {
        return Err(failure("it is not a file".into(), ""));
    }
    let too_large = || failure(format!("it has more than {LARGEST_FILE} bytes"), "");
    if metadata.len() > LARGEST_FILE {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(trouble)?;
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(trouble)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(too_large());
    }
    String::from_utf8(bytes).map_err(|_| failure("it is not UTF-8 text".into(), ""))
}
