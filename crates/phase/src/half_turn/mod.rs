//! Functions of the phase on one half turn, for forces that jump where the velocity changes sign.
//!
//! Between two turning points sign x' is constant. If the phase psi is counted between turning points
//! (x' = 0 at psi = 0 and at psi = pi, at every order), a law with sign x' is a polynomial on
//! 0 < psi < pi, where x' < 0, and for odd laws, f(-x, -x') = -f(x, x'), the other half turn is the
//! point reflection x(a, psi + pi) = -x(a, psi). The ring is
//!
//!   Q(i)[a, 1/a, pi, 1/pi, parameters, 1/parameters][psi, e^{i psi}, e^{-i psi}];
//!
//! psi occurs as a power because the drift of the amplitude is felt within a half turn. `average` derives
//! expansions in it, `residual` substitutes them.

mod average;
mod print;
mod residual;
#[cfg(test)]
mod tests;

pub use average::{FrictionTerm, HalfTurnExpansion, average_half_turn};

use lindstedt_algebra::Stop;
use lindstedt_coeff::sparse::Monomial;
use lindstedt_coeff::{PowerProduct, Symbol};
use rug::{Complete, Rational};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::PI;

/// psi^phase e^{i harmonic psi} a^amplitude constants.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct HalfTurnMonomial {
    /// The power of the phase; it comes first, so that the last monomial has the highest one.
    pub phase: u32,
    /// The harmonic.
    pub harmonic: i32,
    /// The power of the amplitude.
    pub amplitude: i32,
    /// Powers of the number pi and of parameters.
    pub constants: PowerProduct,
}

/// A function on the half turn 0 <= psi <= pi: an exact sum of monomials with factors in Q(i), given by
/// their real and imaginary parts; none of them is zero, so equality is equality of functions.
///
/// ```
/// use lindstedt_phase::half_turn::HalfTurn;
/// // a cos psi
/// let x = HalfTurn::generating_solution();
/// assert!((x.value(2.0, 0.5, &[]) - 2.0 * 0.5f64.cos()).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HalfTurn(BTreeMap<HalfTurnMonomial, [Rational; 2]>);

impl HalfTurn {
    /// One monomial with a real factor.
    pub fn monomial(monomial: HalfTurnMonomial, factor: Rational) -> Self {
        let mut sum = Self::default();
        sum.insert(monomial, [factor, Rational::new()]);
        sum
    }

    /// A number times powers of pi and of parameters.
    pub fn constant(factor: Rational, constants: PowerProduct) -> Self {
        Self::monomial(HalfTurnMonomial { constants, ..HalfTurnMonomial::default() }, factor)
    }

    /// a cos psi.
    pub fn generating_solution() -> Self {
        Self::cosine().times_monomial(amplitude(1))
    }

    /// The monomials and their factors, real and imaginary part.
    pub fn terms(&self) -> impl Iterator<Item = (&HalfTurnMonomial, &[Rational; 2])> {
        self.0.iter()
    }

    /// Whether this is the zero function.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The real part at an amplitude, a phase and values of the parameters, in double precision (rounded,
    /// without a bound); NaN where a parameter has no value.
    pub fn value(&self, amplitude: f64, phase: f64, parameters: &[f64]) -> f64 {
        let power = |&(symbol, exponent): &(Symbol, i16)| {
            let base = match symbol {
                Symbol::Pi => Some(PI),
                Symbol::Parameter(index) => parameters.get(usize::from(index)).copied(),
                _ => None,
            };
            base.unwrap_or(f64::NAN).powi(exponent.into())
        };
        self.terms()
            .map(|(m, [re, im])| {
                let (sin, cos) = (f64::from(m.harmonic) * phase).sin_cos();
                (re.to_f64() * cos - im.to_f64() * sin)
                    * amplitude.powi(m.amplitude)
                    * phase.powf(f64::from(m.phase))
                    * m.constants.factors().iter().map(power).product::<f64>()
            })
            .sum()
    }

    /// The derivative with respect to psi.
    pub fn by_phase(&self) -> Self {
        let mut sum = Self::default();
        for (m, [re, im]) in self.terms() {
            let k = m.harmonic;
            sum.insert(m.clone(), [Rational::from(-k) * im, Rational::from(k) * re]);
            if let Some(phase) = m.phase.checked_sub(1) {
                let j = Rational::from(m.phase);
                sum.insert(
                    HalfTurnMonomial { phase, ..m.clone() },
                    [(&j * re).complete(), (&j * im).complete()],
                );
            }
        }
        sum
    }

    /// The derivative with respect to a.
    pub fn by_amplitude(&self) -> Self {
        let mut sum = Self::default();
        for (m, [re, im]) in self.terms() {
            let i = Rational::from(m.amplitude);
            let lower = HalfTurnMonomial { amplitude: m.amplitude - 1, ..m.clone() };
            sum.insert(lower, [(&i * re).complete(), (&i * im).complete()]);
        }
        sum
    }

    fn cosine() -> Self {
        Self::pair([Rational::from((1, 2)), Rational::new()])
    }

    fn sine() -> Self {
        Self::pair([Rational::new(), Rational::from((-1, 2))])
    }

    /// c e^{i psi} and its conjugate.
    fn pair([re, im]: [Rational; 2]) -> Self {
        let mut sum = Self::default();
        let at = |harmonic| HalfTurnMonomial { harmonic, ..HalfTurnMonomial::default() };
        sum.insert(at(-1), [re.clone(), (-&im).complete()]);
        sum.insert(at(1), [re, im]);
        sum
    }

    fn insert(&mut self, monomial: HalfTurnMonomial, [re, im]: [Rational; 2]) {
        match self.0.entry(monomial) {
            Entry::Vacant(entry) if re.is_zero() && im.is_zero() => drop(entry),
            Entry::Vacant(entry) => {
                entry.insert([re, im]);
            }
            Entry::Occupied(mut entry) => {
                let factor = entry.get_mut();
                factor[0] += re;
                factor[1] += im;
                if factor.iter().all(Rational::is_zero) {
                    entry.remove();
                }
            }
        }
    }

    fn add_scaled(&mut self, other: &Self, factor: &Rational) {
        for (m, [re, im]) in other.terms() {
            self.insert(m.clone(), [(re * factor).complete(), (im * factor).complete()]);
        }
    }

    /// Broken off when it is asked to stop: whoever asks throws the sum away.
    fn add_product(&mut self, one: &Self, other: &Self, stop: &Stop) {
        for (m, [a, b]) in one.terms().take_while(|_| !stop.asked()) {
            for (n, [c, d]) in other.terms() {
                let re = (a * c).complete() - (b * d).complete();
                let im = (a * d).complete() + (b * c).complete();
                self.insert(product(m, n), [re, im]);
            }
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.add_scaled(other, &Rational::from(1));
        sum
    }

    /// The product.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut sum = Self::default();
        sum.add_product(self, other, &Stop::default());
        sum
    }

    fn times_monomial(&self, monomial: HalfTurnMonomial) -> Self {
        self.times(&Self::monomial(monomial, Rational::from(1)))
    }

    /// The value at psi = 0, a function of a alone.
    fn at_start(&self) -> Self {
        let mut sum = Self::default();
        for (m, factor) in self.terms().filter(|(m, _)| m.phase == 0) {
            sum.insert(HalfTurnMonomial { harmonic: 0, ..m.clone() }, factor.clone());
        }
        sum
    }

    /// The value at psi = pi, a function of a alone.
    fn at_end(&self) -> Self {
        let mut sum = Self::default();
        for (m, [re, im]) in self.terms() {
            let sign = Rational::from(if m.harmonic % 2 == 0 { 1 } else { -1 });
            let constants = m.constants.times(&pi(m.phase.cast_signed()).constants);
            let at = HalfTurnMonomial { harmonic: 0, phase: 0, constants, ..*m };
            sum.insert(at, [(&sign * re).complete(), (&sign * im).complete()]);
        }
        sum
    }

    /// A solution of u'' + u = f. On psi^j e^{ik psi} with u = q(psi) e^{ik psi}:
    /// q'' + 2ik q' + (1 - k^2) q = psi^j, solved from the highest power down; where k^2 = 1 for q' first.
    fn oscillator_response(&self) -> Self {
        let mut rest = self.clone();
        let mut response = Self::default();
        // The highest power of psi first: what a step leaves has lower powers.
        while let Some((m, [re, im])) = rest.0.last_key_value() {
            let (m, re, im) = (m.clone(), re.clone(), im.clone());
            let k = m.harmonic;
            let mut step = Self::default();
            if k == 1 || k == -1 {
                // psi^{j+1} / (2ik (j+1)): 1/i = -i, 1/k = k.
                let d = Rational::from((k, 2)) / Rational::from(m.phase + 1);
                let raised = HalfTurnMonomial { phase: m.phase + 1, ..m.clone() };
                step.insert(raised, [(&d * &im).complete(), -(&d * &re).complete()]);
            } else {
                let d = Rational::from(1) - Rational::from(k) * Rational::from(k);
                step.insert(m, [re / &d, im / &d]);
            }
            let minus = Rational::from(-1);
            rest.add_scaled(&step, &minus);
            rest.add_scaled(&step.by_phase().by_phase(), &minus);
            response.add_scaled(&step, &Rational::from(1));
        }
        response
    }
}

fn product(m: &HalfTurnMonomial, n: &HalfTurnMonomial) -> HalfTurnMonomial {
    HalfTurnMonomial {
        phase: m.phase + n.phase,
        harmonic: m.harmonic + n.harmonic,
        amplitude: m.amplitude + n.amplitude,
        constants: m.constants.times(&n.constants),
    }
}

/// a^power.
fn amplitude(power: i32) -> HalfTurnMonomial {
    HalfTurnMonomial { amplitude: power, ..HalfTurnMonomial::default() }
}

/// pi^power; powers are bounded by the order, far below those of i16.
fn pi(power: i32) -> HalfTurnMonomial {
    let power = i16::try_from(power).unwrap_or(i16::MAX);
    let constants = PowerProduct::power(Symbol::Pi, power);
    HalfTurnMonomial { constants, ..HalfTurnMonomial::default() }
}
