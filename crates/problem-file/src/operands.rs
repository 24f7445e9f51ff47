//! Operands: names, functions, x at an earlier time, Taylor polynomials.

use crate::error::{Expectation, Limit, ParseError, ParseErrorKind, excerpt};
use crate::grammar::{LARGEST_EXPONENT, Parsed, Parser};
use crate::lexer::Kind;
use crate::names::{PI, foreign, function, is_parameter_name};
use crate::taylor::taylor;
use crate::trees::{degree, negated};
use lindstedt_equation::{Expression, Function};
use rug::Rational;
use std::cmp::Ordering;
use std::ops::Range;

impl Parser<'_> {
    pub(crate) fn operand(&mut self) -> Parsed {
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
        let unknown = self.names.unknowns.iter().position(|unknown| unknown == name);
        if let Kind::Primes(order) = self.token().kind {
            let Some(unknown) = unknown else {
                let kind = ParseErrorKind::NotDifferentiable { name: excerpt(name) };
                return Err(self.error(kind));
            };
            let derivative = match order {
                1 => 1,
                2 => 2,
                order => return Err(self.error(ParseErrorKind::Derivative { order })),
            };
            self.advance();
            return self.at_a_time(Expression::unknown(unknown, derivative), at.start);
        }
        if let Some(unknown) = unknown {
            return self.at_a_time(Expression::unknown(unknown, 0), at.start);
        }
        match name {
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
            _ if name == PI => true,
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
        let varies = |e: &Expression| match e {
            Expression::Unknown(unknown) => unknown.derivative > 1,
            other => *other == Expression::Time,
        };
        let inner_varies = what.find(&varies);
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
