//! A printed formula against a derived one: equal, or equal after changes of one or two places,
//! or neither.

use super::edits::{Edit, edits};
use super::formula::{Tree, completions, parse};
use super::setting::Setting;
use crate::Text;
use crate::{Findings, Row};
use lindstedt::unstable::coeff::quotient::Quotient;
use lindstedt_algebra::Rationals;
use rug::Rational;
use std::collections::HashMap;
use std::sync::Arc;

/// A formula of the paper.
#[derive(Clone)]
pub(super) struct Statement {
    /// Its number or place.
    pub label: String,
    /// What stands before the formula where it is shown, like "b_2 = ".
    pub left: String,
    /// The formula as printed.
    pub printed: String,
    /// The words of the formula.
    pub setting: Arc<Setting>,
    /// What is derived.
    pub derived: Quotient,
    /// How the derived formula is shown; printed from the element where empty.
    pub shown: String,
    /// Whether squares are compared (of positive quantities: for square roots).
    pub squared: bool,
    /// What confirms the derivation.
    pub independent: String,
    /// What is to be said beside the comparison.
    pub remark: String,
}

/// What the paper prints for a formula, and what is said beside the comparison: a line of a list.
pub(super) struct Printed {
    /// As in [`Statement`].
    label: [&'static str; 2],
    formula: &'static str,
    beside: [&'static str; 3],
    squared: bool,
}

impl Printed {
    /// Label, left side and formula.
    pub const fn new(label: &'static str, left: &'static str, formula: &'static str) -> Self {
        Self { label: [label, left], formula, beside: [""; 3], squared: false }
    }

    /// As [`Statement::with`].
    pub const fn with(
        self,
        shown: &'static str,
        independent: &'static str,
        remark: &'static str,
    ) -> Self {
        Self { beside: [shown, independent, remark], ..self }
    }

    /// By its square.
    pub const fn squared(self) -> Self {
        Self { squared: true, ..self }
    }

    /// Beside what is derived.
    pub fn against(&self, setting: &Arc<Setting>, derived: Quotient) -> Statement {
        let [shown, independent, remark] = self.beside;
        let [label, left] = self.label;
        let statement = Statement::new((label, left), self.formula, setting, derived);
        Statement { squared: self.squared, ..statement.with(shown, independent, remark) }
    }
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Judgement {
    pub holds: bool,
    /// Where a forgotten bracket must stand.
    pub bracket: Option<String>,
    /// The changes that make it hold together; none where it holds or nothing helps.
    pub corrections: Vec<String>,
}

impl Statement {
    /// A formula that is compared as it stands, with nothing said beside it.
    pub fn new(
        (label, left): (&str, &str),
        printed: &str,
        setting: &Arc<Setting>,
        derived: Quotient,
    ) -> Self {
        let [label, left, printed] = [label, left, printed].map(str::to_owned);
        let [shown, independent, remark] = [(); 3].map(|()| String::new());
        let setting = Arc::clone(setting);
        Self { label, left, printed, setting, derived, shown, squared: false, independent, remark }
    }

    /// With what is shown for the derived formula, what confirms it, and what is to be said beside it.
    #[must_use]
    pub fn with(self, shown: &str, independent: &str, remark: &str) -> Self {
        let [shown, independent, remark] = [shown, independent, remark].map(str::to_owned);
        Self { shown, independent, remark, ..self }
    }

    fn value(&self, tree: &Tree) -> Option<Quotient> {
        self.setting.value(&if self.squared { tree.squared() } else { tree.clone() })
    }

    fn is_right(&self, tree: &Tree) -> bool {
        self.value(tree).is_some_and(|value| self.setting.field.equal(&value, &self.derived))
    }

    /// Compares. A formula that cannot be read or has no meaning does not hold.
    pub fn judge(&self) -> Judgement {
        let none = Judgement { holds: false, bracket: None, corrections: Vec::new() };
        if let Some(tree) = parse(&self.printed) {
            if self.is_right(&tree) {
                return Judgement { holds: true, ..none };
            }
            return Judgement { corrections: self.corrections(&tree), ..none };
        }
        let readings = completions(&self.printed);
        if let Some((_, bracket)) = readings.iter().find(|(tree, _)| self.is_right(tree)) {
            return Judgement { bracket: Some(bracket.clone()), ..none };
        }
        for (tree, bracket) in readings {
            let corrections = self.corrections(&tree);
            if !corrections.is_empty() {
                return Judgement { bracket: Some(bracket), corrections, ..none };
            }
        }
        none
    }

    /// One change, or else two changes of different terms, that make the formula hold. Numbers at
    /// a point leave few candidates; those are compared exactly.
    fn corrections(&self, tree: &Tree) -> Vec<String> {
        let Some(point) = self.setting.at_point() else { return Vec::new() };
        let Some(target) = self.setting.number(&self.derived) else { return Vec::new() };
        let number = |tree: &Tree| {
            let tree = if self.squared { tree.squared() } else { tree.clone() };
            point.value(&Rationals, &tree)
        };
        let vocabulary: Vec<String> = self.setting.meaning.words.keys().cloned().collect();
        let single = edits(tree, &vocabulary);
        let values: Vec<Option<Rational>> = single.iter().map(|e| number(&e.tree)).collect();
        for (edit, value) in single.iter().zip(&values) {
            if value.as_ref() == Some(&target) && self.is_right(&edit.tree) {
                return vec![edit.what.clone()];
            }
        }
        let (Some(base), Tree::Sum(_)) = (number(tree), strip(tree)) else { return Vec::new() };
        self.pair(tree, &vocabulary, &single, &values, &(target - base))
    }

    /// Two changes whose effects add up to what is missing.
    fn pair(
        &self,
        tree: &Tree,
        vocabulary: &[String],
        single: &[Edit],
        values: &[Option<Rational>],
        missing: &Rational,
    ) -> Vec<String> {
        let Some(point) = self.setting.at_point() else { return Vec::new() };
        let Some(base) = point.value(&Rationals, tree) else { return Vec::new() };
        let effect = |value: &Rational| Rational::from(value - &base);
        let mut first: HashMap<Rational, usize> = HashMap::new();
        for (n, value) in values.iter().enumerate() {
            let Some(value) = value.as_ref().map(effect) else { continue };
            let partner = first.get(&Rational::from(missing - &value)).copied();
            if let Some((a, b)) = partner.and_then(|m| Some((single.get(m)?, single.get(n)?))) {
                // The second change is made in the formula with the first.
                let both = edits(&a.tree, vocabulary);
                let right = both.iter().find(|e| {
                    e.what == b.what
                        && point.value(&Rationals, &e.tree) == Some(Rational::from(missing + &base))
                        && self.is_right(&e.tree)
                });
                if right.is_some() {
                    return vec![a.what.clone(), b.what.clone()];
                }
            }
            first.entry(value).or_insert(n);
        }
        Vec::new()
    }

    /// The formula as printed with what stands before it: a left side, or marked words.
    fn shown_as_printed(&self) -> Text {
        match self.left.strip_suffix("= ") {
            Some(_) => format!("${}{}$", self.left, self.printed).into(),
            None => format!("{}${}$", self.left, self.printed).into(),
        }
    }

    /// The rows of this formula: one, or one for each of several slips.
    pub fn rows(&self) -> Vec<Row> {
        let judgement = self.judge();
        let derived = if self.shown.is_empty() {
            format!("${}$", self.setting.field.print(&self.derived))
        } else {
            self.shown.clone()
        };
        let row = |label: String, correction: Option<&String>| {
            let holds = judgement.holds;
            let bracket = judgement.bracket.as_deref().filter(|_| correction.is_none());
            let repaired = correction.cloned().or(bracket.map(str::to_owned));
            let findings = Findings { holds, correction: repaired.clone(), ..Findings::default() };
            let mut evidence: Vec<String> = repaired.into_iter().collect();
            evidence.extend(judgement.bracket.clone().filter(|_| correction.is_some()));
            if !holds && evidence.is_empty() {
                evidence.push("no change of one place makes it hold".to_owned());
            }
            evidence.extend(Some(self.remark.clone()).filter(|remark| !remark.is_empty()));
            let evidence = evidence.join("; ");
            let printed = self.shown_as_printed();
            Row::new(label, printed, &*derived, &*self.independent, &findings, evidence)
        };
        match &judgement.corrections[..] {
            [] => vec![row(self.label.clone(), None)],
            [only] => vec![row(self.label.clone(), Some(only))],
            several => several
                .iter()
                .zip(1..)
                .map(|(what, n)| row(format!("{}, slip {n}", self.label), Some(what)))
                .collect(),
        }
    }
}

/// The sum inside factors and signs.
fn strip(tree: &Tree) -> &Tree {
    match tree {
        Tree::Negative(inner) => strip(inner),
        Tree::Product(list) => {
            list.iter().map(strip).find(|part| matches!(part, Tree::Sum(_))).unwrap_or(tree)
        }
        other => other,
    }
}
