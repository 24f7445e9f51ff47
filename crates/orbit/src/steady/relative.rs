//! Motions of two complex unknowns that are steady but for a phase that the flow does not fix.
//!
//! Where w' = G(w) is the same for w_j e^{i d_j theta}, w_j(t) = w_j e^{i d_j delta t} is such a motion: G_j = i d_j delta w_j.
//! With c one of the unknowns, o the other, w_c = a > 0 (the phase is free) and w_o = a y, where G has no constant part and
//! so g = G/a is a polynomial in a and y, delta = Im g_c/d_c and
//!
//!   Re g_c = 0,   g_o = i (d_o/d_c) Im(g_c) y:
//!
//! three equations of a and y, whose zeros are isolated, also beside w = 0. All of them have |y| <= L for one c or
//! |y| <= 1/L for the other. Of whole weights n_1, n_2 without a common divisor w_c > 0 leaves |n_c| phases: as many zeros are
//! one motion.
//!
//! Where an energy E_1 |w_1|^2 + E_2 |w_2|^2 + ... is conserved (Lyapunov 1907: normal modes), such motions are families of one
//! parameter: the balance of energy makes one equation follow from the others, up to terms beyond the order of a truncated
//! flow. In its place the amplitude A of the family is given, E_1 A^2 = 4 (E_1 |w_1|^2 + E_2 |w_2|^2), or A^2 = 4 (|w_1|^2 + |w_2|^2)
//! where E_1 and E_2 are not known to have one sign, and G_j = (i d_j delta + beta E_j) w_j (Munoz-Almaraz et al. 2003): the
//! balance is beta (E_1^2 |w_1|^2 + E_2^2 |w_2|^2) = 0, so that beta vanishes, up to those terms.
//!
//!   E_c g_o = (i (d_o/d_c) E_c Im(g_c) + E_o Re g_c) y.
//!
//! Searches go by a and y ([`FreePhase::reduced`]), branches by w and delta ([`FreePhase::branches`]), since a may vanish along them.

use super::branch::follow;
use super::flow::{times, whole};
use super::krawczyk::newton;
use super::survey::{Located, crossing, located};
use super::{
    Branch, Change, ComplexTerm, Course, Flow, Point, Polynomial, System, Value, Zero, bound,
};
use crate::eigenvalues::eigenvalues;
use nalgebra::Complex;
use rug::Rational;
use rug::ops::Pow;
use std::f64::consts::PI;

/// A flow of two complex unknowns with a free phase.
#[derive(Clone, Debug)]
pub struct FreePhase {
    /// G.
    pub equations: [Vec<ComplexTerm>; 2],
    /// d_1, d_2, not 0.
    pub weights: [Rational; 2],
    /// The names of the parameters of G; of families the last is A.
    pub parameters: Vec<String>,
    /// E_1 and E_2 of families, in the parameters.
    pub energy: Option<[Polynomial; 2]>,
    /// Whether they are of one sign, so that A is measured by them.
    pub definite: bool,
}

/// A branch of such motions.
#[derive(Clone, Debug)]
pub struct Turning {
    /// w and the parameter, the exponents without those that are 0 for every such motion.
    pub branch: Branch,
    /// delta at its points.
    pub rates: Vec<f64>,
    /// Where motions change, in w and the parameter; Hopf points are not proved.
    pub changes: Vec<Located>,
}

/// Motions with so small a part of the largest amplitude of a branch are not told from rest.
const NEAR_REST: f64 = 2e-3;
/// An amplitude that is zero, in parts of the reach.
const SMALL: f64 = 1e-6;

type Complexes = [Polynomial; 2];

/// |w_j|^2.
fn square(w: &[f64], j: usize) -> f64 {
    w[2 * j].powi(2) + w[2 * j + 1].powi(2)
}

/// |w_j|^2 as a polynomial in Re w_1, Im w_1, ...
fn square_of(j: usize) -> Polynomial {
    let [x, y] = [2 * j, 2 * j + 1].map(Polynomial::variable);
    (&x * &x) + &(&y * &y)
}

impl FreePhase {
    /// w' = G.
    fn flow(&self) -> Flow {
        let names: Vec<&str> = self.parameters.iter().map(String::as_str).collect();
        Flow::of_complex(&self.equations, &names)
    }

    /// n_1, n_2.
    fn phases(&self) -> [f64; 2] {
        let ratio = Rational::from(&self.weights[1] / &self.weights[0]);
        [ratio.denom().to_f64(), ratio.numer().to_f64()]
    }

    /// Whether two points lie on one motion, within a distance.
    #[must_use]
    pub fn same(&self, a: &[f64], b: &[f64], within: f64) -> bool {
        let [first, second] = [a, b].map(|w| [square(w, 0).sqrt(), square(w, 1).sqrt()]);
        let [n, m] = self.phases();
        let turn = |w: &[f64]| n * w[3].atan2(w[2]) - m * w[1].atan2(w[0]);
        let off = (turn(a) - turn(b)) / (2.0 * PI);
        let apart = 2.0 * PI * (off - off.round()).abs() * first[0].min(first[1]);
        apart < within && first.iter().zip(second).all(|(a, b)| (a - b).abs() < within)
    }

    /// The three equations with w_c = scales\[0\] s and y = scales\[1\] eta, in Re eta, Im eta and s; nothing where G has a
    /// constant part.
    #[must_use]
    pub fn reduced(&self, c: usize, scales: &[Rational; 2]) -> Option<Flow> {
        let of_gauge = self.divided(c, c, scales)?;
        let [mut re, mut im] = self.divided(1 - c, c, scales)?;
        let times_y =
            |p: &Polynomial, q: &Rational| p * &Polynomial::constant(q * scales[1].clone());
        let ratio = Rational::from(&self.weights[1 - c] / &self.weights[c]);
        let [eta_re, eta_im] = [0, 1].map(Polynomial::variable);
        let energy = self.energy.as_ref().map(|all| all.each_ref().map(|e| e.after(3)));
        let scale = energy.as_ref().map_or(whole(1), |e| e[c].clone());
        let turn = times_y(&(&scale * &of_gauge[1]), &ratio);
        let minus = whole(-1);
        re = (&scale * &re) + &(&turn * &eta_im);
        im = (&scale * &im) + &(&minus * &(&turn * &eta_re));
        let (Some(energy), Some(measure)) = (&energy, &self.measure()) else {
            return Some(Flow::of_rows(vec![of_gauge[0].clone(), re, im], self.parameters.clone()));
        };
        let growth = times_y(&(&energy[1 - c] * &of_gauge[0]), &Rational::from(-1));
        re = re + &(&growth * &eta_re);
        im = im + &(&growth * &eta_im);
        let s = Polynomial::variable(2);
        let other = (&eta_re * &eta_re) + &(&eta_im * &eta_im);
        let other = &other * &Polynomial::constant(scales[1].clone().square());
        let squares = [whole(1), other];
        let squares =
            squares.map(|y| &y * &(&(&s * &s) * &Polynomial::constant(scales[0].clone().square())));
        let size = self.size(measure, 3, [&squares[c], &squares[1 - c]]);
        Some(Flow::of_rows(vec![re, im, size], self.parameters.clone()))
    }

    /// E_1 and E_2 by which A is measured: 1 where they are of no one sign.
    fn measure(&self) -> Option<[Polynomial; 2]> {
        let one = || whole(1);
        let energy = self.energy.as_ref()?;
        Some(if self.definite { energy.clone() } else { [one(), one()] })
    }

    /// E_1 |w_1|^2 + E_2 |w_2|^2 - E_1 A^2/4, the parameters being the variables from `first` on.
    fn size(
        &self,
        energy: &[Polynomial; 2],
        first: usize,
        squares: [&Polynomial; 2],
    ) -> Polynomial {
        let [one, two] = energy.each_ref().map(|e| e.after(first));
        let amplitude = Polynomial::variable(first + self.parameters.len() - 1);
        let own = &(&amplitude * &amplitude) * &Polynomial::constant(Rational::from((-1, 4)));
        (&one * squares[0]) + &(&two * squares[1]) + &(&one * &own)
    }

    /// A of a motion of a family.
    #[must_use]
    pub fn amplitude(&self, values: &[Option<Value>], w: &[f64]) -> Option<f64> {
        let rows = System::new(&self.measure()?, values).values(&[] as &[f64]);
        let square = square(w, 0) + rows[1] / rows[0] * square(w, 1);
        Some(2.0 * square.sqrt())
    }

    /// Some R with |w_j| <= R at all motions: of families from A, else from the terms of highest degree of Re(conj(w_j) G_j) and
    /// d_2 |w_2|^2 Im(conj(w_1) G_1) - d_1 |w_1|^2 Im(conj(w_2) G_2), which vanish there. Nothing where they have common zeros.
    #[must_use]
    pub fn bound(&self, values: &[Option<Value>]) -> Option<f64> {
        if let Some(measure) = &self.measure() {
            let rows = System::new(measure, values).values(&[] as &[f64]);
            let amplitude = values.last()?.as_ref()?.interval().above();
            let most = (rows[0] / rows[1]).sqrt().max(1.0) * amplitude / 2.0;
            return (most.is_finite() && most > 0.0).then_some(most * (1.0 + 1e-9));
        }
        let rows = self.flow().rows;
        let variables: [Polynomial; 4] = std::array::from_fn(Polynomial::variable);
        let minus = whole(-1);
        let product = |j: usize| {
            let (x, y) = (&variables[2 * j], &variables[2 * j + 1]);
            times(&[x.clone(), &minus * y], &[rows[2 * j].clone(), rows[2 * j + 1].clone()])
        };
        let square = |j: usize| &square_of(j) * &Polynomial::constant(self.weights[j].clone());
        let ([first, turn], [second, other]) = (product(0), product(1));
        let turns = (&turn * &square(1)) + &(&minus * &(&other * &square(0)));
        // The phase that is free makes w_2 real.
        let still = Some(Value::Rational(Rational::new()));
        let given: Vec<_> =
            [None, None, None, still].into_iter().chain(values.iter().cloned()).collect();
        bound(&System::new(&[first, second, turns], &given))
    }

    /// G_j/a.
    fn divided(&self, j: usize, c: usize, scales: &[Rational; 2]) -> Option<Complexes> {
        let mut sum = Complexes::default();
        for term in &self.equations[j] {
            let degree: u32 = term.amplitudes.iter().sum();
            let mut exponents = vec![0, 0, degree.checked_sub(1)?];
            exponents.extend(&term.parameters);
            let others = &term.amplitudes[2 * (1 - c)..2 * (1 - c) + 2];
            let size = Rational::from((&scales[0]).pow(degree - 1))
                * Rational::from((&scales[1]).pow(others[0] + others[1]));
            let part = |q: &Rational| {
                let mut part = Polynomial::default();
                part.add_term(&exponents, &size);
                &part * &Polynomial::within(q.clone(), term.radius)
            };
            let mut product = [part(&term.re), part(&term.im)];
            for (sign, n) in [1, -1].into_iter().zip(others) {
                let eta = [Polynomial::variable(0), &Polynomial::variable(1) * &whole(sign)];
                product = (0..*n).fold(product, |product, _| times(&product, &eta));
            }
            sum = [0, 1].map(|k| std::mem::take(&mut sum[k]) + &product[k]);
        }
        Some(sum)
    }

    /// delta of a motion w, and the exponents of the deviations from it but those that are 0 for all: one along the free
    /// phase, and of families one along them; there the others are a pair, its square half the trace of the square.
    /// `system` is G in w and a parameter that has no value, if there is one.
    #[must_use]
    pub fn drift(&self, system: &System, w: &[f64]) -> (f64, Vec<Complex<f64>>) {
        let (values, slopes) = system.derivatives(w);
        let weights = self.weights.each_ref().map(Rational::to_f64);
        let c = usize::from(square(w, 1) > square(w, 0));
        let [x, y, p, q] = [w[2 * c], w[2 * c + 1], values[2 * c], values[2 * c + 1]];
        let delta = (x * q - y * p) / square(w, c) / weights[c];
        let growth = (x * p + y * q) / square(w, c);
        let rows = slopes.chunks_exact(system.variables()).flat_map(|row| &row[..4]);
        let mut slopes: Vec<f64> = rows.copied().collect();
        for (j, d) in weights.iter().enumerate() {
            slopes[8 * j + 2 * j + 1] += delta * d;
            slopes[8 * j + 4 + 2 * j] -= delta * d;
        }
        if self.energy.is_some() {
            // Of the size of the terms left out, as it is whichever energy it goes by.
            (0..4).for_each(|k| slopes[5 * k] -= growth);
            let entry = |i: usize, j: usize| slopes[4 * i + j] * slopes[4 * j + i];
            let trace: f64 = (0..16).map(|k| entry(k / 4, k % 4)).sum();
            let root = Complex::new(0.5 * trace, 0.0).sqrt();
            let other = if trace < 0.0 { root.conj() } else { Complex::new(-root.re, 0.0) };
            return (delta, vec![root, other]);
        }
        let mut exponents = eigenvalues(4, &slopes);
        let size = |k: &usize| exponents[*k].norm();
        if let Some(k) = (0..exponents.len()).min_by(|a, b| size(a).total_cmp(&size(b))) {
            exponents.remove(k);
        }
        (delta, exponents)
    }

    /// G_j - (i d_j delta + beta E_j) w_j, Im w_c, and of families the condition of the energy, in w, delta (and beta): all of them
    /// vanish at motions, isolated where w_c is not zero.
    fn unfolded(&self, c: usize) -> Flow {
        let extra = 1 + usize::from(self.energy.is_some());
        let equation = |j: usize| -> Vec<ComplexTerm> {
            let shifted = |term: &ComplexTerm| ComplexTerm {
                parameters: vec![0; extra].into_iter().chain(term.parameters.clone()).collect(),
                ..term.clone()
            };
            let mut amplitudes = vec![0; 4];
            amplitudes[2 * j] = 1;
            let turn = ComplexTerm {
                amplitudes: amplitudes.clone(),
                parameters: vec![1],
                re: Rational::new(),
                im: Rational::from(-&self.weights[j]),
                radius: 0.0,
            };
            let energy = self.energy.iter().flat_map(|energy| &energy[j].terms);
            let growth = energy.map(|(exponents, c)| ComplexTerm {
                amplitudes: amplitudes.clone(),
                parameters: [0, 1].into_iter().chain(exponents.iter().copied()).collect(),
                re: Rational::from(-&c.middle),
                im: Rational::new(),
                radius: c.radius,
            });
            self.equations[j].iter().map(shifted).chain([turn]).chain(growth).collect()
        };
        let names: Vec<&str> = [""; 2][..extra]
            .iter()
            .copied()
            .chain(self.parameters.iter().map(String::as_str))
            .collect();
        let mut rows = Flow::of_complex(&[equation(0), equation(1)], &names).rows;
        rows.push(Polynomial::variable(2 * c + 1));
        let squares = [0, 1].map(square_of);
        let size = self.measure().map(|e| self.size(&e, 4 + extra, squares.each_ref()));
        rows.extend(size);
        Flow::of_rows(rows, self.parameters.clone())
    }

    /// Rest over the parameter, and the values at which exponents of it cross the imaginary axis, by bisection: motions are born
    /// of rest there. Two crossings within a 400th of the range that undo each other are not seen.
    #[must_use]
    pub fn rest(&self, values: &[Option<Value>], course: &Course) -> Turning {
        const CELLS: u32 = 400;
        let flow = self.flow().system(values);
        let [low, high] = course.range;
        let slopes = |s: f64| -> Vec<f64> {
            let (_, slopes) = flow.derivatives(&[0.0, 0.0, 0.0, 0.0, s]);
            slopes.chunks_exact(5).flat_map(|row| &row[..4]).copied().collect()
        };
        // The exponents with the largest real part first, and the size of the matrix.
        let growths = |s: f64| {
            let rows = slopes(s);
            let mut exponents = eigenvalues(4, &rows);
            exponents.sort_by(|a, b| b.re.total_cmp(&a.re));
            (exponents, rows.iter().fold(0.0f64, |m, x| m.max(x.abs())))
        };
        let points: Vec<Point> = (0..=CELLS)
            .map(|k| low + (high - low) * f64::from(k) / f64::from(CELLS))
            .map(|s| {
                let at = vec![0.0, 0.0, 0.0, 0.0, s];
                Point { at, exponents: eigenvalues(4, &slopes(s)), change: None }
            })
            .collect();
        // How many grow, but for rounding.
        let growing = |(exponents, size): &(Vec<Complex<f64>>, f64)| {
            exponents.iter().filter(|x| x.re > 1e-11 * size).count()
        };
        // The error of an exponent by rounding, which is that of a square root where two of them meet.
        let unsure = |(exponents, size): &(Vec<Complex<f64>>, f64), k: usize| {
            let others = (0..exponents.len()).filter(|j| *j != k);
            let gap = others.map(|j| (exponents[j] - exponents[k]).norm()).fold(*size, f64::min);
            1e-14 * size * size / gap.max(1e-7 * size)
        };
        // Where an exponent is zero within its error at both ends, it moves by rounding alone.
        let moves = |cell: &[f64; 2]| {
            let ends = cell.map(growths);
            let [from, to] = ends.each_ref().map(growing);
            from != to
                && ends.iter().any(|end| {
                    let k = from.min(to);
                    end.0.get(k).is_some_and(|x| x.re.abs() > unsure(end, k))
                })
        };
        let mut changes = Vec::new();
        let mut cells: Vec<_> = points.windows(2).map(|two| [two[0].at[4], two[1].at[4]]).collect();
        cells.retain(moves);
        while let Some([a, b]) = cells.pop() {
            let ends = [a, b].map(growths);
            let [from, to] = ends.each_ref().map(growing);
            if from == to {
                continue;
            }
            let [Some(x), Some(y)] = ends.map(|(all, _)| Some(all.get(from.min(to))?.re)) else {
                continue;
            };
            let (middle, width) = (0.5 * (a + b), b - a);
            // A real part that passes zero does so on a line; one that comes from a double exponent, like a root.
            let line = width < 1e-7 * (high - low) && x * y < 0.0;
            let at = if line { a - x * width / (y - x) } else { middle };
            if line || width < 1e-14 * (high - low) || [a, b].contains(&middle) {
                let at = vec![0.0, 0.0, 0.0, 0.0, at];
                changes.push(Located { change: Change::Hopf, branch: 0, at, proved: None });
            } else {
                cells.extend([[a, middle], [middle, b]]);
            }
        }
        // Of one that is met at the end of two cells both find it, within rounding.
        let place = |it: &Located| it.at[4];
        changes.sort_by(|a, b| place(a).total_cmp(&place(b)));
        changes.dedup_by(|next, it| {
            let same = place(next) - place(it) < 1e-7 * (high - low);
            if same {
                it.at[4] = 0.5 * (place(it) + place(next));
            }
            same
        });
        let rates = vec![0.0; points.len()];
        Turning { branch: Branch { points, closed: false, complete: true }, rates, changes }
    }

    /// The branches over the parameter without a value, [`Course::parameter`] counted among the parameters, that pass motions
    /// at values of it.
    #[must_use]
    pub fn branches(
        &self,
        values: &[Option<Value>],
        found: &[(Value, Vec<Vec<f64>>)],
        course: &Course,
    ) -> Vec<Turning> {
        let flow = self.flow().system(values);
        let mut raw: Vec<(Flow, Branch)> = Vec::new();
        for (value, motions) in found {
            let at = value.interval().middle();
            let mut fixed = values.to_vec();
            fixed[course.parameter] = Some(value.clone());
            for motion in motions {
                let known = |(own, branch): &(Flow, Branch)| {
                    let (system, n) = (own.system(&fixed), own.unknowns());
                    let is_here = |guess: Vec<f64>| {
                        let found = newton(&system, &guess);
                        found.is_some_and(|it| self.same(&it[..4], motion, 1e-7 * course.reach))
                    };
                    // An end of the range is met within rounding.
                    let wide = course.range[1] - course.range[0];
                    let at_end = |point: &&Point| (point.at[n] - at).abs() < 1e-9 * wide;
                    let ends = [branch.points.first(), branch.points.last()];
                    let mut ends = ends.into_iter().flatten().filter(at_end);
                    let mut pairs = branch.points.windows(2);
                    ends.any(|end| is_here(end.at[..n].to_vec()))
                        || pairs
                            .any(|two| crossing(&two[0].at, &two[1].at, at).is_some_and(is_here))
                };
                if raw.iter().any(known) || course.stop.asked() {
                    continue;
                }
                let point: Vec<f64> = motion.iter().copied().chain([at]).collect();
                raw.extend(self.branch(&flow, values, &point, course));
            }
        }
        let reach = course.reach;
        let all = raw.into_iter().enumerate();
        all.map(|(k, (own, branch))| self.turning(&flow, (&own, values), k, branch, reach))
            .collect()
    }

    /// The branch through a motion in w, delta (and beta), with the equations it was followed by: that of the w_c that stays away
    /// from zero along it.
    fn branch(
        &self,
        flow: &System,
        values: &[Option<Value>],
        point: &[f64],
        course: &Course,
    ) -> Option<(Flow, Branch)> {
        let moduli = [0, 1].map(|j| square(point, j).sqrt());
        let first = usize::from(moduli[1] > moduli[0]);
        let mut best: Option<(f64, (Flow, Branch))> = None;
        for c in [first, 1 - first].into_iter().filter(|c| moduli[*c] > SMALL * course.reach) {
            let own = self.unfolded(c);
            let n = own.unknowns();
            let angle = -point[2 * c + 1].atan2(point[2 * c]) / self.weights[c].to_f64();
            let turned = |j: usize| {
                let (sin, cos) = (angle * self.weights[j].to_f64()).sin_cos();
                [
                    point[2 * j] * cos - point[2 * j + 1] * sin,
                    point[2 * j] * sin + point[2 * j + 1] * cos,
                ]
            };
            let mut start = [turned(0), turned(1)].concat();
            start.push(self.drift(flow, point).0);
            start.resize(n, 0.0);
            start.push(point[4]);
            let unknowns = if self.energy.is_some() { 0 } else { 4 };
            let course = Course { parameter: n, unknowns, ..course.clone() };
            let Some(branch) = follow(&own.system(values), &start, &course) else { continue };
            let branch = beside_rest(branch, &start);
            let size = |point: &Point| point.at[2 * c].abs();
            let least = branch.points.iter().map(size).fold(f64::INFINITY, f64::min);
            if best.as_ref().is_none_or(|(other, _)| least > *other) {
                best = Some((least, (own, branch)));
            }
            if least > 0.05 * course.reach {
                break;
            }
        }
        best.map(|(_, found)| found)
    }

    /// Whether all E_j w_j vanish at a point of a branch: no condition is left that beta = 0.
    fn is_level(&self, own: &Flow, values: &[Option<Value>], at: &[f64]) -> bool {
        let Some(energy) = &self.energy else { return false };
        let open = at[own.unknowns()..].iter().map(|s| Rational::from_f64(*s).map(Value::Rational));
        let mut open = open;
        let given: Vec<_> =
            values.iter().map(|value| value.clone().or_else(|| open.next().flatten())).collect();
        let rows = System::new(energy, &given).values(&[] as &[f64]);
        let slope: f64 = (0..2).map(|j| rows[j].powi(2) * square(at, j)).sum();
        let most =
            rows.iter().fold(0.0f64, |m, e| m.max(e.powi(2))) * (square(at, 0) + square(at, 1));
        slope <= SMALL.powi(2) * most
    }

    /// A branch in w alone.
    fn turning(
        &self,
        flow: &System,
        (own, values): (&Flow, &[Option<Value>]),
        index: usize,
        mut branch: Branch,
        reach: f64,
    ) -> Turning {
        let (mut rates, mut changes) = (Vec::new(), Vec::new());
        for point in &mut branch.points {
            let unfolded = point.clone();
            shorten(&mut point.at, own.unknowns());
            let (delta, exponents) = self.drift(flow, &point.at);
            point.exponents = exponents;
            rates.push(delta);
            // The exponent 0 along the phase makes the sum with another vanish at folds.
            point.change = point.change.filter(|it| *it != Change::Hopf || oscillates(point));
            let Some(change) = point.change else { continue };
            let found = match change {
                Change::Hopf => Located { change, branch: index, at: unfolded.at, proved: None },
                _ => located(own, values, reach, (index, &unfolded, change)),
            };
            // Noise beside a degenerate motion is no crossing; nor is one where the energy has no slope, so that beta is free.
            let is_crossing = found.change == Change::Crossing;
            if is_crossing && (found.proved.is_none() || self.is_level(own, values, &found.at)) {
                continue;
            }
            let mut found = found;
            shorten(&mut found.at, own.unknowns());
            let shortened = |mut zero: Zero| {
                shorten(&mut zero.enclosure, own.unknowns());
                shorten(&mut zero.unique_within, own.unknowns());
                zero
            };
            found.proved = found.proved.map(shortened);
            changes.push(found);
        }
        Turning { branch, rates, changes }
    }
}

/// A branch followed through rest goes on as the same motions, -w in the place of w, so that rest looks like a fold; and at rest
/// every delta solves the equations, so that the curve is lost. The part of it, from rest to rest, that has a point.
fn beside_rest(branch: Branch, start: &[f64]) -> Branch {
    let size = |point: &Point| point.at[..4].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let most = branch.points.iter().map(size).fold(0.0, f64::max);
    let is_rest = |point: &Point| size(point) < NEAR_REST * most;
    let cut = |a: &Point, b: &Point| is_rest(a) || is_rest(b);
    let Branch { mut points, mut closed, complete } = branch;
    let mut cuts = points.windows(2);
    if let Some(first) = cuts.position(|two| cut(&two[0], &two[1])).filter(|_| closed) {
        points.pop();
        points.rotate_left(first + 1);
        closed = false;
    }
    let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
    for mut point in points {
        let part =
            parts.last_mut().filter(|part| part.last().is_none_or(|last| !cut(last, &point)));
        match part {
            Some(part) => part.push(point),
            None => {
                // The turn of the parameter at rest is no fold.
                point.change = None;
                parts
                    .last_mut()
                    .and_then(|part| part.last_mut())
                    .into_iter()
                    .for_each(|it| it.change = None);
                parts.push(vec![point]);
            }
        }
    }
    let away =
        |point: &Point| point.at.iter().zip(start).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    let nearest = |part: &Vec<Point>| part.iter().map(away).fold(f64::INFINITY, f64::min);
    let points = parts.into_iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
    Branch { points: points.unwrap_or_default(), closed, complete }
}

/// w and the parameter, of w, delta (beta), the parameter.
fn shorten<T>(all: &mut Vec<T>, unknowns: usize) {
    all.drain(4..unknowns);
    all.truncate(5);
}

/// Whether exponents lie on the imaginary axis, not at 0.
fn oscillates(point: &Point) -> bool {
    let size = point.exponents.iter().fold(0.0f64, |m, x| m.max(x.norm()));
    point.exponents.iter().any(|x| x.re.abs() < 1e-6 * size && x.im.abs() > 1e-6 * size)
}
