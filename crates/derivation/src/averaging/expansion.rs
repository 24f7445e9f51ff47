//! An averaged expansion in amplitude and phase.

use lindstedt_coeff::amplitude::AmplitudePolynomial;
use lindstedt_expand::resonance::SlowFlow;
use lindstedt_phase::amplitudes::polar::{Polar, Read};
use lindstedt_phase::amplitudes::scalars::Scalars;
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes};
use std::fmt::Debug;

/// x = a cos psi + sum eps^n u_n(a, psi, eta), da/dt = sum eps^n A_n(a), dpsi/dt = omega_0 + sum eps^n B_n(a); the u_n
/// have no first harmonic in psi, so a is the amplitude of the first harmonic. Time is that of the equation.
#[derive(Clone, Debug)]
pub struct AveragedExpansion<N> {
    /// A_0 = 0, A_1(a), A_2(a), ...: da/dt.
    pub amplitude_rate: Vec<AmplitudePolynomial<N>>,
    /// B_0 = 0, B_1(a), ...: dpsi/dt - omega_0.
    pub phase_rate: Vec<AmplitudePolynomial<N>>,
    /// u_0 = a cos psi + the forced response, u_1, ...
    pub solution: Vec<Polar<N>>,
}

impl<N: Clone + PartialEq + Debug + Send + Sync> AveragedExpansion<N> {
    /// A slow flow of one unknown, z = (a/2) e^(i psi), with the real and the imaginary part of its constants as `read`
    /// makes numbers of them ([`Amplitudes::parts`]); nothing where a force occurs in it.
    pub fn of<S: Scalars>(
        algebra: &Amplitudes<S>,
        found: &SlowFlow<AmplitudeElement<S::Element>>,
        read: Read<'_, S::Element, N>,
    ) -> Option<Self> {
        let (flow, solution) = found.flow.first().zip(found.solution.first())?;
        let rates =
            flow.iter().map(|f| algebra.polar_rates(f, read)).collect::<Option<Vec<_>>>()?;
        let (amplitude_rate, phase_rate) = rates.into_iter().map(|[a, b]| (a, b)).unzip();
        let solution = solution.iter().map(|x| algebra.polar(x, read)).collect::<Option<_>>()?;
        Some(Self { amplitude_rate, phase_rate, solution })
    }

    /// The highest order derived.
    pub fn order(&self) -> usize {
        self.solution.len().saturating_sub(1)
    }
}
