//! Exact Fourier integrals over the line, and their values in balls.

use super::Hyperbolic;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::fmt;

/// P(w) pi sech(pi w/2) + Q(w) pi w csch(pi w/2) with polynomials P, Q over Q.
///
/// The coefficient of w^n stands at index n; trailing zeros are not stored.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FourierForm {
    /// P.
    pub sech: Vec<Rational>,
    /// Q.
    pub csch: Vec<Rational>,
}

/// The Fourier transform of an element f: the integrals of f(z) cos(w z) and of f(z) sin(w z).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FourierTransform {
    /// The cosine integral (from the even terms).
    pub cosine: FourierForm,
    /// The sine integral (from the odd terms).
    pub sine: FourierForm,
}

fn add_scaled(sum: &mut Vec<Rational>, a: &[Rational], c: &Rational) {
    if sum.len() < a.len() {
        sum.resize(a.len(), Rational::new());
    }
    for (s, x) in sum.iter_mut().zip(a) {
        *s += Rational::from(x * c);
    }
    while sum.last().is_some_and(Rational::is_zero) {
        sum.pop();
    }
}

/// w a.
fn shifted(a: &[Rational]) -> Vec<Rational> {
    let mut result = Vec::with_capacity(a.len() + 1);
    if !a.is_empty() {
        result.push(Rational::new());
        result.extend_from_slice(a);
    }
    result
}

impl FourierForm {
    fn add_scaled(&mut self, other: &Self, c: &Rational) {
        add_scaled(&mut self.sech, &other.sech, c);
        add_scaled(&mut self.csch, &other.csch, c);
    }
    fn shifted(&self) -> Self {
        Self { sech: shifted(&self.sech), csch: shifted(&self.csch) }
    }
    /// An enclosure at w: the polynomials by Horner's rule, so the cancellation inside them costs
    /// bits (never truth).
    #[must_use]
    pub fn ball(&self, balls: Balls, w: &Ball) -> Option<Ball> {
        let horner = |coefficients: &[Rational]| {
            coefficients.iter().rev().fold(balls.zero(), |sum, c| {
                balls.add(&balls.mul(&sum, w), &balls.from_rational(c))
            })
        };
        let mut sum = balls.zero();
        if !self.sech.is_empty() {
            sum = balls.mul(&horner(&self.sech), &first_kernel(balls, w)?);
        }
        if !self.csch.is_empty() {
            let part = balls.mul(&horner(&self.csch), &second_kernel(balls, w)?);
            sum = balls.add(&sum, &part);
        }
        Some(sum)
    }
}

/// C_1(w) = pi sech(pi w/2).
fn first_kernel(balls: Balls, w: &Ball) -> Option<Ball> {
    let pi = balls.pi();
    let half = balls.mul_power_of_two(&balls.mul(&pi, w), -1);
    balls.div(&pi, &balls.cosh(&half))
}

/// C_2(w) = pi w / sinh(pi w/2), 2 at w = 0.
///
/// x/sinh x lies in (0, 1] and decreases with |x|; a ball that contains 0 without being 0 is
/// answered by the hull of the values at 0 and at its largest |x|.
fn second_kernel(balls: Balls, w: &Ball) -> Option<Ball> {
    let two = balls.from_i64(2);
    let at = |w: &Ball| {
        let x = balls.mul(&balls.pi(), w);
        balls.div(&x, &balls.sinh(&balls.mul_power_of_two(&x, -1)))
    };
    if !w.contains_zero() {
        return at(w);
    }
    if w.is_exact() {
        return Some(two);
    }
    let extreme = balls.from_parts(&w.abs_upper(), &rug::Float::new(53));
    if extreme.contains_zero() {
        return Some(two);
    }
    Some(balls.hull(&two, &at(&extreme)?))
}

/// J_{p,q}(w): the integral of sech^p z tanh^q z times cos(w z) (q even) or sin(w z) (q odd),
/// exactly, for p >= 1; `None` for p = 0.
///
/// With C_1 = pi sech(pi w/2), C_2 = pi w csch(pi w/2), C_{p+2} = (p^2 + w^2)/(p(p+1)) C_p and
/// the integral of sech^p tanh^q e^{iwz} = i^q e_q: e_0 = C_p and
/// (p+j-1) e_j = w e_{j-1} - (j-1) e_{j-2} (Meixner-Pollaczek polynomials), J = (-1)^{floor(q/2)} e_q.
/// Cost O((p + q) degree) rational operations.
///
/// ```
/// use lindstedt_melnikov::hyperbolic::line_fourier;
/// // The forcing integral of the double well: pi w sech(pi w/2).
/// assert_eq!(line_fourier(1, 1).map(|j| j.to_string()).as_deref(), Some("(w) pi sech(pi w/2)"));
/// ```
#[must_use]
pub fn line_fourier(p: u32, q: u32) -> Option<FourierForm> {
    if p == 0 {
        return None;
    }
    let start = if p.is_multiple_of(2) { 2 } else { 1 };
    let mut form = FourierForm::default();
    let seed = if start == 1 { &mut form.sech } else { &mut form.csch };
    seed.push(Rational::from(1));
    for n in (start..p).step_by(2) {
        let n = u64::from(n);
        let denominator = Rational::from((1, n * (n + 1)));
        let mut next = FourierForm::default();
        next.add_scaled(&form, &(Rational::from(n * n) * &denominator));
        next.add_scaled(&form.shifted().shifted(), &denominator);
        form = next;
    }
    let mut before = FourierForm::default();
    for j in 1..=u64::from(q) {
        let denominator = Rational::from((1, u64::from(p) + j - 1));
        let mut next = FourierForm::default();
        next.add_scaled(&form.shifted(), &denominator);
        next.add_scaled(&before, &(-Rational::from(j - 1) * &denominator));
        before = std::mem::replace(&mut form, next);
    }
    if (q / 2) % 2 == 1 {
        let mut negated = FourierForm::default();
        negated.add_scaled(&form, &Rational::from(-1));
        form = negated;
    }
    Some(form)
}

impl Hyperbolic {
    /// The Fourier transform, `None` where a term does not decay.
    #[must_use]
    pub fn fourier(&self) -> Option<FourierTransform> {
        let mut transform = FourierTransform::default();
        for (c, p, tanh) in self.terms() {
            let form = line_fourier(p, u32::from(tanh))?;
            let part = if tanh { &mut transform.sine } else { &mut transform.cosine };
            part.add_scaled(&form, c);
        }
        Some(transform)
    }
}

impl fmt::Display for FourierForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let polynomial = |coefficients: &[Rational]| {
            let term = |(n, c): (usize, &Rational)| {
                let power = match n {
                    0 => return c.to_string(),
                    1 => "w".to_owned(),
                    _ => format!("w^{n}"),
                };
                if *c == 1 { power } else { format!("{c} {power}") }
            };
            let terms = coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero());
            terms.map(term).collect::<Vec<_>>().join(" + ")
        };
        let mut parts = Vec::new();
        if !self.sech.is_empty() {
            parts.push(format!("({}) pi sech(pi w/2)", polynomial(&self.sech)));
        }
        if !self.csch.is_empty() {
            parts.push(format!("({}) pi w csch(pi w/2)", polynomial(&self.csch)));
        }
        if parts.is_empty() {
            parts.push("0".to_owned());
        }
        write!(f, "{}", parts.join(" + "))
    }
}
