//! Where an averaged motion starts.

use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Error, Exact, Oscillator, Remark};
use lindstedt_number::ball::Balls;
use rug::Rational;

/// Where the motion starts, at t = 0.
#[derive(Clone, Debug)]
pub enum Start {
    /// a(0) and psi(0).
    Amplitude(Exact, Exact),
    /// x(0) and x'(0), which a(0) and psi(0) are computed from.
    State(Exact, Exact),
}

/// Two values separated by a comma.
fn pair(name: &'static str, text: &str) -> Result<[Exact; 2], Error> {
    let shown: String = text.chars().take(60).collect();
    let (first, second) = text.split_once(',').ok_or_else(|| {
        Refused::usage(name, format!("--{name} {shown:?} is not two values"), "for example 1,0")
    })?;
    Ok([Exact::parse(first)?, Exact::parse(second)?])
}

impl Start {
    /// Reads `A,PSI`, A > 0.
    ///
    /// # Errors
    /// [`Refused`], [`Error::BadValue`].
    pub fn parse_amplitude(text: &str) -> Result<Self, Error> {
        let [a, psi] = pair("start", text)?;
        if !a.ball(Balls::new(64)).is_positive() {
            let message = format!("the amplitude {a} is not positive");
            return Err(Refused::usage("start", message, "--start A,PSI with A > 0").into());
        }
        Ok(Self::Amplitude(a, psi))
    }

    /// Reads `X,V`.
    ///
    /// # Errors
    /// [`Refused`], [`Error::BadValue`].
    pub fn parse_state(text: &str) -> Result<Self, Error> {
        let [x, v] = pair("state", text)?;
        Ok(Self::State(x, v))
    }
}

impl Oscillator {
    /// The start of the file, or the amplitude of the problem at phase 0; where no motion is asked for
    /// an amplitude 1 shows the rates. With what is to be said of it.
    pub(super) fn averaged_start(&self, needed: bool) -> Result<(Start, Option<Remark>), Error> {
        if let Some([x, v]) = self.problem_file().initial.as_ref() {
            let remark = self.start_remark(Taken::Initial("--start AMPLITUDE,0"));
            return Ok((Start::State(Exact::parse(x)?, Exact::parse(v)?), remark));
        }
        let number = |n: u32| Exact::Rational(Rational::from(n));
        match self.value("amplitude") {
            Some(a) => Ok((Start::Amplitude(a, number(0)), None)),
            None if needed => {
                let message = "the amplitude is free: where does the motion start?";
                Err(Refused::usage("start", message, "--start A,PSI or --state X,V").into())
            }
            None => Ok((Start::Amplitude(number(1), number(0)), None)),
        }
    }
}
