//! What an equation contains besides x, x' and parameters: the delays and the forcing frequency.
//!
//! Both must be known before an algebra can be chosen, because the fast phases advance by
//! omega_0 T and omega T during a delay T.

use crate::ExpandError;
use lindstedt_algebra::common_measure;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function, Unknown};
use rug::Rational;

/// The delays and the forcing of an equation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excitation {
    /// The distinct delays T in the order of their first occurrence.
    pub delays: Vec<Expression>,
    /// The frequency omega of which all forcing terms cos(m omega t), sin(m omega t) are harmonics.
    pub frequency: Option<Expression>,
    /// The number in `frequency`; the rest of it is `symbols`.
    number: Rational,
    symbols: Vec<Expression>,
}

impl Excitation {
    /// Reads an equation.
    ///
    /// # Errors
    /// [`ExpandError::UnsupportedTerm`] for a delayed term that is not x(t - T) or x'(t - T), a
    /// function of t that is not cos or sin of a multiple of t, or two forcing frequencies whose
    /// ratio is not a rational number.
    pub fn of(equation: &Expression) -> Result<Self, ExpandError> {
        let mut found = Self::default();
        found.read(equation)?;
        if !found.number.is_zero() {
            let number = Expression::Number(found.number.clone());
            found.frequency = Some(
                found.symbols.iter().cloned().fold(number, |product, symbol| product * symbol),
            );
        }
        Ok(found)
    }

    fn read(&mut self, expression: &Expression) -> Result<(), ExpandError> {
        match expression {
            Expression::Unknown(Unknown { derivative, delay: Some(delay), .. }) => {
                if *derivative > 1 {
                    return Err(unsupported(expression));
                }
                if !self.delays.contains(delay) {
                    self.delays.push((**delay).clone());
                }
                Ok(())
            }
            Expression::Function(Function::Cos | Function::Sin, argument)
                if split_time(argument).is_some() =>
            {
                let (number, symbols) =
                    split_time(argument).ok_or_else(|| unsupported(expression))?;
                if self.number.is_zero() {
                    (self.number, self.symbols) = (number.abs(), symbols);
                } else if self.symbols == symbols {
                    self.number = common_measure(&self.number, &number);
                } else {
                    return Err(unsupported(expression));
                }
                Ok(())
            }
            Expression::Time => Err(unsupported(expression)),
            other => other.children().try_for_each(|inner| self.read(inner)),
        }
    }

    /// m in cos(m omega t), with its sign.
    pub(crate) fn multiple(&self, argument: &Expression) -> Option<i64> {
        let (number, symbols) = split_time(argument)?;
        if symbols != self.symbols || self.number.is_zero() {
            return None;
        }
        let ratio = number / &self.number;
        ratio.is_integer().then(|| ratio.numer().to_i64()).flatten()
    }
}

fn unsupported(term: &Expression) -> ExpandError {
    ExpandError::UnsupportedTerm { term: term.print("eps", Style::Text) }
}

/// q and the other factors of q t s_1 s_2 ...; nothing when the expression is no multiple of t.
fn split_time(argument: &Expression) -> Option<(Rational, Vec<Expression>)> {
    let mut factors = Vec::new();
    flatten(argument, &mut factors);
    let (mut number, mut symbols, mut times) = (Rational::from(1), Vec::new(), 0);
    for factor in factors {
        match factor {
            Expression::Time => times += 1,
            Expression::Number(q) => number *= q,
            constant if constant.is_constant() => symbols.push(constant.clone()),
            _ => return None,
        }
    }
    // The order of the factors as typed does not matter.
    symbols.sort_by_cached_key(|symbol| symbol.print("eps", Style::Text));
    (times == 1 && !number.is_zero()).then_some((number, symbols))
}

fn flatten<'a>(expression: &'a Expression, factors: &mut Vec<&'a Expression>) {
    match expression {
        Expression::Product(list) => list.iter().for_each(|factor| flatten(factor, factors)),
        single => factors.push(single),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cos(argument: Expression) -> Expression {
        argument.apply(Function::Cos)
    }

    #[test]
    fn harmonics_of_one_frequency() {
        let omega = || Expression::parameter("omega");
        let t = || Expression::Time;
        let half = Expression::Number(Rational::from((3, 2)));
        let force = cos(omega() * t()) + cos(t() * half.clone() * omega()).apply(Function::Abs);
        let Ok(found) = Excitation::of(&force) else { panic!("harmonics") };
        let shown = found.frequency.as_ref().map(|f| f.print("eps", Style::Text));
        assert_eq!(shown.as_deref(), Some("1/2*omega"));
        assert_eq!(found.multiple(&(t() * half * omega())), Some(3));
        assert_eq!(found.multiple(&(t() * omega() * -1)), Some(-2));
        assert_eq!(found.multiple(&t()), None);
        assert!(Excitation::of(&(cos(omega() * t()) + cos(t()))).is_err());
        assert!(Excitation::of(&(t() * omega())).is_err());
    }

    #[test]
    fn delays_are_listed_once() {
        let delay = || Expression::parameter("T");
        let x = Expression::DISPLACEMENT.delayed(delay()) - Expression::VELOCITY.delayed(delay());
        let twice = x.clone() + Expression::DISPLACEMENT.delayed(delay() * 2);
        assert_eq!(Excitation::of(&twice).map(|e| e.delays.len()), Ok(2));
        let square = Expression::DISPLACEMENT.pow(2).delayed(delay());
        assert_eq!(Excitation::of(&(x.clone() + square)).map(|e| e.delays.len()), Ok(1));
        assert!(Excitation::of(&(x + Expression::ACCELERATION.delayed(delay()))).is_err());
    }
}
