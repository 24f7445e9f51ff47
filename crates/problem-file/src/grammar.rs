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
use crate::names::{Names, foreign, function, is_parameter_name};
use crate::taylor::taylor;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use rug::Rational;
use std::cmp::Ordering;
use std::ops::Range;

/// Parentheses, powers and functions inside each other.
const DEEPEST: usize = 64;
/// The largest whole exponent, and the largest degree in x and x' that powers may lead to.
const LARGEST_EXPONENT: u64 = 1000;

type Parsed = Result<Expression, ParseError>;

pub(crate) struct Parser<'a> {
    text: &'a str,
    names: &'a Names,
    tokens: Vec<Token>,
    next: usize,
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
        let left = self.sum()?;
        if !self.accept('=') {
            self.end()?;
            return Ok(left);
        }
        let right = self.sum()?;
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

    fn token(&self) -> &Token {
        // The last token is the end, which is never passed.
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    fn advance(&mut self) {
        self.next = (self.next + 1).min(self.tokens.len() - 1);
    }

    fn sign(&self) -> Option<char> {
        match self.token().kind {
            Kind::Sign(c) => Some(c),
            _ => None,
        }
    }

    fn accept(&mut self, c: char) -> bool {
        let found = self.sign() == Some(c);
        if found {
            self.advance();
        }
        found
    }

    fn start(&self) -> usize {
        self.token().at.start
    }

    /// The end of the token before this one.
    fn behind(&self) -> usize {
        self.next.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(0, |t| t.at.end)
    }

    fn error(&self, kind: ParseErrorKind) -> ParseError {
        ParseError::new(kind, self.token().at.clone())
    }

    fn expected(&self, expected: Expectation) -> ParseError {
        let found = match &self.token().kind {
            Kind::End => "the end".to_owned(),
            _ => format!("`{}`", self.excerpt(self.token().at.clone())),
        };
        self.error(ParseErrorKind::Expected { expected, found })
    }

    fn excerpt(&self, at: Range<usize>) -> String {
        excerpt(self.text.get(at).unwrap_or_default())
    }

    fn close(&mut self, c: char) -> Result<(), ParseError> {
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
    fn deeper(&mut self, rule: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
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
    fn enclosed(&mut self, close: char) -> Parsed {
        let before = std::mem::replace(&mut self.in_bars, close == '|');
        let inner = self.deeper(Self::sum)?;
        self.in_bars = before;
        self.close(close)?;
        Ok(inner)
    }

    /// Notes where the part that is looked for stands.
    fn seen(&mut self, expression: Expression, start: usize) -> Expression {
        let end = self.behind();
        if let Some((part, found @ None)) = &mut self.wanted
            && unordered(&expression) == **part
        {
            *found = Some(start..end);
        }
        expression
    }

    // Rules.

    fn sum(&mut self) -> Parsed {
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

    fn operand_follows(&self) -> bool {
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

    fn operand(&mut self) -> Parsed {
        let token = self.token().clone();
        match token.kind {
            Kind::Number(q) => {
                self.advance();
                Ok(Expression::Number(q))
            }
            Kind::Name(name) => {
                self.advance();
                self.name(&name, &token.at)
            }
            Kind::Sign('(') => {
                self.advance();
                self.enclosed(')')
            }
            Kind::Sign('|') => {
                self.advance();
                Ok(self.enclosed('|')?.apply(Function::Abs))
            }
            Kind::Sign('[') => {
                self.advance();
                let inner = self.enclosed(']')?;
                self.at_a_time(inner, token.at.start)
            }
            _ => Err(self.expected(Expectation::Operand)),
        }
    }

    fn name(&mut self, name: &str, at: &Range<usize>) -> Parsed {
        if let Kind::Primes(order) = self.token().kind {
            if name != "x" {
                let kind = ParseErrorKind::NotDifferentiable { name: excerpt(name) };
                return Err(self.error(kind));
            }
            let derivative = match order {
                1 => Expression::Velocity,
                2 => Expression::Acceleration,
                order => return Err(self.error(ParseErrorKind::Derivative { order })),
            };
            self.advance();
            return self.at_a_time(derivative, at.start);
        }
        match name {
            "x" => return self.at_a_time(Expression::Displacement, at.start),
            "t" => return Ok(Expression::Time),
            "taylor" => return self.taylor(),
            "sqrt" => {
                let argument = self.argument()?;
                return Ok(argument.pow(Expression::Number(Rational::from((1, 2)))));
            }
            _ => {}
        }
        if let Some(function) = function(name) {
            return Ok(self.argument()?.apply(function));
        }
        let opens = self.sign() == Some('(');
        if self.names.formal.contains(name) && opens {
            return Ok(self.argument()?.formal(name));
        }
        if name == self.names.small {
            return Ok(Expression::Small);
        }
        let declared = match &self.names.parameters {
            Some(list) => list.contains(name),
            None => is_parameter_name(name),
        };
        if declared {
            return Ok(Expression::parameter(name));
        }
        let kind = match foreign(name) {
            Some(instead) => ParseErrorKind::UnknownFunction { name: excerpt(name), instead },
            None if opens
                && self.names.parameters.is_some()
                && self.names.nearest(name).is_none() =>
            {
                let instead = "sin, cos, exp, ln, abs, sign, sqrt; a product needs `*`";
                ParseErrorKind::UnknownFunction { name: excerpt(name), instead }
            }
            None => ParseErrorKind::UnknownName {
                name: excerpt(name),
                nearest: self.names.nearest(name),
            },
        };
        Err(ParseError::new(kind, at.clone()))
    }

    /// The argument of a function: in parentheses, or one name that nothing follows which could
    /// belong to it.
    fn argument(&mut self) -> Parsed {
        if self.accept('(') {
            return self.enclosed(')');
        }
        let token = self.token().clone();
        if !matches!(token.kind, Kind::Name(_) | Kind::Sign('|')) {
            return Err(self.expected(Expectation::Parenthesis));
        }
        let argument = self.deeper(Self::operand)?;
        let continues = matches!(self.token().kind, Kind::Sign('^') | Kind::Superscript(_))
            || self.operand_follows() && self.token().kind != Kind::Name("to".into());
        if continues {
            return Err(self.expected(Expectation::Parenthesis));
        }
        Ok(argument)
    }

    /// What stands behind x, x' or `[...]`: (t - T) delays it.
    fn at_a_time(&mut self, what: Expression, start: usize) -> Parsed {
        // x (1 - x) is a product, x(t - T) is not. Looked up, not tried: trying twice at every
        // level would take 2^depth steps.
        if self.sign() != Some('(') || !self.time_in_parentheses() {
            return Ok(what);
        }
        self.advance();
        let time = self.enclosed(')')?;
        let at = start..self.behind();
        let found = self.excerpt(at.clone());
        let refused = || ParseError::new(ParseErrorKind::NotADelay { found }, at);
        let mut delay = time.terms().to_vec();
        let Some(now) = delay.iter().position(|term| *term == Expression::Time) else {
            return Err(refused());
        };
        delay.remove(now);
        let delay: Vec<Expression> = delay.into_iter().map(negated).collect();
        let delay = match <[Expression; 1]>::try_from(delay) {
            Ok([single]) => single,
            Err(terms) => Expression::Sum(terms),
        };
        match delay.as_number() {
            Some(q) if q.is_zero() => return Ok(what),
            Some(q) if q.cmp0() == Ordering::Less => return Err(refused()),
            _ => {}
        }
        let later = matches!(
            delay.canonical(),
            Expression::Product(factors)
                if matches!(factors.first(), Some(Expression::Number(q)) if q.cmp0() == Ordering::Less)
        );
        let inner_varies = what.find(&|e| matches!(e, Expression::Acceleration | Expression::Time));
        if later || !delay.is_constant() || inner_varies.is_some() {
            return Err(refused());
        }
        Ok(what.delayed(delay))
    }

    /// Whether t occurs between the parenthesis that opens here and the one that closes it.
    fn time_in_parentheses(&self) -> bool {
        let mut open = 0usize;
        for token in self.tokens.iter().skip(self.next) {
            match &token.kind {
                Kind::Sign('(') => open += 1,
                Kind::Sign(')') => open = open.saturating_sub(1),
                Kind::Name(name) if name == "t" => return true,
                _ => {}
            }
            if open == 0 {
                break;
            }
        }
        false
    }

    /// taylor(f(z), n) or taylor f z to n.
    fn taylor(&mut self) -> Parsed {
        let start = self.start();
        let enclosed = self.accept('(');
        let from = self.next;
        let expression = match self.token().kind.clone() {
            // Functions that exist only here.
            Kind::Name(name) if foreign(&name).is_some() => {
                self.advance();
                let argument = self.argument()?;
                Err((name, argument))
            }
            _ if enclosed => Ok(self.deeper(Self::sum)?),
            _ => Ok(self.deeper(Self::operand)?),
        };
        let at = self.tokens.get(from).map_or(start, |t| t.at.start)..self.behind();
        if enclosed {
            if !self.accept(',') {
                return Err(self.expected(Expectation::Comma));
            }
        } else if self.token().kind == Kind::Name("to".into()) {
            self.advance();
        } else {
            return Err(self.expected(Expectation::To));
        }
        let order = match &self.token().kind {
            Kind::Number(n) if n.is_integer() && *n >= 1 && *n < 100 => n.numer().to_usize(),
            _ => None,
        };
        let Some(order) = order else { return Err(self.expected(Expectation::Order)) };
        self.advance();
        if enclosed {
            self.close(')')?;
        }
        let polynomial = match &expression {
            Ok(expression) => taylor(None, expression, order),
            Err((name, argument)) => taylor(Some(name), argument, order),
        };
        let polynomial = polynomial.map_err(|kind| ParseError::new(kind, at))?;
        if degree(&polynomial) > LARGEST_EXPONENT as f64 {
            let kind = ParseErrorKind::TooLarge { what: Limit::Exponent, limit: LARGEST_EXPONENT };
            return Err(ParseError::new(kind, start..self.behind()));
        }
        Ok(polynomial)
    }
}

fn multiply(factors: &mut Vec<Expression>, factor: Expression) {
    match factor {
        Expression::Product(inner) => factors.extend(inner),
        single => factors.push(single),
    }
}

/// The canonical form without the number of a product and with its factors and terms in the order
/// of their text: what a term is recognised by.
fn unordered(e: &Expression) -> Expression {
    match e.canonical() {
        Expression::Product(mut factors) => {
            factors.retain(|f| !matches!(f, Expression::Number(_)));
            factors.sort_by_cached_key(|f| f.print("", Style::Text));
            if factors.len() == 1 { factors.remove(0) } else { Expression::Product(factors) }
        }
        Expression::Sum(mut terms) => {
            terms.sort_by_cached_key(|t| t.print("", Style::Text));
            Expression::Sum(terms)
        }
        other => other,
    }
}

/// -e, with the sign in a number in front.
fn negated(e: Expression) -> Expression {
    match e {
        Expression::Product(mut factors) => {
            let more = factors.len() > 1;
            match factors.first_mut() {
                Some(Expression::Number(q)) if *q == -1 && more => {
                    factors.remove(0);
                    if factors.len() == 1 {
                        return factors.remove(0);
                    }
                }
                Some(Expression::Number(q)) => *q = Rational::from(-&*q),
                _ => factors.insert(0, Expression::integer(-1)),
            }
            Expression::Product(factors)
        }
        other => -other,
    }
}

/// A bound on the degree in x and x' and in what depends on them, with whole exponents only.
fn degree(e: &Expression) -> f64 {
    match e {
        Expression::Number(_) | Expression::Parameter(_) | Expression::Time => 0.0,
        Expression::Sum(list) => list.iter().map(degree).fold(0.0, f64::max),
        Expression::Product(list) => list.iter().map(degree).sum(),
        Expression::Power(base, exponent) => {
            let n = exponent.as_number().map_or(1.0, |q| q.to_f64().abs());
            degree(base) * n
        }
        _ => 1.0,
    }
}
