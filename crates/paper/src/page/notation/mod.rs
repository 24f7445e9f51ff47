//! The linear notation of the paper's formulas, `x'' + x^3/6 = eps sin t`, as LaTeX. Everything is shown,
//! whatever it is: a bracket that the print forgot stays forgotten.

mod pieces;
mod tokens;

use pieces::{LONG, Piece, divide, joined, number, sign, width, word};
use tokens::{Kind, Token, tokens};

/// A formula as LaTeX.
pub fn latex(formula: &str) -> String {
    let tokens = tokens(formula);
    let mut parser = Parser { tokens: &tokens, at: 0 };
    let mut latex = String::new();
    while parser.at < tokens.len() {
        latex += &joined(&parser.sequence(None));
        // A bracket that was never opened.
        latex += &parser.next().map(|token| sign(token.text).latex).unwrap_or_default();
    }
    latex
}

/// The bracket that closes another, with both in LaTeX.
fn closing(open: &str) -> Option<(&'static str, [&'static str; 2])> {
    match open {
        "(" => Some((")", ["(", ")"])),
        "[" => Some(("]", ["[", "]"])),
        "{" => Some(("}", [r"\{", r"\}"])),
        _ => None,
    }
}

struct Parser<'t, 'a> {
    tokens: &'t [Token<'a>],
    at: usize,
}

impl<'a> Parser<'_, 'a> {
    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).copied()
    }

    fn next(&mut self) -> Option<Token<'a>> {
        self.at += 1;
        self.tokens.get(self.at - 1).copied()
    }

    /// Whether this sign follows, at once or not.
    fn sees(&self, sign: &str) -> bool {
        self.peek().is_some_and(|token| token.text == sign)
    }

    /// Whether this sign follows at once; takes it then.
    fn takes(&mut self, sign: &str) -> bool {
        let found = self.peek().is_some_and(|token| token.text == sign && !token.spaced);
        self.at += usize::from(found);
        found
    }

    /// Everything up to the closing bracket (not taken), or any closing bracket.
    fn sequence(&mut self, close: Option<&str>) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        while let Some(token) = self.peek() {
            if [")", "]", "}"].contains(&token.text)
                && (close.is_some() || close.is_none_or(|close| token.text == close))
            {
                break;
            }
            let after_factor = pieces.last().is_some_and(Piece::is_factor);
            if token.text == "/" && after_factor {
                self.at += 1;
                let below = self.factor();
                divide(&mut pieces, &below);
                continue;
            }
            let space = |pieces: &[Piece]| {
                let applied = pieces.last().is_some_and(|piece| piece.kind == Kind::Upright);
                Piece::new(if applied { "" } else { r"\," }, Kind::Space, 1)
            };
            if token.text == "*" {
                self.at += 1;
                let numbers = pieces.last().is_some_and(|piece| piece.kind == Kind::Number)
                    && self.peek().is_some_and(|token| token.kind == Kind::Number);
                let product = Piece::new(r"\cdot ", Kind::Sign, 1);
                pieces.push(if numbers { product } else { space(&pieces) });
                continue;
            }
            let starts = token.kind != Kind::Sign || closing(token.text).is_some();
            if after_factor && starts && token.spaced {
                pieces.push(space(&pieces));
            }
            pieces.extend(self.factor());
        }
        pieces
    }

    /// A letter, number or bracket with its indices, powers and primes, or a sign; a function with
    /// the bracket that follows at once.
    fn factor(&mut self) -> Vec<Piece> {
        let divided = self.at > 0 && self.tokens.get(self.at - 1).is_some_and(|t| t.text == "/");
        let Some(token) = self.next() else { return Vec::new() };
        let mut pieces = match (token.kind, token.text) {
            (Kind::Number, text) => vec![self.scripts(number(text), String::new())],
            (_, "sum" | "int") => {
                let operator = Piece::new(format!("\\{} ", token.text), Kind::Sign, 1);
                vec![self.scripts(operator, String::new())]
            }
            (_, "sqrt") => {
                let body = self.argument();
                let root = Piece::new(
                    format!(r"\sqrt{{{}}}", joined(&body)),
                    Kind::Tall,
                    1 + width(&body),
                );
                vec![self.scripts(Piece { tall: true, ..root }, String::new())]
            }
            (Kind::Word, text) => {
                let (piece, index) = word(text, divided || self.sees("/"));
                let mut pieces = vec![self.scripts(piece, index)];
                if self.takes("(") {
                    let argument = self.group("(");
                    pieces.push(self.scripts(argument, String::new()));
                }
                pieces
            }
            (_, text) if closing(text).is_some() => {
                let group = self.group(text);
                vec![self.scripts(group, String::new())]
            }
            (_, text) => return vec![sign(text)],
        };
        // A factorial belongs to what stands before it: 1/3! is 1/(3!).
        if self.takes("!") {
            pieces.push(sign("!"));
        }
        pieces
    }

    /// What stands in brackets whose opening one was taken; one that is not closed stays so.
    fn group(&mut self, open: &str) -> Piece {
        let Some((close, [left, right])) = closing(open) else { return sign(open) };
        let body = self.sequence(Some(close));
        let closed = self.sees(close);
        self.at += usize::from(closed);
        let (inside, width) = (joined(&body), 2 + width(&body));
        let tall = body.iter().any(|piece| piece.tall);
        // A long bracket is set in pieces that can stand on different lines.
        let latex = match (closed, tall && width <= LONG) {
            (true, true) => format!(r"\left{left}{inside}\right{right}"),
            (true, false) => format!("{left}{inside}{right}"),
            (false, _) => format!("{left}{inside}"),
        };
        let inside = (closed && open == "(").then_some(inside);
        Piece { tall, inside, ..Piece::new(latex, Kind::Group, width) }
    }

    /// What a root or an index applies to: a bracket without the brackets, or one thing.
    fn argument(&mut self) -> Vec<Piece> {
        if self.sees("(") || self.sees("{") {
            let open = self.next().map_or("(", |token| token.text);
            let close = if open == "(" { ")" } else { "}" };
            let body = self.sequence(Some(close));
            self.at += usize::from(self.sees(close));
            return body;
        }
        let mut pieces = Vec::new();
        if self.sees("-") || self.sees("+") {
            pieces.extend(self.next().map(|token| sign(token.text)));
            // x_+ with nothing else in the index.
            if self.peek().is_none_or(|token| token.spaced || token.kind == Kind::Sign) {
                return pieces;
            }
        }
        pieces.extend(self.next().map(|token| match token.kind {
            Kind::Number => number(token.text),
            Kind::Word => indexed(word(token.text, false)),
            _ => sign(token.text),
        }));
        pieces
    }

    /// The piece with what follows at once: primes, indices after its own, powers.
    fn scripts(&mut self, base: Piece, index: String) -> Piece {
        let (mut below, mut above, mut primes) = (index, String::new(), String::new());
        let mut wide = 0;
        loop {
            if self.takes("'") {
                primes.push('\'');
            } else if self.takes("_") {
                let argument = self.argument();
                wide = width(&argument);
                below += &joined(&argument);
            } else if self.takes("^") {
                let argument = self.argument();
                wide = width(&argument).max(wide);
                above += &joined(&argument);
            } else if base.kind == Kind::Word && self.is_star() {
                // v* is the speed of the belt, b* a value of b.
                self.at += 1;
                below += r"\ast ";
            } else {
                break;
            }
        }
        let script = |mark: &str, text: &str| match text {
            "" => String::new(),
            text => format!("{mark}{{{text}}}"),
        };
        let scripts = script("_", &below) + &primes + &script("^", &above);
        let inside = base.inside.filter(|_| scripts.is_empty());
        let latex = base.latex.trim_end().to_owned() + &scripts;
        // A command ends where a letter begins.
        let latex = if scripts.is_empty() { base.latex } else { latex };
        Piece { latex, inside, width: base.width + primes.len() + wide, ..base }
    }

    /// A star at once that no factor follows at once.
    fn is_star(&self) -> bool {
        let next = self.tokens.get(self.at + 1);
        self.peek().is_some_and(|token| token.text == "*" && !token.spaced)
            && next.is_none_or(|t| t.spaced || (t.kind == Kind::Sign && closing(t.text).is_none()))
    }
}

/// A word with its own index alone.
fn indexed((piece, index): (Piece, String)) -> Piece {
    Parser { tokens: &[], at: 0 }.scripts(piece, index)
}
