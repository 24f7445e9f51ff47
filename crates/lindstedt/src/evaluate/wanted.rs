//! Which orbit of which polynomial field a case asks for, and how x follows from it.

use super::turn::TimeDomain;
use crate::refusal::{Refusal, Refused};
use crate::{Error, Exact, Oscillator};
use lindstedt_algebra::Stop;
use lindstedt_equation::print::Style;
use lindstedt_equation::{AmplitudeRole, Condition, Expression};
use lindstedt_evaluation::setting::check_names;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Failure, Field, Kind, Sine, Start};
use rug::Rational;
use std::collections::BTreeMap;

/// A field, which orbit of it is meant, and how x follows from its unknown.
pub(crate) struct Wanted {
    pub field: Field,
    pub kind: Kind,
    /// The unknown is sin(q y/2) with x = factor y.
    sine: Option<(Sine, Rational)>,
    /// y(0).
    angle: Option<Rational>,
    /// The motion in closed form, in doubles.
    pub closed: Option<Start>,
}

impl Wanted {
    /// Whether the unknown is not x itself.
    pub fn is_substituted(&self) -> bool {
        self.sine.is_some()
    }

    pub fn is_forced(&self) -> bool {
        matches!(self.kind, Kind::Forced(_))
    }

    /// The first guess: the closed form of a pendulum, else the motion in the time domain.
    pub fn start(&self, motion: &TimeDomain<'_>, stop: &Stop) -> Result<Start, Error> {
        self.closed.clone().map_or_else(|| motion.start(stop), Ok)
    }

    /// (x, x') where the unknown and its derivative are known.
    pub fn state(&self, (u, rate): (Ball, Ball)) -> Option<(Ball, Ball)> {
        let Some((sine, factor)) = &self.sine else { return Some((u, rate)) };
        let (y, velocity) = sine.state(&u, &rate)?;
        let balls = Balls::new(u.midpoint().prec());
        let times = |ball: &Ball| balls.mul_rational(ball, factor);
        Some((times(&y), times(&velocity)))
    }
}

impl Oscillator {
    /// The polynomial field with its values and which orbit of it is meant, its data known to so many
    /// digits. A small parameter that has the amplitude in it is, in the equation of x itself, its
    /// other part.
    pub(crate) fn wanted(&self, digits: u32) -> Result<Wanted, Error> {
        let (problem, values) = (self.problem(), self.coefficients_of_proof()?);
        let amplitude = || values.get("amplitude").cloned().unwrap_or_else(|| Rational::from(1));
        let condition = self.condition_of_proof();
        let initial = matches!(condition, None | Some(Condition::InitialAmplitude));
        let equation = problem.time_domain.as_ref().unwrap_or(&problem.equation);
        let single = || initial && problem.others.is_empty();
        if let Some(sine) = Sine::of(equation, &problem.small, &values).filter(|_| single()) {
            // Its equation is in y = x/a.
            let scaled = problem.amplitude == AmplitudeRole::InSums;
            let one = || Rational::from(1);
            let (start, factor) = if scaled { (one(), amplitude()) } else { (amplitude(), one()) };
            let (field, kind) =
                sine.field(&start, digits).map_err(|failure| self.unproved(failure))?;
            let closed = Some(sine.start(&start));
            let angle = Some(start);
            return Ok(Wanted { field, kind, sine: Some((sine, factor)), angle, closed });
        }
        let field =
            Field::of_problem(problem, &values).map_err(|failure| self.unproved(failure))?;
        // A force whose frequency is set to 0 is a constant: what is free in a forced equation is not free in this one.
        let still = field.is_autonomous() && equation.contains(&Expression::Time);
        let drifts = |condition: &Condition| *condition == Condition::FreeAmplitude;
        let asked = self.asked_condition().is_some();
        let kind = match condition.filter(|condition| asked || !still || !drifts(condition)) {
            _ if !field.is_autonomous() => Kind::Forced(1),
            None if field.is_reversible() => Kind::InitialAmplitude(amplitude()),
            None => Kind::LimitCycle,
            Some(Condition::FreeAmplitude) => {
                let message = "an amplitude that drifts belongs to no periodic orbit";
                return Err(Refused::no_answer("no-proof", message, "`evaluate --start`").into());
            }
            Some(Condition::LimitCycle) => Kind::LimitCycle,
            Some(Condition::FundamentalAmplitude) => Kind::FundamentalAmplitude(amplitude()),
            _ => Kind::InitialAmplitude(amplitude()),
        };
        Ok(Wanted { field, kind, sine: None, angle: None, closed: None })
    }

    /// The rational values of all names in the equation of x itself.
    pub(super) fn coefficients_of_proof(&self) -> Result<BTreeMap<String, Rational>, Error> {
        let mut values: BTreeMap<String, Rational> = self
            .values_of_proof()?
            .into_iter()
            .filter_map(|(name, value)| Some((name, value.as_rational()?.clone())))
            .collect();
        let problem = self.problem();
        if problem.amplitude == AmplitudeRole::InSmallParameter {
            let cards = problem.parameters.iter().filter(|card| card.name != "amplitude");
            let part = cards.filter_map(|card| values.get(&*card.name)).next().cloned();
            if let Some(part) = part {
                values.entry(problem.small.to_string()).or_insert(part);
            }
        }
        Ok(values)
    }

    /// The values that enter, with what those set determine (n of a power law gives delta). An equation that
    /// is not expanded needs no more than what is set.
    pub(crate) fn values_of_proof(&self) -> Result<Vec<(String, Exact)>, Error> {
        if self.has_expansion() {
            return Ok(self.setting()?.at);
        }
        let mut given = self.given().clone();
        given.remove("amplitude");
        check_names(self.problem(), &given)?;
        Ok(self.all_values())
    }

    /// Whether there is a series whose sum is a guess.
    pub(crate) fn has_expansion(&self) -> bool {
        let fixed = self.condition().is_some_and(|c| c != Condition::FreeAmplitude);
        fixed && self.problem().others.is_empty() && self.check().is_ok()
    }

    /// The condition; nothing where it only says that the equation is not expanded.
    fn condition_of_proof(&self) -> Option<Condition> {
        if !self.problem().others.is_empty() {
            return self.asked_condition();
        }
        let drifts = self.condition() == Some(Condition::FreeAmplitude);
        let asked = self.asked_condition().is_some() || self.check().is_ok();
        self.condition().filter(|_| asked || !drifts)
    }

    fn unproved(&self, failure: Failure) -> Error {
        match failure {
            Failure::NoValue(name) => self.unset(&name),
            Failure::NotSmooth(ref e) => {
                // What has no expansion has no estimate, either.
                let hint = self.check().map_or_else(|error| error.hint(), |()| failure.hint());
                let show = |e: &Expression| e.print(&self.problem().small, Style::Text);
                let message = format!("{} is not smooth at {} = 0", show(e), show(corner(e)));
                Refused::no_answer("no-proof", message, hint).into()
            }
            other => other.into(),
        }
    }
}

/// What vanishes where an expression is not smooth.
fn corner(e: &Expression) -> &Expression {
    match e {
        Expression::Power(base, _) | Expression::Function(_, base) => corner(base),
        other => other,
    }
}

/// A question for all values of a parameter between two numbers.
pub(crate) struct Between<'a> {
    pub name: &'a str,
    pub ends: &'a [Rational; 2],
    /// The case at either end.
    pub low: &'a Oscillator,
    pub high: &'a Oscillator,
}

/// Digits of the data of a uniform question, which is about an interval.
const FEW_DIGITS: u32 = 20;

impl Between<'_> {
    /// The field with the interval for a coefficient, or the amplitude within the interval. Only one of
    /// both may vary, and only one name of the equation.
    pub fn question(&self) -> Result<(Field, Kind), Failure> {
        let wanted = [self.low, self.high].map(|case| case.wanted(FEW_DIGITS).ok());
        let [Some(low), Some(high)] = wanted else { return Err(Failure::NotOneNumber) };
        if let (Some((sine, _)), Some((other, _))) = (&low.sine, &high.sine) {
            // Between the ends of another parameter the sine may be any other.
            if self.name != "amplitude" {
                return Err(Failure::NotOneNumber);
            }
            let starts = [&low.angle, &high.angle];
            let [Some(start), Some(end)] = starts else { return Err(Failure::NotOneNumber) };
            return sine.between(start, (other, end));
        }
        let values = [self.low, self.high].map(|case| case.coefficients_of_proof().ok());
        let [Some(first), Some(last)] = values else { return Err(Failure::NotOneNumber) };
        let problem = self.low.problem();
        let first_one = problem.time_domain.as_ref().unwrap_or(&problem.equation);
        let holds = |part: &Expression| {
            first_one.contains(part) || problem.others.iter().any(|e| e.contains(part))
        };
        let occurs = |name: &str| {
            holds(&Expression::parameter(name))
                || (*name == *problem.small && holds(&Expression::Small))
        };
        let mut varying = first.iter().filter(|(name, value)| last.get(*name) != Some(value));
        let varying = varying.by_ref().filter(|(name, _)| occurs(name));
        let varying: Vec<&str> = varying.map(|(name, _)| name.as_str()).collect();
        let kind = if low.kind == high.kind {
            Some(low.kind.clone())
        } else {
            low.kind.between(self.ends)
        };
        let kind = kind.ok_or(Failure::NotOneNumber)?;
        match varying[..] {
            [] if low.kind == high.kind || self.name == "amplitude" => Ok((low.field, kind)),
            [name] if low.kind == high.kind => {
                let same = [&first, &last].map(|values| values.get(name))
                    == [&self.ends[0], &self.ends[1]].map(Some);
                if !same {
                    return Err(Failure::NotOneNumber);
                }
                Ok((Field::between(problem, &first, name, self.ends)?, kind))
            }
            _ => Err(Failure::NotOneNumber),
        }
    }
}
