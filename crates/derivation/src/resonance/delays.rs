//! Delays of terms of order eps: what they turn the phases by, e^{-i lambda T}.
//!
//! Delays whose ratios are rational are whole multiples of one, T_0, and the parts of all rates in one generator g (1, an
//! irrational root, an independent frequency) those of one number q. So every e^{-i lambda T} is a product of powers of some
//! W = e^{i q g T_0}, which are constant phases of the algebra: exact for every T, given or not. In what is handed out
//! cos(q g T_0) and sin(q g T_0) are symbols, with 1 - cos^2 in the place of sin^2, so that equal polynomials are
//! equal as data; where q g T_0 is a number of quarters of a turn they are numbers.

use super::forces::{divisor, quarters, wave_names};
use super::{System, Terms};
use crate::averaging::constant;
use lindstedt_algebra::Ring;
use lindstedt_equation::Expression;
use lindstedt_equation::monomials::{Monomials, expand};
use lindstedt_expand::{Excitation, ExpandError};
use lindstedt_number::Exact;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::amplitudes::scalars::Scalars;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm, Amplitudes, Late, Rates};
use rug::{Integer, Rational};
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
    /// Of equations, with the generators of rates as expressions, 1 left out.
    pub(super) fn of<E>(
        equations: &[Expression],
        rates: &Rates<E>,
        generators: &[Expression],
    ) -> Result<Self, ExpandError> {
        let times = Excitation::of(&Expression::Sum(equations.to_vec()))?.delays;
        let mut bases: Vec<(Expression, Rational)> = Vec::new();
        let mut delays = Vec::new();
        for time in times {
            let of = |(first, _): &(Expression, _)| ratio(&expand(&time)?, &expand(first)?);
            let known = bases.iter().map(of).enumerate().find_map(|(k, ratio)| Some((k, ratio?)));
            let (base, multiple) = known.unwrap_or_else(|| {
                bases.push((time.clone(), 1.into()));
                (bases.len() - 1, 1.into())
            });
            bases[base].1 = divisor(&bases[base].1, &multiple);
            delays.push(Delay { time, base, multiple });
        }
        for delay in &mut delays {
            delay.multiple /= &bases[delay.base].1;
        }
        let all = || rates.amplitudes.iter().chain(&rates.forces);
        let mut turns = Vec::new();
        for generator in 0..=generators.len() {
            let parts = all().filter_map(|rate| rate.get(generator));
            let q = parts.fold(Rational::new(), |q, part| divisor(&q, part));
            for (base, (first, common)) in bases.iter().enumerate().filter(|_| !q.is_zero()) {
                let number = Expression::Number(Rational::from(&q * common)) * first.clone();
                let named = generator.checked_sub(1).map(|k| generators[k].clone());
                let angle = named.map_or(number.clone(), |named| number.clone() * named);
                let angle = angle.multiplied_out().unwrap_or(angle).canonical();
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

    /// Their angles.
    pub(super) fn angles(&self) -> Vec<Expression> {
        self.open().map(|turn| turn.angle.clone()).collect()
    }

    /// The names of their cosines and sines.
    pub(super) fn names(&self) -> Vec<String> {
        self.open().flat_map(|turn| wave_names(&turn.angle)).collect()
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

    /// Terms with the exponents of the constant phases behind the first `moving`, then those of `symbols` symbols: with those
    /// of the cosines and sines behind the symbols in their place.
    pub(super) fn unfolded(&self, terms: Terms, moving: usize, symbols: usize) -> Terms {
        let phases = self.phases();
        if phases == 0 {
            return terms;
        }
        let mut sum: BTreeMap<Vec<i32>, [Rational; 2]> = BTreeMap::new();
        for AmplitudeTerm { exponents, re, im } in terms {
            let (first, rest) = exponents.split_at(moving);
            let (turns, rest) = rest.split_at(phases);
            let (own, rest) = rest.split_at(symbols);
            for (wave, [cos, sin]) in product_of_waves(turns) {
                let key = [first, own, &wave, rest].concat();
                let entry = sum.entry(key).or_default();
                entry[0] += Rational::from(&re * &cos) - Rational::from(&im * &sin);
                entry[1] += Rational::from(&re * &sin) + Rational::from(&im * &cos);
            }
        }
        let kept = sum.into_iter().filter(|(_, c)| !c.iter().all(Rational::is_zero));
        kept.map(|(exponents, [re, im])| AmplitudeTerm { exponents, re, im }).collect()
    }

    /// A bound of what [`Self::unfolded`] makes of an error of every coefficient, as its multiple: the absolute values of the
    /// coefficients of cos k theta and sin k theta add up to less than 3^k.
    pub(super) fn growth(&self, terms: &Terms, moving: usize) -> f64 {
        let phases = self.phases();
        let size = |term: &AmplitudeTerm| -> f64 {
            let turns = term.exponents.iter().skip(moving).take(phases);
            turns.map(|k| 3f64.powi(k.abs().min(300))).product()
        };
        if phases == 0 { 1.0 } else { terms.iter().map(size).sum::<f64>().max(1.0) }
    }
}

impl System {
    /// The angle phi of a symbol cos(phi) or sin(phi) and whether it is the sine; nothing for another symbol.
    #[must_use]
    pub fn angle(&self, symbol: &str) -> Option<(&Expression, bool)> {
        self.angles.iter().find_map(|angle| {
            let [cos, sin] = wave_names(angle);
            (symbol == cos || symbol == sin).then_some((angle, symbol == sin))
        })
    }

    /// The value of a symbol cos(phi) or sin(phi); nothing for another symbol, or where a name in phi has no value.
    #[must_use]
    pub fn wave(
        &self,
        symbol: &str,
        values: &dyn Fn(&str) -> Option<Exact>,
        balls: Balls,
    ) -> Option<Ball> {
        let (angle, sine) = self.angle(symbol)?;
        let root = |name: &str| {
            let j: usize = name.strip_prefix("nu_")?.parse().ok()?;
            balls.sqrt(&balls.from_rational(self.squares.get(j.checked_sub(1)?)?))
        };
        let value = |name: &str| match name {
            "pi" => Some(balls.pi()),
            _ => values(name).map(|value| value.ball(balls)).or_else(|| root(name)),
        };
        let ring = BallRing { balls };
        let angle = constant(&ring, angle, &|name| value(name).map(Enclosure))?.0;
        Some(if sine { balls.sin(&angle) } else { balls.cos(&angle) })
    }
}

/// e^{i sum k_j theta_j} as a polynomial in c_1, s_1, c_2, ..., no s_j squared: exponents with real and imaginary parts.
fn product_of_waves(turns: &[i32]) -> BTreeMap<Vec<i32>, [Integer; 2]> {
    let mut product = BTreeMap::from([(Vec::new(), [Integer::from(1), Integer::new()])]);
    for k in turns {
        let [even, odd] = wave(*k);
        let mut longer: BTreeMap<Vec<i32>, [Integer; 2]> = BTreeMap::new();
        for (known, [re, im]) in &product {
            let lists = [(0, &even), (1, &odd)].into_iter();
            for (sine, power, c) in
                lists.flat_map(|(sine, list)| (0..).zip(list).map(move |(n, c)| (sine, n, c)))
            {
                let key = known.iter().copied().chain([power, sine]).collect();
                let part = longer.entry(key).or_default();
                // i s c^n.
                let own = [Integer::from(re * c), Integer::from(im * c)];
                let own = if sine == 1 {
                    let [a, b] = own;
                    [-b, a]
                } else {
                    own
                };
                part.iter_mut().zip(own).for_each(|(sum, c)| *sum += c);
            }
        }
        longer.retain(|_, c| c.iter().any(|c| !c.is_zero()));
        product = longer;
    }
    product
}

/// A(c) and B(c) of (c + i s)^k = A + i s B: e^{i (k+1) theta} is (c A - (1 - c^2) B) + i s (A + c B).
fn wave(k: i32) -> [Vec<Integer>; 2] {
    let (mut even, mut odd) = (vec![Integer::from(1)], Vec::new());
    let add = |sum: &mut Vec<Integer>, list: &[Integer], raised: usize, sign: i32| {
        let length = sum.len().max(list.len() + raised);
        sum.resize(length, Integer::new());
        sum[raised..].iter_mut().zip(list).for_each(|(sum, c)| *sum += Integer::from(c * sign));
    };
    for _ in 0..k.unsigned_abs() {
        let (mut next, mut after) = (Vec::new(), even.clone());
        add(&mut next, &even, 1, 1);
        add(&mut next, &odd, 0, -1);
        add(&mut next, &odd, 2, 1);
        add(&mut after, &odd, 1, 1);
        (even, odd) = (next, after);
    }
    if k < 0 {
        odd.iter_mut().for_each(|c| *c = Integer::from(-&*c));
    }
    [even, odd]
}
