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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Exact;
    use crate::laurent::Laurent;
    use crate::transform::samples_to_modes;
    use rug::{Integer, Rational};

    const BITS: u32 = 80;

    /// size times the mean of cosines with these frequencies, about a middle.
    fn cosines(middle: f64, size: f64, waves: &[usize]) -> Exact {
        let whole =
            |x: f64| Float::with_val(64, x * 2f64.powi(60)).to_integer().unwrap_or_default();
        let mut f = Laurent::zero(waves.iter().max().copied().unwrap_or(0));
        f.re[0] = whole(middle);
        waves.iter().for_each(|k| f.re[*k] += whole(size / waves.len() as f64 / 2.0));
        Exact { modes: f, scale: Rational::from((1, Integer::from(1) << 60u32)) }
    }

    /// The norms of the functions (of an even root with its derivative -root^(q + 1)/q).
    fn norms(kind: Operation, p: &Exact) -> Vec<f64> {
        let list = samples_to_modes(p, BITS, kind, &Default::default()).unwrap();
        list.into_iter().map(|f| Exact::over_power(f, BITS).norm(Up::ONE, 0).0).collect()
    }

    /// p + h for h = -size, size and a mean of cosines that have hardly a common wave: the norms are nearly those of
    /// the bound.
    #[test]
    fn functions_and_slopes_stay_below_their_bounds() {
        for (kind, middle, size) in [
            (Operation::Exponential, 0.3, 1.0),
            (Operation::Sine, 0.0, 1.5),
            (Operation::Sine, 0.4, 0.8),
            (Operation::Root(1), 2.0, 1.0),
            (Operation::Root(2), 2.0, 1.0),
        ] {
            let still = norms(kind, &cosines(middle, 0.0, &[]));
            let steps = [
                cosines(middle - size, 0.0, &[]),
                cosines(middle + size, 0.0, &[]),
                cosines(middle, size, &[1, 4, 16, 64]),
            ];
            let list = steps.map(|p| norms(kind, &p));
            let most = |i: usize| list.iter().map(|n| n[i]).fold(0.0, f64::max);
            let by = Up(size);
            match kind {
                Operation::Sine => {
                    let [s, c] = [Up(still[0]), Up(still[1])];
                    let [sine, slope] = Operation::Sine.outer(s, c, by);
                    let [cosine, fall] = Operation::Cosine.outer(c, s, by);
                    for (truth, bound) in
                        [(most(0), sine), (most(1), slope), (most(1), cosine), (most(0), fall)]
                    {
                        assert!(truth <= bound.0 && bound.0 < 8.0 * truth, "{truth} {bound:?}");
                    }
                    // The mean of cosines alone has a cosine of more than its value at 0.
                    assert!(middle > 0.0 || most(1) > 1.0);
                }
                _ => {
                    let [function, slope] = kind.outer(Up(still[0]), Up(still[0]), by);
                    let derivative = match kind {
                        Operation::Root(q) => most(0).powi(q as i32 + 1) / f64::from(q),
                        _ => most(0),
                    };
                    assert!(most(0) <= function.0 * (1.0 + 1e-12) && function.0 < 2.0 * most(0));
                    assert!(derivative <= slope.0 * (1.0 + 1e-12) && slope.0 < 6.0 * derivative);
                }
            }
        }
    }
}
