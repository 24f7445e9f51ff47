//! Vectors of residues, whose even and odd places are multiplied apart.
//!
//! A product of 32-bit numbers fills 64 bits, and processors multiply the lower halves of 64-bit places: the even places of
//! a vector as they stand, the odd ones shifted down. So sums of products are kept as two vectors, and nothing is
//! unpacked or shuffled on the way. Written out for SSE2, AVX2 and AVX-512, which compilers do not find by themselves (measured:
//! half the speed, and a quarter for the last); the instructions are safe to use through `pulp`, which asks the processor.

/// How many primes.
pub const LANES: usize = 8;
/// One number per prime: x 2^32 mod p.
pub type Residues = [u32; LANES];

/// What the kernels need of a processor. A word holds the residues of [`Self::ROWS`] points.
pub(super) trait Words: Copy {
    /// Some vectors.
    type Word: Copy;
    /// Points in a word.
    const ROWS: usize;

    /// As many points as a word holds.
    fn load(self, rows: &[Residues]) -> Self::Word;
    /// The same numbers at all points.
    fn same(self, row: &Residues) -> Self::Word;
    /// The first points, as many as there is room for.
    fn store(self, word: Self::Word, rows: &mut [Residues]);
    /// t + a b at even places.
    fn accumulate(self, t: Self::Word, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b at even places.
    fn product(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Odd places, shifted to the even ones.
    fn high(self, a: Self::Word) -> Self::Word;
    /// (t >> 32) one + (t mod 2^32) in every 64 bits.
    fn fold(self, t: Self::Word, one: Self::Word) -> Self::Word;
    /// The odd places of `even`, shifted down, and those of `odd`: numbers below 2p, reduced by p.
    fn join(self, even: Self::Word, odd: Self::Word, p: Self::Word) -> Self::Word;
}

/// As many points as a word holds, zero where a row has ended.
#[inline(always)]
pub(super) fn padded<W: Words>(words: W, row: &[Residues], start: usize) -> W::Word {
    match row.get(start..start + W::ROWS) {
        Some(rows) => words.load(rows),
        None => {
            let mut rows = [[0; LANES]; 4];
            for (to, from) in rows.iter_mut().zip(row.iter().skip(start)) {
                *to = *from;
            }
            words.load(&rows[..W::ROWS])
        }
    }
}

/// 64-bit arithmetic, for other processors.
#[derive(Clone, Copy)]
#[cfg_attr(target_arch = "x86_64", allow(dead_code, reason = "the tests compare with it"))]
pub(super) struct Plain;

const HALF: usize = LANES / 2;
const LOWER: u64 = 0xffff_ffff;

impl Words for Plain {
    type Word = [u64; HALF];
    const ROWS: usize = 1;

    fn load(self, rows: &[Residues]) -> Self::Word {
        self.same(&rows[0])
    }
    fn same(self, row: &Residues) -> Self::Word {
        std::array::from_fn(|i| u64::from(row[2 * i]) | u64::from(row[2 * i + 1]) << 32)
    }
    fn store(self, word: Self::Word, rows: &mut [Residues]) {
        rows[0] = std::array::from_fn(|l| (word[l / 2] >> (32 * (l % 2))) as u32);
    }
    fn accumulate(self, t: Self::Word, a: Self::Word, b: Self::Word) -> Self::Word {
        let product = self.product(a, b);
        std::array::from_fn(|i| t[i].wrapping_add(product[i]))
    }
    fn product(self, a: Self::Word, b: Self::Word) -> Self::Word {
        std::array::from_fn(|i| (a[i] & LOWER) * (b[i] & LOWER))
    }
    fn high(self, a: Self::Word) -> Self::Word {
        a.map(|a| a >> 32)
    }
    fn fold(self, t: Self::Word, one: Self::Word) -> Self::Word {
        self.accumulate(t.map(|t| t & LOWER), self.high(t), one)
    }
    fn join(self, even: Self::Word, odd: Self::Word, p: Self::Word) -> Self::Word {
        let once = |a: u64, p: u64| if a >= p { a - p } else { a };
        std::array::from_fn(|i| {
            let high = once(odd[i] >> 32, p[i] >> 32);
            once(even[i] >> 32, p[i] & LOWER) | high << 32
        })
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Residues, Words};
    use pulp::cast;
    use pulp::x86::{V1, V3, V4};
    use std::arch::x86_64::{__m128i, __m256i, __m512i};

    /// An array by position. A closure would be a function of its own, without the instructions of the one around it.
    macro_rules! four {
        (|$i:ident| $value:expr) => {
            [four!(0, $i, $value), four!(1, $i, $value), four!(2, $i, $value), four!(3, $i, $value)]
        };
        ($at:literal, $i:ident, $value:expr) => {{
            const $i: usize = $at;
            $value
        }};
    }
    macro_rules! two {
        (|$i:ident| $value:expr) => {
            [four!(0, $i, $value), four!(1, $i, $value)]
        };
    }

    /// What differs in the points and the names of instructions alone.
    macro_rules! alike {
        ([$($row:literal),*], $each:ident, $set:ident: $add:ident, $multiply:ident, $shift:ident) => {
            const ROWS: usize = [$($row),*].len();

            #[inline(always)]
            fn load(self, rows: &[Residues]) -> Self::Word {
                cast([$(rows[$row]),*])
            }
            #[inline(always)]
            fn same(self, row: &Residues) -> Self::Word {
                cast([*row; Self::ROWS])
            }
            #[inline(always)]
            fn store(self, word: Self::Word, rows: &mut [Residues]) {
                let points: [Residues; Self::ROWS] = cast(word);
                for (to, from) in rows.iter_mut().zip(points) {
                    *to = from;
                }
            }
            #[inline(always)]
            fn accumulate(self, t: Self::Word, a: Self::Word, b: Self::Word) -> Self::Word {
                $each!(|I| self.$set.$add(t[I], self.$set.$multiply(a[I], b[I])))
            }
            #[inline(always)]
            fn product(self, a: Self::Word, b: Self::Word) -> Self::Word {
                $each!(|I| self.$set.$multiply(a[I], b[I]))
            }
            #[inline(always)]
            fn high(self, a: Self::Word) -> Self::Word {
                $each!(|I| self.$set.$shift::<32>(a[I]))
            }
        };
    }

    impl Words for V1 {
        type Word = [__m128i; 4];
        alike!([0, 1], four, sse2: _mm_add_epi64, _mm_mul_epu32, _mm_srli_epi64);

        #[inline(always)]
        fn fold(self, t: Self::Word, one: Self::Word) -> Self::Word {
            let mask = self.sse2._mm_set1_epi64x(0xffff_ffff);
            let lower = four!(|I| self.sse2._mm_and_si128(t[I], mask));
            self.accumulate(lower, self.high(t), one)
        }
        #[inline(always)]
        fn join(self, even: Self::Word, odd: Self::Word, p: Self::Word) -> Self::Word {
            let sse2 = self.sse2;
            let mask = sse2._mm_set1_epi64x(0xffff_ffff);
            four!(|I| {
                let lower = sse2._mm_srli_epi64::<32>(even[I]);
                let sum = sse2._mm_or_si128(lower, sse2._mm_andnot_si128(mask, odd[I]));
                // Residues have 30 bits: what falls below zero shows in the sign.
                let less = sse2._mm_sub_epi32(sum, p[I]);
                let back = sse2._mm_and_si128(sse2._mm_srai_epi32::<31>(less), p[I]);
                sse2._mm_add_epi32(less, back)
            })
        }
    }

    impl Words for V3 {
        type Word = [__m256i; 4];
        alike!([0, 1, 2, 3], four, avx2: _mm256_add_epi64, _mm256_mul_epu32, _mm256_srli_epi64);

        #[inline(always)]
        fn fold(self, t: Self::Word, one: Self::Word) -> Self::Word {
            let zero = self.avx._mm256_setzero_si256();
            let lower = four!(|I| self.avx2._mm256_blend_epi32::<0xaa>(t[I], zero));
            self.accumulate(lower, self.high(t), one)
        }
        #[inline(always)]
        fn join(self, even: Self::Word, odd: Self::Word, p: Self::Word) -> Self::Word {
            let avx2 = self.avx2;
            four!(|I| {
                let lower = avx2._mm256_srli_epi64::<32>(even[I]);
                let sum = avx2._mm256_blend_epi32::<0xaa>(lower, odd[I]);
                // A difference that wraps around is the larger number.
                avx2._mm256_min_epu32(sum, avx2._mm256_sub_epi32(sum, p[I]))
            })
        }
    }

    impl Words for V4 {
        type Word = [__m512i; 2];
        alike!([0, 1, 2, 3], two, avx512f: _mm512_add_epi64, _mm512_mul_epu32, _mm512_srli_epi64);

        #[inline(always)]
        fn fold(self, t: Self::Word, one: Self::Word) -> Self::Word {
            let lower = two!(|I| self.avx512f._mm512_maskz_mov_epi32(0x5555, t[I]));
            self.accumulate(lower, self.high(t), one)
        }
        #[inline(always)]
        fn join(self, even: Self::Word, odd: Self::Word, p: Self::Word) -> Self::Word {
            let avx512 = self.avx512f;
            two!(|I| {
                let lower = avx512._mm512_srli_epi64::<32>(even[I]);
                let sum = avx512._mm512_mask_mov_epi32(lower, 0xaaaa, odd[I]);
                avx512._mm512_min_epu32(sum, avx512._mm512_sub_epi32(sum, p[I]))
            })
        }
    }
}
