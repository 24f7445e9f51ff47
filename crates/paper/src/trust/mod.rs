//! Where the paper's methods can be trusted, and where not: one measurement for each section.
//!
//! * [`Region`]: how often the stability region of (17) has the verdict of the delayed system.
//! * [`Onset`]: the first homoclinic tangency against Melnikov's threshold as eps grows.
//! * [`Truncation`]: the true error of the period against the order of the delta expansion.

mod onset;
mod region;
mod truncation;

pub use crate::vibro_impact::{Rate, Sample};
pub use onset::{Onset, OnsetPoint};
pub use region::{Region, RegionChart};
pub use truncation::Truncation;

pub(super) use onset::read as read_onset;
pub(super) use region::read as read_region;
pub(super) use truncation::read as read_truncation;

use crate::Text;
use serde::Serialize;

/// What is estimated throughout says so.
pub(super) const ESTIMATED: &str = "estimated";

/// Values of eps per loop.
pub(super) const QUICK_STEPS: usize = onset::QUICK.len();
pub(super) const FULL_STEPS: usize = onset::FULL.len();

/// The measurements; empty where the work was stopped before.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Trust {
    /// What they come to in words, in the order of the paper; those of finished sections.
    pub findings: Vec<Finding>,
    /// Section 2.
    pub region: Option<Region>,
    /// Section 3.
    pub onset: Option<Onset>,
    /// Section 4: the power laws, then the pendulum.
    pub truncations: Vec<Truncation>,
}

/// What a section's measurement comes to, in words.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The section of the paper.
    pub section: u32,
    /// The method.
    pub method: Text,
    /// Where it holds.
    pub trusted: Vec<Text>,
    /// Where it does not.
    pub not_trusted: Vec<Text>,
    /// What the numbers are worth.
    pub class: Text,
}

impl Trust {
    /// Adds what another section measured.
    pub(super) fn add(&mut self, other: Self) {
        self.region = self.region.take().or(other.region);
        self.onset = self.onset.take().or(other.onset);
        self.truncations.extend(other.truncations);
    }

    /// Says what was measured.
    pub(super) fn conclude(&mut self) {
        let region = self.region.as_ref().map(Region::finding);
        let onset = self.onset.as_ref().map(Onset::finding);
        let truncation = truncation::finding(&self.truncations);
        self.findings = [region, onset, truncation].into_iter().flatten().collect();
    }
}

/// "61.0 %" of a share.
fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
