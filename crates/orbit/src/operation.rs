//! Sine, cosine, exponential and roots: values, signs and bounds.

use crate::upward::Up;
use rug::Float;

/// Which function of its argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Operation {
    /// e^p.
    Exponential,
    /// sin p; the cosine of the same argument follows it.
    Sine,
    /// cos p; the sine of the same argument stands before it.
    Cosine,
    /// p^(-1/q).
    Root(u32),
}

impl Operation {
    /// This one, and the cosine with a sine.
    pub(crate) fn list(&self) -> &[Self] {
        match self {
            Self::Sine | Self::Cosine => &[Self::Sine, Self::Cosine],
            other => std::slice::from_ref(other),
        }
    }

    /// Whether the function is smooth between values of its argument: a root where they have one sign.
    pub(crate) fn takes(self, negative: impl Iterator<Item = bool>) -> bool {
        let Self::Root(q) = self else { return true };
        let (mut above, mut below) = (false, false);
        negative.for_each(|is| if is { below = true } else { above = true });
        !below || (q == 1 && !above)
    }

    /// The values at a value of the argument; nothing where there is none.
    pub(crate) fn value(self, p: &Float) -> Option<Vec<Float>> {
        match self {
            Self::Exponential => Some(vec![p.clone().exp()]),
            Self::Sine | Self::Cosine => Some(vec![p.clone().sin(), p.clone().cos()]),
            Self::Root(1) => (!p.is_zero()).then(|| vec![p.clone().recip()]),
            Self::Root(q) => (*p > 0).then(|| vec![p.clone().root(q).recip()]),
        }
    }

    /// The value at a value of the argument; not a number where there is none.
    pub(crate) fn in_doubles(self, p: f64) -> f64 {
        match self {
            Self::Exponential => p.exp(),
            Self::Sine => p.sin(),
            Self::Cosine => p.cos(),
            Self::Root(1) => p.recip(),
            Self::Root(q) => p.powf(-1.0 / f64::from(q)),
        }
    }

    /// How the sign of the function changes where that of its argument does; nothing for neither.
    pub(crate) fn sign(self, argument: Option<bool>) -> Option<bool> {
        match self {
            Self::Sine => argument,
            Self::Cosine => argument.map(|_| false),
            Self::Exponential | Self::Root(_) => argument.filter(|changes| !changes),
        }
    }

    /// Bounds of the function and of its derivative where its argument differs by at most `by` from the one at
    /// which the function is `size` (and its partner, cosine or sine, `partner`).
    pub(crate) fn outer(self, size: Up, partner: Up, by: Up) -> [Up; 2] {
        let rise = by.exponential_less_one();
        match self {
            Self::Exponential => [size * (Up::ONE + rise); 2],
            // cosh <= 1 + rise^2/2, sinh <= rise.
            Self::Sine | Self::Cosine => {
                let cosh = Up::ONE + rise * rise * Up(0.5);
                [size * cosh + partner * rise, partner * cosh + size * rise]
            }
            // |1 + d/p|^(-1/q) <= 1/(1 - t), t = |1/p| |d|; the derivative is -root^(q + 1)/q.
            Self::Root(q) => {
                let left = (1.0 - (size.powi(q) * by).0).next_down();
                let outer = if left > 0.0 { size.over(left) } else { Up(f64::INFINITY) };
                [outer, outer.powi(q + 1)]
            }
        }
    }
}
