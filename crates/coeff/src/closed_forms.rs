//! The log-cosine moments mu_m in closed form: elements of Q[ln 2, pi^2, zeta(3), zeta(5), ...].
//!
//! # Derivation
//!
//! With l = -ln|cos t| the mean over a period of |cos t|^{-s} = e^{s l} = sum_m s^m l^m/m! is a
//! beta integral,
//!
//!   sum_m mu_m s^m = <|cos t|^{-s}> = Gamma((1-s)/2) / (sqrt(pi) Gamma(1 - s/2)).
//!
//! The Taylor coefficients of ln Gamma are polygamma values, psi(1) = -gamma,
//! psi(1/2) = -gamma - 2 ln 2, and for n >= 1 (DLMF 5.15.2 and 5.15.3)
//! psi^(n)(1) = (-1)^{n+1} n! zeta(n+1), psi^(n)(1/2) = (2^{n+1} - 1) psi^(n)(1). So
//!
//!   ln Gamma(1 - v)   =              gamma v           + sum_{k>=2}           zeta(k) v^k/k,
//!   ln Gamma(1/2 - v) = ln sqrt(pi) + (gamma + 2 ln 2) v + sum_{k>=2} (2^k - 1) zeta(k) v^k/k,
//!
//! and with v = s/2 and eta(k) = (1 - 2^{1-k}) zeta(k), eta(1) = ln 2 (Dirichlet's eta function)
//!
//!   sum_m mu_m s^m = exp( s ln 2 + sum_{k>=2} (2^k - 2) zeta(k) (s/2)^k/k )
//!                  = exp( sum_{k>=1} eta(k) s^k/k ).
//!
//! Differentiation in s gives the recurrence m mu_m = sum_{k=1}^m eta(k) mu_{m-k}. The zeta
//! values of even argument are Euler's, zeta(2n) = (-1)^{n+1} B_{2n} (2 pi)^{2n} / (2 (2n)!)
//! (DLMF 25.6.2), with Bernoulli numbers from sum_{j<=n} C(n+1, j) B_j = 0 (DLMF 24.5.3).
//!
//! Between ln 2, pi and the odd zeta values no algebraic relation is known, and none is used.

use crate::polynomial::{Polynomial, PolynomialRing, Symbol};
use crate::sparse::Sparse;
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use rug::{Integer, Rational};

/// A table of the closed forms of mu_0, ..., mu_order.
///
/// ```
/// use lindstedt_coeff::closed_forms::ClosedForms;
/// use lindstedt_coeff::print::{Print, Style};
/// use lindstedt_coeff::{PolynomialRing, Symbol};
///
/// let (ring, forms) = (PolynomialRing::default(), ClosedForms::new(3));
/// let mu_2 = forms.closed_form(&ring, &ring.symbol(Symbol::Moment(2)));
/// let shown = mu_2.map(|p| ring.print(&p, Style::Text));
/// assert_eq!(shown.as_deref(), Some("1/2*ln(2)^2 + 1/24*pi^2"));
/// ```
#[derive(Clone, Debug)]
pub struct ClosedForms {
    /// eta(1), eta(2), ...
    eta: Vec<Polynomial>,
    moments: Vec<Polynomial>,
}

impl ClosedForms {
    /// mu_m = (1/m) sum_{k=1}^m eta(k) mu_{m-k} for m up to `order`, exactly. Costs O(order^2)
    /// products of a monomial with a polynomial.
    #[must_use]
    pub fn new(order: u16) -> Self {
        let ring = PolynomialRing::default();
        let bernoulli = bernoulli_numbers(order);
        let eta: Vec<Polynomial> = (1..=order).map(|k| eta(&ring, k, &bernoulli)).collect();
        let moments = exponential(&eta, 1);
        Self { eta, moments }
    }

    /// The coefficients of (sum_m mu_m s^m)^r = exp(r sum_k eta(k) s^k/k) up to the order of the table; that of s^w has
    /// weight w. Costs O(order^2) products of a monomial with a polynomial.
    ///
    /// ```
    /// use lindstedt_coeff::closed_forms::ClosedForms;
    /// let forms = ClosedForms::new(6);
    /// assert_eq!(forms.power(1).get(6), forms.moment(6));
    /// assert_eq!(forms.power(0).iter().filter(|p| !p.is_zero()).count(), 1);
    /// ```
    #[must_use]
    pub fn power(&self, r: i32) -> Vec<Polynomial> {
        exponential(&self.eta, r)
    }

    /// The largest m of the table.
    #[must_use]
    pub fn order(&self) -> usize {
        self.moments.len() - 1
    }

    /// mu_m in ln 2, pi and zeta(3), zeta(5), ...; `None` beyond the table.
    #[must_use]
    pub fn moment(&self, m: u16) -> Option<&Polynomial> {
        self.moments.get(usize::from(m))
    }

    /// `p` with every mu_m replaced by its closed form; other symbols stay. Polynomials whose
    /// equality follows from the formulas above have equal closed forms, although they may differ
    /// as polynomials in the mu_m (first at weight 4, see the tests).
    ///
    /// `None` when a mu_m beyond the table occurs, or a negative power of a mu_m with m >= 2,
    /// whose closed form has no reciprocal in the ring.
    ///
    /// Horner's scheme in the mu_m, the largest m outermost, so that products are shared. Measured
    /// on one core: 13 ms for all 627 monomials of weight 20 (the result has 203 terms), 0.9 s
    /// for the 5604 of weight 30 (1097 terms).
    #[must_use]
    pub fn closed_form(&self, ring: &PolynomialRing, p: &Polynomial) -> Option<Polynomial> {
        let mut terms: Vec<SplitTerm> = Vec::with_capacity(p.terms().len());
        for (monomial, coefficient) in p.terms() {
            let mut rest = ring.rational(coefficient);
            let mut moments = Vec::new();
            for &(symbol, exponent) in monomial.factors() {
                match symbol {
                    Symbol::Moment(m) if usize::from(m) > self.order() => return None,
                    Symbol::Moment(0) => {}
                    Symbol::Moment(1) => {
                        rest = ring.mul(&rest, &ring.power(Symbol::LogTwo, exponent));
                    }
                    Symbol::Moment(_) if exponent < 0 => return None,
                    Symbol::Moment(m) => moments.push((m, exponent)),
                    other => rest = ring.mul(&rest, &ring.power(other, exponent)),
                }
            }
            moments.reverse();
            terms.push(SplitTerm { moments, rest });
        }
        // Descending, so that equal beginnings stand together and the highest power comes first.
        terms.sort_by(|a, b| b.moments.cmp(&a.moments));
        Some(self.horner(ring, &terms, 0))
    }

    /// The sum of the terms, of whose moments the first `depth` are the same in all and already
    /// taken out.
    fn horner(&self, ring: &PolynomialRing, terms: &[SplitTerm], depth: usize) -> Polynomial {
        let next = |term: &SplitTerm| term.moments.get(depth).copied();
        let largest = |term: &SplitTerm| next(term).map(|(m, _)| m);
        let mut sum = ring.zero();
        for same in terms.chunk_by(|x, y| largest(x) == largest(y)) {
            let Some(moment) = same.first().and_then(largest).and_then(|m| self.moment(m)) else {
                let free = same.iter().flat_map(|term| term.rest.terms().iter().cloned());
                ring.add_assign(&mut sum, &Sparse::collect(&Rationals, free));
                continue;
            };
            // sum_e mu_m^e p_e, the exponents e decreasing.
            let mut value = ring.zero();
            let mut groups = same.chunk_by(|x, y| next(x) == next(y)).peekable();
            while let Some(group) = groups.next() {
                ring.add_assign(&mut value, &self.horner(ring, group, depth + 1));
                let exponent = |group: &[SplitTerm]| group.first().and_then(next).map(|(_, e)| e);
                let below = groups.peek().and_then(|group| exponent(group)).unwrap_or(0);
                for _ in below..exponent(group).unwrap_or(0) {
                    value = ring.mul(&value, moment);
                }
            }
            ring.add_assign(&mut sum, &value);
        }
        sum
    }
}

/// y = exp(r sum_k eta(k) s^k/k) by m y_m = r sum_{k=1}^m eta(k) y_{m-k}.
fn exponential(eta: &[Polynomial], r: i32) -> Vec<Polynomial> {
    let ring = PolynomialRing::default();
    let mut list = vec![ring.one()];
    for m in 1..=eta.len() {
        let pairs: Vec<_> = eta.iter().zip(list.iter().rev()).collect();
        let sum = ring.sum_of_products(&pairs);
        list.push(ring.scale(&sum, &Rational::from((r, m as u32))));
    }
    list
}

/// A term of a polynomial: the mu_m with m >= 2 by decreasing m, and everything else.
struct SplitTerm {
    moments: Vec<(u16, i16)>,
    rest: Polynomial,
}

/// eta(k) = (1 - 2^{1-k}) zeta(k), and ln 2 for k = 1.
fn eta(ring: &PolynomialRing, k: u16, bernoulli: &[Rational]) -> Polynomial {
    if k <= 1 {
        return ring.symbol(Symbol::LogTwo);
    }
    let two_to_k = Integer::from(1) << u32::from(k);
    let factor = Rational::from((Integer::from(&two_to_k - 2), two_to_k.clone()));
    if k % 2 == 1 {
        return ring.scale(&ring.symbol(Symbol::Zeta(k)), &factor);
    }
    // zeta(k) = |B_k| 2^{k-1} pi^k / k!; the signs of the B_{2n} alternate.
    let number = bernoulli.get(usize::from(k)).cloned().unwrap_or_default().abs();
    let power = Rational::from((two_to_k, Integer::from(Integer::factorial(k.into())) * 2));
    let exponent = i16::try_from(k).unwrap_or(i16::MAX);
    ring.scale(&ring.power(Symbol::Pi, exponent), &(number * power * factor))
}

/// B_0, ..., B_n from sum_{j<=m} C(m+1, j) B_j = 0 for m >= 1. O(n^2) products.
fn bernoulli_numbers(n: u16) -> Vec<Rational> {
    let mut numbers = vec![Rational::from(1)];
    for m in 1..=u32::from(n) {
        let mut sum = Rational::new();
        for (j, number) in (0u32..).zip(&numbers) {
            sum += Rational::from(Integer::from(m + 1).binomial(j)) * number;
        }
        numbers.push(-sum / (m + 1));
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_number::ball::{Ball, Balls};

    fn moment(m: u16) -> Polynomial {
        PolynomialRing::default().symbol(Symbol::Moment(m))
    }

    /// The value of a polynomial in ln 2, pi and the zeta values.
    fn value(balls: Balls, p: &Polynomial) -> Ball {
        let mut sum = balls.zero();
        for (monomial, coefficient) in p.terms() {
            let mut term = balls.from_rational(coefficient);
            for &(symbol, exponent) in monomial.factors() {
                let base = match symbol {
                    Symbol::LogTwo => Some(balls.ln_2()),
                    Symbol::Pi => Some(balls.pi()),
                    Symbol::Zeta(k) => balls.zeta(k.into()),
                    _ => None,
                };
                let power = base.and_then(|b| balls.powi(&b, exponent.into()));
                term = balls.mul(&term, &power.unwrap_or_else(|| balls.zero()));
            }
            sum = balls.add(&sum, &term);
        }
        sum
    }

    #[test]
    fn second_moment() {
        // int_0^{pi/2} (ln cos t)^2 dt = (pi/2)(ln^2 2 + pi^2/12), Gradshteyn and Ryzhik 4.224.8.
        let ring = PolynomialRing::default();
        let logs = ring.scale(&ring.power(Symbol::LogTwo, 2), &Rational::from((1, 2)));
        let pis = ring.scale(&ring.power(Symbol::Pi, 2), &Rational::from((1, 24)));
        assert_eq!(ClosedForms::new(2).moment(2), Some(&ring.add(&logs, &pis)));
    }

    #[test]
    fn relation_of_weight_four() {
        // 10 mu_4 = 10 mu_3 mu_1 + 19 mu_2^2 - 24 mu_2 mu_1^2 + 6 mu_1^4 because zeta(4) is a
        // rational multiple of zeta(2)^2.
        let ring = PolynomialRing::default();
        let products: [(i32, &[u16]); 5] =
            [(-10, &[4]), (10, &[3, 1]), (19, &[2, 2]), (-24, &[2, 1, 1]), (6, &[1; 4])];
        let mut relation = ring.zero();
        for (coefficient, moments) in products {
            let unit = ring.rational(&Rational::from(coefficient));
            let term = moments.iter().fold(unit, |t, &m| ring.mul(&t, &moment(m)));
            ring.add_assign(&mut relation, &term);
        }
        let forms = ClosedForms::new(4);
        assert_eq!(forms.closed_form(&ring, &relation), Some(ring.zero()));
        let broken = ring.add(&relation, &moment(4));
        assert_ne!(forms.closed_form(&ring, &broken), Some(ring.zero()));
    }

    #[test]
    fn numbers() {
        // mpmath 1.3.0, 45 digits: taylor(gamma((1-s)/2)/(sqrt(pi)*gamma(1-s/2)), 0, 8), and
        // for m = 8 also quad((-log(sin(t)))**8/factorial(8), [0, 1e-3, pi/4, pi/2])*2/pi.
        let cases = [
            (3, "0.64106368711543334067172176889457"),
            (4, "0.63802261870428995222634796835979"),
            (8, "0.63663607188065526391408457618308"),
        ];
        let (forms, balls) = (ClosedForms::new(8), Balls::new(192));
        for (m, digits) in cases {
            let found = forms.moment(m).map(|p| value(balls, p));
            let expected = rug::Float::parse(digits).ok().map(|d| rug::Float::with_val(192, d));
            let distance = found.zip(expected).map(|(f, e)| (e - f.midpoint()).abs());
            assert!(distance.is_some_and(|d| d < 1e-32), "mu_{m}");
        }
    }

    /// All partitions of `weight` into parts up to `largest`, as monomials in the mu_m.
    fn partitions(weight: u16, largest: u16, done: &Polynomial, list: &mut Vec<Polynomial>) {
        if weight == 0 {
            list.push(done.clone());
        }
        for m in 1..=largest.min(weight) {
            let next = PolynomialRing::default().mul(done, &moment(m));
            partitions(weight - m, m, &next, list);
        }
    }

    fn all_of_weight(weight: u16) -> Polynomial {
        let ring = PolynomialRing::default();
        let mut list = Vec::new();
        partitions(weight, weight, &ring.one(), &mut list);
        let terms = list.iter().zip(1i32..).flat_map(|(p, c)| {
            let scaled = ring.scale(p, &Rational::from((c, 3 * c + 1)));
            scaled.terms().to_vec()
        });
        Sparse::collect(&Rationals, terms)
    }

    #[test]
    fn horner_is_substitution() {
        let ring = PolynomialRing { parameters: vec!["a".into()] };
        let forms = ClosedForms::new(9);
        let a = ring.power(Symbol::Parameter(0), -2);
        let p = ring.add(&ring.mul(&a, &all_of_weight(9)), &all_of_weight(6));
        let image = |symbol| match symbol {
            Symbol::Moment(m) => forms.moment(m).cloned().unwrap_or_default(),
            other => ring.symbol(other),
        };
        let slow = ring.substitute(&ring, &p, image);
        assert!(slow.is_some());
        assert_eq!(forms.closed_form(&ring, &p), slow);
    }

    #[test]
    fn weight_twenty() {
        // eta(k) = k mu_k - sum_{j<k} eta(j) mu_{k-j} in the mu_m has all 627 monomials of
        // weight 20 and collapses to (1 - 2^-19) zeta(20), zeta(20) = 174611 pi^20 /
        // 1531329465290625 (Abramowitz and Stegun, table 23.3 with 23.2.16).
        let ring = PolynomialRing::default();
        let mut etas: Vec<Polynomial> = Vec::new();
        for k in 1..=20u16 {
            let mut sum = ring.scale(&moment(k), &Rational::from(-i32::from(k)));
            for (eta, j) in etas.iter().zip(1..) {
                ring.add_assign(&mut sum, &ring.mul(eta, &moment(k - j)));
            }
            etas.push(ring.neg(&sum));
        }
        let last = etas.pop().unwrap_or_default();
        assert_eq!(last.terms().len(), 627);
        let zeta = Rational::from((174_611, 1_531_329_465_290_625_u64));
        let factor = Rational::from(((1 << 19) - 1, 1 << 19));
        let expected = ring.scale(&ring.power(Symbol::Pi, 20), &(zeta * factor));
        assert_eq!(ClosedForms::new(20).closed_form(&ring, &last), Some(expected));
    }

    #[test]
    fn what_the_ring_does_not_hold_is_refused() {
        let (ring, forms) = (PolynomialRing::default(), ClosedForms::new(2));
        assert_eq!(forms.closed_form(&ring, &moment(3)), None);
        assert_eq!(forms.closed_form(&ring, &ring.power(Symbol::Moment(2), -1)), None);
        let inverse = ring.power(Symbol::Moment(1), -3);
        assert_eq!(forms.closed_form(&ring, &inverse), Some(ring.power(Symbol::LogTwo, -3)));
        assert_eq!(forms.moment(3), None);
        assert_eq!(ClosedForms::new(0).order(), 0);
    }
}
