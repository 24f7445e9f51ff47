//! The options of a question: text, each read once; what is left over is refused.

use crate::failure::usage;
use lindstedt::choices::Choice;
use lindstedt::grid::Axis;
use lindstedt::{Error, Exact};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::str::FromStr;

/// Names and values.
pub struct Options(RefCell<BTreeMap<String, String>>);

impl Options {
    pub fn new(list: BTreeMap<String, String>) -> Self {
        Self(RefCell::new(list))
    }

    /// The text of an option.
    pub fn text(&self, name: &str) -> Option<String> {
        self.0.borrow_mut().remove(name)
    }

    /// A value with its own notation, a number among them.
    pub fn parsed<T: FromStr>(&self, name: &str) -> Result<Option<T>, Error> {
        let Some(text) = self.text(name) else { return Ok(None) };
        let hint = match text.parse::<f64>() {
            Ok(_) => "a whole number, not below 0",
            Err(_) => "a number",
        };
        let value = text.parse().map(Some);
        value.map_err(|_| usage(format!("{name} = {text:?} is not understood"), hint))
    }

    /// A value read by a function of the engine.
    pub fn read<T>(
        &self,
        name: &str,
        read: impl FnOnce(&str) -> Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        self.text(name).map(|text| read(&text)).transpose()
    }

    /// An exact number.
    pub fn exact(&self, name: &str) -> Result<Option<Exact>, Error> {
        self.read(name, |text| Ok(Exact::parse(text)?))
    }

    /// Whether a flag is set.
    pub fn flag(&self, name: &str) -> Result<bool, Error> {
        let flag = self.read(name, |text| {
            let wrong = |_| usage(format!("{name} = {text:?} is no flag"), "true or false");
            text.parse().map_err(wrong)
        });
        Ok(flag?.unwrap_or(false))
    }

    /// Refuses more than one of these.
    pub fn only_one(&self, names: &[&str]) -> Result<(), Error> {
        let list = self.0.borrow();
        let given: Vec<&str> =
            names.iter().copied().filter(|name| list.contains_key(*name)).collect();
        match given.as_slice() {
            [] | [_] => Ok(()),
            given => {
                let message = format!("only one of {} at a time", given.join(", "));
                Err(usage(message, "leave the others out"))
            }
        }
    }

    /// One of a list of words.
    pub fn choice<T: Copy>(&self, name: &str, list: &[Choice<T>]) -> Result<Option<T>, Error> {
        self.read(name, |text| {
            let words: Vec<&str> = list.iter().map(|choice| choice.word).collect();
            let wrong =
                || usage(format!("{name} is none of {words:?}: {text:?}"), &words.join(", "));
            Choice::find(list, text).ok_or_else(wrong)
        })
    }

    /// Numbers separated by commas.
    pub fn list<T: FromStr>(&self, name: &str) -> Result<Option<Vec<T>>, Error> {
        self.read(name, |text| {
            let parts = text.split(',').filter(|part| !part.trim().is_empty());
            let list: Result<Vec<T>, _> = parts.map(|part| part.trim().parse()).collect();
            list.map_err(|_| {
                usage(format!("{name} = {text:?} is no list"), "whole numbers: [2, 4, 8]")
            })
        })
    }

    /// The axes of a sweep, separated by semicolons: none, one or two.
    pub fn axes(
        &self,
        read: impl Fn(&str) -> Result<Axis, Error>,
    ) -> Result<(Option<Axis>, Option<Axis>), Error> {
        let text = self.text("sweep").unwrap_or_default();
        Axis::pair(text.split(';').filter(|axis| !axis.is_empty()).map(read))
    }

    /// Refuses what no question read.
    pub fn finish(&self) -> Result<(), Error> {
        match self.0.borrow().keys().next() {
            None => Ok(()),
            Some(name) => {
                let message =
                    format!("this question has no option {name}, or none beside the others");
                Err(usage(message, "leave it out"))
            }
        }
    }
}
