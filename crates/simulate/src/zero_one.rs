//! The 0-1 test for chaos of a time series.

use crate::integrator::Tick;

/// The growth rate K of the mean square displacement of the series' translation variables: near 0
/// for regular, near 1 for chaotic motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroOne {
    /// The median of K_c over the frequencies c.
    pub k: f64,
    /// The lower and the upper quartile of K_c: how far the answer depends on c.
    pub quartiles: (f64, f64),
}

/// Frequencies c per test.
const FREQUENCIES: u32 = 100;
/// What moves by less than this share of its size is constant: the rest is rounding errors.
const CONSTANT: f64 = 1e-9;

/// The 0-1 test of Gottwald and Melbourne (SIAM J. Appl. Dyn. Syst. 8, 2009, 129-145): with
///
/// p_c(n) = sum_{j<=n} phi_j cos jc,  q_c(n) = sum_{j<=n} phi_j sin jc,
/// M_c(n) = mean_j ((p_c(j+n) - p_c(j))^2 + (q_c(j+n) - q_c(j))^2),  n = 1..=N/10,  j = 1..=N - N/10,
///
/// phi_j the numbers of the series less their mean (which would add mean^2 (1 - cos nc)/(1 - cos c) to M_c, in which small
/// motions are lost),
///
/// K_c is the correlation coefficient of M_c(n) and n, K its median over 100 values of c in
/// (pi/5, 4 pi/5) (multiples of the golden ratio modulo 1: the same ones every time).
///
/// A statistical estimate, with no bound; errors like 1/sqrt(N). The series must not be sampled
/// too finely: take stroboscopic points, and every m-th of them where the attractor has m bands
/// (several bands look regular). A series that is constant to nine digits is regular: K = 0. Nothing for
/// less than 100 points or values that are not finite.
/// `tick` is asked before each of the 100 frequencies, nothing if it breaks off. Cost: O(100 N^2/10).
///
/// ```
/// use lindstedt_simulate::{go_on, zero_one};
/// let mut x = 0.3;
/// let logistic: Vec<f64> = (0..2000).map(|_| { x = 3.97 * x * (1.0 - x); x }).collect();
/// let k = zero_one(&logistic, &go_on).map_or(0.0, |test| test.k);
/// assert!(k > 0.99);
/// ```
#[must_use]
pub fn zero_one(series: &[f64], tick: &Tick<'_>) -> Option<ZeroOne> {
    if series.len() < 100 || !series.iter().all(|x| x.is_finite()) {
        return None;
    }
    let motion = about_mean(series);
    let size = |series: &[f64]| series.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size(&motion) <= CONSTANT * size(series) {
        return Some(ZeroOne { k: 0.0, quartiles: (0.0, 0.0) });
    }
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let mut growths: Vec<f64> = (1..=FREQUENCIES)
        .map(|k| std::f64::consts::PI * (0.2 + 0.6 * (f64::from(k) * golden).fract()))
        .map(|c| tick().is_continue().then(|| growth(&motion, c)))
        .collect::<Option<_>>()?;
    growths.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let place = share * (growths.len() - 1) as f64;
        let (low, high) = (place.floor() as usize, place.ceil() as usize);
        growths[low] + (growths[high] - growths[low]) * place.fract()
    };
    Some(ZeroOne { k: at(0.5), quartiles: (at(0.25), at(0.75)) })
}

/// Whether the series visits m bands in turn: the ranges of every m-th number, from each of the first m on, are
/// disjoint. Cost: O(N).
///
/// ```
/// let three: Vec<f64> = (0..300).map(|n| f64::from(n % 3) + 0.3 * f64::from(n).sin()).collect();
/// assert!(lindstedt_simulate::is_in_bands(&three, 3) && !lindstedt_simulate::is_in_bands(&three, 2));
/// ```
#[must_use]
pub fn is_in_bands(series: &[f64], m: usize) -> bool {
    let range = |first: usize| {
        let band = series.iter().skip(first).step_by(m);
        band.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (x.min(low), x.max(high)))
    };
    let mut ranges: Vec<(f64, f64)> = (0..m).map(range).collect();
    ranges.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranges.windows(2).all(|pair| pair[0].1 < pair[1].0)
}

/// Lags at which the halves of a series are compared.
const LAGS: usize = 8;
/// By how many times 1/sqrt(N) they may differ: chaotic series of N points were found to stay below 8, but for
/// one in a hundred.
const SPREAD: f64 = 8.0;

/// Whether the series is stationary as far as its two halves tell, which the 0-1 test presumes: a slow transient
/// whose frequency drifts has K = 1 without chaos. Their means differ by at most 8/sqrt(N)
/// of sqrt(C(0)), and their autocorrelations
///
/// C(k) = mean_j phi_j phi_(j+k),  k = 0..=8,  phi_j the numbers of the series less their mean,
///
/// by at most that of C(0), C(0) that of the whole. A test of statistics: a chaotic series that visits one
/// part of its attractor rarely may fail it. Cost: O(N).
///
/// ```
/// let settles: Vec<f64> = (0..2000).map(|n| (-1e-3 * f64::from(n)).exp() * f64::from(n).cos()).collect();
/// assert!(!lindstedt_simulate::is_stationary(&settles));
/// ```
#[must_use]
pub fn is_stationary(series: &[f64]) -> bool {
    let motion = about_mean(series);
    let (first, second) = motion.split_at(motion.len() / 2);
    let mean = |half: &[f64]| half.iter().sum::<f64>() / half.len() as f64;
    let (limit, square) = (SPREAD / (motion.len() as f64).sqrt(), autocorrelation(&motion, 0));
    let near =
        |lag| (autocorrelation(first, lag) - autocorrelation(second, lag)).abs() <= limit * square;
    (mean(first) - mean(second)).abs() <= limit * square.sqrt() && (0..=LAGS).all(near)
}

/// Of what returns to itself: a chaotic part of a variance below a twentieth is not seen.
const RECURRENT: f64 = 0.95;

/// Whether the series returns to itself after a number of points beyond those of the 0-1 test, |C(k)| > 0.95 C(0) for one
/// k = N/10..=N/2: a motion of few frequencies does, whose harmonics may have a large K where the points are few, since near each
/// of them M_c grows at first; the autocorrelations of chaos decay. Cost: O(N^2).
///
/// ```
/// let slow: Vec<f64> = (0..400).map(|n| (0.02 * f64::from(n)).cos()).collect();
/// assert!(lindstedt_simulate::recurs(&slow));
/// ```
#[must_use]
pub fn recurs(series: &[f64]) -> bool {
    let motion = about_mean(series);
    let limit = RECURRENT * autocorrelation(&motion, 0);
    let mut lags = motion.len() / 10..=motion.len() / 2;
    lags.any(|lag| autocorrelation(&motion, lag).abs() > limit)
}

/// C(k).
fn autocorrelation(motion: &[f64], lag: usize) -> f64 {
    let pairs = motion.iter().zip(motion.iter().skip(lag));
    pairs.map(|(a, b)| a * b).sum::<f64>() / motion.len().saturating_sub(lag) as f64
}

fn about_mean(series: &[f64]) -> Vec<f64> {
    let mean = series.iter().sum::<f64>() / series.len() as f64;
    series.iter().map(|x| x - mean).collect()
}

/// K_c.
fn growth(motion: &[f64], c: f64) -> f64 {
    let (mut p, mut q) = (0.0, 0.0);
    let mut path = Vec::with_capacity(motion.len());
    for (j, phi) in (1u32..).zip(motion) {
        let (sin, cos) = (f64::from(j) * c).sin_cos();
        p += phi * cos;
        q += phi * sin;
        path.push([p, q]);
    }
    let cut = motion.len() / 10;
    let starts = &path[..motion.len() - cut];
    let displacements: Vec<f64> =
        (1..=cut).map(|n| square_of_distance(starts, &path[n..]) / starts.len() as f64).collect();
    correlation(&displacements)
}

/// sum_j |b_j - a_j|^2 over all a_j, in sums that do not wait for one another.
fn square_of_distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let (a, b) = (a.as_flattened(), b[..a.len()].as_flattened());
    let ((eights, rest), (others, other)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in eights.iter().zip(others) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += (b - a) * (b - a);
        }
    }
    let rest: f64 = rest.iter().zip(other).map(|(a, b)| (b - a) * (b - a)).sum();
    sums.iter().sum::<f64>() + rest
}

/// The correlation coefficient of d_n with n; zero for a constant.
fn correlation(d: &[f64]) -> f64 {
    let n = d.len() as f64;
    let (middle, mean) = ((n + 1.0) / 2.0, d.iter().sum::<f64>() / n);
    let (mut mixed, mut squares, mut spread) = (0.0, 0.0, 0.0);
    for (k, value) in (1u32..).zip(d) {
        let (x, y) = (f64::from(k) - middle, value - mean);
        mixed += x * y;
        squares += x * x;
        spread += y * y;
    }
    if spread > 0.0 { mixed / (squares * spread).sqrt() } else { 0.0 }
}
