//! What the names and the functions of an equation mean in floats.

use crate::binding::FORMAL;
use crate::constants::sine_sum;
use crate::settings::Settings;
use crate::values::value;
use lindstedt_algebra::Rationals;
use lindstedt_coeff::floats::Reals;
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_expand::Binding;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// |z| = (z^2)^(1/2) and sgn z = z (z^2)^(-1/2), which are powers of values like others.
pub(super) fn as_powers(equation: &Expression) -> Expression {
    let power = |z: &Expression, twice: i32| {
        z.clone().pow(2).pow(Expression::Number(Rational::from((twice, 2))))
    };
    equation.map(&|e| match e {
        Expression::Function(Function::Abs, z) => Some(power(&as_powers(z), 1)),
        Expression::Function(Function::Sign, z) => {
            let z = as_powers(z);
            Some(power(&z, -1) * z)
        }
        _ => None,
    })
}

/// The middle of a ball in a context of floats.
fn real<R: Reals>(reals: &R, ball: &Ball) -> R::Element {
    reals.nearest(ball.midpoint())
}

/// Values of parameters and of the formal sums S_n.
pub(super) struct Given<'a, R> {
    pub settings: &'a Settings,
    pub problem: &'a Problem,
    pub reals: &'a R,
}

impl<R: Reals> Given<'_, R> {
    fn ball(&self, name: &str, guard: u32) -> Option<Ball> {
        let value = value(self.problem, &self.settings.parameters, name)?;
        Some(value.ball(Balls::new(self.reals.bits() + guard)))
    }
}

impl<R: Reals> Binding<R> for Given<'_, R> {
    fn parameter(&self, name: &str) -> Option<R::Element> {
        Some(real(self.reals, &self.ball(name, 16)?))
    }
    fn formal(&self, name: &str, n: usize) -> Option<R::Element> {
        if name != FORMAL {
            return None;
        }
        // S_n with small n cancels: the Taylor series of sin at the amplitude.
        let balls = Balls::new(self.reals.bits() + 64);
        let amplitude = self.ball("amplitude", 64)?;
        let sum = sine_sum(u16::try_from(n).ok()?, &amplitude, balls, &self.settings.stop)?;
        Some(real(self.reals, &sum))
    }
}

/// Exact values of parameters.
pub(super) struct ExactValues<'a>(pub &'a Settings);

impl Binding<Rationals> for ExactValues<'_> {
    fn parameter(&self, name: &str) -> Option<Rational> {
        self.0.parameters.get(name)?.as_rational().cloned()
    }
}
