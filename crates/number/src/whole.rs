//! Integers that are mostly small: a machine word, and digits on the heap only where one does not do.

use rug::{Integer, Rational};

/// An integer. Exact; up to 64 bits nothing is allocated.
///
/// ```
/// use lindstedt_number::Whole;
/// use rug::Integer;
/// let mut sum = Whole::from(5i64);
/// sum.add_product(&Whole::from(i64::MAX), &Whole::from(2i64));
/// assert_eq!(sum.to_integer(), Integer::from(i64::MAX) * 2 + 5);
/// sum.add_product(&Whole::from(i64::MAX), &Whole::from(-2i64));
/// assert_eq!(sum, Whole::from(5i64));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Whole(Digits);

/// Canonical: what fits into a word is in one.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Digits {
    Word(i64),
    Long(Box<Integer>),
}

use Digits::{Long, Word};

impl Whole {
    /// 0.
    pub const ZERO: Self = Self(Word(0));

    /// 1.
    pub const ONE: Self = Self(Word(1));

    /// Whether it is 0.
    #[inline]
    pub fn is_zero(&self) -> bool {
        matches!(self.0, Word(0))
    }

    /// The same integer.
    pub fn to_integer(&self) -> Integer {
        match &self.0 {
            Word(n) => Integer::from(*n),
            Long(n) => (**n).clone(),
        }
    }

    /// self <- self + other.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        if let (Word(a), Word(b)) = (&self.0, &other.0)
            && let Some(sum) = a.checked_add(*b)
        {
            self.0 = Word(sum);
            return;
        }
        *self = match (&mut self.0, &other.0) {
            (Long(a), Word(b)) => Self::from(std::mem::take(&mut **a) + *b),
            (Long(a), Long(b)) => Self::from(std::mem::take(&mut **a) + &**b),
            (Word(a), Long(b)) => Self::from(Integer::from(&**b + *a)),
            (Word(a), Word(b)) => Self::from(i128::from(*a) + i128::from(*b)),
        };
    }

    /// -self.
    #[inline]
    #[must_use]
    pub fn neg(&self) -> Self {
        match &self.0 {
            Word(n) => n.checked_neg().map_or_else(|| Self::from(-i128::from(*n)), Self::from),
            Long(n) => Self::from(Integer::from(-&**n)),
        }
    }

    /// self other.
    #[inline]
    #[must_use]
    pub fn mul(&self, other: &Self) -> Self {
        match (&self.0, &other.0) {
            (Word(a), Word(b)) => Self::from(i128::from(*a) * i128::from(*b)),
            (Word(a), Long(b)) | (Long(b), Word(a)) => Self::from(Integer::from(&**b * *a)),
            (Long(a), Long(b)) => Self::from(Integer::from(&**a * &**b)),
        }
    }

    /// self <- self + a b.
    #[inline]
    pub fn add_product(&mut self, a: &Self, b: &Self) {
        if let (Word(sum), Word(a), Word(b)) = (&mut self.0, &a.0, &b.0)
            && let Some(product) = a.checked_mul(*b)
            && let Some(total) = sum.checked_add(product)
        {
            *sum = total;
            return;
        }
        self.add_long_product(a, b);
    }

    #[inline(never)]
    fn add_long_product(&mut self, a: &Self, b: &Self) {
        let mut sum = match &mut self.0 {
            Word(n) => Integer::from(*n),
            Long(n) => std::mem::take(&mut **n),
        };
        match (&a.0, &b.0) {
            // |a b| <= 2^126.
            (Word(a), Word(b)) => sum += Integer::from(i128::from(*a) * i128::from(*b)),
            (Word(a), Long(b)) | (Long(b), Word(a)) => sum += &**b * *a,
            (Long(a), Long(b)) => sum += &**a * &**b,
        }
        match &mut self.0 {
            // Its place on the heap stays.
            Long(n) if sum.to_i64().is_none() => **n = sum,
            _ => *self = Self::from(sum),
        }
    }

    /// g <- gcd(g, self) for g >= 0.
    pub fn gcd(&self, g: &mut Self) {
        // Of what is long no more than the remainder by a word.
        let (n, m) = match (&self.0, &g.0) {
            (Word(n), Word(m)) => (n.unsigned_abs(), m.unsigned_abs()),
            (Word(0), Long(_)) => return,
            (Long(n), Word(m)) if *m != 0 => (remainder(n, *m), m.unsigned_abs()),
            (Word(n), Long(m)) => (remainder(m, *n), n.unsigned_abs()),
            _ => {
                let mut common = g.to_integer();
                common.gcd_mut(&self.to_integer());
                *g = Self::from(common);
                return;
            }
        };
        // Often a multiple: one division says so.
        let common = if m > 0 && n.is_multiple_of(m) { m } else { gcd(n, m) };
        *g = Self::from(i128::from(common));
    }

    /// The least common multiple of two positive integers.
    #[must_use]
    pub fn lcm(&self, other: &Self) -> Self {
        let mut common = self.clone();
        other.gcd(&mut common);
        self.divided(&common).mul(other)
    }

    /// self <- self/n for a divisor n.
    pub fn divide(&mut self, n: &Self) {
        match (&mut self.0, &n.0) {
            // i64::MIN/-1 is no word.
            (Word(a), Word(n)) if *n > 0 => *a /= n,
            _ => {
                let mut quotient = self.to_integer();
                quotient.div_exact_mut(&n.to_integer());
                *self = Self::from(quotient);
            }
        }
    }

    /// self/n for a divisor n.
    #[must_use]
    pub fn divided(&self, n: &Self) -> Self {
        let mut quotient = self.clone();
        quotient.divide(n);
        quotient
    }

    /// self/d, d not zero.
    pub fn over(&self, d: &Self) -> Rational {
        match (&self.0, &d.0) {
            (Word(n), Word(d)) => Rational::from((*n, *d)),
            (Long(n), Word(d)) => Rational::from((&**n, *d)),
            (Word(n), Long(d)) => Rational::from((*n, &**d)),
            (Long(n), Long(d)) => Rational::from((&**n, &**d)),
        }
    }
}

/// |n mod m|, m not zero.
fn remainder(n: &Integer, m: i64) -> u64 {
    Integer::from(n % m.unsigned_abs()).abs().to_u64().unwrap_or_default()
}

/// By bits.
fn gcd(mut a: u64, mut b: u64) -> u64 {
    if a == 0 || b == 0 {
        return a | b;
    }
    if b.is_power_of_two() {
        return b.min(1 << a.trailing_zeros());
    }
    let shift = (a | b).trailing_zeros();
    a >>= a.trailing_zeros();
    loop {
        b >>= b.trailing_zeros();
        if a > b {
            std::mem::swap(&mut a, &mut b);
        }
        b -= a;
        if b == 0 {
            return a << shift;
        }
    }
}

impl From<i64> for Whole {
    #[inline]
    fn from(n: i64) -> Self {
        Self(Word(n))
    }
}

impl From<i128> for Whole {
    #[inline]
    fn from(n: i128) -> Self {
        i64::try_from(n).map_or_else(|_| long(n), Self::from)
    }
}

#[inline(never)]
fn long(n: i128) -> Whole {
    Whole(Long(Box::new(Integer::from(n))))
}

impl From<Integer> for Whole {
    fn from(n: Integer) -> Self {
        Self(n.to_i64().map_or_else(|| Long(Box::new(n)), Word))
    }
}

impl From<&Integer> for Whole {
    fn from(n: &Integer) -> Self {
        Self(n.to_i64().map_or_else(|| Long(Box::new(n.clone())), Word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On both sides of the ends of a word.
    fn samples() -> Vec<Integer> {
        let ends = [i64::MIN, i64::MAX, 0, 1 << 40].map(Integer::from);
        let near = |n: Integer| [-2, -1, 0, 1, 2].map(|d| n.clone() + d);
        let square = ends[1].clone().square();
        ends.into_iter().chain([square]).flat_map(near).collect()
    }

    #[test]
    fn the_same_as_of_long_integers() {
        let all = samples();
        for a in &all {
            let x = Whole::from(a);
            assert_eq!(x.to_integer(), *a);
            assert_eq!(x.neg(), Whole::from(Integer::from(-a)));
            for b in &all {
                let y = Whole::from(b);
                let mut sum = x.clone();
                sum.add(&y);
                assert_eq!(sum, Whole::from(Integer::from(a + b)));
                assert_eq!(x.mul(&y), Whole::from(Integer::from(a * b)));
                for c in &all {
                    let mut sum = Whole::from(c);
                    sum.add_product(&x, &y);
                    assert_eq!(sum, Whole::from(Integer::from(a * b) + c));
                }
                let mut g = Whole::from(b.clone().abs());
                x.gcd(&mut g);
                assert_eq!(g, Whole::from(a.clone().gcd(b)));
                if *a > 0 && *b > 0 {
                    assert_eq!(x.lcm(&y), Whole::from(a.clone().lcm(b)));
                }
                if !b.is_zero() {
                    let product = Whole::from(Integer::from(a * b));
                    assert_eq!(product.divided(&y), x);
                    assert_eq!(x.over(&y), Rational::from((a, b)));
                }
            }
        }
    }
}
