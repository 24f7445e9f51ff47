//! The plain form of a slow flow.

use super::polar::{Polar, PolarTerm};
use super::{NormalMode, SlowFlow, Sought, SoughtBranch, Terms};
use lindstedt_coeff::print::Style;
use lindstedt_equation::{Condition, Problem};
use lindstedt_number::Object;
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::Rational;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// A monomial: the powers of its factors by name, and its coefficient.
#[derive(Serialize)]
struct Monomial<'a> {
    powers: Object<&'a str, i32>,
    re: String,
    im: String,
}

/// A term of a rate: coefficient * symbols * a^power * function(harmonic * gamma).
#[derive(Serialize)]
struct Wave<'a> {
    power: u32,
    harmonic: u32,
    function: Option<&'static str>,
    symbols: Object<&'a str, i32>,
    coefficient: String,
}

#[derive(Serialize)]
struct Nearest<'a> {
    order: usize,
    unknown: &'a str,
    harmonic: &'a [i32],
    size: String,
}

#[derive(Serialize)]
struct Residual {
    checked_orders: Option<usize>,
    zero: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    encloses_zero: Option<bool>,
}

impl Residual {
    /// Of exact orders; of enclosed ones nothing says that it is zero.
    fn of(checked_orders: Option<usize>, enclosed: bool) -> Self {
        let is = |kind: bool| checked_orders.filter(|_| kind).map(|_| true);
        Self { checked_orders, zero: is(!enclosed), encloses_zero: is(enclosed) }
    }
}

/// The phase of a force.
#[derive(Serialize)]
struct Force<'a> {
    rate: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<String>,
    detuning: Vec<Vec<Monomial<'a>>>,
}

impl<'a> Force<'a> {
    fn of(flow: &SlowFlow, names: &'a [String], l: usize) -> Self {
        let orders = flow.detuning.get(l).into_iter().flatten();
        Self {
            rate: flow.print_leading_rate(l, Style::Text),
            start: flow.print_start(l, Style::Text),
            detuning: orders.map(|terms| monomials(flow, names, terms)).collect(),
        }
    }
}

/// z_j' = i nu_j z_j + sum eps^n f_(j,n): by order from 1 the list of f_(j,n).
#[derive(Serialize)]
struct Flow<'a> {
    amplitudes: &'a [String],
    frequencies: &'a [String],
    forcing: Option<&'a str>,
    orders: Object<String, Vec<Vec<Monomial<'a>>>>,
}

/// The names of the factors of its monomials: z1, zbar1, z2, ... of any number of unknowns, E or E1, E2, ..., symbols.
fn plain_names(flow: &SlowFlow) -> Vec<String> {
    let amplitudes = (1..=flow.unknowns()).flat_map(|j| [format!("z{j}"), format!("zbar{j}")]);
    let others = flow.factors().into_iter().skip(2 * flow.unknowns());
    let phases = others.enumerate().map(|(n, name)| match n < flow.forces() {
        true => name.replace('_', ""),
        false => name,
    });
    amplitudes.chain(phases).collect()
}

fn powers<'a>(names: &'a [String], exponents: &[i32]) -> Object<&'a str, i32> {
    let all = names.iter().map(String::as_str).zip(exponents.iter().copied());
    Object(all.filter(|(_, n)| *n != 0).collect())
}

#[derive(Serialize)]
struct Invariant<'a> {
    form: Vec<Monomial<'a>>,
    orders: usize,
}

fn monomials<'a>(flow: &SlowFlow, names: &'a [String], terms: &Terms) -> Vec<Monomial<'a>> {
    let one = |t: &AmplitudeTerm| Monomial {
        powers: powers(names, &t.exponents),
        re: flow.number(&t.re),
        im: flow.number(&t.im),
    };
    terms.iter().map(one).collect()
}

fn waves<'a>(symbols: &'a [String], orders: &[Vec<PolarTerm>]) -> Vec<Vec<Wave<'a>>> {
    let one = |t: &PolarTerm| Wave {
        power: t.power,
        harmonic: t.harmonic,
        function: (t.harmonic > 0).then_some(if t.sine { "sin" } else { "cos" }),
        symbols: powers(symbols, &t.symbols),
        coefficient: t.coefficient.to_string(),
    };
    orders.iter().map(|terms| terms.iter().map(one).collect()).collect()
}

/// The unknown that a row of shapes is of.
fn row_names(problem: &Problem, rows: usize) -> Vec<String> {
    (0..rows).map(|j| problem.unknown(j)).collect()
}

impl Serialize for NormalMode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let texts = |list: &[Rational]| list.iter().map(|q| self.number(q)).collect::<Vec<_>>();
        let orders = |list: &[Terms]| -> Vec<String> {
            list.iter().map(|terms| self.print_order(terms, Style::Text)).collect()
        };
        let shape = |list: &Vec<Terms>| -> Vec<String> {
            list.iter().map(|terms| self.print_shape(terms, Style::Text)).collect()
        };
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("mode", &self.mode)?;
        map.serialize_entry("square", &self.print_square(Style::Text))?;
        map.serialize_entry("ratios", &texts(&self.ratios))?;
        let shapes: Vec<_> = self.shapes.iter().map(|row| texts(row)).collect();
        map.serialize_entry("shapes", &shapes)?;
        map.serialize_entry("shape_rows", &row_names(&self.problem, shapes.len()))?;
        map.serialize_entry("symbols", &self.symbols)?;
        map.serialize_entry("frequency_squared", &orders(&self.frequency_squared))?;
        map.serialize_entry("growth_rate", &orders(&self.growth))?;
        map.serialize_entry("solution", &self.solution.iter().map(shape).collect::<Vec<_>>())?;
        if let Some(enclosed) = self.enclosed {
            map.serialize_entry("radius", &enclosed.radius)?;
            map.serialize_entry("residual_radius", &enclosed.residual)?;
        }
        let residual = Residual::of(self.checked_orders, self.enclosed.is_some());
        map.serialize_entry("residual", &residual)?;
        map.serialize_entry("method", &Object(vec![("name", "averaging at resonance")]))?;
        map.end()
    }
}

/// One motion of a parameter that is sought.
#[derive(Serialize)]
struct Branch {
    starts_with: String,
    origin: String,
    series: Vec<String>,
    solution: Vec<String>,
    residual: Residual,
}

impl Serialize for Sought {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let branch = |branch: &SoughtBranch| Branch {
            starts_with: branch.starts_with(),
            origin: branch.origin.clone(),
            series: branch.series.iter().map(|t| self.print_coefficient(t, Style::Text)).collect(),
            solution: branch.solution.iter().map(|t| self.print_motion(t, Style::Text)).collect(),
            residual: Residual::of(branch.checked_orders, false),
        };
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("unknown", &self.parameter)?;
        map.serialize_entry("frequency", &self.frequency.to_string())?;
        map.serialize_entry("symbols", &self.symbols)?;
        map.serialize_entry("branches", &self.branches.iter().map(branch).collect::<Vec<_>>())?;
        map.serialize_entry("all", &self.all)?;
        map.serialize_entry("method", &Object(vec![("name", "Lindstedt-Poincare")]))?;
        map.end()
    }
}

impl Serialize for SlowFlow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (system, names) = (&self.system, plain_names(self));
        let of_modes =
            |list: &Vec<Rational>| list.iter().map(|q| self.number_of_modes(q)).collect::<Vec<_>>();
        let lists = |orders: &[Vec<Terms>]| -> Vec<Vec<Vec<Monomial<'_>>>> {
            let unknown =
                |list: &Vec<Terms>| list.iter().map(|t| monomials(self, &names, t)).collect();
            orders.iter().map(unknown).collect()
        };
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("normalisation", &Condition::FreeAmplitude)?;
        map.serialize_entry("unknowns", &self.coordinates())?;
        let frequency = |nu: &Rational| match self.enclosed {
            Some(_) => self.number(nu),
            None => self.print_multiple(nu, Style::Text),
        };
        let frequencies: Vec<_> = system.frequencies.iter().map(frequency).collect();
        if let Some(unit) = &system.unit {
            map.serialize_entry("unit", &unit.name)?;
        }
        map.serialize_entry("frequencies", &frequencies)?;
        if let Some(enclosed) = self.enclosed {
            map.serialize_entry("squares", &of_modes(&system.squares))?;
            map.serialize_entry("radius", &enclosed.radius)?;
            map.serialize_entry("residual_radius", &enclosed.residual)?;
        }
        let shapes = system.shapes.as_ref();
        let shapes = shapes.map(|rows| rows.iter().map(of_modes).collect::<Vec<_>>());
        map.serialize_entry("shapes", &shapes)?;
        if let Some(shapes) = &shapes {
            map.serialize_entry("shape_rows", &row_names(&self.problem, shapes.len()))?;
        }
        let forces: Vec<_> = (0..system.forces.len()).map(|l| Force::of(self, &names, l)).collect();
        match &forces[..] {
            [] => map.serialize_entry("force", "0")?,
            [only] => {
                map.serialize_entry("force", &only.rate)?;
                if let Some(start) = &only.start {
                    map.serialize_entry("start", start)?;
                }
            }
            several => map.serialize_entry("forces", several)?,
        }
        if let [] | [_] = &forces[..] {
            let detuning = forces.first().map(|force| &force.detuning[..]).unwrap_or_default();
            map.serialize_entry("detuning", detuning)?;
        }
        if !system.independent.is_empty() {
            map.serialize_entry("independent", &system.independent)?;
        }
        let beside = system.beside.as_ref();
        let beside = beside.map(|b| (b.symbol.as_str(), self.print_multiple(&b.rate, Style::Text)));
        map.serialize_entry("beside", &beside.map(|pair| Object(vec![pair])))?;
        map.serialize_entry("symbols", &system.symbols)?;
        let orders = (1..self.flow.first().map_or(0, Vec::len)).map(|n| {
            let of = |unknown: &Vec<Terms>| monomials(self, &names, &unknown[n]);
            (n.to_string(), self.flow.iter().map(of).collect::<Vec<_>>())
        });
        let flow = Flow {
            amplitudes: &names[..2 * self.unknowns()],
            frequencies: &frequencies,
            forcing: match &forces[..] {
                [] => Some("0"),
                [only] => Some(&only.rate),
                _ => None,
            },
            orders: Object(orders.collect()),
        };
        map.serialize_entry("slow_flow", &flow)?;
        map.serialize_entry("solution", &lists(&self.solution))?;
        if !self.energy.is_empty() {
            let energy: Vec<_> = self.energy.iter().map(|t| monomials(self, &names, t)).collect();
            map.serialize_entry("energy", &energy)?;
        }
        let forms = self.quadratic_invariants().into_iter().map(|form| {
            let terms = monomials(self, &names, &form.terms);
            Invariant { form: terms, orders: form.orders }
        });
        let forms: Vec<_> = forms.collect();
        if !forms.is_empty() {
            map.serialize_entry("quadratic_invariants", &forms)?;
        }
        if let Some(Polar { slow, amplitude, phase }) = self.polar() {
            map.serialize_entry("slow_phase", &slow)?;
            let [amplitude, phase] = [amplitude, phase].map(|list| waves(&system.symbols, &list));
            let rates = vec![("amplitude_rate", amplitude), ("phase_rate", phase)];
            map.serialize_entry("polar", &Object(rates))?;
        }
        let unknowns = self.coordinates();
        let near = self.nearest.iter().map(|near| Nearest {
            order: near.order,
            unknown: &unknowns[near.unknown],
            harmonic: &near.harmonic,
            size: self.size(&near.size),
        });
        let list: Vec<_> = near.collect();
        map.serialize_entry("nearest", &list)?;
        let residual = Residual::of(self.checked_orders, self.enclosed.is_some());
        map.serialize_entry("residual", &residual)?;
        map.serialize_entry("method", &Object(vec![("name", "averaging at resonance")]))?;
        map.end()
    }
}
