//! Homoclinic orbits of autonomous perturbations to any order, by a nonlinear time.
//!
//! y'' = a y + b y^k + eps f(y, y'; mu) has at eps = 0 the orbit y = sigma sech^p(omega t) with
//! p = 2/(k - 1). With xi' = omega(xi), T = tanh xi, S = 1 - T^2 and y = sigma sech^p xi for every
//! eps, y' = -p T omega y, and the equation divided by y is polynomial in T:
//!
//! p [(p T^2 - S) W - S T W'/2] = a + b r S + eps sum f_ij (-p T omega)^j (r S)^((i+j-1)/(k-1)),
//!
//! W = omega^2, r = sigma^(k-1). Order n is linear in (W_n, r_n, mu_(n-1)) and triangular in the
//! powers of T; its two conditions of solvability (of the odd part, which is Melnikov's integral,
//! and of the even part) give mu_(n-1) and r_n. Order 0: W = a/p^2, r = -(p + 1) a/(p b).
//!
//! The nonlinear time: Algaba, Chung, Qin, Rodriguez-Luis, Nonlinear Dynamics 97 (2019).

use crate::MelnikovError;
use rug::Rational;

/// A polynomial in T = tanh xi: the coefficient of T^m at index m.
type InTanh = Vec<Rational>;

/// The term (known + unknown mu) y^position y'^velocity of f.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PerturbationTerm {
    /// The power of y.
    pub position: u32,
    /// The power of y'.
    pub velocity: u32,
    /// The coefficient without mu.
    pub known: Rational,
    /// The coefficient of mu.
    pub unknown: Rational,
}

/// y'' = slope y + leading y^power + eps f(y, y'; mu), the saddle at y = 0 for every eps.
///
/// ```
/// use lindstedt_melnikov::{PerturbationTerm, Saddle};
/// use rug::Rational;
///
/// // Takens and Carr: x'' = x - x^3 + eps (mu - x^2) x' has a homoclinic orbit for mu = 4/5 + ...
/// let term = |position, known: i32, unknown: i32| PerturbationTerm {
///     position, velocity: 1, known: known.into(), unknown: unknown.into(),
/// };
/// let saddle = Saddle {
///     slope: 1.into(),
///     power: 3,
///     leading: (-1).into(),
///     perturbation: vec![term(0, 0, 1), term(2, -1, 0)],
/// };
/// let orbit = saddle.homoclinic(3, &mut |_| true)?;
/// assert_eq!(orbit.unknown[0], Rational::from((4, 5)));
/// assert!(saddle.residual_vanishes(&orbit));
/// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Saddle {
    /// a, the square of a rational number.
    pub slope: Rational,
    /// k >= 2.
    pub power: u32,
    /// b, not 0; negative for odd k.
    pub leading: Rational,
    /// The terms of f; a constant one would move the saddle and is refused.
    pub perturbation: Vec<PerturbationTerm>,
}

/// The orbit y = sigma sech^p xi, xi' = omega(tanh xi), and the mu for which it exists: exact
/// coefficients of the powers of eps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HomoclinicOrbit {
    /// mu_0 .. mu_(N-1).
    pub unknown: Vec<Rational>,
    /// sigma^(k-1) to order N, sigma being the largest deviation from the saddle.
    pub amplitude: Vec<Rational>,
    /// omega to order N, each a polynomial in T = tanh xi (the coefficient of T^m at index m).
    pub frequency: Vec<Vec<Rational>>,
}

impl Saddle {
    /// The orbit to order N >= 1 in eps, and mu to order N - 1; `observer` is told every order, `false` ends with it.
    ///
    /// O(N^2) products of polynomials of degree O(N) per power of y' and per term.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`] where y = 0 is no saddle or no orbit returns to it,
    /// [`MelnikovError::DegreeTooLarge`] for a power beyond [`crate::LARGEST_DEGREE`],
    /// [`MelnikovError::NotSquare`], [`MelnikovError::LeavesRing`] for a term of f that is not
    /// rational in sech and tanh on the orbit, or [`MelnikovError::UnknownWithoutWork`].
    pub fn homoclinic(
        &self,
        order: usize,
        observer: &mut dyn FnMut(usize) -> bool,
    ) -> Result<HomoclinicOrbit, MelnikovError> {
        let mut state = Expansion::new(self)?;
        for n in 1..=order {
            state.step(n)?;
            if !observer(n) {
                break;
            }
        }
        let Expansion { unknown, amplitude, omega: frequency, .. } = state;
        Ok(HomoclinicOrbit { unknown, amplitude, frequency })
    }

    /// (i + j - 1)/(k - 1) for each term, of a power k >= 2.
    fn exponents(&self) -> Result<Vec<usize>, MelnikovError> {
        let exponent = |term: &PerturbationTerm| {
            let (position, velocity) = (term.position, term.velocity);
            for degree in [position, velocity].map(|k| k as usize) {
                let limit = crate::LARGEST_DEGREE;
                if degree > limit {
                    return Err(MelnikovError::DegreeTooLarge { degree, limit });
                }
            }
            match (position + velocity).checked_sub(1) {
                Some(n) if n % (self.power - 1) == 0 => Ok((n / (self.power - 1)) as usize),
                _ => Err(MelnikovError::LeavesRing { position, velocity }),
            }
        };
        self.perturbation.iter().map(exponent).collect()
    }

    /// p = 2/(k - 1), and omega_0 = sqrt(a)/p.
    fn unperturbed(&self) -> Result<(Rational, Rational), MelnikovError> {
        let is_odd = !self.power.is_multiple_of(2);
        if self.slope <= 0 {
            return Err(MelnikovError::NotPositive { name: "slope" });
        }
        if self.power < 2 {
            return Err(MelnikovError::NotPositive { name: "power - 1" });
        }
        if self.leading == 0 || (is_odd && self.leading > 0) {
            return Err(MelnikovError::NotPositive { name: "-leading" });
        }
        let (numerator, denominator) = (self.slope.numer(), self.slope.denom());
        if !numerator.is_perfect_square() || !denominator.is_perfect_square() {
            return Err(MelnikovError::NotSquare { slope: self.slope.clone() });
        }
        let root = Rational::from((numerator.clone().sqrt(), denominator.clone().sqrt()));
        let p = Rational::from((2, self.power - 1));
        let omega = root / &p;
        Ok((p, omega))
    }

    /// Whether the orbit satisfies the equation to every order it is known to: y'' is formed from
    /// y' = -p T omega y and compared as a series in eps, at more rational T than the degree of
    /// the difference. It shares nothing with the expansion but the substitution y = sigma sech^p.
    #[must_use]
    pub fn residual_vanishes(&self, orbit: &HomoclinicOrbit) -> bool {
        let Ok((p, _)) = self.unperturbed() else { return false };
        let Ok(exponents) = self.exponents() else { return false };
        let known = orbit.frequency.len();
        if known == 0 || orbit.amplitude.len() != known || orbit.unknown.len() + 1 != known {
            return false;
        }
        let width = orbit.frequency.iter().map(Vec::len).max().unwrap_or(0);
        let term = |(t, e): (&PerturbationTerm, &usize)| t.velocity as usize * width + 2 * e;
        let perturbed = self.perturbation.iter().zip(&exponents).map(term).max().unwrap_or(0);
        let degree = perturbed.max(2 * width + 2);
        (0..=degree).all(|i| {
            let point = Rational::from((2 * i as i64 - degree as i64, degree as i64));
            self.residual_at(orbit, &exponents, &p, &point).iter().all(|r| *r == 0)
        })
    }

    /// The series of (y'' - right-hand side)/y at T.
    fn residual_at(
        &self,
        orbit: &HomoclinicOrbit,
        exponents: &[usize],
        p: &Rational,
        t: &Rational,
    ) -> Vec<Rational> {
        let known = orbit.frequency.len();
        let s = Rational::from(1) - Rational::from(t * t);
        let horner = |c: &InTanh| c.iter().rev().fold(Rational::new(), |sum, c| sum * t + c);
        // y'/y and its derivative by T.
        let mut speed: Vec<Rational> = Vec::new();
        let mut slope: Vec<Rational> = Vec::new();
        for omega in &orbit.frequency {
            let derived: InTanh =
                omega.iter().enumerate().map(|(m, c)| Rational::from(c * (m as u64 + 1))).collect();
            speed.push(-(horner(omega) * t * p));
            slope.push(-(horner(&derived) * p));
        }
        let omega: Vec<Rational> = orbit.frequency.iter().map(horner).collect();
        let square = product(&speed, &speed, known);
        let bend = product(&omega, &slope, known);
        let sr: Vec<Rational> = orbit.amplitude.iter().map(|r| Rational::from(r * &s)).collect();
        let mut residual: Vec<Rational> = square
            .into_iter()
            .zip(bend)
            .zip(&sr)
            .map(|((square, bend), sr)| square + bend * &s - Rational::from(&self.leading * sr))
            .collect();
        residual[0] -= &self.slope;
        for (term, exponent) in self.perturbation.iter().zip(exponents) {
            let one = vec![Rational::from(1)];
            let mut value: Vec<Rational> =
                orbit.unknown.iter().map(|mu| Rational::from(mu * &term.unknown)).collect();
            if let Some(first) = value.first_mut() {
                *first += &term.known;
            }
            let speeds = (0..term.velocity).fold(one.clone(), |w, _| product(&w, &speed, known));
            let sizes = (0..*exponent).fold(one, |w, _| product(&w, &sr, known));
            value = product(&product(&value, &speeds, known), &sizes, known - 1);
            for (r, v) in residual.iter_mut().skip(1).zip(value) {
                *r -= v;
            }
        }
        residual
    }
}

/// The first `known` coefficients of a product of series.
fn product(a: &[Rational], b: &[Rational], known: usize) -> Vec<Rational> {
    let mut result = vec![Rational::new(); known];
    for (i, x) in a.iter().enumerate().take(known) {
        for (r, y) in result[i..].iter_mut().zip(b) {
            *r += Rational::from(x * y);
        }
    }
    result
}

/// sum += factor a b, of polynomials in T.
fn accumulate(sum: &mut InTanh, factor: &Rational, a: &[Rational], b: &[Rational]) {
    if *factor == 0 || a.is_empty() || b.is_empty() {
        return;
    }
    if sum.len() < a.len() + b.len() - 1 {
        sum.resize(a.len() + b.len() - 1, Rational::new());
    }
    for (i, x) in a.iter().enumerate().filter(|(_, x)| **x != 0) {
        let x = Rational::from(x * factor);
        for (s, y) in sum[i..].iter_mut().zip(b) {
            *s += Rational::from(&x * y);
        }
    }
}

/// The coefficient of eps^n of the product of two series whose coefficients are polynomials in T.
fn coefficient(a: &[InTanh], b: &[InTanh], n: usize) -> InTanh {
    let mut sum = Vec::new();
    for i in 0..=n {
        if let (Some(a), Some(b)) = (a.get(i), b.get(n - i)) {
            accumulate(&mut sum, &Rational::from(1), a, b);
        }
    }
    sum
}

/// What is known up to an order.
struct Expansion<'a> {
    saddle: &'a Saddle,
    exponents: Vec<usize>,
    p: Rational,
    unknown: Vec<Rational>,
    amplitude: Vec<Rational>,
    omega: Vec<InTanh>,
    /// (-p T omega)^j at index j.
    speeds: Vec<Vec<InTanh>>,
    /// (r S)^e at index e.
    sizes: Vec<Vec<InTanh>>,
}

impl<'a> Expansion<'a> {
    fn new(saddle: &'a Saddle) -> Result<Self, MelnikovError> {
        let (p, omega) = saddle.unperturbed()?;
        let exponents = saddle.exponents()?;
        let amplitude = -(Rational::from(&p + 1) * &saddle.slope / &p / &saddle.leading);
        let velocity = saddle.perturbation.iter().map(|t| t.velocity as usize).max().unwrap_or(0);
        let exponent = exponents.iter().copied().max().unwrap_or(0);
        Ok(Self {
            saddle,
            exponents,
            p,
            unknown: Vec::new(),
            amplitude: vec![amplitude],
            omega: vec![vec![omega]],
            speeds: vec![Vec::new(); velocity + 1],
            sizes: vec![Vec::new(); exponent + 1],
        })
    }

    /// The powers of y'/y and of r S to eps^m, from omega_m and r_m.
    fn extend(&mut self, m: usize) {
        let one = if m == 0 { vec![Rational::from(1)] } else { Vec::new() };
        let minus = -self.p.clone();
        let mut speed = Vec::new();
        accumulate(&mut speed, &minus, &[Rational::new(), Rational::from(1)], &self.omega[m]);
        let size = self.sech_squared(&self.amplitude[m]);
        for (powers, first) in [(&mut self.speeds, speed), (&mut self.sizes, size)] {
            powers[0].push(one.clone());
            if let Some(power) = powers.get_mut(1) {
                power.push(first);
            }
            for j in 2..powers.len() {
                let next = coefficient(&powers[j - 1], &powers[1], m);
                powers[j].push(next);
            }
        }
    }

    /// factor S.
    #[expect(clippy::unused_self, reason = "reads as a formula")]
    fn sech_squared(&self, factor: &Rational) -> InTanh {
        vec![factor.clone(), Rational::new(), -factor.clone()]
    }

    /// The solution W of p [(p T^2 - S) W - S T W'/2] = right, and what is left of the coefficients
    /// of T^0 and T^1, which must vanish.
    fn solve(&self, right: &[Rational]) -> (InTanh, [Rational; 2]) {
        let mut w = vec![Rational::new(); right.len()];
        let mut left = [Rational::new(), Rational::new()];
        for m in (0..right.len()).rev() {
            let half = Rational::from((m as u64, 2));
            let sum = Rational::from(&half + 1) * &self.p * &w[m] + &right[m];
            match m.checked_sub(2) {
                Some(lower) => w[lower] = sum / (half + &self.p) / &self.p,
                None => left[m] = sum,
            }
        }
        w.truncate(right.len().saturating_sub(2).max(1));
        (w, left)
    }

    /// mu_(n-1), r_n and omega_n.
    fn step(&mut self, n: usize) -> Result<(), MelnikovError> {
        self.extend(n - 1);
        let (mut right, mut work) = (Vec::new(), Vec::new());
        for (term, exponent) in self.saddle.perturbation.iter().zip(&self.exponents) {
            let (speeds, sizes) = (&self.speeds[term.velocity as usize], &self.sizes[*exponent]);
            let one = [Rational::from(1)];
            accumulate(&mut right, &term.known, &coefficient(speeds, sizes, n - 1), &one);
            if term.unknown != 0 {
                for (i, mu) in self.unknown.iter().enumerate() {
                    let factor = Rational::from(mu * &term.unknown);
                    accumulate(&mut right, &factor, &coefficient(speeds, sizes, n - 1 - i), &one);
                }
                accumulate(&mut work, &term.unknown, &coefficient(speeds, sizes, 0), &one);
            }
        }
        let size = self.sech_squared(&self.saddle.leading);
        let (left, by_mu, by_r) = (self.solve(&right).1, self.solve(&work).1, self.solve(&size).1);
        if by_mu[1] == 0 {
            return Err(MelnikovError::UnknownWithoutWork);
        }
        let mu = -Rational::from(&left[1] / &by_mu[1]);
        let r = -(Rational::from(&mu * &by_mu[0]) + &left[0]) / &by_r[0];
        let one = [Rational::from(1)];
        accumulate(&mut right, &mu, &work, &one);
        accumulate(&mut right, &r, &size, &one);
        self.unknown.push(mu);
        self.amplitude.push(r);
        let next = self.root(self.solve(&right).0, n);
        self.omega.push(next);
        Ok(())
    }

    /// omega_n from W_n = sum omega_i omega_(n-i).
    fn root(&self, mut square: InTanh, n: usize) -> InTanh {
        for i in 1..n {
            let minus = Rational::from(-1);
            accumulate(&mut square, &minus, &self.omega[i], &self.omega[n - i]);
        }
        let twice = Rational::from(&self.omega[0][0] * 2);
        for c in &mut square {
            *c /= &twice;
        }
        while square.last().is_some_and(|c| *c == 0) {
            square.pop();
        }
        square
    }
}

#[cfg(test)]
mod tests;
