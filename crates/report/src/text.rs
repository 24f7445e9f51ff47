//! A line: words and formulas.

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
        /// The name of a file, or `#` and that of a [`Part`](crate::Part).
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
