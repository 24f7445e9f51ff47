//! Sums of products whose rows are shared: some places of all rows are laid side by side, so that each comes from memory
//! once for all sums.

use super::super::LANES;
use super::super::words::{Residues, Words};
use super::{Factor, Kernel, Moduli, PrimeFields};
use rustc_hash::FxHashMap;

/// Places of one row, from the start of a line of the cache.
#[derive(Clone)]
#[repr(align(64))]
pub(in crate::modular) struct Tile([Residues; TILE]);

const TILE: usize = 4;
/// Tiles that are laid side by side at a time: two thousand rows of so many stay near the processor.
const TILES: usize = 4;

/// A factor that is a row, or one number.
pub(in crate::modular) trait Shared<'a>: Factor {
    /// The number of the row, or the number itself.
    type Packed: Copy;
    fn packed(self, number_of: &mut impl FnMut(&'a [Residues]) -> u32) -> Self::Packed;
    /// The places of a tile from one on.
    fn unpacked<W: Words>(packed: Self::Packed, words: W, rows: &[Tile], place: usize) -> W::Word;
}

impl<'a> Shared<'a> for &'a [Residues] {
    type Packed = u32;

    #[inline(always)]
    fn packed(self, number_of: &mut impl FnMut(&'a [Residues]) -> u32) -> u32 {
        number_of(self)
    }
    #[inline(always)]
    fn unpacked<W: Words>(packed: u32, words: W, rows: &[Tile], place: usize) -> W::Word {
        words.load(&rows[packed as usize].0[place..place + W::ROWS])
    }
}

impl<'a> Shared<'a> for Residues {
    type Packed = Residues;

    #[inline(always)]
    fn packed(self, _: &mut impl FnMut(&'a [Residues]) -> u32) -> Residues {
        self
    }
    #[inline(always)]
    fn unpacked<W: Words>(packed: Residues, words: W, _: &[Tile], _: usize) -> W::Word {
        words.same(&packed)
    }
}

/// sum_i a_i\[j\] b_i\[j\] for every j, of several lists of pairs.
pub(super) struct SumsOfProducts<'a, B: Shared<'a>> {
    fields: &'a PrimeFields,
    rows: Vec<&'a [Residues]>,
    sums: Vec<Vec<(u32, B::Packed)>>,
    /// Those of the longest rows.
    lengths: Vec<usize>,
}

impl<'a, B: Shared<'a>> SumsOfProducts<'a, B> {
    pub(super) fn new(fields: &'a PrimeFields, lists: &[Vec<(&'a [Residues], B)>]) -> Self {
        let mut rows: Vec<&'a [Residues]> = Vec::new();
        let mut numbers = FxHashMap::default();
        let mut number_of = |row: &'a [Residues]| {
            *numbers.entry((row.as_ptr() as usize, row.len())).or_insert_with(|| {
                rows.push(row);
                rows.len() as u32 - 1
            })
        };
        let mut sum = |pairs: &Vec<(&'a [Residues], B)>| {
            pairs.iter().map(|(a, b)| (number_of(a), b.packed(&mut number_of))).collect()
        };
        let sums = lists.iter().map(&mut sum).collect();
        let longest = |pairs: &Vec<(&[Residues], B)>| super::longest(pairs);
        Self { fields, rows, sums, lengths: lists.iter().map(longest).collect() }
    }
}

impl<'a, B: Shared<'a>> Kernel for SumsOfProducts<'a, B> {
    type Output = Vec<Vec<Residues>>;

    #[inline(always)]
    fn run<W: Words>(self, words: W) -> Vec<Vec<Residues>> {
        let moduli = Moduli::new(words, self.fields);
        let mut lists: Vec<Vec<Residues>> =
            self.lengths.iter().map(|length| vec![[0; LANES]; *length]).collect();
        let length = self.lengths.iter().max().copied().unwrap_or(0);
        let mut tiles = vec![Tile([[0; LANES]; TILE]); TILES * self.rows.len()];
        for start in (0..length).step_by(TILES * TILE) {
            for (row, row_number) in self.rows.iter().zip(0..) {
                for tile in 0..TILES {
                    let place = &mut tiles[tile * self.rows.len() + row_number].0;
                    *place = [[0; LANES]; TILE];
                    let rest = row.get(start + tile * TILE..).unwrap_or(&[]);
                    place.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
                }
            }
            for (tile, rows) in tiles.chunks(self.rows.len().max(1)).enumerate() {
                for (pairs, list) in self.sums.iter().zip(&mut lists) {
                    let places = list.get_mut(start + tile * TILE..).unwrap_or(&mut []);
                    let places = places.chunks_mut(W::ROWS).zip((0..TILE).step_by(W::ROWS));
                    for (sums, place) in places {
                        let pairs = pairs.iter().map(|(a, b)| {
                            let a = words.load(&rows[*a as usize].0[place..place + W::ROWS]);
                            (a, B::unpacked(*b, words, rows, place))
                        });
                        moduli.sum_of_words(pairs, sums);
                    }
                }
            }
        }
        lists
    }
}
