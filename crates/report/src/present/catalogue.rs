//! Problems: a list, or one with its file.

use super::classification::lines;
use super::{Pen, Present, condition_text};
use crate::{Block, Document, Formula};
use lindstedt::catalogue::{Catalogue, Entry};

impl Present for Catalogue {
    fn page(&self, _: Pen) -> Document {
        let mut page = Document::default();
        for entry in &self.problems {
            page = match &entry.file {
                Some(file) => with_file(page, entry, file),
                None => card(page, entry),
            };
        }
        page
    }
}

/// The problem file, with the classification in comments.
fn with_file(page: Document, entry: &Entry, file: &str) -> Document {
    let comments: String = match &entry.classification {
        Some(parts) => {
            lines(parts).iter().map(|(name, what)| format!("# {name:<20}{what}\n")).collect()
        }
        None => String::new(),
    };
    page.with(Block::Source(format!("{file}\n{comments}")))
}

fn card(page: Document, entry: &Entry) -> Document {
    let page = page.heading(entry.name.as_str()).words(entry.title.as_str());
    let page = page.formula(Formula::new(entry.equation.as_str(), entry.latex.as_str()));
    let conditions = entry.conditions.iter().map(|condition| {
        (format!("normalisation {}", condition.name()), condition_text(*condition).to_owned())
    });
    let small = ("small parameter".to_owned(), entry.parameter.clone());
    let parameters = entry
        .parameters
        .iter()
        .map(|card| (format!("{} = {} by default", card.name, card.default), card.meaning.clone()));
    let page = page.lines(std::iter::once(small).chain(conditions).chain(parameters));
    let notes = [("notes", &entry.notes), ("source", &entry.source)];
    page.lines(notes.into_iter().filter(|(_, text)| !text.is_empty()).map(|(n, t)| (n, t.as_str())))
}
