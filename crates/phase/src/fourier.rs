//! Exact Fourier coefficients of cos^p t (ln cos^2 t)^q and of the Lobachevsky functions.
//!
//! # Derivation
//!
//! For s > -1 and real y (Gradshteyn and Ryzhik 3.631.9; checked numerically in the tests)
//!
//!   int_0^{pi/2} (2 cos t)^s cos(y t) dt
//!       = (pi/2) Gamma(1+s) / ( Gamma(1+(s+y)/2) Gamma(1+(s-y)/2) ).
//!
//! Let p >= 0 and m >= 0 be integers of equal parity, a = (p+m)/2, b = (p-m)/2, s = p - z, y = m.
//! Division by the same formula with p = m = 0, which is <|cos t|^{-z}> = sum_j mu_j z^j, leaves
//! quotients of Gamma functions whose arguments differ by integers, a rational function of z:
//!
//!   <cos^p t |cos t|^{-z} cos(m t)> = R(z) sum_j mu_j z^j,
//!
//!   R(z) = 2^{-p} prod_{j=1}^p (j - z) / prod_{j=1}^a (j - z/2) * B(z),
//!   B(z) = 1 / prod_{j=1}^b (j - z/2)        for b >= 0,
//!   B(z) = prod_{j=b+1}^0 (j - z/2)          for b < 0.
//!
//! No denominator vanishes at z = 0. Where Gamma(1+(s-y)/2) has a pole there, m > p, the factor
//! j = 0 gives B a simple zero: cos^p t itself has no harmonics above p, its products with
//! logarithms have them all. Since ln cos^2 t = -2 l with l = -ln|cos t|,
//!
//!   cos^p t (ln cos^2 t)^q = (-2)^q q! [z^q] cos^p t |cos t|^{-z},
//!
//! so every coefficient is a linear form in 1, mu_1, ..., mu_q with rational coefficients.
//!
//! # Parity
//!
//! The functions are even: no sines. t -> t + pi multiplies them by (-1)^p: only harmonics with
//! m - p even occur. Lambda_m is odd and has the period pi: sines of even harmonics only.

use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use rug::{Integer, Rational};

/// The cosine coefficients c_0, ..., c_max of
///
///   cos^p t (ln cos^2 t)^q = c_0 + sum_{m>=1} c_m cos(m t),
///
/// exactly: c_0 is the mean and c_m twice the mean of the function times cos(m t). Entries with
/// m - p odd are zero. The series converges for q >= 1 like m^{-p-1} (ln m)^{q-1}: a partial sum
/// is no approximation to many digits. Costs O((p + max) q) operations with rational numbers.
///
/// ```
/// use lindstedt_coeff::print::{Print, Style};
/// use lindstedt_coeff::PolynomialRing;
/// use lindstedt_phase::fourier::power_log_harmonics;
///
/// let ring = PolynomialRing::default();
/// let c = power_log_harmonics(&ring, 1, 1, 3);
/// assert_eq!(ring.print(&c[1], Style::Text), "1 - 2*mu_1");
/// assert_eq!(ring.print(&c[3], Style::Text), "1/2");
/// ```
pub fn power_log_harmonics(ring: &PolynomialRing, p: u32, q: u16, max: u32) -> Vec<Polynomial> {
    let factorial = Integer::from(Integer::factorial(q.into()));
    let sign = if q.is_multiple_of(2) { 1 } else { -1 };
    let scale = Rational::from((factorial << u32::from(q)) * sign);
    harmonics(ring, p, q, max, &scale)
}

/// The sine coefficients s_0 = 0, s_1, ..., s_max of Lambda_m(t) = sum_k s_k sin(k t), exactly,
/// where Lambda_m(t) = int_0^t (l(s)^m/m! - mu_m) ds: those of the cosine series of l^m/m! divided
/// by k. Entries with k odd are zero. Costs as [`power_log_harmonics`].
pub fn lambda_harmonics(ring: &PolynomialRing, m: u16, max: u32) -> Vec<Polynomial> {
    let mut list = harmonics(ring, 0, m, max, &Rational::from(1));
    for (s, k) in list.iter_mut().zip(0u32..) {
        *s = match k {
            0 => ring.zero(),
            _ => ring.scale(s, &Rational::from((1, k))),
        };
    }
    list
}

/// scale * [z^q] of the cosine coefficients of cos^p t |cos t|^{-z}.
fn harmonics(ring: &PolynomialRing, p: u32, q: u16, max: u32, scale: &Rational) -> Vec<Polynomial> {
    let mut list = Vec::new();
    let mut quotient = Quotient::new(p, q);
    for m in 0..=max {
        if m % 2 != p % 2 {
            list.push(ring.zero());
            continue;
        }
        let doubled = if m == 0 { scale.clone() } else { Rational::from(scale * 2) };
        let mut sum = ring.zero();
        for (j, r) in (0..=q).zip(quotient.series.iter().rev()) {
            let r = Rational::from(r * &doubled);
            let term = match j {
                0 => ring.rational(&r),
                _ => ring.scale(&ring.symbol(Symbol::Moment(j)), &r),
            };
            ring.add_assign(&mut sum, &term);
        }
        list.push(sum);
        quotient.next_harmonic();
    }
    list
}

/// R(z) modulo z^{q+1} for one p and m.
struct Quotient {
    /// (p + m)/2.
    a: i64,
    /// (p - m)/2.
    b: i64,
    /// The Taylor coefficients of R.
    series: Vec<Rational>,
}

impl Quotient {
    /// R for the smallest harmonic of the parity of p, m = p mod 2.
    fn new(p: u32, q: u16) -> Self {
        let m = i64::from(p % 2);
        let p = i64::from(p);
        let mut series = vec![Rational::new(); usize::from(q) + 1];
        if let Some(first) = series.first_mut() {
            *first = Rational::from(1);
        }
        let mut quotient = Self { a: (p + m) / 2, b: (p - m) / 2, series };
        // 2^{-p} prod_{j=1}^p (j - z) = prod_j (j/2 - z/2), a factor with every denominator.
        for j in 1..=p {
            quotient.multiply(&Rational::from((j, 2)));
        }
        for j in 1..=quotient.a {
            quotient.divide(j);
        }
        for j in 1..=quotient.b {
            quotient.divide(j);
        }
        quotient
    }

    /// m -> m + 2: Gamma(1 + b - z/2)/Gamma(b - z/2) = b - z/2, and 1/(a + 1 - z/2).
    fn next_harmonic(&mut self) {
        self.multiply(&Rational::from(self.b));
        self.divide(self.a + 1);
        self.a += 1;
        self.b -= 1;
    }

    /// Multiplies by c - z/2.
    fn multiply(&mut self, c: &Rational) {
        let mut below = Rational::new();
        for r in &mut self.series {
            let old = r.clone();
            *r = Rational::from(&old * c) - below / 2u32;
            below = old;
        }
    }

    /// Divides by j - z/2, j not zero: the quotient x satisfies x_n = (r_n + x_{n-1}/2)/j.
    fn divide(&mut self, j: i64) {
        let mut below = Rational::new();
        for r in &mut self.series {
            below = (Rational::from(&*r) + below / 2u32) / j;
            r.clone_from(&below);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lobachevsky;
    use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, Rationals};
    use lindstedt_coeff::polynomial::power;

    fn constant(n: i64, d: i64) -> Polynomial {
        PolynomialRing::default().rational(&Rational::from((n, d)))
    }

    /// The number that p is, with mu_1 = ln 2 and mu_2, mu_3 from mpmath 1.3.0,
    /// taylor(gamma((1-s)/2)/(sqrt(pi)*gamma(1-s/2)), 0, 3).
    fn value(p: &Polynomial) -> f64 {
        let image = |symbol| match symbol {
            Symbol::Moment(1) => Rational::from_f64(std::f64::consts::LN_2),
            Symbol::Moment(2) => Rational::from_f64(0.651_460_023_671_157_3),
            Symbol::Moment(3) => Rational::from_f64(0.641_063_687_115_433_3),
            _ => None,
        };
        let number = PolynomialRing::default()
            .substitute(&Rationals, p, |symbol| image(symbol).unwrap_or_default());
        number.map_or(f64::NAN, |q| q.to_f64())
    }

    #[test]
    fn quadrature() {
        // mpmath 1.3.0, 40 digits, u = pi/2 - t: quad(sin(u)**p*log(sin(u)**2)**q*
        // cos(m*(pi/2-u)), [0, 1e-3, 0.1, pi/4, pi/2])*2/pi, doubled for m > 0.
        let cases = [
            (2, 1, 0, -0.193_147_180_559_945_3),
            (3, 2, 1, 0.107_745_010_067_135_3),
            (1, 3, 5, -2.288_863_173_395_649),
            (0, 2, 4, 7.772_588_722_239_781),
            (2, 2, 8, -0.072_320_923_148_440_8),
            (4, 1, 2, -0.026_480_513_893_278_64),
            (5, 0, 3, 0.3125),
        ];
        for (p, q, m, expected) in cases {
            let list = power_log_harmonics(&PolynomialRing::default(), p, q, m);
            let found = list.last().map_or(f64::NAN, value);
            assert!((found - expected).abs() < 1e-13, "p = {p}, q = {q}, m = {m}: {found}");
        }
        // The same with Lambda_m(pi/2 - u) = quad(mu_m - l^m/m!, [0, u]) at 20 digits, times
        // 4/pi sin(k t) over the quarter period.
        let cases = [(1, 2, -0.5), (2, 2, -0.596_573_590_279_973), (3, 6, -0.178_304_616_799_01)];
        for (m, k, expected) in cases {
            let list = lambda_harmonics(&PolynomialRing::default(), m, k);
            let found = list.last().map_or(f64::NAN, value);
            assert!((found - expected).abs() < 1e-13, "m = {m}, k = {k}: {found}");
        }
    }

    #[test]
    fn classical_series() {
        // ln|2 cos t| = sum_k (-1)^{k-1} cos(2kt)/k (Gradshteyn and Ryzhik 1.441.4), and its
        // integral L(t) - t ln 2 = Lambda_1(t) = -(1/2) sum_k (-1)^{k-1} sin(2kt)/k^2.
        let ring = PolynomialRing::default();
        let logarithm = power_log_harmonics(&ring, 0, 1, 41);
        let lambda = lambda_harmonics(&ring, 1, 41);
        assert_eq!(logarithm[0], ring.scale(&ring.symbol(Symbol::Moment(1)), &Rational::from(-2)));
        assert_eq!(lambda[0], ring.zero());
        for k in 1..=20i64 {
            let sign = if k % 2 == 1 { 1 } else { -1 };
            let even = usize::try_from(2 * k).unwrap_or_default();
            assert_eq!(logarithm[even], constant(2 * sign, k));
            assert_eq!(lambda[even], constant(-sign, 2 * k * k));
            assert_eq!((&logarithm[even + 1], &lambda[even + 1]), (&ring.zero(), &ring.zero()));
        }
    }

    #[test]
    fn powers_of_the_cosine_are_finite_sums() {
        // cos^4 t = 3/8 + cos(2t)/2 + cos(4t)/8.
        let list = power_log_harmonics(&PolynomialRing::default(), 4, 0, 9);
        let expected =
            [(3, 8), (0, 1), (1, 2), (0, 1), (1, 8), (0, 1), (0, 1), (0, 1), (0, 1), (0, 1)];
        assert_eq!(list, expected.map(|(n, d)| constant(n, d)));
    }

    #[test]
    fn first_coefficient_of_the_power_law() {
        // alpha_1 = mean of 2 cos^2 t ln cos^2 t = 1 - 2 mu_1 = 1 - 2 ln 2.
        let ring = PolynomialRing::default();
        let mean = &power_log_harmonics(&ring, 2, 1, 0)[0];
        let twice_mu = ring.scale(&ring.symbol(Symbol::Moment(1)), &Rational::from(2));
        let alpha = ring.sub(&ring.one(), &twice_mu);
        assert_eq!(ring.scale(mean, &Rational::from(2)), alpha);
    }

    /// The Lobachevsky ring finds means (p even) and first harmonics (p odd) by antiderivatives;
    /// for the other parity they vanish by symmetry, but the antiderivative is outside the ring.
    #[test]
    fn agrees_with_the_antiderivatives_of_the_ring() {
        let a = Lobachevsky::new(PolynomialRing::default());
        let ring = a.constants();
        let log = a.scale(&a.log_secant(), &Rational::from(-2));
        for p in 0..6u32 {
            for q in 0..5u16 {
                let f = a.mul(&power(&a, &a.cosine(), p), &power(&a, &log, q.into()));
                let list = power_log_harmonics(ring, p, q, 1);
                if p % 2 == 0 {
                    let mean = a.antiderivative(&f).map(|(_, mean)| mean);
                    assert_eq!(mean, Ok(list[0].clone()), "mean, p = {p}, q = {q}");
                } else {
                    let first = Ok((list[1].clone(), ring.zero()));
                    assert_eq!(a.first_harmonic(&f), first, "first harmonic, p = {p}, q = {q}");
                }
            }
        }
    }
}
