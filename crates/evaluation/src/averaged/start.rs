//! Where an averaged motion starts.

use crate::error::EvaluationError as Error;
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;

/// Where the motion starts, at t = 0.
#[derive(Clone, Debug)]
pub enum Start {
    /// a(0) and psi(0).
    Amplitude(Exact, Exact),
    /// x(0) and x'(0), which a(0) and psi(0) are computed from.
    State(Exact, Exact),
}

/// Two values separated by a comma.
fn pair(option: &'static str, text: &str) -> Result<[Exact; 2], Error> {
    let shown = || text.chars().take(60).collect();
    let parts =
        text.split_once(',').ok_or_else(|| Error::NotTwoValues { option, text: shown() })?;
    Ok([Exact::parse(parts.0)?, Exact::parse(parts.1)?])
}

impl Start {
    /// Reads `A,PSI`, A > 0.
    ///
    /// # Errors
    /// [`Error::NotTwoValues`], [`Error::NotPositive`], those of [`Exact::parse`].
    pub fn parse_amplitude(text: &str) -> Result<Self, Error> {
        let [a, psi] = pair("start", text)?;
        if !a.ball(Balls::new(64)).is_positive() {
            return Err(Error::NotPositive { amplitude: a.to_string() });
        }
        Ok(Self::Amplitude(a, psi))
    }

    /// Reads `X,V`.
    ///
    /// # Errors
    /// [`Error::NotTwoValues`], those of [`Exact::parse`].
    pub fn parse_state(text: &str) -> Result<Self, Error> {
        let [x, v] = pair("state", text)?;
        Ok(Self::State(x, v))
    }
}
