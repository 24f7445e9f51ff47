//! The modes of M x'' + K x whose frequencies have irrational squares: enclosed by balls.
//!
//! The squares are the roots lambda_j of the characteristic polynomial of A = M^-1 K, positive and simple. The adjugate of
//! lambda - A, B_0 lambda^(n-1) + ... + B_(n-1) (Faddeev and Leverrier), has rank one at a simple root: its columns
//! are multiples of the shape, its rows of the left eigenvector. In the equations lambda_j, P and P^-1 M^-1 are
//! names that no user writes, in the place of which balls are put, of whichever precision.
//!
//! Nothing decides here whether the frequencies are independent over Q: they are taken to be. Where they are not,
//! a divisor contains zero, and that ends the derivation.

use super::ResonanceError;
use super::modes::{Matrix, Spectrum, inverted, product};
use lindstedt_equation::Expression;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::univariate::{positive_roots, refined, simple_and_multiple};
use rug::Rational;
use std::collections::BTreeMap;

/// lambda_j, entry (i, j) of P, and entry (j, i) of P^-1 M^-1, as named in the equations.
#[derive(Clone, Copy)]
pub(super) enum Entry {
    Square(usize),
    Shape(usize, usize),
    Inverse(usize, usize),
}

impl Entry {
    pub(super) fn name(self) -> String {
        match self {
            Self::Square(j) => format!("'lambda{j}"),
            Self::Shape(i, j) => format!("'shape{i},{j}"),
            Self::Inverse(j, i) => format!("'inverse{j},{i}"),
        }
    }
}

/// The linear part as rational numbers, of which all enclosures are computed.
#[derive(Clone, Debug)]
pub struct AlgebraicModes {
    /// The characteristic polynomial, lowest power first, and an interval around every root.
    polynomial: Vec<Rational>,
    roots: Vec<[Rational; 2]>,
    /// B_0, B_1, ...
    adjugate: Vec<Matrix>,
    /// Row and column of an entry of the adjugate at each root that does not vanish.
    pivots: Vec<[usize; 2]>,
    pub(super) mass_inverse: Matrix,
    pub(super) stiffness: Matrix,
    /// What the equations conserve, in the modes: names would hide it.
    pub(super) energy: Option<Expression>,
}

/// Enclosures at a precision.
pub(super) struct Enclosed {
    pub squares: Vec<Ball>,
    pub shapes: Vec<Vec<Ball>>,
    pub inverse: Vec<Vec<Ball>>,
}

/// Bits with which it is looked for entries that do not vanish, and of the numbers beside the enclosures.
const BITS: u32 = 512;

impl AlgebraicModes {
    /// The modes; of squares that are no simple roots, or not positive, why there are none.
    pub(super) fn of(mass: &Matrix, stiffness: &Matrix) -> Result<Self, ResonanceError> {
        let found = Self::unless_refused(mass, stiffness);
        found.unwrap_or(Err(ResonanceError::NoRationalForm))
    }

    fn unless_refused(mass: &Matrix, stiffness: &Matrix) -> Option<Result<Self, ResonanceError>> {
        let n = mass.len();
        let mass_inverse = inverted(mass)?;
        let matrix = product(&mass_inverse, stiffness);
        let unit = |i: usize| (0..n).map(move |j| Rational::from(u32::from(i == j)));
        let mut adjugate: Vec<Matrix> = vec![(0..n).map(|i| unit(i).collect()).collect()];
        let mut polynomial = vec![Rational::from(1)];
        for k in 1..=n {
            let mut next = product(&matrix, adjugate.last()?);
            let trace: Rational = (0..n).map(|i| next[i][i].clone()).sum();
            let c = -trace / u32::try_from(k).ok()?;
            (0..n).for_each(|i| next[i][i] += &c);
            polynomial.push(c);
            adjugate.push(next);
        }
        // Cayley and Hamilton: the last is zero.
        adjugate.pop();
        polynomial.reverse();
        let [simple, multiple] = simple_and_multiple(&polynomial);
        let roots = positive_roots(&polynomial);
        let signs =
            (0..).zip(&polynomial).map(|(k, c)| if k % 2 == 0 { c.clone() } else { -c.clone() });
        let mirrored: Vec<Rational> = signs.collect();
        let negative = positive_roots(&mirrored);
        let zero = usize::from(polynomial[0].is_zero());
        // Each root of the polynomial is one of either factor.
        if roots.len() + negative.len() + zero < simple.len() + multiple.len() - 2 {
            return Some(Err(ResonanceError::Flutter));
        }
        if let Some(root) = negative.last() {
            let square = format!("{:.6}", -refined(&mirrored, root, 64)[0].to_f64());
            return Some(Err(ResonanceError::NoOscillation { square }));
        }
        if multiple.len() > 1 || zero > 0 {
            return None;
        }
        let (mass_inverse, stiffness) = (mass_inverse, stiffness.clone());
        let pivots = Vec::new();
        let energy = None;
        let mut modes =
            Self { polynomial, roots, adjugate, pivots, mass_inverse, stiffness, energy };
        let balls = Balls::new(BITS);
        let pivot = |root| {
            let adjugate = modes.adjugate_at(&modes.square(root, balls), balls);
            let places = (0..n).flat_map(|i| (0..n).map(move |j| [i, j]));
            places.into_iter().find(|[i, j]| !adjugate[*i][*j].contains_zero())
        };
        modes.pivots = modes.roots.iter().map(pivot).collect::<Option<_>>()?;
        (modes.roots.len() == n).then_some(Ok(modes))
    }

    fn square(&self, root: &[Rational; 2], balls: Balls) -> Ball {
        let [low, high] = refined(&self.polynomial, root, balls.bits());
        balls.hull(&balls.from_rational(&low), &balls.from_rational(&high))
    }

    fn adjugate_at(&self, square: &Ball, balls: Balls) -> Vec<Vec<Ball>> {
        let n = self.stiffness.len();
        let entry = |i: usize, j: usize| {
            let horner = |sum: Ball, b: &Matrix| {
                balls.add(&balls.mul(&sum, square), &balls.from_rational(&b[i][j]))
            };
            self.adjugate.iter().fold(balls.zero(), horner)
        };
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
    }

    /// Nothing where the precision is too small to divide.
    pub(super) fn enclosed(&self, balls: Balls) -> Option<Enclosed> {
        let n = self.stiffness.len();
        let sum = |parts: &mut dyn Iterator<Item = Ball>| {
            parts.fold(balls.zero(), |sum, part| balls.add(&sum, &part))
        };
        let mut found =
            Enclosed { squares: Vec::new(), shapes: vec![Vec::new(); n], inverse: Vec::new() };
        for (root, [row, column]) in self.roots.iter().zip(&self.pivots) {
            let square = self.square(root, balls);
            let adjugate = self.adjugate_at(&square, balls);
            let shape = |i: usize| match i == *row {
                true => Some(balls.one()),
                false => balls.div(&adjugate[i][*column], &adjugate[*row][*column]),
            };
            let shape: Vec<Ball> = (0..n).map(shape).collect::<Option<_>>()?;
            let left = &adjugate[*row];
            let norm = sum(&mut left.iter().zip(&shape).map(|(w, v)| balls.mul(w, v)));
            let from = |i: usize| {
                let parts = left.iter().zip(&self.mass_inverse);
                let whole = sum(&mut parts.map(|(w, row)| balls.mul_rational(w, &row[i])));
                balls.div(&whole, &norm)
            };
            found.inverse.push((0..n).map(from).collect::<Option<_>>()?);
            found.shapes.iter_mut().zip(shape).for_each(|(row, entry)| row.push(entry));
            found.squares.push(square);
        }
        Some(found)
    }

    /// Rational numbers beside the enclosures, by their names in the equations.
    pub(super) fn nearby(&self) -> BTreeMap<String, Rational> {
        let found = self.enclosed(Balls::new(BITS));
        let middle = |(name, ball): (String, &Ball)| (name, middle(ball));
        found.iter().flat_map(Enclosed::named).map(middle).collect()
    }

    /// The modes with rational numbers beside the enclosures in their place.
    pub(super) fn spectrum(&self) -> Option<Spectrum> {
        let Enclosed { squares, shapes, inverse } = self.enclosed(Balls::new(BITS))?;
        let nearby =
            |rows: Vec<Vec<Ball>>| -> Matrix { rows.iter().map(|row| middles(row)).collect() };
        Some(Spectrum {
            squares: middles(&squares),
            shapes: Some(nearby(shapes)),
            inverse: nearby(inverse),
        })
    }
}

fn middle(ball: &Ball) -> Rational {
    ball.midpoint().to_rational().unwrap_or_default()
}

pub(super) fn middles(balls: &[Ball]) -> Vec<Rational> {
    balls.iter().map(middle).collect()
}

fn by_name(
    rows: &[Vec<Ball>],
    entry: fn(usize, usize) -> Entry,
) -> impl Iterator<Item = (String, &Ball)> {
    let places = rows.iter().enumerate();
    let all = places.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, b)| (i, j, b)));
    all.map(move |(i, j, ball)| (entry(i, j).name(), ball))
}

impl Enclosed {
    /// All by their names.
    pub(super) fn named(&self) -> BTreeMap<String, &Ball> {
        let squares = self.squares.iter().enumerate().map(|(j, b)| (Entry::Square(j).name(), b));
        let shapes = by_name(&self.shapes, Entry::Shape);
        squares.chain(shapes).chain(by_name(&self.inverse, Entry::Inverse)).collect()
    }
}
