//! One unknown off resonance, delays, and numbers as constants.

use super::{AmplitudeElement, Amplitudes, Rates, Scalars};
#[cfg(doc)]
use lindstedt_algebra::NEAR_MISS;
use lindstedt_algebra::Ring;

/// A delay T with what the phases do meanwhile.
#[derive(Clone, Debug)]
pub struct Delay<N> {
    /// T.
    pub time: N,
    /// cos(rate T), sin(rate T) at order zero for psi_1, ..., psi_M (z_j = |z_j| e^{i psi_j}), eta_1, ..., eta_L.
    pub turns: Vec<[N; 2]>,
}

/// A delay as constants of the algebra.
#[derive(Clone, Debug)]
pub struct Late<E> {
    /// T.
    pub time: AmplitudeElement<E>,
    /// e^{-i rate T} of the amplitudes and of the forces.
    pub turns: Vec<AmplitudeElement<E>>,
}

impl<S: Scalars> Amplitudes<S> {
    /// The algebra of one unknown and one force (or none) whose frequencies are numbers or formulas of which no
    /// combination but the frequency itself is taken to meet it. A monomial that does is refused with its harmonic, also
    /// one that misses by [`NEAR_MISS`].
    ///
    /// ```
    /// use lindstedt_algebra::{AmplitudeAlgebra, Ring};
    /// use lindstedt_phase::amplitudes::{Amplitudes, scalars::Integers};
    /// let algebra = Amplitudes::off_resonance(Integers, &1.into(), None).ok_or("exponents")?;
    /// let z = algebra.amplitude(0);
    /// // d/dt (z zbar) = 0.
    /// assert!(algebra.is_zero(&algebra.by_time(&algebra.mul(&z, &algebra.conjugate(&z)))));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn off_resonance(
        scalars: S,
        frequency: &S::Number,
        force: Option<&S::Number>,
    ) -> Option<Self> {
        let rates = [Some(frequency), force].into_iter().flatten();
        let rates = Rates::single(rates.map(|rate| scalars.numerator(rate)).collect());
        let algebra = Self::of_rates(scalars, rates, &[])?;
        Some(Self { refuses: true, ..algebra })
    }

    /// The algebra of any frequencies, as [`Self::of_rates`], with so many constant phases e^{i theta}.
    pub fn turning(
        scalars: S,
        rates: Rates<S::Element>,
        symbols: &[&str],
        turns: usize,
    ) -> Option<Self> {
        let all: Vec<&str> =
            std::iter::repeat_n("", turns).chain(symbols.iter().copied()).collect();
        let algebra = Self::of_rates(scalars, rates, &all)?;
        let symbols = algebra.symbols[turns..].to_vec();
        Some(Self { turns, symbols, ..algebra })
    }

    /// i^n.
    pub fn quarter_turns(&self, n: i64) -> AmplitudeElement<S::Element> {
        let turn = |f: AmplitudeElement<_>| self.turned(&f);
        (0..n.rem_euclid(4)).fold(self.one(), |f, _| turn(f))
    }

    /// The algebra with delays.
    #[must_use]
    pub fn with_delays(mut self, delays: &[Delay<S::Number>]) -> Self {
        let turn = |[cos, sin]: &[S::Number; 2]| {
            let sin = self.turned(&self.neg(&self.number(sin)));
            self.total(self.number(cos), &sin, false)
        };
        let late = |delay: &Delay<S::Number>| Late {
            time: self.number(&delay.time),
            turns: delay.turns.iter().map(turn).collect(),
        };
        let delays = delays.iter().map(late).collect();
        self.delays = delays;
        self
    }

    /// A number as a constant.
    pub fn number(&self, number: &S::Number) -> AmplitudeElement<S::Element> {
        let (e, denominator) = self.scalars.numerator(number);
        self.single(0, [e, self.scalars.zero()], denominator, true)
    }

    /// The number that f is, if it is a real constant.
    pub fn as_number(&self, f: &AmplitudeElement<S::Element>) -> Option<S::Number> {
        match &f.terms[..] {
            [] => Some(self.scalars.number(&self.scalars.zero(), &f.denominator)),
            [(0, [re, im])] if self.scalars.is_zero(im) => {
                Some(self.scalars.number(re, &f.denominator))
            }
            _ => None,
        }
    }
}
