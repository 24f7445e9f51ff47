//! Algebras of polynomials in complex amplitudes.

use crate::{ForcedAlgebra, PhaseError};
use rug::Rational;

/// What averaging with resonance asks of an algebra of polynomials in the amplitudes z_1, zbar_1, ...,
/// z_M, zbar_M and in E_l = e^{i eta_l}, eta_1, ..., eta_L the phases of the forces.
///
/// At order zero z_j' = i nu_j z_j and eta_l' = Omega_l, so that D_0 = d/dt multiplies the monomial
/// z^p zbar^q E^m by i lambda, lambda = sum_j (p_j - q_j) nu_j + sum_l m_l Omega_l. Laws: D_0 and the
/// derivatives satisfy Leibniz' rule, conjugation is a homomorphism that exchanges z_j with zbar_j and E_l
/// with 1/E_l.
pub trait AmplitudeAlgebra: ForcedAlgebra {
    /// M.
    fn unknowns(&self) -> usize;
    /// L.
    fn forces(&self) -> usize;
    /// nu_j^2, as a constant.
    fn frequency_squared(&self, j: usize) -> Self::Element;
    /// Omega_l, as a constant.
    fn force_rate(&self, l: usize) -> Self::Element;
    /// z_j; 0 where the unknown has no amplitude of its own.
    fn amplitude(&self, j: usize) -> Self::Element;
    /// The complex conjugate.
    fn conjugate(&self, f: &Self::Element) -> Self::Element;
    /// f + conj f.
    fn twice_real(&self, f: &Self::Element) -> Self::Element;
    /// df/dz_j.
    fn by_amplitude(&self, f: &Self::Element, j: usize) -> Self::Element;
    /// df/deta_l.
    fn by_force(&self, f: &Self::Element, l: usize) -> Self::Element;
    /// D_0 f.
    fn by_time(&self, f: &Self::Element) -> Self::Element;
    /// Solves (D_0^2 + nu_j^2) u + 2 i nu_j f + conj(2 i nu_j f) = g for a real g: monomials of the
    /// eigenvalue lambda = nu_j > 0 go to f, those of -nu_j to its conjugate, the others are divided by
    /// nu_j^2 - lambda^2 and go to u. So u is real and has no monomial with |lambda| = nu_j.
    ///
    /// # Errors
    /// [`PhaseError::Undecided`] for a divisor that cannot be told from zero.
    fn split(&self, j: usize, g: &Self::Element) -> Result<Split<Self>, PhaseError>;
    /// Whether f has no monomial with |lambda| = nu_j.
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool;
}

/// The result of [`AmplitudeAlgebra::split`].
#[derive(Clone, Debug)]
pub struct Split<A: AmplitudeAlgebra + ?Sized> {
    /// f.
    pub flow: A::Element,
    /// u.
    pub response: A::Element,
    /// The smallest divisor among those that are numbers: p_1 - q_1, ..., p_M - q_M, m_1, ..., m_L of its
    /// harmonic and (nu_j^2 - lambda^2)/nu_j^2, of enclosures their middle.
    pub nearest: Option<(Vec<i32>, Rational)>,
}
