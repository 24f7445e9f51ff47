//! Functions of an amplitude a, a phase psi and a forcing phase eta: trigonometric polynomials
//!
//!   f = sum_(k,m) ( c_(k,m) cos(k psi + m eta) + s_(k,m) sin(k psi + m eta) )
//!
//! with Laurent polynomials in a as coefficients. Canonical: k > 0, or k = 0 and m >= 0; no
//! harmonic is stored that vanishes. Products cost one coefficient product for each of the four
//! combinations of two harmonics; all else is linear in the number of harmonics.

mod print;

use lindstedt_algebra::{
    Averaged, AveragingAlgebra, ForcedAlgebra, FunctionAlgebra, LinearPart, NEAR_MISS, PhaseError,
    RationalAlgebra, Ring, Stop,
};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials};
use rug::Rational;
use std::collections::BTreeMap;

/// (k, m) of a harmonic cos(k psi + m eta).
pub type Harmonic = (i32, i32);

/// A function: for every harmonic the amplitudes of cosine and sine.
#[derive(Clone, Debug, PartialEq)]
pub struct TorusElement<E> {
    harmonics: BTreeMap<Harmonic, [AmplitudePolynomial<E>; 2]>,
}

impl<E> TorusElement<E> {
    /// The harmonics (k, m) with the amplitudes of cos(k psi + m eta) and sin(k psi + m eta).
    pub fn harmonics(&self) -> &BTreeMap<Harmonic, [AmplitudePolynomial<E>; 2]> {
        &self.harmonics
    }
}

/// A delay T with what the fast phases do meanwhile.
#[derive(Clone, Debug)]
pub struct Delay<E> {
    /// T.
    pub time: E,
    /// cos(omega_0 T), sin(omega_0 T).
    pub free: [E; 2],
    /// cos(omega T), sin(omega T).
    pub forced: [E; 2],
}

/// The algebra over a ring K of numbers or parameters, with the rates omega_0 of psi and omega of eta at
/// order zero and the delays T_j: what averaging needs ([`AveragingAlgebra`]). Exact over an exact K; over
/// balls every coefficient is an enclosure.
///
/// ```
/// use lindstedt_algebra::{Rationals, Ring};
/// use lindstedt_phase::Torus;
/// use rug::Rational;
/// let torus = Torus::new(Rationals, Rational::from(1), None, Vec::new());
/// assert!(torus.is_zero(&torus.add(&torus.one(), &torus.neg(&torus.one()))));
/// ```
#[derive(Clone, Debug)]
pub struct Torus<K: RationalAlgebra> {
    constants: AmplitudePolynomials<K>,
    /// omega_0, the rate of psi at order zero.
    frequency: K::Element,
    /// omega, the rate of eta.
    forcing: Option<K::Element>,
    delays: Vec<Delay<K::Element>>,
    stop: Stop,
}

/// A complex number or function, real and imaginary part.
type Complex<E> = [E; 2];

fn times<R: Ring>(
    ring: &R,
    x: &Complex<R::Element>,
    y: &Complex<R::Element>,
) -> Complex<R::Element> {
    let minus = ring.neg(&y[1]);
    [
        ring.sum_of_products(&[(&x[0], &y[0]), (&x[1], &minus)]),
        ring.sum_of_products(&[(&x[0], &y[1]), (&x[1], &y[0])]),
    ]
}

impl<K: RationalAlgebra> Torus<K> {
    /// The algebra with the free frequency omega_0, the frequency of the force (if there is one)
    /// and the delays.
    pub fn new(
        coefficients: K,
        frequency: K::Element,
        forcing: Option<K::Element>,
        delays: Vec<Delay<K::Element>>,
    ) -> Self {
        let constants = AmplitudePolynomials::new(coefficients);
        Self { constants, frequency, forcing, delays, stop: Stop::default() }
    }

    /// The algebra whose products are broken off when `stop` says so.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// K.
    pub fn coefficients(&self) -> &K {
        &self.constants.coefficients
    }

    /// c cos(k psi + m eta) + s sin(k psi + m eta).
    pub fn harmonic(
        &self,
        harmonic: Harmonic,
        amplitudes: [AmplitudePolynomial<K::Element>; 2],
    ) -> TorusElement<K::Element> {
        let mut f = self.zero();
        self.add_harmonic(&mut f, harmonic, amplitudes);
        f
    }

    fn add_harmonic(
        &self,
        f: &mut TorusElement<K::Element>,
        (mut k, mut m): Harmonic,
        [c, mut s]: [AmplitudePolynomial<K::Element>; 2],
    ) {
        if (k, m) < (0, 0) {
            (k, m) = (-k, -m);
            s = self.constants.neg(&s);
        }
        if (k, m) == (0, 0) {
            s = self.constants.zero();
        }
        let zero = || [self.constants.zero(), self.constants.zero()];
        let known = f.harmonics.entry((k, m)).or_insert_with(zero);
        self.constants.add_assign(&mut known[0], &c);
        self.constants.add_assign(&mut known[1], &s);
        if known.iter().all(|x| self.constants.is_zero(x)) {
            f.harmonics.remove(&(k, m));
        }
    }

    fn map(
        &self,
        f: &TorusElement<K::Element>,
        mut g: impl FnMut(
            Harmonic,
            &[AmplitudePolynomial<K::Element>; 2],
        ) -> [AmplitudePolynomial<K::Element>; 2],
    ) -> TorusElement<K::Element> {
        let mut image = self.zero();
        for (harmonic, amplitudes) in &f.harmonics {
            let amplitudes = g(*harmonic, amplitudes);
            if amplitudes.iter().any(|x| !self.constants.is_zero(x)) {
                image.harmonics.insert(*harmonic, amplitudes);
            }
        }
        image
    }

    /// k omega_0 + m omega.
    fn rate(&self, (k, m): Harmonic) -> K::Element {
        let ring = self.coefficients();
        let free = ring.scale(&self.frequency, &Rational::from(k));
        match &self.forcing {
            Some(forcing) => ring.add(&free, &ring.scale(forcing, &Rational::from(m))),
            None => free,
        }
    }

    /// e^(-i (k omega_0 + m omega) T).
    fn turn(&self, delay: &Delay<K::Element>, (k, m): Harmonic) -> Complex<K::Element> {
        let ring = self.coefficients();
        let mut result = [ring.one(), ring.zero()];
        for ([cos, sin], n) in [(&delay.free, k), (&delay.forced, m)] {
            let sin = if n < 0 { sin.clone() } else { ring.neg(sin) };
            let factor = [cos.clone(), sin];
            for _ in 0..n.unsigned_abs() {
                result = times(ring, &result, &factor);
            }
        }
        result
    }

    /// The factors of the linear part, elements of K.
    fn linear_part(
        &self,
        linear: &LinearPart<AmplitudePolynomial<K::Element>>,
    ) -> Option<LinearPart<K::Element>> {
        let constant = |f| self.constants.as_coefficient(f);
        let delayed = linear.delayed.iter().map(|(b, c)| Some((constant(b)?, constant(c)?)));
        Some(LinearPart {
            stiffness: constant(&linear.stiffness)?,
            damping: constant(&linear.damping)?,
            delayed: delayed.collect::<Option<_>>()?,
        })
    }

    /// 1/L(i nu), nu = k omega_0 + m omega. Without damping and delay L(i omega_0) = 0 says that
    /// L(i nu) = (omega_0 - nu)(omega_0 + nu), which keeps denominators factored; a number that is almost zero is refused.
    fn inverse_response(
        &self,
        linear: &LinearPart<K::Element>,
        harmonic: Harmonic,
    ) -> Result<Complex<K::Element>, PhaseError> {
        let ring = self.coefficients();
        let nu = self.rate(harmonic);
        let (free, forced) = harmonic;
        let invert = |value: &K::Element| {
            if ring.is_zero(value) {
                return Err(PhaseError::Resonance { free, forced });
            }
            ring.reciprocal(value).ok_or(PhaseError::Indivisible { free, forced })
        };
        let is_zero = |c: &K::Element| ring.is_zero(c);
        if is_zero(&linear.damping) && linear.delayed.iter().all(|(b, c)| is_zero(b) && is_zero(c))
        {
            let below = invert(&ring.sub(&self.frequency, &nu))?;
            let above = invert(&ring.add(&self.frequency, &nu))?;
            let rational = |c: &K::Element| ring.as_rational(c);
            if let (Some(rate), Some(frequency)) = (rational(&nu), rational(&self.frequency)) {
                let size = Rational::from(1) - (rate / frequency).square();
                if *size.as_abs() < Rational::from(NEAR_MISS) {
                    return Err(PhaseError::NearMiss { free, forced, size });
                }
            }
            return Ok([ring.mul(&below, &above), ring.zero()]);
        }
        let mut re = ring.sub(&linear.stiffness, &ring.mul(&nu, &nu));
        let mut im = ring.mul(&linear.damping, &nu);
        for (delay, (b, c)) in self.delays.iter().zip(&linear.delayed) {
            let gain = [b.clone(), ring.mul(c, &nu)];
            let [x, y] = times(ring, &gain, &self.turn(delay, harmonic));
            ring.add_assign(&mut re, &x);
            ring.add_assign(&mut im, &y);
        }
        let inverse = invert(&ring.sum_of_products(&[(&re, &re), (&im, &im)]))?;
        Ok([ring.mul(&re, &inverse), ring.neg(&ring.mul(&im, &inverse))])
    }

    /// 1/L'(i omega_0), L'(lambda) = 2 lambda + damping + sum_j (c_j - T_j (b_j + c_j lambda)) e^(-lambda T_j).
    fn inverse_slope(
        &self,
        linear: &LinearPart<K::Element>,
    ) -> Result<Complex<K::Element>, PhaseError> {
        let ring = self.coefficients();
        let mut slope = [linear.damping.clone(), ring.scale(&self.frequency, &Rational::from(2))];
        for (delay, (b, c)) in self.delays.iter().zip(&linear.delayed) {
            let late = ring.neg(&delay.time);
            let re = ring.add(c, &ring.mul(&late, b));
            let im = ring.mul(&late, &ring.mul(c, &self.frequency));
            let [x, y] = times(ring, &[re, im], &self.turn(delay, (1, 0)));
            ring.add_assign(&mut slope[0], &x);
            ring.add_assign(&mut slope[1], &y);
        }
        let [re, im] = slope;
        let square = ring.sum_of_products(&[(&re, &re), (&im, &im)]);
        let failed = PhaseError::Indivisible { free: 1, forced: 0 };
        let inverse = ring.reciprocal(&square).ok_or(failed)?;
        Ok([ring.mul(&re, &inverse), ring.neg(&ring.mul(&im, &inverse))])
    }

    /// (c - i s) z for the amplitudes of Re[(c - i s) e^(i theta)].
    fn rotate(
        &self,
        [c, s]: &[AmplitudePolynomial<K::Element>; 2],
        [re, im]: &Complex<K::Element>,
    ) -> [AmplitudePolynomial<K::Element>; 2] {
        let ring = &self.constants;
        let cos = ring.add(&ring.times(c, re), &ring.times(s, im));
        let sin = ring.sub(&ring.times(s, re), &ring.times(c, im));
        [cos, sin]
    }
}

impl<K: RationalAlgebra> Ring for Torus<K> {
    type Element = TorusElement<K::Element>;

    fn zero(&self) -> Self::Element {
        TorusElement { harmonics: BTreeMap::new() }
    }
    fn one(&self) -> Self::Element {
        self.embed(&self.constants.one())
    }
    fn is_zero(&self, f: &Self::Element) -> bool {
        f.harmonics.is_empty()
    }
    fn may_vanish(&self, f: &Self::Element) -> bool {
        f.harmonics.values().flatten().all(|c| self.constants.may_vanish(c))
    }
    fn add_assign(&self, f: &mut Self::Element, g: &Self::Element) {
        for (harmonic, amplitudes) in &g.harmonics {
            self.add_harmonic(f, *harmonic, amplitudes.clone());
        }
    }
    fn neg(&self, f: &Self::Element) -> Self::Element {
        self.map(f, |_, [c, s]| [self.constants.neg(c), self.constants.neg(s)])
    }
    fn mul(&self, f: &Self::Element, g: &Self::Element) -> Self::Element {
        self.sum_of_products(&[(f, g)])
    }
    /// Re[p e^(i x)] Re[q e^(i y)] = (Re[p q e^(i(x+y))] + Re[p q* e^(i(x-y))])/2.
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let ring = &self.constants;
        let half = Rational::from((1, 2));
        let mut sum = self.zero();
        for (f, g) in pairs {
            for ((k, m), [c, s]) in &f.harmonics {
                for ((j, n), [x, y]) in &g.harmonics {
                    if self.stop.asked() {
                        return self.zero();
                    }
                    let [cx, sy, cy, sx] =
                        [(c, x), (s, y), (c, y), (s, x)].map(|(a, b)| ring.mul(a, b));
                    let high = [ring.sub(&cx, &sy), ring.add(&cy, &sx)];
                    let low = [ring.add(&cx, &sy), ring.sub(&sx, &cy)];
                    self.add_harmonic(&mut sum, (k + j, m + n), high);
                    self.add_harmonic(&mut sum, (k - j, m - n), low);
                }
            }
        }
        self.scale(&sum, &half)
    }
}

impl<K: RationalAlgebra> RationalAlgebra for Torus<K> {
    fn rational(&self, q: &Rational) -> Self::Element {
        self.embed(&self.constants.rational(q))
    }
    fn scale(&self, f: &Self::Element, q: &Rational) -> Self::Element {
        self.map(f, |_, [c, s]| [self.constants.scale(c, q), self.constants.scale(s, q)])
    }
    /// Only functions of the amplitude are units.
    fn reciprocal(&self, f: &Self::Element) -> Option<Self::Element> {
        Some(self.embed(&self.constants.reciprocal(&self.as_constant(f)?)?))
    }
    fn as_rational(&self, f: &Self::Element) -> Option<Rational> {
        self.constants.as_rational(&self.as_constant(f)?)
    }
}

impl<K: RationalAlgebra> FunctionAlgebra for Torus<K> {
    type Constants = AmplitudePolynomials<K>;

    fn constants(&self) -> &Self::Constants {
        &self.constants
    }
    fn embed(&self, c: &AmplitudePolynomial<K::Element>) -> Self::Element {
        self.harmonic((0, 0), [c.clone(), self.constants.zero()])
    }
    fn scale_by(&self, f: &Self::Element, c: &AmplitudePolynomial<K::Element>) -> Self::Element {
        self.map(f, |_, [x, y]| [self.constants.mul(x, c), self.constants.mul(y, c)])
    }
    fn as_constant(&self, f: &Self::Element) -> Option<AmplitudePolynomial<K::Element>> {
        if f.harmonics.is_empty() {
            return Some(self.constants.zero());
        }
        let only = f.harmonics.get(&(0, 0)).filter(|_| f.harmonics.len() == 1)?;
        Some(only[0].clone())
    }
    fn interrupted(&self) -> bool {
        self.stop.asked()
    }
    /// ln 1 = 0; no other logarithm is a trigonometric polynomial.
    fn log_abs(&self, f: &Self::Element) -> Option<Self::Element> {
        (*f == self.one()).then(|| self.zero())
    }
    fn terms(&self, f: &Self::Element) -> usize {
        f.harmonics.values().flatten().map(|c| c.terms().len()).sum()
    }
}

impl<K: RationalAlgebra> ForcedAlgebra for Torus<K> {
    fn delays(&self) -> usize {
        self.delays.len()
    }
    fn forcing(&self, multiple: u32) -> Option<(Self::Element, Self::Element)> {
        self.forcing.as_ref()?;
        let m = i32::try_from(multiple).ok()?;
        let (zero, one) = (self.constants.zero(), self.constants.one());
        let cos = self.harmonic((0, m), [one.clone(), zero.clone()]);
        Some((cos, self.harmonic((0, m), [zero, one])))
    }
}

impl<K: RationalAlgebra> AveragingAlgebra for Torus<K> {
    fn generating_solution(&self) -> Self::Element {
        let amplitude = self.constants.power(1, self.coefficients().one());
        self.harmonic((1, 0), [amplitude, self.constants.zero()])
    }
    fn first_harmonic_of(&self, f: &Self::Element) -> [AmplitudePolynomial<K::Element>; 2] {
        let zero = || [self.constants.zero(), self.constants.zero()];
        f.harmonics.get(&(1, 0)).cloned().unwrap_or_else(zero)
    }
    fn by_amplitude(&self, f: &Self::Element) -> Self::Element {
        self.map(f, |_, [c, s]| [self.constants.derivative(c), self.constants.derivative(s)])
    }
    fn by_phase(&self, f: &Self::Element) -> Self::Element {
        self.map(f, |(k, _), [c, s]| {
            let ring = &self.constants;
            [ring.scale(s, &Rational::from(k)), ring.scale(c, &Rational::from(-k))]
        })
    }
    fn by_time(&self, f: &Self::Element) -> Self::Element {
        self.map(f, |harmonic, [c, s]| {
            let (ring, nu) = (&self.constants, self.rate(harmonic));
            [ring.times(s, &nu), ring.neg(&ring.times(c, &nu))]
        })
    }
    fn shift(&self, f: &Self::Element, delay: usize) -> Option<Self::Element> {
        let delay = self.delays.get(delay)?;
        Some(
            self.map(f, |harmonic, amplitudes| {
                self.rotate(amplitudes, &self.turn(delay, harmonic))
            }),
        )
    }
    fn delay(&self, delay: usize) -> Option<AmplitudePolynomial<K::Element>> {
        Some(self.constants.embed(self.delays.get(delay)?.time.clone()))
    }

    /// With f = Re[(c - i s) e^(i theta)]: u = (c - i s)/L(i nu) for every harmonic but the first,
    /// and A + i a B = (c - i s)/L'(i omega_0) there.
    fn average(
        &self,
        linear: &LinearPart<AmplitudePolynomial<K::Element>>,
        f: &Self::Element,
    ) -> Result<Averaged<Self>, PhaseError> {
        let failed = PhaseError::Indivisible { free: 1, forced: 0 };
        let linear = self.linear_part(linear).ok_or(failed)?;
        let mut response = self.zero();
        let (mut amplitude_rate, mut phase_rate) = (self.constants.zero(), self.constants.zero());
        for (&harmonic, amplitudes) in &f.harmonics {
            if harmonic == (1, 0) {
                let [re, minus_im] = self.rotate(amplitudes, &self.inverse_slope(&linear)?);
                amplitude_rate = re;
                phase_rate = self.constants.neg(&self.constants.shift(&minus_im, -1));
            } else {
                let inverse = self.inverse_response(&linear, harmonic)?;
                let amplitudes = self.rotate(amplitudes, &inverse);
                self.add_harmonic(&mut response, harmonic, amplitudes);
            }
        }
        Ok(Averaged { amplitude_rate, phase_rate, response })
    }
}

#[cfg(test)]
mod tests;
