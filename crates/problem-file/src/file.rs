//! From the text of a problem file to a problem.

use crate::error::{ParseError, ParseErrorKind, excerpt, position};
use crate::file_error::{FileError, FileErrorKind, RoleReason};
use crate::grammar::{locate, parse_equation, parse_expression};
use crate::history::{History, is_range, ranges, start};
use crate::names::{Names, canonical_name, is_parameter_name};
use crate::reader::Reader;
use crate::schema::Schema;
use lindstedt_equation::print::Style;
use lindstedt_equation::{
    AccelerationFault, AmplitudeRole, Condition, Crossing, Expression, Impact, ParameterCard,
    Problem, Synchronous,
};
use std::collections::{BTreeMap, BTreeSet};
use toml::Spanned;

/// Bytes of a problem file; look at the size of a file before reading it.
pub const LARGEST_FILE: u64 = 256 * 1024;

/// A problem with everything that its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct ProblemFile {
    /// The problem; parameters with an order are multiplied by the small parameter to that power.
    pub problem: Problem,
    /// Units as text, by parameter.
    pub units: BTreeMap<String, String>,
    /// Parameters of the equation that are determined by others, with how.
    pub follows: BTreeMap<String, String>,
    /// x(0) and x'(0) as exact text.
    pub initial: Option<[String; 2]>,
    /// The motion before t = 0, and as it was written.
    pub history: Option<(History, String)>,
    /// Parameters that are held fixed.
    pub fixed: Vec<String>,
    /// Parameters that are swept.
    pub swept: Vec<String>,
    /// LO..HI:COUNT of those of `swept` that have a range.
    pub ranges: BTreeMap<String, String>,
    /// Quantities that are asked for.
    pub asked: Vec<String>,
    /// Parameters that are declared and occur nowhere.
    pub unused: Vec<String>,
    /// The names that the equation may mention.
    pub names: Names,
    /// The equation as it was written.
    pub equation: String,
    /// Where it starts, in bytes of the file; nothing when it contains escapes.
    start: Option<usize>,
    text: String,
}

/// The names of the conditions.
pub const CONDITIONS: [(&str, Condition); 4] = [
    ("initial-amplitude", Condition::InitialAmplitude),
    ("fundamental-amplitude", Condition::FundamentalAmplitude),
    ("limit-cycle", Condition::LimitCycle),
    ("free-amplitude", Condition::FreeAmplitude),
];

/// The names of the ways in which an amplitude enters.
pub const AMPLITUDES: [(&str, AmplitudeRole); 6] = [
    ("scaled", AmplitudeRole::Scaled),
    ("scales-frequency", AmplitudeRole::ScalesFrequency { exponent: 2 }),
    ("in-sums", AmplitudeRole::InSums),
    ("in-small-parameter", AmplitudeRole::InSmallParameter),
    ("determined", AmplitudeRole::Determined),
    ("free", AmplitudeRole::Free),
];

/// Quantities that can be asked for.
const ASKED: &str = "frequency, frequency_squared, period_over_2pi, amplitude, \
                     initial_displacement, growth_rate, solution";

/// The condition that suits an equation: a free amplitude with t or a delay, a given amplitude
/// where the form shows that none drifts, a limit cycle otherwise.
pub fn usual_condition(equation: &Expression) -> Condition {
    let outside = |e: &Expression| matches!(e, Expression::Time | Expression::Delayed(..));
    if equation.find(&outside).is_some() {
        Condition::FreeAmplitude
    } else if lindstedt_equation::symmetry::is_reversible(equation) {
        Condition::InitialAmplitude
    } else {
        Condition::LimitCycle
    }
}

/// Why an amplitude cannot enter in this way. The roles of the built-in problems are claims about
/// the equation, and a claim is checked.
fn misplaced(
    role: AmplitudeRole,
    equation: &Expression,
    small: &str,
    declared: &BTreeSet<String>,
) -> Option<RoleReason> {
    match role {
        AmplitudeRole::ScalesFrequency { .. } => {
            let equation = equation.smooth_powers().canonical();
            let fits = |e: &&Expression| **e == Expression::Acceleration || is_power_law(e);
            let odd = equation.terms().iter().find(|e| !fits(e))?;
            Some(RoleReason::Scaling { term: excerpt(&odd.print(small, Style::Text)) })
        }
        AmplitudeRole::InSmallParameter => {
            let mentioned = equation.parameters();
            let free = declared.iter().filter(|name| !mentioned.contains(*name));
            let others = free.filter(|name| *name != "amplitude").count();
            (others != 1 || !declared.contains("amplitude")).then_some(RoleReason::Parts)
        }
        _ => None,
    }
}

/// Whether a term is c x (x^2)^small with c free of x, so that x = a y makes it a (a^2)^small times as
/// large.
fn is_power_law(term: &Expression) -> bool {
    let factors = match term {
        Expression::Product(list) => list.clone(),
        other => vec![other.clone()],
    };
    let x = Expression::Displacement;
    let power = x.clone().pow(2).pow(Expression::Small).canonical();
    let moving = |e: &&Expression| {
        e.find(&|e| matches!(e, Expression::Displacement | Expression::Velocity)).is_some()
    };
    let mut moving: Vec<&Expression> = factors.iter().filter(moving).collect();
    moving.sort_by_key(|e| **e != x);
    moving == [&x, &power]
}

/// How the amplitude enters under a condition.
pub fn usual_amplitude(condition: Option<&Condition>) -> AmplitudeRole {
    match condition {
        Some(Condition::LimitCycle) => AmplitudeRole::Determined,
        Some(Condition::FreeAmplitude) | None => AmplitudeRole::Free,
        Some(_) => AmplitudeRole::Scaled,
    }
}

impl ProblemFile {
    /// Reads a problem file.
    ///
    /// # Errors
    /// [`FileError`] with line and column.
    ///
    /// # Example
    /// ```
    /// use lindstedt_problem_file::ProblemFile;
    /// let file = ProblemFile::parse(
    ///     r#"
    ///     name = "cubic"
    ///     equation = "x'' + x + eps*k*x^3 = 0"
    ///     [parameters]
    ///     k = { value = "1/3", meaning = "cubic stiffness" }
    ///     "#,
    /// )?;
    /// assert_eq!(file.problem.small, "eps");
    /// assert_eq!(file.problem.parameters[0].default, "1/3");
    /// # Ok::<(), lindstedt_problem_file::FileError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        if text.len() as u64 > LARGEST_FILE {
            return Err(reader.error(FileErrorKind::TooLarge { limit: LARGEST_FILE }, 0));
        }
        let schema: Schema = toml::from_str(text).map_err(|error| {
            let message = excerpt_long(error.message());
            let at = error.span().map_or(0, |span| span.start);
            reader.error(FileErrorKind::Toml { message }, at)
        })?;
        read(&reader, schema)
    }

    /// Line and column of a term of the equation; nothing if it cannot be found.
    pub fn locate(&self, term: &Expression) -> Option<(usize, usize)> {
        let found = locate(&self.equation, &self.names, term)?;
        Some(position(&self.text, self.start? + found.start))
    }

    /// Line and column of the equation; nothing when it contains escapes.
    pub fn locate_equation(&self) -> Option<(usize, usize)> {
        Some(position(&self.text, self.start?))
    }
}

/// A message of another library in one line of limited length. It begins with what stands in the
/// file, which may be long, and ends with what is expected, which is not: it is cut in the middle.
fn excerpt_long(text: &str) -> String {
    const BEGIN: usize = 80;
    const END: usize = 280;
    let one_line: Vec<char> = text.replace('\n', ", ").chars().collect();
    if one_line.len() <= BEGIN + END {
        return one_line.into_iter().collect();
    }
    let [begin, end] = [&one_line[..BEGIN], &one_line[one_line.len() - END..]];
    begin.iter().chain(&['.'; 3]).chain(end).collect()
}

fn read(reader: &Reader<'_>, schema: Schema) -> Result<ProblemFile, FileError> {
    let name = schema.name.get_ref();
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || name.len() > 40 || !name.chars().all(plain) || name.starts_with('-') {
        let kind = FileErrorKind::Name { name: excerpt(name), what: "problem" };
        return Err(reader.error(kind, schema.name.span().start));
    }
    let small = match &schema.small {
        None => "eps".to_owned(),
        Some(small) => {
            let canonical = canonical_name(small.get_ref());
            if !is_parameter_name(&canonical) {
                let name = excerpt(small.get_ref());
                let kind = FileErrorKind::Name { name, what: "small parameter" };
                return Err(reader.error(kind, small.span().start));
            }
            canonical
        }
    };
    let (mut cards, mut units, mut follows) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
    let mut declared = BTreeSet::new();
    for (key, parameter) in &schema.parameters.0 {
        let name = canonical_name(key.get_ref());
        if !is_parameter_name(&name) {
            let kind = FileErrorKind::Name { name: excerpt(key.get_ref()), what: "parameter" };
            return Err(reader.error(kind, key.span().start));
        }
        if !declared.insert(name.clone()) {
            return Err(reader.error(FileErrorKind::Twice { name }, key.span().start));
        }
        if !parameter.unit.is_empty() {
            units.insert(name.clone(), parameter.unit.clone());
        }
        if let (Some(how), None) = (&parameter.follows, &parameter.value) {
            follows.insert(name, how.clone());
            continue;
        }
        let default = parameter.value.as_ref().map(|v| reader.value(v)).transpose()?;
        let default = default.unwrap_or_default();
        let meaning = parameter.meaning.clone();
        cards.push(ParameterCard {
            name: name.into(),
            meaning: meaning.into(),
            default: default.into(),
        });
    }
    let mut names = Names::only(&small, declared.iter().map(String::as_str));
    for formal in &schema.formal {
        let name = canonical_name(formal.get_ref());
        if !is_parameter_name(&name) {
            let kind =
                FileErrorKind::Name { name: excerpt(formal.get_ref()), what: "formal function" };
            return Err(reader.error(kind, formal.span().start));
        }
        names.formal.insert(name);
    }
    let orders = orders(reader, &schema, &declared)?;
    let equation = equation(reader, &schema.equation, &names, &orders)?;
    let time_domain = match &schema.time_domain {
        None => None,
        Some(text) => Some(self::equation(reader, text, &names, &BTreeMap::new())?),
    };
    let expression = |text: &Spanned<String>| {
        parse_expression(text.get_ref(), &names).map_err(|error| reader.inside(text, error))
    };
    let impact = match &schema.impact {
        None => None,
        Some(impact) => {
            let crossings = [("rising", Crossing::Rising), ("falling", Crossing::Falling)];
            let at = impact.crossing.span();
            let word = impact.crossing.get_ref();
            let crossing = reader.word("crossing", word, at, &crossings, "rising, falling")?;
            let position = expression(&impact.position)?;
            Some(Impact { position, crossing, restitution: expression(&impact.restitution)? })
        }
    };
    let synchronous = match &schema.synchronous {
        None => None,
        Some(tie) => {
            let parameter = |word: &Spanned<String>| {
                let name = canonical_name(word.get_ref());
                if declared.contains(&name) {
                    return Ok(name.into());
                }
                let kind = FileErrorKind::Undeclared { key: "synchronous", name: excerpt(&name) };
                Err(reader.error(kind, word.span().start))
            };
            Some(Synchronous {
                delay: parameter(&tie.delay)?,
                periods: parameter(&tie.periods)?,
                frequency: parameter(&tie.frequency)?,
            })
        }
    };
    let known = "initial-amplitude, fundamental-amplitude, limit-cycle, free-amplitude";
    let conditions = match &schema.condition {
        None => match usual_condition(&equation) {
            // Nothing to expand in: for the time domain.
            Condition::InitialAmplitude | Condition::LimitCycle
                if !equation.contains(&Expression::Small) =>
            {
                Vec::new()
            }
            usual => vec![usual],
        },
        Some(list) => {
            let one =
                |word: &String| reader.word("condition", word, list.span(), &CONDITIONS, known);
            list.get_ref().0.iter().map(one).collect::<Result<_, _>>()?
        }
    };
    let known = "scaled, scales-frequency, in-sums, in-small-parameter, determined, free";
    let amplitude = match &schema.amplitude {
        None => usual_amplitude(conditions.first()),
        Some(word) => reader.word("amplitude", word.get_ref(), word.span(), &AMPLITUDES, known)?,
    };
    if let Some(reason) = misplaced(amplitude, &equation, &small, &declared) {
        let (role, at) =
            schema.amplitude.as_ref().map_or(("", 0..0), |w| (&**w.get_ref(), w.span()));
        let kind = FileErrorKind::Role { role: excerpt(role), reason };
        return Err(reader.error(kind, at.start));
    }
    if amplitude == AmplitudeRole::Scaled && !declared.contains("amplitude") {
        let meaning = "a: x(0), or the first harmonic; x = a y is expanded";
        cards.push(ParameterCard {
            name: "amplitude".into(),
            meaning: meaning.into(),
            default: "1".into(),
        });
    }
    let (initial, history) = start(reader, schema.initial.as_ref(), &names)?;
    if !equation.contains(&Expression::Small)
        && conditions.iter().any(|c| *c != Condition::FreeAmplitude)
    {
        let kind = FileErrorKind::NoSmallParameter { name: small };
        return Err(reader.error(kind, schema.equation.span().start));
    }
    let listed = |key: &'static str, list: &[Spanned<String>]| -> Result<Vec<String>, FileError> {
        let one = |word: &Spanned<String>| {
            let (name, range) = match word.get_ref().split_once('=') {
                Some((name, range)) if key == "swept" => (name.trim(), Some(range)),
                _ => (word.get_ref().as_str(), None),
            };
            if let Some(text) = range.filter(|text| !is_range(text)) {
                let kind = FileErrorKind::Range { text: excerpt(text) };
                return Err(reader.error(kind, word.span().start));
            }
            let name = canonical_name(name);
            let known = declared.contains(&name) || name == small || name == "amplitude";
            let kind = || FileErrorKind::Undeclared { key, name: excerpt(&name) };
            if known { Ok(name.clone()) } else { Err(reader.error(kind(), word.span().start)) }
        };
        list.iter().map(one).collect()
    };
    let (fixed, swept) = (listed("fixed", &schema.fixed)?, listed("swept", &schema.swept)?);
    if let Some((name, word)) =
        swept.iter().zip(&schema.swept).find(|(name, _)| fixed.contains(name))
    {
        return Err(reader.error(FileErrorKind::Twice { name: name.clone() }, word.span().start));
    }
    let mut asked = Vec::new();
    for word in &schema.asked {
        let known: Vec<(&str, ())> = ASKED.split(", ").map(|word| (word.trim(), ())).collect();
        reader.word("asked", word.get_ref(), word.span(), &known, ASKED)?;
        asked.push(word.get_ref().clone());
    }
    let mut texts = vec![schema.equation.get_ref().clone()];
    texts.extend(schema.time_domain.iter().map(|text| text.get_ref().clone()));
    if let Some(impact) = &schema.impact {
        texts.extend([impact.position.get_ref().clone(), impact.restitution.get_ref().clone()]);
    }
    if let Some(tie) = &schema.synchronous {
        texts.extend([&tie.delay, &tie.periods, &tie.frequency].map(|word| word.get_ref().clone()));
    }
    if let Some(initial) = &schema.initial {
        let exact = [&initial.x, &initial.velocity].into_iter().flatten();
        texts.extend(exact.map(|value| value.get_ref().0.clone()));
        texts.extend(initial.history.iter().map(|text| text.get_ref().clone()));
    }
    texts.extend(follows.values().cloned());
    let mut occurring = equation.parameters();
    occurring.extend(texts.iter().flat_map(|text| words(text)));
    // The amplitude, and the parts of a small parameter that is composed, stand in no equation.
    let parts = match amplitude {
        AmplitudeRole::InSmallParameter => &declared,
        // n = 1 + 2 delta.
        AmplitudeRole::ScalesFrequency { .. } => &BTreeSet::from(["n".to_owned()]),
        _ => &BTreeSet::new(),
    };
    let is_unused = |name: &&String| {
        !parts.contains(*name) && **name != "amplitude" && !occurring.contains(*name)
    };
    let unused = declared.iter().filter(is_unused).cloned().collect();
    Ok(ProblemFile {
        unused,
        start: reader.content(&schema.equation),
        equation: schema.equation.get_ref().clone(),
        text: reader.text.to_owned(),
        problem: Problem {
            name: name.clone().into(),
            title: schema.title.into(),
            equation,
            time_domain,
            impact,
            synchronous,
            small: small.clone().into(),
            conditions,
            amplitude,
            parameters: cards,
            notes: schema.notes.into(),
            source: schema.source.into(),
        },
        units,
        follows,
        initial,
        history,
        fixed,
        ranges: ranges(&schema.swept),
        swept,
        asked,
        names,
    })
}

/// The words of an expression as names.
fn words(text: &str) -> impl Iterator<Item = String> {
    let parts = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    parts.filter(|word| !word.is_empty()).map(canonical_name)
}

/// The order table; names must be parameters, orders at most 100.
fn orders(
    reader: &Reader<'_>,
    schema: &Schema,
    declared: &BTreeSet<String>,
) -> Result<BTreeMap<String, u32>, FileError> {
    let mut orders = BTreeMap::new();
    for (key, order) in &schema.orders.0 {
        let name = canonical_name(key.get_ref());
        if !declared.contains(&name) {
            let kind = FileErrorKind::Undeclared { key: "orders", name: excerpt(&name) };
            return Err(reader.error(kind, key.span().start));
        }
        if *order > 100 {
            let found = order.to_string();
            let kind = FileErrorKind::Word { key: "orders", found, known: "0 to 100" };
            return Err(reader.error(kind, key.span().start));
        }
        if orders.insert(name.clone(), *order).is_some() {
            return Err(reader.error(FileErrorKind::Twice { name }, key.span().start));
        }
    }
    Ok(orders)
}

/// An equation with x'' alone and the orders of its parameters.
fn equation(
    reader: &Reader<'_>,
    text: &Spanned<String>,
    names: &Names,
    orders: &BTreeMap<String, u32>,
) -> Result<Expression, FileError> {
    let equation = parse_equation(text.get_ref(), names).map_err(|e| reader.inside(text, e))?;
    let alone = equation.acceleration_alone().map_err(|fault| {
        let whole = 0..text.get_ref().len();
        let (kind, at) = match fault {
            AccelerationFault::Missing => (ParseErrorKind::NoAcceleration, whole),
            AccelerationFault::Inside(term) => {
                let at = locate(text.get_ref(), names, &term).unwrap_or(whole);
                let term = excerpt(&term.print(&names.small, Style::Text));
                (ParseErrorKind::AccelerationInside { term }, at)
            }
        };
        reader.inside(text, ParseError::new(kind, at))
    })?;
    let order = |e: &Expression| match e {
        Expression::Parameter(name) => match orders.get(name)? {
            0 => None,
            1 => Some(Expression::Small * e.clone()),
            n => Some(Expression::Small.pow(i64::from(*n)) * e.clone()),
        },
        _ => None,
    };
    if orders.is_empty() {
        return Ok(alone);
    }
    Ok(alone.substitute(&order).canonical())
}
