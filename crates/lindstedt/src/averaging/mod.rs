//! Averaging of a problem: rates of amplitude and phase as formulas or as numbers.

mod coefficients;
pub(crate) mod numbers;
mod values;

use crate::derivation::{check_delays, unknown_parameter};
use crate::number::rational;
use crate::{Error, Number, Progress, Value};
use coefficients::{Coefficients, with_angles};
use lindstedt_algebra::{FunctionAlgebra, RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::PolynomialRing;
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials, AmplitudePower};
use lindstedt_coeff::ball::Balls;
use lindstedt_coeff::ball::ring::{BallRing, Enclosure};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::{
    AveragedExpansion, Binding, Excitation, ExpandError, average as expand_average, check_averaged,
    compile, linear_part,
};
use lindstedt_phase::{Delay, Torus};
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};
use values::{Given, collect, constant, enclosed};

/// What to average.
#[derive(Clone, Debug)]
pub struct AveragingSettings {
    /// The highest order.
    pub order: usize,
    /// Values of parameters by name. Parameters of the equation that are not listed stay symbols.
    pub parameters: BTreeMap<String, Value>,
    /// Digits of numbers that are not rational.
    pub digits: usize,
    /// Asked within the orders whether to stop.
    pub stop: Stop,
    /// The memory that may be used, in bytes.
    pub memory: u64,
}

impl Default for AveragingSettings {
    /// Order 2, every parameter a symbol, 30 digits, 8 GiB.
    fn default() -> Self {
        Self {
            order: 2,
            parameters: BTreeMap::new(),
            digits: 30,
            stop: Stop::default(),
            memory: 8 << 30,
        }
    }
}

/// One term c a^exponent of a rate.
#[derive(Clone, Debug, PartialEq)]
pub struct RateTerm {
    /// The power of the amplitude.
    pub exponent: i32,
    /// c.
    pub coefficient: Coefficient,
}

/// A coefficient of an averaged expansion.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// A number.
    Number(Number),
    /// A formula in the parameters that have no value, as text and as LaTeX.
    Formula {
        /// One line of text.
        text: String,
        /// LaTeX.
        latex: String,
    },
}

/// An averaged problem, substituted into its equation:
///
///   x = a cos psi + ..., da/dt = sum eps^n A_n(a), dpsi/dt = sum eps^n B_n(a) with B_0 = omega_0;
///
/// no other term of x contains cos psi or sin psi.
#[derive(Clone, Debug)]
pub struct Averaging {
    /// The problem.
    pub problem: Problem,
    /// The highest order derived.
    pub order: usize,
    /// Orders 0..=this leave no residual; 0 where [`AveragingSettings::stop`] left no time to check
    /// the others.
    pub checked_orders: usize,
    /// A_n, order by order, as terms in increasing powers of a.
    pub amplitude_rate: Vec<Vec<RateTerm>>,
    /// B_n; the one of order zero is omega_0.
    pub phase_rate: Vec<Vec<RateTerm>>,
    /// u_0 = a cos psi + the forced response, u_1, ... as text and as LaTeX.
    pub solution: Vec<[String; 2]>,
    /// Terms of u_n.
    pub terms: Vec<usize>,
    /// Whether the coefficients are exact (rational numbers or formulas); otherwise they are
    /// certified and the residual encloses zero.
    pub exact: bool,
}

impl Averaging {
    /// Whether A_n = R_n a and B_n are free of a: then the amplitude grows exponentially, and
    /// `growth_rate` and `frequency` are numbers.
    pub fn is_linear(&self) -> bool {
        let only = |rates: &[Vec<RateTerm>], exponent| {
            rates.iter().flatten().all(|term| term.exponent == exponent)
        };
        only(&self.amplitude_rate, 1) && only(&self.phase_rate, 0)
    }
}

/// Averages a problem.
///
/// Coefficients are rational where all parameters of the equation have rational values and no
/// delay occurs; formulas when a parameter has no value (the others must be rational); certified
/// numbers otherwise, at a precision that is raised until all digits are certain.
///
/// # Errors
/// [`Error`] with the reason; resonances are named.
///
/// ```
/// use lindstedt::averaging::{AveragingSettings, Coefficient, average};
/// use lindstedt::problems;
/// let problem = problems::vibro_impact::problem();
/// let settings = AveragingSettings { order: 1, ..AveragingSettings::default() };
/// let result = average(&problem, &settings, &mut |_| true)?;
/// // The paper's (7): da/dt = eps R a.
/// let Coefficient::Formula { text, .. } = &result.amplitude_rate[1][0].coefficient else { panic!() };
/// assert!(text.contains("1/2*alpha^(-1)*A*sin(alpha*T)"), "{text}");
/// # Ok::<(), lindstedt::Error>(())
/// ```
pub fn average(
    problem: &Problem,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Averaging, Error> {
    let task = Task::new(problem, settings)?;
    if task.names.iter().any(|name| task.value(name).is_none()) {
        limit_memory(settings)?;
        return task.symbolic(observer);
    }
    if let Some(result) = task.rational(observer)? {
        return Ok(result);
    }
    task.certified(observer)
}

/// The averaged expansion with every parameter a symbol, as elements of their field.
pub(crate) fn formulas(
    problem: &Problem,
    order: usize,
) -> Result<(ParameterField, AveragedExpansion<Torus<ParameterField>>), Error> {
    let settings = AveragingSettings { order, digits: 20, ..AveragingSettings::default() };
    let (field, over) = Task::new(problem, &settings)?.over_parameters(&mut |_| true)?;
    Ok((field, over.expansion))
}

/// Refuses before allocating. Measured: the rates of the delay loop in six symbols take 58 MiB at
/// order 8 and 1.6 times more per order; numbers take 14 MiB at order 60.
fn limit_memory(settings: &AveragingSettings) -> Result<(), Error> {
    let bits = 58f64.log2() + 20.0 + (settings.order as f64 - 8.0) * 1.6f64.log2();
    if bits > (settings.memory.max(1) as f64).log2() {
        return Err(Error::TooLarge {
            order: settings.order,
            exponent: (bits * 2f64.log10()).round() as u64,
            limit: settings.memory >> 20,
        });
    }
    Ok(())
}

struct Task<'a> {
    problem: &'a Problem,
    settings: &'a AveragingSettings,
    excitation: Excitation,
    /// The parameters of the equation.
    names: BTreeSet<String>,
}

/// Values of parameters in a ring of coefficients.
struct Bound<'a, K: RationalAlgebra> {
    ring: AmplitudePolynomials<K>,
    values: &'a dyn Fn(&str) -> Option<K::Element>,
}

impl<K: RationalAlgebra> Binding<AmplitudePolynomials<K>> for Bound<'_, K> {
    fn parameter(&self, name: &str) -> Option<AmplitudePolynomial<K::Element>> {
        (self.values)(name).map(|value| self.ring.embed(value))
    }
    fn formal(&self, _: &str, _: usize) -> Option<AmplitudePolynomial<K::Element>> {
        None
    }
    fn power(&self, power: &Expression) -> Option<AmplitudePolynomial<K::Element>> {
        constant(&self.ring.coefficients, power, self.values).map(|value| self.ring.embed(value))
    }
}

/// Beyond this precision "not enough bits" is answered.
const MOST_BITS: u32 = 1 << 18;

/// The result over K.
struct Over<K: RationalAlgebra> {
    frequency: K::Element,
    expansion: AveragedExpansion<Torus<K>>,
    checked_orders: usize,
    solution: Vec<[String; 2]>,
    terms: Vec<usize>,
}

impl<'a> Task<'a> {
    fn new(problem: &'a Problem, settings: &'a AveragingSettings) -> Result<Self, Error> {
        let known: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
        if let Some(name) = settings.parameters.keys().find(|name| !known.contains(&name.as_str()))
        {
            return Err(unknown_parameter(problem, name));
        }
        check_delays(&problem.equation, &settings.parameters)?;
        let mut names = BTreeSet::new();
        collect(&problem.equation, &mut names);
        let excitation = Excitation::of(&problem.equation)?;
        Ok(Self { problem, settings, excitation, names })
    }

    /// The value of a parameter; of a synchronous delay 2 pi k/omega when that is a multiple of pi.
    fn value(&self, name: &str) -> Option<Given> {
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
    ) -> Result<(Torus<K>, K::Element), Error> {
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
        let waiting = |time: &K::Element| Delay {
            time: time.clone(),
            free: still(ring),
            forced: still(ring),
        };
        // The linear part does not depend on the frequency, and gives it.
        let provisional = Torus::new(
            ring.clone(),
            ring.one(),
            forcing.clone(),
            times.iter().map(waiting).collect(),
        );
        let bound = Bound { ring: provisional.constants().clone(), values };
        let graph = compile(&provisional, &self.problem.equation, &bound, self.settings.order)?;
        let linear = linear_part(&provisional, &graph)?;
        let constants = provisional.constants();
        let zero = |f: &AmplitudePolynomial<K::Element>| constants.is_zero(f);
        if !zero(&linear.damping) || linear.delayed.iter().any(|(b, c)| !zero(b) || !zero(c)) {
            return Err(ExpandError::NotWeaklyNonlinear.into());
        }
        let stiffness = constants.as_coefficient(&linear.stiffness);
        let stiffness = stiffness.ok_or(ExpandError::NotWeaklyNonlinear)?;
        let frequency = ring.square_root(&stiffness).ok_or(ExpandError::StiffnessNotSquare)?;

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
            delays.push(Delay { free: turn(&frequency)?, forced, time });
        }
        let torus = Torus::new(ring, frequency.clone(), forcing, delays);
        Ok((torus.with_stop(self.settings.stop.clone()), frequency))
    }

    fn derive<K: Coefficients + Print>(
        &self,
        (algebra, frequency): (Torus<K>, K::Element),
        values: &dyn Fn(&str) -> Option<K::Element>,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Over<K>, Error> {
        let bound = Bound { ring: algebra.constants().clone(), values };
        let graph = compile(&algebra, &self.problem.equation, &bound, self.settings.order)?;
        let mut on_order =
            |work: &lindstedt_expand::OrderWork| observer(Progress::Order(work.order, work.terms));
        let expansion = expand_average(&algebra, &graph, self.settings.order, &mut on_order)?;
        observer(Progress::Checking);
        // Order zero was checked before the loop.
        let checked_orders = match check_averaged(&algebra, &graph, &expansion) {
            Err(ExpandError::Interrupted { .. }) => 0,
            other => other?,
        };
        let terms = expansion.solution.iter().map(|x| algebra.terms(x)).collect();
        let print = |x| [Style::Text, Style::Latex].map(|style| algebra.print(x, style));
        let solution = expansion.solution.iter().map(print).collect();
        Ok(Over { frequency, expansion, checked_orders, solution, terms })
    }

    fn finish<K: RationalAlgebra>(
        &self,
        over: &Over<K>,
        exact: bool,
        coefficient: &dyn Fn(&K::Element) -> Result<Coefficient, Error>,
    ) -> Result<Averaging, Error> {
        let term = |(AmplitudePower(exponent), c): &(AmplitudePower, K::Element)| {
            Ok(RateTerm { exponent: *exponent, coefficient: coefficient(c)? })
        };
        let rates = |list: &[AmplitudePolynomial<K::Element>]| {
            let rate = |f: &AmplitudePolynomial<K::Element>| f.terms().iter().map(term).collect();
            list.iter().map(rate).collect::<Result<Vec<Vec<_>>, Error>>()
        };
        let mut phase_rate = rates(&over.expansion.phase_rate)?;
        if let Some(first) = phase_rate.first_mut() {
            *first = vec![RateTerm { exponent: 0, coefficient: coefficient(&over.frequency)? }];
        }
        Ok(Averaging {
            problem: self.problem.clone(),
            order: over.expansion.order(),
            checked_orders: over.checked_orders,
            amplitude_rate: rates(&over.expansion.amplitude_rate)?,
            phase_rate,
            solution: over.solution.clone(),
            terms: over.terms.clone(),
            exact,
        })
    }

    /// Over Q; nothing when a square root or an angle is irrational.
    fn over_rationals(
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

    fn rational(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<Averaging>, Error> {
        let Some(over) = self.over_rationals(observer)? else { return Ok(None) };
        let number = |q: &Rational| rational(q, self.settings.digits).map(Coefficient::Number);
        self.finish(&over, true, &number).map(Some)
    }

    /// Over the field of the parameters without a value.
    fn over_parameters(
        &self,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<(ParameterField, Over<ParameterField>), Error> {
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
        let plain = ParameterField { ring: PolynomialRing { parameters }, pairs: Vec::new() };
        let values = |name: &str| match given(name) {
            Some(q) => Some(plain.rational(&q)),
            None => Some(plain.parameter(plain.position(name)?)),
        };
        let algebra = self.algebra(&plain, &values, &|field, angles| with_angles(field, angles))?;
        let field = algebra.0.coefficients().clone();
        let over = self.derive(algebra, &values, observer)?;
        Ok((field, over))
    }

    fn symbolic(&self, observer: &mut dyn FnMut(Progress) -> bool) -> Result<Averaging, Error> {
        let (field, over) = self.over_parameters(observer)?;
        let formula = |c: &ParameterFraction| match field.as_rational(c) {
            Some(q) => rational(&q, self.settings.digits).map(Coefficient::Number),
            None => Ok(Coefficient::Formula {
                text: field.print(c, Style::Text),
                latex: field.print(c, Style::Latex),
            }),
        };
        self.finish(&over, true, &formula)
    }

    /// With enclosures.
    fn over_balls(
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
    fn certified(&self, observer: &mut dyn FnMut(Progress) -> bool) -> Result<Averaging, Error> {
        let digits = self.settings.digits;
        // Every order loses some bits to the growth of the radii.
        let wanted = (digits as f64 * 3.33) as u32;
        let mut bits =
            wanted + 40 + 8 * u32::try_from(self.settings.order).unwrap_or(u32::MAX / 16);
        loop {
            let over = self.over_balls(Balls::new(bits), observer)?;
            let result = self.finish(&over, false, &|c| enclosed(&c.0, digits, bits));
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
