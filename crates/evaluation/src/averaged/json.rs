//! The plain form of an averaged motion.

use super::{Moment, Motion};
use crate::digits::Digits;
use lindstedt_equation::Condition;
use lindstedt_number::Number;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

#[derive(Serialize)]
struct At {
    a: f64,
    psi: f64,
}

#[derive(Serialize)]
struct Rates<'a> {
    amplitude: f64,
    phase: f64,
    amplitude_number: Digits<'a>,
    phase_number: Digits<'a>,
}

#[derive(Serialize)]
struct Moments<'a> {
    order: usize,
    resum: &'static str,
    values: &'a [Moment],
}

impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let linear = |k: usize| self.linear.as_ref().map(|numbers| Digits::of(numbers[k].as_ref()));
        let [a, psi] = self.start;
        let [amplitude, phase] = self.rates();
        let [amplitude_number, phase_number] =
            self.rate_numbers.each_ref().map(|number| Digits::of(number.as_ref()));
        let rates = Rates { amplitude, phase, amplitude_number, phase_number };
        let moments = self.moments.as_deref();
        let solution = moments.map(|values| Moments { order: self.order, resum: "none", values });
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("resum", "none")?;
        map.serialize_entry("normalisation", &Condition::FreeAmplitude)?;
        map.serialize_entry("period", &None::<Number>)?;
        map.serialize_entry("frequency", &linear(1))?;
        map.serialize_entry("growth_rate", &linear(0))?;
        map.serialize_entry("exact_period", &None::<Number>)?;
        map.serialize_entry("start", &At { a, psi })?;
        map.serialize_entry("rates", &rates)?;
        map.serialize_entry("term_ratio", &self.ratio)?;
        map.serialize_entry("integration_error", &self.integration_error)?;
        map.serialize_entry("verdict", &self.verdict())?;
        map.serialize_entry("limit_cycles", &self.cycles)?;
        map.serialize_entry("solution", &solution)?;
        map.end()
    }
}

impl Serialize for Moment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.time.to_string())?;
        map.serialize_entry("a", &Digits::of(self.amplitude.value.as_ref()))?;
        map.serialize_entry("psi", &Digits::of(self.phase.value.as_ref()))?;
        map.serialize_entry("x", &Digits::of(self.displacement.value.as_ref()))?;
        map.end()
    }
}
