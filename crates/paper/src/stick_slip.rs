//! Section 3, the equation (18)-(21) exactly, and the table of thresholds.

use super::melnikov::failed;
use super::{Reader, Row, Section, Table, plain, show};
use crate::oscillator::{oscillator, section_three};
use crate::text::texts;
use lindstedt::Error;
use lindstedt_equation::Expression;
use lindstedt_melnikov::{
    Monomial, OrbitDescription, PolynomialFriction, Region, belt_cycles, sticking_begins,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_problems::stick_slip as card;
use lindstedt_series::univariate;
use lindstedt_simulate::{Model, Parameters, Quantity};
use rug::{Complete, Rational};

/// How many points each identity is evaluated at.
const POINTS: u32 = 40;
/// Digits of the table.
const DIGITS: usize = 20;
/// Digits of the table of cycles.
const CYCLE_DIGITS: usize = 12;

/// Rational numbers that look random and are the same in every run.
struct Points(u64);

impl Points {
    /// A positive number with a denominator of at most 97.
    fn positive(&mut self) -> Rational {
        let mut next = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 33) % 97 + 1
        };
        Rational::from((next(), next()))
    }

    /// A number of either sign.
    fn signed(&mut self) -> Rational {
        let difference = self.positive();
        difference - self.positive()
    }
}

fn cube(x: &Rational) -> Rational {
    x.square_ref().complete() * x
}

fn sign(x: &Rational) -> Rational {
    Rational::from(match x.cmp0() {
        std::cmp::Ordering::Less => -1,
        std::cmp::Ordering::Equal => 0,
        std::cmp::Ordering::Greater => 1,
    })
}

/// T(w) of the engine's law, where its coefficients are rational.
fn law(law: &PolynomialFriction, w: &Rational) -> Option<Rational> {
    let coefficients: Option<Vec<Rational>> =
        law.coefficients.iter().map(|c| c.as_rational().cloned()).collect();
    let dry = law.dry.as_rational()? * sign(w);
    Some(dry + univariate::value(&coefficients?, w))
}

/// The engine's force on the mass: coefficient k at index k.
fn force(orbit: &OrbitDescription, a: &Rational, b: &Rational) -> Option<Vec<Rational>> {
    let power = |x: &Rational, n: i32| match n {
        0 => Some(Rational::from(1)),
        1 => Some(x.clone()),
        _ => None,
    };
    let value = |m: &Monomial| Some(power(a, m.a)? * power(b, m.b)? * &m.coefficient);
    orbit.force.iter().map(value).collect()
}

/// What (18) and (19) print, against (20) of the engine, at one point.
struct Reduction {
    equation: bool,
    friction: bool,
    system: bool,
}

fn reduction(points: &mut Points, orbit: &OrbitDescription) -> Option<Reduction> {
    let [m, k1, k2, forcing, dry, linear, cubic] = std::array::from_fn(|_| points.positive());
    let [x, v, belt, eps, cosine] = std::array::from_fn(|_| points.signed());
    let w = Rational::from(&v - &belt);
    // As printed: theta of (19), and x'' of (18).
    let theta = (&dry * sign(&w)) - Rational::from(&linear * &w) + &cubic * cube(&w);
    let perturbation = Rational::from(&forcing * &cosine) - &theta;
    let eighteen =
        (Rational::from(&k1 * &x) - &k2 * cube(&x) + Rational::from(&eps * &perturbation)) / &m;
    // The parameters as (20) prints them.
    let per_mass = |q: &Rational| Rational::from(q / &m);
    let (a, b, gamma) = (per_mass(&k1), per_mass(&k2), per_mass(&forcing));
    let friction = PolynomialFriction::cubic(
        Exact::from(per_mass(&dry)),
        &Exact::from(per_mass(&linear)),
        Exact::from(per_mass(&cubic)),
    );
    let t = law(&friction, &w)?;
    // v' of (20), printed; and with the engine's force and law.
    let theta_per_mass = per_mass(&theta);
    let printed = Rational::from(&a * &x) - &b * cube(&x)
        + &eps * (Rational::from(&gamma * &cosine) - &theta_per_mass);
    let engine = univariate::value(&force(orbit, &a, &b)?, &x)
        + &eps * (Rational::from(&gamma * &cosine) - &t);
    Some(Reduction {
        equation: eighteen == engine,
        friction: t == theta_per_mass,
        system: printed == engine,
    })
}

/// H of (21) as printed.
fn hamiltonian(a: &Rational, b: &Rational, x: &Rational, v: &Rational) -> Rational {
    let square = x.square_ref().complete();
    let fourth = square.square_ref().complete();
    (v.square_ref().complete() - a * square + b * fourth / 2u32) / 2u32
}

/// f'(0) and f''(0) of a polynomial of degree at most 4, exactly, by five points.
fn derivatives(f: impl Fn(&Rational) -> Rational) -> [Rational; 2] {
    let at = |n: i32| f(&Rational::from(n));
    let [far_left, left, middle, right, far_right] = [at(-2), at(-1), at(0), at(1), at(2)];
    let odd = Rational::from(&right - &left) * 8u32 - Rational::from(&far_right - &far_left);
    let even = (right + left) * 16u32 - middle * 30u32 - far_right - far_left;
    [odd / 12u32, even / 12u32]
}

/// What (21) says, at one point: H is conserved; the critical points are those and no others.
fn flow(points: &mut Points, orbit: &OrbitDescription) -> Option<[bool; 2]> {
    let [b, s] = std::array::from_fn(|_| points.positive());
    // A rational centre: a/b = s^2.
    let a = &b * s.square_ref().complete();
    let [x, v] = std::array::from_fn(|_| points.signed());
    let force = force(orbit, &a, &b)?;
    let acceleration = univariate::value(&force, &x);
    let [by_x, _] = derivatives(|h| hamiltonian(&a, &b, &Rational::from(&x + h), &v));
    let [by_v, _] = derivatives(|h| hamiltonian(&a, &b, &x, &Rational::from(&v + h)));
    let conserved = (by_x * &v + by_v * acceleration).is_zero();
    // Where v = 0 and the force vanishes; its derivative is the square of the eigenvalues.
    let zero = Rational::new();
    let slope = |x: &Rational| {
        derivatives(|h| univariate::value(&force, &Rational::from(x + h)))[0].clone()
    };
    let curvature = |x: &Rational| {
        derivatives(|h| hamiltonian(&a, &b, &Rational::from(x + h), &zero))[1].clone()
    };
    let rest = |x: &Rational| univariate::value(&force, x).is_zero();
    let minus = Rational::from(-&s);
    let centre = |x: &Rational| rest(x) && slope(x) < 0 && curvature(x) > 0;
    let saddle = rest(&zero) && slope(&zero) > 0 && curvature(&zero) < 0;
    // Three different roots of a force of degree 3: there are no others.
    let complete = force.len() == 4 && force.last().is_some_and(|c| !c.is_zero());
    Some([conserved, saddle && centre(&s) && centre(&minus) && complete])
}

/// Reads the equation.
pub(super) fn read_equation(_: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let orbit = section_three().potential().description().ok_or(Error::NoValue)?;
    let mut points = Points(20);
    let mut reductions = Vec::new();
    let mut flows = Vec::new();
    for _ in 0..POINTS {
        reductions.push(reduction(&mut points, &orbit).ok_or(Error::NoValue)?);
        flows.push(flow(&mut points, &orbit).ok_or(Error::NoValue)?);
    }
    section.rows.extend(reduction_rows(&reductions));
    section.rows.extend(flow_rows(&flows, &orbit));
    Ok(true)
}

/// (18) to (20).
fn reduction_rows(reductions: &[Reduction]) -> [Row; 3] {
    let exactly = format!("both sides, exactly, at {POINTS} rational points");
    [
        plain(
            "(18)",
            "$m x'' - k1 x + k2 x^3 = eps [Gamma cos(omega t) - theta(x' - v*)]$",
            "$x'' = a x - b x^3 + eps [gamma cos(omega t) - T(v - v*)]$",
            &*exactly,
            reductions.iter().all(|r| r.equation),
            "with $theta$ of (19) and the parameters of (20)",
        ),
        plain(
            "(19)",
            "$theta(w) = theta_0 sign w - A w + B w^3$",
            "$T(w) = T0 sgn w - alpha w + beta w^3$ is $theta/m$",
            &*exactly,
            reductions.iter().all(|r| r.friction),
            "the law of the engine, sliding in both directions",
        ),
        plain(
            "(20)",
            "$v' = a x - b x^3 + eps [gamma cos(omega t) - T(v - v*)]$, $x' = v$; $a = k1/m$, $b = k2/m$, \
             $gamma = Gamma/m$, $T = theta/m$, $T0 = theta_0/m$, $alpha = A/m$, $beta = B/m$",
            "the force and the law that the engine integrates",
            exactly,
            reductions.iter().all(|r| r.system),
            "$eps$ is a bookkeeping parameter: the paper's numbers take no value for it",
        ),
    ]
}

/// (21), the critical points and the orbit through the saddle.
fn flow_rows(flows: &[[bool; 2]], orbit: &OrbitDescription) -> [Row; 3] {
    [
        plain(
            "(21)",
            "$H = (v^2 - a x^2 + b x^4/2)/2$",
            "$dH/dt = H_x v + H_v (a x - b x^3) = 0$",
            format!("five-point differences, exact for degree 4, at {POINTS} rational points"),
            flows.iter().all(|f| f[0]),
            "$H$ as printed, along the engine's force",
        ),
        plain(
            "critical points",
            "two centres at $(+-sqrt(a/b), 0)$, a hyperbolic saddle at the origin",
            "$a x - b x^3 = 0$ there and nowhere else; eigenvalues squared $a$ at 0, $-2a$ at the others",
            "the sign of $H_xx$",
            flows.iter().all(|f| f[1]),
            "exactly, at parameters with rational centres",
        ),
        plain(
            "$x_0$",
            "$x_0 = +-sqrt(2a/b) sech(sqrt(a) t)$",
            "$xi'' = xi - 2 xi^3$ for $xi = sech z$ in $Q[sech, tanh]$",
            "",
            orbit.check().is_ok(),
            "the first half of (23); an identity modulo $tanh^2 = 1 - sech^2$",
        ),
    ]
}

/// Reads the table.
pub(super) fn read_table(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.tables.push(table(reader.balls)?);
    section.tables.push(cycles(reader.balls)?);
    Ok(true)
}

fn table(balls: Balls) -> Result<Table, Error> {
    let columns = ["$b$", "$V$", "$gamma$ at $v* = 0$", "$gamma$ at $v* = V$", "zero 1", "zero 2"];
    let mut rows = Vec::new();
    for b in [1, 2, 5, 10] {
        let at_zero = oscillator(b, Exact::from(0));
        let mut cells = vec![b.to_string()];
        for value in [
            at_zero.loop_speed(balls),
            at_zero.signed_threshold(balls),
            at_zero.threshold_at_cusp(balls),
        ] {
            cells.push(show(&value.ok_or(Error::NoValue)?, DIGITS));
        }
        let zeros = at_zero.zeros(balls).map_err(failed)?;
        cells.extend(zeros.iter().map(|zero| show(zero, DIGITS)));
        cells.resize(columns.len(), "none".to_owned());
        rows.push(cells);
    }
    let touching = section_three().touching_b().ok_or(Error::NoValue)?;
    Ok(Table {
        name: "thresholds".to_owned(),
        title: "$gamma(v*)$: $a = 1$, $alpha = beta = T0 = 0.3$, $omega = 2$".into(),
        columns: texts(columns),
        rows: rows.into_iter().map(texts).collect(),
        notes: texts([
            "$gamma$ is signed, the work of friction over that of the forcing; the threshold $gamma_c$ \
             is its absolute value"
                .to_owned(),
            "$V = a/sqrt(2b)$ is the largest speed on the loop: there $gamma$ has its cusp".to_owned(),
            format!(
                "the cusp touches $gamma = 0$ at $b* = {touching}$; the rows with $b > b*$ have two zeros, \
                 one on each side of $V$"
            ),
            "at $v* = 0$ and $v* = V$ themselves the theory does not hold: these are limits".to_owned(),
        ]),
    })
}

/// The cycles of (20) without a force that do not reach the speed of the belt: what the paper does not say.
fn cycles(balls: Balls) -> Result<Table, Error> {
    let columns =
        ["$b$", "orbit", "$v*$", "smallest $x$", "largest $x$", "largest $v$", "$lambda/eps$"];
    let (a, paper) = (Exact::from(1), section_three());
    let law = PolynomialFriction::cubic(paper.dry.clone(), &paper.alpha, paper.beta.clone());
    let mut rows = Vec::new();
    for b in [1, 5] {
        for (region, name) in [(Region::Inside, "in a well"), (Region::Outside, "around both")] {
            let b_exact = Exact::from(b);
            let begins = sticking_begins(balls, &a, &b_exact, &law, region).map_err(failed)?;
            let at = Exact::from((11, 20));
            let free = belt_cycles(balls, &a, &b_exact, &law, &at, region).map_err(failed)?;
            for cycle in begins.iter().chain(&free) {
                let [low, high] = &cycle.turning_points;
                let mut cells = vec![b.to_string(), name.to_owned()];
                let numbers = [&cycle.belt_speed, low, high, &cycle.largest_speed, &cycle.exponent];
                cells.extend(numbers.map(|ball| show(ball, CYCLE_DIGITS)));
                rows.push(cells);
            }
        }
    }
    Ok(Table {
        name: "cycles".to_owned(),
        title: "Cycles of (20) without sticking: $a = 1$, $alpha = beta = T0 = 0.3$, $gamma = 0$".into(),
        columns: texts(columns),
        rows: rows.into_iter().map(texts).collect(),
        notes: texts([
            "not in the paper: to first order in $eps$, zeros of the work of friction along the orbits of (21)"
                .to_owned(),
            "where the largest $v$ is $v*$ sticking begins; a faster belt is never reached".to_owned(),
            "the cycles in the wells are born at $v* = sqrt(alpha/(3 beta))$, where the centres lose \
             their stability; $lambda < 0$: they attract"
                .to_owned(),
        ]),
    })
}

/// The equation of the data card.
pub(super) fn model() -> Result<Model, Error> {
    let equation: Expression = card::equation();
    Ok(Model::second_order(&equation)?.with_small("eps"))
}

/// The paper's values: the defaults of the data card (eps = 1: the paper names none).
pub(super) fn parameters() -> Result<Parameters, Error> {
    let mut parameters = Parameters::new();
    for card in card::problem().parameters {
        parameters.set(&card.name, Quantity::parse(&card.default).ok_or(Error::NoValue)?);
    }
    Ok(parameters)
}
