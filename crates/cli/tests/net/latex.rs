//! Whether LaTeX is well formed, read token by token: what TeX would refuse, and what it would
//! print as something else.

use std::collections::BTreeSet;

/// Commands for text alone.
const TEXT: &str =
    r"paragraph section subsection textbf texttt textit emph item hline caption label textwidth \";
/// Commands for mathematics alone.
const MATHEMATICS: &str = r"frac sqrt cos sin tan sec cosh sinh tanh ln exp max min left right langle rangle quad qquad
    dots ddot dot int sum cdot times pm mp le ge ne infty to Rightarrow mapsto in mathbb text mathrm operatorname bar
    overline tilde hat prime alpha beta gamma delta epsilon varepsilon zeta eta theta kappa lambda mu nu xi pi rho
    sigma tau phi varphi chi psi omega ell Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega , ; : ! | \";
/// Commands for both.
const BOTH: &str = "{ } _ % & # $ dots ldots quad qquad textbackslash textasciicircum textasciitilde textbar textless textgreater - , ^";
/// Environments of text, of mathematics, and those inside mathematics.
const ENVIRONMENTS: &str = "tabular longtable itemize enumerate description table verbatim";
const DISPLAYS: &str = "equation equation* align align* gather gather*";
const INNER: &str = "array pmatrix matrix cases aligned";

fn has(list: &str, name: &str) -> bool {
    list.split_whitespace().any(|item| item == name)
}

/// Where the reader is.
#[derive(Clone, Debug, PartialEq)]
struct Place {
    /// What ends it.
    end: String,
    math: bool,
    /// Letters are words here, not products of symbols.
    roman: bool,
    /// A superscript and a subscript that the last symbol has.
    scripts: [bool; 2],
    /// The next symbol is a script.
    is_script: bool,
}

struct Reader<'a> {
    rest: &'a str,
    places: Vec<Place>,
    /// The group that follows a command is text, or upright.
    next_group: Option<(bool, bool)>,
    found: BTreeSet<String>,
}

/// What is wrong with a piece of LaTeX.
pub fn defects(text: &str) -> BTreeSet<String> {
    let place = Place {
        end: String::new(),
        math: false,
        roman: false,
        scripts: [false; 2],
        is_script: false,
    };
    let mut reader =
        Reader { rest: text, places: vec![place], next_group: None, found: BTreeSet::new() };
    while let Some(c) = reader.rest.chars().next() {
        reader.rest = &reader.rest[c.len_utf8()..];
        reader.token(c);
    }
    for place in &reader.places[1..] {
        reader.found.insert(format!("no {} at the end", place.end));
    }
    reader.found
}

impl Reader<'_> {
    fn place(&mut self) -> &mut Place {
        self.places.last_mut().unwrap()
    }

    fn math(&self) -> bool {
        self.places.last().unwrap().math
    }

    fn say(&mut self, what: impl Into<String>) {
        self.found.insert(what.into());
    }

    fn token(&mut self, c: char) {
        match c {
            '\\' => self.command(),
            '{' => self.group(),
            '}' => self.close("}"),
            '$' => self.dollar(),
            '^' | '_' => self.script(c),
            '\'' if self.math() => self.prime(),
            '%' => self.say("% hides the rest of the line"),
            '#' => self.say("bare #"),
            '&' if !self.in_table() => self.say("& outside a table"),
            '<' | '>' | '|' | '~' if !self.math() => {
                self.say(format!("{c} in text is another sign"))
            }
            '\n' if self.math() && self.rest.starts_with('\n') => {
                self.say("empty line in a formula")
            }
            c if c.is_whitespace() => {}
            c if !c.is_ascii() => self.say(format!("{c} is not ASCII")),
            c => self.symbol(c),
        }
    }

    /// A symbol takes the place of the last one, or is its script.
    fn atom(&mut self) {
        let place = self.place();
        if !std::mem::take(&mut place.is_script) {
            place.scripts = [false; 2];
        }
    }

    fn symbol(&mut self, c: char) {
        self.atom();
        if c.is_ascii_alphabetic() && self.math() {
            let end = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
            let word = format!("{c}{}", &self.rest[..end]);
            if word.len() > 2 && !self.place().roman {
                self.say(format!("{word} is a product of letters"));
            }
            self.rest = &self.rest[end..];
        }
    }

    fn script(&mut self, c: char) {
        if !self.math() {
            return self.say(format!("{c} outside a formula"));
        }
        let place = self.place();
        let twice = std::mem::replace(&mut place.scripts[usize::from(c == '_')], true);
        place.is_script = true;
        if twice {
            self.say(format!("double {c}"));
        }
    }

    /// A prime is a superscript, but may be followed by others of its kind and by one ^.
    fn prime(&mut self) {
        if self.place().scripts[0] {
            self.say("prime after ^");
        }
    }

    fn group(&mut self) {
        let (is_script, math, roman) = {
            let place = self.place();
            (place.is_script, place.math, place.roman)
        };
        if self.next_group.is_none() || is_script {
            self.atom();
        }
        let (math, roman) = self.next_group.take().unwrap_or((math, roman));
        self.open("}", math, roman);
    }

    fn open(&mut self, end: &str, math: bool, roman: bool) {
        let place = Place { end: end.into(), math, roman, scripts: [false; 2], is_script: false };
        self.places.push(place);
    }

    fn close(&mut self, end: &str) {
        if self.places.last().is_some_and(|place| place.end == end) {
            self.places.pop();
        } else {
            let wanted = self.place().end.clone();
            self.say(format!("{end} where {wanted:?} is open"));
        }
    }

    fn dollar(&mut self) {
        let double = self.place().end != "$" && self.rest.starts_with('$');
        if double {
            self.rest = &self.rest[1..];
        }
        let end = if double { "$$" } else { "$" };
        if self.place().end == end {
            self.places.pop();
        } else if self.math() {
            self.say(format!("{end} in a formula"));
        } else {
            self.open(end, true, false);
        }
    }

    fn in_table(&self) -> bool {
        let is_table = |name: &str| has("tabular longtable align align*", name) || has(INNER, name);
        self.places.iter().any(|place| is_table(&place.end))
    }

    fn command(&mut self) {
        let letters = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        let first = self.rest.chars().next().map_or(0, char::len_utf8);
        let (name, rest) = self.rest.split_at(letters.max(first));
        self.rest = rest;
        let math = self.math();
        match name {
            "[" | "(" if math => self.say(format!("\\{name} in a formula")),
            "[" => self.open("\\]", true, false),
            "(" => self.open("\\)", true, false),
            "]" | ")" => self.close(&format!("\\{name}")),
            "begin" | "end" => self.environment(name == "begin"),
            "\\" if !self.in_table() => self.say("\\\\ outside a table"),
            "^" | "~" => self.accent(name),
            _ if has(BOTH, name) => {}
            _ if has(MATHEMATICS, name) && math => {}
            _ if has(TEXT, name) && !math => {}
            _ if has(MATHEMATICS, name) => self.say(format!("\\{name} outside a formula")),
            _ if has(TEXT, name) => self.say(format!("\\{name} in a formula")),
            _ => self.say(format!("unknown command \\{name}")),
        }
        // A command that takes a group is one symbol with it; its scripts belong to the group.
        self.atom();
        self.next_group = match name {
            "text" => Some((false, false)),
            "mathrm" | "operatorname" | "mathbb" => Some((true, true)),
            _ => None,
        };
    }

    /// An accent needs a letter or a group: before a sign it goes over the wrong one.
    fn accent(&mut self, name: &str) {
        if self.math() {
            self.say(format!("\\{name} in a formula"));
        }
        if !self.rest.starts_with("{}") {
            self.say(format!("\\{name} is an accent on what follows"));
        }
    }

    fn environment(&mut self, begins: bool) {
        let Some((name, rest)) = self.rest.strip_prefix('{').and_then(|rest| rest.split_once('}'))
        else {
            return self.say("\\begin or \\end without a name");
        };
        self.rest = rest;
        if !begins {
            return self.close(name);
        }
        let math = has(DISPLAYS, name) || has(INNER, name);
        if !math && !has(ENVIRONMENTS, name) {
            self.say(format!("unknown environment {name}"));
        }
        if self.math() != has(INNER, name) {
            self.say(format!("{name} in the wrong place"));
        }
        if has("tabular longtable array", name) {
            self.columns();
        }
        if name == "verbatim" {
            let end = self.rest.find("\\end{verbatim}").unwrap_or(self.rest.len());
            self.rest = &self.rest[end..];
        }
        self.open(name, math, false);
    }

    /// Passes over the columns of a table.
    fn columns(&mut self) {
        let mut depth = 0_usize;
        let ends = |c| {
            match c {
                '{' => depth += 1,
                '}' => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0
        };
        match self.rest.find(ends) {
            Some(end) if self.rest.starts_with('{') => self.rest = &self.rest[end + 1..],
            _ => self.say("a table without columns"),
        }
    }
}

#[test]
fn what_is_well_formed_passes() {
    for good in [
        r"Text with $x_1^{2}$$y$ and \[ \ddot{x} + x = \frac{1}{2}\cos 3\tau \]",
        r"\begin{tabular}{p{0.2\textwidth}l} a & $b$ \\ \end{tabular} 3\% a\_b",
        r"\[ x_{1}'' + x_1'^2 + \text{at rest, 100 of them} + \operatorname{sign} x^{a^{b}} \]",
        r"\[ \begin{aligned} a &= b \\ c &= d \end{aligned} \] x\^{}2",
        "\\begin{verbatim}\nx^2 % no $ comment\n\\end{verbatim}",
    ] {
        assert_eq!(defects(good), BTreeSet::new(), "{good}");
    }
}

#[test]
fn every_kind_of_defect_is_found() {
    for (bad, what) in [
        ("x^2", "^ outside a formula"),
        ("a_b", "_ outside a formula"),
        ("99% of", "% hides the rest of the line"),
        ("$x", "no $ at the end"),
        (r"\[ x", r"no \] at the end"),
        ("{a", "no } at the end"),
        ("a}", "} where \"\" is open"),
        (r"\[ $x$ \]", "$ in a formula"),
        (r"\frobnicate", r"unknown command \frobnicate"),
        (r"\frac{1}{2}", r"\frac outside a formula"),
        (r"$\paragraph{x}$", r"\paragraph in a formula"),
        ("$x^a^b$", "double ^"),
        ("$x^{a}'$", "prime after ^"),
        ("$x_a_b$", "double _"),
        ("$sqrt x$", "sqrt is a product of letters"),
        ("a & b", "& outside a table"),
        ("a < b", "< in text is another sign"),
        ("\u{3b5}", "\u{3b5} is not ASCII"),
        ("\\[ a\n\nb \\]", "empty line in a formula"),
        (r"a \\ b", r"\\ outside a table"),
        (r"\begin{frob}\end{frob}", "unknown environment frob"),
        (r"x\^2", r"\^ is an accent on what follows"),
        (r"\begin{tabular} a \end{tabular}", "a table without columns"),
    ] {
        assert!(defects(bad).contains(what), "{bad}: {:?}", defects(bad));
    }
}
