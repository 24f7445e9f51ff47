//! Coefficients as text and as LaTeX.
//!
//! # Layout
//!
//! A value is printed as a sum of terms, a term as a rational number times named factors:
//!
//! ```text
//! 1 - 2*ln(2)        -2*ln(2)^2 + 1/12*pi^2 - 4/3*ln(2)^3 + 1/6*pi^2*ln(2) - 1/2*zeta(3)
//! ```
//!
//! Terms stand in the order of increasing weight (so that 1 - 2 ln 2 reads as in a book and a
//! long constant reads like a series), within a weight by increasing degree in the parameters,
//! then with the higher power of the first symbol first: mu_1^3, mu_1 mu_2, mu_3. The rational
//! number is a prefix and 1 is left out. Logarithms come last in a term: in LaTeX `\ln 2\,\pi`
//! would read as ln(2 pi). A sum that is a factor of something stands in parentheses, a single
//! term never does, and its sign moves to the sum that it belongs to.
//!
//! Text is read back by any computer algebra system that knows `*`, `/`, `^`, `ln`, `zeta`.

use crate::polynomial::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use crate::sparse::sort_by_rank;
use lindstedt_algebra::{Rationals, Ring};
pub use lindstedt_equation::print::{Style, latex_name, parenthesize, print_rational};
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::digits::decimal;
use rug::{Integer, Rational};
use rustc_hash::FxHashMap;
use std::cmp::{Ordering, Reverse};
use std::fmt::Write;

/// One term of a printed sum: a rational number times factors that are already written.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The rational number, with the sign of the term.
    pub coefficient: Rational,
    /// The factors in the order of printing.
    pub factors: Vec<String>,
}

impl Term {
    /// The term with more factors behind the present ones.
    #[must_use]
    pub fn times(mut self, factors: impl IntoIterator<Item = String>) -> Self {
        self.factors.extend(factors);
        self
    }

    /// A fraction in lowest terms, not zero, whose parts are nowhere put together: long ones are only written.
    #[must_use]
    pub fn of_fraction(numerator: &Integer, denominator: &Integer, style: Style) -> Self {
        let sign = if numerator.is_negative() { -1 } else { 1 };
        let magnitude = numerator.as_abs();
        let is_whole = *denominator == 1;
        let number = match style {
            _ if is_whole => magnitude.to_string(),
            Style::Text => format!("{}/{denominator}", *magnitude),
            Style::Latex => format!(r"\frac{{{}}}{{{denominator}}}", *magnitude),
        };
        let is_one = is_whole && *magnitude == 1;
        let factors = if is_one { Vec::new() } else { vec![number] };
        Self { coefficient: Rational::from(sign), factors }
    }

    /// Writes the term without its sign.
    fn write_magnitude(&self, style: Style, line: &mut String) {
        let number = Rational::from(self.coefficient.abs_ref());
        let shown = self.factors.is_empty() || number != 1;
        let number = shown.then(|| print_rational(&number, style));
        let factors = self.factors.iter().map(String::as_str);
        write_product(number.as_deref().into_iter().chain(factors), style, line);
    }
}

/// Writes factors side by side.
fn write_product<'a>(factors: impl Iterator<Item = &'a str>, style: Style, line: &mut String) {
    let mut factors = factors.peekable();
    let mut behind = false;
    while let Some(factor) = factors.next() {
        write_factor(factor, [behind, factors.peek().is_some()], style, line);
        behind = true;
    }
}

/// Writes a factor behind another one, before another one. In LaTeX a named function brings its own space, and a
/// logarithm that is not the last factor is put into parentheses, since \ln 2\cos t would read as ln(2 cos t).
fn write_factor(factor: &str, [behind, followed]: [bool; 2], style: Style, line: &mut String) {
    let latex = style == Style::Latex;
    let is_log = latex && factor.starts_with(r"\ln");
    let is_function = latex && [r"\cos", r"\sin", r"\sec"].iter().any(|f| factor.starts_with(f));
    if is_log && followed {
        line.push_str(&parenthesize(factor, style));
        return;
    }
    if behind && !is_log && !is_function {
        line.push_str(if latex { r"\," } else { "*" });
    }
    line.push_str(factor);
}

/// The terms as one line; the empty sum is `0`.
#[must_use]
pub fn print_sum(terms: &[Term], style: Style) -> String {
    let mut line = String::new();
    for (index, term) in terms.iter().enumerate() {
        line.push_str(match (index, term.coefficient.cmp0()) {
            (0, Ordering::Less) => "-",
            (0, _) => "",
            (_, Ordering::Less) => " - ",
            _ => " + ",
        });
        term.write_magnitude(style, &mut line);
    }
    if line.is_empty() { "0".to_owned() } else { line }
}

/// A ring whose elements can be printed; the phase algebras print over any of them.
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Ring};
/// use lindstedt_coeff::print::{Print, Style};
/// use lindstedt_coeff::{PolynomialRing, Symbol};
/// use rug::Rational;
///
/// let ring = PolynomialRing::default();
/// let twice = ring.scale(&ring.symbol(Symbol::LogTwo), &Rational::from(-2));
/// let alpha_1 = ring.add(&ring.one(), &twice);
/// assert_eq!(ring.print(&alpha_1, Style::Text), "1 - 2*ln(2)");
/// assert_eq!(ring.print(&alpha_1, Style::Latex), r"1 - 2\ln 2");
/// ```
pub trait Print: Ring {
    /// The terms of the printed sum in order; none for zero.
    fn print_terms(&self, a: &Self::Element, style: Style) -> Vec<Term>;

    /// The element as one line.
    fn print(&self, a: &Self::Element, style: Style) -> String {
        print_sum(&self.print_terms(a, style), style)
    }

    /// The element as a factor of a larger term: a single term is itself, a sum becomes one
    /// factor in parentheses.
    fn factor(&self, a: &Self::Element, style: Style) -> Term {
        let mut terms = self.print_terms(a, style);
        match terms.pop() {
            None => Term { coefficient: Rational::new(), factors: Vec::new() },
            Some(only) if terms.is_empty() => only,
            Some(last) => {
                terms.push(last);
                let sum = print_sum(&terms, style);
                Term { coefficient: Rational::from(1), factors: vec![parenthesize(&sum, style)] }
            }
        }
    }
}

impl Print for Rationals {
    fn print_terms(&self, a: &Rational, _: Style) -> Vec<Term> {
        if a.is_zero() {
            return Vec::new();
        }
        vec![Term { coefficient: a.clone(), factors: Vec::new() }]
    }
}

impl Print for PolynomialRing {
    fn print_terms(&self, a: &Polynomial, style: Style) -> Vec<Term> {
        let mut written = Powers::default();
        let print = |(monomial, coefficient): &(PowerProduct, Rational)| Term {
            coefficient: coefficient.clone(),
            factors: self.factors(monomial, style, &mut written),
        };
        in_order(a).into_iter().map(print).collect()
    }

    /// As [`print_sum`] writes its terms, of which there may be millions: none is built first.
    fn print(&self, a: &Polynomial, style: Style) -> String {
        let mut written = Powers::default();
        let mut line = String::new();
        for (monomial, coefficient) in in_order(a) {
            let negative = coefficient.cmp0() == Ordering::Less;
            line.push_str(match (line.is_empty(), negative) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            });
            let is_unit = *coefficient.denom() == 1 && *coefficient.numer().as_abs() == 1;
            let shown = monomial.factors().is_empty() || !is_unit;
            if shown {
                write_magnitude(coefficient, style, &mut line);
            }
            self.write_factors(monomial, shown, (style, &mut written), &mut line);
        }
        if line.is_empty() { "0".to_owned() } else { line }
    }
}

/// The terms of a polynomial in the order of printing.
fn in_order(a: &Polynomial) -> Vec<&(PowerProduct, Rational)> {
    let mut terms: Vec<_> = a.terms().iter().collect();
    sort_by_rank(
        &mut terms,
        |(m, _)| Some((weight_and_degree(m), m.rank(true)?)),
        |(m, _), (n, _)| {
            weight_and_degree(m).cmp(&weight_and_degree(n)).then_with(|| by_powers(m, n))
        },
    );
    terms
}

/// Weight and degree in the parameters.
fn weight_and_degree(monomial: &PowerProduct) -> (i64, i64) {
    let in_parameters = |&&(s, _): &&(Symbol, i16)| matches!(s, Symbol::Parameter(_));
    let degrees = monomial.factors().iter().filter(in_parameters).map(|&(_, e)| i64::from(e));
    (monomial.weight(), degrees.sum())
}

/// The higher power of the first differing symbol first (a symbol that does not occur sorts by the symbol that
/// stands in its place).
fn by_powers(left: &PowerProduct, right: &PowerProduct) -> Ordering {
    let key = |&(symbol, exponent): &(Symbol, i16)| (symbol, Reverse(exponent));
    left.factors().iter().map(key).cmp(right.factors().iter().map(key))
}

/// The powers of symbols that occurred, written, and whether each stands last.
type Powers = FxHashMap<(Symbol, i16), (bool, String)>;

impl PolynomialRing {
    /// The factors of a monomial: parameters, S_n, mu_m, pi, zeta(k), then the logarithms; in text as one
    /// factor.
    fn factors(&self, monomial: &PowerProduct, style: Style, written: &mut Powers) -> Vec<String> {
        if style == Style::Text {
            let mut line = String::new();
            self.write_factors(monomial, false, (style, written), &mut line);
            return if line.is_empty() { Vec::new() } else { vec![line] };
        }
        let power = |&(symbol, exponent): &(Symbol, i16)| {
            (self.stands_last(symbol), self.power_of(symbol, exponent, style))
        };
        let mut factors: Vec<_> = monomial.factors().iter().map(power).collect();
        factors.sort_by_key(|(last, _)| *last);
        factors.into_iter().map(|(_, power)| power).collect()
    }

    /// Writes the factors, every power of a symbol once, `behind` a number or none.
    fn write_factors(
        &self,
        monomial: &PowerProduct,
        mut behind: bool,
        (style, written): (Style, &mut Powers),
        line: &mut String,
    ) {
        let mut left = monomial.factors().len();
        for logarithms in [false, true] {
            if left == 0 {
                break;
            }
            for &(symbol, exponent) in monomial.factors() {
                let (last, power) = written.entry((symbol, exponent)).or_insert_with(|| {
                    (self.stands_last(symbol), self.power_of(symbol, exponent, style))
                });
                if *last == logarithms {
                    left -= 1;
                    write_factor(power, [behind, left > 0], style, line);
                    behind = true;
                }
            }
        }
    }

    fn stands_last(&self, symbol: Symbol) -> bool {
        symbol == Symbol::LogTwo || self.name(symbol, Style::Text).starts_with("ln(")
    }

    /// The name of a symbol; a parameter without a name is `parameter_n`.
    fn name(&self, symbol: Symbol, style: Style) -> String {
        let latex = style == Style::Latex;
        match symbol {
            Symbol::Parameter(index) => {
                let name = self.parameters.get(usize::from(index)).cloned();
                let name = name.unwrap_or_else(|| format!("parameter_{index}"));
                if latex { latex_name(&name) } else { name }
            }
            Symbol::Sum(n) if latex => latex_name(&format!("S_{n}")),
            Symbol::Moment(m) if latex => latex_name(&format!("mu_{m}")),
            Symbol::LogTwo if latex => r"\ln 2".to_owned(),
            Symbol::Pi if latex => r"\pi".to_owned(),
            Symbol::Zeta(k) if latex => format!(r"\zeta({k})"),
            Symbol::Sum(n) => format!("S_{n}"),
            Symbol::Moment(m) => format!("mu_{m}"),
            Symbol::LogTwo => "ln(2)".to_owned(),
            Symbol::Pi => "pi".to_owned(),
            Symbol::Zeta(k) => format!("zeta({k})"),
        }
    }

    fn power_of(&self, symbol: Symbol, exponent: i16, style: Style) -> String {
        let name = self.name(symbol, style);
        power(&name, exponent.into(), style)
    }
}

/// base^exponent for a base that is a name or a function value: `S_0^(-2)`, `\ln^{2} 2`.
#[must_use]
pub fn power(base: &str, exponent: i64, style: Style) -> String {
    match (style, exponent, base.strip_prefix(r"\ln")) {
        (_, 1, _) => base.to_owned(),
        (Style::Text, 0.., _) => format!("{base}^{exponent}"),
        (Style::Text, ..) => format!("{base}^({exponent})"),
        (Style::Latex, 0.., Some(argument)) => format!(r"\ln^{{{exponent}}}{argument}"),
        (Style::Latex, _, Some(_)) => format!("({base})^{{{exponent}}}"),
        (Style::Latex, ..) => format!("{base}^{{{exponent}}}"),
    }
}

/// [`print_rational`] of the absolute value.
fn write_magnitude(q: &Rational, style: Style, line: &mut String) {
    let (Some(n), Some(d)) = (q.numer().to_i64(), q.denom().to_u64()) else {
        line.push_str(print_rational(q, style).trim_start_matches('-'));
        return;
    };
    let n = n.unsigned_abs();
    // A string takes what is written.
    let _ = match style {
        _ if d == 1 => write!(line, "{n}"),
        Style::Text => write!(line, "{n}/{d}"),
        Style::Latex => write!(line, r"\frac{{{n}}}{{{d}}}"),
    };
}

/// Digits of a printed enclosure; the numbers of a result are printed with their errors instead.
const PRINTED_DIGITS: usize = 17;

impl Print for BallRing {
    /// The midpoint, as far as it is known; `[0]` for an enclosure of zero.
    fn print_terms(&self, a: &Enclosure, _: Style) -> Vec<Term> {
        if self.is_zero(a) {
            return Vec::new();
        }
        let known = a.0.relative_accuracy_bits().max(0) as f64 * std::f64::consts::LOG10_2;
        let digits = (known as usize).clamp(1, PRINTED_DIGITS);
        let shown = decimal(&a.0, digits).unwrap_or_else(|| "[0]".to_owned());
        let (sign, magnitude) = match shown.strip_prefix('-') {
            Some(rest) => (-1, rest.to_owned()),
            None => (1, shown),
        };
        vec![Term { coefficient: Rational::from(sign), factors: vec![magnitude] }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::RationalAlgebra;

    /// numerator, denominator, factors.
    type Parts = (i64, i64, &'static [(Symbol, i16)]);

    fn sum(ring: &PolynomialRing, terms: &[Parts]) -> Polynomial {
        let mut sum = ring.zero();
        for (numerator, denominator, factors) in terms {
            let mut term = ring.rational(&Rational::from((*numerator, *denominator)));
            for &(symbol, exponent) in *factors {
                term = ring.mul(&term, &ring.power(symbol, exponent));
            }
            ring.add_assign(&mut sum, &term);
        }
        sum
    }

    #[test]
    fn closed_form_of_alpha_3() {
        use Symbol::{LogTwo, Pi, Zeta};
        let ring = PolynomialRing::default();
        let terms: [Parts; 5] = [
            (-1, 2, &[(Zeta(3), 1)]),
            (1, 6, &[(LogTwo, 1), (Pi, 2)]),
            (-4, 3, &[(LogTwo, 3)]),
            (1, 12, &[(Pi, 2)]),
            (-2, 1, &[(LogTwo, 2)]),
        ];
        let alpha = sum(&ring, &terms);
        let text = "-2*ln(2)^2 + 1/12*pi^2 - 4/3*ln(2)^3 + 1/6*pi^2*ln(2) - 1/2*zeta(3)";
        assert_eq!(ring.print(&alpha, Style::Text), text);
        let latex = r"-2\ln^{2} 2 + \frac{1}{12}\,\pi^{2} - \frac{4}{3}\ln^{3} 2 + \frac{1}{6}\,\pi^{2}\ln 2 - \frac{1}{2}\,\zeta(3)";
        assert_eq!(ring.print(&alpha, Style::Latex), latex);
    }

    #[test]
    fn moments_and_laurent_exponents() {
        use Symbol::{Moment, Sum};
        let ring = PolynomialRing::default();
        let terms: [Parts; 4] = [
            (1, 1, &[]),
            (-2, 1, &[(Sum(0), -2)]),
            (3, 8, &[(Moment(1), 2)]),
            (-5, 1, &[(Moment(1), 1), (Moment(2), 1)]),
        ];
        let p = sum(&ring, &terms);
        let text = "1 - 2*S_0^(-2) + 3/8*mu_1^2 - 5*mu_1*mu_2";
        assert_eq!(ring.print(&p, Style::Text), text);
        let latex = r"1 - 2\,S_0^{-2} + \frac{3}{8}\,\mu_1^{2} - 5\,\mu_1\,\mu_2";
        assert_eq!(ring.print(&p, Style::Latex), latex);
    }

    #[test]
    fn parameters_by_degree_and_logarithms_last() {
        use Symbol::{LogTwo, Parameter};
        let ring = PolynomialRing { parameters: vec!["ln(a)".into(), "omega".into()] };
        let terms: [Parts; 3] = [
            (1, 1, &[(Parameter(0), 2), (Parameter(1), 1)]),
            (-1, 1, &[(Parameter(1), 1)]),
            (1, 1, &[(Parameter(0), 1), (LogTwo, 1)]),
        ];
        let p = sum(&ring, &terms);
        assert_eq!(ring.print(&p, Style::Text), "-omega + omega*ln(a)^2 + ln(a)*ln(2)");
        let latex = r"-\omega + \omega\ln^{2} a + (\ln a)\ln 2";
        assert_eq!(ring.print(&p, Style::Latex), latex);
        let unnamed = ring.symbol(Parameter(2));
        assert_eq!(ring.print(&unnamed, Style::Text), "parameter_2");
    }

    #[test]
    fn factors_take_parentheses_only_around_sums() {
        let ring = PolynomialRing::default();
        let (one, mu) = (ring.one(), ring.symbol(Symbol::Moment(1)));
        let half = ring.scale(&mu, &Rational::from((-1, 2)));
        let shown = |p: &Polynomial, style| {
            print_sum(&[ring.factor(p, style).times(["x".to_owned()])], style)
        };
        assert_eq!(shown(&half, Style::Text), "-1/2*mu_1*x");
        assert_eq!(shown(&one, Style::Text), "x");
        assert_eq!(shown(&ring.add(&one, &half), Style::Text), "(1 - 1/2*mu_1)*x");
        let latex = r"\left(1 - \frac{1}{2}\,\mu_1\right)\,x";
        assert_eq!(shown(&ring.add(&one, &half), Style::Latex), latex);
        assert_eq!(ring.print(&ring.zero(), Style::Text), "0");
    }

    #[test]
    fn rationals_and_names() {
        let q = Rational::from((-3, 8));
        assert_eq!(Rationals.print(&q, Style::Text), "-3/8");
        assert_eq!(print_rational(&q, Style::Latex), r"-\frac{3}{8}");
        assert_eq!(Rationals.print(&Rational::from(5), Style::Latex), "5");
        assert_eq!(Rationals.print(&Rational::new(), Style::Text), "0");
        let names =
            ["mu_12", "R_in", "omega0", "eps", "S_1", "ln(eta)", "ln(a+b)", "a", "sin(alpha*T)"];
        let latex = [
            r"\mu_{12}", r"R_{\mathrm{in}}", r"\omega_0", r"\varepsilon", "S_1", r"\ln\eta",
            r"\ln(a+b)", "a", r"\sin(\alpha\,T)",
        ];
        assert_eq!(names.map(latex_name), latex);
    }
}
