//! Slow flows with irrational frequencies: coefficients enclosed by balls.
//!
//! nu_j = sqrt(q_j) with rational q_j. Square roots of which no ratio is rational, and 1, are independent over Q
//! (Besicovitch), so that nu_j is a rational multiple of 1 or of the first root of its class, and every resonance is
//! decided exactly; those of [`super::algebraic`] are taken to be independent. What is divided by is enclosed; a divisor that cannot be told from zero ends the derivation.

use super::algebraic::{Enclosed as Modes, middles};
use super::flow::{Job, Run};
use super::print::is_short;
use super::{Enclosed, ResonanceError, SlowFlow, Terms, collected};
use crate::error::DerivationError as Error;
use crate::work::Progress;
use lindstedt_equation::Expression;
use lindstedt_equation::classify::rational_root;
use lindstedt_number::Whole;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::amplitudes::scalars::Over;
use lindstedt_phase::amplitudes::{AmplitudeElement, AmplitudeTerm, Amplitudes, Rates};
use rug::float::Round;
use rug::{Float, Integer, Rational};
use std::cell::Cell;

type Element = AmplitudeElement<Enclosure>;

/// The square roots as multiples of 1 and of the roots of the second list, which has the place of each, too.
fn classes(squares: &[Rational]) -> (Vec<Vec<Rational>>, Vec<(usize, Rational)>) {
    let mut roots: Vec<(usize, Rational)> = Vec::new();
    let rate = |(j, square): (usize, &Rational)| {
        if let Some(root) = rational_root(square) {
            return vec![root];
        }
        let of = |known: &Rational| rational_root(&Rational::from(square / known));
        let found = roots.iter().enumerate().find_map(|(k, (_, known))| Some((k, of(known)?)));
        let (k, multiple) = found.unwrap_or_else(|| {
            roots.push((j, square.clone()));
            (roots.len() - 1, 1.into())
        });
        let mut rate = vec![Rational::new(); k + 1];
        rate.push(multiple);
        rate
    };
    let rates = squares.iter().enumerate().map(rate).collect();
    (rates, roots)
}

/// sum_j q_j times the multiples of the generators that nu_j has.
fn combined(q: &[Rational], amplitudes: &[Vec<Rational>]) -> Vec<Rational> {
    let longest = amplitudes.iter().map(Vec::len).max().unwrap_or(0);
    let mut sum = vec![Rational::new(); longest];
    for (q, own) in q.iter().zip(amplitudes) {
        sum.iter_mut().zip(own).for_each(|(sum, part)| *sum += Rational::from(q * part));
    }
    sum
}

fn middle(_: &BallRing, e: &Enclosure) -> Option<Rational> {
    e.0.midpoint().to_rational()
}

/// The slow flow of a system with irrational frequencies.
pub(super) fn derived(
    job: &Job<'_>,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<SlowFlow, Error> {
    let digits = job.settings.digits.max(1);
    let bits = u32::try_from(4 * digits).unwrap_or(u32::MAX / 4) + 64;
    let ring = BallRing { balls: Balls::new(bits) };
    let modes = job
        .system
        .algebraic
        .as_ref()
        .map(|modes| modes.enclosed(ring.balls).ok_or(ResonanceError::NoRationalForm));
    let modes = modes.transpose()?;
    let (amplitudes, squares, first): (_, Vec<Ball>, Vec<usize>) = match &modes {
        Some(modes) => {
            let unit = |j: usize| (0..=j + 1).map(|k| u32::from(k == j + 1).into()).collect();
            let all = 0..modes.squares.len();
            (all.clone().map(unit).collect(), modes.squares.clone(), all.collect())
        }
        None => {
            let (amplitudes, roots) = classes(&job.system.squares);
            let ball = |(_, square): &(usize, Rational)| ring.balls.from_rational(square);
            (amplitudes, roots.iter().map(ball).collect(), roots.iter().map(|(j, _)| *j).collect())
        }
    };
    let name = |j: &usize| Expression::parameter(&format!("nu_{}", j + 1));
    let named_roots: Vec<_> = first.iter().map(name).collect();
    let roots: Vec<Ball> = squares.iter().filter_map(|square| ring.balls.sqrt(square)).collect();
    let generators = roots.into_iter().map(|ball| (Enclosure(ball), Whole::ONE)).collect();
    let mut rates = Rates { amplitudes, ..job.rates(generators) };
    for (rate, phase) in rates.forces.iter_mut().zip(&job.system.forces) {
        if !phase.of_modes.is_empty() {
            *rate = combined(&phase.of_modes, &rates.amplitudes);
        }
    }
    let scalars = Over::enclosures(ring, middle);
    let named = modes.as_ref().map(Modes::named).unwrap_or_default();
    let other = |name: &str| named.get(name).map(|ball| Enclosure((*ball).clone()));
    let run = job.run(scalars, (rates, &named_roots), &other, observer)?;
    let radius = Cell::new(0.0);
    // Those of so many words may be added, where delays turn them by the same angle, and real parts to imaginary ones.
    let longest = Cell::new(2usize);
    let terms = |f: &Element| {
        let terms = read(&run.algebra, f, &radius);
        longest.set(longest.get().max(terms.len()));
        terms
    };
    let mut flow = job.finished(&run, &terms);
    if run.delays.any() {
        radius.set(radius.get() * longest.get() as f64);
    }
    let largest = run.residual.iter().flat_map(|f| parts(&run.algebra, f));
    let residual = largest.map(|ball| upward(&ball.abs_upper())).fold(0.0, f64::max);
    // With the digits of the other coefficients, and within their radius.
    for (j, list) in flow.flow.iter().enumerate() {
        if modes.is_some() || rational_root(&flow.system.squares[j]).is_none() {
            flow.system.frequencies[j] =
                list[0].first().map(|term| term.im.clone()).unwrap_or_default();
        }
    }
    flow.system.settle_rates();
    if let Some(modes) = &modes {
        let rows = || modes.shapes.iter().chain([&modes.squares]);
        let wide = rows().flatten().map(|ball| upward(ball.radius()));
        radius.set(wide.fold(radius.get(), f64::max));
        flow.system.squares = middles(&modes.squares);
        flow.system.shapes = Some(modes.shapes.iter().map(|row| middles(row)).collect());
    }
    flow.doubtful = doubtful_terms(job, &run, &flow);
    flow.enclosed = Some(Enclosed { radius: radius.get(), residual, digits });
    Ok(flow)
}

/// [`SlowFlow::doubtful`].
fn doubtful_terms(job: &Job<'_>, run: &Run<Over<BallRing>>, flow: &SlowFlow) -> Vec<Vec<Terms>> {
    let kept = flow.first_symbol() + job.system.symbols.len();
    let own = |mut exponents: Vec<i32>| {
        exponents.drain(flow.first_symbol()..flow.first_symbol() + run.delays.phases());
        exponents.truncate(kept);
        exponents.resize(flow.first_symbol() + flow.system.symbols.len(), 0);
        exponents
    };
    let terms = |f: &Element| -> Terms {
        let zero = |exponents| AmplitudeTerm { exponents, re: 0.into(), im: 0.into() };
        doubtful(&run.algebra, f).map(own).map(zero).collect()
    };
    let lists = run.found.flow.iter().map(|list| list.iter().map(&terms).collect());
    let lists: Vec<Vec<Terms>> = lists.collect();
    let any = lists.iter().flatten().any(|terms| !terms.is_empty());
    if any { lists } else { Vec::new() }
}

/// What [`read`] leaves out though it may not vanish: the exponents.
fn doubtful(
    algebra: &Amplitudes<Over<BallRing>>,
    f: &Element,
) -> impl Iterator<Item = Vec<i32>> + use<> {
    let all = algebra.terms_as(f, &|e: &Enclosure, _: &Whole| e.0.clone());
    let left = |parts: &[Ball; 2]| {
        parts.iter().all(Ball::contains_zero) && parts.iter().any(|ball| ball.abs_upper() > 0)
    };
    all.into_iter().filter(move |(_, parts)| left(parts)).map(|(exponents, _)| exponents)
}

fn upward(x: &Float) -> f64 {
    x.to_f64_round(Round::Up)
}

fn parts(algebra: &Amplitudes<Over<BallRing>>, f: &Element) -> Vec<Ball> {
    let all = algebra.terms_as(f, &|e: &Enclosure, _: &Whole| e.0.clone());
    all.into_iter().flat_map(|(_, parts)| parts).collect()
}

/// The middles of the coefficients; what may vanish is left out, and the radius says within what.
fn read(algebra: &Amplitudes<Over<BallRing>>, f: &Element, radius: &Cell<f64>) -> Terms {
    let part = |e: &Enclosure, _: &Whole| {
        let (size, value) = match e.0.contains_zero() {
            true => (e.0.abs_upper(), Rational::new()),
            false => (e.0.radius().clone(), e.0.midpoint().to_rational().unwrap_or_default()),
        };
        // A short number would be taken for an exact one.
        let tiny = Rational::from((1, Integer::from(1) << e.0.midpoint().prec()));
        let (size, value) = match !size.is_zero() && is_short(&value) && !value.is_zero() {
            true => (Float::with_val_round(64, size + &tiny, Round::Up).0, value + tiny),
            false => (size, value),
        };
        radius.set(radius.get().max(upward(&size)));
        value
    };
    collected(algebra.terms_as(f, &part))
}
