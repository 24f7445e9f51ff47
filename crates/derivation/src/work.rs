//! How a question may be worked on: digits, memory, when to stop, whom to tell.

use lindstedt_algebra::Stop;
use std::fmt;
use std::sync::Arc;

/// What long work reports while it goes on.
///
/// ```
/// use lindstedt_derivation::{Progress, Settings, derive};
/// let problem = lindstedt_problems::find("power-law").ok_or("no such problem")?;
/// let mut orders = 0;
/// let mut told = |progress| {
///     orders += usize::from(matches!(progress, Progress::Order(..)));
///     true
/// };
/// derive(&problem, &Settings { order: 2, ..Settings::default() }, &mut told)?;
/// assert!(orders >= 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress {
    /// An order is finished; with the number of terms of its solution.
    Order(usize, usize),
    /// So many primes are done (problems over Q; their number is not known beforehand).
    Primes(usize),
    /// So many values of the small parameter are compared with the time domain.
    Integrating(usize),
    /// The finished expansion is being substituted into the equation.
    Checking,
    /// The work was stopped; what is finished is being read as formulas.
    Reading,
    /// So many of so many independent parts are done.
    Parts(usize, usize),
    /// A try with so many digits.
    Digits(u32),
}

impl Progress {
    /// What is being done.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Order(order, terms) => format!("order {order} done, {terms} terms"),
            Self::Primes(primes) => format!("{primes} primes done"),
            Self::Integrating(done) => format!("{done} values compared"),
            Self::Checking => "substituting into the equation".to_owned(),
            Self::Reading => "reading what is finished".to_owned(),
            Self::Parts(done, all) => format!("{done} of {all} done"),
            Self::Digits(digits) => format!("{digits} digits"),
        }
    }
}

/// The means of a question: one value for every verb. The default answers with 30 digits, in 8 GiB,
/// without an end and in silence.
///
/// ```
/// use lindstedt_derivation::Work;
/// let work = Work { digits: 50, ..Work::default() };
/// assert!(!work.stop.asked());
/// ```
#[derive(Clone)]
pub struct Work {
    /// Correct digits of every decimal, 1 to 10 000.
    pub digits: u32,
    /// Whether doubles are precise enough: fast, with measured or estimated errors. Decimals have 17
    /// digits then, whatever `digits` says.
    pub doubles: bool,
    /// The memory that may be used, in bytes.
    pub memory: u64,
    /// Asked within long work, from any of its threads, whether to stop.
    pub stop: Stop,
    /// Told what is being done, from any thread.
    pub progress: Option<Arc<dyn Fn(Progress) + Send + Sync>>,
}

impl Default for Work {
    fn default() -> Self {
        Self { digits: 30, doubles: false, memory: 8 << 30, stop: Stop::default(), progress: None }
    }
}

impl Work {
    /// Tells what is being done.
    pub fn tell(&self, progress: Progress) {
        if let Some(told) = &self.progress {
            told(progress);
        }
    }

    /// Tells, and answers whether to go on.
    pub fn goes_on(&self, progress: Progress) -> bool {
        self.tell(progress);
        !self.stop.asked()
    }

    /// The digits of a printed decimal.
    #[must_use]
    pub fn printed_digits(&self) -> usize {
        if self.doubles { 17 } else { self.digits as usize }
    }
}

impl fmt::Debug for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { digits, doubles, memory, stop, progress } = self;
        f.debug_struct("Work")
            .field("digits", digits)
            .field("doubles", doubles)
            .field("memory", memory)
            .field("stop", stop)
            .field("progress", &progress.is_some())
            .finish()
    }
}
