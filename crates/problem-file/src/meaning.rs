//! What stands for the name of a parameter: its power of the small parameter (`orders`), and what determines
//! it (`follows`).

use crate::file_error::{FileError, FileErrorKind};
use crate::grammar::parse_expression;
use crate::names::{Names, PI, canonical_name};
use crate::reader::Reader;
use crate::schema::Schema;
use lindstedt_equation::{Expression, Synchronous};
use std::collections::BTreeMap;

/// What stands for the names of parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Meanings {
    /// eps^n p, or what p follows from; the names that it mentions stand for themselves.
    in_place: BTreeMap<String, Expression>,
    /// What contains pi, which is no expression over the rational numbers; the name keeps its place.
    pub(crate) with_pi: BTreeMap<String, Expression>,
}

impl Meanings {
    pub(crate) fn put_in(&self, e: &Expression) -> Expression {
        if self.in_place.is_empty() {
            return e.clone();
        }
        let meaning = |e: &Expression| match e {
            Expression::Parameter(name) => self.in_place.get(&**name).cloned(),
            _ => None,
        };
        e.substitute(&meaning).canonical()
    }

    /// From both tables of a file. What determines a parameter mentions declared names and pi, and in the
    /// end only such with a value; a delay of whole periods follows from its tie.
    pub(crate) fn read(
        reader: &Reader<'_>,
        schema: &Schema,
        names: &Names,
        follows: &BTreeMap<String, String>,
        orders: &BTreeMap<String, u32>,
        tie: Option<&Synchronous>,
    ) -> Result<Self, FileError> {
        let refused = |name: &str, reason: String| {
            let mut keys = schema.parameters.iter().flat_map(|table| &table.0);
            let key = keys.find(|(key, _)| canonical_name(key.get_ref()) == name);
            let at = key.map_or(0, |(key, _)| key.span().start);
            reader.error(FileErrorKind::Follows { name: name.to_owned(), reason }, at)
        };
        let of_order = |name: &str, e: Expression| match orders.get(name) {
            Some(n) if *n > 0 => Expression::Small.pow(i64::from(*n)) * e,
            _ => e,
        };
        let mut known = Self::default();
        for name in orders.keys() {
            known.in_place.insert(name.clone(), of_order(name, Expression::parameter(name)));
        }
        let mut open: BTreeMap<&str, Expression> = BTreeMap::new();
        for (name, text) in follows {
            let found = parse_expression(text, names)
                .map_err(|error| refused(name, format!("{}", error.kind)))?;
            open.insert(name, found);
        }
        if let Some(tie) = tie {
            let parts = [&tie.periods, &tie.frequency];
            if let Some(name) = parts.into_iter().find(|name| open.contains_key(&***name)) {
                return Err(refused(
                    name,
                    "[synchronous] needs a parameter with a value".to_owned(),
                ));
            }
            let [periods, frequency] =
                [&tie.periods, &tie.frequency].map(|name| Expression::parameter(name));
            let turn = Expression::from(2) * Expression::parameter(PI);
            let whole = turn * periods * frequency.pow(-1);
            let differs = |found: &Expression| found.canonical() != whole.canonical();
            if open.get(&*tie.delay).is_some_and(differs) {
                let whole = format!("2*pi*{}/{}", tie.periods, tie.frequency);
                return Err(refused(&tie.delay, format!("by [synchronous] it is {whole}")));
            }
        }
        // What follows from values only is known, then what follows from that.
        while !open.is_empty() {
            let next = open.iter().find(|(_, found)| {
                found.parameters().iter().all(|name| !open.contains_key(name.as_str()))
            });
            let Some((name, found)) = next.map(|(name, found)| (*name, found.clone())) else {
                let name = open.keys().next().copied().unwrap_or_default();
                return Err(refused(name, "it follows from itself in the end".to_owned()));
            };
            open.remove(name);
            let value = known.with_pi_in(&known.put_in(&found));
            if value.parameters().iter().any(|name| name == PI) {
                known.with_pi.insert(name.to_owned(), value);
            } else {
                known.in_place.insert(name.to_owned(), of_order(name, value));
            }
        }
        Ok(known)
    }

    fn with_pi_in(&self, e: &Expression) -> Expression {
        let value = |e: &Expression| match e {
            Expression::Parameter(name) => self.with_pi.get(&**name).cloned(),
            _ => None,
        };
        e.substitute(&value)
    }
}
