//! Slow flows over quotients of polynomials in independent frequencies: those of forces that have no value.

use super::flow::Job;
use super::{SlowFlow, Terms, collected};
use crate::error::DerivationError as Error;
use crate::work::Progress;
use lindstedt_coeff::parameters::{LinearForm, ParameterField, ParameterFraction};
use lindstedt_coeff::polynomial::{PolynomialRing, Symbol};
use lindstedt_coeff::print::{Style, Term, print_sum};
use lindstedt_equation::Expression;
use lindstedt_number::Whole;
use lindstedt_phase::amplitudes::scalars::Over;
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes};
use rug::{Integer, Rational};
use std::collections::{BTreeMap, BTreeSet};

/// The slow flow of a system with independent frequencies.
pub(super) fn derived(
    job: &Job<'_>,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<SlowFlow, Error> {
    let unit = job.system.unit.iter().map(|unit| &unit.name);
    let names: Vec<String> = unit.chain(&job.system.independent).cloned().collect();
    let field = ParameterField {
        ring: PolynomialRing { parameters: names.clone() },
        pairs: vec![],
        affine: true,
    };
    let parameter = |i: usize| Some(field.parameter(u16::try_from(i).ok()?));
    let generators = (0..names.len()).filter_map(parameter).map(|e| (e, Whole::ONE));
    let rates = job.rates(generators.collect());
    let named: Vec<_> = names.iter().map(|name| Expression::parameter(name)).collect();
    let known = |name: &str| parameter(names.iter().position(|known| known == name)?);
    let run = job.run(Over::exact(field.clone()), (rates, &named), &known, observer)?;
    let all = run.found.flow.iter().chain(&run.found.solution).flatten();
    let quotients = Quotients::of(&run.algebra, all, &field);
    let terms = |f: &_| quotients.terms(&run.algebra, f);
    let mut flow = job.finished(&run, &terms);
    flow.system.symbols.extend(names.into_iter().chain(quotients.names()));
    Ok(flow)
}

/// The sums of rates by which the coefficients of a flow are divided.
struct Quotients<'a> {
    field: &'a ParameterField,
    forms: Vec<LinearForm>,
}

/// Exponents with the real and the imaginary part.
type Parts = BTreeMap<Vec<i32>, [Rational; 2]>;

impl<'a> Quotients<'a> {
    fn of<'b>(
        algebra: &Amplitudes<Over<ParameterField>>,
        all: impl Iterator<Item = &'b AmplitudeElement<ParameterFraction>>,
        field: &'a ParameterField,
    ) -> Self {
        let mut forms = BTreeSet::new();
        let read =
            |e: &ParameterFraction, _: &Whole| e.denominator().keys().cloned().collect::<Vec<_>>();
        for f in all {
            let lists = algebra.terms_as(f, &read).into_iter().flat_map(|(_, parts)| parts);
            forms.extend(lists.flatten());
        }
        Self { field, forms: forms.into_iter().collect() }
    }

    /// `(1 - omega)`.
    fn names(&self) -> Vec<String> {
        let name = |index: &Option<u16>| {
            let known = index.and_then(|i| self.field.ring.parameters.get(usize::from(i)));
            known.cloned()
        };
        let term = |(index, n): &(Option<u16>, Integer)| Term {
            coefficient: Rational::from(n),
            factors: name(index).into_iter().collect(),
        };
        let form = |form: &LinearForm| {
            let sum = print_sum(&form.iter().map(term).collect::<Vec<_>>(), Style::Text);
            format!("({sum})")
        };
        self.forms.iter().map(form).collect()
    }

    /// The terms with the exponents of the independent parameters and of the sums behind those of the symbols.
    fn terms(
        &self,
        algebra: &Amplitudes<Over<ParameterField>>,
        f: &AmplitudeElement<ParameterFraction>,
    ) -> Terms {
        let mut sum = Parts::new();
        let read = |e: &ParameterFraction, _: &Whole| e.clone();
        for (exponents, parts) in algebra.terms_as(f, &read) {
            for (k, part) in parts.iter().enumerate() {
                let power = |form| part.denominator().get(form).copied().unwrap_or(0);
                let below = self.forms.iter().map(|form| -power(form).cast_signed());
                for (m, c) in part.numerator().terms() {
                    let mut own = vec![0; self.field.ring.parameters.len()];
                    for (symbol, n) in m.factors() {
                        if let Symbol::Parameter(i) = symbol {
                            own[usize::from(*i)] = i32::from(*n);
                        }
                    }
                    let key: Vec<i32> =
                        exponents.iter().copied().chain(own).chain(below.clone()).collect();
                    sum.entry(key).or_default()[k] += c;
                }
            }
        }
        collected(sum)
    }
}
