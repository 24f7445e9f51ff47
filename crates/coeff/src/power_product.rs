//! Named constants and products of their powers.

use crate::sparse::Monomial;
use smallvec::SmallVec;
use std::cmp::Ordering;

/// A constant that has a name. Nothing is assumed about its value: identities between constants
/// (zeta(2) = pi^2/6, the closed forms of mu_m) are theorems applied by name elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// A formal parameter, by its position in [`PolynomialRing::parameters`](crate::PolynomialRing).
    Parameter(u16),
    /// S_n, the n-th Taylor coefficient of a formal function, n! [z^n] F(z).
    Sum(u16),
    /// mu_m = (1/m!) <(-ln|cos t|)^m>, the log-cosine moments.
    Moment(u16),
    /// ln 2.
    LogTwo,
    /// pi.
    Pi,
    /// zeta(k).
    Zeta(u16),
}

impl Symbol {
    /// The weight that makes the expansions homogeneous: mu_m, zeta(m) and S_m have weight m,
    /// ln 2 and pi weight 1, parameters weight 0.
    pub fn weight(self) -> u32 {
        match self {
            Self::Parameter(_) => 0,
            Self::Sum(n) | Self::Moment(n) | Self::Zeta(n) => u32::from(n),
            Self::LogTwo | Self::Pi => 1,
        }
    }
}

/// A product of powers of symbols: strictly increasing symbols, exponents not zero.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct PowerProduct(SmallVec<[(Symbol, i16); 4]>);

impl PowerProduct {
    /// symbol^exponent.
    pub fn power(symbol: Symbol, exponent: i16) -> Self {
        let mut factors = SmallVec::new();
        if exponent != 0 {
            factors.push((symbol, exponent));
        }
        Self(factors)
    }

    /// The product of powers of strictly increasing symbols; powers with exponent zero are left out.
    pub fn increasing(factors: impl Iterator<Item = (Symbol, i16)>) -> Self {
        Self(factors.filter(|(_, exponent)| *exponent != 0).collect())
    }

    /// The factors, symbols increasing.
    pub fn factors(&self) -> &[(Symbol, i16)] {
        &self.0
    }

    /// A number that is the larger, the larger the list of factors, compared one by one; `falling` compares higher powers
    /// of a symbol as smaller ones. Of up to eight powers of parameters, the first 255, below the 128th.
    pub fn rank(&self, falling: bool) -> Option<u128> {
        let digit = |&(symbol, exponent): &(Symbol, i16)| {
            let Symbol::Parameter(index) = symbol else { return None };
            let exponent = if falling { -i32::from(exponent) } else { exponent.into() };
            let power = u8::try_from(exponent + 128).ok()?;
            let index = u8::try_from(index).ok()?.checked_add(1)?;
            Some(u128::from(index) << 8 | u128::from(power))
        };
        // What is no factor ranks lowest.
        let place =
            |(i, factor): (usize, _)| Some(digit(factor)? << (112usize.checked_sub(16 * i)?));
        self.0.iter().enumerate().map(place).try_fold(0, |sum, digit| Some(sum | digit?))
    }

    /// The sum of weight times exponent.
    pub fn weight(&self) -> i64 {
        // Parameters come first and weigh nothing.
        if self.0.last().is_none_or(|(last, _)| matches!(last, Symbol::Parameter(_))) {
            return 0;
        }
        self.0.iter().map(|&(s, e)| i64::from(s.weight()) * i64::from(e)).sum()
    }
}

impl Ord for PowerProduct {
    /// By weight, then by the list of factors: a fixed order for printing and comparing.
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight().cmp(&other.weight()).then_with(|| self.0.cmp(&other.0))
    }
}

impl PartialOrd for PowerProduct {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Monomial for PowerProduct {
    fn unit() -> Self {
        Self::default()
    }

    fn times(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        let mut product = SmallVec::with_capacity(a.len() + b.len());
        let (mut i, mut j) = (0, 0);
        while i < a.len() && j < b.len() {
            match a[i].0.cmp(&b[j].0) {
                Ordering::Less => {
                    product.push(a[i]);
                    i += 1;
                }
                Ordering::Greater => {
                    product.push(b[j]);
                    j += 1;
                }
                Ordering::Equal => {
                    // Derivations refuse equations whose powers could get to the ends of i16.
                    let exponent = a[i].1.saturating_add(b[j].1);
                    if exponent != 0 {
                        product.push((a[i].0, exponent));
                    }
                    i += 1;
                    j += 1;
                }
            }
        }
        product.extend_from_slice(&a[i..]);
        product.extend_from_slice(&b[j..]);
        Self(product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cmp::Reverse;

    /// Numbers in place of lists: the same order, falling powers, too.
    #[test]
    fn ranks_are_ordered_as_factors_are() {
        let exponents = [-3, 0, 1, 2];
        let mut all = Vec::new();
        for (a, b, c) in exponents
            .into_iter()
            .flat_map(|a| exponents.into_iter().flat_map(move |b| exponents.map(|c| (a, b, c))))
        {
            let factors = [(0, a), (3, b), (254, c)].map(|(i, e)| (Symbol::Parameter(i), e));
            all.push(PowerProduct::increasing(factors.into_iter()));
        }
        let falling = |m: &PowerProduct| m.0.iter().map(|(s, e)| (*s, Reverse(*e))).collect();
        for m in &all {
            for n in &all {
                assert_eq!(m.rank(false).cmp(&n.rank(false)), m.cmp(n));
                let [a, b]: [Vec<_>; 2] = [m, n].map(falling);
                assert_eq!(m.rank(true).cmp(&n.rank(true)), a.cmp(&b));
            }
        }
        let none = [(Symbol::Pi, 1), (Symbol::Parameter(255), 1), (Symbol::Parameter(0), 128)];
        assert!(none.iter().all(|(s, e)| PowerProduct::power(*s, *e).rank(false).is_none()));
        let nine = PowerProduct::increasing((0..9).map(|i| (Symbol::Parameter(i), 1)));
        assert_eq!(nine.rank(false), None);
    }
}
