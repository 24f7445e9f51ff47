//! What the method really gives: partial sums against exact periods.

use super::{Reader, Section, Table, periods};
use crate::text::texts;
use lindstedt::unstable::derivation::constants::Constants;
use lindstedt::{Error, Exact, unstable::derivation::energy};
use lindstedt_algebra::{Ring, Stop};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::digits::decimal;
use rug::{Float, Rational};
use std::rc::Rc;

/// The quantity whose series is cut off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Period,
    Frequency,
    FrequencySquared,
}

/// All three, in the order of the columns.
pub(super) const QUANTITIES: [Quantity; 3] =
    [Quantity::Period, Quantity::Frequency, Quantity::FrequencySquared];

impl Quantity {
    pub fn name(self) -> &'static str {
        match self {
            Self::Period => "$T$",
            Self::Frequency => "$omega$",
            Self::FrequencySquared => "$omega^2$",
        }
    }
}

/// The three series of an oscillator, by the energy integral: exact coefficients as balls,
/// leading coefficients one, omega^2 = kappa (1 + ...).
pub(super) struct Truncations {
    balls: Balls,
    root_of_stiffness: Ball,
    series: [Vec<Ball>; 3],
}

impl Truncations {
    /// x'' + x (x^2)^delta = 0, amplitude 1.
    pub fn power_law(order: usize, balls: Balls) -> Option<Self> {
        let ring = PolynomialRing::default();
        let exact =
            energy::power_law_frequency(&ring, -1, u16::try_from(order).ok()?, &Stop::default())?;
        Self::new(&ring.one(), &exact, &Constants::default(), balls)
    }

    /// The pendulum with amplitude 1.
    pub fn pendulum(order: usize, balls: Balls) -> Option<Self> {
        let ring = PolynomialRing::default();
        let sum = |n| Some(ring.symbol(Symbol::Sum(u16::try_from(n).ok()?)));
        let sums = (0..=order).map(sum).collect::<Option<Vec<_>>>()?;
        let constants = Constants::new(Some(Exact::Rational(Rational::from(1))));
        let exact = energy::period_over_2pi(&ring, &sums, order, &Stop::default())?;
        Self::new(sums.first()?, &exact, &constants, balls)
    }

    fn new(
        stiffness: &Polynomial,
        exact: &[Polynomial],
        constants: &Constants,
        balls: Balls,
    ) -> Option<Self> {
        let period: Vec<Ball> =
            exact.iter().map(|p| constants.evaluate(p, balls)).collect::<Option<_>>()?;
        let frequency = periods::power(&period, &Rational::from(-1), balls)?;
        let squared = periods::power(&period, &Rational::from(-2), balls)?;
        let root_of_stiffness = balls.sqrt(&constants.evaluate(stiffness, balls)?)?;
        Some(Self { balls, root_of_stiffness, series: [period, frequency, squared] })
    }

    /// The terms c_n delta^n of one series.
    fn terms(&self, quantity: Quantity, delta: &Rational) -> Vec<Ball> {
        let mut power = Rational::from(1);
        let scaled = |c: &Ball| {
            let term = self.balls.mul_rational(c, &power);
            power *= delta;
            term
        };
        self.series[quantity as usize].iter().map(scaled).collect()
    }

    /// The coefficients of one series.
    pub fn coefficients(&self, quantity: Quantity) -> &[Ball] {
        &self.series[quantity as usize]
    }

    /// The period that the series of a quantity gives when cut off after `order`; nothing where
    /// omega or omega^2 is not positive.
    pub fn period(&self, quantity: Quantity, order: usize, delta: &Rational) -> Option<Ball> {
        let balls = self.balls;
        let terms = self.terms(quantity, delta);
        let sum = terms.get(..=order)?.iter().fold(balls.zero(), |s, t| balls.add(&s, t));
        let over_2pi = match quantity {
            Quantity::Period => sum,
            Quantity::Frequency if !sum.is_positive() => return None,
            Quantity::Frequency => balls.div(&balls.one(), &sum)?,
            Quantity::FrequencySquared => balls.div(&balls.one(), &balls.sqrt(&sum)?)?,
        };
        let period = balls.mul_i64(&balls.mul(&balls.pi(), &over_2pi), 2);
        balls.div(&period, &self.root_of_stiffness)
    }

    /// The order whose term is smallest, below the last one.
    fn smallest_term(&self, quantity: Quantity, delta: &Rational) -> Option<usize> {
        let terms = self.terms(quantity, delta);
        let size = |n: &usize| terms.get(*n).map(Ball::abs_upper).unwrap_or(Float::new(53));
        (1..terms.len()).min_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Tables that are announced.
pub(super) const TABLES: usize = 5;

/// An oscillator whose period is tabulated.
pub(super) struct Tabled {
    /// "n = 3" or "pendulum".
    pub name: String,
    pub delta: Rational,
    /// The highest order.
    pub order: usize,
    pub exact: Ball,
    pub series: Rc<Truncations>,
    title: String,
    convergence: String,
}

/// The exact coefficients of the pendulum grow like the partitions of the order.
const PENDULUM_ORDER: usize = 14;

/// n = 3, 5, 7, 9 and the pendulum.
fn tabled(order: usize, balls: Balls) -> Option<Vec<Tabled>> {
    let series = Rc::new(Truncations::power_law(order, balls)?);
    let power_law = |n: i32| {
        let delta = Rational::from((n - 1, 2));
        let convergence = if delta == 1 {
            "$delta = 1$ lies ON the circle of convergence $|delta| = 1$ ($T$ is singular at $delta = -1$)"
                .to_owned()
        } else {
            format!("NO CONVERGENCE: $delta = {delta}$ lies outside the circle $|delta| = 1$")
        };
        Some(Tabled {
            name: format!("n = {n}"),
            order,
            exact: periods::power_law_period(&Rational::from(n), balls)?,
            series: Rc::clone(&series),
            title: format!("$x'' + x^{n} = 0$, $x(0) = 1$: $delta = {delta}$"),
            delta,
            convergence,
        })
    };
    let mut list = [3, 5, 7, 9].into_iter().map(power_law).collect::<Option<Vec<_>>>()?;
    let (one, order) = (Rational::from(1), order.min(PENDULUM_ORDER));
    list.push(Tabled {
        name: "pendulum".to_owned(),
        order,
        exact: periods::pendulum_period(&one, balls)?,
        series: Rc::new(Truncations::pendulum(order, balls)?),
        title: "pendulum $x'' + sin x = 0$, $x(0) = 1$: $delta = 1$".to_owned(),
        delta: one,
        convergence:
            "NO CONVERGENCE for any $delta$ but 0: the potential has poles at $delta = -1/k$, \
             $k = 1$, 2, 3, ...; the series is asymptotic"
                .to_owned(),
    });
    Some(list)
}

/// Adds the tables of n = 3, 5, 7, 9 and of the pendulum.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let order = reader.options.table_order.max(6);
    reader.tabled = tabled(order, reader.balls).ok_or(Error::NoValue)?;
    for n in 0..reader.tabled.len() {
        let name = reader.tabled[n].name.clone();
        if !reader.goes_on(&format!("table of {name}")) {
            return Ok(false);
        }
        section.tables.push(table(&reader.tabled[n]).ok_or(Error::NoValue)?);
    }
    Ok(true)
}

fn table(of: &Tabled) -> Option<Table> {
    let (series, order, delta, exact) = (&of.series, of.order, &of.delta, &of.exact);
    let balls = series.balls;
    let mut columns = vec!["order".to_owned()];
    for quantity in QUANTITIES {
        columns.push(format!("$T$ through {}", quantity.name()));
        columns.push("error %".to_owned());
    }
    let mut rows = Vec::new();
    let mut best: [Option<(Float, usize)>; 3] = [None, None, None];
    for n in 0..=order {
        let mut cells = vec![n.to_string()];
        for (quantity, best) in QUANTITIES.into_iter().zip(&mut best) {
            let Some(value) = series.period(quantity, n, delta) else {
                cells.extend(["none".to_owned(), "-".to_owned()]);
                continue;
            };
            let error = balls.div(&balls.sub(&value, exact), exact)?;
            let size = error.abs_upper();
            cells.push(decimal(&value, 10).unwrap_or_else(|| "?".to_owned()));
            let sign = if error.is_positive() { "+" } else { "" };
            let percent = decimal(&balls.mul_i64(&error, 100), 3);
            cells.push(percent.map_or("?".to_owned(), |text| format!("{sign}{text}")));
            if best.as_ref().is_none_or(|(smallest, _)| size < *smallest) {
                *best = Some((size, n));
            }
        }
        rows.push(cells);
    }
    let mut notes = vec![
        format!("exact period {} (certified)", decimal(exact, 25)?),
        of.convergence.clone(),
        "each column cuts off the series of the quantity named, and $T = 2 pi/omega$ follows from it"
            .to_owned(),
    ];
    for (quantity, best) in QUANTITIES.into_iter().zip(best) {
        let smallest = series.smallest_term(quantity, delta)?;
        let (_, order) = best?;
        notes.push(format!(
            "through {}: smallest true error at order {order}, smallest term at order {smallest}",
            quantity.name()
        ));
    }
    notes.push(
        "`none`: the truncated $omega$ or $omega^2$ is not positive, there is no period".to_owned(),
    );
    Some(Table {
        name: of.name.replace(" = ", ""),
        title: of.title.as_str().into(),
        columns: texts(columns),
        rows: rows.into_iter().map(texts).collect(),
        notes: texts(notes),
    })
}
