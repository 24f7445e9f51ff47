//! The slow flow of a problem: averaging at resonance and of several unknowns.

use crate::averaging::Averaging;
use crate::{Answer, DerivationError, Error, Oscillator, SlowFlow, Work};
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::check_parameters;
use lindstedt_derivation::resonance::{
    self, Detuned, NormalMode, ResonanceError, Sought, SoughtBranch,
};
use lindstedt_equation::Expression;
use lindstedt_expand::Excitation;
use serde::Serialize;
use std::time::Instant;

/// Averaged equations: those of amplitude and phase, or of complex amplitudes where a force is in
/// resonance or detuned, or where there are several unknowns.
///
/// ```
/// use lindstedt::{Averaged, Oscillator, Work};
/// let cycle = Oscillator::parse("x'' + x = eps*(1 - x^2)*x'")?;
/// let locked = Oscillator::parse("x'' + x = eps*(1 - x^2)*x' + eps*F*cos(t)")?;
/// assert!(matches!(cycle.averaged(1, &Work::default())?.value, Averaged::Polar(_)));
/// assert!(matches!(locked.averaged(1, &Work::default())?.value, Averaged::Flow(_)));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Averaged {
    /// Krylov, Bogoliubov, Mitropolsky.
    Polar(Averaging),
    /// At resonance.
    Flow(SlowFlow),
}

impl Oscillator {
    /// The averaged equations, by [`Self::average`] where the amplitude and the phase of one unknown are all,
    /// by [`Self::slow_flow`] at a resonance (met at whichever order), with a detuned force, or for several
    /// unknowns.
    ///
    /// # Errors
    /// Those of both.
    ///
    /// ```
    /// use lindstedt::{Averaged, Oscillator, Work};
    /// let spring = Oscillator::parse("x'' + x + eps*x*y; y'' + 4*y + eps*x^2")?;
    /// let Averaged::Flow(flow) = spring.averaged(1, &Work::default())?.value else { panic!() };
    /// // f_11 = (i/2) zbar_1 z_2: the modes exchange their energy.
    /// assert_eq!(flow.flow[0][1][0].exponents, [0, 1, 1, 0, 0]);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn averaged(&self, order: usize, work: &Work) -> Result<Answer<Averaged>, Error> {
        let flow = || Ok(self.slow_flow(order, work)?.map(Averaged::Flow));
        if self.has_flow_alone() {
            check_parameters(self.problem(), &self.entering_coefficients())?;
            return flow();
        }
        // A frequency that was given beside a resonance is swept by its detuning.
        if resonance::is_beside(self.problem(), self.given())
            && let Ok(found) = flow()
        {
            return Ok(found);
        }
        match self.average(order, work) {
            // A delay tied to the period of the force is averaging's, and so is the reason why it fails there.
            Err(error) if error.is_resonance() => flow().map_err(|flow| match flow {
                Error::Derivation(DerivationError::Resonance(ResonanceError::Delay { .. })) => {
                    error
                }
                other => other,
            }),
            // An irrational frequency beside a force is enclosed.
            Err(error) if error.is_irrational_frequency() => flow().map_err(|flow| match flow {
                Error::Derivation(DerivationError::Resonance(_)) => error,
                other => other,
            }),
            other => Ok(other?.map(Averaged::Polar)),
        }
    }

    /// Whether amplitude and phase are not all: several unknowns, a force whose phase contains the small
    /// parameter or the root of a number, or forces that are no harmonics of one phase.
    pub(crate) fn has_flow_alone(&self) -> bool {
        let root = |e: &Expression| match e {
            Expression::Power(base, n) => {
                base.as_number().is_some() && n.as_number().is_some_and(|n| !n.is_integer())
            }
            other => *other == Expression::Small,
        };
        let detuned = |e: &Expression| match e {
            Expression::Function(_, angle) => {
                angle.contains(&Expression::Time) && angle.nodes().any(root)
            }
            _ => false,
        };
        let problem = self.problem();
        let late = |e: &Expression| matches!(e, Expression::Unknown(x) if x.delay.is_some());
        let several = || {
            let second = Excitation::of(&problem.equation).is_err();
            second && !problem.equation.nodes().any(late)
        };
        !problem.others.is_empty() || problem.equation.nodes().any(detuned) || several()
    }

    /// The slow flow up to an order: with complex amplitudes z_j, E = e^{i eta} and the phase eta of the
    /// force,
    ///
    ///   x_j = z_j + zbar_j + ..., z_j' = i nu_j z_j + sum eps^n f_{j,n}(z, zbar, E),
    ///   eta' = Omega + eps sigma_1 + ...,
    ///
    /// whatever is resonant at whichever order. Parameters that are not set stay symbols; what a
    /// frequency depends on takes the value of the problem. A force beside a resonance is detuned: by
    /// `cos((1 + eps*sigma)*t)` as it is written, or by the symbol sigma = (omega - Omega)/eps where omega is
    /// a number; forces that are no harmonics of one phase have phases eta_1, eta_2, ... of their own, and a
    /// parameter without a value in their rates is independent of all others. Exact, and substituted into the
    /// equation. Cost: O(N^2) products of polynomials whose length
    /// grows like N^(symbols + 1).
    ///
    /// # Errors
    /// [`Error`] with the reason: multiple modes with an irrational square, a linear part without modes, a
    /// divisor that is almost zero, each by name; a symbol named like z, E, eta, a, psi, gamma, nu_j or f_j.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// let forced = Oscillator::parse("x'' + x + eps*x^3 = eps*F*cos((1 + eps*sigma)*t)")?;
    /// let flow = forced.slow_flow(2, &Work::default())?.value;
    /// // f_1 = -(i/4) F E + (3/2) i z^2 zbar: exponents of z, zbar, E, F, sigma.
    /// let first: Vec<_> = flow.flow[0][1].iter().map(|t| (&t.exponents[..], t.im.to_string())).collect();
    /// assert!(first.contains(&(&[0, 0, 1, 1, 0], "-1/4".to_owned())));
    /// assert!(first.contains(&(&[2, 1, 0, 0, 0], "3/2".to_owned())));
    /// assert_eq!(flow.checked_orders, Some(2));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn slow_flow(&self, order: usize, work: &Work) -> Result<Answer<SlowFlow>, Error> {
        // Order zero has the symbols of all.
        let names = self.flow(0, work)?.value.check_names();
        names.map_err(|error| self.refusal(error.into()))?;
        self.flow(order, work)
    }

    /// The slow flow for those who do not print it: its symbols may have any names.
    pub(crate) fn flow(&self, order: usize, work: &Work) -> Result<Answer<SlowFlow>, Error> {
        self.flow_detuned(Detuned::Beside, order, work)
    }

    /// The same with the force detuned as it is asked for.
    pub(crate) fn flow_detuned(
        &self,
        detuned: Detuned<'_>,
        order: usize,
        work: &Work,
    ) -> Result<Answer<SlowFlow>, Error> {
        self.check_frequencies()?;
        let start = Instant::now();
        self.values_without_pi()?;
        let settings = self.averaging(order, work);
        let (problem, mut goes_on) = (self.problem(), |progress| work.goes_on(progress));
        let found = resonance::slow_flow(problem, &settings, detuned, &mut goes_on);
        let value = found.map_err(|error| self.refusal(error.into()))?;
        let orders = (order, value.order, value.checked_orders.is_some());
        let tier = if value.enclosed.is_some() { "certified" } else { "exact" };
        let remarks = self.remarks().to_vec();
        let answer = self.finished(&value.system.bound, orders, tier, remarks, start);
        Ok(answer.map(|()| value))
    }

    fn averaging(&self, order: usize, work: &Work) -> AveragingSettings {
        AveragingSettings {
            order,
            parameters: self.given().clone(),
            digits: work.printed_digits(),
            stop: work.stop.clone(),
            memory: work.memory,
        }
    }

    /// The parameter that the problem file seeks (`unknown = "a"`).
    ///
    /// ```
    /// use lindstedt::Oscillator;
    /// let text = "equation = \"x'' + (a - 2*eps*cos(2*t))*x = 0\"\nunknown = \"a\"";
    /// assert_eq!(Oscillator::file(text)?.unknown(), Some("a"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    #[must_use]
    pub fn unknown(&self) -> Option<&str> {
        self.problem_file().unknown.as_deref()
    }

    /// The parameter `name` as a series in the small parameter, for which a motion x = A cos(nu t) + ... or
    /// A sin(nu t) + ... of the forced oscillator stays periodic, nu^2 being its linear stiffness at the value
    /// of the parameter: solvability fixes it order by order. For Mathieu's equation the edges of the tongues.
    /// Exact, and substituted back.
    ///
    /// # Errors
    /// [`Error`] with the reason: no value given, no rational nu, no value that keeps the motion periodic.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work, unstable::coeff::print::Style};
    /// let mathieu = Oscillator::parse("x'' + (a - 2*eps*cos(2*t))*x = 0")?.set("a", "4")?;
    /// let found = mathieu.parameter_series("a", 4, &Work::default())?.value;
    /// // a_2(q) of DLMF 28.6.
    /// assert_eq!(found.print_series(&found.branches[0], Style::Text), "4 + 5/12*eps^2 - 763/13824*eps^4");
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn parameter_series(
        &self,
        name: &str,
        order: usize,
        work: &Work,
    ) -> Result<Answer<Sought>, Error> {
        let start = Instant::now();
        self.values_without_pi()?;
        // Order zero is the linear equation: nothing is sought in it.
        let settings = self.averaging(order.max(1), work);
        let mut goes_on = |progress| work.goes_on(progress);
        let found = resonance::sought(self.problem(), name, &settings, &mut goes_on);
        let value = found.map_err(|error| self.refusal(error.into()))?;
        let done = value.branches.iter().map(SoughtBranch::order).min().unwrap_or(0);
        let checked = value.branches.iter().all(|branch| branch.checked_orders.is_some());
        let (orders, remarks) = ((order, done, checked), self.remarks().to_vec());
        Ok(self.finished(self.given(), orders, "exact", remarks, start).map(|()| value))
    }

    /// A nonlinear normal mode, by its number from 1: all unknowns move with one frequency,
    ///
    ///   Omega^2 = nu^2 (1 + sum eps^n w_n(rho)),   x_i = sum eps^n x_{i,n}(a, psi),   psi' = Omega,
    ///
    /// rho = a^2 and a the amplitude of the first harmonic of the mode: backbone and shape, from the slow flow
    /// with the amplitude of this mode alone. Exact, where squares of frequencies are irrational enclosed, and
    /// substituted back.
    ///
    /// # Errors
    /// [`Error`] with the reason: a force, internal resonance, multiple modes with an irrational square.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work, unstable::coeff::print::Style};
    /// let masses = Oscillator::parse("x'' + 2*x - y + eps*x^3/2; y'' + 2*y - x")?;
    /// let mode = masses.normal_mode(2, 1, &Work::default())?.value;
    /// assert_eq!(mode.square, 3);
    /// assert_eq!(mode.print_in_amplitude(&mode.frequency_squared, Style::Text), "1 + 1/16*rho*eps");
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn normal_mode(
        &self,
        mode: usize,
        order: usize,
        work: &Work,
    ) -> Result<Answer<NormalMode>, Error> {
        let start = Instant::now();
        self.values_without_pi()?;
        let settings = self.averaging(order, work);
        let mut goes_on = |progress| work.goes_on(progress);
        let found = resonance::normal_mode(self.problem(), mode, &settings, &mut goes_on);
        let value = found.map_err(|error| self.refusal(error.into()))?;
        let orders = (order, value.order, value.checked_orders.is_some());
        let tier = if value.enclosed.is_some() { "certified" } else { "exact" };
        let remarks = self.remarks().to_vec();
        Ok(self.finished(self.given(), orders, tier, remarks, start).map(|()| value))
    }
}
