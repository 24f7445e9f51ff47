//! Friction laws T(w), w = v - v* the sliding speed: the force on the mass is -eps T.

use crate::MelnikovError;
use crate::error::positive;
use lindstedt_number::Exact;
use rug::Float;
use rug::ops::Pow;
use std::fmt;
use std::sync::Arc;

/// The largest degree of a polynomial law.
pub const LARGEST_DEGREE: usize = 1000;

/// T(w) = T0 sgn w + sum_k t_k w^k, with sgn 0 = 0: everything in closed form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolynomialFriction {
    /// T0, of any sign.
    pub dry: Exact,
    /// t_k at index k.
    pub coefficients: Vec<Exact>,
}

impl PolynomialFriction {
    /// T(w) = T0 sgn w - alpha w + beta w^3.
    #[must_use]
    pub fn cubic(dry: Exact, alpha: &Exact, beta: Exact) -> Self {
        Self { dry, coefficients: vec![Exact::from(0), -alpha, Exact::from(0), beta] }
    }
    pub(crate) fn check(&self) -> Result<(), MelnikovError> {
        let degree = self.coefficients.len().saturating_sub(1);
        if degree > LARGEST_DEGREE {
            return Err(MelnikovError::DegreeTooLarge { degree, limit: LARGEST_DEGREE });
        }
        Ok(())
    }
}

/// The function of a law without closed form: T(w) at the precision of w.
pub type Law = Arc<dyn Fn(&Float) -> Float + Send + Sync>;

/// A friction law.
#[derive(Clone)]
#[non_exhaustive]
pub enum Friction {
    /// Exact: dry friction and a polynomial.
    Polynomial(PolynomialFriction),
    /// Stribeck: sgn(w) (F_c + (F_s - F_c) e^{-|w|/v_s}) + c w, v_s > 0.
    Stribeck {
        /// F_c, the Coulomb force.
        coulomb: Exact,
        /// F_s, the static force.
        stiction: Exact,
        /// v_s > 0.
        speed: Exact,
        /// c.
        viscous: Exact,
    },
    /// T0 sgn(w)/(1 + d|w|), d >= 0.
    Rational {
        /// T0.
        dry: Exact,
        /// d >= 0.
        slope: Exact,
    },
    /// T0 tanh(w/s), s > 0: smoothed dry friction.
    HyperbolicTangent {
        /// T0.
        dry: Exact,
        /// s > 0.
        speed: Exact,
    },
    /// T0 atan(w/s), s > 0.
    ArcTangent {
        /// T0.
        dry: Exact,
        /// s > 0.
        speed: Exact,
    },
    /// w/(1 + |w|).
    SoftSign,
    /// T0 sgn(w)|w|^p, p > -1.
    SignedPower {
        /// T0.
        dry: Exact,
        /// p > 0.
        exponent: Exact,
    },
    /// Any law, with the sliding speeds where it is not smooth (0 is not implied).
    Custom {
        /// T(w).
        law: Law,
        /// The kinks and jumps of T.
        kinks: Vec<f64>,
    },
}

impl fmt::Debug for Friction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.formula())
    }
}

impl Friction {
    /// The law as a formula.
    #[must_use]
    pub fn formula(&self) -> String {
        match self {
            Self::Polynomial(p) => {
                let mut terms = vec![format!("({}) sgn w", p.dry)];
                let power = |(k, t)| format!("({t}) w^{k}");
                terms.extend(p.coefficients.iter().enumerate().map(power));
                terms.join(" + ")
            }
            Self::Stribeck { coulomb, stiction, speed, viscous } => format!(
                "sgn(w) ({coulomb} + ({stiction} - {coulomb}) exp(-|w|/({speed}))) + ({viscous}) w"
            ),
            Self::Rational { dry, slope } => format!("({dry}) sgn(w)/(1 + ({slope})|w|)"),
            Self::HyperbolicTangent { dry, speed } => format!("({dry}) tanh(w/({speed}))"),
            Self::ArcTangent { dry, speed } => format!("({dry}) atan(w/({speed}))"),
            Self::SoftSign => "w/(1 + |w|)".to_owned(),
            Self::SignedPower { dry, exponent } => format!("({dry}) sgn(w) |w|^({exponent})"),
            Self::Custom { kinks, .. } => format!("a custom law with kinks at {kinks:?}"),
        }
    }

    /// Parameters in their domains.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`] or [`MelnikovError::DegreeTooLarge`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        match self {
            Self::Polynomial(p) => p.check(),
            Self::Stribeck { speed, .. }
            | Self::HyperbolicTangent { speed, .. }
            | Self::ArcTangent { speed, .. } => positive(speed, "speed"),
            Self::Rational { slope, .. } if slope.sign().is_lt() => {
                Err(MelnikovError::NotPositive { name: "slope" })
            }
            Self::SignedPower { exponent, .. } => positive(exponent, "exponent"),
            Self::Custom { kinks, .. } if kinks.iter().any(|k| !k.is_finite()) => {
                Err(MelnikovError::NotFinite { name: "kink" })
            }
            _ => Ok(()),
        }
    }

    /// Where T is not smooth.
    #[must_use]
    pub fn kinks(&self) -> Vec<f64> {
        match self {
            Self::HyperbolicTangent { .. } | Self::ArcTangent { .. } => Vec::new(),
            Self::Custom { kinks, .. } => kinks.clone(),
            _ => vec![0.0],
        }
    }

    /// T at floats of `bits` bits (the constants are enclosed once).
    #[must_use]
    pub fn law(&self, bits: u32) -> Law {
        let balls = lindstedt_number::ball::Balls::new(bits);
        let float = |x: &Exact| x.ball(balls).midpoint().clone();
        let abs = move |w: &Float| Float::with_val(bits, w.abs_ref());
        // sgn(w) m, with sgn 0 = 0.
        let signed = move |w: &Float, m: Float| match w.cmp0() {
            Some(std::cmp::Ordering::Greater) => m,
            Some(std::cmp::Ordering::Less) => -m,
            _ => Float::new(bits),
        };
        match self {
            Self::Polynomial(p) => {
                let dry = float(&p.dry);
                let coefficients: Vec<Float> = p.coefficients.iter().map(float).collect();
                Arc::new(move |w| {
                    let horner = |sum: Float, t: &Float| sum * w + t;
                    let smooth = coefficients.iter().rev().fold(Float::new(bits), horner);
                    signed(w, dry.clone()) + smooth
                })
            }
            Self::Stribeck { coulomb, stiction, speed, viscous } => {
                let (coulomb, stiction) = (float(coulomb), float(stiction));
                let (speed, viscous) = (float(speed), float(viscous));
                Arc::new(move |w| {
                    let decay = (-(abs(w) / &speed)).exp();
                    let size = Float::with_val(bits, &stiction - &coulomb) * decay + &coulomb;
                    signed(w, size) + Float::with_val(bits, w * &viscous)
                })
            }
            Self::Rational { dry, slope } => {
                let (dry, slope) = (float(dry), float(slope));
                Arc::new(move |w| signed(w, dry.clone() / (abs(w) * &slope + 1u32)))
            }
            Self::HyperbolicTangent { dry, speed } => {
                let (dry, speed) = (float(dry), float(speed));
                Arc::new(move |w| Float::with_val(bits, w / &speed).tanh() * &dry)
            }
            Self::ArcTangent { dry, speed } => {
                let (dry, speed) = (float(dry), float(speed));
                Arc::new(move |w| Float::with_val(bits, w / &speed).atan() * &dry)
            }
            Self::SoftSign => Arc::new(move |w| Float::with_val(bits, w / (abs(w) + 1u32))),
            Self::SignedPower { dry, exponent } => {
                let (dry, exponent) = (float(dry), float(exponent));
                Arc::new(move |w| signed(w, abs(w).pow(&exponent) * &dry))
            }
            Self::Custom { law, .. } => Arc::clone(law),
        }
    }
}
