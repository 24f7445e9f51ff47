//! Real trigonometric polynomials with integer coefficients, multiplied exactly.
//!
//! f = sum_(|k| <= M) c_k e^(i k tau) with c_(-k) = conj c_k. A product is one product of long
//! integers (Kronecker's substitution): the coefficients stand side by side in one integer, far
//! enough apart that the sums of the product do not meet. GMP multiplies in nearly linear time, so
//! that a residual is computed without any rounding at a cost of about M log M.

use rug::Integer;
use rug::integer::Order;

/// c_0..=c_M of a real function, as integers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Laurent {
    pub(crate) re: Vec<Integer>,
    pub(crate) im: Vec<Integer>,
}

impl Laurent {
    /// 0 with the modes |k| <= `modes`.
    pub(crate) fn zero(modes: usize) -> Self {
        Self { re: vec![Integer::new(); modes + 1], im: vec![Integer::new(); modes + 1] }
    }

    /// The constant 1.
    pub(crate) fn one() -> Self {
        Self { re: vec![Integer::from(1)], im: vec![Integer::new()] }
    }

    /// M.
    pub(crate) fn modes(&self) -> usize {
        self.re.len().saturating_sub(1)
    }

    /// df/dtau: c_k becomes i k c_k.
    pub(crate) fn derivative(&self) -> Self {
        let with = |list: &[Integer], sign: i64| {
            let each = list.iter().zip(0i64..);
            each.map(|(c, k)| Integer::from(c * (sign * k))).collect()
        };
        Self { re: with(&self.im, -1), im: with(&self.re, 1) }
    }

    /// The modes |k| <= `modes` alone, zeros appended where there are fewer.
    pub(crate) fn resize(&mut self, modes: usize) {
        self.re.resize_with(modes + 1, Integer::new);
        self.im.resize_with(modes + 1, Integer::new);
    }

    /// All modes above the last nonzero one left out.
    pub(crate) fn trim(&mut self) {
        let nonzero = |k: &usize| !(self.re[*k].is_zero() && self.im[*k].is_zero());
        let last = (0..self.re.len()).rev().find(nonzero).unwrap_or(0);
        self.resize(last);
    }

    /// f g, exactly.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let modes = self.modes() + other.modes();
        let length = self.modes().min(other.modes()) * 2 + 1;
        let bits = self.bits() + other.bits() + length.ilog2() + 6;
        let words = bits.div_ceil(64) as usize;
        let (a, b) = (Packed::new(self, words), Packed::new(other, words));
        // (R + S)(R' + S') for the even part R (real coefficients) and i times the odd part.
        let even = Integer::from(&a.re * &b.re);
        let mut product = Self::zero(modes);
        match (&a.im, &b.im) {
            (None, None) => product.re = upper(even, modes, words),
            (Some(s), None) => {
                product.re = upper(even, modes, words);
                product.im = upper(Integer::from(s * &b.re), modes, words);
            }
            (None, Some(s)) => {
                product.re = upper(even, modes, words);
                product.im = upper(Integer::from(&a.re * s), modes, words);
            }
            (Some(s), Some(t)) => {
                let odd = Integer::from(s * t);
                let mixed = Integer::from(&a.re + s) * Integer::from(&b.re + t) - &even - &odd;
                product.re = upper(even - odd, modes, words);
                product.im = upper(mixed, modes, words);
            }
        }
        product
    }

    /// Bits of the largest coefficient.
    fn bits(&self) -> u32 {
        let all = self.re.iter().chain(&self.im);
        all.map(Integer::significant_bits).max().unwrap_or(0)
    }
}

/// sum_k c_k 2^(64 words (k + M)), k = -M..=M, for the real and the imaginary parts.
struct Packed {
    re: Integer,
    /// Nothing for an even function.
    im: Option<Integer>,
}

impl Packed {
    fn new(f: &Laurent, words: usize) -> Self {
        let odd = f.im.iter().any(|c| !c.is_zero());
        Self { re: pack(&f.re, false, words), im: odd.then(|| pack(&f.im, true, words)) }
    }
}

fn pack(half: &[Integer], odd: bool, words: usize) -> Integer {
    let modes = half.len() - 1;
    // Positive and negative values apart: digits are unsigned.
    let mut signed = [vec![0u64; (2 * modes + 1) * words], vec![0u64; (2 * modes + 1) * words]];
    for (k, c) in half.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
        let digits = c.as_abs().to_digits::<u64>(Order::Lsf);
        let negative = usize::from(c.is_negative());
        let mirrored = if odd { 1 - negative } else { negative };
        let mut put = |sign: usize, slot: usize| {
            signed[sign][slot * words..slot * words + digits.len()].copy_from_slice(&digits);
        };
        put(negative, modes + k);
        if k > 0 {
            put(mirrored, modes - k);
        }
    }
    let [positive, negative] = signed.map(|digits| Integer::from_digits(&digits, Order::Lsf));
    positive - negative
}

/// The coefficients k = 0..=modes of a packed product.
fn upper(mut product: Integer, modes: usize, words: usize) -> Vec<Integer> {
    // A bias makes every value positive: no borrows between the slots.
    let slots = 2 * modes + 1;
    let mut bias = vec![0u64; slots * words];
    bias.iter_mut().skip(words - 1).step_by(words).for_each(|w| *w = 1 << 62);
    product += Integer::from_digits(&bias, Order::Lsf);
    let half = Integer::from(1) << (64 * words as u32 - 2);
    let digits = product.to_digits::<u64>(Order::Lsf);
    let slot = |k: usize| {
        let from = ((modes + k) * words).min(digits.len());
        let end = (from + words).min(digits.len());
        Integer::from_digits(&digits[from..end], Order::Lsf) - &half
    };
    (0..=modes).map(slot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by the definition.
    fn by_sums(f: &Laurent, g: &Laurent) -> Laurent {
        let at = |f: &Laurent, k: i64| -> (Integer, Integer) {
            let i = k.unsigned_abs() as usize;
            if i > f.modes() {
                return Default::default();
            }
            (f.re[i].clone(), Integer::from(&f.im[i] * k.signum()))
        };
        let mut sum = Laurent::zero(f.modes() + g.modes());
        for k in 0..=sum.modes() as i64 {
            for l in -(f.modes() as i64)..=f.modes() as i64 {
                let ((a, b), (c, d)) = (at(f, l), at(g, k - l));
                sum.re[k as usize] += Integer::from(&a * &c) - Integer::from(&b * &d);
                sum.im[k as usize] += Integer::from(&a * &d) + Integer::from(&b * &c);
            }
        }
        sum
    }

    #[test]
    fn products_agree_with_sums() {
        let f = |modes: usize, odd: i64, size: i64| {
            let number = |k: usize, s: i64| Integer::from((k as i64 * 7919 + s) % 23 - 11) * size;
            let mut f = Laurent::zero(modes);
            for k in 0..=modes {
                f.re[k] = number(k, 5);
                f.im[k] = number(k, 17) * odd * i64::from(k > 0);
            }
            f
        };
        for (a, b) in [
            (f(4, 1, 1), f(7, 1, i64::MAX)),
            (f(4, 0, i64::MAX), f(3, 1, -2)),
            (f(0, 0, 3), f(5, 1, 1 << 40)),
            (f(2, 0, 1), f(2, 0, 1)),
            (f(9, 1, i64::MAX), f(1, 0, i64::MAX)),
        ] {
            let (product, sums) = (a.times(&b), by_sums(&a, &b));
            assert_eq!(product.re, sums.re);
            assert_eq!(product.im, sums.im);
        }
    }
}
