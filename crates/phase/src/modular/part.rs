//! The part of a function that has one symmetry.

use super::fields::{PrimeFields, Residues};
use super::symmetry::Symmetry;
use super::transform::Transform;
use std::sync::{Arc, OnceLock};

/// The part of a function that has one of the symmetries, by Fourier coefficients or by the values at the
/// points, which determine each other; at least one of the two is there, and the function is not zero. Copies share
/// both: what is transformed in one is known to all.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub symmetry: Symmetry,
    pub forms: Arc<Forms>,
    pub transform: Arc<Transform>,
}

#[derive(Debug, Default)]
pub(super) struct Forms {
    /// The last coefficient does not vanish.
    pub coefficients: OnceLock<Vec<Residues>>,
    pub values: OnceLock<Vec<Residues>>,
}

impl Part {
    pub fn coefficients(&self) -> &[Residues] {
        self.forms.coefficients.get_or_init(|| {
            let values = self.forms.values.get().map_or(&[][..], Vec::as_slice);
            trimmed(self.transform.coefficients(self.symmetry, values))
        })
    }

    pub fn values(&self) -> &[Residues] {
        let values = || self.transform.values(self.symmetry, self.coefficients());
        self.forms.values.get_or_init(values)
    }

    /// Nothing if it vanishes.
    pub fn with_forms(
        &self,
        coefficients: Option<Vec<Residues>>,
        values: Option<Vec<Residues>>,
    ) -> Option<Self> {
        let coefficients = coefficients.map(trimmed);
        let known = coefficients.as_ref().or(values.as_ref())?;
        if known.iter().all(is_zero) {
            return None;
        }
        Some(Self {
            forms: Arc::new(Forms {
                coefficients: coefficients.map_or_else(OnceLock::new, OnceLock::from),
                values: values.map_or_else(OnceLock::new, OnceLock::from),
            }),
            ..self.clone()
        })
    }

    pub fn times(&self, field: &PrimeFields, c: &Residues) -> Option<Self> {
        let image = |list: &Vec<Residues>| field.combination(&[(list, *c)]);
        let Forms { coefficients, values } = &*self.forms;
        self.with_forms(coefficients.get().map(image), values.get().map(image))
    }

    /// sum_i c_i f_i over parts of one symmetry, in the form that needs the fewest transforms.
    pub fn combination(field: &PrimeFields, terms: &[(&Self, Residues)]) -> Option<Self> {
        let (first, _) = terms.first()?;
        let [no_coefficients, no_values] = lacking(terms.iter().map(|(part, _)| *part));
        let by_values = no_values == 0 && terms.len() <= SHORT || no_coefficients > no_values;
        let by_coefficients = no_coefficients == 0 || !by_values;
        let combine = |form: fn(&Self) -> &[Residues]| {
            let lists: Vec<_> = terms.iter().map(|(part, c)| (form(part), *c)).collect();
            field.combination(&lists)
        };
        let coefficients = by_coefficients.then(|| combine(Self::coefficients));
        first.with_forms(coefficients, by_values.then(|| combine(Self::values)))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        match (self.forms.values.get(), other.forms.values.get()) {
            (Some(a), Some(b)) => a == b,
            _ => self.coefficients() == other.coefficients(),
        }
    }
}

pub(super) fn is_zero(c: &Residues) -> bool {
    *c == Residues::default()
}

fn trimmed(mut list: Vec<Residues>) -> Vec<Residues> {
    list.truncate(list.iter().rposition(|c| !is_zero(c)).map_or(0, |last| last + 1));
    list
}

/// Values are combined beside the coefficients in sums of at most so many terms; in longer ones a
/// transform costs less.
const SHORT: usize = 8;

/// How many parts lack their coefficients, and how many their values.
pub(super) fn lacking<'a>(parts: impl Iterator<Item = &'a Part> + Clone) -> [usize; 2] {
    let no = |form: fn(&Forms) -> &OnceLock<Vec<Residues>>| {
        parts.clone().filter(|part| form(&part.forms).get().is_none()).count()
    };
    [no(|forms| &forms.coefficients), no(|forms| &forms.values)]
}
