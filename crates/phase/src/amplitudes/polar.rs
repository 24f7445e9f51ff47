//! Functions of one amplitude and its phase as they are printed: with z = (a/2) e^{i psi} a real polynomial is
//!
//!   f = sum_(k,m) ( c_(k,m) cos(k psi + m eta) + s_(k,m) sin(k psi + m eta) ),   k > 0, or k = 0 and m >= 0,
//!
//! with polynomials in a as c and s, and a slow flow z' = i nu z + z h(z zbar) is a' = a Re h, psi' = nu + Im h.

use super::{AmplitudeElement, Amplitudes, Scalars};
use lindstedt_algebra::{RationalAlgebra, combination};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials, AmplitudePower};
use lindstedt_coeff::print::{Print, Style, Term, latex_name, print_sum};
use rug::{Integer, Rational};
use std::collections::BTreeMap;
use std::fmt::Debug;

/// (k, m) of a harmonic cos(k psi + m eta).
pub type Harmonic = (i32, i32);

/// A function: the amplitudes of cosine and sine of every harmonic that does not vanish.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar<N> {
    harmonics: BTreeMap<Harmonic, [AmplitudePolynomial<N>; 2]>,
}

impl<N: Clone + PartialEq + Debug + Send + Sync> Polar<N> {
    /// The harmonics (k, m) with the amplitudes of cos(k psi + m eta) and sin(k psi + m eta).
    pub fn harmonics(&self) -> &BTreeMap<Harmonic, [AmplitudePolynomial<N>; 2]> {
        &self.harmonics
    }

    /// The number of terms.
    pub fn terms(&self) -> usize {
        self.harmonics.values().flatten().map(|c| c.terms().len()).sum()
    }
}

/// Powers of a with their factors, not sorted.
type Powers<N> = Vec<(AmplitudePower, N)>;

/// What makes numbers of the real and the imaginary part of a constant; nothing of zeros.
pub type Read<'a, E, N> = &'a dyn Fn(&AmplitudeElement<E>) -> Option<[Option<N>; 2]>;

impl<S: Scalars> Amplitudes<S> {
    /// The real and the imaginary part of a constant without symbols.
    pub fn parts(&self, c: &AmplitudeElement<S::Element>) -> Option<[Option<S::Number>; 2]> {
        let number =
            |part| (!self.scalars.is_zero(part)).then(|| self.scalars.number(part, &c.denominator));
        match &c.terms[..] {
            [] => Some([None, None]),
            [(0, parts)] => Some(parts.each_ref().map(number)),
            _ => None,
        }
    }

    /// A real f of one unknown and one force (or none); nothing where a constant cannot be read.
    pub fn polar<N: Clone + PartialEq + Debug + Send + Sync>(
        &self,
        f: &AmplitudeElement<S::Element>,
        read: Read<'_, S::Element, N>,
    ) -> Option<Polar<N>> {
        let mut harmonics: BTreeMap<Harmonic, [Powers<N>; 2]> = BTreeMap::new();
        for ([p, q, m], c) in self.constants_of(f) {
            let harmonic = (p - q, m);
            if harmonic < (0, 0) {
                continue;
            }
            // c z^p zbar^q E^m and its conjugate are 2 Re(c e^{i ...}) (a/2)^(p + q).
            let c = self.halved(&self.conjugated(&c), p + q - i32::from(harmonic > (0, 0)));
            let entry = harmonics.entry(harmonic).or_default();
            let power = AmplitudePower(p + q);
            for (list, part) in entry.iter_mut().zip(read(&c)?) {
                list.extend(part.map(|part| (power, part)));
            }
        }
        let harmonics = harmonics.into_iter().map(|(k, lists)| (k, lists.map(collected)));
        Some(Polar { harmonics: harmonics.collect() })
    }

    /// a Re h and Im h of f = z h(z zbar), of one unknown; nothing where f is not of that form.
    pub fn polar_rates<N: Clone + PartialEq + Debug + Send + Sync>(
        &self,
        f: &AmplitudeElement<S::Element>,
        read: Read<'_, S::Element, N>,
    ) -> Option<[AmplitudePolynomial<N>; 2]> {
        let mut rates = [Powers::new(), Powers::new()];
        for ([p, q, m], c) in self.constants_of(f) {
            if p - q != 1 || m != 0 {
                return None;
            }
            let parts = read(&self.halved(&c, 2 * q))?;
            for ((list, part), power) in rates.iter_mut().zip(parts).zip([p + q, p + q - 1]) {
                list.extend(part.map(|part| (AmplitudePower(power), part)));
            }
        }
        Some(rates.map(collected))
    }

    /// The exponents of z, zbar and E with the constants that are their factors.
    fn constants_of(
        &self,
        f: &AmplitudeElement<S::Element>,
    ) -> Vec<([i32; 3], AmplitudeElement<S::Element>)> {
        let mut groups: BTreeMap<[i32; 3], Vec<_>> = BTreeMap::new();
        for (word, c) in &f.terms {
            let [p, q, m, ..] = self.layout.exponents(*word, self.moving()).0;
            let own = self.layout.pack(&[p, q, m], 0);
            groups.entry([p, q, m]).or_default().push((word - own, c.clone()));
        }
        let constant = |terms| self.canonical(f.denominator.clone(), terms, false);
        groups.into_iter().map(|(key, terms)| (key, constant(terms))).collect()
    }

    /// c/2^n.
    fn halved(&self, c: &AmplitudeElement<S::Element>, n: i32) -> AmplitudeElement<S::Element> {
        let two = Rational::from(2);
        self.scale(
            c,
            &if n < 0 { two } else { Rational::from((1, Integer::from(1) << n.unsigned_abs())) },
        )
    }
}

/// The polynomial of powers that are different.
fn collected<N: Clone + PartialEq + Debug + Send + Sync>(
    mut powers: Powers<N>,
) -> AmplitudePolynomial<N> {
    powers.sort_unstable_by_key(|(power, _)| *power);
    AmplitudePolynomial::from_increasing(powers).unwrap_or_default()
}

impl<N: Clone + PartialEq + Debug + Send + Sync> Polar<N> {
    /// The function as one line, with the phases psi and eta; harmonics increase, those of the
    /// force alone first, cosine before sine.
    pub fn print<K: RationalAlgebra<Element = N> + Print>(
        &self,
        ring: &AmplitudePolynomials<K>,
        style: Style,
    ) -> String {
        let mut terms: Vec<Term> = Vec::new();
        for (&harmonic, amplitudes) in &self.harmonics {
            for (amplitude, function) in amplitudes.iter().zip(["cos", "sin"]) {
                if amplitude.terms().is_empty() {
                    continue;
                }
                let name = (harmonic != (0, 0)).then(|| wave(function, harmonic, style));
                if name.is_none() {
                    terms.extend(ring.print_terms(amplitude, style));
                } else {
                    terms.push(ring.factor(amplitude, style).times(name));
                }
            }
        }
        print_sum(&terms, style)
    }
}

/// cos(k psi + m eta).
fn wave(function: &str, (k, m): Harmonic, style: Style) -> String {
    let angle = if style == Style::Latex {
        let names = ["psi", "eta"].map(latex_name);
        combination([k, m], names.each_ref().map(String::as_str), r"\,")
    } else {
        combination([k, m], ["psi", "eta"], "*")
    };
    let backslash = if style == Style::Latex { r"\" } else { "" };
    format!("{backslash}{function}({angle})")
}

#[cfg(test)]
mod tests {
    use super::super::scalars::Integers;
    use super::*;
    use lindstedt_algebra::{AmplitudeAlgebra, ForcedAlgebra, Rationals, Ring};
    use rug::Rational;

    #[test]
    fn sums_and_angles() {
        let Some(t) = Amplitudes::off_resonance(Integers, &1.into(), Some(&2.into())) else {
            panic!("two rates")
        };
        let ring = AmplitudePolynomials::new(Rationals);
        let z = t.amplitude(0);
        let polar = |f: &_| match t.polar(f, &|c| t.parts(c)) {
            Some(polar) => polar,
            None => panic!("numbers"),
        };
        let Some((_, sin)) = t.forcing(1) else { panic!("a force") };
        // z^2 + zbar^2 = a^2/2 cos(2 psi).
        let square = t.mul(&z, &t.conjugate(&z));
        let mixed = t.mul(&t.twice_real(&t.mul(&z, &z)), &sin);
        let f = t.add(&t.add(&t.scale(&square, &Rational::from(-6)), &t.twice_real(&z)), &mixed);
        let text = "-3/2*a^2 + a*cos(psi) - 1/4*a^2*sin(2*psi - eta) + 1/4*a^2*sin(2*psi + eta)";
        assert_eq!(polar(&f).print(&ring, Style::Text), text);
        let Some((wave, _)) = t.forcing(3) else { panic!("a force") };
        assert_eq!(polar(&wave).print(&ring, Style::Latex), r"\cos(3\,\eta)");
        assert_eq!(polar(&t.zero()).print(&ring, Style::Text), "0");
        // (1 + 4 i |z|^2) z: i z is the rate of z.
        let turn = t.scale(&t.mul(&square, &t.by_time(&z)), &Rational::from(4));
        let shown = t.polar_rates(&t.add(&z, &turn), &|c| t.parts(c));
        let shown = shown.map(|rates| rates.map(|r| ring.print(&r, Style::Text)));
        assert_eq!(shown, Some(["a".to_owned(), "a^2".to_owned()]));
        assert_eq!(t.polar_rates(&t.mul(&z, &z), &|c| t.parts(c)), None);
    }
}
