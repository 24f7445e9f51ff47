//! Rows, tables and sections of what was read, as plain values.

use crate::{Findings, Text, Verdict};
use serde::Serialize;

/// One formula or number of the paper.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The number of the formula, or where the statement stands.
    pub label: Text,
    /// What is printed.
    pub printed: Text,
    /// What the engine derives.
    pub derived: Text,
    /// What another route says, empty where there is none. A residual shares the algebra with the
    /// derivation, other routes share nothing.
    pub independent: Text,
    /// The verdict.
    pub verdict: Verdict,
    /// Why.
    pub evidence: Text,
}

impl Row {
    /// A row whose verdict follows from what was found: label, print, derivation, the other route, why.
    pub(crate) fn new(
        label: impl Into<Text>,
        printed: impl Into<Text>,
        derived: impl Into<Text>,
        independent: impl Into<Text>,
        findings: &Findings,
        evidence: impl Into<Text>,
    ) -> Self {
        let (label, printed, derived) = (label.into(), printed.into(), derived.into());
        let (independent, evidence) = (independent.into(), evidence.into());
        Self { label, printed, derived, independent, verdict: findings.verdict(), evidence }
    }
}

/// A table of numbers. Numbers are certified to the printed digits unless a note says otherwise.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// A short name for files.
    pub name: String,
    /// What it shows.
    pub title: Text,
    /// The heads of the columns.
    pub columns: Vec<Text>,
    /// The cells, row by row.
    pub rows: Vec<Vec<Text>>,
    /// What must be said beside the numbers.
    pub notes: Vec<Text>,
}

/// A section of the paper.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Its number.
    #[serde(rename = "section")]
    pub number: u32,
    /// Its title.
    pub title: &'static str,
    /// Its formulas and numbers, in the order of the paper.
    pub rows: Vec<Row>,
    /// What the method really gives.
    pub tables: Vec<Table>,
}

impl Section {
    /// The row with this label.
    pub fn row(&self, label: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.label == *label)
    }

    /// How many rows have this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }
}
