//! An expression multiplied out: the form in which terms have an order and a degree.

use crate::Expression;
use crate::print::Style;
use rug::Rational;
use std::collections::BTreeMap;

/// Terms of an expanded expression; more are not formed.
pub const MOST_TERMS: usize = 1000;
/// Products of terms formed on the way.
const MOST_WORK: usize = 100_000;

/// small^order * parameters * x^x * x'^velocity * atoms.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Monomial {
    /// The power of the small parameter.
    pub order: u32,
    /// The power of x.
    pub x: u32,
    /// The power of x'.
    pub velocity: u32,
    /// Everything that is no polynomial, by its printed form.
    pub atoms: BTreeMap<String, u32>,
    /// Powers of parameters, and of constants that are no polynomial in them.
    pub parameters: BTreeMap<String, i32>,
}

/// A sum of monomials with what their atoms stand for.
#[derive(Clone, Debug, Default)]
pub struct Monomials {
    /// The terms with their rational factors, none of which is zero.
    pub terms: Terms,
    /// What the names of atoms and of constants stand for.
    pub atoms: BTreeMap<String, Expression>,
}

/// Multiplies out; nothing when that takes more than [`MOST_TERMS`] terms or too many products of
/// terms on the way.
///
/// ```
/// use lindstedt_equation::{Expression, monomials::expand};
/// let x = || Expression::DISPLACEMENT;
/// let square = expand(&((x() + 1) * (x() - 1))).ok_or("too long")?;
/// let constant = square.terms.get(&Default::default());
/// assert_eq!((square.terms.len(), constant), (2, Some(&(-1).into())));
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn expand(e: &Expression) -> Option<Monomials> {
    let mut expander = Expander::up_to(u32::MAX);
    let terms = expander.terms(e)?;
    Some(Monomials { terms, atoms: expander.atoms })
}

/// The terms with t and those without of an angle rate * t + start; nothing for one of another form or without t.
#[must_use]
pub fn angle(argument: &Expression) -> Option<(Monomials, Monomials)> {
    let Monomials { terms, atoms } = expand(argument)?;
    let mut rate = Monomials { terms: Terms::new(), atoms };
    let mut start = rate.clone();
    for (m, q) in terms {
        let part = match m.atoms.iter().next() {
            _ if (m.x, m.velocity) != (0, 0) => return None,
            None => &mut start,
            Some((key, 1)) if key == "t" && m.atoms.len() == 1 => &mut rate,
            Some(_) => return None,
        };
        part.terms.insert(m, q);
    }
    (!rate.terms.is_empty()).then_some((rate, start))
}

impl Expression {
    /// The expression multiplied out, its terms in a fixed order: equal for all ways of writing a
    /// polynomial; nothing when that takes too many terms.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let x = || Expression::DISPLACEMENT;
    /// assert_eq!((x() * (x() - 1)).multiplied_out(), (x().pow(2) - x()).multiplied_out());
    /// ```
    #[must_use]
    pub fn multiplied_out(&self) -> Option<Self> {
        let all = expand(self)?;
        Some(Self::Sum(all.terms.iter().map(|(monomial, q)| all.tree(monomial, q)).collect()))
    }
}

/// Monomials with their factors.
pub type Terms = BTreeMap<Monomial, Rational>;

/// The product of two sums; nothing when that takes too many terms.
#[must_use]
pub fn product(a: &Terms, b: &Terms) -> Option<Terms> {
    Expander::up_to(u32::MAX).product(a, b)
}

pub(crate) struct Expander {
    pub(crate) atoms: BTreeMap<String, Expression>,
    work: usize,
    /// Products of a higher degree are left out.
    degree: u32,
}

fn single(monomial: Monomial) -> Terms {
    Terms::from([(monomial, Rational::from(1))])
}

impl Expander {
    pub(crate) fn up_to(degree: u32) -> Self {
        Self { atoms: BTreeMap::new(), work: 0, degree }
    }

    pub(crate) fn terms(&mut self, e: &Expression) -> Option<Terms> {
        let one = Monomial::default();
        Some(match e {
            Expression::Number(q) if q.is_zero() => Terms::new(),
            Expression::Number(q) => Terms::from([(one, q.clone())]),
            Expression::Parameter(name) => {
                single(Monomial { parameters: BTreeMap::from([(name.clone(), 1)]), ..one })
            }
            Expression::Small => single(Monomial { order: 1, ..one }),
            e if *e == Expression::DISPLACEMENT => single(Monomial { x: 1, ..one }),
            e if *e == Expression::VELOCITY => single(Monomial { velocity: 1, ..one }),
            Expression::Sum(list) => {
                let mut sum = Terms::new();
                for e in list {
                    for (monomial, q) in self.terms(e)? {
                        add(&mut sum, monomial, &q);
                    }
                    self.spend(sum.len(), 1)?;
                }
                sum
            }
            Expression::Product(list) => {
                let mut product = single(one);
                for e in list {
                    let factor = self.terms(e)?;
                    product = self.product(&product, &factor)?;
                }
                product
            }
            Expression::Power(base, exponent) => return self.power(e, base, exponent),
            other => self.atom(other),
        })
    }

    fn spend(&mut self, terms: usize, work: usize) -> Option<()> {
        self.work += work;
        (terms <= MOST_TERMS && self.work <= MOST_WORK).then_some(())
    }

    fn atom(&mut self, e: &Expression) -> Terms {
        let e = e.canonical();
        if let Expression::Number(q) = e {
            return Terms::from([(Monomial::default(), q)]);
        }
        if e.is_constant() {
            return self.constant(&e, 1);
        }
        let key = e.print("eps", Style::Text);
        self.atoms.insert(key.clone(), e);
        single(Monomial { atoms: BTreeMap::from([(key, 1)]), ..Monomial::default() })
    }

    /// A constant that is no polynomial in the parameters, as one more parameter.
    fn constant(&mut self, e: &Expression, n: i32) -> Terms {
        let key = e.print("eps", Style::Text);
        self.atoms.insert(key.clone(), e.clone());
        single(Monomial { parameters: BTreeMap::from([(key, n)]), ..Monomial::default() })
    }

    fn power(
        &mut self,
        whole: &Expression,
        base: &Expression,
        exponent: &Expression,
    ) -> Option<Terms> {
        let n = exponent.as_number().filter(Rational::is_integer);
        let Some(n) = n.and_then(|n| n.numer().to_i32()) else { return Some(self.atom(whole)) };
        let of_base = self.terms(base)?;
        if n < 0 {
            // A product of parameters and a number can be divided by.
            if let [(monomial, q)] = &of_base.iter().collect::<Vec<_>>()[..]
                && **monomial
                    == (Monomial { parameters: monomial.parameters.clone(), ..Monomial::default() })
                && n > -1000
            {
                let mut inverse = (*monomial).clone();
                for exponent in inverse.parameters.values_mut() {
                    *exponent = exponent.saturating_mul(n);
                }
                let mut value = Rational::from(1);
                for _ in 0..n.unsigned_abs() {
                    value /= *q;
                }
                return Some(Terms::from([(inverse, value)]));
            }
            let base = base.canonical();
            let is_number = matches!(base, Expression::Number(_));
            return Some(if base.is_constant() && !is_number {
                self.constant(&base, n)
            } else {
                self.atom(whole)
            });
        }
        let mut power = single(Monomial::default());
        for _ in 0..n {
            power = self.product(&power, &of_base)?;
        }
        Some(power)
    }

    pub(crate) fn product(&mut self, a: &Terms, b: &Terms) -> Option<Terms> {
        let mut product = Terms::new();
        for (m, p) in a {
            let most = self.degree.saturating_sub(m.degree());
            let kept: Vec<_> = b.iter().filter(|(n, _)| n.degree() <= most).collect();
            self.spend(0, kept.len())?;
            for (n, q) in kept {
                add(&mut product, m.times(n)?, &Rational::from(p * q));
            }
        }
        self.spend(product.len(), 0)?;
        Some(product)
    }
}

/// Adds a term to a sum, which keeps none with the factor zero.
pub fn add(sum: &mut Terms, monomial: Monomial, q: &Rational) {
    use std::collections::btree_map::Entry;
    match sum.entry(monomial) {
        Entry::Vacant(entry) => {
            entry.insert(q.clone());
        }
        Entry::Occupied(mut entry) => {
            *entry.get_mut() += q;
            if entry.get().is_zero() {
                entry.remove();
            }
        }
    }
}

impl Monomial {
    /// The product; nothing where an exponent is too large.
    #[must_use]
    pub fn times(&self, other: &Self) -> Option<Self> {
        let mut product = self.clone();
        product.order = self.order.checked_add(other.order)?;
        product.x = self.x.checked_add(other.x)?;
        product.velocity = self.velocity.checked_add(other.velocity)?;
        for (key, n) in &other.atoms {
            let exponent = product.atoms.entry(key.clone()).or_default();
            *exponent = exponent.checked_add(*n)?;
        }
        for (name, n) in &other.parameters {
            let exponent = product.parameters.entry(name.clone()).or_default();
            *exponent = exponent.checked_add(*n)?;
            if *exponent == 0 {
                product.parameters.remove(name);
            }
        }
        Some(product)
    }

    /// The power of x, x' and the atoms together.
    pub(crate) fn degree(&self) -> u32 {
        let all = self.atoms.values().fold(self.x, |sum, n| sum.saturating_add(*n));
        all.saturating_add(self.velocity)
    }

    /// The monomial without the small parameter, x, x' and atoms: the constant factor.
    fn constant(&self) -> Self {
        Self { parameters: self.parameters.clone(), ..Self::default() }
    }

    /// Whether the rest of the monomial is x^x x'^velocity without atoms.
    #[must_use]
    pub fn is_power(&self, x: u32, velocity: u32) -> bool {
        self.x == x && self.velocity == velocity && self.atoms.is_empty()
    }
}

impl Monomials {
    /// A term as a tree: number, parameters, small^order, x, x', atoms.
    #[must_use]
    pub fn tree(&self, monomial: &Monomial, q: &Rational) -> Expression {
        let mut factors = vec![Expression::Number(q.clone())];
        let mut push = |base: Expression, n: i64| {
            if n != 0 {
                factors.push(base.pow(n));
            }
        };
        push(Expression::Small, monomial.order.into());
        for (name, n) in &monomial.parameters {
            let stands_for = self.atoms.get(name).cloned();
            push(stands_for.unwrap_or_else(|| Expression::parameter(name)), i64::from(*n));
        }
        push(Expression::DISPLACEMENT, monomial.x.into());
        push(Expression::VELOCITY, monomial.velocity.into());
        for (key, n) in &monomial.atoms {
            if let Some(atom) = self.atoms.get(key) {
                push(atom.clone(), i64::from(*n));
            }
        }
        Expression::Product(factors).canonical()
    }

    /// The sum of the constant factors of the terms that `wanted` accepts.
    #[must_use]
    pub fn coefficient(&self, wanted: impl Fn(&Monomial) -> bool) -> Expression {
        let chosen = self.terms.iter().filter(|(m, _)| wanted(m));
        Expression::Sum(chosen.map(|(m, q)| self.tree(&m.constant(), q)).collect()).canonical()
    }
}
