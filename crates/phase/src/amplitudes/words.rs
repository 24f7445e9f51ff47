//! Monomials as one machine word: sixteen exponents between -127 and 127 as the balanced digits of a
//! number to the base 256, so that the product of monomials is the sum of their words.

/// sum_i e_i 256^i with |e_i| < 128; unique.
pub type Word = i128;

/// The exponents that a word has.
pub const DIGITS: usize = 16;

/// The largest exponent.
pub const LARGEST: i32 = 127;

/// 256^i.
pub fn unit(i: usize) -> Word {
    1 << (8 * i)
}

/// The exponents e_0, ..., e_{n-1}, and the word of the others.
pub fn exponents(mut word: Word, n: usize) -> ([i32; DIGITS], Word) {
    let mut digits = [0; DIGITS];
    for digit in &mut digits[..n] {
        let low = word as i8;
        *digit = low.into();
        word = (word - Word::from(low)) >> 8;
    }
    (digits, word)
}

/// The word with the first digits and the word of the others.
pub fn pack(digits: &[i32], rest: Word) -> Word {
    digits.iter().rev().fold(rest, |word, digit| (word << 8) + Word::from(*digit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_sums() {
        let (a, b) = ([1, -2, 0, 127, -127], [-1, 2, -100, -7, 3]);
        let sum: Vec<i32> = a.iter().zip(b).map(|(a, b)| a + b).collect();
        let (digits, rest) = exponents(pack(&a, 0) + pack(&b, 0), 5);
        assert_eq!((&digits[..5], rest), (&sum[..], 0));
        assert_eq!(exponents(pack(&[3], 7), 1).1, 7);
        assert_eq!(exponents(unit(15) * -127, DIGITS).0[15], -127);
    }
}
