//! The driver: one loop that derives expansions of x'' + F(x, x'; eps) = 0 to any order.
//!
//! In the phase psi = omega t, with omega^2 = kappa (W_0 + W_1 eps + ...), W_0 = 1 and kappa the
//! linear stiffness, order n of the equation reads
//!
//!   x_n'' + x_n = f_n - W_n x_0'',   f_n = -[F]_n/kappa - sum_{k=1}^{n-1} W_k x_{n-k}''
//!
//! where [F]_n is formed with x_n = 0 (order zero of F is kappa x, checked). The resonant part
//! of f_n in cos psi fixes W_n, the part in sin psi fixes the amplitude of order n - 1 of a
//! limit cycle or must vanish; the rest is solved by the algebra. No branch on the order number.

mod convolution;

use crate::ExpandError;
use crate::ahead::Ahead;
use crate::compile::{Equation, Node};
use crate::evaluator::Evaluator;
use crate::expansion::{Expansion, OrderWork};
use crate::limit_cycle;
use convolution::Combined;
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Ring};
use lindstedt_equation::Condition;
use rug::Rational;
use std::ops::RangeInclusive;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// What to derive: x'' + F(x, x'; eps) = 0 up to eps^order, with the amplitude that `condition` fixes.
#[derive(Clone, Debug)]
pub struct Request {
    /// What fixes the amplitude.
    pub condition: Condition,
    /// The highest order.
    pub order: usize,
    /// a_0; see [`leading_amplitude`].
    pub leading_amplitude: Rational,
}

/// The amplitude at order zero: 1, or the root of the averaged equation for a limit cycle.
///
/// # Errors
/// [`ExpandError`] when there is no limit cycle with a unique rational leading amplitude.
pub fn leading_amplitude<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    condition: Condition,
) -> Result<Rational, ExpandError> {
    match condition {
        Condition::LimitCycle => limit_cycle::leading_amplitude(algebra, equation),
        Condition::InitialAmplitude | Condition::FundamentalAmplitude => Ok(Rational::from(1)),
        Condition::FreeAmplitude => Err(ExpandError::AmplitudeIsFree),
    }
}

/// Derives the expansion up to the order of the request.
///
/// After each order `observer` is told the work; when it returns `false`, or when the algebra is
/// interrupted within an order, the driver stops and returns the orders that are finished.
///
/// # Errors
/// [`ExpandError`] says at which order and why no expansion of the asked form exists or could
/// be found in this algebra.
///
/// # Method
/// Order n solves x_n'' + x_n = f_n - W_n x_0'' in the phase: `PhaseAlgebra::resolve` splits off the
/// resonant part of f_n, its cosine fixes W_n, its sine the amplitude of order n - 1 (limit cycle) or must
/// vanish, and the rest gives x_n. The coefficients of F come from recurrences in eps, so order n costs
/// O(n) products of phase functions per node of the equation and nothing is computed twice. What is
/// returned is not checked: that is [`crate::check`].
///
/// ```
/// use lindstedt_algebra::{Rationals, Ring};
/// use lindstedt_equation::{Condition, Expression};
/// use lindstedt_expand::{Binding, Request, check, compile, expand};
/// use lindstedt_phase::Trigonometric;
/// use rug::Rational;
///
/// struct NoNames;
/// impl Binding<Rationals> for NoNames {
///     fn parameter(&self, _: &str) -> Option<Rational> { None }
/// }
/// let (algebra, x) = (Trigonometric::new(Rationals), Expression::DISPLACEMENT);
/// let duffing = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let equation = compile(&algebra, &duffing, &NoNames, 2)?;
/// let condition = Condition::InitialAmplitude;
/// let request = Request { condition, order: 2, leading_amplitude: Rational::from(1) };
/// let found = expand(&algebra, &equation, &request, &mut |_| true)?;
/// assert_eq!(found.frequency_squared[1..], [Rational::from((3, 4)), Rational::from((-3, 128))]);
/// assert_eq!(check(&algebra, &equation, &found)?, 2);
/// # Ok::<(), lindstedt_expand::ExpandError>(())
/// ```
pub fn expand<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    request: &Request,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Expansion<A>, ExpandError> {
    extend(algebra, equation, request, Known { solution: &[], squared: &[] }, observer)
}

/// The first orders of an expansion: x_n and W_n, n = 0, ..., m.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a, A: PhaseAlgebra> {
    /// x_n; the last one of a limit cycle with its amplitude, which the order after it fixes.
    pub solution: &'a [A::Element],
    /// W_n.
    pub squared: &'a [Constant<A>],
}

/// The same as [`expand`] where the first orders are known: their right sides are not formed again.
///
/// Nothing is checked; work is counted from the first order that was derived.
///
/// # Errors
/// Those of [`expand`].
pub fn extend<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    request: &Request,
    known: Known<'_, A>,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Expansion<A>, ExpandError> {
    let mut driver = Driver::start(algebra, equation, request)?;
    let mut first = 1;
    for (x, w) in known.solution.iter().zip(known.squared).skip(1).take(request.order) {
        driver.take(first, x.clone(), w.clone())?;
        first += 1;
    }
    let work = run(&mut driver, first..=request.order, observer)?;
    driver.finish(work)
}

/// 1/S for a limit cycle, where 2<f_n sin> changes by S when the amplitude of order n - 1 does by one: a_(n-1) is
/// -2<f_n sin>/S. Nothing where the condition fixes the amplitude.
///
/// # Errors
/// [`ExpandError::DegenerateLimitCycle`] where S is zero; those of [`expand`] to order 1.
pub fn amplitude_reaction<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    request: &Request,
) -> Result<Option<Constant<A>>, ExpandError> {
    if request.condition != Condition::LimitCycle {
        return Ok(None);
    }
    let mut driver = Driver::start(algebra, equation, request)?;
    driver.step(1)?;
    Ok(driver.limit_cycle.map(|reaction| reaction.inverse_sin))
}

/// How the amplitude is treated: fixed or a limit cycle's (`Driver` below), or free and drifting
/// ([`crate::average`]). The loop over the orders is the same.
pub(crate) trait Scheme {
    /// Derives order n: residual, resonant part, response. Interrupted, it fails and leaves the
    /// orders below as they were.
    fn step(&mut self, n: usize) -> Result<(), ExpandError>;
    /// Products formed so far.
    fn products(&self) -> u64;
    /// Terms of the last order of the solution.
    fn terms(&self) -> usize;
}

/// The loop over the orders; stops early when the observer says so or the algebra is interrupted.
pub(crate) fn run(
    scheme: &mut dyn Scheme,
    orders: RangeInclusive<usize>,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Vec<OrderWork>, ExpandError> {
    let mut list = Vec::new();
    for n in orders {
        let before = scheme.products();
        match scheme.step(n) {
            Err(ExpandError::Interrupted { .. }) => break,
            other => other?,
        }
        let products = scheme.products() - before;
        let work = OrderWork { order: n, products, terms: scheme.terms() };
        list.push(work);
        if !observer(&work) {
            break;
        }
    }
    Ok(list)
}

pub(crate) struct Driver<'a, A: PhaseAlgebra> {
    pub(crate) algebra: &'a A,
    condition: Condition,
    pub(crate) evaluator: Evaluator<'a, A>,
    pub(crate) stiffness: Constant<A>,
    /// 1/kappa and 1/a_0.
    pub(crate) inverse_stiffness: Constant<A>,
    inverse_amplitude: Constant<A>,
    pub(crate) frequency_squared: Vec<Constant<A>>,
    /// omega/sqrt(kappa); used only where the velocity occurs, and then kappa = 1.
    pub(crate) frequency: Vec<Constant<A>>,
    pub(crate) x: Vec<A::Element>,
    /// x_n' and x_n'' with respect to psi.
    slopes: Vec<A::Element>,
    second_derivatives: Vec<A::Element>,
    /// Whether coefficient n of a node depends on x_n.
    sensitive: Vec<bool>,
    limit_cycle: Option<LimitCycleResponse<A>>,
    /// Whether x_n has no first harmonic but that of the amplitude of a limit cycle, in place of its values at zero.
    pub(crate) by_first_harmonic: bool,
    /// Of the inertia and the velocity.
    ahead: [Ahead<A::Element>; 2],
}

/// How order n reacts to a change of the amplitude of order n - 1.
struct LimitCycleResponse<A: PhaseAlgebra> {
    /// The change of coefficient n - 1 of every node.
    of_nodes: Vec<A::Element>,
    /// The change of f_n, split: resonant amplitudes and response.
    cos: Constant<A>,
    inverse_sin: Constant<A>,
    response: A::Element,
}

impl<A: PhaseAlgebra> Scheme for Driver<'_, A> {
    fn products(&self) -> u64 {
        self.evaluator.products
    }

    fn terms(&self) -> usize {
        self.x.last().map_or(0, |x| self.algebra.terms(x))
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let (algebra, constants) = (self.algebra, self.algebra.constants());
        let f = self.right_side(n)?;
        let phase = |source| ExpandError::Phase { order: n, source };
        let split = algebra.resolve(&f);
        self.go_on(n)?;
        let mut split = split.map_err(phase)?;
        // Rounding errors of an estimating algebra are no drift of the amplitude.
        if self.limit_cycle.is_none() && !constants.is_zero(&split.sin_amplitude) {
            let resonant = algebra.scale_by(&algebra.sine(), &split.sin_amplitude);
            if algebra.agrees(&f, &algebra.sub(&f, &resonant)) {
                split.sin_amplitude = constants.zero();
            }
        }
        if let Some(shift) = self.amplitude_shift(&split.sin_amplitude, n)? {
            if let Some(reaction) = &self.limit_cycle {
                let change = constants.mul(&reaction.cos, &shift);
                constants.add_assign(&mut split.cos_amplitude, &change);
                let change = algebra.scale_by(&reaction.response, &shift);
                algebra.add_assign(&mut split.response, &change);
            }
            self.shift_amplitude(&shift, n - 1);
        }
        // f_n - W_n x_0'' = f_n + W_n a_0 cos psi has no cos psi left:
        let secular = constants.mul(&split.cos_amplitude, &self.inverse_amplitude);
        let mut x = split.response;
        if self.by_first_harmonic {
            let harmonic = algebra.first_harmonic(&x);
            self.go_on(n)?;
            let (c, s) = harmonic.map_err(phase)?;
            x = algebra.sub(&x, &algebra.scale_by(&algebra.cosine(), &c));
            x = algebra.sub(&x, &algebra.scale_by(&algebra.sine(), &s));
        }
        self.take(n, x, constants.neg(&secular))
    }
}

impl<'a, A: PhaseAlgebra> Driver<'a, A> {
    pub(crate) fn start(
        algebra: &'a A,
        equation: &'a Equation<A>,
        request: &Request,
    ) -> Result<Self, ExpandError> {
        let constants = algebra.constants();
        let mut evaluator = Evaluator::new(algebra, equation);
        // The amplitude of the last order of a limit cycle needs one more.
        evaluator.last = Some(request.order + 1);
        let amplitude = constants.rational(&request.leading_amplitude);
        let inverse_amplitude =
            constants.reciprocal(&amplitude).ok_or(ExpandError::NoLimitCycle)?;
        let x0 = algebra.scale_by(&algebra.cosine(), &amplitude);
        evaluator.assign(&Node::Displacement, 0, x0.clone());
        evaluator.assign(&Node::Velocity, 0, algebra.derivative(&x0));

        let unit = |variable| {
            move |node: &Node<_>| (*node == variable).then(|| [algebra.one(), algebra.zero()])
        };
        let by_x = evaluator.tangents(&unit(Node::Displacement))?;
        let by_v = evaluator.tangents(&unit(Node::Velocity))?;
        let sensitive: Vec<bool> = by_x
            .iter()
            .zip(&by_v)
            .map(|(x, v)| !algebra.is_zero(&x[0]) || !algebra.is_zero(&v[0]))
            .collect();
        let root = equation.root();
        let stiffness = algebra
            .as_constant(&by_x[root][0])
            .filter(|_| algebra.is_zero(&by_v[root][0]))
            .ok_or(ExpandError::NotWeaklyNonlinear)?;
        let order_zero = evaluator.coefficient(root, 0)?;
        if !algebra.agrees(&order_zero, &algebra.scale_by(&x0, &stiffness)) {
            return Err(ExpandError::NotWeaklyNonlinear);
        }
        if constants.is_zero(&stiffness) {
            return Err(ExpandError::NoStiffness);
        }
        if equation.has_velocity() && stiffness != constants.one() {
            return Err(ExpandError::StiffnessNotOne);
        }
        let inverse_stiffness =
            constants.reciprocal(&stiffness).ok_or(ExpandError::SingularStiffness)?;
        let mut driver = Self {
            algebra,
            condition: request.condition,
            evaluator,
            stiffness,
            inverse_stiffness,
            inverse_amplitude,
            frequency_squared: vec![constants.one()],
            frequency: vec![constants.one()],
            slopes: vec![algebra.derivative(&x0)],
            second_derivatives: vec![algebra.neg(&x0)],
            x: vec![x0],
            sensitive,
            limit_cycle: None,
            by_first_harmonic: request.condition == Condition::FundamentalAmplitude,
            ahead: [Ahead::new(), Ahead::new()],
        };
        driver.forget(1);
        Ok(driver)
    }

    /// Order n, with all that follows from it at once.
    fn take(&mut self, n: usize, x: A::Element, squared: Constant<A>) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        self.frequency_squared.push(squared);
        self.extend_frequency(n);
        let slope = algebra.derivative(&x);
        self.second_derivatives.push(algebra.derivative(&slope));
        self.slopes.push(slope);
        self.forget(n);
        self.evaluator.assign(&Node::Displacement, n, x.clone());
        self.x.push(x);
        if self.evaluator.equation.has_velocity() {
            let velocity = self.velocity(n);
            self.evaluator.assign(&Node::Velocity, n, velocity);
        }
        if self.condition == Condition::LimitCycle && self.limit_cycle.is_none() {
            self.limit_cycle = Some(self.prepare_limit_cycle()?);
        }
        Ok(())
    }

    /// Fails after an interruption: the values of the order in progress mean nothing.
    pub(crate) fn go_on(&self, order: usize) -> Result<(), ExpandError> {
        if self.algebra.interrupted() { Err(ExpandError::Interrupted { order }) } else { Ok(()) }
    }

    /// Forgets provisional coefficients: those of order n and above that depend on x_n.
    pub(crate) fn forget(&mut self, n: usize) {
        self.evaluator.forget_from(n, &self.sensitive);
    }

    /// f_n.
    fn right_side(&mut self, n: usize) -> Result<A::Element, ExpandError> {
        let force = self.evaluator.coefficient(self.evaluator.equation.root(), n)?;
        self.look_ahead(Combined::Inertia, n);
        let mut terms = vec![(&force, &self.inverse_stiffness)];
        terms.extend(self.combined(Combined::Inertia, n));
        let f = self.algebra.linear_combination(&terms);
        Ok(self.algebra.neg(&f))
    }

    /// The amplitude of order n - 1 that removes the secular term in sin psi from order n.
    fn amplitude_shift(
        &self,
        sin_amplitude: &Constant<A>,
        n: usize,
    ) -> Result<Option<Constant<A>>, ExpandError> {
        let constants = self.algebra.constants();
        match &self.limit_cycle {
            Some(reaction) => {
                let shift = constants.mul(sin_amplitude, &reaction.inverse_sin);
                Ok(Some(constants.neg(&shift)))
            }
            None if constants.is_zero(sin_amplitude) => Ok(None),
            None => Err(ExpandError::AmplitudeDrifts { order: n }),
        }
    }

    /// Adds shift * cos psi to x_n, the last order known, and to all that was computed from it.
    fn shift_amplitude(&mut self, shift: &Constant<A>, n: usize) {
        let algebra = self.algebra;
        let Some(reaction) = &self.limit_cycle else { return };
        if algebra.constants().is_zero(shift) {
            return;
        }
        let change = algebra.scale_by(&algebra.cosine(), shift);
        algebra.add_assign(&mut self.x[n], &change);
        algebra.add_assign(&mut self.slopes[n], &algebra.derivative(&change));
        algebra.add_assign(&mut self.second_derivatives[n], &algebra.neg(&change));
        let corrections: Vec<A::Element> =
            reaction.of_nodes.iter().map(|change| algebra.scale_by(change, shift)).collect();
        self.evaluator.correct(n, &corrections);
    }

    /// omega_n from 2 omega_n = W_n - sum_{k=1}^{n-1} omega_k omega_{n-k}.
    fn extend_frequency(&mut self, n: usize) {
        let constants = self.algebra.constants();
        let pairs: Vec<_> = (1..n).map(|k| (&self.frequency[k], &self.frequency[n - k])).collect();
        let rest = constants.sub(&self.frequency_squared[n], &constants.sum_of_products(&pairs));
        self.frequency.push(constants.scale(&rest, &Rational::from((1, 2))));
    }

    /// f_n changes by -[dF]_1/kappa + W_1 cos psi when x_{n-1} changes by cos psi, because F is
    /// linear at order zero.
    fn prepare_limit_cycle(&mut self) -> Result<LimitCycleResponse<A>, ExpandError> {
        let (algebra, constants) = (self.algebra, self.algebra.constants());
        let direction = algebra.cosine();
        let slope = algebra.derivative(&direction);
        let slopes = [slope.clone(), algebra.scale_by(&slope, &self.frequency[1])];
        // At x_1 = 0, where order 1 of F is its explicit dependence on eps.
        let mut alone = Evaluator::new(algebra, self.evaluator.equation);
        alone.assign(&Node::Displacement, 0, self.x[0].clone());
        alone.assign(&Node::Velocity, 0, algebra.derivative(&self.x[0]));
        let velocity = algebra.scale_by(&algebra.derivative(&self.x[0]), &self.frequency[1]);
        alone.assign(&Node::Velocity, 1, velocity);
        let change = |node: &Node<_>| match node {
            Node::Displacement => Some([direction.clone(), algebra.zero()]),
            Node::Velocity => Some(slopes.clone()),
            _ => None,
        };
        let tangents = alone.tangents(&change)?;
        let force = &tangents[self.evaluator.equation.root()][1];
        let mut change = algebra.neg(&algebra.scale_by(force, &self.inverse_stiffness));
        let inertia = algebra.scale_by(&direction, &self.frequency_squared[1]);
        algebra.add_assign(&mut change, &inertia);
        let split =
            algebra.resolve(&change).map_err(|source| ExpandError::Phase { order: 1, source })?;
        let inverse_sin =
            constants.reciprocal(&split.sin_amplitude).ok_or(ExpandError::DegenerateLimitCycle)?;
        Ok(LimitCycleResponse {
            of_nodes: tangents.into_iter().map(|[zero, _]| zero).collect(),
            cos: split.cos_amplitude,
            inverse_sin,
            response: split.response,
        })
    }

    /// The amplitude of the last order of a limit cycle is fixed by the order after it.
    pub(crate) fn finish(mut self, work: Vec<OrderWork>) -> Result<Expansion<A>, ExpandError> {
        let algebra = self.algebra;
        let order = self.x.len() - 1;
        // The order in progress when it was interrupted may have its frequency already.
        self.frequency_squared.truncate(order + 1);
        if self.condition == Condition::LimitCycle && order > 0 {
            self.go_on(order)?;
        }
        if self.limit_cycle.is_some() {
            let f = self.right_side(order + 1)?;
            let phase = |source| ExpandError::Phase { order: order + 1, source };
            let (_, sin_amplitude) = algebra.first_harmonic(&f).map_err(phase)?;
            self.go_on(order)?;
            if let Some(shift) = self.amplitude_shift(&sin_amplitude, order + 1)? {
                self.shift_amplitude(&shift, order);
            }
        }
        let amplitude = self.x.iter().filter_map(|x| algebra.at_zero(x)).collect();
        Ok(Expansion {
            condition: self.condition,
            stiffness: self.stiffness,
            frequency_squared: self.frequency_squared,
            amplitude,
            solution: self.x,
            work,
            certificates: self.evaluator.certificates(order),
        })
    }
}
