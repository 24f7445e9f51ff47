//! From the keys of a problem file to the problem: each key is read, and checked, by itself.

use crate::error::{ParseError, ParseErrorKind, excerpt};
use crate::file::{AMPLITUDES, ASKED, CONDITIONS, ProblemFile, UNNAMED, misplaced};
use crate::file_error::{FileError, FileErrorKind};
use crate::grammar::{locate, parse_equation, parse_expression};
use crate::history::{is_range, ranges, start};
use crate::meaning::Meanings;
use crate::names::{Names, PI, canonical_name, is_parameter_name};
use crate::reader::Reader;
use crate::schema::{self, Schema};
use lindstedt_equation::print::Style;
use lindstedt_equation::{
    AccelerationFault, AmplitudeRole, Condition, Crossing, Expression, Impact, ParameterCard,
    Problem, Synchronous,
};
use std::collections::{BTreeMap, BTreeSet};
use toml::Spanned;

/// `[parameters]`.
struct Parameters {
    /// Those with a value of their own.
    cards: Vec<ParameterCard>,
    units: BTreeMap<String, String>,
    /// Those that others determine.
    follows: BTreeMap<String, String>,
    /// The names of all.
    declared: BTreeSet<String>,
}

pub(crate) fn read(reader: &Reader<'_>, schema: Schema) -> Result<ProblemFile, FileError> {
    let name = problem_name(reader, &schema)?;
    let small = small_name(reader, &schema)?;
    let Parameters { mut cards, units, follows, declared } = parameters(reader, &schema, &small)?;
    let mut names = match &schema.parameters {
        Some(_) => Names::only(&small, declared.iter().map(String::as_str)),
        None => Names::any(&small),
    };
    names.formal = formal_names(reader, &schema)?;
    let orders = orders(reader, &schema, &declared)?;
    let tie = schema.synchronous.as_ref();
    let synchronous = tie.map(|tie| synchronous(reader, tie, &declared)).transpose()?;
    let tie = synchronous.as_ref();
    let meanings = Meanings::read(reader, &schema, &names, &follows, &orders, tie)?;
    let read = |text| read_equation(reader, text, &names, &meanings);
    let equation = read(&schema.equation)?;
    let time_domain = schema.time_domain.as_ref().map(read).transpose()?;
    let wall = schema.impact.as_ref();
    let impact = wall.map(|wall| impact(reader, wall, &names, &meanings)).transpose()?;
    cards.extend(undeclared([Some(&equation), time_domain.as_ref()], impact.as_ref(), &declared));
    names.parameters = Some(cards.iter().map(|card| card.name.to_string()).collect());
    names.parameters.iter_mut().for_each(|list| list.extend(declared.iter().cloned()));
    let conditions = conditions(reader, &schema, &equation)?;
    let amplitude = amplitude(reader, &schema, (&equation, &small), &conditions, &declared)?;
    if amplitude == AmplitudeRole::Scaled && !declared.contains("amplitude") {
        let meaning = "a: x(0), or the first harmonic; x = a y is expanded";
        cards.push(ParameterCard::new("amplitude", meaning, "1"));
    }
    let (initial, history) = start(reader, schema.initial.as_ref(), &names)?;
    if !equation.contains(&Expression::Small)
        && conditions.iter().any(|c| *c != Condition::FreeAmplitude)
    {
        let kind = FileErrorKind::NoSmallParameter { name: small };
        return Err(reader.error(kind, schema.equation.span().start));
    }
    let known = |name: &str| declared.contains(name) || name == small || name == "amplitude";
    let fixed = listed(reader, "fixed", &schema.fixed, &known)?;
    let swept = listed(reader, "swept", &schema.swept, &known)?;
    if let Some((name, word)) =
        swept.iter().zip(&schema.swept).find(|(name, _)| fixed.contains(name))
    {
        return Err(reader.error(FileErrorKind::Twice { name: name.clone() }, word.span().start));
    }
    let unused = unused(&schema, &equation, amplitude, &declared, &follows);
    let mut problem = Problem::new(name, equation)
        .with_title(schema.title.clone())
        .with_small(small)
        .under(conditions, amplitude)
        .with_notes(schema.notes.clone())
        .with_source(schema.source.clone());
    problem.parameters = cards;
    (problem.time_domain, problem.impact, problem.synchronous) = (time_domain, impact, synchronous);
    Ok(ProblemFile {
        unused,
        asked: asked(reader, &schema)?,
        named: schema.name.is_some(),
        declares: schema.parameters.is_some(),
        start: reader.content(&schema.equation),
        equation: schema.equation.get_ref().clone(),
        text: reader.text.to_owned(),
        problem,
        units,
        follows,
        initial,
        history,
        fixed,
        meanings,
        ranges: ranges(&schema.swept),
        swept,
        names,
    })
}

/// The parameters without a table: those that equations and wall mention, without a value; and the number
/// pi, which no table declares.
fn undeclared(
    equations: [Option<&Expression>; 2],
    wall: Option<&Impact>,
    declared: &BTreeSet<String>,
) -> Vec<ParameterCard> {
    let parts = wall.into_iter().flat_map(|wall| [&wall.position, &wall.restitution]);
    let all = equations.into_iter().flatten().chain(parts);
    let mentioned: BTreeSet<String> = all.flat_map(Expression::parameters).collect();
    let card = |name: String| {
        let (meaning, default) = if name == PI { ("the number pi", PI) } else { ("", "") };
        ParameterCard::new(name, meaning, default)
    };
    let open = |name: &String| !declared.contains(name) && name != "amplitude";
    mentioned.into_iter().filter(open).map(card).collect()
}

fn problem_name(reader: &Reader<'_>, schema: &Schema) -> Result<String, FileError> {
    let Some(word) = &schema.name else { return Ok(UNNAMED.to_owned()) };
    let name = word.get_ref();
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || name.len() > 40 || !name.chars().all(plain) || name.starts_with('-') {
        let kind = FileErrorKind::Name { name: excerpt(name), what: "problem" };
        return Err(reader.error(kind, word.span().start));
    }
    Ok(name.clone())
}

/// A name as it is used, if a parameter may have it.
fn parameter_name(
    reader: &Reader<'_>,
    word: &Spanned<String>,
    what: &'static str,
) -> Result<String, FileError> {
    let name = canonical_name(word.get_ref());
    if is_parameter_name(&name) {
        return Ok(name);
    }
    let kind = FileErrorKind::Name { name: excerpt(word.get_ref()), what };
    Err(reader.error(kind, word.span().start))
}

fn small_name(reader: &Reader<'_>, schema: &Schema) -> Result<String, FileError> {
    match &schema.small {
        None => Ok("eps".to_owned()),
        Some(small) => parameter_name(reader, small, "small parameter"),
    }
}

fn formal_names(reader: &Reader<'_>, schema: &Schema) -> Result<BTreeSet<String>, FileError> {
    schema.formal.iter().map(|word| parameter_name(reader, word, "formal function")).collect()
}

fn parameters(reader: &Reader<'_>, schema: &Schema, small: &str) -> Result<Parameters, FileError> {
    let (mut cards, mut units, mut follows) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
    let mut declared = BTreeSet::new();
    for (key, parameter) in schema.parameters.iter().flat_map(|table| &table.0) {
        let name = parameter_name(reader, key, "parameter")?;
        if !declared.insert(name.clone()) {
            return Err(reader.error(FileErrorKind::Twice { name }, key.span().start));
        }
        if !parameter.unit.is_empty() {
            units.insert(name.clone(), parameter.unit.clone());
        }
        if let Some(how) = &parameter.follows {
            let wrong = if parameter.value.is_some() {
                Some("it has a value, too")
            } else if name == "amplitude" || name == small {
                Some("the amplitude and the small parameter have values of their own")
            } else {
                None
            };
            if let Some(reason) = wrong {
                let kind = FileErrorKind::Follows { name, reason: reason.to_owned() };
                return Err(reader.error(kind, key.span().start));
            }
            follows.insert(name, how.clone());
            continue;
        }
        let default = parameter.value.as_ref().map(|v| reader.value(v)).transpose()?;
        let meaning = parameter.meaning.clone();
        cards.push(ParameterCard::new(name, meaning, default.unwrap_or_default()));
    }
    Ok(Parameters { cards, units, follows, declared })
}

fn impact(
    reader: &Reader<'_>,
    wall: &schema::Impact,
    names: &Names,
    meanings: &Meanings,
) -> Result<Impact, FileError> {
    let expression = |text: &Spanned<String>| {
        let found = parse_expression(text.get_ref(), names);
        found.map(|e| meanings.put_in(&e)).map_err(|error| reader.inside(text, error))
    };
    let crossings = [("rising", Crossing::Rising), ("falling", Crossing::Falling)];
    let (word, at) = (wall.crossing.get_ref(), wall.crossing.span());
    let crossing = reader.word("crossing", word, at, &crossings, "rising, falling")?;
    let position = expression(&wall.position)?;
    Ok(Impact { position, crossing, restitution: expression(&wall.restitution)? })
}

fn synchronous(
    reader: &Reader<'_>,
    tie: &schema::Synchronous,
    declared: &BTreeSet<String>,
) -> Result<Synchronous, FileError> {
    let parameter = |word: &Spanned<String>| {
        let name = canonical_name(word.get_ref());
        if declared.contains(&name) {
            return Ok(name.into());
        }
        let kind = FileErrorKind::Undeclared { key: "synchronous", name: excerpt(&name) };
        Err(reader.error(kind, word.span().start))
    };
    Ok(Synchronous {
        delay: parameter(&tie.delay)?,
        periods: parameter(&tie.periods)?,
        frequency: parameter(&tie.frequency)?,
    })
}

/// The conditions listed, or the usual one; none where there is nothing to expand in: such an equation
/// is for the time domain.
fn conditions(
    reader: &Reader<'_>,
    schema: &Schema,
    equation: &Expression,
) -> Result<Vec<Condition>, FileError> {
    let known = "initial-amplitude, fundamental-amplitude, limit-cycle, free-amplitude";
    let Some(list) = &schema.condition else {
        return Ok(Condition::usual(equation).into_iter().collect());
    };
    let one = |word: &String| reader.word("condition", word, list.span(), &CONDITIONS, known);
    list.get_ref().0.iter().map(one).collect()
}

fn amplitude(
    reader: &Reader<'_>,
    schema: &Schema,
    (equation, small): (&Expression, &str),
    conditions: &[Condition],
    declared: &BTreeSet<String>,
) -> Result<AmplitudeRole, FileError> {
    let known = "scaled, scales-frequency, in-sums, in-small-parameter, determined, free";
    let (word, at) = match &schema.amplitude {
        None => ("", 0..0),
        Some(word) => (&**word.get_ref(), word.span()),
    };
    let role = match &schema.amplitude {
        None => AmplitudeRole::usual(conditions.first()),
        Some(_) => reader.word("amplitude", word, at.clone(), &AMPLITUDES, known)?,
    };
    match misplaced(role, equation, small, declared) {
        None => Ok(role),
        Some(reason) => {
            let kind = FileErrorKind::Role { role: excerpt(word), reason };
            Err(reader.error(kind, at.start))
        }
    }
}

/// `fixed` or `swept`.
fn listed(
    reader: &Reader<'_>,
    key: &'static str,
    list: &[Spanned<String>],
    known: &dyn Fn(&str) -> bool,
) -> Result<Vec<String>, FileError> {
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
        if known(&name) {
            return Ok(name);
        }
        let kind = FileErrorKind::Undeclared { key, name: excerpt(&name) };
        Err(reader.error(kind, word.span().start))
    };
    list.iter().map(one).collect()
}

fn asked(reader: &Reader<'_>, schema: &Schema) -> Result<Vec<String>, FileError> {
    let known: Vec<(&str, ())> = ASKED.split(", ").map(|word| (word.trim(), ())).collect();
    let one = |word: &Spanned<String>| {
        reader.word("asked", word.get_ref(), word.span(), &known, ASKED)?;
        Ok(word.get_ref().clone())
    };
    schema.asked.iter().map(one).collect()
}

/// The parameters that are declared and occur nowhere.
fn unused(
    schema: &Schema,
    equation: &Expression,
    amplitude: AmplitudeRole,
    declared: &BTreeSet<String>,
    follows: &BTreeMap<String, String>,
) -> Vec<String> {
    let mut texts = vec![&schema.equation];
    texts.extend(&schema.time_domain);
    if let Some(wall) = &schema.impact {
        texts.extend([&wall.position, &wall.restitution]);
    }
    if let Some(tie) = &schema.synchronous {
        texts.extend([&tie.delay, &tie.periods, &tie.frequency]);
    }
    let mut texts: Vec<&str> = texts.into_iter().map(|text| text.get_ref().as_str()).collect();
    if let Some(initial) = &schema.initial {
        let exact = [&initial.x, &initial.velocity].into_iter().flatten();
        texts.extend(exact.map(|value| value.get_ref().0.as_str()));
        texts.extend(initial.history.iter().map(|text| text.get_ref().as_str()));
    }
    texts.extend(follows.values().map(String::as_str));
    let mut occurring = equation.parameters();
    occurring.extend(texts.into_iter().flat_map(words));
    // The amplitude, and the parts of a small parameter that is composed, stand in no equation.
    let parts = match amplitude {
        AmplitudeRole::InSmallParameter => declared,
        // n = 1 + 2 delta.
        AmplitudeRole::ScalesFrequency { .. } => &BTreeSet::from(["n".to_owned()]),
        _ => &BTreeSet::new(),
    };
    let is_unused = |name: &&String| {
        !parts.contains(*name) && **name != "amplitude" && !occurring.contains(*name)
    };
    declared.iter().filter(is_unused).cloned().collect()
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

/// An equation with x'' alone and what stands for its parameters.
fn read_equation(
    reader: &Reader<'_>,
    text: &Spanned<String>,
    names: &Names,
    meanings: &Meanings,
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
    Ok(meanings.put_in(&alone))
}
