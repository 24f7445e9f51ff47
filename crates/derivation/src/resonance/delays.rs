//! Delays of terms of order eps: what they turn the phases by, e^{-i lambda T}.
//!
//! Delays whose ratios are rational are whole multiples of one, T_0, and the parts of all rates in one generator g (1, an
//! irrational root, an independent frequency) those of one number q. So every e^{-i lambda T} is a product of powers of some
//! W = e^{i q g T_0}, which are constant phases of the algebra: exact for every T, given or not. In what is handed out every
//! product of their powers, e^{i theta}, is cos(theta) + i sin(theta) with these two as symbols, each to the first power:
//! equal sums are equal as data, and nothing cancels that does not cancel by itself, where powers of cos(q g T_0) would have
//! coefficients that grow like 2^k with alternating signs. Where theta is a number of quarters of a turn they are numbers.

use super::forces::{Angles as Named, named, quarters, wave_names};
use super::{System, Terms, Unit, collected};
use lindstedt_algebra::{Ring, common_measure};
use lindstedt_coeff::constant;
use lindstedt_equation::Expression;
use lindstedt_equation::monomials::{Monomials, expand};
use lindstedt_expand::{Excitation, ExpandError};
use lindstedt_number::Exact;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::amplitudes::scalars::Scalars;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm, Amplitudes, Late, Rates};
use rug::Rational;
use std::collections::BTreeMap;

/// A delay: `multiple` times T_0 of the number `base`.
struct Delay {
    time: Expression,
    base: usize,
    multiple: Rational,
}

/// The angle q g T_0.
struct Turn {
    base: usize,
    generator: usize,
    q: Rational,
    angle: Expression,
    /// So many quarters of a turn.
    quarters: Option<i64>,
}

/// The delays of equations with the angles that they turn phases by.
pub(super) struct Delays {
    delays: Vec<Delay>,
    turns: Vec<Turn>,
}

fn ratio(a: &Monomials, b: &Monomials) -> Option<Rational> {
    let (name, q) = a.terms.first_key_value()?;
    let ratio = Rational::from(q / b.terms.get(name)?);
    let holds = |(name, q): (&_, &Rational)| {
        b.terms.get(name).is_some_and(|other| *q == Rational::from(&ratio * other))
    };
    (a.terms.len() == b.terms.len() && a.terms.iter().all(holds)).then_some(ratio)
}

/// The value of a constant expression in an algebra.
type Constant<'a, S> =
    dyn Fn(&Amplitudes<S>, &Expression) -> Option<AmplitudeElement<<S as Scalars>::Element>> + 'a;

impl Delays {
    /// Of equations, with the generators of rates as expressions, 1 left out, and the unit.
    pub(super) fn of<E>(
        equations: &[Expression],
        rates: &Rates<E>,
        generators: &[Expression],
        unit: Option<&Unit>,
    ) -> Result<Self, ExpandError> {
        let times = Excitation::of(&Expression::Sum(equations.to_vec()))?.delays;
        let mut bases: Vec<(Expression, Rational)> = Vec::new();
        let mut delays = Vec::new();
        // A root stands in a delay and in a frequency: a delay of sqrt(2) by a frequency of sqrt(2) is an angle of 2.
        let plain = |e: Expression| match unit {
            Some(unit) => unit.with_square(e),
            None => e,
        };
        for time in times.into_iter().map(plain) {
            let of = |(first, _): &(Expression, _)| ratio(&expand(&time)?, &expand(first)?);
            let known = bases.iter().map(of).enumerate().find_map(|(k, ratio)| Some((k, ratio?)));
            let (base, multiple) = known.unwrap_or_else(|| {
                bases.push((time.clone(), 1.into()));
                (bases.len() - 1, 1.into())
            });
            bases[base].1 = common_measure(&bases[base].1, &multiple);
            delays.push(Delay { time, base, multiple });
        }
        for delay in &mut delays {
            delay.multiple /= &bases[delay.base].1;
        }
        let all = || rates.amplitudes.iter().chain(&rates.forces);
        let mut turns = Vec::new();
        for generator in 0..=generators.len() {
            let parts = all().filter_map(|rate| rate.get(generator));
            let q = parts.fold(Rational::new(), |q, part| common_measure(&q, part));
            for (base, (first, common)) in bases.iter().enumerate().filter(|_| !q.is_zero()) {
                let number = Expression::Number(Rational::from(&q * common)) * first.clone();
                let named = generator.checked_sub(1).map(|k| generators[k].clone());
                let angle = named.map_or(number.clone(), |named| number.clone() * named);
                let angle = angle.multiplied_out().unwrap_or(angle).canonical();
                let angle = plain(angle);
                let quarters = quarters(&angle).and_then(|n| n.to_i64());
                turns.push(Turn { base, generator, q: q.clone(), angle, quarters });
            }
        }
        Ok(Self { delays, turns })
    }

    fn open(&self) -> impl Iterator<Item = &Turn> {
        self.turns.iter().filter(|turn| turn.quarters.is_none())
    }

    /// Whether there is one.
    pub(super) fn any(&self) -> bool {
        !self.delays.is_empty()
    }

    /// How many constant phases there are.
    pub(super) fn phases(&self) -> usize {
        self.open().count()
    }

    /// The algebra with the delays; `time` is the value of T. Nothing where that is no polynomial, or where exponents are
    /// beyond what words hold.
    pub(super) fn put_in<S: Scalars>(
        &self,
        algebra: Amplitudes<S>,
        rates: &Rates<S::Element>,
        time: &Constant<'_, S>,
    ) -> Option<Amplitudes<S>> {
        let late = |delay: &Delay| {
            let turn = |rate: &Vec<Rational>| self.turned_back(&algebra, delay, rate);
            let all = rates.amplitudes.iter().chain(&rates.forces);
            let turns = all.map(turn).collect::<Option<_>>()?;
            Some(Late { time: time(&algebra, &delay.time)?, turns })
        };
        let late = self.delays.iter().map(late).collect::<Option<_>>()?;
        Some(algebra.with_late(late))
    }

    /// e^{-i rate T}.
    fn turned_back<S: Scalars>(
        &self,
        algebra: &Amplitudes<S>,
        delay: &Delay,
        rate: &[Rational],
    ) -> Option<AmplitudeElement<S::Element>> {
        let mut product = algebra.one();
        let mut phase = 0;
        for turn in &self.turns {
            let part = rate.get(turn.generator).filter(|_| turn.base == delay.base);
            let power = part.map(|part| Rational::from(part / &turn.q) * &delay.multiple);
            let power = power.map_or(Some(0), |n| n.is_integer().then(|| n.numer().to_i32())?)?;
            let factor = match turn.quarters {
                Some(n) => algebra.quarter_turns(-n.checked_mul(i64::from(power))?),
                None => algebra.constant_phase(phase, power.checked_neg()?)?,
            };
            phase += usize::from(turn.quarters.is_none());
            product = algebra.mul(&product, &factor);
        }
        Some(product)
    }

    /// The angles that the terms of an algebra are turned by; the exponents of the constant phases are behind the first
    /// `moving`.
    pub(super) fn angles<'a>(
        &self,
        terms: impl Iterator<Item = &'a AmplitudeTerm>,
        moving: usize,
    ) -> Angles {
        let phases = self.phases();
        let mut angles = Angles { moving, phases, known: BTreeMap::new(), open: Vec::new() };
        for term in terms.filter(|_| phases > 0) {
            let (key, _) = angles.of(term);
            if angles.known.contains_key(&key) {
                continue;
            }
            let part =
                |(turn, k): (&Turn, &i32)| Expression::integer(i64::from(*k)) * turn.angle.clone();
            let sum = Expression::Sum(self.open().zip(&key).map(part).collect());
            let angle = sum.multiplied_out().unwrap_or(sum).canonical();
            let turned = match quarters(&angle).map(|n| n.mod_u(4).cast_signed()) {
                Some(n) => Turned::Quarters(n),
                None => {
                    angles.open.push(angle);
                    Turned::By(angles.open.len() - 1)
                }
            };
            angles.known.insert(key, turned);
        }
        angles
    }
}

/// What e^{i theta} is.
#[derive(Clone, Copy)]
enum Turned {
    /// i^n.
    Quarters(i32),
    /// That of an open angle.
    By(usize),
}

/// The angles theta = sum_j k_j theta_j of products of constant phases: of k and -k the one that begins positive.
pub(super) struct Angles {
    moving: usize,
    phases: usize,
    known: BTreeMap<Vec<i32>, Turned>,
    open: Vec<Expression>,
}

impl Angles {
    /// k or -k, and the sign.
    fn of(&self, term: &AmplitudeTerm) -> (Vec<i32>, i32) {
        let turns = &term.exponents[self.moving..self.moving + self.phases];
        let sign = turns.iter().find(|k| **k != 0).map_or(1, |k| k.signum());
        (turns.iter().map(|k| sign * k).collect(), sign)
    }

    /// The names of the cosines and sines of the open ones.
    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        self.open.iter().flat_map(wave_names)
    }

    /// The open ones by these.
    pub(super) fn named(self) -> Named {
        named(self.open)
    }

    /// Terms with the exponents of the constant phases, then those of `symbols` symbols: with those of the cosines and sines
    /// behind the symbols in their place. All angles are known: those of all terms were read.
    pub(super) fn unfold(&self, terms: &mut Terms, symbols: usize) {
        if self.phases == 0 {
            return;
        }
        let mut sum: BTreeMap<Vec<i32>, [Rational; 2]> = BTreeMap::new();
        for term in terms.iter() {
            let (key, sign) = self.of(term);
            let (first, rest) = term.exponents.split_at(self.moving);
            let (own, rest) = rest[self.phases..].split_at(symbols);
            let mut add = |place: Option<usize>, quarters: i32| {
                let mut wave = vec![0; 2 * self.open.len()];
                place.into_iter().for_each(|place| wave[place] = 1);
                let (re, im) = (&term.re, &term.im);
                let turned = match quarters.rem_euclid(4) {
                    0 => [re.clone(), im.clone()],
                    1 => [Rational::from(-im), re.clone()],
                    2 => [Rational::from(-re), Rational::from(-im)],
                    _ => [im.clone(), Rational::from(-re)],
                };
                let entry = sum.entry([first, own, &wave, rest].concat()).or_default();
                entry.iter_mut().zip(turned).for_each(|(sum, part)| *sum += part);
            };
            match self.known[&key] {
                Turned::Quarters(n) => add(None, sign * n),
                Turned::By(k) => {
                    add(Some(2 * k), 0);
                    add(Some(2 * k + 1), sign);
                }
            }
        }
        *terms = collected(sum);
    }
}

impl System {
    /// The angle phi of a symbol cos(phi) or sin(phi) and whether it is the sine; nothing for another symbol.
    #[must_use]
    pub fn angle(&self, symbol: &str) -> Option<(&Expression, bool)> {
        self.angles.get(symbol).map(|(angle, sine)| (angle, *sine))
    }

    /// The value of a symbol cos(phi) or sin(phi), or of the unit sqrt(d); nothing for another symbol, or where a name in phi has no value.
    #[must_use]
    pub fn wave(
        &self,
        symbol: &str,
        values: &dyn Fn(&str) -> Option<Exact>,
        balls: Balls,
    ) -> Option<Ball> {
        let unit = |name: &str| {
            let unit = self.unit.as_ref().filter(|unit| unit.name == name);
            Some(Exact::root(unit?.square.clone()?).ball(balls))
        };
        let Some((angle, sine)) = self.angle(symbol) else { return unit(symbol) };
        let root = |name: &str| {
            let j: usize = name.strip_prefix("nu_")?.parse().ok()?;
            balls.sqrt(&balls.from_rational(self.squares.get(j.checked_sub(1)?)?))
        };
        let value = |name: &str| match name {
            "pi" => Some(balls.pi()),
            _ => values(name)
                .map(|value| value.ball(balls))
                .or_else(|| unit(name))
                .or_else(|| root(name)),
        };
        let ring = BallRing { balls };
        let angle = constant(&ring, angle, &|name| value(name).map(Enclosure))?.0;
        Some(if sine { balls.sin(&angle) } else { balls.cos(&angle) })
    }
}
