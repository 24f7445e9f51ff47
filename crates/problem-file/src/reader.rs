//! What the reading of every key needs: positions, exact values, words.

use crate::error::{ParseError, excerpt, position};
use crate::file_error::{FileError, FileErrorKind};
use crate::schema::ExactText;
use lindstedt_number::Exact;
use std::ops::Range;
use toml::Spanned;

pub(crate) struct Reader<'a> {
    pub text: &'a str,
}

impl Reader<'_> {
    pub fn error(&self, kind: FileErrorKind, at: usize) -> FileError {
        let (line, column) = position(self.text, at);
        FileError { kind, line, column }
    }

    /// Where the content of a string starts, if it stands in the file as it is.
    pub fn content(&self, string: &Spanned<String>) -> Option<usize> {
        let raw = self.text.get(string.span())?;
        let inside = raw.find(string.get_ref().as_str())?;
        Some(string.span().start + inside)
    }

    /// An error inside a string.
    pub fn inside(&self, string: &Spanned<String>, error: ParseError) -> FileError {
        let start = self.content(string);
        let at = start.map_or(string.span().start, |start| start + error.at.start);
        self.error(FileErrorKind::Equation(error), at)
    }

    pub fn value(&self, value: &Spanned<ExactText>) -> Result<String, FileError> {
        let text = value.get_ref().0.trim();
        let sign = matches!(text, "+" | "-");
        if sign || Exact::parse(text).is_ok() {
            return Ok(text.to_owned());
        }
        let kind = FileErrorKind::Value { text: excerpt(text) };
        Err(self.error(kind, value.span().start))
    }

    pub fn word<T: Clone>(
        &self,
        key: &'static str,
        word: &str,
        at: Range<usize>,
        list: &[(&str, T)],
    ) -> Result<T, FileError> {
        let found = list.iter().find(|(name, _)| *name == word).map(|(_, value)| value.clone());
        let names = || list.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        let kind = || FileErrorKind::Word { key, found: excerpt(word), known: names() };
        found.ok_or_else(|| self.error(kind(), at.start))
    }
}
