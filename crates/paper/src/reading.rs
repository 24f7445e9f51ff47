//! What was read, as plain values: every page is a reader of them.

use crate::{Section, Trust};
use serde::Serialize;

/// What was read.
#[derive(Clone, Debug, Serialize)]
pub struct Paper {
    /// The version of the JSON form, [`lindstedt::SCHEMA`].
    pub schema: u32,
    /// Where the methods can be trusted.
    pub trust: Trust,
    /// The sections, in the order of the paper; with the rows finished when the observer stopped the work.
    pub sections: Vec<Section>,
    /// Whether everything is there (false when the observer stopped the work).
    pub complete: bool,
}

impl Paper {
    /// The section with this number, if it was begun.
    pub fn section(&self, number: u32) -> Option<&Section> {
        self.sections.iter().find(|section| section.number == number)
    }
}
