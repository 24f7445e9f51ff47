//! All Hopf points of an interval of the parameter, with proof, and one of them to many digits.
//!
//! L(i omega; alpha) = 0 are two real equations for (alpha, omega). A box is thrown away where the mean value form
//! L(c) + L'(box)(box - c) has no zero, and answered where Krawczyk's operator
//!
//!   K = c - Y L(c) + (1 - Y L'(box)) (box - c),   Y near L'(c)^-1,
//!
//! maps the box into itself: then it holds one zero, a simple one, at which the determinant of L' does not vanish: the
//! pair of roots crosses the axis with a speed. Else it is halved. Near omega = 0 the equations are Re L = 0 and
//! Im L/omega = 0, so that a root at zero is no Hopf point. omega <= [`reach`]: beyond, the highest derivative exceeds all
//! other terms.

use crate::HopfError;
use crate::equation::{
    Characteristic, DelayEquation, characteristic, delays_positive, reach, value,
};
use lindstedt_equation::Expression;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls, Complex, ComplexBalls};
use rug::Float;

/// Bits of the search.
const COARSE: u32 = 64;
/// Boxes that are looked at before a search is given up.
const MOST_BOXES: usize = 400_000;
/// Where a box as small as this is not decided, it is not by halving it.
const SMALLEST: f64 = 1e-9;
/// The interval that is searched first ends at this distance from the value, or at the value's size; it is doubled so
/// many times.
const FIRST: f64 = 0.5;
const DOUBLINGS: u32 = 8;

/// A Hopf point: alpha_0 and omega_0 > 0, each enclosed.
#[derive(Clone, Debug)]
pub struct HopfPoint {
    /// alpha_0.
    pub parameter: Ball,
    /// omega_0.
    pub frequency: Ball,
}

/// The Hopf points of an interval.
#[derive(Clone, Debug)]
pub struct HopfPoints {
    /// The ends of the interval.
    pub interval: [f64; 2],
    /// All of them, the nearest to the value that was given first; of two at the same distance the larger parameter,
    /// then the lower frequency.
    pub points: Vec<HopfPoint>,
}

type Box2 = [Ball; 2];

struct Search<'a> {
    equation: &'a DelayEquation<Enclosure>,
    ring: BallRing,
}

/// All Hopf points with |alpha - near| <= d, the smallest of d = max(|near|, 1)/2, twice that, ... (eight times) for
/// which there is one.
///
/// # Errors
/// [`HopfError::Still`], [`HopfError::Even`], [`HopfError::NoPoint`], [`HopfError::Undecided`], [`HopfError::ZeroRoot`], [`HopfError::UndecidedDelay`],
/// [`HopfError::TooManyBoxes`], [`HopfError::Unbounded`]; [`HopfError::Stopped`] when `goes_on` said so.
pub(crate) fn points(
    equation: &DelayEquation<Expression>,
    unknown: &str,
    near: f64,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<HopfPoints, HopfError> {
    if equation.linear().all(|(term, factor)| {
        term.coefficient.len() <= 1 && equation.delays[factor.delay].len() <= 1
    }) {
        return Err(HopfError::Still { unknown: unknown.to_owned() });
    }
    // Where L(i omega) is real for all omega, its zeros are curves in the plane of (alpha, omega), which no box isolates.
    if equation.linear().all(|(_, factor)| factor.derivative.is_multiple_of(2) && factor.delay == 0)
    {
        return Err(HopfError::Even);
    }
    let ring = BallRing { balls: Balls::new(COARSE) };
    let equation = equation.over(&ring).ok_or(HopfError::Field)?;
    let search = Search { equation: &equation, ring };
    let mut distance = FIRST * near.abs().max(1.0);
    let mut ends = [near, near];
    for _ in 0..=DOUBLINGS {
        ends = [near - distance, near + distance];
        let mut points = search.all(unknown, ends, goes_on)?;
        if !points.is_empty() {
            let key = |p: &HopfPoint| {
                let [alpha, omega] = [&p.parameter, &p.frequency].map(|b| b.midpoint().to_f64());
                // Of equal distances the rounding must not decide.
                let far = (1e9 * (alpha - near).abs() / distance).round();
                [far, -alpha, omega]
            };
            points.sort_by(|a, b| {
                let (a, b) = (key(a), key(b));
                a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
            });
            return Ok(HopfPoints { interval: ends, points });
        }
        distance *= 2.0;
    }
    let [low, high] = ends.map(|end| end.to_string());
    Err(HopfError::NoPoint { unknown: unknown.to_owned(), low, high })
}

/// The same point to about `bits` bits.
///
/// # Errors
/// [`HopfError::Field`] for a constant without a value.
pub(crate) fn refined(
    equation: &DelayEquation<Expression>,
    point: &HopfPoint,
    bits: u32,
) -> Result<HopfPoint, HopfError> {
    let ring = BallRing { balls: Balls::new(bits) };
    let equation = equation.over(&ring).ok_or(HopfError::Field)?;
    let search = Search { equation: &equation, ring };
    let mut at = [point.parameter.clone(), point.frequency.clone()];
    // The radius is squared every time, until rounding ends it.
    for _ in 0..64 {
        let Some(next) = search.krawczyk(&at) else { break };
        let ended = next
            .iter()
            .zip(&at)
            .all(|(new, old)| Float::with_val(53, new.radius() * 2u32) >= *old.radius());
        if next.iter().zip(&at).any(|(new, old)| new.radius() > old.radius()) {
            break;
        }
        at = next;
        if ended {
            break;
        }
    }
    let [parameter, frequency] = at;
    Ok(HopfPoint { parameter, frequency })
}

impl Search<'_> {
    fn balls(&self) -> Balls {
        self.ring.balls
    }

    /// L at i omega.
    fn at(&self, [alpha, omega]: &Box2) -> Characteristic {
        let lambda = Complex { re: self.balls().zero(), im: omega.clone() };
        characteristic(self.equation, self.ring, &lambda, alpha)
    }

    /// The matrix of d(Re L, Im L)/d(alpha, omega): dL/domega = i L'.
    fn slopes(&self, at: &Characteristic) -> [[Ball; 2]; 2] {
        let turned = ComplexBalls::new(self.balls()).times_i(&at.by_root);
        let own = &at.by_parameter;
        [[own.re.clone(), turned.re], [own.im.clone(), turned.im]]
    }

    /// An enclosure of the zeros in the box, one inside it where it is smaller; nothing where L' is singular.
    fn krawczyk(&self, region: &Box2) -> Option<Box2> {
        let balls = self.balls();
        let centre =
            region.each_ref().map(|part| balls.from_parts(part.midpoint(), &Float::new(53)));
        let middle = self.at(&centre);
        let [[a, b], [c, d]] = self.slopes(&middle).map(|row| row.map(|e| exact(&e, balls)));
        let determinant = balls.sub(&balls.mul(&a, &d), &balls.mul(&b, &c));
        let inverse = exact(&balls.div(&balls.one(), &determinant)?, balls);
        let scaled = |e: &Ball| exact(&balls.mul(e, &inverse), balls);
        let y = [[scaled(&d), balls.neg(&scaled(&b))], [balls.neg(&scaled(&c)), scaled(&a)]];
        let slopes = self.slopes(&self.at(region));
        let value = [&middle.value.re, &middle.value.im];
        let mut next = Vec::with_capacity(2);
        for (i, row) in y.iter().enumerate() {
            let newton = balls.add(&balls.mul(&row[0], value[0]), &balls.mul(&row[1], value[1]));
            let mut sum = balls.sub(&centre[i], &newton);
            for (j, part) in region.iter().enumerate() {
                let product = balls
                    .add(&balls.mul(&row[0], &slopes[0][j]), &balls.mul(&row[1], &slopes[1][j]));
                let rest = balls.sub(&balls.from_i64(i64::from(i == j)), &product);
                let step = balls.sub(part, &centre[j]);
                sum = balls.add(&sum, &balls.mul(&rest, &step));
            }
            next.push(sum);
        }
        <[Ball; 2]>::try_from(next).ok()
    }

    /// Whether L surely has no zero in the box.
    fn is_empty(&self, region: &Box2) -> bool {
        let balls = self.balls();
        if delays_positive(self.equation, self.ring, &region[0]) == Some(false) {
            return true;
        }
        if region[1].contains_zero() {
            return !self.real_part(region).contains_zero()
                || !self.slope_at_zero(region).contains_zero();
        }
        let whole = self.at(region);
        if !whole.value.contains_zero() {
            return true;
        }
        let centre =
            region.each_ref().map(|part| balls.from_parts(part.midpoint(), &Float::new(53)));
        let middle = self.at(&centre);
        let slopes = self.slopes(&whole);
        let value = [middle.value.re, middle.value.im];
        value.iter().zip(&slopes).any(|(value, row)| {
            let mut sum = value.clone();
            for (j, slope) in row.iter().enumerate() {
                let step = balls.sub(&region[j], &centre[j]);
                sum = balls.add(&sum, &balls.mul(slope, &step));
            }
            !sum.contains_zero()
        })
    }

    fn real_part(&self, region: &Box2) -> Ball {
        self.at(region).value.re
    }

    /// Im L(i omega)/omega, also at omega = 0: the sum of c times -T sinc(omega T), cos(omega T),
    /// omega^2 T sinc(omega T), ... for n = 0, 1, 2, ...
    fn slope_at_zero(&self, [alpha, omega]: &Box2) -> Ball {
        let balls = self.balls();
        let at = Enclosure(alpha.clone());
        let mut sum = balls.zero();
        for (term, factor) in self.equation.linear() {
            let c = value(&self.ring, &term.coefficient, &at).0;
            let later = value(&self.ring, &self.equation.delays[factor.delay], &at).0;
            let angle = balls.mul(omega, &later);
            let n = factor.derivative;
            // Im(i^n e^(-i y))/omega, omega^n apart.
            let even = n.is_multiple_of(2);
            let part = if even {
                balls.neg(&balls.mul(&later, &sinc(&angle, balls)))
            } else {
                balls.cos(&angle)
            };
            let power = if even { n } else { n - 1 };
            let power = (0..power).fold(balls.one(), |all, _| balls.mul(&all, omega));
            let sign = if (n / 2).is_multiple_of(2) { 1 } else { -1 };
            let own = balls.mul_i64(&balls.mul(&balls.mul(&c, &part), &power), sign);
            sum = balls.add(&sum, &own);
        }
        sum
    }

    fn all(
        &self,
        unknown: &str,
        ends: [f64; 2],
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<HopfPoint>, HopfError> {
        let balls = self.balls();
        let alpha = between(ends, balls);
        let reach = reach(self.equation, self.ring, &alpha).ok_or(HopfError::Unbounded)?;
        let mut open = vec![[alpha, between([0.0, reach], balls)]];
        let mut found: Vec<(Box2, HopfPoint)> = Vec::new();
        let mut looked = 0;
        while let Some(region) = open.pop() {
            looked += 1;
            if looked % 256 == 0 && !goes_on() {
                return Err(HopfError::Stopped);
            }
            if self.is_empty(&region) {
                continue;
            }
            // A zero on an edge is inside of a larger box.
            let wide = region
                .each_ref()
                .map(|part| balls.add_error(part, &Float::with_val(53, part.radius() / 4u32)));
            let positive = wide[1].is_positive();
            let next = self.krawczyk(&wide).filter(|_| positive);
            if let Some(next) = &next {
                if is_inside(next, &wide) {
                    self.note(&mut found, wide, next, ends).map_err(|at| {
                        HopfError::UndecidedDelay { unknown: unknown.to_owned(), at }
                    })?;
                    continue;
                }
                if next.iter().zip(&region).any(|(a, b)| !a.overlaps(b)) {
                    continue;
                }
            }
            let sizes = region.each_ref().map(|part| part.radius().to_f64());
            let unknown = || unknown.to_owned();
            if sizes.iter().all(|size| *size < SMALLEST) {
                let at = place(&region[0]);
                return Err(if region[1].contains_zero() {
                    HopfError::ZeroRoot { unknown: unknown(), at }
                } else {
                    HopfError::Undecided { unknown: unknown(), at }
                });
            }
            if looked > MOST_BOXES {
                let [low, high] = ends.map(|end| end.to_string());
                return Err(HopfError::TooManyBoxes {
                    unknown: unknown(),
                    low,
                    high,
                    boxes: looked,
                });
            }
            open.extend(halves(region, sizes, balls));
        }
        Ok(found.into_iter().map(|(_, point)| point).collect())
    }

    /// Notes a zero that was not found in another box, and lies in the interval.
    ///
    /// # Errors
    /// Where it is, if the sign of a delay is not decided there.
    fn note(
        &self,
        found: &mut Vec<(Box2, HopfPoint)>,
        wide: Box2,
        next: &Box2,
        ends: [f64; 2],
    ) -> Result<(), String> {
        let mut at = next.clone();
        for _ in 0..6 {
            at = self.krawczyk(&at).filter(|next| is_inside(next, &at)).unwrap_or(at);
        }
        let outside = at[0].upper() < ends[0] || at[0].lower() > ends[1];
        let known = found.iter().any(|(other, point)| {
            let same = [&point.parameter, &point.frequency].into_iter().zip(&at);
            is_inside(&at, other) && same.clone().all(|(a, b)| a.overlaps(b))
        });
        if outside || known {
            return Ok(());
        }
        let late = delays_positive(self.equation, self.ring, &at[0]);
        if late.ok_or_else(|| place(&at[0]))? {
            let [parameter, frequency] = at;
            found.push((wide, HopfPoint { parameter, frequency }));
        }
        Ok(())
    }
}

fn place(alpha: &Ball) -> String {
    format!("{:.6}", alpha.midpoint().to_f64())
}

/// sin y/y: near 1 for small y, at least -0.2173 anywhere.
fn sinc(y: &Ball, balls: Balls) -> Ball {
    if let Some(quotient) = balls.div(&balls.sin(y), y).filter(|_| !y.contains_zero()) {
        return quotient;
    }
    let large = y.abs_upper();
    if large <= 1 {
        // 1 - y^2/6 <= sin y/y <= 1.
        let drop = Float::with_val(53, large.square_ref()) / 6u32;
        return balls.add_error(&balls.one(), &(drop * 1.001));
    }
    balls.hull(&balls.one(), &balls.from_rational(&(-11, 50).into()))
}

fn exact(ball: &Ball, balls: Balls) -> Ball {
    balls.from_parts(ball.midpoint(), &Float::new(53))
}

fn between(ends: [f64; 2], balls: Balls) -> Ball {
    let [low, high] = ends.map(|end| balls.from_parts(&Float::with_val(53, end), &Float::new(53)));
    balls.hull(&low, &high)
}

fn is_inside(inner: &Box2, outer: &Box2) -> bool {
    inner.iter().zip(outer).all(|(a, b)| a.lower() > b.lower() && a.upper() < b.upper())
}

/// The halves along the longer side.
fn halves(region: Box2, sizes: [f64; 2], balls: Balls) -> [Box2; 2] {
    let side = usize::from(sizes[1] > sizes[0]);
    let quarter = Float::with_val(53, region[side].radius()) / 2u32;
    let half = |sign: i32| {
        let middle = Float::with_val(COARSE, &quarter * sign) + region[side].midpoint();
        let mut half = region.clone();
        half[side] = balls.from_parts(&middle, &quarter);
        half
    };
    [half(-1), half(1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residual::tests::wright;

    /// alpha = omega = pi/2 + 2 pi m, and -alpha = omega = pi/2 + pi (2 m + 1): |alpha| <= 8 holds three.
    #[test]
    fn all_of_wright() {
        let found = points(&wright(), "alpha", 0.0, &mut || true).unwrap();
        let pairs = |found: &HopfPoints| -> Vec<[f64; 2]> {
            let of = |p: &HopfPoint| [&p.parameter, &p.frequency].map(|b| b.midpoint().to_f64());
            found.points.iter().map(of).collect()
        };
        let half = std::f64::consts::FRAC_PI_2;
        assert_eq!(found.interval, [-2.0, 2.0]);
        assert!(
            matches!(pairs(&found)[..], [[a, w]] if (a - half).abs() < 1e-12 && (w - half).abs() < 1e-12)
        );
        let wide = points(&wright(), "alpha", -5.0, &mut || true).unwrap();
        assert!(
            matches!(pairs(&wide)[..], [[a, w]] if (a + 3.0 * half).abs() < 1e-12 && (w + a).abs() < 1e-12)
        );
        let sharp = refined(&wright(), &found.points[0], 400).unwrap();
        let balls = Balls::new(400);
        let pi = balls.mul_rational(&balls.pi(), &(1, 2).into());
        assert!(sharp.parameter.overlaps(&pi) && sharp.parameter.relative_accuracy_bits() > 380);
        assert!(sharp.frequency.overlaps(&pi));
    }
}
