//! Equations as text and as LaTeX, with the parentheses that are needed and no others.
//!
//! The tree is printed as it stands: nothing is reordered, collected or cancelled. Only signs
//! move to where a reader expects them: a product with negative numbers shows one sign in front,
//! and a factor 1 beside others is left out. Sums in sums and products in products are flat,
//! which addition and multiplication allow.

use crate::{Expression, Function, Unknown};
use rug::Rational;
use std::borrow::Cow;
use std::cmp::Ordering;

/// How to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// One line of ASCII, `x'' + x*(x^2)^delta`, `3/8*mu_1^2`.
    Text,
    /// Mathematics for LaTeX, `\ddot{x} + x\,(x^{2})^{\delta}`, `\frac{3}{8}\,\mu_1^{2}`.
    Latex,
}

impl Expression {
    /// The expression as one line; `small` is the name of the small parameter. The cost is
    /// linear in the size of the tree (times its depth).
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// use lindstedt_equation::print::Style;
    ///
    /// let x = Expression::DISPLACEMENT;
    /// let duffing = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
    /// assert_eq!(duffing.print("eps", Style::Text), "x'' + x + eps*x^3");
    /// assert_eq!(duffing.print("eps", Style::Latex), r"\ddot{x} + x + \varepsilon\,x^{3}");
    /// ```
    #[must_use]
    pub fn print(&self, small: &str, style: Style) -> String {
        self.print_named(small, &[], style)
    }

    /// The same with names for the unknowns; those without one are x, x_2, ...
    #[must_use]
    pub fn print_named(&self, small: &str, names: &[Cow<'static, str>], style: Style) -> String {
        Printer { small, names, style }.sum(self)
    }
}

/// A factor of a term, written.
struct Written {
    line: String,
    /// Whether it begins with a digit, so that LaTeX needs a dot between it and a number.
    number: bool,
}

/// What the printing of every node needs.
struct Printer<'a> {
    small: &'a str,
    names: &'a [Cow<'static, str>],
    style: Style,
}

impl Printer<'_> {
    fn latex(&self) -> bool {
        self.style == Style::Latex
    }

    /// Any expression, outside of all parentheses.
    fn sum(&self, expression: &Expression) -> String {
        let mut line = String::new();
        for (negative, term) in self.terms(expression) {
            line.push_str(match (line.is_empty(), negative) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            });
            line.push_str(&term);
        }
        if line.is_empty() { "0".to_owned() } else { line }
    }

    /// The terms of a sum, of sums in sums too: (negative, magnitude).
    fn terms(&self, expression: &Expression) -> Vec<(bool, String)> {
        match expression {
            Expression::Sum(terms) => terms.iter().flat_map(|term| self.terms(term)).collect(),
            single => vec![self.term(single)],
        }
    }

    /// A product, or anything that stands as one term of a sum: (negative, magnitude).
    fn term(&self, expression: &Expression) -> (bool, String) {
        let mut factors = Vec::new();
        flatten(expression, &mut factors);
        let negative =
            |f: &&&Expression| matches!(f, Expression::Number(n) if n.cmp0() == Ordering::Less);
        let sign = factors.iter().filter(negative).count() % 2 == 1;
        let is_unit = |f: &&Expression| matches!(f, Expression::Number(n) if Rational::from(n.abs_ref()) == 1);
        let mut shown: Vec<&Expression> = factors.into_iter().filter(|f| !is_unit(f)).collect();
        let one = Expression::integer(1);
        if shown.is_empty() {
            shown.push(&one);
        }
        let last = shown.len() - 1;
        let mut line = String::new();
        for (index, factor) in shown.into_iter().enumerate() {
            let factor = self.factor(factor, index == last);
            line.push_str(match (index, self.latex(), factor.number) {
                (0, ..) => "",
                (_, false, _) => "*",
                (_, true, true) => r" \cdot ",
                (_, true, false) => r"\,",
            });
            line.push_str(&factor.line);
        }
        (sign, line)
    }

    /// A factor of a product; the sign of a number is left to the term.
    fn factor(&self, expression: &Expression, last: bool) -> Written {
        let line = match expression {
            Expression::Number(n) => {
                let magnitude = Rational::from(n.abs_ref());
                return Written { line: print_rational(&magnitude, self.style), number: true };
            }
            Expression::Sum(_) => parenthesize(&self.sum(expression), self.style),
            Expression::Function(function, argument) => self.function(*function, argument, last),
            other => self.atom(other),
        };
        Written { line, number: false }
    }

    /// An expression that can stand under or (in text) over the sign of a power: parentheses
    /// unless it is one symbol, a non-negative integer or a function value.
    fn base(&self, expression: &Expression) -> String {
        let needs = match expression {
            Expression::Number(n) => !n.is_integer() || n.cmp0() == Ordering::Less,
            Expression::Sum(_) | Expression::Product(_) | Expression::Power(..) => true,
            Expression::Function(Function::Abs, _) => false,
            Expression::Function(..) => self.latex(),
            _ => false,
        };
        let line = self.sum(expression);
        if needs { parenthesize(&line, self.style) } else { line }
    }

    /// Everything that is not a sum, a product, a number or an elementary function; those are
    /// written by `sum`.
    fn atom(&self, expression: &Expression) -> String {
        match (expression, self.latex()) {
            (Expression::Parameter(name), false) => name.clone(),
            (Expression::Parameter(name), true) => latex_name(name),
            (Expression::Small, false) => self.small.to_owned(),
            (Expression::Small, true) => latex_name(self.small),
            (Expression::Unknown(unknown), _) => self.unknown(unknown),
            (Expression::Time, _) => "t".to_owned(),
            (Expression::Power(base, exponent), true) => {
                format!("{}^{{{}}}", self.base(base), self.sum(exponent))
            }
            (Expression::Power(base, exponent), false) => {
                format!("{}^{}", self.base(base), self.base(exponent))
            }
            (Expression::Formal(name, argument), latex) => {
                let name = if latex { latex_name(name) } else { name.clone() };
                format!("{name}{}", parenthesize(&self.sum(argument), self.style))
            }
            (Expression::Function(function, argument), _) => {
                self.function(*function, argument, true)
            }
            (Expression::Sum(_) | Expression::Product(_) | Expression::Number(_), _) => {
                self.sum(expression)
            }
        }
    }

    /// sin(x), in LaTeX \sin x where no factor follows that could be read as its argument.
    fn function(&self, function: Function, argument: &Expression, last: bool) -> String {
        let name = match function {
            Function::Ln => "ln",
            Function::Exp => "exp",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Abs => "abs",
            Function::Sign => "sign",
        };
        let line = self.sum(argument);
        if !self.latex() {
            return format!("{name}({line})");
        }
        match function {
            Function::Exp => return format!("e^{{{line}}}"),
            Function::Abs => return format!(r"\left|{line}\right|"),
            Function::Sign => {
                return format!(r"\operatorname{{sign}}{}", parenthesize(&line, self.style));
            }
            Function::Ln | Function::Sin | Function::Cos => {}
        }
        let symbol = matches!(
            argument,
            Expression::Unknown(Unknown { delay: None, .. })
                | Expression::Parameter(_)
                | Expression::Time
                | Expression::Small
        );
        if symbol && last {
            let space = if line.starts_with('\\') { "" } else { " " };
            return format!(r"\{name}{space}{line}");
        }
        format!(r"\{name}{}", parenthesize(&line, self.style))
    }

    /// x, x', x''(t - T); the second unknown is x_2.
    fn unknown(&self, unknown: &Unknown) -> String {
        let n = unknown.derivative as usize;
        let name = match (self.names.get(unknown.index), unknown.index) {
            (Some(name), _) => name.to_string(),
            (None, 0) => "x".to_owned(),
            (None, k) => format!("x_{}", k + 1),
        };
        let name = if self.latex() { latex_name(&name) } else { name };
        // The dots stand over the letter, not over its index.
        let (letter, index) = name.split_at(name.find('_').unwrap_or(name.len()));
        let stem = match (self.latex(), n) {
            (true, 1..=4) => format!(r"\{}ot{{{letter}}}", "d".repeat(n)),
            (true, 5..) => format!("{letter}^{{({n})}}"),
            _ => letter.to_owned(),
        };
        let primes = if self.latex() { String::new() } else { "'".repeat(n) };
        let time = unknown.delay.as_deref().map(|delay| Expression::Time - delay.clone());
        let time = time.map_or_else(String::new, |time| parenthesize(&self.sum(&time), self.style));
        format!("{stem}{index}{primes}{time}")
    }
}

/// The factors of a product, of products in products and of sums of one term too.
fn flatten<'a>(expression: &'a Expression, factors: &mut Vec<&'a Expression>) {
    match expression {
        Expression::Product(inner) => inner.iter().for_each(|factor| flatten(factor, factors)),
        Expression::Sum(terms) if terms.len() == 1 => {
            terms.iter().for_each(|term| flatten(term, factors));
        }
        other => factors.push(other),
    }
}

/// A sum in parentheses, growing ones around fractions in LaTeX.
#[must_use]
pub fn parenthesize(sum: &str, style: Style) -> String {
    if style == Style::Latex && sum.contains(r"\frac") {
        format!(r"\left({sum}\right)")
    } else {
        format!("({sum})")
    }
}

/// `-3/8`, in LaTeX `-\frac{3}{8}`; integers without denominator.
#[must_use]
pub fn print_rational(q: &Rational, style: Style) -> String {
    if style == Style::Text || q.is_integer() {
        return q.to_string();
    }
    let sign = if q.cmp0() == Ordering::Less { "-" } else { "" };
    let numerator = q.numer().clone().abs();
    format!(r"{sign}\frac{{{numerator}}}{{{}}}", q.denom())
}

/// Names that are Greek letters; `eps` and `epsilon` are \varepsilon.
const GREEK: &str = " alpha beta gamma delta zeta eta theta iota kappa lambda mu nu xi pi rho \
    sigma tau upsilon phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega ";

/// A name of ASCII letters in LaTeX: `mu_1` and `mu1` are `\mu_1`, `R_in` is `R_{\mathrm{in}}`, `ln(a)` is
/// `\ln a`. Anything that is no name is left as it is.
#[must_use]
pub fn latex_name(name: &str) -> String {
    if let Some(argument) = name.strip_prefix("ln(").and_then(|rest| rest.strip_suffix(')')) {
        let simple = argument.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let argument = latex_name(argument);
        let space = if argument.starts_with('\\') { "" } else { " " };
        return if simple { format!(r"\ln{space}{argument}") } else { format!(r"\ln({argument})") };
    }
    if let Some(number) = name.strip_prefix("sqrt(").and_then(|rest| rest.strip_suffix(')')) {
        return format!(r"\sqrt{{{number}}}");
    }
    for function in ["cos", "sin"] {
        let argument = name.strip_prefix(function).and_then(|rest| rest.strip_prefix('('));
        if let Some(product) = argument.and_then(|rest| rest.strip_suffix(')')) {
            let factors: Vec<String> = product.split('*').map(latex_name).collect();
            return format!(r"\{function}({})", factors.join(r"\,"));
        }
    }
    if let Some((letter, index)) = name.split_once('_') {
        let index = latex_name(index);
        let single = index.chars().count() == 1;
        let index = if single { index } else { format!("{{{index}}}") };
        return format!("{}_{index}", latex_name(letter));
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    if !stem.is_empty() && stem.len() < name.len() {
        return latex_name(&format!("{stem}_{}", &name[stem.len()..]));
    }
    if name == "eps" || name == "epsilon" {
        r"\varepsilon".to_owned()
    } else if GREEK.contains(&format!(" {name} ")) {
        format!(r"\{name}")
    } else if name.len() > 1 && name.chars().all(|c| c.is_ascii_alphabetic()) {
        format!(r"\mathrm{{{name}}}")
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Expression::{Number, Small};

    fn x() -> Expression {
        Expression::DISPLACEMENT
    }

    fn both(e: &Expression, small: &str) -> [String; 2] {
        [Style::Text, Style::Latex].map(|style| e.print(small, style))
    }

    #[test]
    fn power_law_and_van_der_pol() {
        let power_law = Expression::ACCELERATION + x() * x().pow(2).pow(Small);
        let shown = ["x'' + x*(x^2)^delta", r"\ddot{x} + x\,(x^{2})^{\delta}"];
        assert_eq!(both(&power_law, "delta"), shown);
        let van_der_pol =
            Expression::ACCELERATION + x() - Small * (1 - x().pow(2)) * Expression::VELOCITY;
        let latex = r"\ddot{x} + x - \varepsilon\,(1 - x^{2})\,\dot{x}";
        assert_eq!(both(&van_der_pol, "eps"), ["x'' + x - eps*(1 - x^2)*x'", latex]);
    }

    #[test]
    fn formal_and_elementary_functions() {
        let log = x().pow(2).ln();
        let e = x() * (Small * log.clone()).formal("Omega") - log;
        let latex = r"x\,\Omega(\delta\,\ln(x^{2})) - \ln(x^{2})";
        assert_eq!(both(&e, "delta"), ["x*Omega(delta*ln(x^2)) - ln(x^2)", latex]);
        let sin = Expression::Function(Function::Sin, Box::new(x()));
        let e = Expression::ACCELERATION
            + sin.clone()
            + sin.clone() * Expression::VELOCITY
            + sin.pow(2);
        let latex = r"\ddot{x} + \sin x + \sin(x)\,\dot{x} + (\sin x)^{2}";
        assert_eq!(both(&e, ""), ["x'' + sin(x) + sin(x)*x' + sin(x)^2", latex]);
        let exp = Expression::Function(Function::Exp, Box::new(-x()));
        assert_eq!(both(&exp.pow(2), ""), ["exp(-x)^2", "(e^{-x})^{2}"]);
    }

    #[test]
    fn numbers_signs_and_parentheses() {
        let third = || Number(Rational::from((-1, 3)));
        let cases = [
            (third() * x(), "-1/3*x", r"-\frac{1}{3}\,x"),
            (x() * third(), "-x*1/3", r"-x \cdot \frac{1}{3}"),
            (x().pow(Number(Rational::from((1, 2)))), "x^(1/2)", r"x^{\frac{1}{2}}"),
            (Number(Rational::from((1, 2))).pow(x()), "(1/2)^x", r"\left(\frac{1}{2}\right)^{x}"),
            (x().pow(third()), "x^(-1/3)", r"x^{-\frac{1}{3}}"),
            (third().pow(2), "(-1/3)^2", r"\left(-\frac{1}{3}\right)^{2}"),
            (x() - (x() - third()), "x - (x + 1/3)", r"x - \left(x + \frac{1}{3}\right)"),
            (x() * (-x()) * 2, "-x*x*2", r"-x\,x \cdot 2"),
            (x().pow(x().pow(2)), "x^(x^2)", "x^{x^{2}}"),
            ((x() * 2).pow(-1), "(x*2)^(-1)", r"(x \cdot 2)^{-1}"),
            (-x() * Expression::integer(-1), "x", "x"),
            (Expression::integer(-1), "-1", "-1"),
            (Expression::Sum(Vec::new()), "0", "0"),
            (Expression::Product(Vec::new()), "1", "1"),
            (Expression::parameter("Omega_0").pow(2), "Omega_0^2", r"\Omega_0^{2}"),
            (x() + Expression::Sum(vec![x(), x() * -1]), "x + x - x", "x + x - x"),
            (Expression::Sum(vec![x() + 1]) * x(), "(x + 1)*x", r"(x + 1)\,x"),
        ];
        for (e, text, latex) in cases {
            assert_eq!(both(&e, "eps"), [text, latex]);
        }
    }

    #[test]
    fn time_delays_and_non_smooth_functions() {
        let delay = || Expression::parameter("T");
        let forcing = (Expression::parameter("omega") * Expression::Time).apply(Function::Cos);
        let e = x() - x().delayed(delay()) + Expression::VELOCITY.delayed(delay() * 2) - forcing;
        let latex = r"x - x(t - T) + \dot{x}(t - T \cdot 2) - \cos(\omega\,t)";
        assert_eq!(both(&e, "eps"), ["x - x(t - T) + x'(t - T*2) - cos(omega*t)", latex]);
        let e = x().apply(Function::Abs).pow(3) * Expression::VELOCITY.apply(Function::Sign);
        let latex = r"\left|x\right|^{3}\,\operatorname{sign}(\dot{x})";
        assert_eq!(both(&e, "eps"), ["abs(x)^3*sign(x')", latex]);
    }

    #[test]
    fn an_empty_sum_is_a_factor() {
        let e = Expression::Sum(Vec::new()) * x();
        assert_eq!(both(&e, "eps"), ["(0)*x", r"(0)\,x"]);
    }
}
