//! What all commands share: format, output, progress, what ends them.

use crate::arguments::{Common, Format, Precision};
use crate::failure::{Failure, NO_ANSWER, STOPPED, UNDECIDED};
use crate::terminal::warn;
use crate::watch::{Limits, Watch};
use crate::{Outcome, output};
use indicatif::{ProgressBar, ProgressStyle};
use lindstedt::unstable::equation::Condition;
use lindstedt::unstable::problem_file::{FileError, LARGEST_FILE, canonical_name};
use lindstedt::{Answer, Error, Oscillator, Progress, Refused, Remark, Standing, Work};
use lindstedt_report::{FigureError, Format as Written, Present};
use serde::Serialize;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// No result is printed with more digits than this: the contract of exact evaluation.
const MOST_DIGITS: u64 = 10_000;
/// So many lines of a table are written between two looks at the clock.
const LINES: u64 = 1 << 10;
/// So many numbers show how long it takes to write them as JSON; of many each takes longer by such a factor.
const SAMPLE: u32 = 1 << 14;
const SLOWER: f64 = 2.5;
/// What takes some hundredths of a second at most is written, whatever the time is.
const FEW: usize = 1 << 16;

/// One run of the program.
pub struct Session<'a> {
    common: &'a Common,
    limits: Limits,
    /// The clock, the signals and the memory.
    pub watch: Watch,
    bar: ProgressBar,
}

impl<'a> Session<'a> {
    /// Starts the clock and catches Ctrl-C: the first asks the work to stop at the next order,
    /// the second ends the program.
    pub fn start(common: &'a Common) -> Self {
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} [{elapsed}] {msg}") {
            bar.set_style(style);
        }
        if let Some(threads) = common.threads {
            // Nothing has used the pool before, so this is the first and the only time that it is made.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads));
            if let Err(error) = pool.build_global() {
                warn(&format!("--threads {threads}: {error}"));
            }
        }
        let limits = Limits::new(common.limit_seconds, common.limit_memory);
        let watch = Watch::start(limits, common.format, bar.clone());
        Self { common, limits, watch, bar }
    }

    pub fn format(&self) -> Format {
        self.common.format
    }

    pub fn out(&self) -> Option<&Path> {
        self.common.out.as_deref()
    }

    /// The means of a question.
    pub fn work(&self) -> Work {
        let (bar, watch) = (self.bar.clone(), self.watch.clone());
        let progress = move |progress: Progress| {
            if matches!(progress, Progress::Reading) {
                watch.showing();
            }
            bar.set_message(progress.words());
            bar.tick();
        };
        Work {
            memory: self.limits.memory(),
            stop: self.watch.stop(),
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
        condition: Option<Condition>,
    ) -> Result<Oscillator, Failure> {
        let mut oscillator = if is_equation(name) {
            Oscillator::parse(name)?
        } else if is_file(name) {
            Oscillator::file(&read(name)?).map_err(|error| at_place(name, error))?.called(name)
        } else {
            Oscillator::builtin(name)?
        };
        for item in set {
            oscillator = with_value(oscillator, item)?;
        }
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

    /// Fails now rather than after the work if what is asked for cannot be written, or would be written
    /// over what is read or written beside it.
    pub fn check_writable(
        &self,
        problem: &str,
        plots: &[PathBuf],
        journal: Option<&Path>,
    ) -> Result<(), Failure> {
        output::check_plots(plots)?;
        let plotted = plots.iter().map(|path| ("--plot", path.as_path()));
        let out = self.out().map(|path| ("--out", path));
        let journal = journal.map(|path| ("--resume", path));
        let written: Vec<_> = out.into_iter().chain(journal).chain(plotted).collect();
        let read = is_file(problem).then(|| ("the problem file", Path::new(problem)));
        output::check_distinct(&written, read)?;
        written.iter().try_for_each(|(_, path)| output::check_file(path))
    }

    /// Prints an answer in the format asked for, writes its figures and tables, says its remarks.
    pub fn show<T: Serialize>(&self, answer: Result<Answer<T>, Error>, plots: &[PathBuf]) -> Outcome
    where
        Answer<T>: Present,
    {
        self.done();
        let mut answer = answer?;
        if self.format() == Format::Json {
            answer.shorten(self.points_in_time());
        }
        let text = self.written(&answer)?;
        let (tables, figures): (Vec<&PathBuf>, Vec<_>) =
            plots.iter().partition(|path| output::is(path, "csv"));
        let drawn = if figures.is_empty() { Ok(None) } else { drawn(&answer) };
        // What was found is printed, whatever becomes of its figures.
        self.watch.writing();
        let tables = tables.into_iter().map(|path| self.write_table(&answer, path));
        let files = drawn.and_then(|text| {
            let write = |path: &PathBuf| match &text {
                Some(text) => output::write_file(path, text).map(|()| 0),
                None => Ok(nothing(path)),
            };
            let codes = figures.into_iter().map(write).chain(tables);
            codes.reduce(|before, code| Ok(before?.max(code?))).unwrap_or(Ok(0))
        });
        output::write(self.out(), &text)?;
        self.say_remarks(&answer.remarks);
        let undrawn = files?;
        Ok(match (answer.standing, self.watch.reason()) {
            (Standing::Complete, _) => undrawn,
            (Standing::NoAnswer, _) => NO_ANSWER,
            (Standing::Stopped { .. }, Some(why)) => {
                warn(&format!("{}: not everything is finished", why.words));
                why.exit
            }
            (Standing::Undecided | Standing::Stopped { .. }, _) => UNDECIDED,
        })
    }

    /// As many numbers as there is time to write as JSON, by what a few of them take.
    fn points_in_time(&self) -> usize {
        let Some(left) = self.watch.left() else { return usize::MAX };
        let (begin, sample) =
            (Instant::now(), Vec::from_iter((1..=SAMPLE).map(|n| 1.0 / f64::from(n))));
        let _ = lindstedt_report::json(&sample);
        let each = SLOWER * begin.elapsed().as_secs_f64() / f64::from(SAMPLE);
        ((left / each) as usize).max(FEW)
    }

    /// Writes the table of an answer, as many of its rows as there is time for.
    fn write_table<T>(&self, answer: &Answer<T>, path: &Path) -> Outcome
    where
        Answer<T>: Present,
    {
        let (mut lines, mut whole) = (0u64, true);
        let written = output::write_with(path, |to| {
            let mut written = Ok(());
            let taken = answer.csv(&mut |line| {
                written = to.write_all(line.as_bytes());
                lines += 1;
                written.is_ok()
                    && (lines % LINES != 0 || self.watch.left().is_none_or(|left| left > 0.0))
            });
            whole = taken != Some(false);
            written.map(|()| taken.is_some())
        })?;
        if whole {
            return Ok(if written { 0 } else { nothing(path) });
        }
        let rows = lines - 1;
        let path = path.display();
        warn(&format!("{path} has the first {rows} rows: the time limit was reached"));
        Ok(UNDECIDED)
    }

    /// Says what is to be said beside an answer.
    pub fn say_remarks(&self, remarks: &[Remark]) {
        remarks.iter().for_each(|remark| warn(&remark.0));
    }

    /// Prints what can be shown in the format asked for.
    pub fn print<A: Serialize + Present>(&self, answer: &A) -> Result<(), Failure> {
        let text = self.written(answer)?;
        self.watch.writing();
        output::write(self.out(), &text)
    }

    fn written<A: Serialize + Present>(&self, answer: &A) -> Result<String, Failure> {
        Ok(match self.format() {
            Format::Json => lindstedt_report::json(answer)
                .map_err(|error| Refused::undecided("undecided", error.to_string(), ""))?,
            Format::Text => Written::Text.write(&answer.plain_document()),
            Format::Latex => Written::Latex.write(&answer.document()),
            Format::Markdown => Written::Markdown.write(&answer.document()),
        })
    }

    /// A failure of this run: of stopped work with what stopped it.
    pub fn failed(&self, mut failure: Failure) -> Failure {
        self.done();
        if let Some(why) = self.watch.reason().filter(|_| failure.exit == STOPPED) {
            let refused = &mut failure.refused;
            refused.message = format!("{}: {}", why.words, refused.message);
            refused.code = why.code;
            if let Some(hint) = why.hint {
                refused.hint = hint.to_owned();
            }
            failure.exit = why.exit;
        }
        failure
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
        self.watch.showing();
        self.bar.finish_and_clear();
    }
}

/// Says that a file is not written; the exit code.
fn nothing(path: &Path) -> u8 {
    warn(&format!("there is nothing to draw: {} is not written", path.display()));
    NO_ANSWER
}

/// The figure; nothing where there is nothing to draw.
fn drawn<T>(answer: &Answer<T>) -> Result<Option<String>, Failure>
where
    Answer<T>: Present,
{
    match answer.figure().map(|figure| figure.svg()) {
        None => Ok(None),
        // What there would be to draw was not reached.
        Some(Err(FigureError::Empty)) if matches!(answer.standing, Standing::Stopped { .. }) => {
            Ok(None)
        }
        Some(figure) => figure.map(Some).map_err(Failure::figure),
    }
}

/// Whether a problem is named by its file.
fn is_file(problem: &str) -> bool {
    problem.ends_with(".toml") && !is_equation(problem)
}

fn is_equation(problem: &str) -> bool {
    problem.contains(['\'', '='])
}

/// The number of digits asked for.
fn digits(precision: &Precision) -> Result<usize, Failure> {
    if precision.f64 {
        return Ok(17);
    }
    match precision.digits {
        0 => Err(Failure::usage("digits", "at least one digit is needed".into(), "--digits 30")),
        d if d > MOST_DIGITS => {
            let message = format!("{d} digits are more than the limit of {MOST_DIGITS}");
            Err(Refused::undecided("digits", message, "ask for fewer digits").into())
        }
        d => usize::try_from(d)
            .map_err(|_| Failure::usage("digits", "too many digits".into(), "--digits 30")),
    }
}

/// The oscillator with the value of a `--set NAME=VALUE`.
fn with_value(oscillator: Oscillator, item: &str) -> Result<Oscillator, Failure> {
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
    // Greek letters as in a problem file.
    if oscillator.given().contains_key(&canonical_name(name.trim())) {
        return Err(Failure::usage("set", format!("{name} is set twice"), ""));
    }
    Ok(oscillator.set(name, value)?)
}

/// An error of a problem file with its path, line and column.
fn at_place(path: &str, error: Error) -> Failure {
    let mut failure = Failure::of(&error);
    if let Error::File(FileError { kind, line, column }) = &error {
        failure.refused.message = format!("{}:{line}:{column}: {kind}", shown(path));
    }
    failure
}

/// A path, whole: paths are as long as file systems allow, far more is an argument that is none.
fn shown(name: &str) -> String {
    name.chars().take(4096).collect()
}

/// The text of a file, if it is a file of a reasonable size: devices, pipes and what is too large
/// are refused before anything is read.
fn read(path: &str) -> Result<String, Failure> {
    let failure = |what| Failure::file(format!("cannot read {}: {what}", shown(path)), "");
    let trouble = |error: std::io::Error| failure(error.to_string());
    let metadata = std::fs::metadata(path).map_err(trouble)?;
    if !metadata.is_file() {
        return Err(failure("it is not a file".into()));
    }
    let too_large = || failure(format!("it has more than {LARGEST_FILE} bytes"));
    if metadata.len() > LARGEST_FILE {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(trouble)?;
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(trouble)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(too_large());
    }
    String::from_utf8(bytes).map_err(|_| failure("it is not UTF-8 text".into()))
}
