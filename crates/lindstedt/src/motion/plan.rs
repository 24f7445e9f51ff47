//! What is integrated and shown.

use super::setup::Setup;
use super::{View, difference};
use crate::Work;
use lindstedt_simulate::{self as simulate, Course, Cut, End, Quantity, SimulateError};
use rug::Float;

/// What to integrate.
pub(super) struct Plan {
    pub setup: Setup,
    pub end: End,
    /// Times of the samples, in order.
    pub times: Vec<Quantity>,
    pub section: Option<Cut>,
    /// Points of the section left out at the beginning.
    pub skip: usize,
    /// Whether the line of a figure is kept.
    pub drawn: bool,
    pub view: View,
    /// Why the motion ends before it should.
    pub cut: Option<String>,
}

impl Plan {
    /// Ends the motion at a thousandth of its time before the singularity.
    pub fn cut_before(&mut self, singularity: f64, reason: String) {
        let end = singularity * (1.0 - 1.0 / 1024.0);
        self.times.retain(|time| time.float(64) <= end);
        self.end = End::Time(Quantity::Float(Float::with_val(53, end)));
        self.cut = Some(reason);
    }

    /// Whether the motion starts beside the periodic impact orbit.
    pub fn perturbed(&self) -> bool {
        let Some(orbit) = &self.setup.orbit else { return false };
        let start = self.setup.flow.start[1].float(orbit.start.prec());
        difference(&start, &orbit.start) > Float::with_val(53, orbit.velocity.abs_ref()) * 1e-25f64
    }

    /// The same with half the perturbation, in the digits of [`Self::run`].
    pub fn run_half(&mut self, digits: u32, work: &Work) -> Option<Course> {
        let orbit = self.setup.orbit.as_ref()?;
        let start = self.setup.flow.start[1].float(orbit.start.prec());
        let half = Quantity::Float((start + &orbit.start) / 2u32);
        let whole = std::mem::replace(&mut self.setup.flow.start[1], half);
        let course = self.run(digits, work.doubles, work);
        self.setup.flow.start[1] = whole;
        course.ok()
    }

    /// Integrates with so many digits, in doubles if `doubles`.
    pub fn run(&self, digits: u32, doubles: bool, work: &Work) -> Result<Course, SimulateError> {
        let Self { setup, end, times, section, drawn, .. } = self;
        let (flow, section, drawn) = (&setup.flow, *section, *drawn);
        let plan = simulate::Plan { flow, end, times, section, drawn };
        let mut course = plan.run(digits, doubles, &|| work.stop.asked())?;
        course.complete &= self.cut.is_none();
        Ok(course)
    }
}
