//! The equivalent flow of Krylov, Bogoliubov and Mitropolsky, as numbers.
//!
//! The averaged equations a' = R a, psi' = alpha0 of any order are the Taylor series in eps of the
//! characteristic root lambda = R + i alpha0 of the delayed flight without impacts,
//! lambda^2 + alpha^2 = eps g(lambda), g(l) = (A + B l)(1 - e^(-l T)) - c l, lambda(0) = i alpha.
//! This recursion shares no code with the symbolic derivation and serves as its witness.

use crate::error::ImpactError;
use crate::parameters::Parameters;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// An equivalent free flow x'' - 2 R x' + (R^2 + Omega^2) x = 0.
#[derive(Clone, Debug)]
pub struct Flow<S> {
    /// R, growth rate of the amplitude.
    pub growth_rate: S,
    /// Omega = alpha0, angular frequency.
    pub frequency: S,
}

/// The numbers lambda_0, ..., lambda_N with the sums they give.
#[derive(Clone, Debug)]
pub struct Rates<S> {
    /// lambda_n = R_n + i alpha0_n; lambda_0 = i alpha.
    pub terms: Vec<Complex<S>>,
}

/// lambda_0, ..., lambda_order by the recursion
///
/// ```text
/// e_0 = exp(-i alpha T)
/// G_(m-1)  = A (delta_(m,1) - e_(m-1)) + (B - c) lambda_(m-1) - i alpha B e_(m-1)
/// w_m      = B e_m + lambda_(m+1)
/// lambda_m = (G_(m-1) - sum_(j=1..m-1) lambda_j w_(m-1-j))/(2 i alpha)
/// e_m      = -(T/m) sum_(j=1..m) j lambda_j e_(m-j)
/// ```
///
/// The products with lambda_j of B sum_j lambda_j e_(m-1-j) and of sum_j lambda_j lambda_(m-j) are one, with w.
///
/// Cost: order^2 multiplications. Certified for balls; for doubles a few ulp times the order.
pub fn rates<S: Real>(parameters: &Parameters<S>, order: usize) -> Rates<S> {
    let mut scratch = Scratch::new(order);
    let time = parameters.period();
    scratch.fill(parameters, &time, &free_delay(parameters, &time), order);
    Rates { terms: scratch.terms }
}

/// e_0 = exp(-i alpha T).
pub(crate) fn free_delay<S: Real>(parameters: &Parameters<S>, time: &S) -> Complex<S> {
    let (sin, cos) = (parameters.alpha.clone() * time).sin_cos();
    Complex::new(cos, -sin)
}

/// Buffers of the recursion, reused along a chart.
pub(crate) struct Scratch<S> {
    /// lambda_n.
    pub(crate) terms: Vec<Complex<S>>,
    /// n lambda_n, from n = 1 on.
    slopes: Vec<Complex<S>>,
    /// e_n.
    delayed: Vec<Complex<S>>,
    /// w_n.
    coupled: Vec<Complex<S>>,
    /// The sum of all lambda_n.
    sum: Option<Complex<S>>,
}

impl<S: Real> Scratch<S> {
    pub(crate) fn new(order: usize) -> Self {
        let buffer = || Vec::with_capacity(order.min(1 << 16) + 1);
        Self { terms: buffer(), slopes: buffer(), delayed: buffer(), coupled: buffer(), sum: None }
    }
    /// Runs the recursion; allocates only while the buffers grow.
    #[inline(always)]
    pub(crate) fn fill(
        &mut self,
        parameters: &Parameters<S>,
        time: &S,
        delay: &Complex<S>,
        order: usize,
    ) {
        let Parameters { alpha, damping, displacement_gain: a, velocity_gain: b, .. } = parameters;
        for buffer in [&mut self.terms, &mut self.slopes, &mut self.delayed, &mut self.coupled] {
            buffer.clear();
        }
        let free = Complex::new(alpha.integer(0), alpha.clone());
        // The last numbers by themselves: read back from a list they would wait for the list to be written.
        let (mut sum, mut last, mut e) = (free.clone(), free.clone(), delay.clone());
        self.terms.push(free);
        self.delayed.push(delay.clone());
        let half_inverse = alpha.integer(1) / alpha.doubled();
        let loss = b.clone() - damping;
        for m in 1..=order {
            let driven = e.scaled(b);
            let mut g = last.scaled(&loss) - e.scaled(a);
            if m == 1 {
                g.re = g.re + a;
            }
            g.re = g.re + driven.im.clone() * alpha;
            g.im = g.im - driven.re.clone() * alpha;
            let minus = (-g).plus_products(self.terms[1..].iter().zip(self.coupled.iter().rev()));
            // 1/(2 i alpha)
            let next = Complex::new(-(minus.im * &half_inverse), minus.re * &half_inverse);
            if m < order {
                e = self.continue_with(&next, driven, time);
                self.delayed.push(e.clone());
            }
            sum = sum + &next;
            self.terms.push(next.clone());
            last = next;
        }
        self.sum = Some(sum);
    }
    /// w_(m-1) and e_m from lambda_m and B e_(m-1).
    #[inline(always)]
    fn continue_with(&mut self, next: &Complex<S>, driven: Complex<S>, time: &S) -> Complex<S> {
        let m = i64::try_from(self.terms.len()).unwrap_or(i64::MAX);
        let weight = time.integer(m);
        self.coupled.push(driven + next);
        self.slopes.push(next.scaled(&weight));
        let sum = Complex::real(time.integer(0))
            .plus_products(self.slopes.iter().zip(self.delayed.iter().rev()));
        sum.scaled(&-(time.clone() / weight))
    }
    /// The flow of the sum of all terms (eps = 1).
    #[inline(always)]
    pub(crate) fn flow(&self) -> Option<Flow<S>> {
        let Complex { re, im } = self.sum.clone()?;
        Some(Flow { growth_rate: re, frequency: im })
    }
}

impl<S: Real> Rates<S> {
    /// R and alpha0 of the given order at eps = 1: the sums of the terms up to there (all of them
    /// where the order exceeds the series).
    pub fn flow(&self, order: usize) -> Option<Flow<S>> {
        let (first, rest) = self.terms.split_first()?;
        let sum = rest.iter().take(order).fold(first.clone(), |sum, term| sum + term);
        Some(Flow { growth_rate: sum.re, frequency: sum.im })
    }
}

impl<S: Real> Flow<S> {
    /// The free flow of the uncontrolled oscillator: R = -c/2, Omega = sqrt(alpha^2 - c^2/4).
    ///
    /// # Errors
    /// [`ImpactError::Overdamped`] unless c < 2 alpha.
    pub fn uncontrolled(parameters: &Parameters<S>) -> Result<Self, ImpactError> {
        let half = parameters.damping.halved();
        let below = parameters.alpha.clone() - &half;
        if !below.is_positive() {
            let limit = parameters.alpha.to_f64() * 2.0;
            return Err(ImpactError::Overdamped { damping: parameters.damping.to_f64(), limit });
        }
        let above = parameters.alpha.clone() + &half;
        Ok(Self { growth_rate: -half, frequency: (below * above).sqrt() })
    }
    /// Refuses a flow that does not oscillate.
    ///
    /// # Errors
    /// [`ImpactError::NotApplicable`] unless Omega > 0 and both numbers are finite.
    #[inline(always)]
    pub fn validate(&self) -> Result<(), ImpactError> {
        if self.frequency.is_positive()
            && self.frequency.is_finite()
            && self.growth_rate.is_finite()
        {
            return Ok(());
        }
        Err(ImpactError::NotApplicable { frequency: self.frequency.to_f64() })
    }
    /// |lambda^2 + alpha^2 - g(lambda)| for lambda = R + i Omega: zero for the full root.
    pub fn residual(&self, parameters: &Parameters<S>) -> S {
        let lambda = Complex::new(self.growth_rate.clone(), self.frequency.clone());
        characteristic(parameters, &parameters.period(), &lambda).0.modulus()
    }
}

/// f(l) = l^2 + alpha^2 - g(l) and f'(l).
fn characteristic<S: Real>(
    parameters: &Parameters<S>,
    time: &S,
    lambda: &Complex<S>,
) -> (Complex<S>, Complex<S>) {
    let Parameters { alpha, damping, displacement_gain: a, velocity_gain: b, .. } = parameters;
    let delayed = (-lambda.scaled(time)).exp();
    let loop_gain = Complex::real(a.clone()) + lambda.scaled(b);
    let difference = Complex::real(alpha.integer(1)) - &delayed;
    let g = loop_gain.clone() * &difference - lambda.scaled(damping);
    let slope =
        difference.scaled(b) + (loop_gain * &delayed).scaled(time) - Complex::real(damping.clone());
    let value = lambda.clone() * lambda + Complex::real(alpha.square()) - g;
    (value, lambda.scaled(&alpha.integer(2)) - slope)
}

/// The full characteristic root continued from i alpha at eps = 0 to eps = 1, by Newton's method
/// with a step in eps that halves on failure.
///
/// Estimated: midpoints without an error bound; see [`Flow::residual`]. The free delay equation
/// has infinitely many other roots.
///
/// # Errors
/// [`ImpactError::NoConvergence`] where the path meets a branch point.
pub fn characteristic_root<S: Real>(parameters: &Parameters<S>) -> Result<Flow<S>, ImpactError> {
    let time = parameters.period();
    let at = |eps: f64| {
        let factor = time.number(eps);
        Parameters {
            damping: parameters.damping.clone() * &factor,
            displacement_gain: parameters.displacement_gain.clone() * &factor,
            velocity_gain: parameters.velocity_gain.clone() * &factor,
            ..parameters.clone()
        }
    };
    let mut lambda = Complex::new(time.integer(0), parameters.alpha.clone());
    let (mut eps, mut step) = (0.0, 0.125_f64);
    while eps < 1.0 {
        let target = (eps + step).min(1.0);
        let limit = 0.2 * parameters.alpha.to_f64();
        match newton(&at(target), &time, &lambda, limit, 40) {
            Some(next) => {
                (lambda, eps, step) = (next, target, step * 1.5);
            }
            None if step > 1e-4 => step *= 0.5,
            None => return Err(ImpactError::NoConvergence { what: "the characteristic root" }),
        }
    }
    let bits = time.precision();
    let rounds = 8 + usize::try_from(bits.ilog2()).unwrap_or(0);
    let lambda = newton(parameters, &time, &lambda, f64::INFINITY, rounds)
        .ok_or(ImpactError::NoConvergence { what: "the characteristic root" })?;
    Ok(Flow { growth_rate: lambda.re, frequency: lambda.im })
}

/// Newton's method from `start`; `None` if it leaves the disc of radius `limit` or does not settle.
fn newton<S: Real>(
    parameters: &Parameters<S>,
    time: &S,
    start: &Complex<S>,
    limit: f64,
    rounds: usize,
) -> Option<Complex<S>> {
    let mut lambda = start.clone();
    let resolution = 2.0_f64.powi(-(time.precision().min(1000) as i32) + 8);
    let mut last = f64::INFINITY;
    for _ in 0..rounds {
        let (value, slope) = characteristic(parameters, time, &lambda);
        let step = value.over(&slope).centre();
        lambda = (lambda - &step).centre();
        let size = step.to_f64().modulus();
        if !size.is_finite() || (lambda.clone() - start).to_f64().modulus() > limit {
            return None;
        }
        if size <= resolution || (size >= last && size < 1e-10) {
            return Some(lambda);
        }
        last = size;
    }
    (last < 1e-10).then_some(lambda)
}
