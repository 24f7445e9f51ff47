//! Functions of one amplitude and its phase as they are printed: with z = (a/2) e^{i psi} a real polynomial is
//!
//!   f = sum_(k,m) ( c_(k,m) cos(k psi + m eta) + s_(k,m) sin(k psi + m eta) ),   k > 0, or k = 0 and m >= 0,
//!
//! with polynomials in a as c and s, and a slow flow z' = i nu z + z h(z zbar) is a' = a Re h, psi' = nu + Im h.

use super::{AmplitudeElement, Amplitudes, Scalars};
use lindstedt_algebra::{RationalAlgebra, combination};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials, AmplitudePower};
use lindstedt_coeff::print::{Print, Style, Term, latex_name, print_sum};
use rug::Integer;
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

impl<S: Scalars> Amplitudes<S> {
    /// A real f of one unknown and one force (or none), without symbols.
    pub fn polar(&self, f: &AmplitudeElement<S::Element>) -> Polar<S::Number> {
        let mut harmonics: BTreeMap<Harmonic, [Powers<S::Number>; 2]> = BTreeMap::new();
        for (word, [re, im]) in &f.terms {
            let [p, q, m, ..] = self.layout.exponents(*word, self.phases()).0;
            let harmonic = (p - q, m);
            if harmonic < (0, 0) {
                continue;
            }
            // c z^p zbar^q E^m and its conjugate are 2 Re(c e^{i ...}) (a/2)^(p + q).
            let halvings = p + q - i32::from(harmonic > (0, 0));
            let entry = harmonics.entry(harmonic).or_default();
            let power = AmplitudePower(p + q);
            for (list, part) in entry.iter_mut().zip([re.clone(), self.scalars.neg(im)]) {
                if !self.scalars.is_zero(&part) {
                    list.push((power, self.halved(&part, &f.denominator, halvings)));
                }
            }
        }
        let harmonics = harmonics.into_iter().map(|(k, lists)| (k, lists.map(collected)));
        Polar { harmonics: harmonics.collect() }
    }

    /// a Re h and Im h of f = z h(z zbar), of one unknown; nothing where f is not of that form.
    pub fn polar_rates(
        &self,
        f: &AmplitudeElement<S::Element>,
    ) -> Option<[AmplitudePolynomial<S::Number>; 2]> {
        let mut rates = [Powers::new(), Powers::new()];
        for (word, parts) in &f.terms {
            let (digits, rest) = self.layout.exponents(*word, self.phases());
            let [p, q, ..] = digits;
            if p - q != 1 || rest != 0 || digits[2..].iter().any(|m| *m != 0) {
                return None;
            }
            for ((list, part), power) in rates.iter_mut().zip(parts).zip([p + q, p + q - 1]) {
                if !self.scalars.is_zero(part) {
                    let number = self.halved(part, &f.denominator, 2 * q);
                    list.push((AmplitudePower(power), number));
                }
            }
        }
        Some(rates.map(collected))
    }

    /// e/(2^n d).
    fn halved(&self, e: &S::Element, d: &Integer, n: i32) -> S::Number {
        match u32::try_from(n) {
            Ok(n) => self.scalars.number(e, &(d.clone() << n)),
            Err(_) => self.scalars.number(&self.scalars.times(e, &Integer::from(2)), d),
        }
    }
}

/// The polynomial of powers that are different.
fn collected<N: Clone + PartialEq + Debug + Send + Sync>(
    mut powers: Powers<N>,
) -> AmplitudePolynomial<N> {
    powers.sort_by_key(|(power, _)| *power);
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
        let Some((_, sin)) = t.forcing(1) else { panic!("a force") };
        // z^2 + zbar^2 = a^2/2 cos(2 psi).
        let square = t.mul(&z, &t.conjugate(&z));
        let mixed = t.mul(&t.twice_real(&t.mul(&z, &z)), &sin);
        let f = t.add(&t.add(&t.scale(&square, &Rational::from(-6)), &t.twice_real(&z)), &mixed);
        let text = "-3/2*a^2 + a*cos(psi) - 1/4*a^2*sin(2*psi - eta) + 1/4*a^2*sin(2*psi + eta)";
        assert_eq!(t.polar(&f).print(&ring, Style::Text), text);
        let Some((wave, _)) = t.forcing(3) else { panic!("a force") };
        assert_eq!(t.polar(&wave).print(&ring, Style::Latex), r"\cos(3\,\eta)");
        assert_eq!(t.polar(&t.zero()).print(&ring, Style::Text), "0");
        // (1 + 4 i |z|^2) z: i z is the rate of z.
        let turn = t.scale(&t.mul(&square, &t.by_time(&z)), &Rational::from(4));
        let shown = t.polar_rates(&t.add(&z, &turn));
        let shown = shown.map(|rates| rates.map(|r| ring.print(&r, Style::Text)));
        assert_eq!(shown, Some(["a".to_owned(), "a^2".to_owned()]));
        assert_eq!(t.polar_rates(&t.mul(&z, &z)), None);
    }
}
