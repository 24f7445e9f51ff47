//! How a question is worked on: on a thread of its own, with Ctrl-C, a limit in time, and progress.

use crate::failure::{exception, usage};
use lindstedt::{Error, Progress, Refused, Stop, Work};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Between two looks at the signals.
const TICK: Duration = Duration::from_millis(20);
/// The stack of the thread that works: that of a program's first one.
const STACK: usize = 8 << 20;
/// So many numbers take no longer than that.
const FEW: usize = 100_000;

/// The process that first asked something.
static PROCESS: OnceLock<u32> = OnceLock::new();

/// Digits, memory, time, and whom to tell.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Means {
    digits: u32,
    doubles: bool,
    memory: u64,
    seconds: Option<f64>,
    progress: Option<Py<PyAny>>,
}

#[pymethods]
impl Means {
    /// Refuses a process that was forked off one that worked: its threads are not there, and it would wait for them for
    /// ever.
    #[new]
    #[pyo3(signature = (digits=30, doubles=false, memory=8 << 30, seconds=None, progress=None))]
    fn new(
        py: Python<'_>,
        digits: u32,
        doubles: bool,
        memory: u64,
        seconds: Option<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let own = std::process::id();
        if *PROCESS.get_or_init(|| own) != own {
            let message = "this process was forked off one in which lindstedt had worked";
            let refused = Refused::usage("fork", message, "multiprocessing with \"spawn\"");
            return Err(exception(py, &refused.into()));
        }
        if let Some(seconds) = seconds.filter(|seconds| seconds.is_nan() || *seconds < 0.0) {
            let message = format!("seconds = {seconds} is no limit");
            return Err(exception(py, &usage(message, "a number from 0 up, or nothing")));
        }
        Ok(Self { digits, doubles, memory, seconds, progress })
    }
}

/// What was last told: words, parts done, all parts.
type Told = (String, usize, usize);

fn told(progress: &Progress) -> Told {
    match progress {
        Progress::Parts(done, all) => (String::new(), *done, *all),
        other => (other.words(), 0, 0),
    }
}

impl Means {
    /// Asks for so many numbers, all of them or none.
    pub fn list<T: Send>(
        &self,
        py: Python<'_>,
        count: usize,
        question: impl FnOnce(&Work) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        if count <= FEW {
            let found = py.detach(|| question(&Work::default()));
            return found.map_err(|error| exception(py, &error));
        }
        self.ask(py, |work| {
            let found = question(work)?;
            let stopped = || Refused::stopped("stopped before all values were there", "");
            if work.stop.asked() { Err(stopped().into()) } else { Ok(found) }
        })
    }

    /// Asks a question without the interpreter's lock.
    pub fn ask<T: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&Work) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let stopped = Arc::new(AtomicBool::new(false));
        // A limit that no duration holds, as infinity, is none.
        let end = self.seconds.and_then(|s| Duration::try_from_secs_f64(s).ok());
        let end = end.and_then(|duration| Instant::now().checked_add(duration));
        let last: Arc<Mutex<Option<Told>>> = Arc::default();
        let (asked, tell) = (stopped.clone(), last.clone());
        let stop =
            move || asked.load(Ordering::Relaxed) || end.is_some_and(|end| Instant::now() > end);
        let tell = move |progress: Progress| {
            if let Ok(mut last) = tell.lock() {
                *last = Some(told(&progress));
            }
        };
        let work = Work {
            digits: self.digits,
            doubles: self.doubles,
            memory: self.memory,
            stop: Stop::new(stop),
            progress: self.progress.is_some().then(|| Arc::new(tell) as _),
        };
        let interrupted = |failure: &mut Option<PyErr>| {
            let told = last.lock().ok().and_then(|mut last| last.take());
            let tell = || match (&self.progress, told) {
                (Some(progress), Some(told)) => progress.call1(py, told).map(drop),
                _ => Ok(()),
            };
            if let Err(error) = py.check_signals().and_then(|()| tell()) {
                stopped.store(true, Ordering::Relaxed);
                failure.get_or_insert(error);
            }
        };
        std::thread::scope(|scope| {
            let (sender, mut receiver) = channel();
            let worker = std::thread::Builder::new().stack_size(STACK);
            let worker = worker.spawn_scoped(scope, move || sender.send(question(&work)).ok())?;
            let mut failure = None;
            loop {
                let found;
                (receiver, found) = py.detach(move || {
                    let found = receiver.recv_timeout(TICK);
                    (receiver, found)
                });
                match found {
                    Ok(found) => {
                        interrupted(&mut failure);
                        return match failure {
                            Some(error) => Err(error),
                            None => found.map_err(|error| exception(py, &error)),
                        };
                    }
                    Err(RecvTimeoutError::Timeout) => interrupted(&mut failure),
                    Err(RecvTimeoutError::Disconnected) => {
                        // Joined here, or the scope panics in its turn.
                        let _ = worker.join();
                        let message =
                            "the work ended without an answer: a defect, please report it";
                        return Err(pyo3::exceptions::PyRuntimeError::new_err(message));
                    }
                }
            }
        })
    }
}
