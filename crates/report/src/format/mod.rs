//! The readers of a document.

mod html;
mod latex;
mod markdown;
mod text;

use crate::{Block, Document, Formula, Span, Table, Text};

/// How a document is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Plain text for a terminal, without control characters.
    Text,
    /// LaTeX for a document with `amsmath`.
    Latex,
    /// Markdown with formulas between dollar signs.
    Markdown,
    /// The body of an HTML page, formulas as MathML.
    Html,
}

/// One form of writing: how each part of a document looks.
trait Writer {
    fn words(&self, words: &str) -> String;
    fn inline(&self, formula: &Formula) -> String;
    fn verbatim(&self, code: &str) -> String;
    fn heading(&self, line: &str, level: usize) -> String;
    fn formula(&self, formula: &Formula) -> String;
    fn lines(&self, list: &[(String, String)]) -> String;
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String;
    fn paragraph(&self, line: &str) -> String;
    fn code(&self, code: &str) -> String;
}

impl Format {
    fn writer(self) -> &'static dyn Writer {
        match self {
            Self::Text => &text::Plain,
            Self::Latex => &latex::Latex,
            Self::Markdown => &markdown::Markdown,
            Self::Html => &html::Html,
        }
    }

    /// A line.
    #[must_use]
    pub fn line(self, line: &Text) -> String {
        let writer = self.writer();
        let span = |span: &Span| match span {
            Span::Words(words) => writer.words(words),
            Span::Formula(formula) => writer.inline(formula),
            Span::Sentence(formula) if self == Self::Text => writer.words(&formula.text),
            Span::Sentence(formula) => self.line(&Text::marked(&formula.latex)),
            Span::Code(code) => writer.verbatim(code),
        };
        line.0.iter().map(span).collect()
    }

    /// A whole page.
    ///
    /// ```
    /// use lindstedt_report::{Document, Format};
    /// let page = Document::titled("100 % of <all>").lines([("period", "6.28")]);
    /// assert_eq!(Format::Text.write(&page), "100 % of <all>\n\n  period  6.28\n");
    /// assert!(Format::Latex.write(&page).starts_with("\\section*{100 \\% of \\textless{}all"));
    /// assert!(Format::Html.write(&page).starts_with("<h1>100 % of &lt;all&gt;</h1>"));
    /// ```
    #[must_use]
    pub fn write(self, page: &Document) -> String {
        let writer = self.writer();
        let mut headings = 0;
        let parts = page.blocks.iter().map(|block| match block {
            Block::Heading(line) => {
                headings += 1;
                writer.heading(&self.line(line), headings.min(2))
            }
            Block::Formula(formula) => writer.formula(formula),
            Block::Lines(list) => {
                let line = |(name, value): &(Text, Text)| (self.line(name), self.line(value));
                writer.lines(&list.iter().map(line).collect::<Vec<_>>())
            }
            Block::Table(table) => self.table(table),
            Block::Words(line) => writer.paragraph(&self.line(line)),
            Block::Source(file) if self == Self::Text => text::harmless(file),
            Block::Code(code) | Block::Source(code) => writer.code(code),
        });
        let parts: Vec<String> = parts.collect();
        self.join(page, &parts)
    }

    fn table(self, table: &Table) -> String {
        let cells = |row: &Vec<Text>| row.iter().map(|cell| self.line(cell)).collect::<Vec<_>>();
        let rows: Vec<Vec<String>> = table.rows.iter().map(cells).collect();
        self.writer().table(&cells(&table.columns), &rows)
    }

    /// Parts with a blank line between them; in text what belongs together stands together.
    fn join(self, page: &Document, parts: &[String]) -> String {
        let mut text = String::new();
        let mut before: Option<&Block> = None;
        for (index, (block, part)) in page.blocks.iter().zip(parts).enumerate() {
            let close = before.is_some_and(|before| match (before, block) {
                (Block::Formula(_), Block::Formula(_)) => true,
                // Not the title.
                (Block::Heading(_), _) => index > 1,
                (Block::Words(line), Block::Formula(_)) => self.line(line).ends_with(':'),
                _ => false,
            });
            if before.is_some() && !(self == Self::Text && close) {
                text.push('\n');
            }
            text += part;
            before = Some(block);
        }
        text
    }
}
