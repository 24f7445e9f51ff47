//! With which mixture of cosine and sine a motion starts that a parameter keeps periodic.
//!
//! At z = (A/2) v, |v| = 1, the slow flow f(z; p_0 + eps p_1 + ...) vanishes. Order n of it is F_n(v) + c p_{n-1} with F_n
//! of the orders before, so p_{n-1} = -Re(F_n conj c)/|c|^2 where Im(F_n conj c) = 0. At the first order at which
//! that does not hold for every v, it is an equation for v: with the harmonics 0 and k alone a + 2 Re(g v^k) = 0, a
//! quadratic one for u = v^k.

use super::super::forces::harmonic;
use super::super::{ResonanceError, Terms};
use crate::error::DerivationError as Error;
use lindstedt_equation::Expression;
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_expand::ExpandError;
use rug::ops::Pow;
use rug::{Integer, Rational};
use std::collections::{BTreeMap, BTreeSet};

/// A complex number with rational parts; of a start |.| = 1.
pub(super) type Complex = [Rational; 2];

fn real(q: impl Into<Rational>) -> Complex {
    [q.into(), Rational::new()]
}

fn times(a: &Complex, b: &Complex) -> Complex {
    let [re, im] = [Rational::from(&a[0] * &b[0]), Rational::from(&a[0] * &b[1])];
    [re - Rational::from(&a[1] * &b[1]), im + Rational::from(&a[1] * &b[0])]
}

fn conjugate([re, im]: &Complex) -> Complex {
    [re.clone(), Rational::from(-im)]
}

/// w^n for |w| = 1.
pub(super) fn power(w: &Complex, n: i32) -> Complex {
    let w = if n < 0 { conjugate(w) } else { w.clone() };
    (0..n.unsigned_abs()).fold(real(1), |product, _| times(&product, &w))
}

fn square(c: &Complex) -> Rational {
    c.iter().map(|part| part.clone().square()).sum()
}

fn angle(c: &Complex) -> f64 {
    c[1].to_f64().atan2(c[0].to_f64())
}

fn square_root(q: &Rational) -> Option<Rational> {
    let exact = |n: &Integer| n.is_perfect_square().then(|| n.clone().sqrt());
    Some(Rational::from((exact(q.numer())?, exact(q.denom())?)))
}

/// The n-th root with rational parts of a w with |w| = 1, in lowest terms (p + i q)/r: r^n is the denominator of w.
fn root(w: &Complex, n: i32) -> Option<Complex> {
    let common = Integer::from(w[0].denom().lcm_ref(w[1].denom()));
    let r = common.root(n.unsigned_abs());
    let candidate = |j: i32| {
        let angle = (angle(w) + std::f64::consts::TAU * f64::from(j)) / f64::from(n);
        let part =
            |x: f64| Some(Rational::from((Integer::from_f64((x * r.to_f64()).round())?, &r)));
        let z = [part(angle.cos())?, part(angle.sin())?];
        (power(&z, n) == *w).then_some(z)
    };
    let order = |a: &Complex, b: &Complex| (&a[0], &b[1]).cmp(&(&b[0], &a[1]));
    (0..n).filter_map(candidate).max_by(order)
}

/// A motion starts as A Re(direction e^{i nu t}), t being counted so that the forces' e^{i Omega t} is `turn` times as
/// large.
#[derive(Clone)]
pub(super) struct Start {
    pub direction: Complex,
    pub turn: Complex,
}

impl Start {
    /// The cosine and the sine.
    pub(super) fn symmetric() -> Vec<Self> {
        let both = [real(1), [0.into(), (-1).into()]];
        both.map(|direction| Self { direction, turn: real(1) }).into()
    }

    /// With v^k = u, where nu and Omega are these multiples of one frequency; of a linear equation, where k = 2, a multiple of
    /// v is 1 + u, since (1 + u)^2 = u |1 + u|^2.
    fn of(u: &Complex, k: i32, [nu, step]: [i32; 2], linear: bool) -> Option<Self> {
        if let Some(direction) = root(u, k) {
            return Some(Self { direction, turn: real(1) });
        }
        // turn = v^(-step/nu).
        let turned = || {
            let product = nu.checked_mul(k)?;
            let common = Integer::from(product).gcd(&Integer::from(step)).to_i32()?;
            let turn = root(&power(u, -(step / common)), product / common)?;
            Some(Self { direction: real(1), turn })
        };
        let multiple = || {
            let direction = [Rational::from(&u[0] + 1u32), u[1].clone()];
            (linear && k == 2).then(|| Self { direction, turn: real(1) })
        };
        turned().or_else(multiple)
    }
}

/// The starts, the order that fixes them, and whether these are all.
pub(super) struct Starts {
    pub list: Vec<Start>,
    pub order: usize,
    pub all: bool,
}

/// Whether a term z^p zbar^q E^m, m != 0, of these orders can choose a start, nu and Omega being these multiples of one
/// frequency: resonant ones have |m| >= nu and |p - q - 1| >= Omega. With terms eps^k x^d E^h, by the largest
/// (d - 1)/k and h/k, order n has p + q <= l = 1 + n (d - 1)/k and |m| <= n h/k + l h_0, h_0 of the force at order zero.
/// For linear equations: whether 2 nu is a whole multiple of Omega.
pub(super) fn may_choose(equation: &Expression, order: usize, [nu, step]: [i32; 2]) -> bool {
    let Some(all) = expand(equation) else { return true };
    let (mut degree, mut force, mut first) = (Rational::new(), Rational::new(), 0);
    for m in all.terms.keys() {
        let (mut d, mut h) = (m.x + m.velocity, 0);
        for (name, n) in &m.parameters {
            let wave = all.atoms.get(name).and_then(harmonic);
            h += wave.map_or(0, |(_, _, harmonic)| (harmonic * n).unsigned_abs());
        }
        for (name, n) in &m.atoms {
            let Some(Expression::Unknown(_)) = all.atoms.get(name) else { return true };
            d += n;
        }
        match m.order {
            0 => first = h.max(first),
            k => {
                degree = degree.max(Rational::from((d.saturating_sub(1), k)));
                force = force.max(Rational::from((h, k)));
            }
        }
    }
    let leaves = degree * order + 1u32;
    leaves.clone() + 1u32 >= step && force * order + leaves * first >= nu
}

/// Whether every term has one factor of x, x' or x'' and is none of a force.
pub(super) fn is_linear(equation: &Expression) -> bool {
    let Some(all) = expand(equation) else { return false };
    let others = |m: &Monomial| -> u32 {
        let unknown = |name: &String| matches!(all.atoms.get(name), Some(Expression::Unknown(_)));
        m.atoms.iter().filter(|(name, _)| unknown(name)).map(|(_, n)| n).sum()
    };
    all.terms.keys().all(|m| m.x + m.velocity + others(m) == 1)
}

/// A polynomial: the exponents of v and of the symbols.
type Polynomial = BTreeMap<Vec<i32>, Complex>;

fn add_product(sum: &mut Polynomial, a: &Polynomial, b: &Polynomial) {
    for (m, c) in a {
        for (n, d) in b {
            let key = m.iter().zip(n).map(|(m, n)| m + n).collect();
            let entry = sum.entry(key).or_insert_with(|| real(0));
            let product = times(c, d);
            entry.iter_mut().zip(product).for_each(|(entry, part)| *entry += part);
        }
    }
    sum.retain(|_, c| c.iter().any(|part| !part.is_zero()));
}

/// The conjugate on the circle.
fn mirrored(f: &Polynomial) -> Polynomial {
    let mirror = |key: &Vec<i32>| [&[-key[0]], &key[1..]].concat();
    f.iter().map(|(key, c)| (mirror(key), conjugate(c))).collect()
}

/// factor f and, times a sign, its conjugate.
fn part(f: &Polynomial, factor: &Complex, sign: i32) -> Polynomial {
    let mut sum = Polynomial::new();
    for (f, factor) in [(f, factor.clone()), (&mirrored(f), times(factor, &real(sign)))] {
        let width = f.keys().next().map_or(1, Vec::len);
        add_product(&mut sum, f, &[(vec![0; width], factor)].into());
    }
    sum
}

/// What finds the start of a motion in the slow flow.
pub(super) struct Search<'a> {
    /// f_0, f_1, ..., orders up to some order at a time.
    pub flow: &'a mut dyn FnMut(usize) -> Result<Vec<Terms>, Error>,
    /// The number of symbols, and the place of the parameter among them.
    pub symbols: (usize, usize),
    /// Whether a multiple of a motion is one.
    pub linear: bool,
    /// A.
    pub amplitude: &'a Rational,
    /// nu and Omega in multiples of one frequency.
    pub multiples: [i32; 2],
    /// The name of coefficient n - 1 of the parameter, of order n.
    pub name: &'a dyn Fn(usize) -> String,
}

impl Search<'_> {
    /// The starts, and the order that fixes them.
    pub(super) fn starts(&mut self, order: usize) -> Result<Starts, Error> {
        let (mut flow, mut values) = (Vec::new(), Vec::<Polynomial>::new());
        for n in 1..=order {
            if flow.len() <= n {
                flow = (self.flow)((2 * n - 1).min(order))?;
            }
            let Some(terms) = flow.get(1..=n) else { break };
            let slope = terms[0].iter().map(|t| self.on_circle(t)).filter(|(j, _)| *j == 1);
            let slope: Polynomial = slope.flat_map(|(_, single)| single).collect();
            let plain = slope.keys().all(|key| key[1..].iter().all(|e| *e == 0));
            let Some((_, c)) = slope.first_key_value().filter(|_| slope.len() == 1 && plain) else {
                break;
            };
            let mut ratio = Polynomial::new();
            add_product(&mut ratio, &self.without_last(terms, &values), &mirrored(&slope));
            // -Re/|c|^2 and Im.
            let value = part(&ratio, &real(-(square(c) * 2u32).recip()), 1);
            let aside = part(&ratio, &[0.into(), (-1, 2).into()], -1);
            if !aside.is_empty() {
                let harmonics = aside.keys().map(|key| key[0]).filter(|k| *k > 0);
                let all = harmonics.collect::<BTreeSet<_>>().len() == 1;
                return Ok(Starts { list: self.solved(n, &aside, &value)?, order: n, all });
            }
            if value.keys().any(|key| key[0] != 0) {
                break;
            }
            values.push(value);
        }
        Ok(Starts { list: Start::symmetric(), order: 1, all: true })
    }

    /// F_n from f_1, ..., f_n and p_0, ..., p_{n-2}.
    fn without_last(&self, flow: &[Terms], values: &[Polynomial]) -> Polynomial {
        let n = flow.len();
        let mut powers = vec![vec![Polynomial::new(); n]];
        powers[0][0] = [(vec![0; self.symbols.0], real(1))].into();
        for j in 0..n {
            let mut row = vec![Polynomial::new(); n];
            for (m, sum) in row.iter_mut().enumerate() {
                let pairs = values.iter().zip(powers[j][..=m].iter().rev());
                pairs.for_each(|(p, rest)| add_product(sum, p, rest));
            }
            powers.push(row);
        }
        let mut sum = Polynomial::new();
        for (k, f) in flow.iter().enumerate() {
            for (j, single) in f.iter().map(|term| self.on_circle(term)) {
                if let Some(power) = powers.get(j) {
                    add_product(&mut sum, &single, &power[n - 1 - k]);
                }
            }
        }
        sum
    }

    /// The power of the parameter in a term, and the rest of it at z = (A/2) v, E = 1.
    fn on_circle(&self, term: &lindstedt_phase::amplitudes::AmplitudeTerm) -> (usize, Polynomial) {
        let [z, zbar, _, symbols @ ..] = &term.exponents[..] else { return (0, Polynomial::new()) };
        let half = Rational::from(self.amplitude / 2u32).pow(z + zbar);
        let place = self.symbols.1;
        let rest = symbols.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, e)| *e);
        let key = std::iter::once(z - zbar).chain(rest).collect();
        let c = [&term.re, &term.im].map(|part| Rational::from(part * &half));
        (symbols[place].unsigned_abs() as usize, [(key, c)].into())
    }

    /// The starts at which `aside` vanishes.
    fn solved(
        &self,
        n: usize,
        aside: &Polynomial,
        value: &Polynomial,
    ) -> Result<Vec<Start>, Error> {
        let harmonics = aside.keys().map(|key| key[0]).filter(|k| *k > 0);
        let harmonics: Vec<i32> = harmonics.collect::<BTreeSet<_>>().into_iter().collect();
        let (k, roots) = match harmonics[..] {
            [] => (1, Roots::None),
            [k] => (k, quadratic(aside, k)),
            _ => (1, quarters(aside)),
        };
        let mixture = |angles: &[f64]| {
            let (parameter, roots) = ((self.name)(n), decimals(value, k, angles).join(", "));
            Error::from(ResonanceError::Mixture { order: n, parameter, roots })
        };
        let mut roots = match roots {
            Roots::None => return Err(ExpandError::NotBalanced { order: n }.into()),
            Roots::Irrational(angles) => return Err(mixture(&angles)),
            Roots::Rational(roots) => roots,
        };
        // The cosine first.
        roots.sort_by(|a, b| b.cmp(a));
        roots.dedup();
        let found: Option<_> =
            roots.iter().map(|u| Start::of(u, k, self.multiples, self.linear)).collect();
        found.ok_or_else(|| mixture(&roots.iter().map(angle).collect::<Vec<_>>()))
    }
}

/// The roots u = v^k of a + 2 Re(g u) = 0; of irrational ones the angles, where there are no symbols.
enum Roots {
    None,
    Irrational(Vec<f64>),
    Rational(Vec<Complex>),
}

fn quadratic(aside: &Polynomial, k: i32) -> Roots {
    let at = |k: i32| aside.iter().filter(move |(key, _)| key[0] == k);
    let Some((_, g)) = at(k).next() else { return Roots::None };
    let half = at(0).next().map(|(_, a)| Rational::from(&a[0] / -2)).unwrap_or_default();
    // Without a, g may be one complex number times a real polynomial.
    let one = |c: &Complex| half.is_zero() && times(c, &conjugate(g))[1].is_zero();
    if !at(k).all(|(_, c)| one(c)) && aside.keys().any(|key| key[1..].iter().any(|e| *e != 0)) {
        return Roots::Irrational(Vec::new());
    }
    let gap = square(g) - half.clone().square();
    if gap < 0 {
        return Roots::None;
    }
    let over = times(&conjugate(g), &real(square(g).recip()));
    match square_root(&gap) {
        Some(side) => {
            let both = [side.clone(), -side].map(|side| times(&[half.clone(), side], &over));
            Roots::Rational(both.into())
        }
        None => {
            let side = gap.to_f64().sqrt().atan2(half.to_f64());
            Roots::Irrational(vec![angle(&over) + side, angle(&over) - side])
        }
    }
}

/// The quarters of a turn among the roots of several harmonics.
fn quarters(aside: &Polynomial) -> Roots {
    let vanishes = |v: &Complex| {
        let mut sum = Polynomial::new();
        for (key, c) in aside {
            let still = std::iter::once(0).chain(key[1..].iter().copied()).collect();
            let one = [(vec![0; key.len()], real(1))].into();
            add_product(&mut sum, &[(still, times(c, &power(v, key[0])))].into(), &one);
        }
        sum.is_empty()
    };
    let quarters = (0..4).map(|j| power(&[0.into(), 1.into()], j));
    match quarters.filter(vanishes).collect::<Vec<_>>() {
        roots if roots.is_empty() => Roots::Irrational(Vec::new()),
        roots => Roots::Rational(roots),
    }
}

/// The values at v^k = e^{i angle}, in decimals, where they have no symbols.
fn decimals(value: &Polynomial, k: i32, angles: &[f64]) -> Vec<String> {
    if value.keys().any(|key| key[1..].iter().any(|e| *e != 0)) {
        return Vec::new();
    }
    let at = |angle: &f64| {
        let term = |(key, c): (&Vec<i32>, &Complex)| {
            let angle = angle * f64::from(key[0]) / f64::from(k);
            c[0].to_f64() * angle.cos() - c[1].to_f64() * angle.sin()
        };
        format!("{:.6}", value.iter().map(term).sum::<f64>())
    };
    angles.iter().map(at).collect()
}
