//! Sines, cosines, exponentials and roots of a trigonometric polynomial, as elements of the algebra.
//!
//! An approximation comes from samples on a grid; nothing depends on how. That it is near the function is
//! proved afterwards by what ties it to its argument p, formed exactly, e being the approximation:
//! * exponential: with rho = e' - p' e the quotient e exp(-p) has the derivative rho exp(-p), so that
//!   |e exp(-p) - 1| <= |e(0) exp(-p(0)) - 1| + 2 |rho| exp|p|;
//! * sine and cosine: the same for the rotation (c + i s) exp(-i p), with rho_c = c' + p' s and
//!   rho_s = s' - p' c;
//! * root: with 1 - p e^q = d the root p^(-1/q) is e (1 - d)^(-1/q), the binomial series.

use crate::centre::Variables;
use crate::exact::Exact;
use crate::field::Function;
use crate::laurent::Laurent;
use crate::operation::Operation;
use crate::upward::Up;
use lindstedt_number::ball::{Ball, Balls};

/// Approximations at a centre (of a sine also its cosine), with what ties them to their argument.
#[derive(Clone, Debug)]
pub(crate) struct Tied {
    kind: Operation,
    pub(crate) functions: Vec<Exact>,
    argument: Exact,
    /// rho, or 1 - p e^q.
    defects: Vec<Exact>,
    /// What the functions miss at tau = 0, in units of 2^-bits; infinite where that excludes them.
    start: Up,
    bits: u32,
}

/// The largest norm of an argument that an exponential is taken of.
const MOST_NORM: f64 = 200.0;

impl Function {
    /// The approximations with what ties them.
    pub(crate) fn tie(&self, variables: &mut Variables<'_>, functions: &[Laurent]) -> Tied {
        let argument = variables.exact(&self.argument, 0);
        Tied::new(self.kind, argument, functions, variables.bits())
    }
}

/// A number of units of 2^-bits as a number, rounded up.
pub(crate) fn from_units(x: Up, bits: u32) -> Up {
    x * Up(2f64.powi(-(bits.min(1000) as i32)))
}

/// |x| in units of 2^-bits.
fn in_units(x: &Ball, bits: u32) -> Up {
    Up::of_float(&(x.abs_upper() << bits))
}

impl Tied {
    fn new(kind: Operation, argument: Exact, functions: &[Laurent], bits: u32) -> Self {
        let count = if kind == Operation::Sine { 2 } else { 1 };
        let functions = functions.iter().take(count);
        let functions: Vec<_> = functions.map(|f| Exact::over_power(f.clone(), bits)).collect();
        let (slope, balls) = (argument.derivative(), Balls::new(bits + 64));
        let ball = |f: &Exact| balls.from_rational(&f.at_zero());
        let angle = ball(&argument);
        let (defects, start) = match (kind, &functions[..]) {
            (Operation::Root(q), [root]) => {
                let power = (1..q).fold(root.clone(), |power, _| power.times(root));
                let one = Exact::over_power(Laurent::one(), 0);
                // An even root has the sign +.
                let start = if q == 1 || root.at_zero() > 0 { 0.0 } else { f64::INFINITY };
                (vec![one.minus(&argument.times(&power))], Up(start))
            }
            (Operation::Exponential, [e]) => {
                let start = balls.mul(&balls.exp(&balls.neg(&angle)), &ball(e));
                let rho = e.derivative().minus(&slope.times(e));
                (vec![rho], in_units(&balls.sub(&start, &balls.one()), bits))
            }
            (_, [s, c]) => {
                let [sin, cos] = [balls.sin(&angle), balls.cos(&angle)];
                let u = balls.add(&balls.mul(&ball(c), &cos), &balls.mul(&ball(s), &sin));
                let w = balls.sub(&balls.mul(&ball(s), &cos), &balls.mul(&ball(c), &sin));
                let start = in_units(&balls.sub(&u, &balls.one()), bits) + in_units(&w, bits);
                let by_cosine = c.derivative().minus(&slope.times(s).scaled(-1));
                (vec![by_cosine, s.derivative().minus(&slope.times(c))], start)
            }
            _ => (Vec::new(), Up(f64::INFINITY)),
        };
        Self { kind, functions, argument, defects, start, bits }
    }

    /// The norm of the argument.
    pub(crate) fn size(&self, nu: Up) -> Up {
        self.argument.norm(nu, 0)
    }

    /// A bound of the distance of each function from its approximation in the norm with the weight nu, in
    /// units of 2^-bits, where the argument is uncertain by so many of them; nothing where it is too large.
    pub(crate) fn error(&self, nu: Up, uncertain: Up) -> Option<Up> {
        let own: Up = self.defects.iter().map(|f| f.norm(nu, self.bits)).sum();
        let norm: Up = self.functions.iter().map(|f| f.norm(nu, 0)).sum();
        let (twice, small) = (Up(2.0), |x: Up, most: f64| from_units(x, self.bits).0 < most);
        if let Operation::Root(q) = self.kind {
            // (1 - d)^(-1/q) - 1 <= d/(1 - d) <= 2 d.
            let delta = own + self.start + uncertain * norm.powi(q);
            return small(delta, 0.5).then(|| twice * norm * delta);
        }
        let size = self.argument.norm(nu, 0);
        if size.0.is_nan() || size.0 > MOST_NORM || !small(uncertain, 1.0) {
            return None;
        }
        // |sin p|, |cos p|, |exp(-p)| <= exp|p|.
        let bound = Up::ONE + size.exponential_less_one();
        if self.kind == Operation::Exponential {
            // |e - exp p| <= |e| eta/(1 - eta); |exp(p + d) - exp p| <= 2 |d| |exp p| for |d| <= 1.
            let eta = self.start + twice * own * bound;
            return small(eta, 0.5).then(|| norm * (twice * eta + Up(4.0) * uncertain));
        }
        let own = (self.start + Up(4.0) * own * bound) * bound;
        let norm = norm + twice * from_units(own, self.bits);
        Some(own + twice * norm * uncertain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transform::samples_to_modes;

    fn argument() -> Exact {
        // 1/2 + 2 * 3/8 cos tau - 2 * 1/8 sin 2 tau.
        let number = |n: i64| rug::Integer::from(n);
        let re = [4, 3, 0].map(number).to_vec();
        let im = [0, 0, 1].map(number).to_vec();
        Exact::over_power(Laurent { re, im }, 3)
    }

    /// Every error is small where the approximation is right, and covers what a coefficient was moved by.
    #[test]
    fn a_moved_coefficient_is_seen() {
        const BITS: u32 = 120;
        let (nu, p) = (Up(1.1), argument());
        let shift = rug::Integer::from(1) << 40u32;
        for kind in
            [Operation::Exponential, Operation::Sine, Operation::Root(1), Operation::Root(2)]
        {
            let p = match kind {
                Operation::Root(_) => Exact::over_power(Laurent::one(), 0).minus(&p.scaled(-1)),
                _ => p.clone(),
            };
            let list = samples_to_modes(&p, BITS, kind, &Default::default()).unwrap();
            let error =
                |list: &[Laurent]| Tied::new(kind, p.clone(), list, BITS).error(nu, Up::ZERO);
            let right = error(&list).unwrap();
            assert!(right.0 < 1e7, "{kind:?}: {right:?}");
            // A multiple of an exponential, or of sine and cosine, has no defect but its start.
            let mut forged = list.clone();
            for c in forged.iter_mut().flat_map(|f| f.re.iter_mut().chain(&mut f.im)) {
                *c += c.clone() >> 80u32;
            }
            assert!(error(&forged).unwrap().0 > 2f64.powi(39), "{kind:?}");
            for k in [0, 2] {
                let mut forged = list.clone();
                forged[0].re[k] += &shift;
                let seen = error(&forged).unwrap().0;
                assert!(seen > 2f64.powi(40) && seen < 2f64.powi(52), "{kind:?} {k}: {seen}");
            }
        }
    }
}
