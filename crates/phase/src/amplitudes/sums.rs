//! Sums of products in progress: where the coefficient of a word stands.
//!
//! Few words are found by a hash. Of many the exponents obey linear relations: of a homogeneous expansion the order fixes
//! one of them, its dimension another. So words are numbered: by the exponents, from the highest, that those above
//! them do not determine, as digits of a mixed radix. The number of a product is the sum of two numbers, numbers are in
//! the order of words, and nothing is looked for or sorted. The relations are those of some of the words; that two
//! words have one number is noticed, and then they are hashed.

use super::Term;
use super::words::{DIGITS, Layout, Word};

pub(super) type Terms<E> = Vec<Term<E>>;

/// Sums of products: a list, and where words stand in it.
pub(super) struct Sum<E> {
    /// One more than the place of a word, 0 where there is none: by its number, or from where its hash leads among at
    /// least twice as many slots as words, a power of two.
    places: Vec<u32>,
    terms: Terms<E>,
    numbering: Option<Numbering>,
}

/// Fewer products of terms are not worth a numbering.
pub(super) const FEW: usize = 128;

/// Fewer products of terms of every factor are not worth reading relations for.
pub(super) const MANY: usize = 1024;

/// The most numbers, for every product of terms: empty ones cost little.
const EMPTY: usize = 8;

/// In place of exponents: those of the algebra tell words apart by too many numbers.
pub(super) const SPARSE: u32 = u32::MAX;

/// The words of a factor of which relations are read.
const SAMPLES: usize = 24;

impl<E: Clone> Sum<E> {
    pub(super) fn hashed() -> Self {
        Self { places: vec![0; 64], terms: Vec::new(), numbering: None }
    }

    pub(super) fn numbered(numbering: Numbering) -> Self {
        Self { places: vec![0; numbering.count], terms: Vec::new(), numbering: Some(numbering) }
    }

    /// What the number of a product is the sum of: with `first` of the first factor.
    pub(super) fn number(&self, word: Word, first: bool) -> i64 {
        let Some(numbering) = &self.numbering else { return 0 };
        numbering.number(word) - if first { numbering.least } else { 0 }
    }

    /// The coefficient of a word, that of a new one from `zero`; nothing where another word has its number.
    #[inline]
    pub(super) fn coefficient(
        &mut self,
        (word, number): (Word, i64),
        zero: impl Fn() -> E,
    ) -> Option<&mut [E; 2]> {
        if self.numbering.is_none() {
            let slot = self.slot(word);
            let place = self.places[slot];
            let known = if place == 0 { None } else { Some(place as usize - 1) };
            return Some(match known {
                Some(place) => &mut self.terms[place].1,
                None => self.begin(slot, word, zero),
            });
        }
        let slot = number as usize;
        let place = *self.places.get(slot)?;
        if place == 0 {
            return Some(self.begin(slot, word, zero));
        }
        let (known, sum) = &mut self.terms[place as usize - 1];
        (*known == word).then_some(sum)
    }

    fn begin(&mut self, mut slot: usize, word: Word, zero: impl Fn() -> E) -> &mut [E; 2] {
        if self.numbering.is_none() && 2 * self.terms.len() >= self.places.len() {
            self.places = vec![0; 4 * self.places.len()];
            for place in 0..self.terms.len() {
                let slot = self.slot(self.terms[place].0);
                self.places[slot] = place as u32 + 1;
            }
            slot = self.slot(word);
        }
        let place = self.terms.len();
        self.terms.push((word, [zero(), zero()]));
        self.places[slot] = place as u32 + 1;
        &mut self.terms[place].1
    }

    /// The slot of a word: its own or an empty one.
    fn slot(&self, word: Word) -> usize {
        let mask = self.places.len() - 1;
        let mut slot = home(word, self.places.len().ilog2());
        loop {
            match self.places[slot].checked_sub(1) {
                Some(place) if self.terms[place as usize].0 != word => slot = (slot + 1) & mask,
                _ => return slot,
            }
        }
    }

    /// The terms, sorted.
    pub(super) fn sorted(mut self, zero: impl Fn() -> E) -> Terms<E> {
        if self.numbering.is_none() {
            self.terms.sort_unstable_by_key(|(word, _)| *word);
            return self.terms;
        }
        let mut sorted = Vec::with_capacity(self.terms.len());
        for place in self.places.into_iter().filter(|place| *place > 0) {
            let (word, sum) = &mut self.terms[place as usize - 1];
            sorted.push((*word, std::mem::replace(sum, [zero(), zero()])));
        }
        sorted
    }
}

/// Where a word is looked for first among 2^bits slots. Every bit of either half changes the top bits of the products,
/// the highest bits of a half no others.
pub(super) fn home(word: Word, bits: u32) -> usize {
    let low = (word as u64).wrapping_mul(0xf135_7aea_2e62_a9c5);
    let high = ((word >> 64) as u64).wrapping_mul(0xd6e8_feb8_6659_fd93);
    ((low ^ high.rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - bits)) as usize
}

/// The numbers of the words of a sum of products.
pub(super) struct Numbering {
    layout: Layout,
    /// Exponents and what they are multiplied with.
    digits: Vec<(usize, i64)>,
    /// The sum of the least digits.
    least: i64,
    /// How many numbers there are.
    count: usize,
}

impl Numbering {
    /// Of so many products of lists of terms by exponents that tell their words apart; nothing where they would be few
    /// among the numbers.
    pub(super) fn of<E>(
        layout: Layout,
        pairs: &[[&[Term<E>]; 2]],
        exponents: impl Iterator<Item = usize>,
        products: usize,
    ) -> Option<Self> {
        let ends = |list: &[Term<E>], i: usize| {
            let of = |(word, _): &Term<E>| i64::from(layout.exponent(*word, i));
            list.iter().map(of).fold((i64::MAX, i64::MIN), |(a, b), e| (a.min(e), b.max(e)))
        };
        let (mut stride, mut least, mut digits) = (1i64, 0, Vec::new());
        for i in exponents {
            let (mut low, mut high) = (i64::MAX, i64::MIN);
            for [a, b] in pairs {
                let [a, b] = [a, b].map(|list| ends(list, i));
                (low, high) = (low.min(a.0 + b.0), high.max(a.1 + b.1));
            }
            digits.push((i, stride));
            least += low * stride;
            stride = stride.checked_mul(high - low + 1)?;
        }
        let count = usize::try_from(stride).ok()?;
        (count <= products.saturating_mul(EMPTY)).then_some(Self { layout, digits, least, count })
    }

    fn number(&self, word: Word) -> i64 {
        let digit = |&(i, stride): &(usize, i64)| i64::from(self.layout.exponent(word, i)) * stride;
        self.digits.iter().map(digit).sum()
    }
}

/// The prime modulo which relations are read.
const PRIME: i64 = (1 << 31) - 1;

/// The exponents, a bit each, that in products of some terms of the lists those above them do not determine: the pivots
/// of the differences of their words in echelon form.
pub(super) fn independent<E>(layout: Layout, count: usize, pairs: &[[&[Term<E>]; 2]]) -> u32 {
    let mut rows: Vec<(usize, [i64; DIGITS])> = Vec::new();
    let digits = |word: Word| layout.exponents(word, count).0.map(i64::from);
    let mut first = None;
    for lists in pairs {
        let mut start = [0; DIGITS];
        for list in lists {
            let Some((own, _)) = list.first() else { continue };
            let own = digits(*own);
            let step = list.len().div_ceil(SAMPLES);
            for (word, _) in list.iter().step_by(step).chain(list.last()) {
                let digits = digits(*word);
                reduce(&mut rows, std::array::from_fn(|i| digits[i] - own[i]));
            }
            start = std::array::from_fn(|i| start[i] + own[i]);
        }
        let first = first.get_or_insert(start);
        reduce(&mut rows, std::array::from_fn(|i| start[i] - first[i]));
    }
    rows.iter().map(|(pivot, _)| 1 << pivot).sum()
}

/// Adds what is new of a row to those of an echelon form, from the highest exponent.
fn reduce(rows: &mut Vec<(usize, [i64; DIGITS])>, row: [i64; DIGITS]) {
    let mut row = row.map(|n| n.rem_euclid(PRIME));
    for i in (0..DIGITS).rev() {
        if row[i] == 0 {
            continue;
        }
        let Some((_, known)) = rows.iter().find(|(pivot, _)| *pivot == i) else {
            rows.push((i, row));
            return;
        };
        // row known_i - known row_i.
        let (a, b) = (known[i], row[i]);
        for (x, y) in row.iter_mut().zip(known) {
            *x = (*x * a % PRIME - y * b % PRIME).rem_euclid(PRIME);
        }
    }
}
