//! Stopping long work from within.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A question that long steps ask between their parts, from any thread: whether to stop. Once the
/// answer was yes it stays yes. The default never stops.
///
/// An algebra that holds one may break a product off; its value then means nothing, and
/// [`FunctionAlgebra::interrupted`](crate::FunctionAlgebra::interrupted) says so.
///
/// ```
/// use lindstedt_algebra::Stop;
/// use std::sync::atomic::{AtomicU32, Ordering};
/// let left = AtomicU32::new(2);
/// let stop = Stop::new(move || left.fetch_sub(1, Ordering::Relaxed) == 0);
/// assert_eq!([stop.asked(), stop.asked(), stop.asked(), stop.asked()], [false, false, true, true]);
/// ```
#[derive(Clone, Default)]
pub struct Stop(Option<Arc<Question>>);

struct Question {
    ask: Box<dyn Fn() -> bool + Send + Sync>,
    stopped: AtomicBool,
}

impl Stop {
    /// Stops when `ask` says so; it is called some thousand times per second.
    pub fn new(ask: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(Question { ask: Box::new(ask), stopped: AtomicBool::new(false) })))
    }

    /// Whether to stop.
    #[must_use]
    pub fn asked(&self) -> bool {
        let Some(question) = &self.0 else { return false };
        if question.stopped.load(Ordering::Relaxed) {
            return true;
        }
        let stop = (question.ask)();
        if stop {
            question.stopped.store(true, Ordering::Relaxed);
        }
        stop
    }
}

impl fmt::Debug for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Stop" } else { "Stop(never)" })
    }
}
