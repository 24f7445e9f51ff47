//! x(t) as a Fourier series in doubles.

use num_traits::Float;

/// x as a Fourier series in omega t.
#[derive(Clone, Debug)]
pub struct Fourier {
    /// (c_k, s_k) of c_k cos(k omega t) + s_k sin(k omega t).
    pub coefficients: Vec<(f64, f64)>,
    /// What the harmonics that are left out add at most, as far as it was seen.
    pub deviation: f64,
    /// What the estimated errors of x allow a coefficient to be wrong by; nothing without estimates.
    pub error: Option<f64>,
    /// The largest estimated error of x where the coefficients were taken; infinite without estimates.
    pub largest_error: f64,
}

impl Fourier {
    /// x at the phase omega t, sum_k c_k cos(k omega t) + s_k sin(k omega t), in any floating-point
    /// type: doubles, singles, dual numbers whose derivative part is dx/d(omega t).
    ///
    /// One sine and one cosine; the harmonics follow by the addition formulas, with a rounding
    /// error of at most about two units in the last place per harmonic. Nothing is allocated.
    ///
    /// ```
    /// use lindstedt_evaluation::Fourier;
    /// // 2 cos(omega t) + sin(2 omega t)/2.
    /// let coefficients = vec![(0.0, 0.0), (2.0, 0.0), (0.0, 0.5)];
    /// let x = Fourier { coefficients, deviation: 0.0, error: None, largest_error: 0.0 };
    /// assert!((x.at(1.0f64) - (2.0 * 1f64.cos() + 2f64.sin() / 2.0)).abs() < 1e-15);
    /// assert!((x.at(1.0f32) - 1.535_253_3).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn at<T: Float>(&self, phase: T) -> T {
        let (sine, cosine) = phase.sin_cos();
        let double = |x: f64| T::from(x).unwrap_or_else(T::nan);
        let (mut c, mut s, mut sum) = (T::one(), T::zero(), T::zero());
        for &(of_cosine, of_sine) in &self.coefficients {
            sum = sum + double(of_cosine) * c + double(of_sine) * s;
            (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
        }
        sum
    }
}

/// (c_k, s_k) of values at the phases 2 pi (i + 1/2)/n, by the trapezoidal rule.
pub(super) fn harmonic(values: &[f64], k: usize) -> (f64, f64) {
    let count = values.len() as f64;
    let weight = if k == 0 { 1.0 } else { 2.0 } / count;
    values.iter().enumerate().fold((0.0, 0.0), |(c, s), (i, x)| {
        let angle = k as f64 * (i as f64 + 0.5) * std::f64::consts::TAU / count;
        (c + weight * x * angle.cos(), s + weight * x * angle.sin())
    })
}
