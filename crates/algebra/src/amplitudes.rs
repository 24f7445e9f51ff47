//! Algebras of polynomials in complex amplitudes.

use crate::{ForcedAlgebra, FunctionAlgebra, PhaseError, Ring};
use rug::Rational;

/// What averaging with resonance asks of an algebra of polynomials in the amplitudes z_1, zbar_1, ...,
/// z_M, zbar_M and in E_l = e^{i eta_l}, eta_1, ..., eta_L the phases of the forces.
///
/// At order zero z_j' = i nu_j z_j and eta_l' = Omega_l, so that D_0 = d/dt multiplies the monomial
/// z^p zbar^q E^m by i lambda, lambda = sum_j (p_j - q_j) nu_j + sum_l m_l Omega_l. Laws: D_0 and the
/// derivatives satisfy Leibniz' rule, conjugation is a homomorphism that exchanges z_j with zbar_j and E_l
/// with 1/E_l; so does f(t - T) = exp(-T D_0) f for a delay T.
pub trait AmplitudeAlgebra: ForcedAlgebra + FunctionAlgebra<Constants = Self> + Sized {
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
    /// sum f dg/dz_j + conj for pairs of any f and a real g: the rates of change of the g where z_j' = f.
    fn along(&self, j: usize, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let slopes: Vec<_> = pairs.iter().map(|(_, g)| self.by_amplitude(g, j)).collect();
        let pairs: Vec<_> = pairs.iter().zip(&slopes).map(|((f, _), slope)| (*f, slope)).collect();
        self.twice_real(&self.sum_of_products(&pairs))
    }
    /// c_j, d_j and r without amplitudes, with f = sum_j (c_j z_j + d_j zbar_j) + r over the unknowns that have one;
    /// nothing for other f.
    fn linear_parts(&self, f: &Self::Element) -> Option<LinearParts<Self::Element>>;
    /// df/deta_l.
    fn by_force(&self, f: &Self::Element, l: usize) -> Self::Element;
    /// D_0 f.
    fn by_time(&self, f: &Self::Element) -> Self::Element;
    /// exp(-T D_0) f for the delay T of that position.
    fn shift(&self, f: &Self::Element, delay: usize) -> Option<Self::Element>;
    /// T itself.
    fn delay(&self, delay: usize) -> Option<Self::Element>;
    /// Solves L(D_0) u + L'(i nu_j) f + conj(L'(i nu_j) f) = g for a real g, L the characteristic function of the linear
    /// part of unknown j, of which i nu_j is a root where the unknown has an amplitude: monomials of the eigenvalue
    /// lambda = nu_j > 0 go to f, those of -nu_j to its conjugate, the others are divided by L(i lambda) and go to u. So
    /// u is real and has no monomial with |lambda| = nu_j.
    ///
    /// # Errors
    /// [`PhaseError::Undecided`] for a divisor that cannot be told from zero. An algebra that takes all but z_j itself to be
    /// off resonance refuses what is not: [`PhaseError::Resonance`], [`PhaseError::NearMiss`],
    /// [`PhaseError::Indivisible`].
    fn split(
        &self,
        j: usize,
        linear: &LinearPart<Self::Element>,
        g: &Self::Element,
    ) -> Result<Split<Self>, PhaseError>;
    /// Whether f has no monomial with |lambda| = nu_j.
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool;
}

/// The linear part at order zero, x'' + damping x' + stiffness x + sum_j (b_j + c_j d/dt) x(t - T_j),
/// with the characteristic function L(lambda) = lambda^2 + damping lambda + stiffness
/// + sum_j (b_j + c_j lambda) e^(-lambda T_j).
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPart<E> {
    /// The factor of x.
    pub stiffness: E,
    /// The factor of x'.
    pub damping: E,
    /// (b_j, c_j) for every delay.
    pub delayed: Vec<(E, E)>,
}

impl<E> LinearPart<E> {
    /// Whether there is neither damping nor delay.
    pub fn is_free<R: Ring<Element = E>>(&self, ring: &R) -> bool {
        let vanish = |list: [&E; 2]| list.into_iter().all(|c| ring.is_zero(c));
        ring.is_zero(&self.damping) && self.delayed.iter().all(|(b, c)| vanish([b, c]))
    }
}

/// The result of [`AmplitudeAlgebra::linear_parts`]: c_j and d_j, and r.
pub type LinearParts<E> = (Vec<[E; 2]>, E);

/// The result of [`AmplitudeAlgebra::split`].
#[derive(Clone, Debug)]
pub struct Split<A: AmplitudeAlgebra> {
    /// f.
    pub flow: A::Element,
    /// u.
    pub response: A::Element,
    /// The smallest divisor among those that are numbers: p_1 - q_1, ..., p_M - q_M, m_1, ..., m_L of its
    /// harmonic and (nu_j^2 - lambda^2)/nu_j^2, of enclosures their middle.
    pub nearest: Option<(Vec<i32>, Rational)>,
}
