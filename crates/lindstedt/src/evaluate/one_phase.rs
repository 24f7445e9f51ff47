//! The question `evaluate --cycles`: first-order averaging of any law as numbers.

use crate::answer::estimated;
use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Number, Oscillator, Remark, Standing, Work};
use lindstedt_algebra::Stop;
use lindstedt_equation::print::Style;
use lindstedt_recognise::{OnePhase, PhaseCycle};
use serde::Serialize;
use std::time::Instant;

/// First-order averaging of x'' + omega^2 x + eps g(x, x') = 0 for any law g, x = a cos psi. Estimated: integrals
/// over the phase, cut where the law jumps or bends.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct FirstOrder {
    /// The small parameter.
    pub parameter: String,
    /// omega.
    pub frequency: f64,
    /// The amplitude up to which cycles are sought.
    pub amplitude: Exact,
    /// a' over the small parameter there.
    pub amplitude_rate: Number,
    /// psi' - omega over the small parameter there.
    pub phase_rate: Number,
    /// v*, the one x' other than 0 at which the law jumps or bends.
    pub belt_speed: Option<f64>,
    /// By rising amplitude.
    pub cycles: Vec<FirstOrderCycle>,
    /// a, where a' has an extremum that is not told from zero: one semistable cycle, two close ones or none.
    pub touching: Vec<Number>,
    /// From a to a, where a' is zero within its error at every amplitude tried: every amplitude is a steady state.
    pub steady: Vec<[f64; 2]>,
    /// From a to a, where the integral over the phase does not converge: cycles there are not found.
    pub unresolved: Vec<[f64; 2]>,
    /// The distance of the amplitudes that were tried: cycles that are closer may be missed.
    pub cell: f64,
    /// The parameter that v* is a multiple of.
    pub belt: Option<String>,
    /// Where cycles are as fast as the belt, by rising speed.
    pub sticking: Vec<StickingBegins>,
}

/// A simple zero of a'.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct FirstOrderCycle {
    /// a.
    pub amplitude: Number,
    /// The Floquet exponent over the small parameter.
    pub exponent: Number,
    /// psi' - omega over the small parameter.
    pub phase_rate: Number,
    /// Whether the exponent is negative where the small parameter is positive; nothing within its error of zero.
    pub stable: Option<bool>,
    /// Its way past the belt.
    pub belt: Option<Belt>,
}

/// How a cycle meets the belt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Belt {
    /// It is slower than the belt at all times.
    Slower,
    /// It overtakes the belt and passes it where the spring is stronger than friction, or no eps says how strong that is.
    Overtakes,
    /// It meets the belt where the spring is weaker than friction: it sticks, and averaging does not hold.
    Sticks,
    /// Its amplitude is not known well enough to say.
    Undecided,
}

impl Belt {
    /// In words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Slower => "slower than the belt",
            Self::Overtakes => {
                "overtakes the belt without sticking as the small parameter goes to 0"
            }
            Self::Sticks => "sticks to the belt: averaging does not hold",
            Self::Undecided => {
                "undecided whether it is slower than the belt: as fast within its error"
            }
        }
    }
}

/// A cycle as fast as the belt.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct StickingBegins {
    /// The value of the parameter of the belt.
    pub value: Number,
    /// a = |v*|/omega.
    pub amplitude: Number,
}

fn number([value, error]: [f64; 2]) -> Result<Number, Error> {
    estimated(value, error)
}

impl FirstOrder {
    fn new(
        (small, eps): (&str, Option<f64>),
        law: &OnePhase,
        largest: &Exact,
        stop: &Stop,
    ) -> Result<Self, Error> {
        let top = largest.to_f64();
        let undefined = || match law.overflow(top) {
            Some(term) => {
                let term = term.print(small, Style::Text);
                let message =
                    format!("{term} passes the largest double, 1.8e308, at this amplitude");
                Refused::undecided("too-large", message, "a smaller --cycles")
            }
            None => {
                let message = "the integral of the law over the phase does not converge at this amplitude: it has no \
                               finite value on the way, a pole (within a quarter of a turn an integrable one, too), or \
                               oscillates too fast";
                Refused::no_answer(
                    "no-value",
                    message,
                    "a smaller --cycles, where the pole lies beyond it",
                )
            }
        };
        let rates = law.rates(top).ok_or_else(undefined)?;
        let cycle = |cycle| FirstOrderCycle::new(law, &cycle, eps);
        let sticking = law.sticking(top, stop).into_iter().map(|found| {
            Ok(StickingBegins {
                value: number(found.parameter)?,
                amplitude: number(found.amplitude)?,
            })
        });
        let found = law.cycles(top, stop);
        Ok(Self {
            parameter: small.to_owned(),
            frequency: law.frequency,
            amplitude: largest.clone(),
            amplitude_rate: number(rates.amplitude)?,
            phase_rate: number(rates.phase)?,
            belt_speed: law.belt_speed,
            cycles: found.cycles.into_iter().map(cycle).collect::<Result<_, Error>>()?,
            touching: found.touching.into_iter().map(number).collect::<Result<_, Error>>()?,
            steady: found.steady,
            unresolved: found.unresolved,
            cell: found.cell,
            belt: law.belt.clone(),
            sticking: sticking.collect::<Result<_, Error>>()?,
        })
    }
}

impl FirstOrderCycle {
    fn new(law: &OnePhase, cycle: &PhaseCycle, eps: Option<f64>) -> Result<Self, Error> {
        let a = cycle.amplitude;
        let belt = law.belt_speed.map(|_| match (law.is_slower(a), eps) {
            (None, _) => Belt::Undecided,
            (Some(true), _) => Belt::Slower,
            (Some(false), None) => Belt::Overtakes,
            (Some(false), Some(eps)) => match law.sticks(a, eps) {
                Some(true) => Belt::Sticks,
                Some(false) => Belt::Overtakes,
                None => Belt::Undecided,
            },
        });
        let [exponent, error] = cycle.exponent;
        Ok(Self {
            amplitude: number(cycle.amplitude)?,
            exponent: number(cycle.exponent)?,
            phase_rate: number(cycle.phase)?,
            stable: (exponent.abs() > error).then_some(exponent < 0.0),
            belt,
        })
    }
}

impl Oscillator {
    /// The rates of first order at an amplitude, the cycles up to it, and the speeds of the belt at which one of them
    /// is as fast as the belt, where the speed is a parameter.
    ///
    /// Cost: some hundred integrals over the phase.
    ///
    /// # Errors
    /// [`Refused`] with the term that does not fit: forces, delays, walls, springs that are not linear.
    ///
    /// ```
    /// use lindstedt::{Exact, Oscillator, Work};
    /// // Van der Pol's law: a = 2, exponent -eps.
    /// let cycle = Oscillator::parse("x'' + x = eps*(1 - x^2)*x'")?;
    /// let found = cycle.first_order(&Exact::from(3), &Work::default())?.value;
    /// assert!(found.cycles.len() == 1 && found.cycles[0].amplitude.decimal.starts_with("2.00000000"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn first_order(&self, largest: &Exact, work: &Work) -> Result<Answer<FirstOrder>, Error> {
        let start = Instant::now();
        self.single()?;
        if self.problem().impact.is_some() {
            let message = "there is a wall; averaging over one phase takes none";
            return Err(Refused::no_answer("no-method", message, "").into());
        }
        let top = largest.to_f64();
        if !(top > 0.0 && top.is_finite()) {
            return Err(Refused::usage(
                "bad-value",
                "the amplitude must be positive",
                "--cycles 2",
            )
            .into());
        }
        let values = self.form_values(&[])?;
        let law = OnePhase::new(self.problem(), &values).map_err(|refusal| self.unfit(refusal))?;
        let eps = values.get(&*self.problem().small).map(Exact::to_f64);
        let value = FirstOrder::new((&self.problem().small, eps), &law, largest, &work.stop)?;
        let mut remarks = self.remarks().to_vec();
        let standing = if work.stop.asked() {
            remarks.push(Remark("stopped; cycles not reached are missing".to_owned()));
            Standing::Stopped { done: value.cycles.len() }
        } else if value.unresolved.is_empty() {
            Standing::Complete
        } else {
            Standing::Undecided
        };
        let header = self.header(values, Some(1), "estimated", start);
        Ok(Answer { header, value, standing, remarks })
    }
}
