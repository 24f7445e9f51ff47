//! From the equations of a problem to what is averaged: values put in, modes, the phase of the forces.

use super::algebraic::AlgebraicModes;
use super::conserved::axes;
use super::forces::{Phase, around, combination, harmonic, is_internal, is_wave, near, sum};
use super::modes::{Matrix, inverted, spectrum};
use super::prepared::Prepared;
use super::separated::{energy, separated};
use super::unit::Unit;
use super::{Names, ResonanceError};
use crate::error::DerivationError as Error;
use lindstedt_equation::{Expression, Function};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// What is averaged: x_j'' + nu_j^2 x_j + ... = 0 with forces cos(m eta_l), eta_l = Omega_l t + the detuning; frequencies
/// in multiples of the unit.
#[derive(Clone, Debug)]
pub struct System {
    /// The left sides, x_j'' alone; where there are shapes, of the modes.
    pub equations: Vec<Expression>,
    /// What frequencies and the rates of forces are multiples of; nothing where that is 1.
    pub unit: Option<Box<Unit>>,
    /// nu_j; of an irrational one a rational number beside it: within 2^-200, in a flow within its radius
    /// ([`Enclosed`](super::Enclosed)).
    pub frequencies: Vec<Rational>,
    /// nu_j^2.
    pub squares: Vec<Rational>,
    /// The phases of the forces.
    pub forces: Vec<Phase>,
    /// Parameters without a value that the rates of the forces depend on: taken to be independent of one another
    /// and of all numbers, so that no sum of them is a resonance unless it is one identically.
    pub independent: Vec<String>,
    /// Names without a value, in the order of printing.
    pub symbols: Vec<String>,
    /// P of x = P q, where the unknowns are no modes.
    pub shapes: Option<Matrix>,
    /// Where squares or shapes are irrational: what their numbers here are beside.
    pub algebraic: Option<AlgebraicModes>,
    /// The symbols that are cosines and sines of constant angles, with the angle and whether it is the sine: what forces
    /// are ahead of their phase, and what delays turn phases by.
    pub angles: BTreeMap<String, (Expression, bool)>,
    /// The values that were put in.
    pub bound: BTreeMap<String, Rational>,
    /// The frequency that was given where it lies beside a resonance, and the name of its detuning.
    pub beside: Option<Beside>,
}

/// From which rate the only force is detuned.
#[derive(Clone, Copy, Debug)]
pub enum Detuned<'a> {
    /// From that of a resonance that it lies beside, if there is one.
    Beside,
    /// From none, however small the small parameter becomes: sigma = (omega - Omega)/eps grows without bound then, and no
    /// order of the detuned flow is small beside the one before.
    Not,
    /// From this one, in multiples of the unit: one of [`System::resonances_around`].
    From(&'a Rational),
}

/// A frequency beside a resonance: rate = Omega + eps * symbol.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The rate of the force's phase as it was given.
    pub rate: Rational,
    /// The symbol (rate - Omega)/eps.
    pub symbol: String,
}

impl System {
    /// What is averaged, with a force detuned by a symbol as it is asked for.
    pub(super) fn of(
        equations: &[Expression],
        given: &BTreeMap<String, Exact>,
        cards: &dyn Fn(&str) -> Option<Exact>,
        names: Names<'_>,
        detuned: Detuned<'_>,
    ) -> Result<Self, Error> {
        let prepared = Prepared::of(equations, given, cards, names)?;
        let (mass, stiffness) = (&prepared.mass, &prepared.stiffness);
        let irrational = || ResonanceError::NoRationalForm;
        let unit = prepared.unit;
        // Without a number nothing is enclosed.
        let symbol = unit.clone().filter(|unit| unit.square.is_none());
        let enclosed = || symbol.as_ref().map_or(Ok(()), |unit| Err(unit.unset()));
        let (mut modes, mut algebraic) = match spectrum(mass, stiffness) {
            Err(ResonanceError::NoRationalForm) => {
                enclosed()?;
                let found = AlgebraicModes::of(mass, stiffness)?;
                (found.spectrum().ok_or_else(irrational)?, Some(found))
            }
            other => (other?, None),
        };
        unit.iter().for_each(|unit| unit.scaled(&mut modes.squares));
        let frequencies = modes.frequencies_nearby().map_err(|error| match (error, &symbol) {
            (ResonanceError::NoOscillation { square }, Some(unit)) => {
                ResonanceError::NoOscillation { square: format!("{square}*{}^2", unit.name) }
            }
            (other, _) => other,
        })?;
        let squares = modes.squares.clone();
        let of = |modes: &_| separated(&prepared.equations, modes, algebraic.as_ref(), names);
        let mut equations = of(&modes)?;
        // Of equal frequencies the modes are whichever have the energy in the squares of their velocities.
        let equal = squares.iter().enumerate().any(|(j, square)| squares[..j].contains(square));
        if equal
            && prepared.forces.is_empty()
            && let Some(axes) = axes(&equations)
            && let Some(other) = modes.with_axes(&axes)
        {
            modes = other;
            equations = of(&modes)?;
        }
        if let Some(known) = &mut algebraic
            && prepared.forces.is_empty()
        {
            known.energy = energy(&prepared.equations, &modes, known, names)?;
        }
        if let Some(unit) = &unit {
            let own = equations.into_iter().zip(&squares).enumerate();
            equations = own.map(|(j, (e, square))| unit.with_squares(e, j, square)).collect();
        }
        let detunings = prepared.forces.iter().flat_map(|phase| &phase.detuning);
        let mut symbols = symbols(equations.iter().chain(detunings), names);
        let is_unit = |name: &String| unit.as_ref().is_some_and(|unit| unit.name == *name);
        symbols.retain(|name| !prepared.independent.contains(name) && !is_unit(name));
        let system = Self {
            equations,
            unit: unit.map(Box::new),
            frequencies,
            squares,
            forces: prepared.forces,
            independent: prepared.independent,
            angles: prepared.angles,
            symbols,
            shapes: modes.shapes,
            algebraic,
            bound: prepared.bound,
            beside: None,
        };
        if !system.is_exact() {
            enclosed()?;
        }
        if let Some(first) = system.independent.first().filter(|_| !system.is_exact()) {
            // Nothing says that they are independent of square roots.
            let (first, second) = (first.clone(), "irrational frequencies".to_owned());
            return Err(ResonanceError::NoRatio { first, second }.into());
        }
        let rate = system.force();
        let at = match detuned {
            Detuned::From(at) => Some(at.clone()).filter(|at| *at != rate),
            Detuned::Beside if rate > 0 => near(&rate, &system.frequencies),
            _ => None,
        };
        Ok(match at {
            Some(at) => system.detuned_from(at),
            None => system,
        })
    }

    /// Whether all frequencies are rational multiples of the unit.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let square = |nu: &Rational| nu.clone().square();
        self.algebraic.is_none()
            && self.frequencies.iter().zip(&self.squares).all(|(nu, known)| square(nu) == *known)
    }

    /// nu_j^2 in numbers, not in multiples of a root.
    pub(super) fn plain_squares(&self) -> Vec<Rational> {
        self.unit.as_ref().map_or_else(|| self.squares.clone(), |unit| unit.plain(&self.squares))
    }

    /// The first frequency without a value that coefficients are divided by.
    #[must_use]
    pub fn open_frequency(&self) -> Option<&String> {
        let unit = self.unit.as_ref().filter(|unit| unit.square.is_none());
        unit.map(|unit| &unit.name).or(self.independent.first())
    }

    /// The value of the unit; nothing where it is a symbol without one.
    #[must_use]
    pub fn unit_value(&self, values: &dyn Fn(&str) -> Option<Exact>, balls: Balls) -> Option<Ball> {
        self.unit.as_ref().map_or_else(|| Some(balls.one()), |unit| unit.value(values, balls))
    }

    /// The rates of the only force at resonances that this one is around, a half of them away at most, those of the
    /// lowest order first, then the nearest; none where it is at one.
    #[must_use]
    pub fn resonances_around(&self) -> Vec<Rational> {
        let rate = self.beside.as_ref().map_or_else(|| self.force(), |beside| beside.rate.clone());
        if rate > 0 { around(&rate, &self.frequencies) } else { Vec::new() }
    }

    /// Omega of the only force, where it is a multiple of the unit; else 0.
    #[must_use]
    pub fn force(&self) -> Rational {
        match &self.forces[..] {
            [only] => only.number().unwrap_or_default(),
            _ => Rational::new(),
        }
    }

    /// P^-1 of q = P^-1 x, where the unknowns are no modes.
    #[must_use]
    pub fn modes(&self) -> Option<Matrix> {
        self.shapes.as_ref().and_then(inverted)
    }

    /// The equations with cos m eta_l and sin m eta_l as parameters of the names `of` gives.
    pub(super) fn with_waves(
        &self,
        of: &dyn Fn(Function, usize, i32) -> String,
    ) -> Vec<Expression> {
        let named = |e: &Expression| {
            let (function, l, m) = harmonic(e).filter(|_| is_wave(e))?;
            Some(Expression::parameter(&of(function, l, m)))
        };
        self.equations.iter().map(|e| e.map(&named)).collect()
    }

    /// cos(m eta_l) or sin(m eta_l) with the angle of the phase in the time.
    pub(super) fn written(&self, (l, m, sine): (usize, i32, bool)) -> Option<Expression> {
        let phase = self.forces.get(l)?;
        let unit = self.unit.as_ref().map_or_else(|| 1.into(), |unit| unit.expression());
        let others = self.independent.iter().map(|name| Expression::parameter(name));
        let rates = phase.rate.iter().zip(std::iter::once(unit).chain(others));
        let rates = rates.map(|(q, factor)| Expression::Number(q.clone()) * factor);
        let detuned =
            (1i64..).zip(&phase.detuning).map(|(n, e)| Expression::Small.pow(n) * e.clone());
        let rate = Expression::Sum(rates.chain(detuned).collect());
        let angle = i64::from(m) * (rate * Expression::Time + phase.start.clone());
        let function = if sine { Function::Sin } else { Function::Cos };
        Some(angle.canonical().apply(function))
    }

    /// Puts the rates that are sums of irrational frequencies beside these as they are now.
    pub(super) fn settle_rates(&mut self) {
        for phase in self.forces.iter_mut().filter(|phase| !phase.of_modes.is_empty()) {
            phase.rate[0] = sum(&phase.of_modes, &self.frequencies);
        }
    }

    /// With the symbol of the detuning of the only force from a rate.
    fn detuned_from(mut self, at: Rational) -> Self {
        let (rate, exact) = (self.force(), self.is_exact());
        let [phase] = &mut self.forces[..] else { return self };
        let free = |name: &&str| !self.symbols.iter().any(|known| known == name);
        let symbol = ["sigma", "detuning", "sigma_0"].into_iter().find(free).unwrap_or("sigma_1");
        self.symbols.push(symbol.to_owned());
        if phase.detuning.is_empty() {
            phase.detuning.push(0.into());
        }
        phase.detuning[0] = (phase.detuning[0].clone() + Expression::parameter(symbol)).canonical();
        phase.rate[0] = at;
        if !exact {
            phase.of_modes = combination(&phase.rate[0], &self.frequencies).unwrap_or_default();
        }
        self.settle_rates();
        self.beside = Some(Beside { rate, symbol: symbol.to_owned() });
        self
    }
}

/// The names that occur, in the order of the data card, which is that of printing.
pub(super) fn symbols<'a>(
    equations: impl Iterator<Item = &'a Expression>,
    names: Names<'_>,
) -> Vec<String> {
    let used = equations.flat_map(Expression::parameters).filter(|name| !is_internal(name));
    let used: BTreeSet<String> = used.collect();
    let cards = names.0.parameters.iter().map(|card| card.name.to_string());
    let mut symbols: Vec<String> = cards.filter(|name| used.contains(name)).collect();
    let unlisted: Vec<_> = used.into_iter().filter(|name| !symbols.contains(name)).collect();
    symbols.extend(unlisted);
    symbols
}

/// Refuses a delay where one is not taken.
pub(super) fn refuse_delays(
    equations: &[Expression],
    names: Names<'_>,
) -> Result<(), ResonanceError> {
    let late = |e: &&Expression| matches!(e, Expression::Unknown(x) if x.delay.is_some());
    match equations.iter().flat_map(Expression::nodes).find(late) {
        None => Ok(()),
        Some(e) => Err(ResonanceError::Delay { term: names.shown(e) }),
    }
}
