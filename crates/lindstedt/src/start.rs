//! The starts that a file may give twice: `[initial]` and `amplitude`.

use crate::{Exact, Oscillator, Remark};
use lindstedt_number::ball::Balls;

/// Which of the two a question takes.
pub enum Taken {
    /// The amplitude, also where it is the default one.
    Amplitude,
    /// x and velocity of `[initial]`; the option that gives the other start, with
    /// AMPLITUDE in place of the value.
    Initial(&'static str),
}

impl Oscillator {
    /// Says which start is taken where `[initial]` and the amplitude contradict each other.
    #[must_use]
    pub fn start_remark(&self, taken: Taken) -> Option<Remark> {
        let file = self.problem_file();
        let [x, velocity] = file.initial.as_ref()?;
        let value = |text: &String| Exact::parse(text).ok();
        let written = file.names.parameters.iter().any(|names| names.contains("amplitude"));
        // A default that nobody wrote contradicts nothing that is taken.
        let told = written || self.given().contains_key("amplitude");
        if matches!(taken, Taken::Initial(_)) && !told {
            return None;
        }
        let amplitude = self.value("amplitude")?;
        let same = value(x).as_ref() == Some(&amplitude);
        let rests = value(velocity).and_then(|v| Some(v.as_rational()?.is_zero())) == Some(true);
        // An amplitude that is refused is no advice.
        let advice = |value: Option<Exact>, option: &str| match value {
            Some(value) if value.ball(Balls::new(64)).is_positive() => {
                format!(" ({})", option.replace("AMPLITUDE", &value.to_string()))
            }
            _ => String::new(),
        };
        let text = match (taken, same, rests) {
            (_, true, true) => return None,
            (Taken::Amplitude, false, _) => format!(
                "x = {x} of [initial] has no effect here: the amplitude is {amplitude}{}",
                advice(value(x), "--set amplitude=AMPLITUDE")
            ),
            (Taken::Amplitude, true, false) => format!(
                "velocity = {velocity} of [initial] has no effect here: the expansion starts at rest"
            ),
            (Taken::Initial(option), ..) => format!(
                "amplitude = {amplitude} is not the start here: x = {x}, velocity = {velocity} of \
                 [initial] is{}",
                advice(Some(amplitude.clone()), option)
            ),
        };
        Some(Remark(text))
    }
}
