//! The parameters of a problem file: the table that declares them, their orders, those that no table
//! declares and those that nothing uses.

use crate::error::excerpt;
use crate::file_error::{FileError, FileErrorKind};
use crate::names::{PI, canonical_name, is_parameter_name};
use crate::reader::Reader;
use crate::schema::Schema;
use lindstedt_equation::{AmplitudeRole, Expression, Impact, ParameterCard};
use std::collections::{BTreeMap, BTreeSet};
use toml::Spanned;

/// `[parameters]`.
pub(crate) struct Parameters {
    /// Those with a value of their own.
    pub cards: Vec<ParameterCard>,
    pub units: BTreeMap<String, String>,
    /// Those that others determine.
    pub follows: BTreeMap<String, String>,
    /// The names of all.
    pub declared: BTreeSet<String>,
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

pub(crate) fn small_name(reader: &Reader<'_>, schema: &Schema) -> Result<String, FileError> {
    match &schema.small {
        None => Ok("eps".to_owned()),
        Some(small) => parameter_name(reader, small, "small parameter"),
    }
}

pub(crate) fn formal_names(
    reader: &Reader<'_>,
    schema: &Schema,
) -> Result<BTreeSet<String>, FileError> {
    schema.formal.iter().map(|word| parameter_name(reader, word, "formal function")).collect()
}

pub(crate) fn parameters(
    reader: &Reader<'_>,
    schema: &Schema,
    small: &str,
) -> Result<Parameters, FileError> {
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

/// The parameters without a table: those that equations and wall mention, without a value; and the number
/// pi, which no table declares.
pub(crate) fn undeclared<'a>(
    equations: impl Iterator<Item = &'a Expression>,
    wall: Option<&Impact>,
    declared: &BTreeSet<String>,
) -> Vec<ParameterCard> {
    let parts = wall.into_iter().flat_map(|wall| [&wall.position, &wall.restitution]);
    let parts = parts.flat_map(Expression::parameters);
    let mentioned: BTreeSet<String> =
        equations.flat_map(Expression::parameters).chain(parts).collect();
    let card = |name: String| {
        let (meaning, default) = if name == PI { ("the number pi", PI) } else { ("", "") };
        ParameterCard::new(name, meaning, default)
    };
    let open = |name: &String| !declared.contains(name) && name != "amplitude";
    mentioned.into_iter().filter(open).map(card).collect()
}

/// The parameters that are declared and occur nowhere.
pub(crate) fn unused<'a>(
    schema: &Schema,
    equations: impl Iterator<Item = &'a Expression>,
    amplitude: AmplitudeRole,
    declared: &BTreeSet<String>,
    follows: &BTreeMap<String, String>,
) -> Vec<String> {
    let mut texts: Vec<_> = schema.equations.iter().chain(&schema.time_domain).collect();
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
    let mut occurring: Vec<String> = equations.flat_map(Expression::parameters).collect();
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
pub(crate) fn orders(
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
            let kind = FileErrorKind::Word { key: "orders", found, known: "0 to 100".to_owned() };
            return Err(reader.error(kind, key.span().start));
        }
        if orders.insert(name.clone(), *order).is_some() {
            return Err(reader.error(FileErrorKind::Twice { name }, key.span().start));
        }
    }
    Ok(orders)
}
