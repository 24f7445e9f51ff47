//! What was done, in words.

use crate::names::{method_name, short, with_error};
use crate::period::Evaluation;
use lindstedt_number::Number;
use lindstedt_series::resummation::{Growth, ResummationError, Resummed};
use rug::Float;

impl Evaluation {
    /// What was done and why, in one or two sentences, with what the series alone has for an estimate.
    pub(crate) fn describe(&self, estimate: Option<&Number>) -> String {
        let outcome = &self.resummed.outcome;
        let mut parts = Vec::new();
        let name = &self.variable;
        parts.push(match (self.radius, self.resummed.growth) {
            (Some((0.0, why)), _) => {
                format!("the series in {name} diverges for every {name} but 0 ({why}): it is asymptotic")
            }
            (Some((radius, why)), _) => {
                format!("the series in {name} has radius of convergence {radius} ({why})")
            }
            (None, Growth::Factorial { rate }) => format!(
                "the series in {name} seems to diverge for every {name} but 0 (coefficients grow like \
                 n!^{rate:.1}): asymptotic"
            ),
            (None, Growth::Entire) => {
                format!("the coefficients in {name} fall like those of an entire function")
            }
            _ => match self.estimated_radius() {
                Some((radius, error)) => {
                    let radius = with_error(radius, error);
                    format!("the series in {name} has radius of convergence {radius} (estimated)")
                }
                None => "too few coefficients to estimate the radius of convergence".to_owned(),
            },
        });
        if let Some((order, number)) = &self.best_truncation {
            let value = number
                .as_ref()
                .map_or_else(String::new, |n| format!(", which gives {}", n.decimal));
            parts.push(format!("best truncation at order {order}{value}"));
        }
        let method = method_name(self.resummed.method);
        let degrees = outcome.degrees.map_or_else(String::new, |(l, m)| format!(" [{l}/{m}]"));
        let choice = self.choice();
        let order = self.order;
        let error = self.true_error.as_deref();
        let measured = error.map(|error| format!("; against the closed form the error is {error}"));
        let measured = measured.unwrap_or_default();
        parts.push(match estimate {
            Some(Number { error: Some(error), .. }) => {
                format!("summed by {method}{degrees}{choice}, estimated error {error}")
            }
            _ if self.no_estimate => format!(
                "{method}{degrees} of order {order}, no estimate from so few coefficients{measured}"
            ),
            _ => format!(
                "{method}{degrees} gives not one digit by its estimate: neighbouring approximants do not agree{measured}"
            ),
        });
        parts.join("; ")
    }

    /// The radius of convergence and its error, both estimated, where the coefficients have one:
    /// the modulus of the nearest singularity where that is found and agrees with the slope of
    /// log |c_n|, else that slope.
    #[must_use]
    pub fn estimated_radius(&self) -> Option<(f64, f64)> {
        let found = self.resummed.singularity.as_ref();
        // The disagreement of a few approximants is no bound: twice as much.
        let modulus = found.map(|s| (s.at.abs().to_f64(), 2.0 * s.error.to_f64()));
        match self.resummed.growth {
            Growth::Radius { radius, error } => {
                let agrees = |pair: &(f64, f64)| (pair.0 - radius).abs() <= error + pair.1;
                Some(modulus.filter(agrees).unwrap_or((radius, error)))
            }
            Growth::Undecided => modulus,
            _ => None,
        }
    }

    /// Why the method was taken, where there was a choice.
    fn choice(&self) -> String {
        let Resummed { tried, method, outcome, .. } = &self.resummed;
        let errors = || tried.iter().filter_map(|(m, e)| Some((m, e.as_ref().ok()?)));
        let finite = || errors().filter(|(_, error)| error.is_finite());
        let Some((_, own)) = errors().find(|(m, _)| *m == method).filter(|_| tried.len() > 1)
        else {
            return String::new();
        };
        let count = finite().count();
        let floor = Float::with_val(53, outcome.estimate.value.abs_ref()) >> self.accuracy;
        if count == 1 {
            format!(", the only one of {} methods with an error estimate", tried.len())
        } else if *own <= floor {
            format!(
                ", the simplest of {} methods whose error is below the working precision",
                tried.len()
            )
        } else if finite().all(|(_, error)| own <= error) {
            format!(", the least error estimate of {count} methods")
        } else {
            let least = finite().map(|(_, error)| error.clone()).reduce(|a, b| a.min(&b));
            let near = least.map_or(count, |least| {
                let bound = least * 10u32;
                finite().filter(|(_, error)| **error <= bound).count()
            });
            format!(
                ", the simplest of {near} methods whose error estimate is within a factor 10 of \
                 the least"
            )
        }
    }

    /// Whether the coefficients are too few for an estimate of the error; the error of the period,
    /// if there is one, is then measured by the closed form.
    #[must_use]
    pub fn has_no_estimate(&self) -> bool {
        self.no_estimate
    }

    /// Why a method gave nothing, or its error estimate relative to 2 pi times the factor.
    #[must_use]
    pub fn tried(&self) -> Vec<(&'static str, String)> {
        let text = |found: &Result<Float, ResummationError>| match found {
            Ok(error) if error.is_finite() => short(error),
            Ok(_) => "no estimate".to_owned(),
            Err(reason) => reason.to_string(),
        };
        self.resummed.tried.iter().map(|(m, found)| (method_name(*m), text(found))).collect()
    }
}
