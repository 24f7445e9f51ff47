//! The guess from which Newton's method starts.

use crate::centre::Component;
use nalgebra::Complex;
use rug::Rational;
use std::f64::consts::TAU;

/// A guess of a periodic orbit: x = sum_k (cosine_k cos k tau + sine_k sin k tau), tau = omega t;
/// from an expansion's sum, or from a simulation ([`Start::from_samples`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// omega > 0. Ignored for a forced orbit, whose frequency is the force's.
    pub frequency: f64,
    /// The coefficients of cos k tau, k = 0, 1, ...
    pub cosines: Vec<f64>,
    /// The coefficients of sin k tau, k = 0, 1, ...; the first is ignored.
    pub sines: Vec<f64>,
}

impl Start {
    /// The discrete Fourier transform of x(j T/n), j = 0..n, over one period T; n samples give the modes up
    /// to n/4 (the others are left to Newton's method). Cost n^2/4.
    ///
    /// ```
    /// use lindstedt_orbit::Start;
    /// let samples: Vec<f64> = (0..32).map(|j| (j as f64 * std::f64::consts::TAU / 32.0).cos()).collect();
    /// let start = Start::from_samples(std::f64::consts::TAU, &samples);
    /// assert!((start.cosines[1] - 1.0).abs() < 1e-15 && (start.frequency - 1.0).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn from_samples(period: f64, samples: &[f64]) -> Self {
        let n = samples.len();
        let coefficient = |k: usize, wave: fn(f64) -> f64| {
            let angle = |j: usize| TAU * ((j * k % n) as f64) / n as f64;
            let sum: f64 = samples.iter().enumerate().map(|(j, x)| x * wave(angle(j))).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
        };
        let modes = 0..=n / 4;
        Self {
            frequency: TAU / period,
            cosines: modes.clone().map(|k| coefficient(k, f64::cos)).collect(),
            sines: modes.map(|k| coefficient(k, f64::sin)).collect(),
        }
    }

    /// The numerical solution in doubles.
    pub(crate) fn of(frequency: &Rational, component: &Component) -> Self {
        let modes = component.doubles();
        let times = |k: usize| if k == 0 { 1.0 } else { 2.0 };
        Self {
            frequency: frequency.to_f64(),
            cosines: modes.iter().enumerate().map(|(k, c)| times(k) * c.re).collect(),
            sines: modes.iter().map(|c| -2.0 * c.im).collect(),
        }
    }

    /// sum_k |c_k|, twice those that oscillate.
    pub(crate) fn size(&self) -> f64 {
        self.complex().iter().map(|c| 2.0 * c.norm()).sum()
    }

    /// Whether the harmonics that oscillate have this share of the sum.
    pub(crate) fn oscillates(&self, share: f64) -> bool {
        let whole: f64 = self.complex().iter().skip(1).map(|c| 2.0 * c.norm()).sum();
        whole > share * self.size()
    }

    /// Whether frequency and harmonics agree, relative to their size.
    pub(crate) fn is_near(&self, other: &Self, relative: f64) -> bool {
        distance(std::slice::from_ref(self), std::slice::from_ref(other)) <= relative
    }

    /// sum_k |c_k| of the difference, twice those that oscillate.
    fn apart(&self, other: &Self) -> f64 {
        let (a, b) = (self.complex(), other.complex());
        let at = |list: &[Complex<f64>], k: usize| list.get(k).copied().unwrap_or_default();
        (0..a.len().max(b.len())).map(|k| 2.0 * (at(&a, k) - at(&b, k)).norm()).sum()
    }

    /// c_k = (cosine_k - i sine_k)/2.
    pub(crate) fn complex(&self) -> Vec<Complex<f64>> {
        let modes = self.cosines.len().max(self.sines.len());
        let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        let one = |k| match k {
            0 => Complex::new(at(&self.cosines, 0), 0.0),
            k => Complex::new(at(&self.cosines, k), -at(&self.sines, k)) / 2.0,
        };
        (0..modes).map(one).collect()
    }
}

/// The distance of the harmonics of all unknowns or of the frequencies, relative to the size of the first.
pub(crate) fn distance(one: &[Start], other: &[Start]) -> f64 {
    let apart: f64 = one.iter().zip(other).map(|(a, b)| a.apart(b)).sum();
    let apart = apart / one.iter().map(Start::size).sum::<f64>();
    let detuned =
        one.iter().zip(other).map(|(a, b)| (a.frequency - b.frequency).abs() / a.frequency);
    detuned.fold(apart, f64::max)
}

/// The same orbit with its phase moved so that the first harmonic of the first unknown is a positive multiple
/// of cos tau.
pub(crate) fn in_phase(mut unknowns: Vec<Vec<Complex<f64>>>) -> Vec<Vec<Complex<f64>>> {
    let angle = unknowns[0].get(1).map_or(0.0, |c| c.arg());
    for modes in &mut unknowns {
        for (k, c) in modes.iter_mut().enumerate() {
            *c *= Complex::from_polar(1.0, -angle * k as f64);
        }
    }
    unknowns
}
