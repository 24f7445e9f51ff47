//! From the keys of a problem file to the problem: each key is read, and checked, by itself.

use crate::declared::{
    Parameters, formal_names, orders, parameters, small_name, undeclared, unused,
};
use crate::error::{ParseError, ParseErrorKind, excerpt};
use crate::file::{AMPLITUDES, ProblemFile, UNNAMED, misplaced};
use crate::file_error::{FileError, FileErrorKind};
use crate::grammar::{locate, parse_equation, parse_expression};
use crate::history::{is_range, ranges, start};
use crate::meaning::Meanings;
use crate::names::{Names, canonical_name};
use crate::reader::Reader;
use crate::schema::{self, Schema};
use lindstedt_equation::print::Style;
use lindstedt_equation::{
    AccelerationFault, AmplitudeRole, Condition, Crossing, Expression, Impact, ParameterCard,
    Problem, Quantity, Synchronous,
};
use std::collections::BTreeSet;
use toml::Spanned;

pub(crate) fn read(reader: &Reader<'_>, schema: Schema) -> Result<ProblemFile, FileError> {
    let name = problem_name(reader, &schema)?;
    let small = small_name(reader, &schema)?;
    let Parameters { mut cards, units, follows, declared } = parameters(reader, &schema, &small)?;
    let mut names = known_names(reader, &schema, &small, &declared)?;
    let orders = orders(reader, &schema, &declared)?;
    let tie = schema.synchronous.as_ref();
    let synchronous = tie.map(|tie| synchronous(reader, tie, &declared)).transpose()?;
    let meanings =
        Meanings::read(reader, &schema, &names, &follows, &orders, synchronous.as_ref())?;
    let Formulas { equation, others, time_domain, impact } =
        formulas(reader, &schema, &names, &meanings)?;
    let sides = [&equation].into_iter().chain(&others);
    cards.extend(undeclared(sides.clone().chain(&time_domain), impact.as_ref(), &declared));
    names.parameters = Some(cards.iter().map(|card| card.name.to_string()).collect());
    names.parameters.iter_mut().for_each(|list| list.extend(declared.iter().cloned()));
    let conditions = match schema.condition {
        None if !others.is_empty() => vec![Condition::FreeAmplitude],
        _ => conditions(reader, &schema, &equation)?,
    };
    let amplitude = amplitude(reader, &schema, (&equation, &small), &conditions, &declared)?;
    if amplitude == AmplitudeRole::Scaled && !declared.contains("amplitude") {
        let meaning = "a: x(0), or the first harmonic; x = a y is expanded";
        cards.push(ParameterCard::new("amplitude", meaning, "1"));
    }
    let (initial, history) = start(reader, schema.initial.as_ref(), &names)?;
    check_expansion(reader, &schema, (&equation, &small), &conditions)?;
    let known = |name: &str| declared.contains(name) || name == small || name == "amplitude";
    let (fixed, swept, unknown) = fixed_and_swept(reader, &schema, &known, &cards)?;
    let unused = unused(&schema, sides, amplitude, &declared, &follows);
    let usual = names.unknowns == ["x"];
    let unknowns = names.unknowns.iter().filter(|_| !usual).map(|name| name.clone().into());
    let mut problem = Problem::new(name, equation)
        .with_others(others, unknowns.collect())
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
        start: reader.content(schema.first()),
        equation: schema.first().get_ref().clone(),
        text: reader.text.to_owned(),
        problem,
        units,
        follows,
        initial,
        history,
        unknown,
        fixed,
        meanings,
        ranges: ranges(&schema.swept),
        swept,
        names,
    })
}

/// The names that the formulas may use: those declared, or any where no table declares them; and the unknowns,
/// as many as there are equations.
fn known_names(
    reader: &Reader<'_>,
    schema: &Schema,
    small: &str,
    declared: &BTreeSet<String>,
) -> Result<Names, FileError> {
    let names = match &schema.parameters {
        Some(_) => Names::only(small, declared.iter().map(String::as_str)),
        None => Names::any(small),
    };
    let names = Names { formal: formal_names(reader, schema)?, ..names };
    if let [only] = &schema.equations[..] {
        return Ok(names.of_one(only.get_ref()));
    }
    let names = names.of_system(schema.equations.iter().map(|text| text.get_ref().as_str()));
    let (unknowns, equations) = (names.unknowns.len(), schema.equations.len());
    if unknowns == equations {
        return Ok(names);
    }
    let kind = FileErrorKind::Unknowns { unknowns: names.unknowns.join(", "), equations };
    Err(reader.error(kind, schema.first().span().start))
}

/// What is written as formulas.
struct Formulas {
    equation: Expression,
    others: Vec<Expression>,
    time_domain: Option<Expression>,
    impact: Option<Impact>,
}

fn formulas(
    reader: &Reader<'_>,
    schema: &Schema,
    names: &Names,
    meanings: &Meanings,
) -> Result<Formulas, FileError> {
    let read = |text| read_equation(reader, text, names, meanings);
    let wall = schema.impact.as_ref();
    Ok(Formulas {
        equation: read(schema.first())?,
        others: schema.equations.iter().skip(1).map(read).collect::<Result<_, _>>()?,
        time_domain: schema.time_domain.as_ref().map(read).transpose()?,
        impact: wall.map(|wall| impact(reader, wall, names, meanings)).transpose()?,
    })
}

/// What is to be expanded must contain what it is expanded in.
fn check_expansion(
    reader: &Reader<'_>,
    schema: &Schema,
    (equation, small): (&Expression, &str),
    conditions: &[Condition],
) -> Result<(), FileError> {
    let expands = conditions.iter().any(|c| *c != Condition::FreeAmplitude);
    if equation.contains(&Expression::Small) || !expands {
        return Ok(());
    }
    let kind = FileErrorKind::NoSmallParameter { name: small.to_owned() };
    Err(reader.error(kind, schema.first().span().start))
}

/// `fixed`, `swept`, `unknown`.
type Chosen = (Vec<String>, Vec<String>, Option<String>);

/// `fixed` and `swept`, which have no name in common, and `unknown`.
fn fixed_and_swept(
    reader: &Reader<'_>,
    schema: &Schema,
    known: &dyn Fn(&str) -> bool,
    cards: &[ParameterCard],
) -> Result<Chosen, FileError> {
    let fixed = listed(reader, "fixed", &schema.fixed, known)?;
    let swept = listed(reader, "swept", &schema.swept, known)?;
    let mut all = swept.iter().zip(&schema.swept);
    if let Some((name, word)) = all.find(|(name, _)| fixed.contains(name)) {
        return Err(reader.error(FileErrorKind::Twice { name: name.clone() }, word.span().start));
    }
    let occurs = |name: &str| cards.iter().any(|card| card.name == *name);
    let unknown = listed(reader, "unknown", schema.unknown.as_slice(), &occurs)?.pop();
    Ok((fixed, swept, unknown))
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

fn impact(
    reader: &Reader<'_>,
    wall: &schema::Impact,
    names: &Names,
    meanings: &Meanings,
) -> Result<Impact, FileError> {
    let expression = |key: &'static str, text: &Spanned<String>| {
        let found = parse_expression(text.get_ref(), names);
        let found = found.map_err(|error| reader.inside(text, error))?;
        let on =
            match found.nodes().find(|e| matches!(e, Expression::Time | Expression::Unknown(_))) {
                None => return Ok(meanings.put_in(&found)),
                Some(Expression::Time) => "t",
                Some(_) => "x",
            };
        Err(reader.error(FileErrorKind::Wall { key, on }, text.span().start))
    };
    let crossings = [("rising", Crossing::Rising), ("falling", Crossing::Falling)];
    let (word, at) = (wall.crossing.get_ref(), wall.crossing.span());
    let crossing = reader.word("crossing", word, at, &crossings)?;
    let position = expression("position", &wall.position)?;
    let restitution = expression("restitution", &wall.restitution)?;
    Ok(Impact { position, crossing, restitution })
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
    let Some(list) = &schema.condition else {
        return Ok(Condition::usual(equation).into_iter().collect());
    };
    let known = Condition::ALL.map(|condition| (condition.name(), condition));
    let one = |word: &String| reader.word("condition", word, list.span(), &known);
    list.get_ref().0.iter().map(one).collect()
}

fn amplitude(
    reader: &Reader<'_>,
    schema: &Schema,
    (equation, small): (&Expression, &str),
    conditions: &[Condition],
    declared: &BTreeSet<String>,
) -> Result<AmplitudeRole, FileError> {
    let (word, at) = match &schema.amplitude {
        None => ("", 0..0),
        Some(word) => (&**word.get_ref(), word.span()),
    };
    let role = match &schema.amplitude {
        None => AmplitudeRole::usual(conditions.first()),
        Some(_) => reader.word("amplitude", word, at.clone(), &AMPLITUDES)?,
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

fn asked(reader: &Reader<'_>, schema: &Schema) -> Result<Vec<Quantity>, FileError> {
    let known = Quantity::ALL.map(|quantity| (quantity.name(), quantity));
    let one = |word: &Spanned<String>| reader.word("asked", word.get_ref(), word.span(), &known);
    schema.asked.iter().map(one).collect()
}

/// The Taylor polynomial of one over the factor of x'', in text that is taken.
fn inverse_factor(equation: &Expression, names: &Names) -> Option<String> {
    let wanted = Expression::ACCELERATION;
    let with = equation.terms().iter().filter(|term| term.contains(&wanted));
    let factor = with.map(|term| {
        let others = term.factors().iter().filter(|e| **e != wanted);
        Expression::Product(others.cloned().collect()).canonical()
    });
    let factor = Expression::Sum(factor.collect()).canonical();
    let text = format!("taylor(1/({}), 9)", factor.print(&names.small, Style::Text));
    (!factor.contains(&wanted) && parse_expression(&text, names).is_ok()).then_some(text)
}

/// An equation with x'' alone, or x' where there is no x'', and what stands for its parameters.
fn read_equation(
    reader: &Reader<'_>,
    text: &Spanned<String>,
    names: &Names,
    meanings: &Meanings,
) -> Result<Expression, FileError> {
    let equation = parse_equation(text.get_ref(), names).map_err(|e| reader.inside(text, e))?;
    if names.unknowns.len() > 1 {
        // Masses may couple.
        return Ok(meanings.put_in(&equation));
    }
    let alone = equation.highest_alone().map_err(|fault| {
        let whole = 0..text.get_ref().len();
        let (kind, at) = match fault {
            AccelerationFault::Missing => (ParseErrorKind::NoDerivative, whole),
            AccelerationFault::Inside(term) => {
                let at = locate(text.get_ref(), names, &term).unwrap_or(whole);
                let term = excerpt(&term.print(&names.small, Style::Text));
                let kind = match equation.is_first_order() {
                    true => ParseErrorKind::VelocityInside { term },
                    false => {
                        let inverse = inverse_factor(&equation, names);
                        ParseErrorKind::AccelerationInside { term, inverse }
                    }
                };
                (kind, at)
            }
        };
        reader.inside(text, ParseError::new(kind, at))
    })?;
    Ok(meanings.put_in(&alone))
}
