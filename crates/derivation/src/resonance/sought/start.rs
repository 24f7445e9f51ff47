//! With which mixture of cosine and sine a motion starts that a parameter keeps periodic.
//!
//! At z = (A/2) v, |v| = 1, the slow flow f(z; p_0 + eps p_1 + ...) vanishes. Order n of it is F_n(v) + c p_{n-1} with F_n
//! of the orders before, so p_{n-1} = -Re(F_n conj c)/|c|^2 where Im(F_n conj c) = 0. At the first order at which
//! that does not hold for every v, it is an equation for v: with the harmonics 0 and k alone a + 2 Re(g v^k) = 0, a
//! quadratic one for u = v^k.

use super::super::{ResonanceError, Terms};
use crate::error::DerivationError as Error;
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

fn square_root(q: &Rational) -> Option<Rational> {
    let exact = |n: &Integer| n.is_perfect_square().then(|| n.clone().sqrt());
    Some(Rational::from((exact(q.numer())?, exact(q.denom())?)))
}

/// The n-th root with rational parts of a w with |w| = 1, in lowest terms (p + i q)/r: r^n is the denominator of w.
fn root(w: &Complex, n: i32) -> Option<Complex> {
    let common = Integer::from(w[0].denom().lcm_ref(w[1].denom()));
    let r = common.root(n.unsigned_abs());
    let angle = w[1].to_f64().atan2(w[0].to_f64());
    let candidate = |j: i32| {
        let angle = (angle + std::f64::consts::TAU * f64::from(j)) / f64::from(n);
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

    /// With v^k = u, where nu and Omega are these multiples of one frequency.
    fn of(u: &Complex, k: i32, [nu, step]: [i32; 2]) -> Option<Self> {
        if let Some(direction) = root(u, k) {
            return Some(Self { direction, turn: real(1) });
        }
        // turn = v^(-step/nu).
        let product = nu.checked_mul(k)?;
        let common = Integer::from(product).gcd(&Integer::from(step)).to_i32()?;
        let turn = root(&power(u, -(step / common)), product / common)?;
        Some(Self { direction: real(1), turn })
    }
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

/// What finds the start of a motion in the slow flow.
pub(super) struct Search<'a> {
    /// f_0, f_1, ..., orders up to some order at a time.
    pub flow: &'a mut dyn FnMut(usize) -> Result<Vec<Terms>, Error>,
    /// The number of symbols, and the place of the parameter among them.
    pub symbols: (usize, usize),
    /// A.
    pub amplitude: &'a Rational,
    /// nu and Omega in multiples of one frequency.
    pub multiples: [i32; 2],
    /// The name of coefficient n - 1 of the parameter, of order n.
    pub name: &'a dyn Fn(usize) -> String,
}

impl Search<'_> {
    /// The starts, and the order that fixes them.
    pub(super) fn starts(&mut self, order: usize) -> Result<(Vec<Start>, usize), Error> {
        let symmetric = |n| Ok((Start::symmetric(), n));
        let width = self.symbols.0;
        let (mut flow, mut values) = (Vec::new(), Vec::<Polynomial>::new());
        for n in 1..=order {
            if flow.len() <= n {
                flow = (self.flow)((2 * n - 1).min(order))?;
            }
            let Some(terms) = flow.get(1..=n) else { break };
            let one = Polynomial::from([(vec![0; width], real(1))]);
            // Powers of p_0 + eps p_1 + ..., p_{n-1} being left out.
            let mut powers = vec![vec![one]];
            powers[0].resize(n, Polynomial::new());
            for j in 0..n {
                let mut row = vec![Polynomial::new(); n];
                for (m, sum) in row.iter_mut().enumerate() {
                    let pairs = values.iter().zip(powers[j][..=m].iter().rev());
                    pairs.for_each(|(p, rest)| add_product(sum, p, rest));
                }
                powers.push(row);
            }
            let mut sum = Polynomial::new();
            for (k, term) in
                terms.iter().enumerate().flat_map(|(k, f)| f.iter().map(move |t| (k, t)))
            {
                let (j, single) = self.on_circle(term);
                if let Some(power) = powers.get(j) {
                    add_product(&mut sum, &single, &power[n - 1 - k]);
                }
            }
            let slope = terms[0].iter().map(|t| self.on_circle(t)).filter(|(j, _)| *j == 1);
            let slope: Polynomial = slope.flat_map(|(_, single)| single).collect();
            let plain = slope.keys().all(|key| key[1..].iter().all(|e| *e == 0));
            let Some((_, c)) = slope.first_key_value().filter(|_| slope.len() == 1 && plain) else {
                return symmetric(1);
            };
            let size = c.iter().map(|part| part.clone().square()).sum::<Rational>();
            let mut ratio = Polynomial::new();
            add_product(&mut ratio, &sum, &mirrored(&slope));
            let part = |factor: Complex, sign: i32| {
                let mut sum = Polynomial::new();
                let constant = |c| Polynomial::from([(vec![0; width], c)]);
                add_product(&mut sum, &ratio, &constant(factor.clone()));
                let other = times(&factor, &real(sign));
                add_product(&mut sum, &mirrored(&ratio), &constant(other));
                sum
            };
            // -Re/|c|^2 and Im.
            let value = part(real(-(size * 2u32).recip()), 1);
            let aside = part([0.into(), (-1, 2).into()], -1);
            if !aside.is_empty() {
                return Ok((self.solved(n, &aside, &value)?, n));
            }
            if value.keys().any(|key| key[0] != 0) {
                return symmetric(n);
            }
            values.push(value);
        }
        symmetric(1)
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
        let harmonics: BTreeSet<i32> =
            aside.keys().map(|key| key[0].abs()).filter(|k| *k != 0).collect();
        let mixture = |k: i32, angles: &[f64]| {
            let (parameter, roots) = ((self.name)(n), decimals(value, k, angles).join(", "));
            Error::from(ResonanceError::Mixture { order: n, parameter, roots })
        };
        let no_value = || Error::from(ExpandError::NotBalanced { order: n });
        let at = |k: i32| aside.iter().filter(move |(key, _)| key[0] == k);
        let (k, roots) = match harmonics.iter().collect::<Vec<_>>()[..] {
            [] => return Err(no_value()),
            [&k] if at(0).next().is_none() => {
                let Some((_, g)) = at(k).next() else { return Err(no_value()) };
                let real_ratio = |c: &Complex| times(c, &conjugate(g))[1].is_zero();
                let size = g.iter().map(|part| part.clone().square()).sum::<Rational>();
                match square_root(&size).filter(|_| at(k).all(|(_, c)| real_ratio(c))) {
                    Some(size) => {
                        let u = times(&[0.into(), size.recip()], &conjugate(g));
                        (k, vec![u.clone(), u.map(|part| -part)])
                    }
                    None => return Err(mixture(k, &[])),
                }
            }
            [&k] => {
                let numbers = aside.keys().all(|key| key[1..].iter().all(|e| *e == 0));
                let (Some((_, a)), Some((_, g))) = (at(0).next().filter(|_| numbers), at(k).next())
                else {
                    return Err(mixture(k, &[]));
                };
                let size = g.iter().map(|part| part.clone().square()).sum::<Rational>();
                let half = Rational::from(&a[0] / -2);
                let square = size.clone() - half.clone().square();
                if square < 0 {
                    return Err(no_value());
                }
                let over = times(&conjugate(g), &real(size.recip()));
                let Some(side) = square_root(&square) else {
                    let side = square.to_f64().sqrt().atan2(half.to_f64());
                    let angle = |side| side + over[1].to_f64().atan2(over[0].to_f64());
                    return Err(mixture(k, &[angle(side), angle(-side)]));
                };
                let other = [half.clone(), Rational::from(-&side)];
                (k, vec![times(&[half, side], &over), times(&other, &over)])
            }
            _ => {
                let quarters = (0..4).map(|j| power(&[0.into(), 1.into()], j));
                let vanishes = |v: &Complex| {
                    let mut sum = Polynomial::new();
                    for (key, c) in aside {
                        let at = [(key[1..].to_vec(), times(c, &power(v, key[0])))].into();
                        let one = [(vec![0; key.len() - 1], real(1))].into();
                        add_product(&mut sum, &at, &one);
                    }
                    sum.is_empty()
                };
                (1, quarters.filter(vanishes).collect())
            }
        };
        let mut roots = roots;
        // The cosine first.
        roots.sort_by(|a, b| b.cmp(a));
        roots.dedup();
        let found = roots.iter().map(|u| Start::of(u, k, self.multiples));
        let found: Option<Vec<_>> = found.collect();
        let angles: Vec<_> = roots.iter().map(|u| u[1].to_f64().atan2(u[0].to_f64())).collect();
        found.filter(|list| !list.is_empty()).ok_or_else(|| mixture(k, &angles))
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
