//! One averaging: the field its coefficients are taken from, rational numbers, symbols or enclosures.

use super::coefficients::{Coefficients, with_angles};
use super::cycles::{cycles, single_cycle};
use super::formulas::Formulas;
use super::values::{Given, enclosed};
use super::{
    AveragedExpansion, Averaging, AveragingSettings, Coefficient, Formula, RateTerm, SingleCycle,
};
use crate::error::DerivationError as Error;
use crate::limits::{check_delays, refuse_high_powers, refuse_taken, unknown_parameter};
use crate::resonance::ResonanceError;
use crate::values::value;
use crate::work::Progress;
use lindstedt_algebra::{FunctionAlgebra, RationalAlgebra, Rationals};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials, AmplitudePower};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::print::Print;
use lindstedt_coeff::{PolynomialRing, constant};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::resonance::{check_flow, linear_part, resonant};
use lindstedt_expand::{Binding, Equation, Excitation, ExpandError, compile_system};
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::rational;
use lindstedt_phase::amplitudes::polar::{Polar, Read};
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, Delay, scalars::Scalars};
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::sync::Arc;

pub(super) struct Task<'a> {
    problem: &'a Problem,
    settings: &'a AveragingSettings,
    pub(super) excitation: Excitation,
    /// The parameters of the equation.
    pub(super) names: BTreeSet<String>,
}

/// The values of constant expressions.
struct Bound<'a, E>(&'a dyn Fn(&Expression) -> Option<E>);

/// The polynomials in the amplitude and the phase of the force.
type Algebra<K> = Amplitudes<<K as Coefficients>::Scalars>;

impl<A: FunctionAlgebra> Binding<A> for Bound<'_, A::Element> {
    fn parameter(&self, name: &str) -> Option<A::Element> {
        (self.0)(&Expression::parameter(name))
    }
    fn power(&self, power: &Expression) -> Option<A::Element> {
        (self.0)(power)
    }
}

/// What an equation is averaged over.
struct Setting<K: Coefficients> {
    ring: K,
    algebra: Algebra<K>,
    /// omega_0, and the frequency of the force.
    frequency: K::Element,
    forcing: Option<K::Element>,
    delays: Vec<Delay<K::Element>>,
}

/// That z alone does not solve order zero says of one unknown that its equation is not weakly nonlinear.
fn weakly(error: ExpandError) -> ExpandError {
    match error {
        ExpandError::NotTheFrequency { .. } => ExpandError::NotWeaklyNonlinear,
        error => error,
    }
}

/// Beyond this precision "not enough bits" is answered.
const MOST_BITS: u32 = 1 << 18;

/// The result over K.
pub(super) struct Over<K: RationalAlgebra> {
    ring: K,
    pub(super) frequency: K::Element,
    pub(super) expansion: AveragedExpansion<K::Element>,
    checked_orders: usize,
}

impl<'a> Task<'a> {
    pub(super) fn new(
        problem: &'a Problem,
        settings: &'a AveragingSettings,
    ) -> Result<Self, Error> {
        let known: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
        if let Some(name) = settings.parameters.keys().find(|name| !known.contains(&name.as_str()))
        {
            return Err(unknown_parameter(problem, name));
        }
        check_delays(&problem.equation, &settings.parameters)?;
        let mut names = BTreeSet::new();
        names.extend(problem.equation.parameters());
        let excitation = Excitation::of(&problem.equation)?;
        let task = Self { problem, settings, excitation, names };
        let symbols = || task.names.iter().filter(|name| task.value(name).is_none());
        if symbols().next().is_some() {
            refuse_high_powers([&problem.equation], settings.order)?;
        }
        refuse_taken(symbols(), |base, numbered| match base {
            "a" if !numbered => Some("the amplitude"),
            "psi" if !numbered => Some("the phase"),
            "eta" if !numbered => Some("the phase of the force"),
            "A" | "B" | "u" if numbered => Some("a coefficient"),
            _ => None,
        })?;
        Ok(task)
    }

    /// The value of a parameter; of a synchronous delay 2 pi k/omega when that is a multiple of pi.
    pub(super) fn value(&self, name: &str) -> Option<Given> {
        let given = |name: &str| self.settings.parameters.get(name).cloned();
        match &self.problem.synchronous {
            Some(tie) if tie.delay == name => {
                Some(Given::Period(given(&tie.periods)?, given(&tie.frequency)?))
            }
            _ => given(name).map(Given::Value),
        }
    }

    fn is_synchronous(&self, delay: &Expression) -> bool {
        let tied = self.problem.synchronous.as_ref();
        tied.is_some_and(|tie| *delay == Expression::parameter(&tie.delay))
    }

    /// The algebra over K and the frequency omega_0; `angles` sees omega_0 T and omega T before
    /// their sines are asked for, and may extend the ring.
    fn algebra<K: Coefficients>(
        &self,
        ring: &K,
        values: &dyn Fn(&str) -> Option<K::Element>,
        angles: &dyn Fn(&K, &[K::Element]) -> K,
    ) -> Result<Setting<K>, Error> {
        let evaluate = |expression: &Expression| constant(ring, expression, values);
        let unknown = |e: &Expression| {
            Error::from(ExpandError::UnsupportedTerm {
                term: e.print(&self.problem.small, lindstedt_equation::print::Style::Text),
            })
        };
        let forcing = match &self.excitation.frequency {
            Some(frequency) => Some(evaluate(frequency).ok_or_else(|| unknown(frequency))?),
            None => None,
        };
        let times: Vec<K::Element> = self
            .excitation
            .delays
            .iter()
            .map(|delay| evaluate(delay).ok_or_else(|| unknown(delay)))
            .collect::<Result<_, _>>()?;
        let still = |ring: &K| [ring.one(), ring.zero()];
        let waiting =
            |time: &K::Element| Delay { time: time.clone(), turns: vec![still(ring), still(ring)] };
        // The linear part does not depend on the frequency, and gives it.
        let waiting: Vec<_> = times.iter().map(waiting).collect();
        let provisional = self.amplitudes(ring, &ring.one(), forcing.as_ref(), &waiting)?;
        let graph = self.compiled(ring, &provisional, values)?;
        let linear = linear_part(&provisional, &graph).map_err(weakly)?;
        if !linear.is_free(&provisional) {
            return Err(ExpandError::NotWeaklyNonlinear.into());
        }
        let stiffness = provisional.as_number(&linear.stiffness);
        let stiffness = stiffness.ok_or(ExpandError::NotWeaklyNonlinear)?;
        let frequency = ring.square_root(&stiffness).filter(|nu| !ring.is_zero(nu));
        let frequency = frequency.ok_or_else(|| match ring.sign(&stiffness) {
            Some(Ordering::Equal) => ExpandError::NoStiffness,
            Some(Ordering::Less) => ExpandError::NegativeStiffness,
            _ => ExpandError::StiffnessNotSquare,
        })?;

        let mut all = Vec::new();
        for (delay, time) in self.excitation.delays.iter().zip(&times) {
            all.push(ring.mul(&frequency, time));
            if let Some(forcing) = forcing.as_ref().filter(|_| !self.is_synchronous(delay)) {
                all.push(ring.mul(forcing, time));
            }
        }
        let ring = angles(ring, &all);
        let mut delays = Vec::new();
        for (delay, time) in self.excitation.delays.iter().zip(times) {
            let turn =
                |rate: &K::Element| ring.turn(rate, &time).ok_or(ExpandError::IrrationalAngle);
            let forced = match &forcing {
                Some(forcing) if !self.is_synchronous(delay) => turn(forcing)?,
                _ => still(&ring),
            };
            delays.push(Delay { turns: vec![turn(&frequency)?, forced], time });
        }
        let algebra = self.amplitudes(&ring, &frequency, forcing.as_ref(), &delays)?;
        Ok(Setting { ring, algebra, frequency, forcing, delays })
    }

    fn amplitudes<K: Coefficients>(
        &self,
        ring: &K,
        frequency: &K::Element,
        forcing: Option<&K::Element>,
        delays: &[Delay<K::Element>],
    ) -> Result<Algebra<K>, Error> {
        let algebra = Amplitudes::off_resonance(ring.scalars(), frequency, forcing);
        let algebra = algebra.ok_or(ExpandError::NotWeaklyNonlinear)?;
        Ok(algebra.with_delays(delays).with_stop(self.settings.stop.clone()))
    }

    fn compiled<K: Coefficients>(
        &self,
        ring: &K,
        algebra: &Algebra<K>,
        values: &dyn Fn(&str) -> Option<K::Element>,
    ) -> Result<Equation<Algebra<K>>, ExpandError> {
        let number = |e: &Expression| Some(algebra.number(&constant(ring, e, values)?));
        self.graph(algebra, &number)
    }

    fn graph<S: Scalars>(
        &self,
        algebra: &Amplitudes<S>,
        constant: &dyn Fn(&Expression) -> Option<AmplitudeElement<S::Element>>,
    ) -> Result<Equation<Amplitudes<S>>, ExpandError> {
        let equation = std::slice::from_ref(&self.problem.equation);
        compile_system(algebra, equation, &Bound(constant), self.settings.order)
    }

    fn derive<K: Coefficients + Print>(
        &self,
        Setting { ring, algebra, frequency, .. }: Setting<K>,
        values: &dyn Fn(&str) -> Option<K::Element>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Over<K>, Error> {
        let graph = self.compiled(&ring, &algebra, values)?;
        let (expansion, checked_orders) =
            self.expanded(&algebra, &graph, &|c| algebra.parts(c), observer)?;
        Ok(Over { ring, frequency, expansion, checked_orders })
    }

    /// The expansion, its constants read as numbers, and how many orders were checked.
    fn expanded<S: Scalars, N: Clone + PartialEq + Debug + Send + Sync>(
        &self,
        algebra: &Amplitudes<S>,
        graph: &Equation<Amplitudes<S>>,
        read: Read<'_, S::Element, N>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<(AveragedExpansion<N>, usize), Error> {
        let mut on_order =
            |work: &lindstedt_expand::OrderWork| observer(Progress::Order(work.order, work.terms));
        let found = resonant(algebra, graph, self.settings.order, &[], &mut on_order);
        let overflowed = || {
            let (order, largest) = (self.settings.order, algebra.largest_exponent());
            Err(ResonanceError::TooHigh { order, largest }.into())
        };
        if algebra.overflowed() {
            return overflowed();
        }
        let found = found.map_err(weakly)?;
        observer(Progress::Checking);
        // Order zero was checked before the loop.
        let checked_orders = match check_flow(algebra, graph, &found) {
            _ if algebra.overflowed() => return overflowed(),
            Err(ExpandError::Interrupted { .. }) => 0,
            other => other?,
        };
        if self.settings.stop.asked() {
            observer(Progress::Reading);
        }
        let expansion = AveragedExpansion::of(algebra, &found, read);
        Ok((expansion.ok_or(ExpandError::NotWeaklyNonlinear)?, checked_orders))
    }

    /// Over symbols in the words of the algebra; nothing where that has no room or cannot divide, which the field of the
    /// parameters does or refuses.
    fn over_words(
        &self,
        field: &ParameterField,
        formulas: &Formulas<'_>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<(AveragedExpansion<ParameterFraction>, usize)>, Error> {
        let algebra = &formulas.algebra;
        let value = |name: &str| match self.settings.parameters.get(name) {
            Some(value) => Some(algebra.rational(value.as_rational()?)),
            None => formulas.element(&field.parameter(field.position(name)?)),
        };
        let graph = self.graph(algebra, &|e| constant(algebra, e, &value));
        let found = graph
            .map_err(Error::from)
            .and_then(|graph| self.expanded(algebra, &graph, &|c| formulas.read(c), observer));
        match found {
            Ok(found) => Ok(Some(found)),
            Err(Error::Expand(
                error @ (ExpandError::Residual { .. }
                | ExpandError::Normalisation { .. }
                | ExpandError::Interrupted { .. }),
            )) => Err(error.into()),
            Err(_) => Ok(None),
        }
    }

    fn finish<K: RationalAlgebra + Print + Send + Sync + 'static>(
        &self,
        over: Over<K>,
        exact: bool,
        coefficient: &dyn Fn(K::Element) -> Result<Coefficient, Error>,
    ) -> Result<Averaging, Error> {
        let order = over.expansion.order();
        let term = |(AmplitudePower(exponent), c): (AmplitudePower, K::Element)| {
            Ok(RateTerm { exponent, coefficient: coefficient(c)? })
        };
        let rates = |list: Vec<AmplitudePolynomial<K::Element>>| {
            let rate = |f: AmplitudePolynomial<K::Element>| f.into_terms().map(term).collect();
            list.into_iter().map(rate).collect::<Result<Vec<Vec<_>>, Error>>()
        };
        let mut phase_rate = rates(over.expansion.phase_rate)?;
        if let Some(first) = phase_rate.first_mut() {
            *first = vec![RateTerm { exponent: 0, coefficient: coefficient(over.frequency)? }];
        }
        let constants = Arc::new(AmplitudePolynomials::new(over.ring));
        let printed = |u: Polar<K::Element>| {
            let constants = Arc::clone(&constants);
            Formula::new(move |style| u.print(&constants, style))
        };
        Ok(Averaging {
            problem: self.problem.clone(),
            order,
            checked_orders: over.checked_orders,
            amplitude_rate: rates(over.expansion.amplitude_rate)?,
            phase_rate,
            terms: over.expansion.solution.iter().map(Polar::terms).collect(),
            solution: over.expansion.solution.into_iter().map(printed).collect(),
            symbols: self.names.iter().filter(|n| self.value(n).is_none()).cloned().collect(),
            exact,
            cycles: None,
            single_cycle: None,
            convergence: None,
            description: None,
        })
    }

    /// The one limit cycle of what is not over Q.
    fn single_cycle<K: RationalAlgebra>(
        &self,
        ring: &K,
        over: &Over<K>,
        may_be_positive: &dyn Fn(&K::Element) -> bool,
        coefficient: &dyn Fn(K::Element) -> Result<Coefficient, Error>,
    ) -> Result<Option<SingleCycle>, Error> {
        if self.problem.impact.is_some() || self.settings.stop.asked() {
            return Ok(None);
        }
        let found = single_cycle(ring, &over.frequency, &over.expansion);
        let found = found.filter(|(_, [square, ..])| may_be_positive(&square[0]));
        let Some((leading_order, [square, exponent, frequency])) = found else { return Ok(None) };
        let all =
            |list: Vec<K::Element>| list.into_iter().map(coefficient).collect::<Result<_, _>>();
        Ok(Some(SingleCycle {
            leading_order,
            squared_amplitude: all(square)?,
            exponent: all(exponent)?,
            frequency: all(frequency)?,
        }))
    }

    /// Over Q; nothing when a square root or an angle is irrational.
    pub(super) fn over_rationals(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<Over<Rationals>>, Error> {
        let values = |name: &str| match self.value(name)? {
            Given::Value(value) => value.as_rational().cloned(),
            Given::Period(..) => None,
        };
        if self.names.iter().any(|name| values(name).is_none()) {
            return Ok(None);
        }
        let algebra = match self.algebra(&Rationals, &values, &|ring, _| *ring) {
            Err(Error::Expand(ExpandError::StiffnessNotSquare | ExpandError::IrrationalAngle)) => {
                return Ok(None);
            }
            other => other?,
        };
        self.derive(algebra, &values, observer).map(Some)
    }

    pub(super) fn rational(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<Averaging>, Error> {
        let Some(over) = self.over_rationals(observer)? else { return Ok(None) };
        let number = |q| Ok(Coefficient::Number(rational(&q, self.settings.digits)?));
        let cycles = match self.settings.stop.asked() {
            true => None,
            false => cycles(&over.frequency, &over.expansion, self.settings.digits)?,
        };
        Ok(Some(Averaging { cycles, ..self.finish(over, true, &number)? }))
    }

    /// Over the field of the parameters without a value: in words where these have room.
    pub(super) fn over_parameters(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<(ParameterField, Over<ParameterField>), Error> {
        let general = self.over_field()?;
        let Setting { ring: field, frequency, forcing, delays, .. } = &general;
        if let Some(formulas) = Formulas::new(field, frequency, forcing.as_ref(), delays)
            && let Some((expansion, checked)) =
                self.over_words(field, &formulas.with_stop(self.settings.stop.clone()), observer)?
        {
            let (ring, frequency) = (field.clone(), frequency.clone());
            let over = Over { ring, frequency, expansion, checked_orders: checked };
            return Ok((field.clone(), over));
        }
        let field = field.clone();
        Ok((field, self.derive_over_field(general, observer)?))
    }

    /// The values of the parameters in a field.
    fn in_field(&self, field: &ParameterField, name: &str) -> Option<ParameterFraction> {
        match self.settings.parameters.get(name) {
            Some(value) => Some(field.rational(value.as_rational()?)),
            None => Some(field.parameter(field.position(name)?)),
        }
    }

    fn derive_over_field(
        &self,
        general: Setting<ParameterField>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Over<ParameterField>, Error> {
        let field = general.ring.clone();
        self.derive(general, &|name| self.in_field(&field, name), observer)
    }

    fn over_field(&self) -> Result<Setting<ParameterField>, Error> {
        let given = |name: &str| match self.value(name)? {
            Given::Value(value) => value.as_rational().cloned(),
            Given::Period(..) => None,
        };
        let irrational = |name: &&String| {
            let value = self.settings.parameters.get(*name);
            value.is_some_and(|value| value.as_rational().is_none())
        };
        let tied = |name: &&String| {
            let tie = self.problem.synchronous.as_ref();
            tie.is_some_and(|tie| tie.periods == ***name)
        };
        let names = self.settings.parameters.keys();
        if let Some(name) = names.clone().find(irrational).or(names.clone().find(tied)) {
            // A delay tied to the force takes the values of its periods and its frequency.
            let tie = self.problem.synchronous.as_ref();
            let cards = self.problem.parameters.iter().map(|card| card.name.to_string());
            let open = |name: &String| {
                let behind = tie.is_some_and(|t| t.periods == **name || t.frequency == **name);
                (self.names.contains(name) || behind)
                    && !self.settings.parameters.contains_key(name)
            };
            let missing = cards.filter(open).collect();
            return Err(Error::NotAmongSymbols { name: name.clone(), missing });
        }
        // In the order of the data card, which is the order of printing.
        let cards = self.problem.parameters.iter().map(|card| card.name.to_string());
        let listed: Vec<String> = cards.filter(|name| self.names.contains(name)).collect();
        let unlisted = self.names.iter().filter(|name| !listed.contains(name)).cloned();
        let ordered: Vec<String> = listed.iter().cloned().chain(unlisted).collect();
        let parameters = ordered.into_iter().filter(|name| given(name).is_none()).collect();
        // A frequency with a value on its card may be at a resonance, which a formula would not see.
        let known = |name: &String| value(self.problem, &self.settings.parameters, name).is_some();
        let rates = self.excitation.frequency.iter().flat_map(Expression::parameters);
        let affine = rates.into_iter().any(|name| !known(&name));
        let plain =
            ParameterField { ring: PolynomialRing { parameters }, pairs: Vec::new(), affine };
        let values = |name: &str| self.in_field(&plain, name);
        self.algebra(&plain, &values, &|field, angles| with_angles(field, angles))
    }

    pub(super) fn symbolic(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Averaging, Error> {
        let (field, over) = self.over_parameters(observer)?;
        let field = Arc::new(field);
        let formula = |c: ParameterFraction| {
            if let Some(q) = field.as_rational(&c) {
                return Ok(Coefficient::Number(rational(&q, self.settings.digits)?));
            }
            let field = Arc::clone(&field);
            Ok(Coefficient::Formula(Formula::new(move |style| field.print(&c, style))))
        };
        let positive = |c: &_| field.sign(c).is_none_or(|sign| sign == Ordering::Greater);
        let single_cycle = self.single_cycle(&*field, &over, &positive, &formula)?;
        Ok(Averaging { single_cycle, ..self.finish(over, true, &formula)? })
    }

    /// With enclosures.
    pub(super) fn over_balls(
        &self,
        balls: Balls,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Over<BallRing>, Error> {
        let ring = BallRing { balls };
        let values = |name: &str| Some(Enclosure(self.value(name)?.ball(balls)?));
        let algebra = self.algebra(&ring, &values, &|ring, _| *ring)?;
        self.derive(algebra, &values, observer)
    }

    /// With enclosures; the precision doubles until every coefficient has its digits.
    pub(super) fn certified(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Averaging, Error> {
        let digits = self.settings.digits;
        // Every order loses some bits to the growth of the radii.
        let wanted = (digits as f64 * 3.33) as u32;
        let mut bits =
            wanted + 40 + 8 * u32::try_from(self.settings.order).unwrap_or(u32::MAX / 16);
        loop {
            let over = self.over_balls(Balls::new(bits), observer)?;
            let number = |c: Enclosure| enclosed(&c.0, digits, bits);
            let positive = |c: &Enclosure| c.0.lower() > 0;
            let ring = BallRing { balls: Balls::new(bits) };
            let single = self.single_cycle(&ring, &over, &positive, &number);
            let result = single.and_then(|single_cycle| {
                Ok(Averaging { single_cycle, ..self.finish(over, false, &number)? })
            });
            match result {
                Err(Error::NotEnoughBits { .. })
                    if bits < MOST_BITS && !self.settings.stop.asked() =>
                {
                    bits *= 2;
                }
                other => return other,
            }
        }
    }
}
