//! Autonomous polynomial vector fields w' = G(w; p), and the points at which steady states change, as zeros of larger
//! polynomial systems.

use super::value::Value;
use super::{Polynomial, System};
use rug::Rational;

/// w' = G(w; p): the variables 0, ..., n - 1 of the polynomials are w, those that follow are the parameters.
#[derive(Clone, Debug)]
pub struct Flow {
    /// G.
    pub rows: Vec<Polynomial>,
    /// The names of the parameters.
    pub parameters: Vec<String>,
    /// Its equations in complex unknowns, where it is made of such.
    pub(super) complex: Vec<Vec<ComplexTerm>>,
}

/// A term of w_j' in complex unknowns: (re + i im) prod_j w_j^(p_j) conj(w_j)^(q_j) times powers of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplexTerm {
    /// p_1, q_1, p_2, q_2, ...
    pub amplitudes: Vec<u32>,
    /// The exponents of the parameters.
    pub parameters: Vec<u32>,
    /// The real part.
    pub re: Rational,
    /// The imaginary part.
    pub im: Rational,
    /// What each of these may be off by.
    pub radius: f64,
}

/// A point at which steady states change. With J = G_w:
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Change {
    /// J v = 0: two states meet and vanish; one parameter is free.
    Fold,
    /// J (a - i b) = i rate (a - i b): an oscillation of the amplitudes, a torus; one parameter is free.
    Hopf,
    /// J v = 0 and J u + G_ww(v, v) = 0: two folds meet; two parameters are free.
    Cusp,
    /// J v = 0 and J u = v: a double zero exponent; two parameters are free.
    BogdanovTakens,
    /// Two branches cross: a fold in every direction.
    Crossing,
}

impl Flow {
    /// The flow of complex unknowns as one of their real and imaginary parts, Re w_1, Im w_1, Re w_2, ...
    #[must_use]
    pub fn of_complex(equations: &[Vec<ComplexTerm>], parameters: &[&str]) -> Self {
        let unknowns = 2 * equations.len();
        let part = |j: usize, sign: i32| {
            [Polynomial::variable(2 * j), &Polynomial::variable(2 * j + 1) * &whole(sign)]
        };
        let mut rows = Vec::new();
        for equation in equations {
            let mut sum = [Polynomial::default(), Polynomial::default()];
            for term in equation {
                let coefficient = |q: &Rational| Polynomial::within(q.clone(), term.radius);
                let mut product = [&term.re, &term.im].map(coefficient);
                for (k, e) in term.amplitudes.iter().enumerate() {
                    let factor = part(k / 2, if k % 2 == 0 { 1 } else { -1 });
                    product = (0..*e).fold(product, |p, _| times(&p, &factor));
                }
                let mut exponents = vec![0; unknowns];
                exponents.extend(&term.parameters);
                let mut powers = Polynomial::default();
                powers.add_term(&exponents, &Rational::from(1));
                sum = [0, 1].map(|k| std::mem::take(&mut sum[k]) + &(&product[k] * &powers));
            }
            rows.extend(sum);
        }
        let parameters = parameters.iter().map(|name| (*name).to_owned()).collect();
        Self { complex: equations.to_vec(), ..Self::of_rows(rows, parameters) }
    }

    /// A flow of any polynomials.
    #[must_use]
    pub fn of_rows(rows: Vec<Polynomial>, parameters: Vec<String>) -> Self {
        Self { rows, parameters, complex: Vec::new() }
    }

    /// n.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.rows.len()
    }

    /// G as functions of w and of the parameters without a value; `values` in the order of the parameters.
    #[must_use]
    pub fn system(&self, values: &[Option<Value>]) -> System {
        System::new(&self.rows, &self.given(values))
    }

    fn given(&self, values: &[Option<Value>]) -> Vec<Option<Value>> {
        std::iter::repeat_n(None, self.unknowns()).chain(values.iter().cloned()).collect()
    }

    /// G and det G_w, both zero at folds and where branches cross; nothing of more than two unknowns, where the determinant
    /// has too many terms.
    pub(super) fn turning(&self, values: &[Option<Value>]) -> Option<System> {
        let [first, second] = &self.rows[..] else { return None };
        let minus = &second.by(0) * &whole(-1);
        let determinant = (&first.by(0) * &second.by(1)) + &(&first.by(1) * &minus);
        let rows = [first.clone(), second.clone(), determinant];
        Some(System::new(&rows, &self.given(values)))
    }

    /// The number of free parameters of a change.
    #[must_use]
    pub fn free(change: Change) -> usize {
        match change {
            Change::Fold | Change::Hopf | Change::Crossing => 1,
            Change::Cusp | Change::BogdanovTakens => 2,
        }
    }

    /// The polynomials whose zeros are the points of a change, in w, the free parameters, and v (and u; for a Hopf point
    /// a, b, rate); l is the vector with l v = 1, l u = 0 (l a = 1, l b = 0), but |v| = 1 of a fold. A crossing is a zero with beta = 0 of
    /// G + beta l, v J, v G_p, l v - 1 in w, p, v, beta (Moore 1980): at a zero with another beta the branches pass each other.
    #[must_use]
    pub fn conditions(
        &self,
        change: Change,
        values: &[Option<Value>],
        l: &[f64],
    ) -> Option<System> {
        let n = self.unknowns();
        let first = n + self.parameters.len();
        let list = |from: usize| (from..from + n).map(Polynomial::variable).collect::<Vec<_>>();
        let (v, u) = (list(first), list(first + n));
        let forms: Vec<_> = l
            .iter()
            .map(|x| Rational::from_f64(*x).map(Polynomial::constant))
            .collect::<Option<_>>()?;
        let form = |of: &[Polynomial]| dot(&forms, of);
        let along = |of: &[Polynomial]| -> Vec<Polynomial> {
            let row = |row: &Polynomial| dot(&(0..n).map(|j| row.by(j)).collect::<Vec<_>>(), of);
            self.rows.iter().map(row).collect()
        };
        let mut rows = self.rows.clone();
        let j_v = along(&v);
        match change {
            Change::Fold => rows.extend(j_v),
            Change::Hopf => {
                let rate = Polynomial::variable(first + 2 * n);
                let turned = &rate * &whole(-1);
                rows.extend(j_v.into_iter().zip(&u).map(|(jv, u)| jv + &(&rate * u)));
                rows.extend(along(&u).into_iter().zip(&v).map(|(ju, v)| ju + &(&turned * v)));
                rows.push(form(&u));
            }
            Change::Cusp => {
                let twice =
                    j_v.iter().map(|row| dot(&(0..n).map(|j| row.by(j)).collect::<Vec<_>>(), &v));
                let last: Vec<_> = along(&u).into_iter().zip(twice).map(|(a, b)| a + &b).collect();
                rows.extend(j_v);
                rows.extend(last);
                rows.push(form(&u));
            }
            Change::BogdanovTakens => {
                let last = along(&u).into_iter().zip(&v).map(|(ju, v)| ju + &(v * &whole(-1)));
                let last: Vec<_> = last.collect();
                rows.extend(j_v);
                rows.extend(last);
                rows.push(form(&u));
            }
            Change::Crossing => {
                let open = values.iter().position(Option::is_none)?;
                let beta = Polynomial::variable(first + n);
                rows.iter_mut()
                    .zip(&forms)
                    .for_each(|(row, l)| *row = std::mem::take(row) + &(&beta * l));
                let across = (0..n).chain([n + open]);
                let by = |k: usize| self.rows.iter().map(|row| row.by(k)).collect::<Vec<_>>();
                rows.extend(across.map(|k| dot(&by(k), &v)));
            }
        }
        // A curve of folds is followed along v, which would turn until no l of its start fits.
        let size = if change == Change::Fold { dot(&v, &v) } else { form(&v) };
        rows.push(size + &whole(-1));
        Some(System::new(&rows, &self.given(values)))
    }
}

pub(super) fn whole(n: i32) -> Polynomial {
    Polynomial::constant(Rational::from(n))
}

fn dot(a: &[Polynomial], b: &[Polynomial]) -> Polynomial {
    a.iter().zip(b).fold(Polynomial::default(), |sum, (a, b)| sum + &(a * b))
}

/// The product of complex numbers.
pub(super) fn times(a: &[Polynomial; 2], b: &[Polynomial; 2]) -> [Polynomial; 2] {
    let minus = &a[1] * &whole(-1);
    [(&a[0] * &b[0]) + &(&minus * &b[1]), (&a[0] * &b[1]) + &(&a[1] * &b[0])]
}
