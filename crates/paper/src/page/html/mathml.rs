//! Formulas as MathML Core, which browsers lay out by themselves.
//!
//! A formula becomes several `<math>` elements, cut before its relations, sums and long brackets:
//! between them a line can break, inside them it cannot.

use super::formula::parse;
use super::node::Node;
use super::tokens::Token;
use std::fmt::Write;

/// A bracket longer than this is written in pieces that can stand on different lines.
const TOGETHER: usize = 30;
/// A piece with more marks than this ends at the next product.
const PIECE: usize = 24;

/// The formula of some tokens, in pieces.
pub fn formula(tokens: &[Token<'_>]) -> Vec<String> {
    let mut pieces = Pieces::default();
    pieces.nodes(&parse(tokens));
    pieces.finish()
}

#[derive(Default)]
struct Pieces {
    done: Vec<String>,
    piece: String,
    marks: usize,
    /// Whether the piece ends with a sign that belongs to what follows.
    is_open: bool,
}

impl Pieces {
    fn cut(&mut self) {
        if !self.piece.is_empty() {
            self.done.push(std::mem::take(&mut self.piece));
        }
        self.marks = 0;
    }

    fn nodes(&mut self, nodes: &[Node]) {
        for node in nodes {
            match node {
                Node::Operator(sign, true) => {
                    // A sign after a sign or at the beginning is no place for a break.
                    if !self.is_open && !self.piece.is_empty() {
                        self.cut();
                    }
                    let unary = self.is_open || self.done.is_empty() && self.piece.is_empty();
                    // The space between two pieces stands before the sign.
                    let form =
                        if unary { "form=\"prefix\"" } else { "form=\"infix\" lspace=\"0\"" };
                    let _ = write!(self.piece, "<mo {form}>{}</mo>", escape(sign));
                    self.is_open = true;
                }
                Node::Space if self.marks > PIECE && !self.is_open => self.cut(),
                Node::Group { open, close, body, length } if *length > TOGETHER => {
                    self.fence(open);
                    self.is_open = true;
                    self.nodes(body);
                    self.fence(close);
                    self.is_open = false;
                }
                Node::Scripts { base, below, above } => match &**base {
                    Node::Group { open, close, body, length } if *length > TOGETHER => {
                        self.fence(open);
                        self.is_open = true;
                        self.nodes(body);
                        let closed = Node::Operator((*close).to_owned(), false);
                        self.piece += &scripts(&closed, below, above);
                        self.is_open = false;
                    }
                    _ => self.whole(node),
                },
                _ => self.whole(node),
            }
        }
    }

    fn whole(&mut self, node: &Node) {
        let text = render(node);
        self.marks += text.matches("</m").count();
        self.piece += &text;
        self.is_open = false;
    }

    fn fence(&mut self, sign: &str) {
        if !sign.is_empty() {
            let _ = write!(self.piece, "<mo stretchy=\"false\">{sign}</mo>");
        }
    }

    fn finish(mut self) -> Vec<String> {
        self.cut();
        self.done.iter().map(|piece| format!("<math>{piece}</math>")).collect()
    }
}

fn row(nodes: &[Node]) -> String {
    let inner: String = nodes.iter().map(render).collect();
    if nodes.len() == 1 { inner } else { format!("<mrow>{inner}</mrow>") }
}

fn scripts(base: &Node, below: &[Node], above: &[Node]) -> String {
    let base = render(base);
    match (below.is_empty(), above.is_empty()) {
        (true, true) => base,
        (false, true) => format!("<msub>{base}{}</msub>", row(below)),
        (true, false) => format!("<msup>{base}{}</msup>", row(above)),
        (false, false) => format!("<msubsup>{base}{}{}</msubsup>", row(below), row(above)),
    }
}

fn render(node: &Node) -> String {
    match node {
        Node::Letter(letter) => format!("<mi>{}</mi>", escape(letter)),
        Node::Upright(word) => format!("<mi class=\"f\">{}</mi>", escape(word)),
        Node::Number(digits) => format!("<mn>{}</mn>", escape(digits)),
        Node::Operator(sign, _) => match sign.as_str() {
            "|" => "<mo stretchy=\"false\" lspace=\"0\" rspace=\"0\">|</mo>".to_owned(),
            "/" => "<mo lspace=\"0\" rspace=\"0\">/</mo>".to_owned(),
            "\u{2032}" => "<mo lspace=\"0\" rspace=\"0\">\u{2032}</mo>".to_owned(),
            "," => "<mo rspace=\"0.25em\">,</mo>".to_owned(),
            sign => format!("<mo>{}</mo>", escape(sign)),
        },
        Node::Space => "<mspace width=\"0.18em\"/>".to_owned(),
        Node::Group { open, close, body, .. } => {
            let stretchy = if body.iter().any(is_tall) { "" } else { " stretchy=\"false\"" };
            let fence = |sign: &str| match sign {
                "" => String::new(),
                sign => format!("<mo{stretchy}>{sign}</mo>"),
            };
            let inner: String = body.iter().map(render).collect();
            format!("<mrow>{}{inner}{}</mrow>", fence(open), fence(close))
        }
        Node::Row(nodes) => row(nodes),
        Node::Fraction(above, below) => format!("<mfrac>{}{}</mfrac>", row(above), row(below)),
        Node::Root(body) => format!("<msqrt>{}</msqrt>", row(body)),
        Node::Scripts { base, below, above } => scripts(base, below, above),
    }
}

/// Whether brackets around it must grow.
fn is_tall(node: &Node) -> bool {
    match node {
        Node::Fraction(..) | Node::Root(_) => true,
        Node::Group { body, .. } => body.iter().any(is_tall),
        Node::Scripts { base, .. } => is_tall(base),
        _ => false,
    }
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
