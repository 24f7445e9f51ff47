//! Sums and products.

use super::sums::{FEW, MANY, Numbering, SPARSE, Sum, Terms, independent};
use super::words::{DIGITS, Word};
use super::{AmplitudeElement, Amplitudes, Scalars, Term};
use lindstedt_algebra::{ForcedAlgebra, FunctionAlgebra, RationalAlgebra, Ring};
use lindstedt_number::Whole;
use rug::Rational;
use std::sync::atomic::Ordering::Relaxed;

pub(super) type Pair<'a, E> = (&'a AmplitudeElement<E>, &'a AmplitudeElement<E>);

/// Products of coefficients between two looks at the stop.
const LOOK: usize = 10_000;

impl<S: Scalars> Amplitudes<S> {
    pub(super) fn largest(&self, f: &AmplitudeElement<S::Element>) -> i32 {
        let n = self.exponents();
        let of = |word: Word| {
            self.layout.exponents(word, n).0.iter().map(|e| e.abs()).max().unwrap_or(0)
        };
        f.terms.iter().map(|(word, _)| of(*word)).max().unwrap_or(0)
    }

    pub(super) fn is_small(&self, f: &AmplitudeElement<S::Element>) -> bool {
        f.terms.iter().all(|(word, _)| self.layout.is_small(*word))
    }

    /// sum <- sum + n a b for terms a and a polynomial b; nothing where two words have one number.
    pub(super) fn accumulate(
        &self,
        sum: &mut Sum<S::Element>,
        [a, b]: [&[Term<S::Element>]; 2],
        n: &Whole,
    ) -> Option<()> {
        let scalars = &self.scalars;
        // The real and the imaginary parts, most of which vanish.
        let mut parts = [Vec::with_capacity(b.len()), Vec::with_capacity(b.len())];
        for (w, c) in b {
            let number = sum.number(*w, false);
            for (part, e) in parts.iter_mut().zip(c).filter(|(_, e)| !scalars.is_zero(e)) {
                part.push((*w, number, e));
            }
        }
        for (k, (v, c)) in a.iter().enumerate() {
            if k % 64 == 63 && self.stop.asked() {
                return Some(());
            }
            let first = sum.number(*v, true);
            for (i, c) in c.iter().enumerate().filter(|(_, e)| !scalars.is_zero(e)) {
                let c = scalars.times(c, n);
                for (j, list) in parts.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
                    let c = if i + j == 2 { &scalars.neg(&c) } else { &c };
                    for (w, number, e) in list {
                        let at = (v + w, first + number);
                        let parts = sum.coefficient(at, || scalars.zero())?;
                        scalars.add_product(&mut parts[i ^ j], c, e);
                    }
                }
            }
        }
        Some(())
    }

    /// The terms of a real polynomial whose words are above those of their conjugates, twice, and once
    /// those that are their own: half of it, so that h + conj h is twice the polynomial.
    fn half(&self, f: &AmplitudeElement<S::Element>) -> Terms<S::Element> {
        let two = Whole::from(2i64);
        let part = |(word, c): &Term<S::Element>| match word.cmp(&self.mirrored(*word)) {
            std::cmp::Ordering::Less => None,
            std::cmp::Ordering::Equal => Some((*word, c.clone())),
            std::cmp::Ordering::Greater => {
                Some((*word, c.each_ref().map(|e| self.scalars.times(e, &two))))
            }
        };
        f.terms.iter().filter_map(part).collect()
    }

    /// The sorted terms of a real polynomial from those whose words are not below those of their conjugates.
    pub(super) fn complete(&self, terms: &mut Terms<S::Element>) {
        let above = |(word, [re, im]): &Term<S::Element>| {
            let mirrored = self.mirrored(*word);
            (*word != mirrored).then(|| (mirrored, [re.clone(), self.scalars.neg(im)]))
        };
        let below: Terms<_> = terms.iter().filter_map(above).collect();
        terms.extend(below);
        terms.sort_unstable_by_key(|(word, _)| *word);
    }

    /// The conjugate of every term, unsorted.
    pub(super) fn mirror(&self, terms: &[Term<S::Element>]) -> Terms<S::Element> {
        let term = |(word, [re, im]): &Term<S::Element>| {
            (self.mirrored(*word), [re.clone(), self.scalars.neg(im)])
        };
        terms.iter().map(term).collect()
    }

    /// The sum of two sorted lists, with factors.
    pub(super) fn merged(
        &self,
        a: Terms<S::Element>,
        b: &[Term<S::Element>],
        [m, n]: [&Whole; 2],
    ) -> Terms<S::Element> {
        let scaled = |c: &[S::Element; 2], n: &Whole| {
            if *n == Whole::ONE {
                c.clone()
            } else {
                c.each_ref().map(|e| self.scalars.times(e, n))
            }
        };
        let mut list = Vec::with_capacity(a.len() + b.len());
        let mut rest = b.iter().peekable();
        for (word, c) in a {
            while let Some((w, d)) = rest.next_if(|(w, _)| *w < word) {
                list.push((*w, scaled(d, n)));
            }
            let mut sum = if *m == Whole::ONE { c } else { scaled(&c, m) };
            if let Some((_, d)) = rest.next_if(|(w, _)| *w == word) {
                for (x, y) in sum.iter_mut().zip(d) {
                    match *n == Whole::ONE {
                        true => self.scalars.add(x, y),
                        false => self.scalars.add(x, &self.scalars.times(y, n)),
                    }
                }
            }
            list.push((word, sum));
        }
        list.extend(rest.map(|(w, d)| (*w, scaled(d, n))));
        list
    }

    pub(super) fn total(
        &self,
        a: AmplitudeElement<S::Element>,
        b: &AmplitudeElement<S::Element>,
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        let denominator = a.denominator.lcm(&b.denominator);
        let factors = [&a, b].map(|f| denominator.divided(&f.denominator));
        let terms = self.merged(a.terms, &b.terms, factors.each_ref());
        self.canonical(denominator, terms, real)
    }

    fn products(&self, pairs: &[Pair<'_, S::Element>]) -> AmplitudeElement<S::Element> {
        let pairs = || pairs.iter().filter(|(a, b)| !a.terms.is_empty() && !b.terms.is_empty());
        let beyond = |a, b| self.overflows(self.largest(a), self.largest(b));
        if pairs().any(|(a, b)| !(self.is_small(a) && self.is_small(b)) && beyond(a, b)) {
            return self.zero();
        }
        let real = pairs().all(|(a, b)| a.real && b.real);
        let mut known = pairs();
        if let (Some((a, b)), None) = (known.next(), known.next())
            && let Some(product) = self.of_single(a, b).or_else(|| self.of_single(b, a))
        {
            return self.reduced(product);
        }
        if S::GATHERS {
            let pairs: Vec<_> = pairs().copied().collect();
            let product = self.of_one_word(&pairs, real);
            return product.unwrap_or_else(|| self.gathered(&pairs, real));
        }
        let lcm = |d: Whole, (a, b): &Pair<'_, _>| d.lcm(&a.denominator.mul(&b.denominator));
        let mut denominator = pairs().fold(Whole::ONE, lcm);
        let ordered: Vec<Pair<'_, _>> = pairs()
            .map(|(a, b)| if a.terms.len() < b.terms.len() { (*a, *b) } else { (*b, *a) })
            .collect();
        let halves: Vec<_> = ordered.iter().filter(|_| real).map(|(a, _)| self.half(a)).collect();
        let lists = ordered.iter().enumerate().map(|(i, (a, b))| {
            let a = halves.get(i).unwrap_or(&a.terms);
            [&a[..], &b.terms[..]]
        });
        let lists: Vec<_> = lists.collect();
        let add = |mut sum: Sum<S::Element>| {
            let mut unseen = 0;
            for ((a, b), lists) in ordered.iter().zip(&lists) {
                unseen += lists[0].len() * lists[1].len();
                if unseen > LOOK {
                    unseen = 0;
                    if self.stop.asked() {
                        break;
                    }
                }
                let n = denominator.divided(&a.denominator).divided(&b.denominator);
                self.accumulate(&mut sum, *lists, &n)?;
            }
            Some(sum.sorted(|| self.scalars.zero()))
        };
        let mut terms = self.summed_up(&lists, &add);
        if real {
            let mut mirror = self.mirror(&terms);
            mirror.sort_unstable_by_key(|(word, _)| *word);
            terms = self.merged(terms, &mirror, [&Whole::ONE, &Whole::ONE]);
            // h + conj h was twice the factor.
            let (half, two) = self.scalars.fraction(&Rational::from((1, 2)));
            denominator = denominator.mul(&two);
            for part in terms.iter_mut().flat_map(|(_, c)| c) {
                *part = self.scalars.product(part, &half);
            }
        }
        self.reduced(self.canonical(denominator, terms, real))
    }

    /// What `add` makes of a sum in which all words have numbers of their own.
    fn summed_up(
        &self,
        lists: &[[&[Term<S::Element>]; 2]],
        add: &dyn Fn(Sum<S::Element>) -> Option<Terms<S::Element>>,
    ) -> Terms<S::Element> {
        let products: usize = lists.iter().map(|[a, b]| a.len() * b.len()).sum();
        let numbered = |independent: u32| {
            let exponents = (0..DIGITS).filter(|i| independent >> i & 1 == 1);
            add(Sum::numbered(Numbering::of(self.layout, lists, exponents, products)?))
        };
        // Mostly what the sum before had.
        let known = self.independent.load(Relaxed);
        let mut terms = if products < FEW || known == SPARSE { None } else { numbered(known) };
        if terms.is_none() && known != SPARSE && products > MANY * lists.len() {
            let new = independent(self.layout, self.exponents(), lists);
            terms = if new == known { None } else { numbered(new) };
            self.independent.store(if terms.is_some() { new } else { SPARSE }, Relaxed);
        }
        // Words that are hashed are never refused.
        terms.or_else(|| add(Sum::hashed())).unwrap_or_default()
    }

    /// The product with a single term, which keeps the order of the words.
    fn of_single(
        &self,
        a: &AmplitudeElement<S::Element>,
        b: &AmplitudeElement<S::Element>,
    ) -> Option<AmplitudeElement<S::Element>> {
        let [(v, [x, y])] = &a.terms[..] else { return None };
        let minus = self.scalars.neg(y);
        let denominator = a.denominator.mul(&b.denominator);
        let mut content = denominator.clone();
        if let Some(e) = [(x, y), (y, x)]
            .into_iter()
            .find_map(|(e, other)| self.scalars.is_zero(other).then_some(e))
        {
            // What e and the denominator of b share, and that of a with b.
            content.clone_from(&b.denominator);
            self.scalars.content(&mut content, e);
            content = content.mul(&a.denominator);
        }
        let term = |(w, [re, im]): &Term<S::Element>| {
            (v + w, [[(re, x), (im, &minus)], [(re, y), (im, x)]].map(|pairs| self.sum(pairs)))
        };
        let terms = b.terms.iter().map(term).collect();
        Some(self.canonical_within(content, denominator, terms, a.real && b.real))
    }

    /// a b + c d, of which zeros cost nothing.
    pub(super) fn sum(&self, pairs: [(&S::Element, &S::Element); 2]) -> S::Element {
        let scalars = &self.scalars;
        let nonzero =
            |(a, b): &(&S::Element, &S::Element)| !scalars.is_zero(a) && !scalars.is_zero(b);
        match pairs.each_ref().map(nonzero) {
            [false, false] => scalars.zero(),
            [true, false] => scalars.product(pairs[0].0, pairs[0].1),
            [false, true] => scalars.product(pairs[1].0, pairs[1].1),
            [true, true] => scalars.sum_of_products(&pairs),
        }
    }
}

impl<S: Scalars> Ring for Amplitudes<S> {
    type Element = AmplitudeElement<S::Element>;

    fn zero(&self) -> Self::Element {
        AmplitudeElement { denominator: Whole::ONE, terms: Vec::new(), real: true }
    }
    fn one(&self) -> Self::Element {
        self.monomial(0, true)
    }
    fn is_zero(&self, f: &Self::Element) -> bool {
        f.terms.is_empty()
    }
    fn size(&self, f: &Self::Element) -> usize {
        f.terms.len()
    }
    fn may_vanish(&self, f: &Self::Element) -> bool {
        f.terms.iter().flat_map(|(_, c)| c).all(|part| self.scalars.may_vanish(part))
    }
    fn add_assign(&self, a: &mut Self::Element, b: &Self::Element) {
        if b.terms.is_empty() {
            return;
        }
        if a.terms.is_empty() {
            a.clone_from(b);
            return;
        }
        let real = a.real && b.real;
        let own = std::mem::replace(a, self.zero());
        *a = self.total(own, b, real);
    }
    fn neg(&self, f: &Self::Element) -> Self::Element {
        let term =
            |(word, c): &Term<S::Element>| (*word, c.each_ref().map(|part| self.scalars.neg(part)));
        AmplitudeElement {
            denominator: f.denominator.clone(),
            terms: f.terms.iter().map(term).collect(),
            real: f.real,
        }
    }
    fn mul(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        self.products(&[(a, b)])
    }
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        self.products(pairs)
    }
}

impl<S: Scalars> RationalAlgebra for Amplitudes<S> {
    fn rational(&self, q: &Rational) -> Self::Element {
        let (e, denominator) = self.scalars.fraction(q);
        self.single(0, [e, self.scalars.zero()], denominator, true)
    }
    fn scale(&self, f: &Self::Element, q: &Rational) -> Self::Element {
        if *q == 1 { f.clone() } else { self.scaled(f, q) }
    }
    /// Of the complex constants that S can divide by, 1/(re + i im) = (re - i im)/(re^2 + im^2), times symbols that have
    /// inverses.
    fn reciprocal(&self, f: &Self::Element) -> Option<Self::Element> {
        let [(word, [re, im])] = &f.terms[..] else { return None };
        let word = self.inverse_of(*word)?;
        let scalars = &self.scalars;
        let minus = scalars.neg(im);
        if scalars.is_zero(im) {
            let (e, d) = scalars.inverse(re, &f.denominator)?;
            return Some(self.single(word, [e, scalars.zero()], d, f.real));
        }
        if scalars.is_zero(re) {
            let (e, d) = scalars.inverse(&minus, &f.denominator)?;
            return Some(self.single(word, [scalars.zero(), e], d, false));
        }
        let square = scalars.sum_of_products(&[(re, re), (im, im)]);
        let (e, d) = scalars.inverse(&square, &f.denominator)?;
        let parts = [re, &minus].map(|part| scalars.product(part, &e));
        Some(self.single(word, parts, d, false))
    }
    fn as_rational(&self, f: &Self::Element) -> Option<Rational> {
        match &f.terms[..] {
            [] => Some(Rational::new()),
            [(0, [re, im])] if self.scalars.is_zero(im) => {
                self.scalars.quotient(re, &f.denominator)
            }
            _ => None,
        }
    }
}

impl<S: Scalars> FunctionAlgebra for Amplitudes<S> {
    // Symbols are part of the polynomials, and so constants are polynomials, too.
    type Constants = Self;

    fn constants(&self) -> &Self {
        self
    }
    fn embed(&self, c: &Self::Element) -> Self::Element {
        c.clone()
    }
    fn scale_by(&self, f: &Self::Element, c: &Self::Element) -> Self::Element {
        self.mul(f, c)
    }
    fn as_constant(&self, f: &Self::Element) -> Option<Self::Element> {
        let constant =
            |word: Word| self.layout.exponents(word, self.moving()).0.iter().all(|e| *e == 0);
        f.terms.iter().all(|(word, _)| constant(*word)).then(|| f.clone())
    }
    fn log_abs(&self, _: &Self::Element) -> Option<Self::Element> {
        None
    }
    fn terms(&self, f: &Self::Element) -> usize {
        f.terms.len()
    }
    fn interrupted(&self) -> bool {
        self.overflowed() || self.stop.asked()
    }
}

impl<S: Scalars> ForcedAlgebra for Amplitudes<S> {
    fn delays(&self) -> usize {
        self.delays.len()
    }
    fn forcing(&self, multiple: u32) -> Option<(Self::Element, Self::Element)> {
        let [cos, sin] = self.wave(0, i32::try_from(multiple).ok()?)?;
        Some((cos, sin))
    }
}
