//! Linear equations whose coefficients are polynomials in parameters, with negative powers too.
//!
//! Elimination without fractions: a product of parameters can be divided by, and so can a row whose entries are all multiples
//! of its pivot; where neither is so rows are multiplied by each other's pivots.

use lindstedt_equation::monomials::{Monomial, Terms, add, product};
use rug::Rational;

type Row = Vec<Terms>;

/// Terms of a quotient at most, and of all rows: weights that are longer are looked for no further.
const LONGEST_QUOTIENT: usize = 64;
const MOST_TERMS: usize = 1000;

/// A number as a polynomial.
pub(super) fn as_parameter_free(q: &Rational) -> Terms {
    let mut sum = Terms::new();
    add(&mut sum, Monomial::default(), q);
    sum
}

/// m^n for n = 1 and -1.
fn to_the(m: &Monomial, n: i32) -> Monomial {
    let parameters = m.parameters.iter().map(|(name, e)| (name.clone(), e * n));
    Monomial { parameters: parameters.collect(), ..Monomial::default() }
}

/// The greatest product of parameters that divides all terms of all entries.
fn content<'a>(entries: impl Iterator<Item = &'a Terms>) -> Monomial {
    let mut monomials = entries.flat_map(Terms::keys);
    let mut common = monomials.next().map_or_else(Monomial::default, Monomial::clone);
    for m in monomials {
        let below = m.parameters.iter().filter(|(_, e)| **e < 0).map(|(name, _)| (name.clone(), 0));
        for (name, none) in below {
            common.parameters.entry(name).or_insert(none);
        }
        for (name, e) in &mut common.parameters {
            *e = (*e).min(m.parameters.get(name).copied().unwrap_or(0));
        }
    }
    common.parameters.retain(|_, e| *e != 0);
    common
}

/// The term of a polynomial that is first in an order which products keep: by the power of the first parameter, and so on.
fn leading(terms: &Terms) -> Option<(&Monomial, &Rational)> {
    let mut best = terms.iter().next()?;
    for term in terms {
        let gap = term.0.times(&to_the(best.0, -1))?;
        if gap.parameters.values().next().is_some_and(|e| *e > 0) {
            best = term;
        }
    }
    Some(best)
}

fn scaled(terms: &Terms, m: &Monomial) -> Option<Terms> {
    terms.iter().map(|(own, q)| Some((own.times(m)?, q.clone()))).collect()
}

fn subtract(from: &mut Terms, terms: &Terms) {
    terms.iter().for_each(|(m, q)| add(from, m.clone(), &Rational::from(-q)));
}

/// a/b where it is a polynomial, b not zero. Freed of products of parameters both have the powers of polynomials, and so has
/// their quotient: the division ends.
fn quotient(a: &Terms, b: &Terms) -> Option<Terms> {
    let [own, other] = [a, b].map(|terms| content(std::iter::once(terms)));
    let mut rest = scaled(a, &to_the(&own, -1))?;
    let b = scaled(b, &to_the(&other, -1))?;
    let (first, factor) = leading(&b)?;
    let mut found = Terms::new();
    while let Some((m, q)) = leading(&rest) {
        let m = m.times(&to_the(first, -1))?;
        if m.parameters.values().any(|e| *e < 0) {
            return None;
        }
        let term = Terms::from([(m, Rational::from(q / factor))]);
        subtract(&mut rest, &product(&term, &b)?);
        found.extend(term);
        if found.len() > LONGEST_QUOTIENT {
            return None;
        }
    }
    scaled(&found, &own.times(&to_the(&other, -1))?)
}

/// All entries over one of them, if that divides them.
fn over(row: &Row, entry: &Terms) -> Option<Row> {
    row.iter().map(|own| quotient(own, entry)).collect()
}

/// A pivot among rows: one that divides its row before others, and that row.
fn pivot(rows: &[Row]) -> Option<(usize, usize, Row)> {
    let places = || {
        let row = |(i, row): (usize, &Row)| (0..row.len()).map(move |j| (i, j));
        rows.iter().enumerate().flat_map(row).filter(|(i, j)| !rows[*i][*j].is_empty())
    };
    let one = places().find_map(|(i, j)| Some((i, j, over(&rows[i], &rows[i][j])?)));
    one.or_else(|| places().next().map(|(i, j)| (i, j, rows[i].clone())))
}

/// The rows that elimination leaves with their pivots, each the only entry of its column; nothing where that takes too long.
fn reduced(mut rows: Vec<Row>) -> Option<Vec<(usize, Row)>> {
    let mut done: Vec<(usize, Row)> = Vec::new();
    loop {
        rows.retain(|row| row.iter().any(|entry| !entry.is_empty()));
        if rows.iter().flatten().map(Terms::len).sum::<usize>() > MOST_TERMS {
            return None;
        }
        let Some((i, j, chosen)) = pivot(&rows) else { return Some(done) };
        rows.swap_remove(i);
        for row in rows.iter_mut().chain(done.iter_mut().map(|(_, row)| row)) {
            let own = row[j].clone();
            if own.is_empty() {
                continue;
            }
            for (entry, other) in row.iter_mut().zip(&chosen) {
                *entry = product(entry, &chosen[j])?;
                subtract(entry, &product(other, &own)?);
            }
        }
        done.push((j, chosen));
    }
}

pub(super) fn rank(rows: Vec<Row>) -> Option<usize> {
    Some(reduced(rows)?.len())
}

/// A basis of the vectors that are orthogonal to all rows, of n entries: free of common factors that are products of parameters
/// and of powers below zero, their first entries with the factor 1, and 1 where they divide the others.
pub(super) fn kernel(rows: Vec<Row>, n: usize) -> Option<Vec<Row>> {
    let done = reduced(rows)?;
    let free = (0..n).filter(|j| done.iter().all(|(own, _)| own != j));
    let vector = |free: usize| {
        let mut vector = vec![Terms::new(); n];
        vector[free] = as_parameter_free(&1.into());
        for (own, row) in done.iter().filter(|(_, row)| !row[free].is_empty()) {
            // row[own] v_own + row[free] v_free = 0.
            let (known, scale) = (product(&row[free], &vector[free])?, row[*own].clone());
            match quotient(&known, &scale) {
                Some(value) => subtract(&mut vector[*own], &value),
                None => {
                    for entry in &mut vector {
                        *entry = product(entry, &scale)?;
                    }
                    subtract(&mut vector[*own], &known);
                }
            }
        }
        plain(vector)
    };
    free.map(vector).collect()
}

/// A vector over its first entry where that divides it, and without common products of parameters.
fn plain(vector: Row) -> Option<Row> {
    let first = vector.iter().find(|entry| !entry.is_empty())?;
    let vector = over(&vector, first).unwrap_or(vector);
    let common = content(vector.iter());
    let (_, factor) = leading(vector.iter().find(|entry| !entry.is_empty())?)?;
    let scale = product(
        &as_parameter_free(&factor.clone().recip()),
        &Terms::from([(to_the(&common, -1), 1.into())]),
    )?;
    vector.iter().map(|entry| product(entry, &scale)).collect()
}
