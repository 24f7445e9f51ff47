//! The end of an integration.

/// How an integration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At the time asked for.
    Reached,
    /// The observer broke it off.
    Stopped,
}
