//! Functions on a half turn as text and as LaTeX: `1 - cos(psi) - 2*pi^(-1)*sin(psi) + 2*pi^(-1)*psi*cos(psi)`.

use super::HalfTurn;
use lindstedt_algebra::Rationals;
use lindstedt_coeff::print::{Print, Style, Term, latex_name, power, print_sum};
use lindstedt_coeff::sparse::Monomial;
use lindstedt_coeff::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use rug::Rational;
use std::collections::BTreeMap;

/// Terms with the constants they have, in any order.
type Terms = Vec<(PowerProduct, Rational)>;

impl HalfTurn {
    /// The coefficients of the powers of a of a function that does not depend on the phase.
    pub fn by_powers_of_amplitude(&self) -> Vec<(i32, Polynomial)> {
        let mut powers: BTreeMap<i32, Terms> = BTreeMap::new();
        for (m, [re, _]) in self.terms().filter(|(m, _)| m.phase == 0 && m.harmonic == 0) {
            powers.entry(m.amplitude).or_default().push((m.constants.clone(), re.clone()));
        }
        powers.into_iter().map(|(n, terms)| (n, Polynomial::collect(&Rationals, terms))).collect()
    }

    /// The function as one line, with the names of the parameters; the powers of psi increase, then the
    /// harmonics, cosine before sine.
    pub fn print(&self, parameters: &[String], style: Style) -> String {
        // The amplitude is one more symbol of the coefficients.
        let names = parameters.iter().cloned().chain(["a".to_owned()]).collect();
        let ring = PolynomialRing { parameters: names };
        let a = Symbol::Parameter(u16::try_from(parameters.len()).unwrap_or(u16::MAX));
        let mut waves: BTreeMap<(u32, i32, bool), Terms> = BTreeMap::new();
        // c e^{ik psi} and its conjugate are 2 Re c cos k psi - 2 Im c sin k psi.
        for (m, [re, im]) in self.terms().filter(|(m, _)| m.harmonic >= 0) {
            let twice =
                |q: &Rational, n: i32| Rational::from(if m.harmonic > 0 { n } else { 1 }) * q;
            let n = i16::try_from(m.amplitude).unwrap_or(i16::MAX);
            let constants = m.constants.times(&PowerProduct::power(a, n));
            for (sine, q) in [(false, twice(re, 2)), (true, twice(im, -2))] {
                let key = (m.phase, m.harmonic, sine);
                waves.entry(key).or_default().push((constants.clone(), q));
            }
        }
        let mut sum: Vec<Term> = Vec::new();
        for ((phase, harmonic, sine), terms) in waves {
            let coefficient = Polynomial::collect(&Rationals, terms);
            if coefficient.is_zero() {
                continue;
            }
            let names = factors(phase, harmonic, sine, style);
            match names.is_empty() {
                true => sum.extend(ring.print_terms(&coefficient, style)),
                false => sum.push(ring.factor(&coefficient, style).times(names)),
            }
        }
        print_sum(&sum, style)
    }
}

/// psi^phase and cos(harmonic psi) or its sine, without what is 1.
fn factors(phase: u32, harmonic: i32, sine: bool, style: Style) -> Vec<String> {
    let (psi, backslash) = match style {
        Style::Text => ("psi".to_owned(), ""),
        Style::Latex => (latex_name("psi"), r"\"),
    };
    let raised = (phase > 0).then(|| power(&psi, phase.into(), style));
    let times = if style == Style::Text { "*" } else { r"\," };
    let angle = if harmonic == 1 { psi } else { format!("{harmonic}{times}{psi}") };
    let function = if sine { "sin" } else { "cos" };
    let wave = (harmonic > 0).then(|| format!("{backslash}{function}({angle})"));
    raised.into_iter().chain(wave).collect()
}
