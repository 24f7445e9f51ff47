//! Algebras of functions of an amplitude, a fast phase and a forcing phase.

use crate::{ForcedAlgebra, FunctionAlgebra, LinearPart, PhaseError, Ring};

/// Shorthand for the functions of the amplitude.
type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// What the method of Krylov, Bogoliubov and Mitropolsky asks of an algebra of functions of the
/// amplitude a, the phase psi and the phase eta of a force; the constants are functions of a.
///
/// At order zero psi advances at the rate omega_0 and eta at the rate omega, so that
/// d/dt = D_0 = omega_0 d/dpsi + omega d/deta, and f(t - T) = exp(-T D_0) f.
pub trait AveragingAlgebra: ForcedAlgebra {
    /// a cos psi.
    fn generating_solution(&self) -> Self::Element;
    /// The amplitudes of cos psi and sin psi in f, functions of a.
    fn first_harmonic_of(&self, f: &Self::Element) -> [Constant<Self>; 2];
    /// df/da.
    fn by_amplitude(&self, f: &Self::Element) -> Self::Element;
    /// df/dpsi.
    fn by_phase(&self, f: &Self::Element) -> Self::Element;
    /// D_0 f.
    fn by_time(&self, f: &Self::Element) -> Self::Element;
    /// exp(-T D_0) f for the delay T of that position.
    fn shift(&self, f: &Self::Element, delay: usize) -> Option<Self::Element>;
    /// T itself.
    fn delay(&self, delay: usize) -> Option<Constant<Self>>;
    /// Splits f into its resonant part and the rest, and solves
    ///
    ///   L(D_0) u + L'(D_0) (A d/da + B d/dpsi) (a cos psi) = f
    ///
    /// for u without the harmonic cos psi, sin psi, and for A and B, functions of a.
    ///
    /// # Errors
    /// [`PhaseError::Resonance`] where L vanishes at a combination frequency,
    /// [`PhaseError::Indivisible`] where the ring of coefficients cannot divide by L.
    fn average(
        &self,
        linear: &LinearPart<Constant<Self>>,
        f: &Self::Element,
    ) -> Result<Averaged<Self>, PhaseError>;
}

/// The result of [`AveragingAlgebra::average`]: A, B and u of
/// L(D_0) u + L'(D_0) (A d/da + B d/dpsi) (a cos psi) = f, unique since u has no first harmonic.
#[derive(Clone, Debug)]
pub struct Averaged<A: AveragingAlgebra + ?Sized> {
    /// A.
    pub amplitude_rate: Constant<A>,
    /// B.
    pub phase_rate: Constant<A>,
    /// u.
    pub response: A::Element,
}
