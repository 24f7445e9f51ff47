//! All zeros of n polynomials in a box, with proof of their number, by subdivision; and a box outside which there is
//! none.
//!
//! A box is thrown away when it is proved to have no zero, or when it lies in a box that is known to have exactly one,
//! which is counted. Otherwise it is cut in two; a zero on a cut is proved on a box around it, not on the halves.
//! What is still open at the smallest size is handed back: *could not decide* is not *none*.

use super::System;
use super::krawczyk::{
    Region, Verdict, Zero, is_in, krawczyk, meet, middle, newton_while, prove, zero_near,
};
use lindstedt_algebra::Stop;
use lindstedt_number::interval::Interval;

/// How far a search goes.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Boxes looked at.
    pub boxes: usize,
    /// Boxes are not cut below this fraction of the box searched.
    pub smallest: f64,
    /// Only zeros are wanted of which every pair of unknowns (x_0, x_1), (x_2, x_3), ... has at most this modulus.
    pub modulus: Option<f64>,
    /// Asked between boxes.
    pub stop: Stop,
}

impl Default for Limits {
    fn default() -> Self {
        Self { boxes: 2_000_000, smallest: 1e-6, modulus: None, stop: Stop::default() }
    }
}

/// The zeros of a box.
#[derive(Clone, Debug)]
pub struct Found {
    /// The zeros, each proved; no two are the same.
    pub zeros: Vec<Zero>,
    /// Boxes that could not be decided, hulls of neighbours; all other points of the box searched that are no zero
    /// of the list are none.
    pub undecided: Vec<Region>,
    /// Zeros, each proved, of which is not decided whether they keep to [`Limits::modulus`].
    pub at_edge: Vec<Zero>,
    /// The boxes looked at.
    pub boxes: usize,
    /// Whether the search was stopped; what was left then counts as undecided.
    pub stopped: bool,
}

impl Found {
    /// Whether the number of zeros is proved.
    #[must_use]
    pub fn is_proved(&self) -> bool {
        self.undecided.is_empty() && self.at_edge.is_empty()
    }
}

/// All zeros of as many polynomials as unknowns in a closed box. A zero on its boundary within rounding is counted.
///
/// Nothing where the numbers of polynomials, of unknowns and of sides differ. Cost: one test, n^3 operations, per box;
/// the number of boxes grows with the number of zeros and, fast, with n and near multiple zeros.
///
/// ```
/// use lindstedt_number::interval::Interval;
/// use lindstedt_orbit::steady::{Limits, Polynomial, System, all_zeros};
/// // x^2 + y^2 = 1, x = y.
/// let (x, y) = (Polynomial::variable(0), Polynomial::variable(1));
/// let circle = (&x * &x) + &(&y * &y) + &Polynomial::constant((-1).into());
/// let line = x + &(&y * &Polynomial::constant((-1).into()));
/// let system = System::new(&[circle, line], &[]);
/// let found = all_zeros(&system, &[Interval::new(-2.0, 2.0); 2], &Limits::default()).ok_or("shape")?;
/// assert!(found.is_proved() && found.zeros.len() == 2);
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn all_zeros(system: &System, region: &[Interval], limits: &Limits) -> Option<Found> {
    zeros_at(system, region, &Places::Anywhere, limits)
}

/// Where zeros can be.
pub(super) enum Places {
    /// Anywhere.
    Anywhere,
    /// Where their moduli of (x_0, x_1), (x_2, x_3), ..., and an odd last one, lie in one of these cells.
    Moduli(Vec<Region>),
    /// In one of these boxes.
    Boxes(Vec<Region>),
}

/// The same where something is known of the places.
pub(super) fn zeros_at(
    system: &System,
    region: &[Interval],
    places: &Places,
    limits: &Limits,
) -> Option<Found> {
    let n = region.len();
    let fits = n > 0 && system.rows() == n && system.variables() == n;
    if !fits || region.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let (zeros, open) = (Vec::new(), Vec::new());
    let rounding = region.iter().map(|x| ROUNDING * x.above()).collect();
    let mut search = Search { system, places, limits, zeros, open, boxes: 0, rounding };
    let stopped = !search.run(region);
    let meets = |zero: &Zero| meet(&zero.enclosure, region).is_some();
    // Boxes that were open before a zero was proved on a box around them.
    let known = |part: &Region| search.zeros.iter().any(|zero| is_in(part, &zero.unique_within));
    search.open.retain(|part| !known(part));
    search.zeros.retain(meets);
    let undecided = joined(search.open);
    let limit = Interval::point(limits.modulus.unwrap_or(f64::INFINITY));
    let (mut zeros, mut at_edge) = (Vec::new(), Vec::new());
    for zero in search.zeros {
        let modulus = modulus(&zero.enclosure);
        if modulus.high() <= limit.low() {
            zeros.push(zero);
        } else if modulus.low() <= limit.low() {
            at_edge.push(zero);
        }
    }
    Some(Found { zeros, undecided, at_edge, boxes: search.boxes, stopped })
}

/// Enclosures of the moduli of (x_0, x_1), (x_2, x_3), ...; an odd last one stands alone.
fn moduli(region: &[Interval]) -> impl Iterator<Item = Interval> {
    let square = |pair: &[Interval]| pair.iter().fold(Interval::ZERO, |sum, x| sum + x.powi(2));
    region.chunks(2).map(move |pair| square(pair).root())
}

/// An enclosure of the largest modulus of (x_0, x_1), (x_2, x_3), ...; an odd last one stands alone.
pub(super) fn modulus(region: &[Interval]) -> Interval {
    moduli(region).fold(Interval::ZERO, |most, r| {
        Interval::new(most.low().max(r.low()), most.high().max(r.high()))
    })
}

/// Rounding errors of a zero found in doubles over the largest |x_i| of the region searched.
const ROUNDING: f64 = 1e-13;

struct Search<'a> {
    system: &'a System,
    places: &'a Places,
    limits: &'a Limits,
    zeros: Vec<Zero>,
    open: Vec<Region>,
    boxes: usize,
    /// What a zero found in doubles may be beside the box that has it, by sides.
    rounding: Vec<f64>,
}

impl Search<'_> {
    /// False when it was stopped.
    fn run(&mut self, region: &[Interval]) -> bool {
        let smallest: Vec<f64> = region.iter().map(|x| self.limits.smallest * x.width()).collect();
        let mut stack = match self.places {
            Places::Boxes(boxes) => boxes.clone(),
            _ => vec![self.reached(region)],
        };
        while let Some(part) = stack.pop() {
            if self.zeros.iter().any(|zero| is_in(&part, &zero.unique_within)) {
                continue;
            }
            if self.limits.modulus.is_some_and(|most| modulus(&part).low() > most) {
                continue;
            }
            if !self.has_moduli(&part) {
                continue;
            }
            self.boxes += 1;
            if self.boxes > self.limits.boxes || self.limits.stop.asked() {
                self.open.push(part);
                self.open.append(&mut stack);
                return false;
            }
            let next = match krawczyk(self.system, &part) {
                Verdict::None => continue,
                Verdict::One(_) if self.record(&part) => continue,
                Verdict::One(within) => within,
                Verdict::Within(within) => within,
                Verdict::Open => part.clone(),
            };
            if gained(&part, &next) {
                stack.push(next);
                continue;
            }
            self.centre(&part);
            match self.cut(&next, &smallest) {
                Some(halves) => stack.extend(halves),
                None => self.open.push(next),
            }
        }
        true
    }

    /// The part of a box that the moduli of zeros reach to.
    fn reached(&self, region: &[Interval]) -> Region {
        let Places::Moduli(cells) = self.places else { return region.to_vec() };
        let pairs = region.len() / 2;
        let largest = |j: usize| cells.iter().fold(0.0, |most: f64, cell| most.max(cell[j].high()));
        let side = |(i, x): (usize, &Interval)| match i / 2 {
            j if j < pairs => x.meet(Interval::new(-largest(j), largest(j))).unwrap_or(*x),
            _ => *x,
        };
        region.iter().enumerate().map(side).collect()
    }

    /// Whether a box has points with moduli that zeros may have.
    fn has_moduli(&self, part: &[Interval]) -> bool {
        let Places::Moduli(cells) = self.places else { return true };
        let (pairs, rest) = part.split_at(part.len() / 2 * 2);
        let place: Region = moduli(pairs).chain(rest.iter().copied()).collect();
        cells.iter().any(|cell| meet(cell, &place).is_some())
    }

    /// Records the zero of a box that has exactly one; false where it cannot be told from another.
    fn record(&mut self, part: &[Interval]) -> bool {
        prove(self.system, part).is_some_and(|zero| self.keep(zero))
    }

    /// Adds a zero unless it is known; false where that is not decided. A box with one zero knows all that lie in it.
    fn keep(&mut self, zero: Zero) -> bool {
        for known in &mut self.zeros {
            let same = is_in(&zero.enclosure, &known.unique_within)
                || is_in(&known.enclosure, &zero.unique_within);
            if same {
                // A proof on a tiny box leaves those around it open, which one on a larger box closes.
                if is_in(&known.unique_within, &zero.unique_within) {
                    *known = zero;
                }
                return true;
            }
            if meet(&zero.enclosure, &known.enclosure).is_some() {
                return false;
            }
        }
        self.zeros.push(zero);
        true
    }

    /// Looks for a zero from the middle of a box, for one on its boundary, which no subdivision isolates.
    fn centre(&mut self, part: &[Interval]) {
        // What strays from the box is no zero of it: smaller boxes start nearer.
        let strays = |at: &[f64]| {
            let far = |(x, side): (&f64, &Interval)| (x - side.middle()).abs() > 4.0 * side.width();
            at.iter().zip(part).any(far)
        };
        let Some(at) = newton_while(self.system, &middle(part), |at| !strays(at)) else { return };
        // A linear equation alone leaves a side of the width of rounding, within which nothing is proved.
        let near = |((x, side), rounding): ((&f64, &Interval), &f64)| {
            (x - side.middle()).abs() <= 0.6 * side.width() + rounding
        };
        let width = |(side, rounding): (&Interval, &f64)| 1.2 * side.width() + 4.0 * rounding;
        let widths: Vec<f64> = part.iter().zip(&self.rounding).map(width).collect();
        // Known, and on no smaller box than is tried.
        let wide =
            |(x, (a, width)): (&Interval, (&f64, &f64))| x.contains(*a) && x.width() >= *width;
        let known = |zero: &Zero| zero.unique_within.iter().zip(at.iter().zip(&widths)).all(wide);
        if !at.iter().zip(part).zip(&self.rounding).all(near) || self.zeros.iter().any(known) {
            return;
        }
        if let Some(zero) = zero_near(self.system, &at, &widths) {
            self.keep(zero);
        }
    }

    /// The halves of a box, cut where the polynomials change most; nothing at the smallest size.
    fn cut(&self, part: &[Interval], smallest: &[f64]) -> Option<[Region; 2]> {
        let n = part.len();
        let (_, slopes) = self.system.derivatives(part);
        let change = |j: usize| -> f64 {
            let steepest = (0..n).map(|i| slopes[i * n + j].above()).fold(0.0, f64::max);
            let width = part[j].width();
            // A side that nothing depends on, or that everything does, is cut by its length.
            if steepest.is_finite() { width * steepest.max(1e-300) } else { width }
        };
        let large = (0..n).filter(|j| part[*j].width() > smallest[*j]);
        let side = large.max_by(|a, b| change(*a).total_cmp(&change(*b)))?;
        Some(halved(part, side))
    }
}

/// A box cut in two.
pub(super) fn halved(part: &[Interval], side: usize) -> [Region; 2] {
    part[side].halves().map(|half| {
        let mut piece = part.to_vec();
        piece[side] = half;
        piece
    })
}

/// Whether a side has become much shorter.
fn gained(before: &[Interval], after: &[Interval]) -> bool {
    before.iter().zip(after).any(|(a, b)| b.width() < 0.6 * a.width())
}

/// Hulls of boxes that touch.
fn joined(open: Vec<Region>) -> Vec<Region> {
    let mut hulls: Vec<Region> = Vec::new();
    for mut part in open {
        while let Some(k) = hulls.iter().position(|hull| meet(hull, &part).is_some()) {
            let other = hulls.swap_remove(k);
            part = part.iter().zip(&other).map(|(a, b)| a.hull(*b)).collect();
        }
        hulls.push(part);
    }
    hulls
}

/// How many times as far as where the terms of highest degree are largest a bound may be.
const FARTHEST: f64 = 1e6;
/// Boxes of the sphere looked at for a bound.
const MOST_PARTS: usize = 100_000;

/// Some R such that every pair (x_0, x_1), (x_2, x_3), ... of every zero has a modulus below R, from the terms of highest
/// degree of every polynomial: where they have no common zero on the cube's surface max |x_i| = 1, one of them outgrows
/// the rest of its polynomial; 0 where all have terms of one degree alone. Nothing where they have one, or where that
/// could not be decided.
#[must_use]
pub fn bound(system: &System) -> Option<f64> {
    let n = system.variables();
    let (top, sizes) = system.leading();
    if n == 0 || system.rows() != n {
        return None;
    }
    let mut stack = Vec::new();
    for (side, end) in (0..n).flat_map(|side| [(side, -1.0), (side, 1.0)]) {
        let mut face = vec![Interval::new(-1.0, 1.0); n];
        face[side] = Interval::point(end);
        stack.push(face);
    }
    // Where the terms of highest degree are almost zero the bound is far beyond that where they are large.
    let least = sizes.iter().filter_map(|sums| outgrows(*sums.last()?, sums));
    let farthest = FARTHEST * least.fold(0.0, f64::max);
    let mut radius = 0.0f64;
    let mut parts = 0;
    while let Some(part) = stack.pop() {
        parts += 1;
        if parts > MOST_PARTS {
            return None;
        }
        let values = top.values(&part);
        let outgrown = values
            .iter()
            .zip(&sizes)
            .filter_map(|(value, sums)| outgrows(value.below(), sums).filter(|r| *r <= farthest));
        // A much finer cut gives a smaller bound; a few parts are worth it.
        let width = part.iter().map(|x| x.width()).fold(0.0, f64::max);
        let size = modulus(&part).high();
        match outgrown.reduce(f64::min).map(|r| Interval::point(r * size).above()) {
            Some(r) if r <= radius || width < 0.2 => radius = radius.max(r),
            _ if width < 1e-3 => return None,
            _ => {
                let widest = |a: &usize, b: &usize| part[*a].width().total_cmp(&part[*b].width());
                let side = (0..n).max_by(widest)?;
                stack.extend(halved(&part, side));
            }
        }
    }
    Some(radius)
}

/// A power of 2^(1/4), rounded up, beyond which c r^d > sum_(k<d) sums_k r^k, d + 1 the length of the list; 0 where there is
/// nothing to outgrow. It lies between m and 2 m, m the largest (sums_k/c)^(1/(d-k)) (Fujiwara).
fn outgrows(c: f64, sums: &[f64]) -> Option<f64> {
    let (_, below) = sums.split_last()?;
    let radius = |k: i32| 2f64.powf(f64::from(k) / 4.0);
    let one = |(k, size): (usize, &f64)| (size / c).powf(1.0 / (below.len() - k) as f64);
    let most = below.iter().enumerate().map(one).fold(0.0, f64::max);
    if !(c > 0.0 && most.is_finite()) {
        return None;
    }
    if most == 0.0 {
        // A quotient may have underflowed.
        return below.iter().all(|size| *size == 0.0).then_some(0.0);
    }
    // Falls with r. A sum of a few positive doubles and their powers is known to a few units.
    let rest = |r: f64| below.iter().fold(0.0, |sum, size| (sum + size) / r);
    let first = (4.0 * most.log2()).floor() as i32 - 1;
    let mut powers = (first..first + 12).map(radius);
    powers.find(|r| rest(*r) * (1.0 + 1e-12) < c)
}
