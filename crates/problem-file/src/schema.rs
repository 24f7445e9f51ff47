//! The keys of a problem file, as serde reads them.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt::Formatter;
use std::marker::PhantomData;
use toml::Spanned;

/// Everything that a file may say.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Schema {
    pub name: Option<Spanned<String>>,
    #[serde(default)]
    pub title: String,
    equation: Option<Spanned<String>>,
    /// One for every unknown; the one of `equation` where that is given.
    #[serde(default)]
    pub equations: Vec<Spanned<String>>,
    pub small: Option<Spanned<String>>,
    pub condition: Option<Spanned<OneOrMany>>,
    pub amplitude: Option<Spanned<String>>,
    #[serde(default)]
    pub formal: Vec<Spanned<String>>,
    pub time_domain: Option<Spanned<String>>,
    #[serde(default)]
    pub orders: Entries<u32>,
    /// Without the table every name of the equation is a parameter.
    pub parameters: Option<Entries<Parameter>>,
    pub impact: Option<Impact>,
    pub synchronous: Option<Synchronous>,
    pub initial: Option<Initial>,
    #[serde(default)]
    pub fixed: Vec<Spanned<String>>,
    #[serde(default)]
    pub swept: Vec<Spanned<String>>,
    #[serde(default)]
    pub asked: Vec<Spanned<String>>,
    pub unknown: Option<Spanned<String>>,
    #[serde(default)]
    pub notes: String,
    #[serde(default)]
    pub source: String,
}

impl Schema {
    /// With `equation` among the equations; nothing where there is none, or both keys.
    pub fn with_equations(mut self) -> Option<Self> {
        match self.equation.take() {
            None => {}
            Some(single) if self.equations.is_empty() => self.equations.push(single),
            Some(_) => return None,
        }
        (!self.equations.is_empty()).then_some(self)
    }

    /// The equation of the first unknown.
    pub fn first(&self) -> &Spanned<String> {
        &self.equations[0]
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Impact {
    pub position: Spanned<String>,
    pub crossing: Spanned<String>,
    pub restitution: Spanned<String>,
}

/// Names of parameters: delay = 2 pi periods/frequency.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Synchronous {
    pub delay: Spanned<String>,
    pub periods: Spanned<String>,
    pub frequency: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Initial {
    pub x: Option<Spanned<ExactText>>,
    pub velocity: Option<Spanned<ExactText>>,
    pub history: Option<Spanned<String>>,
}

/// A parameter: a value, or a table.
pub(crate) struct Parameter {
    pub value: Option<Spanned<ExactText>>,
    pub unit: String,
    pub meaning: String,
    pub follows: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterTable {
    value: Option<Spanned<ExactText>>,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    meaning: String,
    follows: Option<String>,
}

/// An exact number as text.
pub(crate) struct ExactText(pub String);

/// A word or a list of words.
pub(crate) struct OneOrMany(pub Vec<String>);

/// A table in the order of the file.
pub(crate) struct Entries<T>(pub Vec<(Spanned<String>, T)>);

impl<T> Default for Entries<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de> Deserialize<'de> for ExactText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Words;
        impl Visitor<'_> for Words {
            type Value = ExactText;
            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                f.write_str("an exact value in quotes, for example \"1/3\"")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<ExactText, E> {
                Ok(ExactText(text.to_owned()))
            }
            fn visit_i64<E: Error>(self, n: i64) -> Result<ExactText, E> {
                Ok(ExactText(n.to_string()))
            }
        }
        deserializer.deserialize_any(Words)
    }
}

impl<'de> Deserialize<'de> for Parameter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Forms;
        impl<'de> Visitor<'de> for Forms {
            type Value = Parameter;
            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                f.write_str("{ value = \"1/3\", unit = \"...\", meaning = \"...\" }")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Parameter, A::Error> {
                let ParameterTable { value, unit, meaning, follows } =
                    ParameterTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Parameter { value, unit, meaning, follows })
            }
        }
        deserializer.deserialize_any(Forms)
    }
}

impl<'de> Deserialize<'de> for OneOrMany {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Forms;
        impl<'de> Visitor<'de> for Forms {
            type Value = OneOrMany;
            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                f.write_str("a word or a list of words")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<OneOrMany, E> {
                Ok(OneOrMany(vec![text.to_owned()]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<OneOrMany, A::Error> {
                let mut words = Vec::new();
                while let Some(word) = list.next_element()? {
                    words.push(word);
                }
                Ok(OneOrMany(words))
            }
        }
        deserializer.deserialize_any(Forms)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Table<T> {
            type Value = Entries<T>;
            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Table(PhantomData))
    }
}
