//! The linear notation of the paper's formulas, `x'' + x^3/6 = eps sin t`, as LaTeX. Everything is shown,
//! whatever it is: a bracket that the print forgot stays forgotten.

/// What a token is, and what a piece is for those beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A letter or a word: as a piece a letter with its indices.
    Word,
    /// A decimal number, with its exponent.
    Number,
    /// A sign, or several that belong together.
    Sign,
    /// A function or another upright word.
    Upright,
    /// Something in brackets.
    Group,
    /// The space between two factors.
    Space,
    /// A fraction, a root.
    Tall,
}

/// A token with its place.
#[derive(Clone, Copy, Debug)]
struct Token<'a> {
    kind: Kind,
    text: &'a str,
    /// Whether a space stands before it.
    spaced: bool,
}

/// A part of a formula as it is set.
#[derive(Clone, Debug)]
struct Piece {
    latex: String,
    kind: Kind,
    /// How many marks wide it is, about.
    width: usize,
    /// Whether brackets around it must grow.
    tall: bool,
    /// What stands between round brackets, if it is such a pair.
    inside: Option<String>,
}

/// Signs of several characters, and signs that LaTeX writes otherwise.
const SIGNS: [(&str, &str); 16] = [
    ("...", r"\ldots "),
    ("->", r"\to "),
    ("<=", r"\le "),
    (">=", r"\ge "),
    ("!=", r"\ne "),
    ("+-", r"\pm "),
    ("-+", r"\mp "),
    ("{", r"\{"),
    ("}", r"\}"),
    ("%", r"\%"),
    ("&", r"\&"),
    ("#", r"\#"),
    ("^", r"\hat{\ }"),
    ("_", r"\_"),
    ("\\", r"\backslash "),
    ("\u{2014}", r"\text{\u{2014}}"),
];

const GREEK: [&str; 24] = [
    "alpha", "beta", "gamma", "delta", "eta", "theta", "kappa", "lambda", "mu", "xi", "pi", "rho",
    "sigma", "tau", "phi", "psi", "omega", "zeta", "nu", "Gamma", "Delta", "Lambda", "Sigma",
    "Omega",
];

const FUNCTIONS: [&str; 8] = ["cos", "sin", "tan", "cosh", "sinh", "tanh", "exp", "ln"];

/// Small changes of a letter, and delayed quantities: a letter with its index.
const PERTURBED: [&str; 6] = ["dC", "dD", "dT", "dphi", "dtau", "dx"];
const DELAYED: [&str; 2] = ["xT", "zT"];

/// Fractions with longer parts are written with a slash.
const LONG: usize = 26;

/// A formula as LaTeX.
pub(crate) fn latex(formula: &str) -> String {
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

/// Cuts a formula into tokens.
fn tokens(line: &str) -> Vec<Token<'_>> {
    let (mut list, mut rest) = (Vec::new(), line);
    loop {
        let trimmed = rest.trim_start();
        let Some(first) = trimmed.chars().next() else { return list };
        let spaced = trimmed.len() < rest.len();
        let (kind, length) = match first {
            'a'..='z' | 'A'..='Z' => {
                let end = trimmed.find(|c: char| !c.is_ascii_alphanumeric());
                (Kind::Word, end.unwrap_or(trimmed.len()))
            }
            '0'..='9' => (Kind::Number, number_length(trimmed)),
            first => {
                let known = SIGNS.iter().find(|(sign, _)| trimmed.starts_with(sign));
                (Kind::Sign, known.map_or(first.len_utf8(), |(sign, _)| sign.len()))
            }
        };
        let (text, tail) = trimmed.split_at(length);
        list.push(Token { kind, text, spaced });
        rest = tail;
    }
}

/// The length of the decimal number at the beginning.
fn number_length(rest: &str) -> usize {
    let digits = |from: usize| rest.bytes().skip(from).take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if rest[end..].starts_with('.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if rest[end..].starts_with('e') {
        let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        end += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    end
}

fn joined(pieces: &[Piece]) -> String {
    pieces.iter().map(|piece| piece.latex.as_str()).collect()
}

fn width(pieces: &[Piece]) -> usize {
    pieces.iter().map(|piece| piece.width).sum()
}

impl Piece {
    fn new(latex: impl Into<String>, kind: Kind, width: usize) -> Self {
        Self { latex: latex.into(), kind, width, tall: false, inside: None }
    }

    /// Whether it can be divided: neither sign nor space.
    fn is_factor(&self) -> bool {
        !matches!(self.kind, Kind::Sign | Kind::Space)
    }
}

fn sign(text: &str) -> Piece {
    let known = SIGNS.iter().find(|(sign, _)| *sign == text);
    Piece::new(known.map_or(text, |(_, latex)| latex), Kind::Sign, 1)
}

fn number(text: &str) -> Piece {
    let latex = match text.split_once('e') {
        Some((digits, power)) => format!(r"{digits}\cdot 10^{{{}}}", power.trim_start_matches('+')),
        None => text.to_owned(),
    };
    Piece::new(latex, Kind::Number, text.len())
}

/// The letter of a name without index.
fn letter(word: &str) -> Option<String> {
    match word {
        "eps" => Some(r"\varepsilon ".to_owned()),
        // O1, O2, ... are the names of orbits.
        "O" => None,
        word if word.len() == 1 => Some(word.to_owned()),
        word => GREEK.contains(&word).then(|| format!("\\{word} ")),
    }
}

/// A word with its own index; `divides` tells that a slash stands beside it: then dx is a differential.
fn word(text: &str, divides: bool) -> (Piece, String) {
    let upright = |latex: String| (Piece::new(latex, Kind::Upright, text.len()), String::new());
    let italic = |latex: String, index: &str| {
        (Piece::new(latex, Kind::Word, 1 + index.len()), index.to_owned())
    };
    if FUNCTIONS.contains(&text) {
        return upright(format!("\\{text} "));
    }
    let base = text.trim_end_matches(|c: char| c.is_ascii_digit());
    if let Some(base_letter) = letter(base) {
        return italic(base_letter, &text[base.len()..]);
    }
    if DELAYED.contains(&text) {
        return italic(text[..1].to_owned(), &text[1..]);
    }
    match text.strip_prefix('d').and_then(letter) {
        Some(of) if PERTURBED.contains(&text) && !divides => italic(format!(r"\delta {of}"), ""),
        Some(of) => italic(format!("d{of}"), ""),
        // A short word in a formula is a product (2kx).
        None if text.len() == 2 && base.len() == 2 => italic(text.to_owned(), ""),
        None if ["sech", "csch", "sgn"].contains(&text) => {
            upright(format!(r"\operatorname{{{text}}}"))
        }
        None => upright(format!(r"\text{{{text}}}")),
    }
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

/// A fraction of the last factor, or a quotient with a slash where a part is long.
fn divide(pieces: &mut Vec<Piece>, below: &[Piece]) {
    let mut from = pieces.len().saturating_sub(1);
    let is_group = |n: usize| pieces.get(n).is_some_and(|piece| piece.inside.is_some());
    if is_group(from) && from > 0 && pieces[from - 1].is_factor() {
        // What stands directly before a bracket is applied to it: z(t)/gamma.
        from -= 1;
    } else {
        from = numerator(pieces, from);
    }
    let above = pieces.split_off(from);
    if width(&above) > LONG || width(below) > LONG || below.is_empty() {
        pieces.extend(above);
        pieces.push(sign("/"));
        pieces.extend_from_slice(below);
        return;
    }
    let bare = |part: &[Piece]| match part {
        [Piece { inside: Some(inside), .. }] => inside.clone(),
        part => joined(part),
    };
    let latex = format!(r"\frac{{{}}}{{{}}}", bare(&above), bare(below));
    let fraction = Piece::new(latex, Kind::Tall, width(&above).max(width(below)));
    pieces.push(Piece { tall: true, ..fraction });
}

/// Where a numerator begins that takes in the letters and numbers before its last factor: 2 pi k/omega.
fn numerator(pieces: &[Piece], last: usize) -> usize {
    let is_plain = |n: usize| matches!(pieces[n].kind, Kind::Word | Kind::Number);
    let mut from = last;
    // 2a/b.
    if from > 0 && pieces[from - 1].kind == Kind::Number {
        from -= 1;
    }
    while from >= 2 && pieces[from - 1].kind == Kind::Space && is_plain(from - 2) {
        from -= 2;
    }
    // The argument of a function without brackets (cos 2 beta t/2) stays with it.
    let is_argument =
        from >= 2 && pieces[from - 1].kind == Kind::Space && pieces[from - 2].kind == Kind::Upright;
    if is_argument { last } else { from }
}

#[cfg(test)]
mod tests {
    use super::latex;
    use crate::Text;
    use lindstedt_report::{Format, mathml};

    /// A marked line as HTML.
    fn line(text: &str) -> String {
        Format::Html.line(&Text::from(text).line())
    }

    /// The text of a line of HTML, without its tags.
    fn bare(html: &str) -> String {
        let after =
            |part: &str| part.split_once('>').map_or(part.to_owned(), |(_, text)| text.to_owned());
        html.split('<').map(after).collect()
    }

    fn formulas(text: &str) -> usize {
        line(text).matches("<math>").count()
    }

    #[test]
    fn words_stay_words() {
        for text in [
            "no change of one place makes it hold",
            "neither sufficient (96 points are unstable) nor necessary",
            "the engine's law, sliding in both directions; a minute",
            "0-1 test of the series, 20000 polynomials",
            "close to 0.65 a very slight chaotic behaviour",
        ] {
            assert_eq!(formulas(text), 0, "{}", line(text));
            assert_eq!(bare(&line(text)), text);
        }
    }

    #[test]
    fn formulas_are_found() {
        for (text, count) in [
            ("$x'' + c x' + x + eps x^3 = 0$", 5),
            ("exact, as polynomials in $x$, $x'$, $x(t-T)$", 3),
            ("the printed root is imaginary for $omega > alpha$", 1),
            ("$a = 1$ and b = 2", 1),
        ] {
            assert_eq!(formulas(text), count, "{}", line(text));
        }
        let html = line("a bound, $omega^2 = sin 1$, holds");
        assert!(
            html.starts_with("a bound, <span class=\"g\"><math>")
                && html.ends_with("</span> holds"),
            "{html}"
        );
        assert!(html.contains("<msup><mi>\u{3c9}</mi><mrow><mn>2</mn></mrow></msup>"), "{html}");
    }

    #[test]
    fn structure() {
        for (text, expected) in [
            (
                "D = C/sin(2*beta*lambda)*(exp(beta*c) - cos(2*beta*lambda))",
                r"D=\frac{C}{\sin (2\,\beta \,\lambda )}\,(\exp (\beta \,c)-\cos (2\,\beta \,\lambda ))",
            ),
            ("b_0/b_2 < 1", r"\frac{b_{0}}{b_{2}}<1"),
            ("v* = 0.4", r"v_{\ast }=0.4"),
            ("R_r*v*sin(t)", r"R_{r}\,v\,\sin (t)"),
            ("z(t)/gamma = 2 pi k/omega", r"\frac{z(t)}{\gamma }=\frac{2\,\pi \,k}{\omega }"),
            ("dx'_+ = -R_r dx'_-", r"\delta x_{+}'=-R_{r}\,\delta x_{-}'"),
            ("da/dt - dx/dt", r"\frac{da}{dt}-\frac{dx}{dt}"),
            ("x = sqrt(2a/b)", r"x=\sqrt{\frac{2a}{b}}"),
            ("S = 1 - 1/3! + x^2/(2k+1)!", r"S=1-\frac{1}{3!}+\frac{x^{2}}{(2k+1)!}"),
            ("lambda = sqrt(alpha^2 - c^2/4)", r"\lambda =\sqrt{\alpha^{2}-\frac{c^{2}}{4}}"),
            ("alpha0 x_0'' T_(l+1)", r"\alpha_{0}\,x_{0}''\,T_{l+1}"),
            ("(a/b)^2 -> 6e-13", r"\left(\frac{a}{b}\right)^{2}\to 6\cdot 10^{-13}"),
        ] {
            assert_eq!(latex(text), expected, "{text}");
        }
    }

    /// Everything that is read can be drawn, with elements closed in the order in which they were opened.
    #[test]
    fn elements_are_nested() {
        for text in [
            "z'' + alpha^2 z = eps f",
            "sin phi = (-1/2*(R_r + 1)*[(R_r - 1)*cos(x) + R_r*exp(beta*c))/(F*omega)*v",
            "((( x ]]] ^ _ / * < & > \" ''' -> ... +- a_{b",
            "sum_{k>=1} (-1)^(k-1) sin(2kx)/k^2 - int_0^x ln|cos t| dt",
            "int {gamma v0(t - t0) cos(omega t) - ...} dt",
        ] {
            let drawn = mathml(&latex(text), false);
            assert!(drawn.is_ok(), "{text}: {drawn:?}");
        }
    }
}
