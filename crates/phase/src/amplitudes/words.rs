//! Monomials as one machine word: exponents as the balanced digits of a number, so that the product of monomials is
//! the sum of their words.

/// sum_i e_i 2^(b i) with |e_i| < 2^(b - 1); unique.
pub type Word = i128;

/// The most exponents that a word has.
pub const DIGITS: usize = 16;

/// How wide a digit is: b bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    bits: u32,
}

impl Layout {
    /// The widest digits that so many exponents leave; nothing for more than sixteen.
    pub fn of(exponents: usize) -> Option<Self> {
        let bits = match exponents {
            0..=4 => 32,
            5..=8 => 16,
            9..=DIGITS => 8,
            _ => return None,
        };
        Some(Self { bits })
    }

    /// The largest exponent: 127 in digits of eight bits.
    pub fn largest(self) -> i32 {
        i32::MAX >> (32 - self.bits)
    }

    /// Whether all exponents are in [-2^(b - 3), 2^(b - 3)), so that two such words can be added: with 2^(b - 3) added to
    /// each they are digits of b - 2 bits.
    pub fn is_small(self, word: Word) -> bool {
        // 1 in every digit: a constant for each width, known to the compiler.
        let ones = match self.bits {
            8 => u128::MAX / 0xff,
            16 => u128::MAX / 0xffff,
            _ => u128::MAX / 0xffff_ffff,
        };
        let raised = word.cast_unsigned().wrapping_add(ones << (self.bits - 3));
        raised & ((ones * 3) << (self.bits - 2)) == 0
    }

    /// 2^(b i).
    pub fn unit(self, i: usize) -> Word {
        1 << (self.bits as usize * i)
    }

    /// e_i.
    pub fn exponent(self, word: Word, i: usize) -> i32 {
        let start = self.bits as usize * i;
        // The digits below are less than half of 2^(b i) in size.
        let half = if start == 0 { 0 } else { 1 << (start - 1) };
        let above = word.wrapping_add(half) >> start;
        (above as i32) << (32 - self.bits) >> (32 - self.bits)
    }

    /// What the first n exponents are told from others by.
    pub fn lowest(self, word: Word, n: usize) -> Word {
        let end = self.bits as usize * n;
        if end >= 128 { word } else { word & ((1 << end) - 1) }
    }

    /// The exponents e_0, ..., e_{n-1}, and the word of the others.
    pub fn exponents(self, mut word: Word, n: usize) -> ([i32; DIGITS], Word) {
        let mut digits = [0; DIGITS];
        for digit in &mut digits[..n] {
            let low = (word as i32) << (32 - self.bits) >> (32 - self.bits);
            *digit = low;
            word = (word - Word::from(low)) >> self.bits;
        }
        (digits, word)
    }

    /// The word with the first digits and the word of the others.
    pub fn pack(self, digits: &[i32], rest: Word) -> Word {
        digits.iter().rev().fold(rest, |word, digit| (word << self.bits) + Word::from(*digit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_sums() {
        let (a, b) = ([1, -2, 0, 127, -127], [-1, 2, -100, -7, 3]);
        for count in [5, 12] {
            let layout = Layout::of(count).unwrap_or(Layout { bits: 8 });
            let sum: Vec<i32> = a.iter().zip(b).map(|(a, b)| a + b).collect();
            let words = [&a, &b].map(|digits| layout.pack(digits, 0));
            let (digits, rest) = layout.exponents(words[0] + words[1], 5);
            let single: Vec<i32> =
                (0..5).map(|i| layout.exponent(words[0] + words[1], i)).collect();
            assert_eq!(single, sum);
            assert_eq!(layout.lowest(words[0], 2), layout.lowest(layout.pack(&a[..2], 3), 2));
            assert_eq!((&digits[..5], rest), (&sum[..], 0));
            assert_eq!(layout.exponents(layout.pack(&[3], 7), 1).1, 7);
        }
    }

    #[test]
    fn every_width_holds_its_largest() {
        for (count, largest) in [(3, i32::MAX), (4, i32::MAX), (8, 32767), (9, 127), (16, 127)] {
            let Some(layout) = Layout::of(count) else { panic!("{count} exponents") };
            assert_eq!(layout.largest(), largest);
            let digits = vec![-largest; count];
            assert_eq!(layout.exponents(layout.pack(&digits, 0), count).0[..count], digits);
            assert_eq!(
                layout.exponents(-largest as Word * layout.unit(count - 1), count).0[..count - 1],
                vec![0; count - 1]
            );
        }
        assert_eq!(Layout::of(17), None);
    }

    #[test]
    fn small_words_can_be_added() {
        for count in [4, 8, 16] {
            let Some(layout) = Layout::of(count) else { panic!("{count} exponents") };
            let most = layout.largest() / 4;
            for i in 0..count {
                let of = |e: i32| {
                    let mut digits = vec![-1; count];
                    digits[i] = e;
                    layout.pack(&digits, 0)
                };
                assert!([-most - 1, -1, 0, 1, most].into_iter().all(|e| layout.is_small(of(e))));
                let beyond = [most + 1, -most - 2, layout.largest(), -layout.largest()];
                assert!(!beyond.into_iter().any(|e| layout.is_small(of(e))));
            }
        }
    }
}
