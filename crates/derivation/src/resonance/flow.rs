//! The slow flow of a system over any coefficients: derived, checked, with its energy; and over rational numbers.

use super::conserved::conserved_energy;
use super::delays::Delays;
use super::system::refuse_delays;
use super::{
    Names, ResonanceError, Room, SlowFlow, System, Terms, refuse_near_miss, sum_of_harmonics,
};
use crate::averaging::AveragingSettings;
use crate::error::DerivationError as Error;
use crate::work::Progress;
use lindstedt_algebra::{AmplitudeAlgebra, PhaseError};
use lindstedt_coeff::constant;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_expand::resonance::{checked_residual, energy, resonant};
use lindstedt_expand::{Binding, Equation, ExpandError, OrderWork, compile_system};
use lindstedt_number::Whole;
use lindstedt_phase::amplitudes::scalars::{Integers, Scalars};
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, Rates};
use rug::Rational;

/// Symbols of the algebra, waves of the forces, and what else is a constant of the coefficients.
pub(super) struct Symbols<'a, S: Scalars> {
    pub algebra: &'a Amplitudes<S>,
    /// cos m eta is the harmonic m times this of the algebra.
    pub step: i32,
    pub other: &'a dyn Fn(&str) -> Option<S::Element>,
}

impl<S: Scalars> Binding<Amplitudes<S>> for Symbols<'_, S> {
    fn parameter(&self, name: &str) -> Option<AmplitudeElement<S::Element>> {
        if let Some((l, m, sine)) = wave_of(name) {
            let [cos, sin] = self.algebra.wave(l, m.checked_mul(self.step)?)?;
            return Some(if sine { sin } else { cos });
        }
        let other = || Some(self.algebra.constant((self.other)(name)?));
        self.algebra.symbol(name).or_else(other)
    }
    fn power(&self, e: &Expression) -> Option<AmplitudeElement<S::Element>> {
        constant(self.algebra, e, &|name| self.parameter(name))
    }
}

const WAVE: &str = "'wave";

/// l and m of cos(m eta_l) or sin(m eta_l) by their name, and whether it is the sine.
pub(super) fn wave_of(name: &str) -> Option<(usize, i32, bool)> {
    let mut parts = name.strip_prefix(WAVE)?.split(',').map(|part| part.parse::<i32>().ok());
    let mut next = || parts.next().flatten();
    Some((next()?.try_into().ok()?, next()?, next()? == 1))
}

/// The equations of a system with the waves as [`Symbols`] reads them.
pub(super) fn compiled_form(system: &System) -> Vec<Expression> {
    system.with_waves(&|function, l, m| {
        let sine = i32::from(function == Function::Sin);
        format!("{WAVE}{l},{m},{sine}")
    })
}

/// The equations of a system in an algebra; a term that is refused as it was written, the unknowns by their names.
pub(super) fn compiled<S: Scalars>(
    algebra: &Amplitudes<S>,
    (system, names): (&System, Names<'_>),
    binding: &dyn Binding<Amplitudes<S>>,
    order: usize,
) -> Result<Equation<Amplitudes<S>>, ExpandError> {
    let equations = compiled_form(system);
    compile_system(algebra, &equations, binding, order).map_err(|error| {
        let ExpandError::UnsupportedTerm { term } = &error else { return error };
        // Where unknowns are modes what is said is a term of the user's that no polynomial is.
        let unknown = |e: &Expression| matches!(e, Expression::Unknown(_));
        let curved = |e: &&Expression| match e {
            Expression::Power(z, n) => {
                let natural = n.as_number().is_some_and(|n| n.is_integer() && n >= 0);
                !natural && z.find(&unknown).is_some()
            }
            Expression::Function(_, z) => z.find(&unknown).is_some(),
            _ => false,
        };
        let own = || names.0.equations().flat_map(Expression::nodes).find(curved);
        if let Some(own) = system.shapes.is_some().then(own).flatten() {
            return ExpandError::UnsupportedTerm { term: names.shown(own) };
        }
        let refused = |e: &&Expression| e.print("eps", Style::Text) == *term;
        let Some(found) = equations.iter().flat_map(Expression::nodes).find(refused) else {
            return error;
        };
        let wave = |e: &Expression| match e {
            Expression::Parameter(name) => system.written(wave_of(name)?),
            _ => None,
        };
        ExpandError::UnsupportedTerm { term: names.shown(&found.map(&wave)) }
    })
}

pub(super) type Element<S> = AmplitudeElement<<S as Scalars>::Element>;
pub(super) type Found<S> = lindstedt_expand::resonance::SlowFlow<Element<S>>;

/// A flow that was derived.
pub(super) struct Run<S: Scalars> {
    pub algebra: Amplitudes<S>,
    pub delays: Delays,
    pub found: Found<S>,
    /// The orders that were checked.
    pub checked: Option<usize>,
    /// What the residual is.
    pub residual: Vec<Element<S>>,
    /// The energy, order by order; empty where there is none.
    pub energy: Vec<Element<S>>,
}

pub(super) struct Job<'a> {
    pub problem: &'a Problem,
    pub system: System,
    pub settings: &'a AveragingSettings,
}

impl Job<'_> {
    /// The multiples of 1 and the generators, a unit other than 1 first, in the nu_j, where these are multiples of the unit,
    /// and in the Omega_l; one 0 without a force.
    pub(super) fn rates<E>(&self, generators: Vec<(E, Whole)>) -> Rates<E> {
        let number = self.system.unit.as_ref().map(|_| Rational::new());
        let rate = |rate: &[Rational]| number.iter().chain(rate).cloned().collect::<Vec<_>>();
        let amplitudes = self.system.frequencies.iter();
        let amplitudes = amplitudes.map(|nu| rate(std::slice::from_ref(nu))).collect();
        let mut forces: Vec<_> = self.system.forces.iter().map(|phase| rate(&phase.rate)).collect();
        if forces.is_empty() {
            forces.push(vec![Rational::new()]);
        }
        Rates { amplitudes, forces, generators }
    }

    /// Over rational numbers, a unit other than 1 being the last of the symbols.
    pub(super) fn rational(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<SlowFlow, Error> {
        let units: Vec<_> = self.system.unit.iter().map(|unit| unit.expression()).collect();
        let generators = units.iter().map(|_| Integers.fraction(&1.into())).collect();
        let run = self.run(Integers, (self.rates(generators), &units), &|_| None, observer)?;
        let terms = |f: &_| run.algebra.rational_terms(f).unwrap_or_default();
        Ok(self.finished(&run, &terms))
    }

    /// Derives and checks, over some coefficients, with `other` for names that are none of the symbols; the generators of the
    /// rates as expressions.
    pub(super) fn run<S: Scalars>(
        &self,
        scalars: S,
        (rates, generators): (Rates<S::Element>, &[Expression]),
        other: &dyn Fn(&str) -> Option<S::Element>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Run<S>, Error> {
        let (system, settings) = (&self.system, self.settings);
        let names: Vec<&str> = system.symbols.iter().map(String::as_str).collect();
        let equations = compiled_form(system);
        let delays = Delays::of(&equations, &rates, generators, system.unit.as_deref())?;
        let algebra = Amplitudes::turning(scalars, rates.clone(), &names, delays.phases());
        let no_room = || {
            let forces: Vec<_> = system.forces.iter().map(|phase| phase.rate.clone()).collect();
            let symbols = names.len() + delays.phases();
            ResonanceError::no_room(&system.frequencies, &forces, symbols)
        };
        let unit = system.unit.iter().map(|unit| &*unit.name).find(|unit| names.contains(unit));
        let algebra = algebra.and_then(|algebra| match unit {
            Some(unit) => algebra.with_unit(unit),
            None => Some(algebra),
        });
        let algebra = algebra.ok_or_else(no_room)?.with_inverses();
        let time = |algebra: &Amplitudes<S>, e: &Expression| {
            let binding = Symbols { algebra, step: 1, other };
            constant(algebra, e, &|name| binding.parameter(name))
        };
        let late = || delays.put_in(algebra, &rates, &time);
        let algebra = late().ok_or_else(|| self.refused_delay())?.with_stop(settings.stop.clone());
        let binding = Symbols { algebra: &algebra, step: 1, other };
        let names = Names(self.problem);
        let graph = compiled(&algebra, (system, names), &binding, settings.order)?;
        let sigma = |e: &Expression| {
            let term = names.shown(e);
            let refused = || ResonanceError::NotAForce { term };
            constant(&algebra, e, &|name| binding.parameter(name)).ok_or_else(refused)
        };
        let list = |phase: &super::Phase| phase.detuning.iter().map(sigma).collect();
        let detuning = system.forces.iter().map(list).collect::<Result<Vec<Vec<_>>, _>>()?;
        let mut room = Room::new(settings);
        let mut on_order = |work: &OrderWork| {
            observer(Progress::Order(work.order, work.terms)) && room.has_next(work)
        };
        let found = resonant(&algebra, &graph, settings.order, &detuning, &mut on_order);
        room.checked?;
        let (order, largest) = (settings.order, algebra.largest_exponent());
        let too_high = || Error::from(ResonanceError::TooHigh { order, largest });
        let found = found.map_err(|error| match error {
            ExpandError::Interrupted { .. } if algebra.overflowed() => too_high(),
            ExpandError::Phase { order, source: PhaseError::Undecided { harmonic } } => {
                let harmonic = sum_of_harmonics(&harmonic, algebra.forces());
                ResonanceError::UndecidedDivisor { order, harmonic }.into()
            }
            error => error.into(),
        })?;
        if algebra.overflowed() {
            return Err(too_high());
        }
        refuse_near_miss(&found.nearest, algebra.forces())?;
        observer(Progress::Checking);
        let (checked, residual) = match checked_residual(&algebra, &graph, &found) {
            // What was multiplied after the work was stopped means nothing, for better or worse.
            _ if settings.stop.asked() => (None, Vec::new()),
            Err(ExpandError::Interrupted { .. }) => (None, Vec::new()),
            other => (Some(found.order()), other?),
        };
        let conserved = checked.filter(|_| !delays.any() && system.forces.is_empty());
        let known = || match &system.algebraic {
            Some(modes) => modes.energy.clone(),
            None => conserved_energy(&system.equations),
        };
        let energy = match conserved.and_then(|_| known()) {
            None => Vec::new(),
            Some(sum) => {
                // As the rest of an equation of its own.
                let rest = std::iter::once(sum).chain(std::iter::repeat(Expression::integer(0)));
                let alone = |(j, rest)| Expression::unknown(j, 2) + rest;
                let all: Vec<_> =
                    rest.take(system.equations.len()).enumerate().map(alone).collect();
                let graph = compile_system(&algebra, &all, &binding, settings.order)?;
                match energy(&algebra, &graph, &found) {
                    _ if settings.stop.asked() || algebra.overflowed() => Vec::new(),
                    other => other?,
                }
            }
        };
        Ok(Run { algebra, delays, found, checked, residual, energy })
    }

    /// A delay that is no polynomial in parameters.
    fn refused_delay(&self) -> Error {
        match refuse_delays(&self.system.equations, Names(self.problem)) {
            Err(error) => error.into(),
            Ok(()) => ExpandError::NotWeaklyNonlinear.into(),
        }
    }

    pub(super) fn finished<S: Scalars>(
        &self,
        run: &Run<S>,
        terms: &dyn Fn(&Element<S>) -> Terms,
    ) -> SlowFlow {
        let Run { algebra, delays, found, checked, energy, .. } = run;
        let mut system = self.system.clone();
        let (moving, own) = (algebra.unknowns() * 2 + algebra.forces(), system.symbols.len());
        let lists = |lists: &[Vec<Element<S>>]| -> Vec<Vec<Terms>> {
            lists.iter().map(|list| list.iter().map(terms).collect()).collect()
        };
        let [mut flow, mut solution, mut detuning] =
            [&found.flow, &found.solution, &found.detuning].map(|all| lists(all));
        for (j, list) in flow.iter_mut().enumerate() {
            list[0] = terms(&algebra.by_time(&algebra.amplitude(j)));
        }
        let all = || [&flow, &solution, &detuning].into_iter().flatten().flatten().flatten();
        let angles = delays.angles(all(), moving);
        for list in [&mut flow, &mut solution, &mut detuning].into_iter().flatten().flatten() {
            angles.unfold(list, own);
        }
        system.symbols.extend(angles.names());
        system.angles.extend(angles.named());
        SlowFlow {
            problem: self.problem.clone(),
            system,
            order: found.order(),
            checked_orders: *checked,
            flow,
            solution,
            detuning,
            nearest: found.nearest.clone(),
            energy: energy.iter().map(terms).collect(),
            enclosed: None,
            doubtful: Vec::new(),
        }
    }
}
