//! Correlation with a fixed table by one product of long integers (Kronecker's substitution).
//!
//! The values become fixed-point integers that are packed side by side into one integer; the
//! product of two such integers contains every sum of products, separated by enough zeros. GMP
//! multiplies long integers in nearly linear time, against K^2 single products otherwise.

use rug::float::Round;
use rug::integer::Order;
use rug::{Float, Integer};

/// The table S(m), m = -(K-1)..=2K-1, packed.
#[derive(Clone, Debug)]
pub(super) struct Packed {
    nodes: usize,
    /// Fixed-point bits.
    bits: u32,
    /// 64-bit words per value of the product.
    words: usize,
    table: Integer,
}

impl Packed {
    /// `table` holds |S| <= 1.
    pub(super) fn new(table: &[Float], nodes: usize, bits: u32) -> Self {
        let bits = bits + 8;
        // K products below 2^(2 bits), a sign and a carry.
        let room = 2 * bits as usize + nodes.ilog2() as usize + 4;
        let words = room.div_ceil(64);
        let packed = pack(table.iter(), table.len(), bits, 0, words);
        Self { nodes, bits, words, table: packed }
    }

    /// C(n) = sum_(j=1)^(K-1) g_j S(j + n) for n = -(K-1)..=K-1, with an error of about K 2^-bits
    /// times the largest |g|.
    pub(super) fn correlation(&self, g: &[Float]) -> Vec<Float> {
        let count = 2 * self.nodes - 1;
        let Some(largest) = g.iter().filter_map(Float::get_exp).max() else {
            return vec![Float::new(self.bits); count];
        };
        if g.iter().any(|x| !x.is_finite()) {
            return vec![Float::with_val(self.bits, rug::float::Special::Nan); count];
        }
        // g_j at position K-1-j, S(m) at m+K-1: the product has C(n) at 2K-2+n.
        let reversed = pack(g.iter().skip(1).rev(), g.len(), self.bits, largest, self.words);
        let mut product = reversed * &self.table;
        // A bias makes every value positive: no borrows between the slots.
        let slots = 4 * self.nodes;
        let mut bias = vec![0u64; slots * self.words];
        bias.iter_mut().skip(self.words - 1).step_by(self.words).for_each(|w| *w = 1 << 62);
        product += Integer::from_digits(&bias, Order::Lsf);
        let half = Integer::from(1) << (64 * self.words as u32 - 2);
        let digits = product.to_digits::<u64>(Order::Lsf);
        let shift = largest - 2 * self.bits as i32;
        let slot = |index: usize| {
            let from = index * self.words;
            let end = (from + self.words).min(digits.len());
            let value = Integer::from_digits(digits.get(from..end).unwrap_or_default(), Order::Lsf);
            Float::with_val(self.bits, value - &half) << shift
        };
        (self.nodes - 1..3 * self.nodes - 2).map(slot).collect()
    }
}

/// sum_i round(x_i 2^(bits - exponent)) 2^(64 words i).
fn pack<'a>(
    values: impl Iterator<Item = &'a Float>,
    count: usize,
    bits: u32,
    exponent: i32,
    words: usize,
) -> Integer {
    // Positive and negative values apart: digits are unsigned.
    let mut signed = [vec![0u64; count * words], vec![0u64; count * words]];
    let [positive, negative] = &mut signed;
    for (i, x) in values.enumerate() {
        let scaled = Float::with_val(x.prec(), x << (bits as i32 - exponent));
        let Some((integer, _)) = scaled.to_integer_round(Round::Nearest) else { continue };
        let target = if integer.is_negative() { &mut *negative } else { &mut *positive };
        let digits = integer.abs().to_digits::<u64>(Order::Lsf);
        for (word, digit) in target.iter_mut().skip(i * words).zip(digits) {
            *word = digit;
        }
    }
    Integer::from_digits(positive, Order::Lsf) - Integer::from_digits(negative, Order::Lsf)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_sums() {
        let (nodes, bits) = (9usize, 100);
        let number = |k: i64| Float::with_val(bits, k * 7 % 13 - 6) / (3 + k * k);
        let table: Vec<Float> =
            (0..3 * nodes as i64 - 1).map(|k| number(k - 8).clamp(&-1.0, &1.0)).collect();
        let g: Vec<Float> = (0..nodes as i64).map(|k| number(k + 40) << 30).collect();
        let found = Packed::new(&table, nodes, bits).correlation(&g);
        assert_eq!(found.len(), 2 * nodes - 1);
        for (index, value) in found.iter().enumerate() {
            let mut sum = Float::new(200);
            for j in 1..nodes {
                // S(m) at m + K - 1, m = j + n, n = index - (K - 1).
                sum += Float::with_val(200, &g[j] * &table[j + index]);
            }
            let error = Float::with_val(53, value - &sum).abs();
            assert!(error < 1e-20, "{index}: {value} {sum}");
        }
    }
}
