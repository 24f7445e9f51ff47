//! The slow flow of one unknown in polar coordinates, as books print it.
//!
//! z = (a/2) e^{i psi}. With Omega/nu = s/t in lowest terms every monomial of f turns as e^{i (psi + g gamma)},
//! gamma = t eta - s psi slow, so that
//!
//!   a' = sum eps^n A_n(a, gamma),   a psi' = nu a + sum eps^n P_n(a, gamma),
//!   a gamma' = t sum eps^n sigma_n a - s sum eps^n P_n,
//!
//! A_n + i P_n = sum 2 c (a/2)^{p+q} e^{i g gamma} over the monomials c z^p zbar^q E^{g t} of f_n.

use super::{SlowFlow, Terms};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::Rational;
use std::collections::BTreeMap;

/// c a^power cos(g gamma) or c a^power sin(g gamma) with a product of symbols.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarTerm {
    /// The power of a.
    pub power: u32,
    /// g; 0 for a term without gamma.
    pub harmonic: u32,
    /// Whether it is the sine.
    pub sine: bool,
    /// The exponents of the symbols.
    pub symbols: Vec<i32>,
    /// c.
    pub coefficient: Rational,
}

/// The slow flow in a and gamma.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// t, s of gamma = t eta - s psi; nothing where no force is in resonance: then the second rate is a psi'.
    pub slow: Option<[u32; 2]>,
    /// A_n from n = 1.
    pub amplitude: Vec<Vec<PolarTerm>>,
    /// Order n of a gamma', or of a psi', from n = 1.
    pub phase: Vec<Vec<PolarTerm>>,
}

/// Power, harmonic, sine, symbols.
type Key = (u32, u32, bool, Vec<i32>);

impl SlowFlow {
    /// In polar coordinates; nothing for several unknowns or phases, or an irrational frequency.
    #[must_use]
    pub fn polar(&self) -> Option<Polar> {
        let ([nu], [flow]) = (&self.system.frequencies[..], &self.flow[..]) else { return None };
        if self.forces() > 1 || !self.system.is_exact() {
            return None;
        }
        let ratio = self.system.force() / nu;
        let turned = |terms: &Terms| terms.iter().any(|t| t.exponents[2] != 0);
        let numbers = || Some([ratio.denom().to_u32()?, ratio.numer().to_u32()?]);
        let slow = if flow.iter().any(turned) { Some(numbers()?) } else { None };
        let mut polar = Polar { slow, amplitude: Vec::new(), phase: Vec::new() };
        for (n, terms) in flow.iter().enumerate().skip(1) {
            let (amplitude, mut phase) = rates(terms, slow.map_or(1, |[t, _]| t));
            if let Some([t, s]) = slow {
                phase.values_mut().for_each(|c| *c *= -Rational::from(s));
                let sigma = self.detuning.first().and_then(|list| list.get(n - 1));
                for term in sigma.into_iter().flatten() {
                    let key = (1, 0, false, term.exponents[3..].to_vec());
                    *phase.entry(key).or_default() += Rational::from(&term.re * t);
                }
            }
            polar.amplitude.push(listed(amplitude));
            polar.phase.push(listed(phase));
        }
        Some(polar)
    }
}

fn listed(sum: BTreeMap<Key, Rational>) -> Vec<PolarTerm> {
    let terms = sum.into_iter().filter(|(_, c)| !c.is_zero());
    let term = |((power, harmonic, sine, symbols), coefficient)| PolarTerm {
        power,
        harmonic,
        sine,
        symbols,
        coefficient,
    };
    terms.map(term).collect()
}

/// A_n and P_n.
fn rates(terms: &[AmplitudeTerm], t: u32) -> (BTreeMap<Key, Rational>, BTreeMap<Key, Rational>) {
    let (mut amplitude, mut phase) = (BTreeMap::<Key, Rational>::new(), BTreeMap::new());
    for term in terms {
        let [p, q, m] = [0, 1, 2].map(|i| term.exponents[i]);
        let power = (p + q).unsigned_abs();
        let scale = Rational::from((2, 1)) >> power;
        let g = m / t.cast_signed();
        let symbols = term.exponents[3..].to_vec();
        let add = |sum: &mut BTreeMap<Key, Rational>, sine, c: Rational| {
            let key = (power, g.unsigned_abs(), sine, symbols.clone());
            *sum.entry(key).or_default() += c * &scale;
        };
        // (re + i im)(cos + i sin).
        add(&mut amplitude, false, term.re.clone());
        add(&mut phase, false, term.im.clone());
        if g != 0 {
            let sign = Rational::from(g.signum());
            add(&mut amplitude, true, Rational::from(-&term.im) * &sign);
            add(&mut phase, true, Rational::from(&term.re * &sign));
        }
    }
    (amplitude, phase)
}
