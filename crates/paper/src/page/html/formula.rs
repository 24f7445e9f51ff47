//! The structure of a formula: fractions, roots, indices and brackets.

use super::fraction::push_fraction;
use super::names::{Name, name, operator};
use super::node::Node;
use super::tokens::{Kind, Token};

struct Parser<'t, 'a> {
    tokens: &'t [Token<'a>],
    at: usize,
}

/// Reads a formula; everything is shown, whatever it is.
pub fn parse(tokens: &[Token<'_>]) -> Vec<Node> {
    let mut parser = Parser { tokens, at: 0 };
    let mut nodes = Vec::new();
    while parser.at < tokens.len() {
        nodes.extend(parser.sequence(None));
        // A bracket that was never opened.
        if let Some(token) = parser.next() {
            nodes.push(Node::Operator(token.text.to_owned(), false));
        }
    }
    nodes
}

fn closing(open: &str) -> Option<(&'static str, &'static str)> {
    match open {
        "(" => Some(("(", ")")),
        "[" => Some(("[", "]")),
        "{" => Some(("{", "}")),
        _ => None,
    }
}

impl<'t, 'a> Parser<'t, 'a> {
    fn peek(&self) -> Option<&'t Token<'a>> {
        self.tokens.get(self.at)
    }

    fn next(&mut self) -> Option<&'t Token<'a>> {
        self.at += 1;
        self.tokens.get(self.at - 1)
    }

    fn sees(&self, sign: &str) -> bool {
        self.peek().is_some_and(|token| token.is(sign))
    }

    /// Everything up to the closing bracket (not taken), or any closing bracket.
    fn sequence(&mut self, close: Option<&str>) -> Vec<Node> {
        let mut nodes: Vec<Node> = Vec::new();
        while let Some(token) = self.peek() {
            if [")", "]", "}"].iter().any(|sign| token.is(sign)) {
                let ours = close.is_none_or(|close| token.is(close));
                if ours || close.is_some() {
                    break;
                }
            }
            if token.is("/") && nodes.last().is_some_and(Node::is_factor) {
                self.at += 1;
                let below = self.factor();
                let above = nodes.pop().into_iter().collect();
                push_fraction(&mut nodes, above, below);
                continue;
            }
            let between = nodes.last().is_some_and(Node::is_factor);
            if token.is("*") {
                self.at += 1;
                let numbers = matches!(nodes.last(), Some(Node::Number(_)))
                    && self.peek().is_some_and(|t| t.kind == Kind::Number);
                nodes.push(if numbers {
                    Node::Operator("\u{b7}".into(), false)
                } else {
                    Node::Space
                });
                continue;
            }
            let spaced = token.spaced;
            let starts_factor = token.kind != Kind::Sign || closing(token.text).is_some();
            if between && starts_factor && spaced {
                nodes.push(Node::Space);
            }
            nodes.extend(self.factor());
        }
        nodes
    }

    /// A letter, number or bracket with its indices, powers and primes, or a sign; a function with
    /// the bracket that follows at once.
    fn factor(&mut self) -> Vec<Node> {
        let Some(token) = self.next() else { return Vec::new() };
        let mut applies = false;
        let base = match token.kind {
            Kind::Number => self.number(token.text),
            Kind::Word => {
                if let Some(sign) = operator(token.text) {
                    Node::Operator(sign.to_owned(), false)
                } else if token.text == "sqrt" {
                    Node::Root(self.argument())
                } else {
                    applies = true;
                    word(token.text, self.sees("/"), self.before_slash())
                }
            }
            Kind::Sign => match closing(token.text) {
                Some((open, close)) => self.group(open, close),
                None => return vec![sign(token.text)],
            },
        };
        let mut nodes = vec![self.scripts(base)];
        if applies && self.peek().is_some_and(|t| t.is("(") && !t.spaced) {
            self.at += 1;
            let group = self.group("(", ")");
            nodes.push(self.scripts(group));
        }
        // A factorial belongs to what stands before it: 1/3! is 1/(3!).
        if self.peek().is_some_and(|t| t.is("!") && !t.spaced) {
            self.at += 1;
            nodes.push(Node::Operator("!".to_owned(), false));
        }
        nodes
    }

    fn before_slash(&self) -> bool {
        self.at >= 2 && self.tokens.get(self.at - 2).is_some_and(|t| t.is("/"))
    }

    fn number(&self, text: &str) -> Node {
        let Some((digits, exponent)) = text.split_once('e') else {
            return Node::Number(text.to_owned());
        };
        let power = exponent.trim_start_matches('+').replace('-', "\u{2212}");
        let ten = Box::new(Node::Number(format!("{digits}\u{b7}10")));
        Node::Scripts { base: ten, below: Vec::new(), above: vec![Node::Number(power)] }
    }

    fn group(&mut self, open: &'static str, close: &'static str) -> Node {
        let start = self.at;
        let body = self.sequence(Some(close));
        let length: usize = self.tokens[start..self.at.min(self.tokens.len())]
            .iter()
            .map(|t| t.text.len() + 1)
            .sum();
        let closed = self.sees(close);
        if closed {
            self.at += 1;
        }
        Node::Group { open, close: if closed { close } else { "" }, body, length }
    }

    /// What a root or an index applies to: a bracket without the brackets, or one thing.
    fn argument(&mut self) -> Vec<Node> {
        for (open, close) in [("(", ")"), ("{", "}")] {
            if self.sees(open) {
                self.at += 1;
                if let Node::Group { body, .. } = self.group(open, close) {
                    return body;
                }
            }
        }
        let negative = self.sees("-") || self.sees("+");
        let mut nodes = Vec::new();
        if negative && let Some(token) = self.next() {
            nodes.push(sign(token.text));
            // x_+ with nothing else in the index.
            if self.peek().is_none_or(|t| t.spaced || t.kind == Kind::Sign) {
                return nodes;
            }
        }
        match self.next() {
            Some(token) if token.kind == Kind::Number => nodes.push(self.number(token.text)),
            Some(token) if token.kind == Kind::Word => nodes.push(word(token.text, false, false)),
            Some(token) => nodes.push(sign(token.text)),
            None => {}
        }
        nodes
    }

    fn scripts(&mut self, base: Node) -> Node {
        let (mut below, mut above) = (Vec::new(), Vec::new());
        let mut primes = Vec::new();
        while let Some(token) = self.peek().filter(|token| !token.spaced) {
            if token.is("'") {
                self.at += 1;
                primes.push(Node::Operator("\u{2032}".to_owned(), false));
            } else if token.is("_") {
                self.at += 1;
                below.extend(self.argument());
            } else if token.is("^") {
                self.at += 1;
                above.extend(self.argument());
            } else if token.is("*") && matches!(&base, Node::Letter(_)) && self.is_star() {
                // v* is the speed of the belt, b* a value of b.
                self.at += 1;
                below.push(Node::Operator("\u{2217}".to_owned(), false));
            } else {
                break;
            }
        }
        // The index of a name of its own (alpha0) comes before these. A prime stands high by itself.
        let base = match base {
            base if below.is_empty() && above.is_empty() => base,
            Node::Scripts { base, below: mut first, above: over } => {
                first.extend(below);
                Node::Scripts { base, below: first, above: [over, above].concat() }
            }
            base => Node::Scripts { base: Box::new(base), below, above },
        };
        if primes.is_empty() {
            return base;
        }
        primes.insert(0, base);
        Node::Row(primes)
    }

    /// A star that no factor follows at once.
    fn is_star(&self) -> bool {
        self.tokens
            .get(self.at + 1)
            .is_none_or(|t| t.spaced || (t.kind == Kind::Sign && closing(t.text).is_none()))
    }
}

/// A word; `over` and `under` tell that a slash follows or precedes: then dx is a differential.
fn word(text: &str, over: bool, under: bool) -> Node {
    let letter = |letter: &str| Node::Letter(letter.to_owned());
    match name(text) {
        Some(Name::Letter { letter: base, index: "" }) => letter(base),
        Some(Name::Letter { letter: base, index }) => {
            let index = if index.starts_with(|c: char| c.is_ascii_digit()) {
                Node::Number(index.to_owned())
            } else {
                letter(index)
            };
            Node::Scripts { base: Box::new(letter(base)), below: vec![index], above: Vec::new() }
        }
        Some(Name::Change(base)) if over || under => Node::Letter(format!("d{base}")),
        Some(Name::Change(base)) => Node::Letter(format!("\u{3b4}{base}")),
        Some(Name::Function(text)) => Node::Upright(text.to_owned()),
        // A short word in a formula is a product (2kx) or a differential (dt).
        None if text.len() == 2 => letter(text),
        None => match text.strip_prefix('d').and_then(name) {
            Some(Name::Letter { letter: base, index: "" }) => Node::Letter(format!("d{base}")),
            _ => Node::Upright(text.to_owned()),
        },
    }
}

fn sign(text: &str) -> Node {
    let (shown, breaks) = match text {
        "-" => ("\u{2212}", true),
        "+" | "=" | "<" | ">" => (text, true),
        "+-" => ("\u{b1}", true),
        "-+" => ("\u{2213}", true),
        "<=" => ("\u{2264}", true),
        ">=" => ("\u{2265}", true),
        "!=" => ("\u{2260}", true),
        "->" => ("\u{2192}", true),
        "..." => ("\u{2026}", false),
        other => (other, false),
    };
    Node::Operator(shown.to_owned(), breaks)
}
