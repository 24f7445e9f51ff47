//! Functions of the phase as text and as LaTeX, over any printable ring of constants.
//!
//! ```text
//! 3/8*cos(tau) - 1/32*cos(3*tau)
//! cos(tau)*(-l + 1/2*l^2 - 1/2*Lambda_1^2) + sin(tau)*(-2*Lambda_1 + Lambda_2)
//! ```
//!
//! Harmonics increase, cosine before sine. In the Lobachevsky ring the blocks stand in the order
//! of the total degree in cos and sin, sec(t)^3 before sin(t), and inside a block the terms in
//! the order of their weight; a block with one term is that term. In LaTeX the trigonometric
//! factors stand behind the others (`\ell\cos\tau`), where nothing can be read as their argument.

use crate::Lobachevsky;
use crate::lobachevsky::{Factor, LobachevskyElement, Word};
use crate::trigonometric::{Trigonometric, TrigonometricPolynomial, harmonics};
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra};
use lindstedt_coeff::print::{Print, Style, Term, latex_name, parenthesize, power, print_sum};
use rug::Rational;
use std::fmt::Write;

/// A phase algebra whose elements can be printed.
pub trait PrintPhase: PhaseAlgebra<Constants: Print> {
    /// The terms of the printed sum in order, for a phase of the given name; none for zero.
    fn print_terms(&self, f: &Self::Element, phase: &str, style: Style) -> Vec<Term>;

    /// The function as one line, for a phase variable with the given name (`tau`, `psi`, `t`; a
    /// name of Greek letters becomes the letter in LaTeX).
    ///
    /// ```
    /// use lindstedt_algebra::{PhaseAlgebra, Rationals};
    /// use lindstedt_coeff::print::Style;
    /// use lindstedt_phase::Trigonometric;
    /// use lindstedt_phase::print::PrintPhase;
    /// use rug::Rational;
    ///
    /// let algebra = Trigonometric::new(Rationals);
    /// let f = algebra.cos(3, Rational::from((-1, 32)));
    /// assert_eq!(algebra.print(&f, "tau", Style::Text), "-1/32*cos(3*tau)");
    /// assert_eq!(algebra.print(&f, "tau", Style::Latex), r"-\frac{1}{32}\cos 3\tau");
    /// ```
    fn print(&self, f: &Self::Element, phase: &str, style: Style) -> String {
        print_sum(&self.print_terms(f, phase, style), style)
    }
}

impl<C: RationalAlgebra + Print> PrintPhase for Trigonometric<C> {
    fn print_terms(
        &self,
        f: &TrigonometricPolynomial<C::Element>,
        phase: &str,
        style: Style,
    ) -> Vec<Term> {
        let constants = self.constants();
        let mut terms = Vec::new();
        for (k, (c, s)) in harmonics(constants, f) {
            if k == 0 {
                terms.extend(constants.print_terms(&c, style));
                continue;
            }
            for (coefficient, function) in [(c, "cos"), (s, "sin")] {
                if !constants.is_zero(&coefficient) {
                    let factor = constants.factor(&coefficient, style);
                    terms.push(times_harmonic(factor, function, k, phase, style));
                }
            }
        }
        terms
    }
}

/// A term times cos or sin of a multiple of the phase; cos 0 is not written.
#[must_use]
pub fn times_harmonic(term: Term, function: &str, k: usize, phase: &str, style: Style) -> Term {
    if k == 0 { term } else { term.times([function_value(function, 1, k, phase, style)]) }
}

impl<C: RationalAlgebra + Print> PrintPhase for Lobachevsky<C> {
    fn print_terms(
        &self,
        f: &LobachevskyElement<C::Element>,
        phase: &str,
        style: Style,
    ) -> Vec<Term> {
        let mut blocks: Vec<_> = f.blocks().iter().collect();
        blocks.sort_by_key(|(factor, _)| (factor.power + i32::from(factor.sine), factor.sine));
        let mut terms = Vec::new();
        for (&factor, polynomial) in blocks {
            let outer = trigonometric_factors(factor, phase, style);
            let mut inner: Vec<(Term, Vec<String>)> = Vec::new();
            for (word, c) in polynomial.terms() {
                inner.push((self.constants().factor(c, style), word_factors(word, style)));
            }
            match inner.as_slice() {
                // A constant that is a sum needs no parentheses where nothing multiplies it.
                [(_, word)] if word.is_empty() && outer.is_empty() => {
                    for (_, c) in polynomial.terms() {
                        terms.extend(self.constants().print_terms(c, style));
                    }
                }
                [(constant, word)] => {
                    terms.push(combine(constant.clone(), word.clone(), outer, style))
                }
                _ if outer.is_empty() => {
                    terms.extend(inner.into_iter().map(|(constant, word)| constant.times(word)));
                }
                _ => {
                    let sum: Vec<Term> =
                        inner.into_iter().map(|(constant, word)| constant.times(word)).collect();
                    let sum = parenthesize(&print_sum(&sum, style), style);
                    let one = Term { coefficient: Rational::from(1), factors: Vec::new() };
                    terms.push(combine(one, vec![sum], outer, style));
                }
            }
        }
        terms
    }
}

/// constant * outer * inner in text, constant * inner * outer in LaTeX.
fn combine(constant: Term, inner: Vec<String>, outer: Vec<String>, style: Style) -> Term {
    match style {
        Style::Text => constant.times(outer).times(inner),
        Style::Latex => constant.times(inner).times(outer),
    }
}

/// cos^power (sec^-power for negative ones), and sin.
fn trigonometric_factors(factor: Factor, phase: &str, style: Style) -> Vec<String> {
    let mut factors = Vec::new();
    if factor.power != 0 {
        let function = if factor.power > 0 { "cos" } else { "sec" };
        factors.push(function_value(function, factor.power.unsigned_abs(), 1, phase, style));
    }
    if factor.sine {
        factors.push(function_value("sin", 1, 1, phase, style));
    }
    factors
}

/// l and Lambda_m with their exponents, as one factor: solutions have millions of them.
fn word_factors(word: &Word, style: Style) -> Vec<String> {
    let mut line = String::new();
    for (index, &exponent) in word.exponents().iter().enumerate().filter(|(_, e)| **e > 0) {
        let times = if style == Style::Text { "*" } else { r"\," };
        line.push_str(if line.is_empty() { "" } else { times });
        // Writing to a string cannot fail.
        let _ = match (index, style) {
            (0, Style::Text) => write!(line, "l"),
            (0, Style::Latex) => write!(line, r"\ell"),
            (m, Style::Text) => write!(line, "Lambda_{m}"),
            (m, Style::Latex) => write!(line, "{}", latex_name(&format!("Lambda_{m}"))),
        };
        let _ = match (exponent, style) {
            (1, _) => Ok(()),
            (_, Style::Text) => write!(line, "^{exponent}"),
            (_, Style::Latex) => write!(line, "^{{{exponent}}}"),
        };
    }
    if line.is_empty() { Vec::new() } else { vec![line] }
}

/// function(harmonic * phase)^exponent: `cos(3*tau)^2`, `\cos^{2} 3\tau`.
fn function_value(
    function: &str,
    exponent: u32,
    harmonic: usize,
    phase: &str,
    style: Style,
) -> String {
    let simple = phase.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let name = match style {
        Style::Text => phase.to_owned(),
        Style::Latex => latex_name(phase),
    };
    let argument = match (harmonic, simple, style) {
        (1, ..) => name,
        (_, true, Style::Text) => format!("{harmonic}*{name}"),
        (_, false, Style::Text) => format!("{harmonic}*({name})"),
        (_, true, Style::Latex) => format!("{harmonic}{name}"),
        (_, false, Style::Latex) => format!("{harmonic}({name})"),
    };
    if style == Style::Text {
        return power(&format!("{function}({argument})"), exponent.into(), style);
    }
    let function = power(&format!(r"\{function}"), exponent.into(), style);
    match (simple, argument.starts_with('\\')) {
        (false, _) => format!("{function}({argument})"),
        (true, true) => format!("{function}{argument}"),
        (true, false) => format!("{function} {argument}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::{Rationals, Ring};
    use lindstedt_coeff::sparse::Monomial;
    use lindstedt_coeff::{PolynomialRing, Symbol};

    fn q(n: i64, d: i64) -> Rational {
        Rational::from((n, d))
    }

    #[test]
    fn trigonometric_polynomials() {
        let a = Trigonometric::new(Rationals);
        let f = a.add(&a.cos(1, q(3, 8)), &a.add(&a.sin(1, q(-1, 1)), &a.cos(3, q(-1, 32))));
        let text = "3/8*cos(t) - sin(t) - 1/32*cos(3*t)";
        assert_eq!(a.print(&f, "t", Style::Text), text);
        let latex = r"\frac{3}{8}\cos\psi - \sin\psi - \frac{1}{32}\cos 3\psi";
        assert_eq!(a.print(&f, "psi", Style::Latex), latex);
        let text = "3/8*cos(w*t) - sin(w*t) - 1/32*cos(3*(w*t))";
        assert_eq!(a.print(&f, "w*t", Style::Text), text);
        assert_eq!(a.print(&a.zero(), "t", Style::Text), "0");
    }

    #[test]
    fn coefficients_that_are_sums_take_parentheses() {
        let ring = PolynomialRing { parameters: vec!["a".into()] };
        let sum = ring.sub(&ring.one(), &ring.symbol(Symbol::LogTwo));
        let a = Trigonometric::new(ring.clone());
        let amplitude = ring.power(Symbol::Parameter(0), 3);
        let f = a.add(&a.cos(0, sum.clone()), &a.add(&a.cos(2, sum), &a.sin(2, amplitude)));
        let text = "1 - ln(2) + (1 - ln(2))*cos(2*t) + a^3*sin(2*t)";
        assert_eq!(a.print(&f, "t", Style::Text), text);
        let ln_cos = a.cos(1, ring.symbol(Symbol::LogTwo));
        assert_eq!(a.print(&ln_cos, "t", Style::Latex), r"(\ln 2)\cos t");
    }

    /// x_2 of the power law.
    #[test]
    fn second_correction_of_the_power_law() {
        let a = Lobachevsky::new(PolynomialRing::default());
        let term =
            |power, sine, word, n, d| a.term(power, sine, word, a.constants().rational(&q(n, d)));
        let square = |word: Word| word.times(&word);
        let mut x2 = a.zero();
        for t in [
            term(1, false, Word::log(1), -1, 1),
            term(1, false, Word::log(2), 1, 2),
            term(1, false, square(Word::lambda(1)), -1, 2),
            term(0, true, Word::lambda(1), -2, 1),
            term(0, true, Word::lambda(2), 1, 1),
        ] {
            a.add_assign(&mut x2, &t);
        }
        let text = "cos(t)*(-l + 1/2*l^2 - 1/2*Lambda_1^2) + sin(t)*(-2*Lambda_1 + Lambda_2)";
        assert_eq!(a.print(&x2, "t", Style::Text), text);
        let latex = r"\left(-\ell + \frac{1}{2}\,\ell^{2} - \frac{1}{2}\,\Lambda_1^{2}\right)\cos\tau + (-2\,\Lambda_1 + \Lambda_2)\sin\tau";
        assert_eq!(a.print(&x2, "tau", Style::Latex), latex);
    }

    #[test]
    fn blocks_by_degree_with_secants() {
        let a = Lobachevsky::new(PolynomialRing::default());
        let ring = a.constants();
        let c = ring.sub(&ring.one(), &ring.symbol(Symbol::Moment(1)));
        let mut f = a.term(-3, false, Word::unit(), c.clone());
        for t in [
            a.term(0, false, Word::unit(), c),
            a.term(2, true, Word::log(1), ring.rational(&q(-1, 2))),
            a.term(-1, true, Word::lambda(2), ring.one()),
        ] {
            a.add_assign(&mut f, &t);
        }
        let text =
            "(1 - mu_1)*sec(t)^3 + 1 - mu_1 + sec(t)*sin(t)*Lambda_2 - 1/2*cos(t)^2*sin(t)*l";
        assert_eq!(a.print(&f, "t", Style::Text), text);
        let latex = r"(1 - \mu_1)\sec^{3} t + 1 - \mu_1 + \Lambda_2\sec t\sin t - \frac{1}{2}\,\ell\cos^{2} t\sin t";
        assert_eq!(a.print(&f, "t", Style::Latex), latex);
    }
}
