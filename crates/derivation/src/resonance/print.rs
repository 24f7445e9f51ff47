//! Slow flows as text and as LaTeX: `-1/4*i*F*E + (1/2*i*s - mu)*z + 3/2*i*al*z^2*zbar`.

use super::{Enclosed, PolarTerm, SlowFlow, Terms};
use lindstedt_coeff::print::{Style, Term, latex_name, parenthesize, power, print_sum};
use lindstedt_number::ball::Balls;
use lindstedt_number::digits::{decimal, error_string};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// What a number of which no digit is known begins with: its bound follows.
const UNKNOWN: &str = "0 +- ";

/// Whether a number in the middle of an enclosure is exact: no other is so short.
pub(super) fn is_short(q: &Rational) -> bool {
    q.numer().significant_bits() <= 32 && q.denom().significant_bits() <= 32
}

/// A name of a factor or an unknown: in LaTeX z_1, \bar z_1, \mu.
#[must_use]
pub fn print_name(name: &str, style: Style) -> String {
    match (style, name.strip_prefix("zbar")) {
        (Style::Text, _) => name.to_owned(),
        // (1 - 2*omega): a sum of rates.
        (Style::Latex, None) if name.starts_with('(') => {
            let inner = name.trim_matches(['(', ')']).split(' ');
            let product = |word: &str| -> String {
                word.split('*').map(latex_name).collect::<Vec<_>>().join(r"\,")
            };
            format!("({})", inner.map(product).collect::<Vec<_>>().join(" "))
        }
        (Style::Latex, Some(index)) => format!(r"\bar z{index}"),
        (Style::Latex, None) => latex_name(name),
    }
}

/// sum small^n c_n, every c_n a sum of terms.
pub(super) fn print_powers(
    orders: &[Terms],
    small: &str,
    style: Style,
    terms_of: &dyn Fn(&Terms) -> Vec<Term>,
) -> String {
    let mut sum = Vec::new();
    for (n, terms) in (0i64..).zip(orders).filter(|(_, terms)| !terms.is_empty()) {
        let factor = (n > 0).then(|| power(small, n, style));
        sum.push(match <[Term; 1]>::try_from(terms_of(terms)) {
            Ok([single]) => single.times(factor),
            Err(list) => {
                let line = parenthesize(&print_sum(&list, style), style);
                Term { coefficient: Rational::from(1), factors: vec![line] }.times(factor)
            }
        });
    }
    print_sum(&sum, style)
}

/// Powers of named factors.
pub(super) fn factors(names: &[String], exponents: &[i32], style: Style) -> Vec<String> {
    let all = names.iter().zip(exponents).filter(|(_, n)| **n != 0);
    all.map(|(factor, n)| power(&print_name(factor, style), i64::from(*n), style)).collect()
}

/// n phase.
#[must_use]
pub fn print_turns(n: u32, phase: &str, style: Style) -> String {
    match (n, style) {
        (1, Style::Text) => phase.to_owned(),
        (1, Style::Latex) => latex_name(phase),
        (n, Style::Text) => format!("{n}*{phase}"),
        (n, Style::Latex) => format!("{n}{}", latex_name(phase)),
    }
}

impl Enclosed {
    /// A coefficient and the factor beside it: the sign and the decimal digits.
    pub(super) fn coefficient(&self, q: &Rational, style: Style) -> (Rational, Option<String>) {
        if is_short(q) {
            return (q.clone(), None);
        }
        let digits = self.number(&q.clone().abs());
        match digits.strip_prefix(UNKNOWN) {
            None => (Rational::from(q.cmp0() as i32), Some(digits)),
            // No sign is known.
            Some(radius) => {
                let text = match (style, radius.split_once('e')) {
                    (Style::Latex, Some((m, n))) => format!(r"(0 \pm {m}\cdot 10^{{{n}}})"),
                    _ => format!("({digits})"),
                };
                (Rational::from(1), Some(text))
            }
        }
    }

    /// A short number as it is, of others the digits that are certain.
    pub(super) fn number(&self, q: &Rational) -> String {
        if is_short(q) { q.to_string() } else { self.of_digits(q) }
    }

    fn of_digits(&self, q: &Rational) -> String {
        let Self { radius, digits, .. } = *self;
        let balls = Balls::new(u32::try_from(4 * digits).unwrap_or(u32::MAX / 4) + 64);
        let error = Float::with_val(64, radius);
        if q.is_zero() {
            return "0".to_owned();
        }
        let ball = balls.add_error(&balls.from_rational(q), &error);
        // log10(2) > 0.301.
        let known = usize::try_from(ball.relative_accuracy_bits().max(0)).unwrap_or(0) * 301 / 1000;
        let certain = [digits, known.min(digits), 1].into_iter().find_map(|n| decimal(&ball, n));
        certain.unwrap_or_else(|| format!("{UNKNOWN}{}", error_string(&ball, "0")))
    }
}

impl SlowFlow {
    /// The name of the small parameter.
    fn small(&self, style: Style) -> String {
        print_name(&self.problem.small, style)
    }

    /// A coefficient and the factor beside it: of enclosures the sign and the decimal digits.
    fn coefficient(&self, q: &Rational, style: Style) -> (Rational, Option<String>) {
        self.enclosed.map_or_else(|| (q.clone(), None), |it| it.coefficient(q, style))
    }

    /// A coefficient: a rational number as it is (of enclosures, a short one), else the digits that are certain, at most those asked
    /// for, or `0 +- 2.2e-55` where none is.
    #[must_use]
    pub fn number(&self, q: &Rational) -> String {
        self.enclosed.map_or_else(|| q.to_string(), |it| it.number(q))
    }

    /// nu_j^2 or an entry of the shapes: a rational number as it is, otherwise as [`Self::number`].
    #[must_use]
    pub fn number_of_modes(&self, q: &Rational) -> String {
        let enclosed = self.enclosed.filter(|_| self.system.algebraic.is_some() && *q != 1);
        enclosed.map_or_else(|| q.to_string(), |it| it.of_digits(q))
    }

    /// A polynomial in the amplitudes, its terms collected by amplitudes and phase.
    #[must_use]
    pub fn print(&self, terms: &[AmplitudeTerm], style: Style) -> String {
        let names = self.factors();
        let phases = self.first_symbol();
        let mut collected: BTreeMap<(i32, Vec<i32>), Vec<Term>> = BTreeMap::new();
        for term in terms {
            let (phase, symbols) = term.exponents.split_at(phases);
            let degree = phase[..2 * self.unknowns()].iter().sum();
            // Words that begin with z come first within a degree.
            let key = (degree, phase.iter().map(|e| -e).collect());
            let symbols = factors(&names[phases..], symbols, style);
            let list = collected.entry(key).or_default();
            for (coefficient, i) in [(&term.re, None), (&term.im, Some("i".to_owned()))] {
                if !coefficient.is_zero() {
                    let (coefficient, digits) = self.coefficient(coefficient, style);
                    let factors = digits.into_iter().chain(i).chain(symbols.clone()).collect();
                    list.push(Term { coefficient, factors });
                }
            }
        }
        let whole = |line| Term { coefficient: Rational::from(1), factors: vec![line] };
        let sum = collected.into_iter().map(|((_, phase), list)| {
            let phase: Vec<i32> = phase.iter().map(|e| -e).collect();
            let phase = factors(&names, &phase, style);
            match <[Term; 1]>::try_from(list) {
                Ok([single]) => single.times(phase),
                Err(list) if phase.is_empty() => whole(print_sum(&list, style)),
                Err(list) => whole(parenthesize(&print_sum(&list, style), style)).times(phase),
            }
        });
        print_sum(&sum.collect::<Vec<_>>(), style)
    }

    /// Omega_l.
    #[must_use]
    pub fn print_leading_rate(&self, l: usize, style: Style) -> String {
        print_sum(&self.leading_rate(l, style), style)
    }

    /// A multiple of the unit.
    #[must_use]
    pub fn print_multiple(&self, q: &Rational, style: Style) -> String {
        print_sum(&[self.multiple(q, style)], style)
    }

    fn multiple(&self, q: &Rational, style: Style) -> Term {
        let unit = self.system.unit.as_ref().map(|unit| print_name(&unit.name, style));
        let (coefficient, digits) = self.coefficient(q, style);
        Term { coefficient, factors: digits.into_iter().chain(unit).collect() }
    }

    fn leading_rate(&self, l: usize, style: Style) -> Vec<Term> {
        let rate = self.system.forces.get(l).map_or(&[][..], |phase| &phase.rate);
        let unit = self.system.unit.as_ref().map(|unit| &unit.name);
        let names = std::iter::once(unit).chain(self.system.independent.iter().map(Some));
        let term = |(q, name): (&Rational, Option<&String>)| {
            let (coefficient, digits) = self.coefficient(q, style);
            let name = name.map(|name| print_name(name, style));
            Term { coefficient, factors: digits.into_iter().chain(name).collect() }
        };
        rate.iter().zip(names).filter(|(q, _)| !q.is_zero()).map(term).collect()
    }

    /// eta_l' = Omega_l + eps sigma_{l,1} + ...
    #[must_use]
    pub fn print_force(&self, l: usize, style: Style) -> String {
        let count = self.first_symbol();
        let names = &self.factors()[count..];
        let mut sum = self.leading_rate(l, style);
        for (n, sigma) in self.detuning.get(l).into_iter().flatten().enumerate() {
            for term in sigma {
                let symbols = factors(names, &term.exponents[count..], style);
                let small = power(&self.small(style), n as i64 + 1, style);
                let term = Term { coefficient: term.re.clone(), factors: vec![small] };
                sum.push(term.times(symbols));
            }
        }
        print_sum(&sum, style)
    }

    /// eta_l(0); nothing where it is 0.
    #[must_use]
    pub fn print_start(&self, l: usize, style: Style) -> Option<String> {
        let start = &self.system.forces.get(l)?.start;
        let zero = start.as_number().is_some_and(|q| q.is_zero());
        (!zero).then(|| start.print(&self.problem.small, style))
    }

    /// The unknowns in terms of the modes; empty where they are the same.
    #[must_use]
    pub fn print_shapes(&self, style: Style) -> Vec<String> {
        let modes = self.coordinates();
        let row = |(i, row): (usize, &Vec<Rational>)| {
            let terms = row.iter().zip(&modes).filter(|(q, _)| !q.is_zero());
            let rational = self.system.algebraic.is_none();
            let term = |(q, mode): (&Rational, &String)| {
                let whole = rational || *q == 1;
                let (coefficient, digits) =
                    if whole { (q.clone(), None) } else { self.coefficient(q, style) };
                Term {
                    coefficient,
                    factors: digits.into_iter().chain([print_name(mode, style)]).collect(),
                }
            };
            let sum = print_sum(&terms.map(term).collect::<Vec<_>>(), style);
            format!("{} = {sum}", print_name(&self.problem.unknown(i), style))
        };
        self.system.shapes.iter().flatten().enumerate().map(row).collect()
    }

    /// sum eps^n (...) of a rate in polar form, from n = 1, with `leading` before it.
    #[must_use]
    pub fn print_rate(
        &self,
        leading: Option<Rational>,
        orders: &[Vec<PolarTerm>],
        style: Style,
    ) -> String {
        let first = leading.map(|q| self.multiple(&q, style).times(["a".to_owned()]));
        let mut sum: Vec<Term> = first.into_iter().collect();
        for (n, terms) in orders.iter().enumerate().filter(|(_, terms)| !terms.is_empty()) {
            let terms: Vec<Term> = terms.iter().map(|term| self.wave(term, style)).collect();
            let line = parenthesize(&print_sum(&terms, style), style);
            let factor = power(&self.small(style), n as i64 + 1, style);
            sum.push(Term { coefficient: Rational::from(1), factors: vec![factor, line] });
        }
        print_sum(&sum, style)
    }

    fn wave(&self, term: &PolarTerm, style: Style) -> Term {
        let mut all = factors(&self.system.symbols, &term.symbols, style);
        if term.power > 0 {
            all.push(power("a", i64::from(term.power), style));
        }
        if term.harmonic > 0 {
            let backslash = if style == Style::Latex { r"\" } else { "" };
            let function = if term.sine { "sin" } else { "cos" };
            let angle = print_turns(term.harmonic, "gamma", style);
            all.push(format!("{backslash}{function}({angle})"));
        }
        Term { coefficient: term.coefficient.clone(), factors: all }
    }
}
