//! All orders of a conservative oscillation from its still part: no product of two full solutions.
//!
//! Let l = -ln|cos psi|, Lambda_m' = l^m/m! - mu_m, and let P = sum x_n eps^n solve
//! omega^2 P'' + F(P; eps) = 0, P = 1, P' = 0 at psi = 0. Suppose that P depends on all Lambda_m through one shift
//! of the clock: with numbers c_m(eps) that vanish at eps = 0,
//!
//!   g = 1 + sum_m c_m l^m/m!,     dP/dLambda_m = -c_m D P,     D = (1/g) d/dpsi with the Lambda_m held fixed.  (1)
//!
//! Then P' = D P + sum_m (l^m/m! - mu_m) ... = M D P with M = 1 + sum_m mu_m c_m, and with omega^2 = kappa nu/M^2
//! the equation is kappa nu D^2 P + F(P) = 0. Its left side obeys (1), too: where its orders below n vanish, order n
//! does not depend on the Lambda_m, and vanishes if it does at Lambda = 0. So all of it follows from the *still*
//! part p = P at Lambda = 0, a function of cos, sin and l alone:
//!
//!   kappa nu D^2 p + F(p) = 0,   D = (1/g) d/dpsi,   P = sum_j (-1)^j/j! (sum_m c_m Lambda_m)^j D^j p.        (2)
//!
//! With q = D p, that is g q = p', kappa nu q' + g F = 0, order n of (2) is, for a_0 = 1,
//!
//!   p_n'' + p_n + (g_n sin)' + g_n cos = f_n + nu_n cos,
//!   f_n = -([F]_n + sum_{k=1}^{n-1} g_k F_{n-k})/kappa + sum_{k=1}^{n-1} ((g_k q_{n-k})' - nu_k q'_{n-k}),
//!
//! and since u = p_n + sin sum_m c_mn Lambda_m has u'' + u = p_n'' + p_n + (g_n sin)' + g_n cos - 2 sum_m c_mn mu_m cos,
//! resolving f_n in a ring with the constants mu_m = 0 gives p_n, the numbers c_mn and nu_n at once.
//! The constants mu_m do not enter: (2) holds for all of them.

mod check;
mod frequency;

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{Driver, Request, Scheme, run};
use crate::expansion::{Expansion, OrderWork};
use lindstedt_algebra::{ClockAlgebra, FunctionAlgebra, Ring};
use lindstedt_equation::Condition;

pub use check::check_clock;
pub use frequency::{ClockFrequency, ClockMean, clock_variable};

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// A conservative oscillation by its still part and its clock.
#[derive(Clone, Debug)]
pub struct ClockExpansion<A: ClockAlgebra> {
    /// p_0, p_1, ... in the place of the solution and nu_0 = 1, nu_1, ... in that of omega^2/kappa.
    pub still: Expansion<A>,
    /// c_mn by order n and then m - 1; nothing at order 0.
    pub numbers: Vec<Vec<Constant<A>>>,
}

impl<A: ClockAlgebra> ClockExpansion<A> {
    /// The highest order derived.
    pub fn order(&self) -> usize {
        self.still.order()
    }
}

/// Derives the still part and the clock up to the order of the request, in an algebra with mu_m = 0.
///
/// # Errors
/// [`ExpandError::NotOneClock`] where the velocity occurs, the condition is not x(0) = 1 at rest, or an order is
/// no shift of one clock; else as [`expand`](crate::expand). What is returned is not checked: that is
/// [`check_clock`].
///
/// # Cost
/// Order n costs O(n) products of *still* functions per node of the equation: O(n^2) terms each in place of as
/// many as there are partitions of n.
pub fn expand_clock<A: ClockAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    request: &Request,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<ClockExpansion<A>, ExpandError> {
    if request.condition != Condition::InitialAmplitude
        || request.leading_amplitude != 1
        || equation.has_velocity()
    {
        return Err(ExpandError::NotOneClock { order: 0 });
    }
    let driver = Driver::start(algebra, equation, request)?;
    let slope = algebra.derivative(&driver.x[0]);
    let mut clock = ClockDriver {
        numbers: vec![Vec::new()],
        paces: vec![algebra.one()],
        forces: vec![algebra.scale_by(&driver.x[0], &driver.stiffness)],
        velocity_slopes: vec![algebra.derivative(&slope)],
        velocities: vec![slope],
        driver,
    };
    let work = run(&mut clock, 1..=request.order, observer)?;
    let mut numbers = clock.numbers;
    let still = clock.driver.finish(work)?;
    numbers.truncate(still.solution.len());
    Ok(ClockExpansion { still, numbers })
}

struct ClockDriver<'a, A: ClockAlgebra> {
    driver: Driver<'a, A>,
    numbers: Vec<Vec<Constant<A>>>,
    /// g_n.
    paces: Vec<A::Element>,
    /// q_n and q_n' with q = D p.
    velocities: Vec<A::Element>,
    velocity_slopes: Vec<A::Element>,
    /// F_n.
    forces: Vec<A::Element>,
}

impl<A: ClockAlgebra> ClockDriver<'_, A> {
    /// sum_{k=1}^{n-1} g_k f_{n-k}.
    fn paced(&self, f: &[A::Element], n: usize) -> A::Element {
        let pairs: Vec<_> = (1..n).map(|k| (&self.paces[k], &f[n - k])).collect();
        self.driver.algebra.sum_of_products(&pairs)
    }

    /// f_n, and \[F\]_n formed with p_n = 0.
    fn right_side(&mut self, n: usize) -> Result<[A::Element; 2], ExpandError> {
        let algebra = self.driver.algebra;
        let root = self.driver.evaluator.equation.root();
        let force = self.driver.evaluator.coefficient(root, n)?;
        let whole = algebra.add(&force, &self.paced(&self.forces, n));
        let mut terms = vec![(&whole, &self.driver.inverse_stiffness)];
        let known = &self.driver.frequency_squared[1..];
        terms.extend(self.driver.convolution(known, &self.velocity_slopes, n, |_| true));
        let sum = algebra.linear_combination(&terms);
        let inertia = algebra.derivative(&self.paced(&self.velocities, n));
        Ok([algebra.sub(&inertia, &sum), force])
    }

    /// Takes p_n and the numbers of order n.
    fn take(&mut self, n: usize, still: A::Element, numbers: Vec<Constant<A>>, force: A::Element) {
        let algebra = self.driver.algebra;
        let pace = algebra.pace(&numbers);
        let mut velocity =
            algebra.sub(&algebra.derivative(&still), &self.paced(&self.velocities, n));
        let shift = algebra.mul(&pace, &self.velocities[0]);
        velocity = algebra.sub(&velocity, &shift);
        self.velocity_slopes.push(algebra.derivative(&velocity));
        self.velocities.push(velocity);
        let linear = algebra.scale_by(&still, &self.driver.stiffness);
        self.forces.push(algebra.add(&force, &linear));
        self.paces.push(pace);
        self.numbers.push(numbers);
        self.driver.forget(n);
        self.driver.evaluator.assign(&Node::Displacement, n, still.clone());
        self.driver.x.push(still);
    }
}

impl<A: ClockAlgebra> Scheme for ClockDriver<'_, A> {
    fn products(&self) -> u64 {
        self.driver.products()
    }

    fn terms(&self) -> usize {
        self.driver.terms()
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let (algebra, constants) = (self.driver.algebra, self.driver.algebra.constants());
        let [f, force] = self.right_side(n)?;
        let split = algebra.resolve(&f);
        self.driver.go_on(n)?;
        let split = split.map_err(|source| ExpandError::Phase { order: n, source })?;
        if !constants.is_zero(&split.sin_amplitude) {
            return Err(ExpandError::AmplitudeDrifts { order: n });
        }
        let clock = algebra.split_clock(&split.response);
        let (still, numbers) = clock.ok_or(ExpandError::NotOneClock { order: n })?;
        self.driver.frequency_squared.push(constants.neg(&split.cos_amplitude));
        self.take(n, still, numbers, force);
        self.driver.go_on(n)
    }
}
