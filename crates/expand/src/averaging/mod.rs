//! Averaging after Krylov, Bogoliubov and Mitropolsky: the amplitude a is free and drifts,
//!
//!   x = a cos psi + sum eps^n u_n(a, psi, eta),
//!   da/dt = sum eps^n A_n(a),   dpsi/dt = omega_0 + sum eps^n B_n(a),   deta/dt = omega,
//!
//! so that d/dt = D = sum eps^n D_n with D_0 = omega_0 d/dpsi + omega d/deta and
//! D_n = A_n d/da + B_n d/dpsi. With L the characteristic function of the linear part at order
//! zero, order n of the equation reads
//!
//!   L(D_0) u_n + L'(D_0) D_n (a cos psi) = f_n,
//!
//! where -f_n is order n of the equation formed with u_n = A_n = B_n = 0. The resonant part of f_n
//! fixes A_n and B_n, the rest u_n, without first harmonic. Delayed values are exp(-T D) x; since
//! D_0 commutes with all D_n, exp(-T D) = exp(-T D_0) exp(-T (eps D_1 + eps^2 D_2 + ...)), and the
//! powers of the second exponential are built order by order, in `delayed`. This is the loop of
//! [`crate::expand`] with another policy for the amplitude: `Scheme`.

mod check;
mod complex;
mod delayed;
mod linear;
#[cfg(test)]
mod tests;

pub use check::check_averaged;

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{OrderWork, Scheme, run};
use crate::evaluator::Evaluator;
use delayed::Tower;
use lindstedt_algebra::{
    Averaged, AveragingAlgebra, FunctionAlgebra, LinearPart, RationalAlgebra, Ring,
};
use linear::{Affine, Linear};
use rug::Rational;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// An averaged expansion: x = a cos psi + sum eps^n u_n(a, psi, eta), da/dt = sum eps^n A_n(a),
/// dpsi/dt = omega_0 + sum eps^n B_n(a); the u_n have no first harmonic in psi, so a is the amplitude of
/// the first harmonic. Time is that of the equation.
#[derive(Clone, Debug)]
pub struct AveragedExpansion<A: AveragingAlgebra> {
    /// The linear part at order zero.
    pub linear: LinearPart<Constant<A>>,
    /// A_0 = 0, A_1(a), A_2(a), ...: da/dt.
    pub amplitude_rate: Vec<Constant<A>>,
    /// B_0 = 0, B_1(a), ...: dpsi/dt - omega_0.
    pub phase_rate: Vec<Constant<A>>,
    /// u_0 = a cos psi + the forced response, u_1, ...
    pub solution: Vec<A::Element>,
    /// The work, order by order.
    pub work: Vec<OrderWork>,
}

impl<A: AveragingAlgebra> AveragedExpansion<A> {
    /// The highest order derived.
    pub fn order(&self) -> usize {
        self.solution.len() - 1
    }
}

/// Derives the averaged expansion up to an order; `observer` as in [`crate::expand`].
///
/// Cost: O(N^2) derivations and products of phase functions, O(N^3) derivations with delays. Where the equation is linear,
/// O(N^2) products of constants (`linear`).
///
/// # Errors
/// [`ExpandError`] says at which order and why no expansion of this form exists or could be found:
/// resonances are named by their harmonic.
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Rationals};
/// use lindstedt_equation::Expression;
/// use lindstedt_expand::{Binding, average, check_averaged, compile};
/// use lindstedt_phase::Torus;
/// use rug::Rational;
///
/// struct NoNames;
/// impl<C: RationalAlgebra> Binding<C> for NoNames {
///     fn parameter(&self, _: &str) -> Option<C::Element> { None }
///     fn formal(&self, _: &str, _: usize) -> Option<C::Element> { None }
/// }
/// let x = Expression::DISPLACEMENT;
/// let duffing = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let torus = Torus::new(Rationals, Rational::from(1), None, Vec::new());
/// let equation = compile(&torus, &duffing, &NoNames, 1)?;
/// let found = average(&torus, &equation, 1, &mut |_| true)?;
/// assert_eq!(check_averaged(&torus, &equation, &found)?, 1);
/// // dpsi/dt = 1 + eps 3/8 a^2.
/// assert!(format!("{:?}", found.phase_rate[1]).contains("3/8"));
/// # Ok::<(), lindstedt_expand::ExpandError>(())
/// ```
pub fn average<A: AveragingAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    order: usize,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<AveragedExpansion<A>, ExpandError> {
    let start = Averaging::start(algebra, equation)?;
    let Some(affine) = Affine::of(algebra, equation, order) else {
        return general(start, order, observer);
    };
    let mut linear = Linear::start(start, affine).ok_or(ExpandError::NotWeaklyNonlinear)?;
    let work = run(&mut linear, 1..=order, observer)?;
    Ok(linear.finish(work))
}

/// The scheme for any equation.
fn general<A: AveragingAlgebra>(
    mut averaging: Averaging<'_, A>,
    order: usize,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<AveragedExpansion<A>, ExpandError> {
    let work = run(&mut averaging, 1..=order, observer)?;
    let Averaging { linear, amplitude_rate, phase_rate, x, .. } = averaging;
    Ok(finished(linear, [amplitude_rate, phase_rate], x, work))
}

/// The orders that are finished: an order that was interrupted has provisional values.
fn finished<A: AveragingAlgebra>(
    linear: LinearPart<Constant<A>>,
    [mut amplitude_rate, mut phase_rate]: [Vec<Constant<A>>; 2],
    mut solution: Vec<A::Element>,
    work: Vec<OrderWork>,
) -> AveragedExpansion<A> {
    let finished = work.len() + 1;
    solution.truncate(finished);
    amplitude_rate.truncate(finished);
    phase_rate.truncate(finished);
    AveragedExpansion { linear, amplitude_rate, phase_rate, solution, work }
}

struct Averaging<'a, A: AveragingAlgebra> {
    algebra: &'a A,
    evaluator: Evaluator<'a, A>,
    linear: LinearPart<Constant<A>>,
    amplitude_rate: Vec<Constant<A>>,
    phase_rate: Vec<Constant<A>>,
    x: Vec<A::Element>,
    /// x', order by order.
    velocity: Vec<A::Element>,
    /// x(t - T), for every delay.
    towers: Vec<Tower<A>>,
    /// Whether coefficient n of a node depends on x_n, x_n' or their delayed values.
    sensitive: Vec<bool>,
}

impl<A: AveragingAlgebra> Scheme for Averaging<'_, A> {
    fn products(&self) -> u64 {
        self.evaluator.products
    }

    fn terms(&self) -> usize {
        self.x.last().map_or(0, |x| self.algebra.terms(x))
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        // Provisionally u_n = A_n = B_n = 0.
        self.amplitude_rate.push(algebra.constants().zero());
        self.phase_rate.push(algebra.constants().zero());
        self.x.push(algebra.zero());
        self.velocity.push(self.rate_of_change(&self.x, n));
        self.extend_delayed(n)?;
        self.assign(n);
        let f = self.right_side(n)?;
        let phase = |source| ExpandError::Phase { order: n, source };
        let averaged = algebra.average(&self.linear, &f);
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        let Averaged { amplitude_rate, phase_rate, response } = averaged.map_err(phase)?;
        let leading = &self.x[0];
        let drift = algebra.add(
            &algebra.scale_by(&algebra.by_amplitude(leading), &amplitude_rate),
            &algebra.scale_by(&algebra.by_phase(leading), &phase_rate),
        );
        self.amplitude_rate[n] = amplitude_rate;
        self.phase_rate[n] = phase_rate;
        self.amend(n, response, &drift)?;
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        Ok(())
    }
}

impl<'a, A: AveragingAlgebra> Averaging<'a, A> {
    fn start(algebra: &'a A, equation: &'a Equation<A>) -> Result<Self, ExpandError> {
        let (linear, sensitive) = linearise(algebra, equation)?;
        // Anew: with a force at order zero x_0 is not a cos psi, at which the linear part was found, and
        // coefficients of order 1 that were needed for it depend on x_0.
        let evaluator = Evaluator::new(algebra, equation);
        let generating = algebra.generating_solution();
        let zero = || vec![algebra.constants().zero()];
        let mut averaging = Self {
            algebra,
            evaluator,
            linear,
            amplitude_rate: zero(),
            phase_rate: zero(),
            velocity: vec![algebra.by_time(&generating)],
            x: vec![generating],
            towers: (0..algebra.delays()).map(|delay| Tower::new(algebra, delay)).collect(),
            sensitive,
        };
        averaging.order_zero()?;
        Ok(averaging)
    }

    /// Adds the response to a force at order zero, L(D_0) p = force(eta), to a cos psi.
    fn order_zero(&mut self) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        self.extend_delayed(0)?;
        self.assign(0);
        let force = self.right_side(0)?;
        if !algebra.may_vanish(&force) {
            let phase = |source| ExpandError::Phase { order: 0, source };
            let forced = algebra.average(&self.linear, &force).map_err(phase)?;
            let drifts = [&forced.amplitude_rate, &forced.phase_rate];
            if drifts.into_iter().any(|rate| !algebra.constants().may_vanish(rate)) {
                // a cos psi is no solution at order zero: the frequency is not omega_0, or the
                // linear part damps or excites it.
                return Err(ExpandError::NotWeaklyNonlinear);
            }
            self.amend(0, forced.response, &algebra.zero())?;
            if !algebra.may_vanish(&self.right_side(0)?) {
                return Err(ExpandError::NotWeaklyNonlinear);
            }
        }
        Ok(())
    }

    /// Order n of D applied to a series: sum_k D_k f_{n-k}.
    fn rate_of_change(&self, f: &[A::Element], n: usize) -> A::Element {
        let mut sum = f.get(n).map_or_else(|| self.algebra.zero(), |f| self.algebra.by_time(f));
        let drift = delayed::drift(self.algebra, [&self.amplitude_rate, &self.phase_rate], f, n);
        self.algebra.add_assign(&mut sum, &drift);
        sum
    }

    /// f_n, with the provisional values of order n.
    fn right_side(&mut self, n: usize) -> Result<A::Element, ExpandError> {
        let force = self.evaluator.coefficient(self.evaluator.equation.root(), n)?;
        let acceleration = self.rate_of_change(&self.velocity, n);
        Ok(self.algebra.neg(&self.algebra.add(&acceleration, &force)))
    }

    fn extend_delayed(&mut self, n: usize) -> Result<(), ExpandError> {
        for tower in &mut self.towers {
            let rates = [&self.amplitude_rate[..], &self.phase_rate[..]];
            tower.extend(self.algebra, rates, &self.x, n).ok_or(ExpandError::NotWeaklyNonlinear)?;
        }
        Ok(())
    }

    /// Adds u to x_n, and D_n x_0 = `drift` to x_n', with what follows for the delayed values.
    fn amend(&mut self, n: usize, u: A::Element, drift: &A::Element) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        let rate = algebra.add(&algebra.by_time(&u), drift);
        algebra.add_assign(&mut self.velocity[n], &rate);
        for tower in &mut self.towers {
            tower.amend(algebra, n, &u, drift).ok_or(ExpandError::NotWeaklyNonlinear)?;
        }
        algebra.add_assign(&mut self.x[n], &u);
        self.assign(n);
        Ok(())
    }

    /// Hands order n of x, x' and their delayed values to the evaluator.
    fn assign(&mut self, n: usize) {
        self.evaluator.forget_from(n, &self.sensitive);
        let mut set = |variable, value| self.evaluator.assign(&variable, n, value);
        set(Node::Displacement, self.x[n].clone());
        set(Node::Velocity, self.velocity[n].clone());
        for (delay, tower) in self.towers.iter().enumerate() {
            set(
                Node::Unknown { index: 0, velocity: false, delay: Some(delay) },
                tower.values()[n].clone(),
            );
            // exp(-T D) commutes with D: the delayed velocity is the rate of the delayed value.
            let mut late = self.algebra.by_time(&tower.values()[n]);
            let rates = [&self.amplitude_rate[..], &self.phase_rate[..]];
            let drift = delayed::drift(self.algebra, rates, tower.values(), n);
            self.algebra.add_assign(&mut late, &drift);
            set(Node::Unknown { index: 0, velocity: true, delay: Some(delay) }, late);
        }
    }
}

/// The linear part at a cos psi, and the nodes whose order n depends on order n of x.
fn linearise<A: AveragingAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
) -> Result<(LinearPart<Constant<A>>, Vec<bool>), ExpandError> {
    let mut evaluator = Evaluator::new(algebra, equation);
    let generating = algebra.generating_solution();
    evaluator.assign(&Node::Displacement, 0, generating.clone());
    evaluator.assign(&Node::Velocity, 0, algebra.by_time(&generating));
    for delay in 0..algebra.delays() {
        let late = algebra.shift(&generating, delay).ok_or(ExpandError::NotWeaklyNonlinear)?;
        let late_velocity = algebra.by_time(&late);
        evaluator.assign(&Node::Unknown { index: 0, velocity: false, delay: Some(delay) }, 0, late);
        evaluator.assign(
            &Node::Unknown { index: 0, velocity: true, delay: Some(delay) },
            0,
            late_velocity,
        );
    }
    let mut sensitive = vec![false; equation.nodes.len()];
    let mut factor = |variable: Node<Constant<A>>| {
        let unit = |node: &Node<_>| (*node == variable).then(|| [algebra.one(), algebra.zero()]);
        let tangents = evaluator.tangents(&unit)?;
        for (flag, tangent) in sensitive.iter_mut().zip(&tangents) {
            *flag |= !algebra.is_zero(&tangent[0]);
        }
        algebra.as_constant(&tangents[equation.root()][0]).ok_or(ExpandError::NotWeaklyNonlinear)
    };
    let linear = LinearPart {
        stiffness: factor(Node::Displacement)?,
        damping: factor(Node::Velocity)?,
        delayed: (0..algebra.delays())
            .map(|delay| {
                let displacement =
                    factor(Node::Unknown { index: 0, velocity: false, delay: Some(delay) })?;
                Ok((
                    displacement,
                    factor(Node::Unknown { index: 0, velocity: true, delay: Some(delay) })?,
                ))
            })
            .collect::<Result<_, ExpandError>>()?,
    };
    Ok((linear, sensitive))
}

/// The linear part of an equation at order zero; needs no frequency.
///
/// # Errors
/// [`ExpandError::NotWeaklyNonlinear`] when it is not linear with constant factors.
pub fn linear_part<A: AveragingAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
) -> Result<LinearPart<Constant<A>>, ExpandError> {
    linearise(algebra, equation).map(|(linear, _)| linear)
}

/// -T/i as a constant of the algebra.
fn step_back<A: AveragingAlgebra>(algebra: &A, delay: usize, i: usize) -> Option<Constant<A>> {
    let time = algebra.delay(delay)?;
    Some(algebra.constants().scale(&time, &Rational::from((-1, i))))
}
