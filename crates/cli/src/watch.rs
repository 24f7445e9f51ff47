//! What ends work before it is done: a signal, the time limit, the memory limit. One thread looks at
//! all of them; the work asks a flag, and the flag decides the exit code.

use crate::arguments::Format;
use crate::failure::{Failure, UNDECIDED};
use crate::terminal::warn;
use indicatif::ProgressBar;
use lindstedt::Refused;
use lindstedt::unstable::algebra::Stop;
use signal_hook::consts::signal as signals;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// How often the thread looks.
const PERIOD: Duration = Duration::from_millis(4);

/// Why work was stopped.
#[derive(Debug)]
pub struct Reason {
    /// The exit code.
    pub exit: u8,
    /// A short name for programs.
    pub code: &'static str,
    /// In words.
    pub words: &'static str,
    /// What to do about it; nothing where the work knows better.
    pub hint: Option<&'static str>,
    /// The signal that says so.
    signal: Option<i32>,
}

const TIME: usize = 0;
const MEMORY: usize = 1;

/// The reasons there are. A signal ends with 128 and its number, as in a shell.
const REASONS: &[Reason] = &[
    Reason {
        exit: UNDECIDED,
        code: "limit-seconds",
        words: "the time limit was reached",
        hint: None,
        signal: None,
    },
    Reason {
        exit: UNDECIDED,
        code: "limit-memory",
        words: "the memory limit was reached",
        hint: Some("raise --limit-memory, or ask for less"),
        signal: None,
    },
    Reason {
        exit: 130,
        code: "interrupted",
        words: "interrupted",
        hint: Some("the same command begins anew"),
        signal: Some(signals::SIGINT),
    },
    Reason {
        exit: 143,
        code: "terminated",
        words: "terminated",
        hint: Some("the same command begins anew"),
        signal: Some(signals::SIGTERM),
    },
    #[cfg(unix)]
    Reason {
        exit: 129,
        code: "hung-up",
        words: "the terminal hung up",
        hint: Some("the same command begins anew; under nohup it goes on"),
        signal: Some(signals::SIGHUP),
    },
];

/// How far the program is.
#[derive(Clone, Copy)]
enum Phase {
    /// Something is computed.
    Working,
    /// What was found is put into words.
    Showing,
    /// Files are written.
    Writing,
}

/// The program itself takes about so much: no smaller limit is counted.
const LEAST_MEMORY: u64 = 16 << 20;

/// What may be used.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Seconds since the start.
    seconds: Option<f64>,
    /// Bytes of memory.
    memory: u64,
    /// Bytes of address space that the process may have.
    space: Option<u64>,
}

impl Limits {
    /// The limits asked for, and the smaller one that the process was started under (`ulimit -v`): GMP
    /// aborts where memory ends, so the work ends before.
    pub fn new(seconds: Option<f64>, memory: u64) -> Self {
        #[cfg(unix)]
        let space = rustix::process::getrlimit(rustix::process::Resource::As).current;
        #[cfg(not(unix))]
        let space: Option<u64> = None;
        let room = space.map_or(u64::MAX, |space| space.saturating_sub(used().1));
        Self { seconds, memory: memory.min(room), space }
    }

    /// Bytes that the work may be predicted to take.
    pub fn memory(&self) -> u64 {
        self.memory
    }

    /// Whether the memory is used up: `beyond` the limit by so many hundredths, or the address space but for an
    /// eighth, of which `beyond` may use up half.
    fn full(&self, beyond: u64) -> bool {
        let (resident, space) = used();
        let limit = self.memory.max(LEAST_MEMORY);
        let most = self.space.map(|most| most - most / if beyond > 0 { 16 } else { 8 });
        resident > limit.saturating_add(limit / 100 * beyond)
            || most.is_some_and(|most| space > most)
    }

    /// Whether so much more than the limit of time has passed.
    fn late(&self, start: Instant, by: f64) -> bool {
        self.seconds.is_some_and(|limit| start.elapsed().as_secs_f64() > limit + by)
    }

    /// How late the work may end: the larger of 0.3 s and a tenth, less what it takes to end.
    fn grace(&self) -> f64 {
        (self.seconds.unwrap_or(0.0) / 10.0).max(0.3) - 0.08
    }

    /// Whether the work, which had taken `before` seconds of the processor when its time was over, is beyond that:
    /// on a busy machine it is not to blame for what others take.
    fn overdue(&self, start: Instant, before: f64) -> bool {
        let grace = self.grace();
        let taken = processor().map_or(f64::INFINITY, |seconds| seconds - before);
        self.late(start, grace) && (taken > 0.7 * grace || self.late(start, 10.0 * grace))
    }
}

/// The resident memory without the pages of files (the program's own code), and the address space of the process, in
/// bytes; zero where nobody knows. Asked every few milliseconds, of the file that costs the kernel least.
fn used() -> (u64, u64) {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    #[cfg(unix)]
    let page = rustix::param::page_size() as u64;
    #[cfg(not(unix))]
    let page = 0;
    let mut words = pages.split_whitespace().map_while(|word| word.parse::<u64>().ok());
    let mut next = || words.next().unwrap_or(0).saturating_mul(page);
    let space = next();
    let resident = next();
    (resident.saturating_sub(next()), space)
}

/// The processor's seconds that the process took; nothing but on Linux. The kernel counts them in hundredths.
fn processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name, in parentheses, may contain anything; user and system time are the 14th and 15th word.
    let mut words = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut next = || words.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}

/// What the kernel says of the process; nothing but on Linux.
fn status() -> String {
    std::fs::read_to_string("/proc/self/status").unwrap_or_default()
}

fn field<'a>(status: &'a str, name: &str) -> Option<&'a str> {
    status.lines().find_map(|line| line.strip_prefix(name)).map(str::trim)
}

/// The one that looks.
#[derive(Clone)]
pub struct Watch(Arc<State>);

struct State {
    start: Instant,
    limits: Limits,
    /// Zero, or one more than the place in [`REASONS`].
    reason: Arc<AtomicUsize>,
    phase: AtomicUsize,
    format: Format,
    bar: ProgressBar,
}

impl Watch {
    /// Catches the signals and begins to look. A second signal ends the program at once.
    pub fn start(limits: Limits, format: Format, bar: ProgressBar) -> Self {
        let reason = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        let ignored = ignored();
        for (place, why) in REASONS.iter().enumerate() {
            let Some(signal) = why.signal.filter(|signal| ignored >> (signal - 1) & 1 == 0) else {
                continue;
            };
            let (exit, again) = (i32::from(why.exit), &again);
            // What cannot be caught ends the program by itself.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, exit, again.clone());
            let _ = signal_hook::flag::register(signal, again.clone());
            let _ = signal_hook::flag::register_usize(signal, reason.clone(), place + 1);
        }
        // A file that grows beyond `ulimit -f` is an error of the write.
        #[cfg(unix)]
        let _ = signal_hook::flag::register(signals::SIGXFSZ, Arc::new(AtomicBool::new(false)));
        let (start, phase) = (Instant::now(), AtomicUsize::new(Phase::Working as usize));
        let watch = Self(Arc::new(State { start, limits, reason, phase, format, bar }));
        let own = watch.clone();
        let looking = std::thread::Builder::new().name("watch".to_owned());
        // Without a thread there are no limits but those that are predicted.
        let _ = looking.stack_size(256 << 10).spawn(move || own.look());
        watch
    }

    /// Looks until files are written.
    fn look(&self) {
        let Self(state) = self;
        let (mut said, mut before) = (false, None);
        loop {
            std::thread::sleep(PERIOD);
            let phase = state.phase.load(Ordering::SeqCst);
            if phase == Phase::Writing as usize {
                return;
            }
            if state.limits.late(state.start, 0.0) {
                self.because(TIME);
            } else if state.limits.full(0) {
                self.because(MEMORY);
            }
            let reason = self.reason();
            if !said && reason.is_some_and(|why| why.signal.is_some()) {
                warn("stopping after the step in progress; Ctrl-C again to stop at once");
                said = true;
            }
            if before.is_none() && state.limits.late(state.start, 0.0) {
                before = processor();
            }
            let working = phase == Phase::Working as usize;
            if working && state.limits.overdue(state.start, before.unwrap_or(0.0)) {
                self.end(&REASONS[TIME]);
            } else if state.limits.full(10) {
                self.end(&REASONS[MEMORY]);
            }
        }
    }

    /// Asks the work to stop; the first reason counts.
    fn because(&self, place: usize) {
        let _ = self.0.reason.compare_exchange(0, place + 1, Ordering::SeqCst, Ordering::SeqCst);
    }

    /// Ends the program: the step in progress does not look at the flag, or not often enough.
    fn end(&self, why: &Reason) {
        self.0.bar.finish_and_clear();
        let message = format!("{} within a step that cannot be broken off", why.words);
        let hint = why.hint.unwrap_or("raise --limit-seconds, or ask for less");
        let refused = Refused::undecided(why.code, message, hint);
        Failure { exit: why.exit, refused }.report(self.0.format);
        exit(i32::from(why.exit));
    }

    /// Why the work was stopped, if it was.
    pub fn reason(&self) -> Option<&'static Reason> {
        REASONS.get(self.0.reason.load(Ordering::SeqCst).checked_sub(1)?)
    }

    /// The question of the work.
    pub fn stop(&self) -> Stop {
        let reason = self.0.reason.clone();
        Stop::new(move || reason.load(Ordering::Relaxed) != 0)
    }

    /// The work is done: what is finished is shown, however long that takes.
    pub fn showing(&self) {
        self.0.phase.fetch_max(Phase::Showing as usize, Ordering::SeqCst);
    }

    /// Files are written from here on, and nothing ends that.
    pub fn writing(&self) {
        self.0.phase.store(Phase::Writing as usize, Ordering::SeqCst);
    }

    /// The seconds until the time is over, with what an end may take; nothing without a limit.
    pub fn left(&self) -> Option<f64> {
        let State { limits, start, .. } = &*self.0;
        Some(limits.seconds? + limits.grace() - start.elapsed().as_secs_f64())
    }

    /// The time since the start.
    pub fn elapsed(&self) -> Duration {
        self.0.start.elapsed()
    }
}

/// The signals that were ignored when the program began (`nohup`, `&` in a script), a bit each: they stay so.
fn ignored() -> u64 {
    field(&status(), "SigIgn:").and_then(|mask| u64::from_str_radix(mask, 16).ok()).unwrap_or(0)
}
