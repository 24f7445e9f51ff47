//! Laws that jump where the velocity changes its sign, on the half turn where it is negative.

use crate::classification::Reason;
use crate::methods::{is_logarithmic, is_not_polynomial};
use crate::monomials::{Monomial, expand};
use crate::symmetry::{Parity, parity};
use crate::{Expression, Function};

impl Expression {
    /// The first sign or absolute value of something that varies.
    #[must_use]
    pub fn jump(&self) -> Option<&Self> {
        self.find(
            &|e| matches!(e, Self::Function(Function::Abs | Function::Sign, z) if !z.is_constant()),
        )
    }

    /// A law f(x, x') as the polynomial that it is where x' < 0: sign(c x'^n) and |c x'^n| have their value
    /// there. The other half turn is its point reflection, since f(-x, -x') = -f(x, x') is tested.
    ///
    /// # Errors
    /// What is against it: a function of t, a delay, a term that is not odd, a jump elsewhere, no polynomial.
    ///
    /// ```
    /// use lindstedt_equation::classify::Reason;
    /// use lindstedt_equation::{Expression, Function};
    /// let v = || Expression::VELOCITY;
    /// let law = v() * v().apply(Function::Abs);
    /// assert_eq!(law.between_turning_points()?, -(v() * v()));
    /// let bias = v().apply(Function::Sign) + Expression::DISPLACEMENT.pow(2);
    /// assert!(matches!(bias.between_turning_points(), Err(Reason::NotOdd(_))));
    /// # Ok::<(), Reason>(())
    /// ```
    pub fn between_turning_points(&self) -> Result<Self, Reason> {
        let law = self.map(&where_falling).canonical();
        if let Some(jump) = law.jump() {
            return Err(Reason::NonSmooth(jump.clone()));
        }
        if let Some(time) = self.terms().iter().find(|term| term.contains(&Self::Time)) {
            return Err(Reason::Forced(time.clone()));
        }
        if let Some(delay) = self.find(&Self::is_delayed) {
            return Err(Reason::Delay(delay.clone()));
        }
        if let Some(e) = law.find(&|e| is_not_polynomial(e) || is_logarithmic(e)) {
            return Err(Reason::NotPolynomial(e.clone()));
        }
        let out = self.multiplied_out().unwrap_or_else(|| self.clone());
        match out.terms().iter().find(|term| parity(term, true) != Some(Parity::Odd)) {
            Some(term) => Err(Reason::NotOdd(term.clone())),
            None => Ok(law),
        }
    }
}

/// sign(c x'^n) or |c x'^n| where x' < 0.
fn where_falling(e: &Expression) -> Option<Expression> {
    let Expression::Function(function @ (Function::Abs | Function::Sign), z) = e else {
        return None;
    };
    let all = expand(z)?;
    let (Some((m, q)), 1) = (all.terms.first_key_value(), all.terms.len()) else { return None };
    let plain = *m == Monomial { velocity: m.velocity, ..Monomial::default() };
    if !plain || m.velocity == 0 {
        return None;
    }
    let sign = if q.is_positive() == (m.velocity % 2 == 0) { 1 } else { -1 };
    Some(match function {
        Function::Sign => Expression::integer(sign),
        _ => sign * (**z).clone(),
    })
}
