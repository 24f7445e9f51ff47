//! Printed formulas as trees: reading, brackets that were forgotten, writing.

use rug::Rational;

/// A formula as it is printed; nothing is reordered.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    Number(Rational),
    Symbol(String),
    Sum(Vec<Tree>),
    Product(Vec<Tree>),
    Negative(Box<Tree>),
    Inverse(Box<Tree>),
    Power(Box<Tree>, i32),
    Apply(String, Box<Tree>),
}

/// Reads a formula: + - * / ^ with integer exponents, names, functions of one argument, round and
/// square brackets; an equation is its left side less its right side. Nothing for what is none.
pub fn parse(text: &str) -> Option<Tree> {
    if let Some((left, right)) = text.split_once('=') {
        let right = Tree::Negative(Box::new(parse(right)?));
        return Some(Tree::Sum(vec![parse(left)?, right]));
    }
    let mut parser = Parser { rest: text };
    let tree = parser.sum()?;
    parser.rest.trim().is_empty().then_some(tree)
}

/// Every reading of a formula with one closing bracket too few, with what was inserted where.
pub fn completions(text: &str) -> Vec<(Tree, String)> {
    let count = |wanted: [char; 2]| text.chars().filter(|c| wanted.contains(c)).count();
    if count(['(', '[']) != count([')', ']']) + 1 {
        return Vec::new();
    }
    let missing = if count(['(', '\0']) > count([')', '\0']) { ')' } else { ']' };
    let mut found: Vec<(Tree, String)> = Vec::new();
    for (position, _) in text.char_indices().chain([(text.len(), ' ')]) {
        let (before, after) = text.split_at(position);
        if before.ends_with(char::is_whitespace) {
            continue;
        }
        if let Some(tree) = parse(&format!("{before}{missing}{after}"))
            && !found.iter().any(|(known, _)| *known == tree)
        {
            let from = before.char_indices().rev().nth(11).map_or(0, |(start, _)| start);
            let context = before.get(from..).unwrap_or(before).trim();
            found.push((tree, format!("the bracket closes after `{context}`")));
        }
    }
    found
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn eat(&mut self, wanted: char) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(wanted) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn word(&mut self, belongs: impl Fn(char) -> bool) -> &str {
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn sum(&mut self) -> Option<Tree> {
        let mut terms = Vec::new();
        let mut negative = self.eat('-');
        loop {
            let term = self.product()?;
            terms.push(if negative { Tree::Negative(Box::new(term)) } else { term });
            negative = self.eat('-');
            if !negative && !self.eat('+') {
                break;
            }
        }
        Some(if terms.len() == 1 { terms.remove(0) } else { Tree::Sum(terms) })
    }

    fn product(&mut self) -> Option<Tree> {
        let mut factors = vec![self.power()?];
        loop {
            if self.eat('*') {
                factors.push(self.power()?);
            } else if self.eat('/') {
                factors.push(Tree::Inverse(Box::new(self.power()?)));
            } else {
                break;
            }
        }
        Some(if factors.len() == 1 { factors.remove(0) } else { Tree::Product(factors) })
    }

    fn power(&mut self) -> Option<Tree> {
        let base = self.atom()?;
        if !self.eat('^') {
            return Some(base);
        }
        let negative = self.eat('-');
        let exponent: i32 = self.word(|c| c.is_ascii_digit()).parse().ok()?;
        Some(Tree::Power(Box::new(base), if negative { -exponent } else { exponent }))
    }

    fn atom(&mut self) -> Option<Tree> {
        for (open, close) in [('(', ')'), ('[', ']')] {
            if self.eat(open) {
                let inner = self.sum()?;
                return self.eat(close).then_some(inner);
            }
        }
        let digits = self.word(|c| c.is_ascii_digit());
        if !digits.is_empty() {
            return Some(Tree::Number(digits.parse().ok()?));
        }
        let name = self.word(|c| c.is_ascii_alphanumeric() || c == '_' || c == '\'').to_owned();
        if name.is_empty() {
            return None;
        }
        if self.rest.starts_with('(') {
            return Some(Tree::Apply(name, Box::new(self.atom()?)));
        }
        Some(Tree::Symbol(name))
    }
}

impl Tree {
    /// The formula as text.
    pub fn print(&self) -> String {
        match self {
            Self::Number(q) => q.to_string(),
            Self::Symbol(name) => name.clone(),
            Self::Sum(terms) => {
                let mut line = String::new();
                for (n, term) in terms.iter().enumerate() {
                    match term {
                        Self::Negative(inner) if n > 0 => {
                            line += &format!(" - {}", inner.in_product());
                        }
                        term if n > 0 => line += &format!(" + {}", term.print()),
                        term => line += &term.print(),
                    }
                }
                line
            }
            Self::Product(factors) => {
                let mut line = String::new();
                for (n, factor) in factors.iter().enumerate() {
                    match factor {
                        Self::Inverse(inner) if n > 0 => line += &format!("/{}", inner.as_factor()),
                        factor if n > 0 => line += &format!("*{}", factor.as_factor()),
                        factor => line += &factor.as_factor(),
                    }
                }
                line
            }
            Self::Negative(inner) => format!("-{}", inner.in_product()),
            Self::Inverse(inner) => format!("1/{}", inner.as_factor()),
            Self::Power(base, exponent) => format!("{}^{exponent}", base.as_factor()),
            Self::Apply(name, argument) => format!("{name}({})", argument.print()),
        }
    }

    fn in_product(&self) -> String {
        match self {
            Self::Sum(_) | Self::Negative(_) => format!("({})", self.print()),
            _ => self.print(),
        }
    }

    fn as_factor(&self) -> String {
        match self {
            Self::Sum(_) | Self::Negative(_) | Self::Product(_) | Self::Inverse(_) => {
                format!("({})", self.print())
            }
            _ => self.print(),
        }
    }

    /// The square, with roots removed: sqrt(x)^2 = x.
    pub fn squared(&self) -> Self {
        match self {
            Self::Apply(name, argument) if name == "sqrt" => (**argument).clone(),
            Self::Product(factors) => Self::Product(factors.iter().map(Self::squared).collect()),
            Self::Inverse(inner) => Self::Inverse(Box::new(inner.squared())),
            Self::Negative(inner) => inner.squared(),
            other => Self::Power(Box::new(other.clone()), 2),
        }
    }

    /// The parts of a node, in order.
    pub fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Number(_) | Self::Symbol(_) => Vec::new(),
            Self::Sum(list) | Self::Product(list) => list.iter().collect(),
            Self::Negative(inner)
            | Self::Inverse(inner)
            | Self::Power(inner, _)
            | Self::Apply(_, inner) => vec![inner],
        }
    }

    /// The node reached by a path of part numbers.
    pub fn at(&self, path: &[usize]) -> Option<&Self> {
        match path.split_first() {
            None => Some(self),
            Some((first, rest)) => self.parts().get(*first)?.at(rest),
        }
    }

    /// The formula with another node at the end of a path.
    #[must_use]
    pub fn with(&self, path: &[usize], node: Self) -> Self {
        let mut copy = self.clone();
        if let Some(place) = copy.at_mut(path) {
            *place = node;
        }
        copy
    }

    fn at_mut(&mut self, path: &[usize]) -> Option<&mut Self> {
        let Some((&first, rest)) = path.split_first() else { return Some(self) };
        let part = match self {
            Self::Number(_) | Self::Symbol(_) => None,
            Self::Sum(list) | Self::Product(list) => list.get_mut(first),
            Self::Negative(inner)
            | Self::Inverse(inner)
            | Self::Power(inner, _)
            | Self::Apply(_, inner) => (first == 0).then_some(&mut **inner),
        };
        part?.at_mut(rest)
    }

    /// The paths of all nodes, the node itself first.
    pub fn paths(&self) -> Vec<Vec<usize>> {
        let mut all = vec![Vec::new()];
        for (n, part) in self.parts().into_iter().enumerate() {
            for mut path in part.paths() {
                path.insert(0, n);
                all.push(path);
            }
        }
        all
    }
}
