//! An expansion beside the printed order equations.

use super::compare::{Ratio, Term, compare_sums};
use super::{Findings, Reader, Row, periods};
use lindstedt::unstable::derivation::constants::Constants;
use lindstedt::{
    Derivation, Error, Progress, Solution, unstable::derivation::Settings,
    unstable::derivation::derive,
};
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Ring};
use lindstedt_coeff::print::Style;
use lindstedt_coeff::{Polynomial, PolynomialRing};
use lindstedt_expand::{ExpandError, Expansion};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::digits::decimal;
use lindstedt_phase::evaluate::PhaseFunctions;
use lindstedt_phase::lobachevsky::LobachevskyElement;
use lindstedt_phase::lobachevsky_function::{LambdaTable, Point};
use lindstedt_phase::print::PrintPhase;
use lindstedt_phase::{Lobachevsky, lobachevsky::Word};
use rug::Rational;

pub(super) type Algebra = Lobachevsky<PolynomialRing>;
pub(super) type Element = LobachevskyElement<Polynomial>;

impl Ratio for PolynomialRing {
    fn leading_ratio(&self, a: &Polynomial, b: &Polynomial) -> Option<Rational> {
        let ([(m, x), ..], [(n, y), ..]) = (a.terms(), b.terms()) else { return None };
        (m == n).then(|| Rational::from(y / x))
    }
}

impl Ratio for Algebra {
    fn leading_ratio(&self, a: &Element, b: &Element) -> Option<Rational> {
        let ((i, p), (j, q)) = (a.blocks().first_key_value()?, b.blocks().first_key_value()?);
        let ((v, c), (w, d)) = (p.terms().first()?, q.terms().first()?);
        if i == j && v == w { self.constants().leading_ratio(c, d) } else { None }
    }
}

/// An expansion, with what its numbers need.
pub(super) struct Case {
    pub algebra: Algebra,
    pub derivation: Derivation,
    pub expansion: Expansion<Algebra>,
    pub constants: Constants,
    table: LambdaTable,
}

impl Case {
    /// Derives a problem at amplitude 1; nothing when stopped before order 2.
    pub fn derive(name: &str, reader: &mut Reader<'_>) -> Result<Option<Self>, Error> {
        let problem = lindstedt_problems::find(name).ok_or(Error::NoValue)?;
        let one = lindstedt::Exact::from(1);
        let settings = Settings {
            order: reader.options.order.max(2),
            parameters: [("amplitude".to_owned(), one.clone())].into(),
            ..Settings::default()
        };
        let mut observer = |progress: Progress| match progress {
            Progress::Order(n, _) => (reader.observer)(&format!("{name}, order {n}")),
            _ => true,
        };
        let derivation = derive(&problem, &settings, &mut observer)?;
        let Solution::Clock(solution) = &derivation.solution else { return Err(Error::NoValue) };
        let expansion = solution.expansion();
        if expansion.order() < 2 {
            return Ok(None);
        }
        Ok(Some(Self {
            algebra: Lobachevsky::new(derivation.ring.clone()),
            expansion,
            constants: Constants::new(Some(one)),
            table: LambdaTable::new(settings.order, reader.balls),
            derivation,
        }))
    }

    /// x_n.
    pub fn x(&self, n: usize) -> &Element {
        &self.expansion.solution[n]
    }

    /// x_n''.
    pub fn acceleration(&self, n: usize) -> Element {
        self.algebra.derivative(&self.algebra.derivative(self.x(n)))
    }

    /// ln(x_0^2) = -2 l.
    pub fn log(&self) -> Element {
        self.algebra.term(
            0,
            false,
            Word::log(1),
            self.algebra.constants().rational(&Rational::from(-2)),
        )
    }

    /// f g.
    pub fn product(&self, f: &Element, g: &Element) -> Element {
        self.algebra.mul(f, g)
    }

    /// c f.
    pub fn scaled(&self, f: &Element, c: &Polynomial) -> Element {
        self.algebra.scale_by(f, c)
    }

    /// -alpha_k x_n''.
    pub fn inertia(&self, k: usize, n: usize) -> Term<Element> {
        let value = self.scaled(&self.acceleration(n), &self.expansion.frequency_squared[k]);
        Term::new(-1, &format!("alpha_{k} x_{n}''"), value)
    }

    /// The whole right side of x_n'' + x_n = ..., secular term and all.
    pub fn right_side(&self, n: usize) -> Element {
        self.algebra.add(&self.acceleration(n), self.x(n))
    }

    fn value(&self, f: &Element) -> Option<Ball> {
        let point = Point::Rational(Rational::from(1));
        let balls = self.table.balls();
        let of_coefficient = |c: &_| self.constants.evaluate(c, balls);
        PhaseFunctions::lobachevsky(std::slice::from_ref(f), self.table.clone(), of_coefficient)?
            .at(&point)?
            .pop()
    }

    /// The row of x_n(0) = (1 or 0), x_n'(0) = 0.
    pub fn initial_row(&self, label: &str, n: usize, printed: &str) -> Row {
        let ring = self.algebra.constants();
        let start = self.algebra.at_zero(self.x(n));
        let slope = self.algebra.at_zero(&self.algebra.derivative(self.x(n)));
        let expected = if n == 0 { ring.one() } else { ring.zero() };
        let holds = start.as_ref() == Some(&expected) && slope == Some(ring.zero());
        let shown = |value: Option<Polynomial>| {
            let rational = value.and_then(|v| ring.as_rational(&v));
            rational.map_or("?".to_owned(), |q| q.to_string())
        };
        Row::new(
            label,
            printed,
            format!("$x_{n}(0) = {}$, $x_{n}'(0) = {}$", shown(start), shown(slope)),
            self.residual_text(),
            &Findings::holds(holds),
            "value and slope of the derived $x_n$ at 0, exactly",
        )
    }

    /// What the residual check said.
    pub fn residual_text(&self) -> String {
        match self.derivation.checked_orders {
            Some(order) => {
                format!("substituted into the equation: residual 0 at orders 0..{order}")
            }
            None => "not substituted into the equation".to_owned(),
        }
    }

    /// The row of an order equation: the printed right side against the derived one, exactly, and
    /// both against a numerical differentiation of the force along x_0 + delta x_1 at tau = 1.
    ///
    /// # Errors
    /// A residual error when the two routes contradict each other (a defect of the engine).
    pub fn order_row(
        &self,
        label: &str,
        (n, printed): (usize, &str),
        terms: &[Term<Element>],
        vocabulary: &[Term<Element>],
        force: &dyn Fn(&Ball, &Ball, Balls) -> Option<Ball>,
    ) -> Result<Row, Error> {
        let derived = self.right_side(n);
        let mut findings = compare_sums(&self.algebra, terms, &derived, vocabulary);
        // The paper writes squares of logarithms as [ln(x^2)]^2, so this may be the logarithm of a square.
        let reading = printed.contains("ln(x_0)^2") && findings.correction.is_some();
        findings.holds |= reading;
        let mut sum = self.algebra.zero();
        for term in terms {
            let value = self.algebra.scale(&term.value, &term.factor);
            self.algebra.add_assign(&mut sum, &value);
        }
        let contradiction = || Error::from(ExpandError::Residual { order: n });
        let balls = self.table.balls();
        let ours = self.value(&derived).ok_or(Error::NoValue)?;
        let theirs = self.value(&sum).ok_or(Error::NoValue)?;
        let numerical = self.numerical_right_side(n, force).ok_or(Error::NoValue)?;
        let distance = balls.sub(&ours, &numerical).abs_upper();
        if distance > 1e-25 {
            return Err(contradiction());
        }
        let show = |ball: &Ball| decimal(ball, 12).unwrap_or_else(|| "?".to_owned());
        let text = self.algebra.print(&derived, "tau", Style::Text);
        let evidence = match &findings.correction {
            Some(correction) if reading => format!(
                "right with $ln(x_0)^2$ read as $ln((x_0)^2)$; read as $(ln x_0)^2$ it would be {}, and right is \
                 {correction}",
                show(&theirs)
            ),
            _ if findings.holds => "equal in the Lobachevsky ring".to_owned(),
            Some(correction) => format!("{correction}; at $tau = 1$ as printed {}", show(&theirs)),
            None => format!("at $tau = 1$ as printed {}", show(&theirs)),
        };
        Ok(Row::new(
            label,
            printed,
            format!("$x_{n}'' + x_{n} = {text}$"),
            format!(
                "at $tau = 1$, force differentiated numerically: {} (estimated; derived {})",
                show(&numerical),
                show(&ours)
            ),
            &findings,
            evidence,
        ))
    }

    /// -[force]_n/kappa - sum_{k=1}^n W_k x_{n-k}'' at tau = 1, for n = 1, 2, the force along
    /// x_0 + delta x_1 by finite differences.
    fn numerical_right_side(
        &self,
        n: usize,
        force: &dyn Fn(&Ball, &Ball, Balls) -> Option<Ball>,
    ) -> Option<Ball> {
        let balls = self.table.balls();
        let x0 = self.value(self.x(0))?;
        let x1 = if n > 1 { self.value(self.x(1))? } else { balls.zero() };
        let along = |delta: &Ball| {
            let x = balls.add(&x0, &balls.mul(delta, &x1));
            force(&x, delta, balls)
        };
        let stiffness = self.constants.evaluate(&self.expansion.stiffness, balls)?;
        let mut sum = balls.div(&periods::difference(n, balls, along)?, &stiffness)?;
        for k in 1..=n {
            let w = self.constants.evaluate(&self.expansion.frequency_squared[k], balls)?;
            let acceleration = self.value(&self.acceleration(n - k))?;
            sum = balls.add(&sum, &balls.mul(&w, &acceleration));
        }
        Some(balls.neg(&sum))
    }
}
