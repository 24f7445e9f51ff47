//! What Newton's method for a tangency needs besides G and dG/dsigma, carried from one search to the next.

/// Steps below this tell of rounding errors, not of derivatives.
const TELLS: f64 = 1e-8;

/// What one search for a tangency leaves to the next, of an orbit followed for another time.
pub(super) struct Known {
    pub steps: Steps,
    /// The last derivatives, and the time N + sigma, in periods, of the orbit that they are of.
    pub derivatives: Option<(f64, Derivatives)>,
}

impl Default for Known {
    fn default() -> Self {
        Self { steps: Steps { value: 1e-6, phase: 1e-5 }, derivatives: None }
    }
}

/// Half widths of differences by the value and by the phase.
pub(super) struct Steps {
    pub value: f64,
    pub phase: f64,
}

impl Steps {
    /// No longer than what changes G by 1e-4.
    pub fn shorten(&mut self, Derivatives { by_value, curvature }: &Derivatives) {
        self.value = self.value.min((1e-4 / by_value[0]).abs());
        self.phase = self.phase.min((1e-4 / curvature).abs().sqrt());
    }
}

/// Of G and dG/dsigma by the value, and d^2 G/dsigma^2.
#[derive(Clone, Copy)]
pub(super) struct Derivatives {
    pub by_value: [f64; 2],
    pub curvature: f64,
}

impl Derivatives {
    pub fn times(self, growth: f64) -> Self {
        let Self { by_value, curvature } = self;
        Self { by_value: by_value.map(|d| growth * d), curvature: growth * curvature }
    }

    /// The derivatives after a step, by what G and dG/dsigma came to: dG/dsigma is known, the rest by the least change that
    /// agrees (Broyden, Math. Comp. 19, 1965).
    pub fn corrected(self, [last, found]: [[f64; 2]; 2], [dv, dp]: [f64; 2]) -> Self {
        let Self { by_value: [mut value, mut slope], mut curvature } = self;
        let square = dv * dv + dp * dp;
        if square.sqrt() < TELLS {
            return self;
        }
        let missing = found[1] - last[1] - slope * dv - curvature * dp;
        slope += missing * dv / square;
        curvature += missing * dp / square;
        // Of a small part of the step the other one tells more.
        if dv.abs() > 0.1 * dp.abs() {
            value = (found[0] - last[0] - (last[1] + found[1]) / 2.0 * dp) / dv;
        }
        Self { by_value: [value, slope], curvature }
    }

    /// The step in the value and in the phase to G = dG/dsigma = 0.
    pub fn step(&self, [g, slope]: [f64; 2]) -> [f64; 2] {
        let determinant = self.by_value[0] * self.curvature - self.by_value[1] * slope;
        let dv = (slope * slope - g * self.curvature) / determinant;
        let dp = (g * self.by_value[1] - slope * self.by_value[0]) / determinant;
        [dv, dp]
    }
}
