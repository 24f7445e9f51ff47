//! Analytic functions of the unknown about its rest at zero, as Taylor polynomials.

use lindstedt_equation::{Expression, Function, taylor};
use rug::Rational;

/// The equation with Taylor polynomials of a degree about x = 0 in the place of exp, sin, cos of what vanishes there, and of
/// whole negative powers of what is another number there. Of a motion of size eps all orders up to that degree are those
/// of the equation as it was.
///
/// ```
/// use lindstedt_equation::{Expression, Function, print::Style};
/// let growth = Expression::DISPLACEMENT.apply(Function::Exp) - 1;
/// let near = lindstedt_recognise::about_rest(&growth, 2).multiplied_out().ok_or("terms")?;
/// assert_eq!(near.print("eps", Style::Text), "x + 1/2*x^2");
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn about_rest(e: &Expression, degree: u32) -> Expression {
    let inner = e.map_children(&mut |child| about_rest(child, degree));
    let polynomial = match &inner {
        Expression::Function(function, argument) => of_function(*function, argument, degree),
        Expression::Power(base, exponent) => of_power(base, exponent, degree),
        _ => None,
    };
    polynomial.unwrap_or(inner)
}

/// The value at x = 0, where it is a rational number; nothing for what does not depend on x.
fn at_rest(e: &Expression) -> Option<Rational> {
    let moves = |e: &Expression| matches!(e, Expression::Unknown(_));
    let still = e.map(&|e| moves(e).then(|| Expression::integer(0)));
    e.nodes().any(moves).then(|| still.canonical().as_number())?
}

/// sum c_k u^k by Horner's rule.
fn polynomial(u: &Expression, coefficients: &[Rational]) -> Expression {
    let number = |q: &Rational| Expression::Number(q.clone());
    let mut all = coefficients.iter().rev().map(number);
    let last = all.next().unwrap_or_else(|| 0.into());
    all.fold(last, |sum, c| sum * u.clone() + c)
}

fn of_function(function: Function, u: &Expression, degree: u32) -> Option<Expression> {
    if !at_rest(u)?.is_zero() {
        return None;
    }
    Some(polynomial(u, &taylor::of_function(function, degree as usize)?))
}

/// (c + u)^n = c^n sum binomial(n, k) (u/c)^k.
fn of_power(base: &Expression, exponent: &Expression, degree: u32) -> Option<Expression> {
    let n = exponent.as_number().filter(|n| n.is_integer() && *n < 0)?.numer().to_i32()?;
    let c = at_rest(base).filter(|c| !c.is_zero())?;
    let mut scale = (0..n.unsigned_abs()).fold(Rational::from(1), |power, _| power / &c);
    let coefficients = taylor::binomial(&n.into(), degree as usize).into_iter().map(|binomial| {
        let next = Rational::from(&scale * &binomial);
        scale /= &c;
        next
    });
    let coefficients: Vec<Rational> = coefficients.collect();
    Some(polynomial(&(base.clone() - Expression::Number(c)), &coefficients))
}
