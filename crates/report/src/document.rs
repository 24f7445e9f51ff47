//! What a page is made of.

use crate::{Formula, Table, Text};

/// A part of a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading; the first of a document is its title.
    Heading(Text),
    /// A formula on a line of its own.
    Formula(Formula),
    /// Names with values, one line each.
    Lines(Vec<(Text, Text)>),
    /// A table.
    Table(Table),
    /// A paragraph.
    Words(Text),
    /// Program text or a picture in characters, line by line as it is.
    Code(String),
    /// A whole file: in text it stands alone and unchanged, elsewhere as [`Block::Code`].
    Source(String),
    /// Items, one below the other.
    List(Vec<Text>),
    /// A picture with words below it; nothing where only characters are shown.
    Picture {
        /// The name of its file, without `.svg`.
        name: String,
        /// What it shows.
        caption: Text,
        /// The picture.
        svg: String,
    },
    /// A part with a place of its own.
    Part(Part),
    /// What is read on demand, under a word; in full where a page cannot fold.
    Folded {
        /// The word.
        word: &'static str,
        /// Whether it is shown at first.
        open: bool,
        /// What is folded away.
        page: Document,
    },
}

/// A part of a page with a heading one level below that of the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The heading; a frame without one where empty.
    pub title: Text,
    /// The name by which a [`Span::Link`](crate::Span::Link) finds it; empty where none does.
    pub name: String,
    /// What it is, for a style sheet: `row wrong`.
    pub class: String,
    /// What it says.
    pub page: Document,
}

/// A page: what an answer says, in the order in which it is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The parts.
    pub blocks: Vec<Block>,
}

impl Document {
    /// A page with a title.
    pub fn titled(title: impl Into<Text>) -> Self {
        Self::default().heading(title)
    }

    /// The page with one more part.
    #[must_use]
    pub fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// The page with a heading after it.
    #[must_use]
    pub fn heading(self, text: impl Into<Text>) -> Self {
        self.with(Block::Heading(text.into()))
    }

    /// The page with a displayed formula after it.
    #[must_use]
    pub fn formula(self, formula: Formula) -> Self {
        self.with(Block::Formula(formula))
    }

    /// The page with a paragraph after it.
    #[must_use]
    pub fn words(self, text: impl Into<Text>) -> Self {
        self.with(Block::Words(text.into()))
    }

    /// The page with named values after it; nothing where the list is empty.
    #[must_use]
    pub fn lines<N: Into<Text>, V: Into<Text>>(
        self,
        list: impl IntoIterator<Item = (N, V)>,
    ) -> Self {
        let list: Vec<_> =
            list.into_iter().map(|(name, value)| (name.into(), value.into())).collect();
        if list.is_empty() { self } else { self.with(Block::Lines(list)) }
    }

    /// The page with a table after it; nothing where the table is empty.
    #[must_use]
    pub fn table(self, table: Table) -> Self {
        if table.rows.is_empty() { self } else { self.with(Block::Table(table)) }
    }

    /// The page with items after it; nothing where the list is empty.
    #[must_use]
    pub fn list<T: Into<Text>>(self, list: impl IntoIterator<Item = T>) -> Self {
        let list: Vec<Text> = list.into_iter().map(Into::into).collect();
        if list.is_empty() { self } else { self.with(Block::List(list)) }
    }

    /// The page with a part of its own after it.
    #[must_use]
    pub fn part(
        self,
        (name, class): (impl Into<String>, impl Into<String>),
        title: impl Into<Text>,
        page: Self,
    ) -> Self {
        let (title, name, class) = (title.into(), name.into(), class.into());
        self.with(Block::Part(Part { title, name, class, page }))
    }

    /// The page with what is read on demand after it; nothing where that is empty.
    #[must_use]
    pub fn folded(self, word: &'static str, open: bool, page: Self) -> Self {
        if page.blocks.is_empty() { self } else { self.with(Block::Folded { word, open, page }) }
    }

    /// The page with another one after it.
    #[must_use]
    pub fn append(mut self, other: Self) -> Self {
        self.blocks.extend(other.blocks);
        self
    }
}
