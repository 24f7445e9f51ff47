//! Sums of products over scalars without denominators: the products that a coefficient is made of are gathered first, so
//! that the scalars sum them at once.

use super::ring::Pair;
use super::sums::Terms;
use super::words::Word;
use super::{AmplitudeElement, Amplitudes, Scalars, Term};
use lindstedt_algebra::Ring;
use lindstedt_number::Whole;
use rug::Rational;
use rustc_hash::FxHashMap;

/// The products of which the real and the imaginary part of a coefficient are sums.
type Factors<'a, E> = [Vec<(&'a E, &'a E)>; 2];

/// Terms with the words of their conjugates and -im.
type List<'a, E> = (&'a [Term<E>], &'a [(Word, E)]);

/// The products of every monomial.
type Sums<'a, E> = FxHashMap<Word, Factors<'a, E>>;

impl<S: Scalars> Amplitudes<S> {
    /// The sum of products over scalars without denominators, every coefficient at once. Of a real sum the monomials
    /// whose words are not below those of their conjugates are formed.
    pub(super) fn gathered(
        &self,
        pairs: &[Pair<'_, S::Element>],
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        let companions: Vec<_> = pairs.iter().map(|(a, _)| self.companions(&a.terms)).collect();
        let mut sums = Sums::default();
        for ((a, b), companions) in pairs.iter().zip(&companions) {
            for (w, c) in &b.terms {
                self.gather(&mut sums, (&a.terms, companions), (*w, [c, c]), real);
            }
        }
        self.summed(sums, real)
    }

    /// The same of single terms whose products have one word, as constants have: nothing is gathered.
    pub(super) fn of_one_word(
        &self,
        pairs: &[Pair<'_, S::Element>],
        real: bool,
    ) -> Option<AmplitudeElement<S::Element>> {
        let mut products = Vec::with_capacity(pairs.len());
        let mut word = None;
        for (a, b) in pairs {
            let ([(v, c)], [(w, d)]) = (&a.terms[..], &b.terms[..]) else { return None };
            if *word.get_or_insert(v + w) != v + w {
                return None;
            }
            products.push([c, d]);
        }
        let scalars = &self.scalars;
        let minus: Vec<_> = products.iter().map(|[c, _]| scalars.neg(&c[1])).collect();
        let mut lists = [Vec::new(), Vec::new()];
        for ([[x, y], [u, v]], minus) in products.iter().zip(&minus) {
            let all = [(0, x, u), (0, minus, v), (1, x, v), (1, y, u)];
            let known = |(_, a, b): &(usize, &S::Element, &S::Element)| {
                !scalars.is_zero(a) && !scalars.is_zero(b)
            };
            all.into_iter().filter(known).for_each(|(part, a, b)| lists[part].push((a, b)));
        }
        let sums = lists.map(|list| scalars.sum_of_products(&list));
        Some(self.single(word?, sums, Whole::ONE, real))
    }

    /// [`AmplitudeAlgebra::along`](lindstedt_algebra::AmplitudeAlgebra::along), of the monomials whose words are not below
    /// those of their conjugates: c z^p zbar^q changes at the rate c p f/z + c q fbar/zbar. The part h = h_1 + i h_2 of f/z
    /// that only turns and stretches z, monomials that are their own conjugates, brings c ((p + q) h_1 + i (p - q) h_2).
    pub(super) fn gathered_along(
        &self,
        j: usize,
        pairs: &[Pair<'_, S::Element>],
    ) -> AmplitudeElement<S::Element> {
        if j >= self.amplitudes {
            return self.zero();
        }
        let unit = self.layout.unit(2 * j);
        let scaled = |[a, b]: [i32; 2]| {
            move |(word, c): &Term<S::Element>| {
                let digits = self.layout.exponents(*word, 2 * j + 2).0;
                let n = Rational::from(a * digits[2 * j] + b * digits[2 * j + 1]);
                (*word, c.each_ref().map(|e| self.scalars.scale(e, &n)))
            }
        };
        let parts = |(f, g): &Pair<'_, S::Element>| {
            let over = |(word, c): &Term<S::Element>| (word - unit, c.clone());
            let (own, others): (Terms<_>, Terms<_>) =
                f.terms.iter().map(over).partition(|(word, _)| *word == self.mirrored(*word));
            let mirrored = self.mirror(&others);
            let of = |list: &Terms<_>, weights| -> Terms<S::Element> {
                if list.is_empty() {
                    return Vec::new();
                }
                g.terms.iter().map(scaled(weights)).collect()
            };
            let factors = [[1, 1], [1, -1]].map(|weights| of(&own, weights));
            let sides = [[1, 0], [0, 1]].map(|weights| of(&others, weights));
            ([own, others, mirrored].map(|list| (self.companions(&list), list)), factors, sides)
        };
        let parts: Vec<_> = pairs.iter().map(parts).collect();
        let mut sums = Sums::default();
        for (lists, [whole, difference], [left, right]) in &parts {
            let lists = lists.each_ref().map(|(companions, list)| (&list[..], &companions[..]));
            for (list, [a, b]) in
                lists.into_iter().zip([[whole, difference], [left, left], [right, right]])
            {
                for ((word, c), (_, d)) in a.iter().zip(b) {
                    self.gather(&mut sums, list, (*word, [c, d]), true);
                }
            }
        }
        self.summed(sums, true)
    }

    /// The word of the conjugate and -im of every term.
    fn companions(&self, terms: &[Term<S::Element>]) -> Vec<(Word, S::Element)> {
        terms.iter().map(|(word, [_, im])| (self.mirrored(*word), self.scalars.neg(im))).collect()
    }

    /// The products of a list, with its companions, and one monomial, which has one factor for their real and one for their
    /// imaginary parts.
    fn gather<'a>(
        &self,
        sums: &mut Sums<'a, S::Element>,
        (terms, companions): List<'a, S::Element>,
        (w, [c, d]): (Word, [&'a [S::Element; 2]; 2]),
        real: bool,
    ) {
        let scalars = &self.scalars;
        let opposite = if real { self.mirrored(w) } else { 0 };
        for ((v, [re, im]), (own, minus)) in terms.iter().zip(companions) {
            let word = v + w;
            // The conjugate of a product is the product of the conjugates.
            let mirrored = if real { own + opposite } else { Word::MIN };
            if word < mirrored {
                continue;
            }
            let all = [(0, re, &c[0]), (0, minus, &d[1]), (1, re, &c[1]), (1, im, &d[0])];
            let parts = if word == mirrored { &all[..2] } else { &all };
            let nonzero = |(_, c, d): &&(usize, &S::Element, &S::Element)| {
                !scalars.is_zero(c) && !scalars.is_zero(d)
            };
            let lists = sums.entry(word).or_default();
            parts.iter().filter(nonzero).for_each(|&(i, c, d)| lists[i].push((c, d)));
        }
    }

    /// The polynomial of gathered coefficients.
    fn summed(&self, sums: Sums<'_, S::Element>, real: bool) -> AmplitudeElement<S::Element> {
        let sum = |(word, lists): (Word, Factors<'_, S::Element>)| {
            let sum = |list: Vec<_>| match self.stop.asked() {
                true => self.scalars.zero(),
                false => self.scalars.sum_of_products(&list),
            };
            (word, lists.map(sum))
        };
        let mut terms: Terms<S::Element> = sums.into_iter().map(sum).collect();
        match real {
            true => self.complete(&mut terms),
            false => terms.sort_unstable_by_key(|(word, _)| *word),
        }
        self.canonical(Whole::ONE, terms, real)
    }
}
