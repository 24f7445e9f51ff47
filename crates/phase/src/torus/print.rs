//! Functions of two phases as text and as LaTeX: `a*cos(psi) - 1/32*a^3*cos(3*psi) + p*cos(eta)`.

use super::{Harmonic, Torus, TorusElement};
use lindstedt_algebra::{FunctionAlgebra, RationalAlgebra, Ring, combination};
use lindstedt_coeff::print::{Print, Style, Term, latex_name, print_sum};

impl<K: RationalAlgebra + Print> Torus<K> {
    /// The function as one line, with the phases psi and eta; harmonics increase, those of the
    /// force alone first, cosine before sine.
    pub fn print(&self, f: &TorusElement<K::Element>, style: Style) -> String {
        let ring = self.constants();
        let mut terms: Vec<Term> = Vec::new();
        for (&harmonic, amplitudes) in f.harmonics() {
            for (amplitude, function) in amplitudes.iter().zip(["cos", "sin"]) {
                if ring.is_zero(amplitude) {
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
    use super::*;
    use lindstedt_algebra::{AveragingAlgebra, Rationals};
    use rug::Rational;

    #[test]
    fn sums_and_angles() {
        let t = Torus::new(Rationals, Rational::from(1), Some(Rational::from(2)), Vec::new());
        let ring = t.constants();
        let a = |n, c: (i32, u32)| ring.power(n, Rational::from(c));
        let mixed = t.harmonic((2, -1), [ring.zero(), ring.add(&a(1, (1, 2)), &a(3, (-1, 4)))]);
        let mean = t.embed(&a(2, (-3, 2)));
        let f = t.add(&t.add(&t.generating_solution(), &mixed), &mean);
        let text = "-3/2*a^2 + a*cos(psi) + (1/2*a - 1/4*a^3)*sin(2*psi - eta)";
        assert_eq!(t.print(&f, Style::Text), text);
        let wave = t.harmonic((0, 3), [ring.one(), ring.zero()]);
        assert_eq!(t.print(&wave, Style::Latex), r"\cos(3\,\eta)");
        assert_eq!(t.print(&t.zero(), Style::Text), "0");
    }
}
