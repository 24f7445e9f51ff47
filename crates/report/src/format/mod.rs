//! The readers of a document.

mod csv;
mod html;
mod latex;
mod markdown;
mod text;

use crate::{Block, Document, Formula, Span, Table, Text};
pub(crate) use csv::line;
pub use html::standalone;
pub use text::harmless;
pub(crate) use text::steers;

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
    fn strong(&self, words: &str, class: &str) -> String;
    fn link(&self, words: &str, to: &str) -> String;
    fn heading(&self, line: &str, level: usize) -> String;
    fn formula(&self, formula: &Formula) -> String;
    fn lines(&self, list: &[(String, String)]) -> String;
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String;
    fn paragraph(&self, line: &str) -> String;
    fn code(&self, code: &str) -> String;
    fn list(&self, items: &[String]) -> String;
    fn picture(&self, name: &str, caption: &str, svg: &str) -> String;
}

impl Format {
    fn writer(self) -> &'static dyn Writer {
        match self {
            Self::Text => &text::UNLIMITED,
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
            Span::Strong { words, class } => writer.strong(words, class),
            Span::Link { words, to } => writer.link(words, to),
        };
        let spans = line.0.iter().map(span).collect();
        if self == Self::Html { html::glued(spans) } else { spans.concat() }
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
        self.blocks(self.writer(), page, 1)
    }

    /// A whole page; text with its paragraphs, items and named values broken into lines of at most so many
    /// characters, where blanks allow it.
    #[must_use]
    pub fn write_within(self, page: &Document, width: usize) -> String {
        let plain = text::Plain { width };
        self.blocks(if self == Self::Text { &plain } else { self.writer() }, page, 1)
    }

    /// The blocks of a page, or of a part that lies so deep.
    fn blocks(self, writer: &dyn Writer, page: &Document, depth: usize) -> String {
        let mut list: Vec<(usize, Block)> = match self {
            Self::Html => page.blocks.iter().map(|block| (depth, block.clone())).collect(),
            _ => flat(page, depth),
        };
        let title = list.iter_mut().find(|(_, block)| matches!(block, Block::Heading(_)));
        if let (1, Some((level, _))) = (depth, title) {
            *level = 0;
        }
        let parts = list.iter().map(|(depth, block)| match block {
            Block::Heading(line) => writer.heading(&self.line(line), depth + 1),
            Block::Formula(formula) => writer.formula(formula),
            Block::Lines(list) => {
                let line = |(name, value): &(Text, Text)| (self.line(name), self.line(value));
                writer.lines(&list.iter().map(line).collect::<Vec<_>>())
            }
            Block::Table(table) => self.table(table),
            Block::Words(line) => writer.paragraph(&self.line(line)),
            Block::Source(file) if self == Self::Text => harmless(file),
            Block::Code(code) | Block::Source(code) => writer.code(code),
            Block::List(items) => {
                let items: Vec<String> = items.iter().map(|item| self.line(item)).collect();
                writer.list(&items)
            }
            Block::Picture { name, caption, svg } => writer.picture(name, &self.line(caption), svg),
            // Only HTML keeps these as they are.
            Block::Part(part) => {
                let inner = self.blocks(writer, &part.page, depth + 1);
                html::part(part, &self.line(&part.title), depth + 1, &inner)
            }
            Block::Folded { word, open, page } => {
                html::folded(word, *open, &self.blocks(writer, page, depth + 1))
            }
        });
        let parts: Vec<String> = parts.collect();
        self.join(&list, &parts)
    }

    fn table(self, table: &Table) -> String {
        let cells = |row: &Vec<Text>| row.iter().map(|cell| self.line(cell)).collect::<Vec<_>>();
        let rows: Vec<Vec<String>> = table.rows.iter().map(cells).collect();
        self.writer().table(&cells(&table.columns), &rows)
    }

    /// Parts with a blank line between them; in text what belongs together stands together.
    fn join(self, blocks: &[(usize, Block)], parts: &[String]) -> String {
        let mut text = String::new();
        let mut before: Option<&Block> = None;
        for (index, ((_, block), part)) in blocks.iter().zip(parts).enumerate() {
            if part.is_empty() {
                continue;
            }
            let close = before.is_some_and(|before| match (before, block) {
                (Block::Formula(_), Block::Formula(_)) => true,
                (Block::Heading(_), Block::Heading(_)) => false,
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

/// The page without parts in parts, each block with its depth; named values that follow those
/// of another part are one list with them.
fn flat(page: &Document, depth: usize) -> Vec<(usize, Block)> {
    let mut list: Vec<(usize, Block)> = Vec::new();
    for block in &page.blocks {
        let inner = match block {
            Block::Part(part) => {
                if !part.title.0.is_empty() {
                    list.push((depth, Block::Heading(part.title.clone())));
                }
                flat(&part.page, depth + 1)
            }
            Block::Folded { page, .. } => flat(page, depth),
            block => vec![(depth, block.clone())],
        };
        let nested = matches!(block, Block::Part(_) | Block::Folded { .. });
        for (depth, block) in inner {
            match (list.last_mut(), block) {
                (Some((_, Block::Lines(before))), Block::Lines(next)) if nested => {
                    before.extend(next);
                }
                (_, block) => list.push((depth, block)),
            }
        }
    }
    list
}
