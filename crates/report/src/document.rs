//! What a page is made of.

use crate::Table;

/// A formula in the two notations that the engine prints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula {
    /// As in a problem file: `x'' + x + eps*x^3 = 0`.
    pub text: String,
    /// The same in LaTeX, without delimiters.
    pub latex: String,
}

impl Formula {
    /// A formula from what prints it in either notation.
    pub fn new(text: impl Into<String>, latex: impl Into<String>) -> Self {
        Self { text: text.into(), latex: latex.into() }
    }

    /// As a sentence: the LaTeX form is words with formulas between dollar signs, the text form stands
    /// as it is.
    #[must_use]
    pub fn into_sentence(self) -> Text {
        Text(vec![Span::Sentence(self)])
    }
}

/// A piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Span {
    /// Plain words: data, escaped by every reader.
    Words(String),
    /// A formula within the line.
    Formula(Formula),
    /// A sentence with its own marks: its LaTeX form is words with formulas between dollar signs.
    Sentence(Formula),
    /// Something to type or to find in a file, in a fixed width.
    Code(String),
    /// Words that stand out; the class is a name for a style sheet.
    Strong {
        /// What is read.
        words: String,
        /// What it is: `wrong`.
        class: &'static str,
    },
    /// Words that lead to a place of the page or to a file beside it; where nothing can be followed,
    /// the words.
    Link {
        /// What is read.
        words: String,
        /// The name of a file, or `#` and that of a [`Part`].
        to: String,
    },
}

/// A line: words with formulas between them.
///
/// ```
/// use lindstedt_report::{Format, Formula, Text};
/// let line = Text::words("exponent ").formula(Formula::new("lambda", r"\lambda"));
/// assert_eq!(Format::Text.line(&line), "exponent lambda");
/// assert_eq!(Format::Latex.line(&line), r"exponent $\lambda$");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text(pub Vec<Span>);

impl Text {
    /// A line of words.
    pub fn words(words: impl Into<String>) -> Self {
        Self(vec![Span::Words(words.into())])
    }

    /// The line with a formula after it.
    #[must_use]
    pub fn formula(mut self, formula: Formula) -> Self {
        self.0.push(Span::Formula(formula));
        self
    }

    /// The line with words after it.
    #[must_use]
    pub fn and(mut self, words: impl Into<String>) -> Self {
        self.0.push(Span::Words(words.into()));
        self
    }

    /// The line with something to type after it.
    #[must_use]
    pub fn code(mut self, code: impl Into<String>) -> Self {
        self.0.push(Span::Code(code.into()));
        self
    }

    /// The line with words after it that stand out.
    #[must_use]
    pub fn strong(mut self, words: impl Into<String>, class: &'static str) -> Self {
        self.0.push(Span::Strong { words: words.into(), class });
        self
    }

    /// The line with words after it that lead somewhere.
    #[must_use]
    pub fn link(mut self, words: impl Into<String>, to: impl Into<String>) -> Self {
        self.0.push(Span::Link { words: words.into(), to: to.into() });
        self
    }

    /// The line with another one after it.
    #[must_use]
    pub fn then(mut self, other: impl Into<Self>) -> Self {
        self.0.extend(other.into().0);
        self
    }

    /// Words with formulas between dollar signs, in LaTeX: `the root $\alpha_0$ of`. The text form of
    /// such a formula is its source without backslashes and braces.
    #[must_use]
    pub fn marked(source: &str) -> Self {
        let part = |(index, part): (usize, &str)| match index % 2 {
            0 => Span::Words(part.to_owned()),
            _ => Span::Formula(Formula::new(part.replace(['\\', '{', '}'], ""), part)),
        };
        Self(source.split('$').enumerate().filter(|(_, part)| !part.is_empty()).map(part).collect())
    }
}

impl<T: Into<String>> From<T> for Text {
    fn from(words: T) -> Self {
        Self::words(words)
    }
}

impl From<Formula> for Text {
    fn from(formula: Formula) -> Self {
        Self(vec![Span::Formula(formula)])
    }
}

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
    /// The name by which a [`Span::Link`] finds it; empty where none does.
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
