//! Columns of a chart side by side: the predicted maps of eight points at once.
//!
//! Every operation of one point waits for the one before it; eight points wait together, in the vectors of the
//! processor. In every lane the operations and their order are those of a single double, sine and exponential those of
//! the library, so the numbers are the same bit by bit.

use crate::flow::{Flow, Scratch, free_delay};
use crate::map::ImpactMap;
use crate::parameters::{Parameters, Swept};
use crate::prediction::Ground;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// So many points at a time.
pub(crate) const LANES: usize = 8;

/// Doubles side by side. What is asked about them has the answer that all of them have, else none: NaN, no sign. A formula
/// that chooses its way by [`Real::holds`] and [`Real::sign`] gives up where they part.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Lanes([f64; LANES]);

impl Lanes {
    #[inline(always)]
    pub(crate) fn all(x: &f64) -> Self {
        Self([*x; LANES])
    }
    // Loops, not the functions of the library on arrays: those are calls, outside the vectors.
    #[inline(always)]
    fn zip(mut self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a = f(*a, *b);
        }
        self
    }
    #[inline(always)]
    fn each(mut self, f: impl Fn(f64) -> f64) -> Self {
        for x in &mut self.0 {
            *x = f(*x);
        }
        self
    }
}

macro_rules! operators {
    ($($trait:ident $name:ident;)*) => { $(
        impl $trait<&Lanes> for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $name(self, other: &Lanes) -> Lanes {
                self.zip(other, |a, b| $trait::$name(a, b))
            }
        }
        impl $trait for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $name(self, other: Lanes) -> Lanes {
                $trait::$name(self, &other)
            }
        }
    )* };
}

operators! { Add add; Sub sub; Mul mul; Div div; }

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|x| -x)
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn integer(&self, n: i64) -> Self {
        Self::all(&(n as f64))
    }
    #[inline(always)]
    fn number(&self, x: f64) -> Self {
        Self::all(&x)
    }
    fn pi(&self) -> Self {
        Self::all(&std::f64::consts::PI)
    }
    #[inline(always)]
    fn square(&self) -> Self {
        *self * self
    }
    #[inline(always)]
    fn sqrt(&self) -> Self {
        self.each(f64::sqrt)
    }
    #[inline(always)]
    fn exp(&self) -> Self {
        self.each(f64::exp)
    }
    #[inline(always)]
    fn exp_m1(&self) -> Self {
        self.each(f64::exp_m1)
    }
    #[inline(always)]
    fn sin_cos(&self) -> (Self, Self) {
        let (mut sin, mut cos) = (*self, *self);
        for (sin, cos) in sin.0.iter_mut().zip(&mut cos.0) {
            (*sin, *cos) = sin.sin_cos();
        }
        (sin, cos)
    }
    fn atan2(&self, x: &Self) -> Self {
        (*self).zip(x, f64::atan2)
    }
    #[inline(always)]
    fn sign(&self) -> Option<Ordering> {
        let is = |sign: fn(f64) -> bool| self.holds(sign) == Some(true);
        if is(|x| x > 0.0) {
            Some(Ordering::Greater)
        } else if is(|x| x < 0.0) {
            Some(Ordering::Less)
        } else {
            is(|x| x == 0.0).then_some(Ordering::Equal)
        }
    }
    #[inline(always)]
    fn to_f64(&self) -> f64 {
        let first = self.0[0];
        if self.holds(|x| x == first) == Some(true) { first } else { f64::NAN }
    }
    fn magnitude_above(&self) -> f64 {
        self.0.iter().fold(0.0, |most, x| most.max(x.abs()))
    }
    fn magnitude_below(&self) -> f64 {
        self.0.iter().fold(f64::INFINITY, |least, x| least.min(x.abs()))
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        self.holds(f64::is_finite) == Some(true)
    }
    fn centre(&self) -> Self {
        *self
    }
    fn widened(&self, _error: &Self) -> Self {
        *self
    }
    fn neutral_width(&self) -> f64 {
        0.0.neutral_width()
    }
    fn precision(&self) -> u32 {
        f64::MANTISSA_DIGITS
    }
    #[inline(always)]
    fn holds(&self, property: impl Fn(f64) -> bool) -> Option<bool> {
        let mut number = 0;
        for x in &self.0 {
            number += usize::from(property(*x));
        }
        match number {
            0 => Some(false),
            LANES => Some(true),
            _ => None,
        }
    }
    #[inline(always)]
    fn halved(&self) -> Self {
        self.each(|x| 0.5 * x)
    }
}

/// The columns of one row whose gain grows along it.
pub(crate) struct Columns<'p> {
    gain: Swept,
    order: usize,
    time: Lanes,
    delay: Complex<Lanes>,
    parameters: Parameters<Lanes>,
    ground: Ground<Lanes>,
    single: &'p Ground<f64>,
    arch: pulp::Arch,
}

impl<'p> Columns<'p> {
    pub(crate) fn new(
        gain: Swept,
        order: usize,
        parameters: &Parameters<f64>,
        ground: &'p Ground<f64>,
    ) -> Self {
        let time = parameters.period();
        let delay = free_delay(parameters, &time);
        Self {
            gain,
            order,
            time: Lanes::all(&time),
            delay: Complex::new(Lanes::all(&delay.re), Lanes::all(&delay.im)),
            parameters: parameters.map(Lanes::all),
            ground: ground.convert(Lanes::all),
            single: ground,
            arch: pulp::Arch::new(),
        }
    }
    /// The maps for some values of the gain, of those that have one.
    pub(crate) fn maps(
        &mut self,
        values: [f64; LANES],
        scratch: &mut Scratch<Lanes>,
    ) -> [Option<ImpactMap<f64>>; LANES] {
        *self.parameters.slot(self.gain) = Lanes(values);
        let (flow, map) = self.arch.dispatch(Maps { columns: self, scratch });
        if let Some(ImpactMap { trace: Lanes(trace), determinant: Lanes(determinant) }) = map {
            return std::array::from_fn(|l| {
                Some(ImpactMap { trace: trace[l], determinant: determinant[l] })
            });
        }
        let Some(Flow { growth_rate: Lanes(rate), frequency: Lanes(frequency) }) = flow else {
            return [const { None }; LANES];
        };
        // One of them has none, or another formula than the others.
        std::array::from_fn(|l| {
            let flow = Flow { growth_rate: rate[l], frequency: frequency[l] };
            self.single.map(&flow).ok()
        })
    }
}

/// By the widest vectors that the processor has: the same operations on every number by any.
struct Maps<'a, 'p> {
    columns: &'a Columns<'p>,
    scratch: &'a mut Scratch<Lanes>,
}

impl pulp::NullaryFnOnce for Maps<'_, '_> {
    type Output = (Option<Flow<Lanes>>, Option<ImpactMap<Lanes>>);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Columns { parameters, time, delay, order, ground, .. } = self.columns;
        self.scratch.fill(parameters, time, delay, *order);
        let flow = self.scratch.flow();
        let map = match &flow {
            Some(flow) => ground.map(flow).ok(),
            None => None,
        };
        (flow, map)
    }
}
