//! From tokens to a tree, by recursive descent with a limited depth.
//!
//! ```text
//! equation = sum ["=" sum]
//! sum      = ["+" | "-"] product { ("+" | "-") product }
//! product  = signed { ("*" | "/") signed | power }        two neighbours are multiplied
//! signed   = { "+" | "-" } power
//! power    = operand [ "^" signed ]                        from the right
//! operand  = number | name | function | "(" sum ")" | "|" sum "|" | x [primes] [at]
//!          | "[" sum "]" [at]
//! at       = "(" t - delay ")"
//! ```

use crate::error::{Expectation, Limit, ParseError, ParseErrorKind, excerpt};
use crate::lexer::{Kind, Token, tokens};
use crate::names::{Names, is_parameter_name};
use crate::trees::{degree, multiply, negated, unordered};
use lindstedt_equation::Expression;
use rug::Rational;
use std::cmp::Ordering;
use std::ops::Range;

impl Names {
    /// The same with the unknowns of several equations: the names with primes, in the order in which their second derivatives
    /// occur, or their first ones of those that have no second.
    #[must_use]
    pub fn of_system<'a>(mut self, equations: impl IntoIterator<Item = &'a str>) -> Self {
        let all = equations.into_iter().filter_map(|text| tokens(text).ok());
        let all: Vec<Token> = all.flatten().collect();
        let primed = |pair: &[Token]| match pair {
            [Token { kind: Kind::Name(name), .. }, Token { kind: Kind::Primes(order), .. }] => {
                Some((*order > 1, name.clone()))
            }
            _ => None,
        };
        let (second, first): (Vec<_>, Vec<_>) =
            all.windows(2).filter_map(primed).partition(|(second, _)| *second);
        self.unknowns = Vec::new();
        for (_, name) in second.into_iter().chain(first) {
            if !self.unknowns.contains(&name) {
                self.unknowns.push(name);
            }
        }
        self
    }

    /// The same with the unknown of one equation: the only name with primes, which may be another than x where x does not
    /// occur, is declared nowhere, and means nothing else.
    #[must_use]
    pub fn of_one(self, equation: &str) -> Self {
        let list = tokens(equation).unwrap_or_default();
        let mentions_x = list.iter().any(|token| token.kind == Kind::Name("x".to_owned()));
        let named = self.clone().of_system([equation]);
        let declared = |name| self.parameters.as_ref().is_some_and(|list| list.contains(name));
        match &named.unknowns[..] {
            [only] if is_parameter_name(only) && *only != self.small => {
                if mentions_x || declared(only) { self } else { named }
            }
            _ => self,
        }
    }
}

/// Parentheses, powers and functions inside each other.
const DEEPEST: usize = 64;
/// The largest whole exponent, and the largest degree in x and x' that powers may lead to.
pub(crate) const LARGEST_EXPONENT: u64 = 1000;

pub(crate) type Parsed = Result<Expression, ParseError>;

pub(crate) struct Parser<'a> {
    text: &'a str,
    pub(crate) names: &'a Names,
    pub(crate) tokens: Vec<Token>,
    pub(crate) next: usize,
    depth: usize,
    /// Whether a `|` here closes.
    in_bars: bool,
    /// What is looked for, and where it was found first.
    wanted: Option<(&'a Expression, Option<Range<usize>>)>,
}

/// Parses an equation and moves its right side to the left; without `=` the right side is zero.
///
/// # Errors
/// [`ParseError`] with the position.
///
/// # Example
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_equation::print::Style;
/// use lindstedt_problem_file::{Names, parse_equation};
/// let equation = parse_equation("x'' + x = ε(1 - x²)x'", &Names::any("eps"))?;
/// assert_eq!(equation.print("eps", Style::Text), "x'' + x - eps*(1 - x^2)*x'");
/// # Ok::<(), lindstedt_problem_file::ParseError>(())
/// ```
pub fn parse_equation(text: &str, names: &Names) -> Parsed {
    Parser::new(text, names, None)?.equation()
}

/// Parses an expression: no `=`.
///
/// # Errors
/// [`ParseError`] with the position.
pub fn parse_expression(text: &str, names: &Names) -> Parsed {
    let mut parser = Parser::new(text, names, None)?;
    let expression = parser.sum()?;
    parser.end()?;
    Ok(expression)
}

/// Where a subexpression of the parsed equation stands in its text, up to a numerical factor and
/// the order of factors and terms; nothing if it is not found.
pub fn locate(text: &str, names: &Names, part: &Expression) -> Option<Range<usize>> {
    let part = unordered(part);
    let mut parser = Parser::new(text, names, Some(&part)).ok()?;
    parser.equation().ok()?;
    parser.wanted.and_then(|(_, found)| found)
}

impl<'a> Parser<'a> {
    fn new(
        text: &'a str,
        names: &'a Names,
        wanted: Option<&'a Expression>,
    ) -> Result<Self, ParseError> {
        let tokens = tokens(text)?;
        let wanted = wanted.map(|part| (part, None));
        Ok(Self { text, names, tokens, next: 0, depth: 0, in_bars: false, wanted })
    }

    fn equation(&mut self) -> Parsed {
        let left = self.sum()?.without_small_divisors();
        if !self.accept('=') {
            self.end()?;
            return Ok(left);
        }
        let right = self.sum()?.without_small_divisors();
        if self.sign() == Some('=') {
            return Err(self.error(ParseErrorKind::SecondEquality));
        }
        self.end()?;
        if right.as_number().is_some_and(|q| q.is_zero()) {
            return Ok(left);
        }
        let mut terms = left.terms().to_vec();
        terms.extend(right.terms().iter().cloned().map(negated));
        Ok(Expression::Sum(terms))
    }

    // Tokens.

    pub(crate) fn token(&self) -> &Token {
        // The last token is the end, which is never passed.
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    pub(crate) fn advance(&mut self) {
        self.next = (self.next + 1).min(self.tokens.len() - 1);
    }

    pub(crate) fn sign(&self) -> Option<char> {
        match self.token().kind {
            Kind::Sign(c) => Some(c),
            _ => None,
        }
    }

    pub(crate) fn accept(&mut self, c: char) -> bool {
        let found = self.sign() == Some(c);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn start(&self) -> usize {
        self.token().at.start
    }

    /// The end of the token before this one.
    pub(crate) fn behind(&self) -> usize {
        self.next.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(0, |t| t.at.end)
    }

    pub(crate) fn error(&self, kind: ParseErrorKind) -> ParseError {
        ParseError::new(kind, self.token().at.clone())
    }

    pub(crate) fn expected(&self, expected: Expectation) -> ParseError {
        let found = match &self.token().kind {
            Kind::End => "the end".to_owned(),
            _ => format!("`{}`", self.excerpt(self.token().at.clone())),
        };
        self.error(ParseErrorKind::Expected { expected, found })
    }

    pub(crate) fn excerpt(&self, at: Range<usize>) -> String {
        excerpt(self.text.get(at).unwrap_or_default())
    }

    pub(crate) fn close(&mut self, c: char) -> Result<(), ParseError> {
        if self.accept(c) { Ok(()) } else { Err(self.expected(Expectation::Closing(c))) }
    }

    fn end(&self) -> Result<(), ParseError> {
        if self.token().kind == Kind::End {
            Ok(())
        } else {
            Err(self.expected(Expectation::Operator))
        }
    }

    /// Runs a rule one level deeper.
    pub(crate) fn deeper(&mut self, rule: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth == DEEPEST {
            let kind = ParseErrorKind::TooLarge { what: Limit::Depth, limit: DEEPEST as u64 };
            return Err(self.error(kind));
        }
        self.depth += 1;
        let result = rule(self);
        self.depth -= 1;
        result
    }

    /// A sum between signs that open and close, where bars mean what they mean outside.
    pub(crate) fn enclosed(&mut self, close: char) -> Parsed {
        let before = std::mem::replace(&mut self.in_bars, close == '|');
        let inner = self.deeper(Self::sum)?;
        self.in_bars = before;
        self.close(close)?;
        Ok(inner)
    }

    /// Notes where the part that is looked for stands.
    pub(crate) fn seen(&mut self, expression: Expression, start: usize) -> Expression {
        let end = self.behind();
        if let Some((part, found @ None)) = &mut self.wanted
            && unordered(&expression) == **part
        {
            *found = Some(start..end);
        }
        expression
    }

    // Rules.

    pub(crate) fn sum(&mut self) -> Parsed {
        let start = self.start();
        let mut terms = Vec::new();
        let mut negative = self.leading_sign();
        loop {
            let from = self.start();
            let term = self.product()?;
            let term = if negative { negated(term) } else { term };
            let term = self.seen(term, from);
            match term {
                // Addition is flat, as the operators of the tree have it.
                Expression::Sum(inner) if !negative => terms.extend(inner),
                other => terms.push(other),
            }
            if !matches!(self.sign(), Some('+' | '-')) {
                break;
            }
            negative = self.leading_sign();
        }
        let sum = if terms.len() == 1 { terms.remove(0) } else { Expression::Sum(terms) };
        Ok(self.seen(sum, start))
    }

    /// Signs in front: whether they make a minus.
    fn leading_sign(&mut self) -> bool {
        let mut negative = false;
        while let Some(c @ ('+' | '-')) = self.sign() {
            negative ^= c == '-';
            self.advance();
        }
        negative
    }

    fn product(&mut self) -> Parsed {
        let start = self.start();
        let first = self.power()?;
        let mut factors = match first {
            Expression::Product(factors) => factors,
            single => vec![single],
        };
        // The divisor, if the last operation was a division: 1/2x and a/b c have two readings.
        let mut divisor: Option<Expression> = None;
        loop {
            match self.sign() {
                Some('*') => {
                    self.advance();
                    let factor = self.signed()?;
                    multiply(&mut factors, factor);
                    divisor = None;
                }
                Some('/') => {
                    self.advance();
                    let at = self.start();
                    let by = self.signed()?;
                    self.divide(&mut factors, &by, at)?;
                    divisor = Some(by);
                }
                _ if self.operand_follows() => {
                    self.check_neighbour(divisor.as_ref(), start)?;
                    let factor = self.power()?;
                    multiply(&mut factors, factor);
                    divisor = None;
                }
                _ => break,
            }
        }
        let single = factors.len() == 1;
        let product = if single { factors.remove(0) } else { Expression::Product(factors) };
        Ok(self.seen(product, start))
    }

    fn divide(
        &self,
        factors: &mut Vec<Expression>,
        by: &Expression,
        at: usize,
    ) -> Result<(), ParseError> {
        let number = by.as_number();
        if number.as_ref().is_some_and(Rational::is_zero) {
            return Err(ParseError::new(ParseErrorKind::DivisionByZero, at..self.behind()));
        }
        match (factors.last_mut(), by) {
            // 1/3 is a number.
            (Some(Expression::Number(q)), Expression::Number(by)) => *q /= by,
            (_, Expression::Number(by)) => {
                factors.push(Expression::Number(Rational::from(by.recip_ref())));
            }
            _ => factors.push(by.clone().pow(-1)),
        }
        Ok(())
    }

    pub(crate) fn operand_follows(&self) -> bool {
        match &self.token().kind {
            Kind::Number(_) | Kind::Name(_) => true,
            Kind::Sign('|') => !self.in_bars,
            Kind::Sign(c) => matches!(c, '(' | '['),
            _ => false,
        }
    }

    /// Whether multiplication without a sign is clear here.
    fn check_neighbour(
        &self,
        divisor: Option<&Expression>,
        start: usize,
    ) -> Result<(), ParseError> {
        let token = self.token();
        if matches!(token.kind, Kind::Number(_)) {
            return Err(self.expected(Expectation::Operator));
        }
        let number = matches!(divisor, Some(Expression::Number(_)));
        if divisor.is_some() && !(number && token.spaced) {
            let found = self.excerpt(start..token.at.end);
            let instead = "a/b*c or a/(b*c)".to_owned();
            return Err(self.error(ParseErrorKind::Ambiguous { found, instead }));
        }
        // (x^2 - 1)(t - T): a delay or a product?
        let tokens = self.tokens.get(self.next..).unwrap_or_default();
        if let [open, time, then, ..] = tokens
            && open.kind == Kind::Sign('(')
            && time.kind == Kind::Name("t".into())
            && matches!(then.kind, Kind::Sign('-' | '+' | ')'))
        {
            let found = self.excerpt(start..then.at.end);
            let instead = "[...](t - T) for a delay, (...)*(t - T) for a product".to_owned();
            return Err(self.error(ParseErrorKind::Ambiguous { found, instead }));
        }
        Ok(())
    }

    fn signed(&mut self) -> Parsed {
        let negative = self.leading_sign();
        let power = self.power()?;
        Ok(if negative { negated(power) } else { power })
    }

    fn power(&mut self) -> Parsed {
        let start = self.start();
        let base = self.operand()?;
        let base = self.seen(base, start);
        let exponent = match &self.token().kind {
            Kind::Superscript(n) => {
                let n = Expression::Number(n.clone());
                self.advance();
                if matches!(self.token().kind, Kind::Sign('^') | Kind::Superscript(_)) {
                    let found = self.excerpt(start..self.token().at.end);
                    let instead = "(x^2)^3 or x^(2^3)".to_owned();
                    return Err(self.error(ParseErrorKind::Ambiguous { found, instead }));
                }
                n
            }
            Kind::Sign('^') => {
                self.advance();
                self.deeper(Self::signed)?
            }
            _ => return Ok(base),
        };
        let power = base.pow(exponent);
        self.check_power(&power, start)?;
        Ok(self.seen(power, start))
    }

    /// Limits of numbers and degrees, and 0^(-n).
    fn check_power(&self, power: &Expression, start: usize) -> Result<(), ParseError> {
        let Expression::Power(base, exponent) = power else { return Ok(()) };
        let Some(n) = exponent.as_number() else { return Ok(()) };
        let at = start..self.behind();
        let steep = Rational::from(n.abs_ref()) > LARGEST_EXPONENT;
        if n.cmp0() == Ordering::Less && base.as_number().is_some_and(|q| q.is_zero()) {
            return Err(ParseError::new(ParseErrorKind::DivisionByZero, at));
        }
        let n = n.to_f64().abs();
        // A number that canonical() does not form is too long; degrees multiply.
        let long = base.as_number().is_some() && n.fract() == 0.0 && power.as_number().is_none();
        if steep || long || degree(base) * n > LARGEST_EXPONENT as f64 {
            let kind = ParseErrorKind::TooLarge { what: Limit::Exponent, limit: LARGEST_EXPONENT };
            return Err(ParseError::new(kind, at));
        }
        Ok(())
    }
}
