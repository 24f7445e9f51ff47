//! What is derived: the coefficients of an expansion and what they cost.

use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, Ring};
use lindstedt_equation::Condition;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// What one order cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OrderWork {
    /// The order n.
    pub order: usize,
    /// Products of phase functions formed for it.
    pub products: u64,
    /// Terms of x_n.
    pub terms: usize,
}

/// An expansion with its normalisation: x = sum x_n(psi) eps^n with psi = omega t and
/// omega^2 = kappa sum W_n eps^n, for n = 0, ..., order; coefficients are elements of the algebra that
/// derived it and mean nothing without it.
#[derive(Clone, Debug)]
pub struct Expansion<A: PhaseAlgebra> {
    /// What fixes the amplitude, and so the meaning of every coefficient.
    pub condition: Condition,
    /// kappa, the factor of x at order zero.
    pub stiffness: Constant<A>,
    /// W_0 = 1, W_1, ...: omega^2 = kappa sum W_n eps^n.
    pub frequency_squared: Vec<Constant<A>>,
    /// x(0), order by order.
    pub amplitude: Vec<Constant<A>>,
    /// x_0, x_1, ... as functions of psi = omega t.
    pub solution: Vec<A::Element>,
    /// The work, order by order.
    pub work: Vec<OrderWork>,
    /// Coefficients of the logarithms, exponentials and formal functions of the equation, by
    /// node: the residual check verifies them by their differential equations.
    pub certificates: Vec<Vec<A::Element>>,
}

impl<A: PhaseAlgebra> Expansion<A> {
    /// The highest order derived.
    pub fn order(&self) -> usize {
        self.solution.len() - 1
    }

    /// f_n, the right side of x_n'' + x_n = f_n - W_n x_0'' (zero at order zero and beyond the
    /// orders derived).
    pub fn right_side(&self, algebra: &A, n: usize) -> A::Element {
        let (Some(x), Some(w)) = (self.solution.get(n), self.frequency_squared.get(n)) else {
            return algebra.zero();
        };
        let sum = algebra.force(x);
        let Some(leading) = self.solution.first().filter(|_| n > 0) else { return sum };
        let inertia = algebra.derivative(&algebra.derivative(leading));
        algebra.add(&sum, &algebra.scale_by(&inertia, w))
    }
}
