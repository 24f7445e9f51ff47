//! A truncated slow flow and the equations it belongs to, as systems of first order to integrate.
//!
//! At one value of the small parameter, z_j = u_j + i v_j: u_j', v_j' from z_j' = i nu_j z_j + sum eps^n f_{j,n},
//! and x_j from them, or where its series is asked for by its rate D x_j along that flow, D as in [`lindstedt_expand::resonance`].

use super::forces::with_phases;
use super::{AlgebraicModes, Phase, SlowFlow, Terms};
use lindstedt_coeff::constant;
use lindstedt_equation::{Expression, Function, Unknown};
use lindstedt_number::Exact;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational, ops::Pow};
use std::collections::BTreeMap;
use std::ops::{AddAssign, MulAssign, SubAssign};

/// Polynomials in z_1, zbar_1, ..., E, or in u_1, v_1, ..., E: complex coefficients by exponents.
type Polynomial = BTreeMap<Vec<i32>, [Rational; 2]>;

/// y' = rates(y, t), y(0) = start.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The names of the states.
    pub names: Vec<String>,
    /// Their rates in these names and t; none where there are delays.
    pub rates: Vec<Expression>,
    /// Their values at t = 0.
    pub start: Vec<Rational>,
}

/// x_1, x_2, ... in z_1, zbar_1, ... and t, of the modes where there are shapes.
#[derive(Clone, Debug)]
pub struct Positions {
    list: Vec<Polynomial>,
    /// eta_1', eta_2', ...
    rates: Vec<Rational>,
}

impl Positions {
    /// Their values at u_1, v_1, ... and t, to the precision of t.
    #[must_use]
    pub fn at(&self, state: &[Float], time: &Float) -> Vec<Float> {
        let bits = time.prec();
        let pair = |w: &[Float]| [[w[0].clone(), w[1].clone()], [w[0].clone(), -w[1].clone()]];
        let z: Vec<[Float; 2]> = state.chunks_exact(2).flat_map(pair).collect();
        let term = |(key, c): (&Vec<i32>, &[Rational; 2])| {
            let (powers, turns) = key.split_at(z.len());
            let turns = turns.iter().zip(&self.rates);
            let rate: Rational = turns.map(|(m, rate)| Rational::from(rate * *m)).sum();
            let (sin, cos) = (Float::with_val(bits, rate) * time).sin_cos(Float::new(bits));
            let c = c.each_ref().map(|c| Float::with_val(bits, c));
            let all = z.iter().zip(powers);
            let all = all.flat_map(|(z, n)| std::iter::repeat_n(z, n.unsigned_abs() as usize));
            let [re, _] = all.fold(times(&c, &[cos, sin]), |product, z| times(&product, z));
            re
        };
        let sum = |x: &Polynomial| x.iter().map(term).fold(Float::new(bits), |sum, x| sum + x);
        self.list.iter().map(sum).collect()
    }
}

/// Values of the symbols and of the small parameter.
struct At<'a> {
    flow: &'a SlowFlow,
    small: &'a Rational,
    symbols: Vec<Rational>,
    /// That of the unit.
    unit: Rational,
    /// eta_l(0) where one is not 0.
    starts: Option<Vec<Ball>>,
}

/// Bits of constants that are irrational: they are rational numbers within 2^-200 here.
fn balls() -> Balls {
    Balls::new(320)
}

fn nearby(ball: &Ball) -> Option<Rational> {
    ball.midpoint().to_rational()
}

fn add(sum: &mut Polynomial, key: Vec<i32>, [re, im]: [Rational; 2]) {
    let entry = sum.entry(key).or_default();
    entry[0] += re;
    entry[1] += im;
}

fn times<T>([a, b]: &[T; 2], [c, d]: &[T; 2]) -> [T; 2]
where
    T: Clone + for<'a> MulAssign<&'a T> + AddAssign + SubAssign,
{
    let product = |x: &T, y: &T| {
        let mut product = x.clone();
        product *= y;
        product
    };
    let (mut re, mut im) = (product(a, c), product(a, d));
    re -= product(b, d);
    im += product(b, c);
    [re, im]
}

fn product(f: &Polynomial, g: &Polynomial) -> Polynomial {
    let mut sum = Polynomial::new();
    for (v, a) in f {
        for (w, b) in g {
            add(&mut sum, v.iter().zip(w).map(|(v, w)| v + w).collect(), times(a, b));
        }
    }
    sum
}

impl At<'_> {
    /// e^{i sum m_l eta_l(0)}.
    fn turned(&self, turns: &[i32]) -> Option<[Rational; 2]> {
        let starts = self.starts.as_ref()?;
        let add = |sum: Ball, (m, start): (&i32, &Ball)| {
            balls().add(&sum, &balls().mul_i64(start, i64::from(*m)))
        };
        let angle = turns.iter().zip(starts).fold(balls().from_rational(&Rational::new()), add);
        Some([nearby(&balls().cos(&angle))?, nearby(&balls().sin(&angle))?])
    }

    /// sum eps^n of a list of orders, E_l being e^{i (eta_l - eta_l(0))}.
    fn sum(&self, orders: &[Terms], first: u32) -> Polynomial {
        let phases = self.flow.first_symbol();
        let mut sum = Polynomial::new();
        for (n, term) in
            (first..).zip(orders).flat_map(|(n, terms)| terms.iter().map(move |t| (n, t)))
        {
            let (phase, exponents) = term.exponents.split_at(phases);
            let mut size = Rational::from(self.small.pow(n));
            for (value, n) in self.symbols.iter().zip(exponents) {
                size *= Rational::from(value.pow(*n));
            }
            let parts = [&term.re, &term.im].map(|c| Rational::from(c * &size));
            let turned = self.turned(&phase[2 * self.flow.unknowns()..]);
            let parts = turned.map_or(parts.clone(), |turned| times(&parts, &turned));
            add(&mut sum, phase.to_vec(), parts);
        }
        sum
    }

    /// eta_l'.
    fn force_rate(&self, l: usize) -> Rational {
        let detuning = self.flow.detuning.get(l).map_or_else(Polynomial::new, |d| self.sum(d, 1));
        let leading = self.flow.system.forces.get(l).and_then(Phase::number);
        detuning.into_values().map(|[re, _]| re).sum::<Rational>()
            + leading.unwrap_or_default() * &self.unit
    }

    fn force_rates(&self) -> Vec<Rational> {
        (0..self.flow.forces()).map(|l| self.force_rate(l)).collect()
    }

    /// z_1', z_2', ...
    fn flows(&self) -> Vec<Polynomial> {
        self.flow.flow.iter().map(|orders| self.sum(orders, 0)).collect()
    }

    /// D x, whose real part is the rate.
    fn rate(&self, x: &Polynomial, flows: &[Polynomial]) -> Polynomial {
        let first = 2 * flows.len();
        let turns = self.force_rates();
        let mut sum = Polynomial::new();
        for (key, c) in x {
            let turns = key[first..].iter().zip(&turns);
            let m = turns.map(|(m, turn)| Rational::from(turn * *m)).sum();
            add(&mut sum, key.clone(), times(c, &[Rational::new(), m]));
        }
        for (j, flow) in flows.iter().enumerate() {
            // d/dz_j, twice its real part.
            let slope = x.iter().filter(|(key, _)| key[2 * j] != 0).map(|(key, c)| {
                let mut lower = key.clone();
                lower[2 * j] -= 1;
                (lower, c.each_ref().map(|c| Rational::from(c * (2 * key[2 * j]))))
            });
            for (key, c) in product(&slope.collect(), flow) {
                add(&mut sum, key, c);
            }
        }
        sum
    }
}

/// The real part at z_j = zbar_j = half and E = 1.
fn at_start(f: &Polynomial, unknowns: usize, half: &Rational) -> Rational {
    let size = |key: &Vec<i32>| key[..2 * unknowns].iter().sum::<i32>();
    f.iter().map(|(key, [re, _])| Rational::from(half.pow(size(key))) * re).sum()
}

/// The polynomial in the u and v of so many unknowns.
fn cartesian(f: &Polynomial, unknowns: usize) -> Polynomial {
    let mut sum = Polynomial::new();
    for (key, c) in f {
        let last = 2 * unknowns;
        let mut constant = vec![0; key.len()];
        constant[last..].copy_from_slice(&key[last..]);
        let mut part = Polynomial::from([(constant, c.clone())]);
        for (i, n) in key[..last].iter().enumerate() {
            let unit = |i: usize| (0..key.len()).map(|k| i32::from(k == i)).collect::<Vec<_>>();
            let sign = Rational::from(if i % 2 == 0 { 1 } else { -1 });
            let (even, odd) = (i - i % 2, i - i % 2 + 1);
            let factor = Polynomial::from([
                (unit(even), [Rational::from(1), Rational::new()]),
                (unit(odd), [Rational::new(), sign]),
            ]);
            part = (0..*n).fold(part, |part, _| product(&part, &factor));
        }
        part.into_iter().for_each(|(key, c)| add(&mut sum, key, c));
    }
    sum
}

/// The real (0) or imaginary (1) part as an expression, with E_l = e^{i rate_l t}.
fn tree(f: &Polynomial, part: usize, names: &[String], rates: &[Rational]) -> Expression {
    let mut sum = Vec::new();
    for (key, [re, im]) in f {
        let (powers, turns) = key.split_at(key.len() - rates.len());
        let m: Rational = turns.iter().zip(rates).map(|(m, q)| Rational::from(q * *m)).sum();
        let angle = || Expression::Number(m.clone()) * Expression::Time;
        // (re + i im)(cos + i sin).
        let [cos, sin] =
            if part == 0 { [re.clone(), -im.clone()] } else { [im.clone(), re.clone()] };
        for (c, function) in [(cos, Function::Cos), (sin, Function::Sin)] {
            if c.is_zero() || m.is_zero() && function == Function::Sin {
                continue;
            }
            let mut factors = vec![Expression::Number(c)];
            let powers = names.iter().zip(powers).filter(|(_, n)| **n != 0);
            factors.extend(powers.map(|(name, n)| Expression::parameter(name).pow(i64::from(*n))));
            if !m.is_zero() {
                factors.push(angle().apply(function));
            }
            sum.push(Expression::Product(factors).canonical());
        }
    }
    Expression::Sum(sum).canonical()
}

impl SlowFlow {
    /// The truncated slow flow from z_j = amplitude/2 as a system in u_1, v_1, ..., and the equations themselves from the
    /// same x_j(0) and x_j'(0) as one in x_1, w_1 = x_1', ...; of the modes where there are shapes. Nothing where a symbol has
    /// no value.
    #[must_use]
    pub fn motions(
        &self,
        small: &Rational,
        values: &dyn Fn(&str) -> Option<Rational>,
        amplitude: &Rational,
    ) -> Option<[Motion; 2]> {
        let at = self.at(small, values)?;
        let unknowns = self.unknowns();
        let names: Vec<String> =
            (1..=unknowns).flat_map(|j| [format!("u_{j}"), format!("v_{j}")]).collect();
        let flows = at.flows();
        let turns = at.force_rates();
        let mut rates = Vec::new();
        for flow in flows.iter().map(|flow| cartesian(flow, unknowns)) {
            rates.extend([0, 1].map(|part| tree(&flow, part, &names, &turns)));
        }
        let half = Rational::from(amplitude / 2);
        let mut start = Vec::new();
        for orders in &self.solution {
            let x = at.sum(orders, 0);
            start.extend([&x, &at.rate(&x, &flows)].map(|f| at_start(f, unknowns, &half)));
        }
        let names_of = |j: usize| [format!("x_{}", j + 1), format!("w_{}", j + 1)];
        let full = Motion {
            names: (0..unknowns).flat_map(names_of).collect(),
            rates: self.in_time(&at, values)?,
            start,
        };
        let zero = Rational::new;
        let start = (0..unknowns).flat_map(|_| [half.clone(), zero()]).collect();
        Some([Motion { names, rates, start }, full])
    }

    /// The x_j along it; nothing where a symbol has no value.
    #[must_use]
    pub fn positions(
        &self,
        small: &Rational,
        values: &dyn Fn(&str) -> Option<Rational>,
    ) -> Option<Positions> {
        let at = self.at(small, values)?;
        let list = self.solution.iter().map(|orders| at.sum(orders, 0)).collect();
        Some(Positions { list, rates: at.force_rates() })
    }

    /// The truncated slow flow of [`Self::motions`] with x_1, ... as further states.
    #[must_use]
    pub fn with_positions(
        &self,
        small: &Rational,
        values: &dyn Fn(&str) -> Option<Rational>,
        slow: &Motion,
    ) -> Option<Motion> {
        let (at, unknowns, mut all) = (self.at(small, values)?, self.unknowns(), slow.clone());
        let (flows, turns, half) = (at.flows(), at.force_rates(), slow.start.first()?);
        for (j, orders) in self.solution.iter().enumerate() {
            let x = at.sum(orders, 0);
            let rate = cartesian(&at.rate(&x, &flows), unknowns);
            all.rates.push(tree(&rate, 0, &slow.names, &turns));
            all.start.push(at_start(&x, unknowns, half));
            all.names.push(format!("x_{}", j + 1));
        }
        Some(all)
    }

    fn at<'a>(
        &'a self,
        small: &'a Rational,
        values: &dyn Fn(&str) -> Option<Rational>,
    ) -> Option<At<'a>> {
        let beside = self.system.beside.as_ref();
        let exact = |name: &str| values(name).map(Exact::Rational);
        let unit = nearby(&self.system.unit_value(&exact, balls())?)?;
        let symbol = |name: &String| match beside.filter(|beside| beside.symbol == *name) {
            Some(beside) => Some((&beside.rate - self.system.force()) * &unit / small),
            None => self.constant(name, values),
        };
        let symbols: Vec<_> = self.system.symbols.iter().map(symbol).collect::<Option<_>>()?;
        let starts = self.system.forces.iter().map(|phase| self.angle(&phase.start, values));
        let starts = starts.collect::<Option<Vec<_>>>()?;
        let starts = Some(starts).filter(|all| all.iter().any(|start| !start.contains_zero()));
        Some(At { flow: self, small, symbols, unit, starts })
    }

    /// eta_l'; nothing where a symbol has no value.
    #[must_use]
    pub fn force_rate(
        &self,
        l: usize,
        small: &Rational,
        values: &dyn Fn(&str) -> Option<Rational>,
    ) -> Option<Rational> {
        Some(self.at(small, values)?.force_rate(l))
    }

    /// The longest delay, from above.
    #[must_use]
    pub fn longest_delay(&self, values: &dyn Fn(&str) -> Option<Rational>) -> Option<Rational> {
        let nodes = self.system.equations.iter().flat_map(Expression::nodes);
        let delays = nodes.filter_map(Expression::delay);
        delays.filter_map(|delay| self.angle(delay, values)?.upper().to_rational()).max()
    }

    /// A constant by its name.
    fn constant(&self, name: &str, values: &dyn Fn(&str) -> Option<Rational>) -> Option<Rational> {
        let exact = |name: &str| values(name).map(Exact::Rational);
        let pi = || (name == "pi").then(|| balls().pi());
        let wave = || self.system.wave(name, &exact, balls()).or_else(pi);
        values(name).or_else(|| nearby(&wave()?))
    }

    /// A constant angle.
    fn angle(&self, angle: &Expression, values: &dyn Fn(&str) -> Option<Rational>) -> Option<Ball> {
        let value = |name: &str| {
            let pi = (name == "pi").then(|| balls().pi());
            Some(Enclosure(pi.or_else(|| Some(balls().from_rational(&values(name)?)))?))
        };
        Some(constant(&BallRing { balls: balls() }, angle, &value)?.0)
    }

    /// x_j' = w_j, w_j' = ... from the equations, with numbers for all names; none where there are delays.
    fn in_time(
        &self,
        at: &At<'_>,
        values: &dyn Fn(&str) -> Option<Rational>,
    ) -> Option<Vec<Expression>> {
        // One unknown: as it was written, with its own force.
        let single = self.unknowns() == 1;
        let written = [self.problem.equation.clone()];
        let late = |e: &Expression| matches!(e, Expression::Unknown(x) if x.delay.is_some());
        if self.system.equations.iter().any(|e| e.nodes().any(late)) {
            return Some(Vec::new());
        }
        let equations = if single { &written[..] } else { &self.system.equations };
        let modes = self.system.algebraic.as_ref().map(AlgebraicModes::nearby);
        let of_modes = |name: &str| modes.as_ref()?.get(name).cloned();
        let change = |e: &Expression| match e {
            Expression::Small => Some(Expression::Number(at.small.clone())),
            Expression::Parameter(name) => {
                self.constant(name, values).or_else(|| of_modes(name)).map(Expression::Number)
            }
            Expression::Unknown(Unknown { index, derivative, delay: None }) => {
                let letter = if *derivative == 0 { "x" } else { "w" };
                Some(Expression::parameter(&format!("{letter}_{}", index + 1)))
            }
            _ => None,
        };
        let in_time = |l: usize| {
            let start = self.system.forces.get(l)?.start.map(&change);
            Some(Expression::Number(at.force_rate(l)) * Expression::Time + start)
        };
        let mut rates = Vec::new();
        for (j, equation) in equations.iter().enumerate() {
            let acceleration = Expression::unknown(j, 2);
            let rest: Vec<_> =
                equation.terms().iter().filter(|term| **term != acceleration).cloned().collect();
            let right = (-Expression::Sum(rest)).map(&change);
            let right = with_phases(&right, &in_time).canonical();
            let unset = |name: &String| !name.starts_with("x_") && !name.starts_with("w_");
            if right.parameters().iter().any(unset) {
                return None;
            }
            rates.extend([Expression::parameter(&format!("w_{}", j + 1)), right]);
        }
        Some(rates)
    }
}
