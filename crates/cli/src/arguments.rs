//! The options that commands share, and how values are read. Names are part of the public interface: add, do not rename.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use lindstedt::choices::Choice;
use std::path::PathBuf;

/// How results are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Text,
    Json,
    Latex,
    Markdown,
}

#[derive(Debug, Args)]
pub struct Common {
    /// The form of the result.
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write the result to this file instead of standard output.
    #[arg(long, global = true, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// No progress on standard error.
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Stop after so many seconds with what is finished (exit code 4).
    #[arg(long, global = true, value_name = "S", value_parser = seconds)]
    pub limit_seconds: Option<f64>,
    /// Stop before more memory is taken (512M, 8G), with what is finished (exit code 4).
    #[arg(long, global = true, value_name = "SIZE", default_value = "8G", value_parser = memory_size)]
    pub limit_memory: u64,
    /// Threads for what runs on several cores; by default RAYON_NUM_THREADS, else all cores. The results are the same.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Precision {
    /// Correct digits of every decimal.
    #[arg(long, default_value_t = 30, value_name = "D", allow_negative_numbers = true)]
    #[arg(conflicts_with = "f64")]
    pub digits: u64,
    /// 17 digits, the precision of a double.
    #[arg(long)]
    pub f64: bool,
}

/// A value by its word in a table.
pub fn one_of<T>(list: &'static [Choice<T>]) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let words = list.iter().map(|choice| {
        let word = PossibleValue::new(choice.word);
        if choice.help.is_empty() { word } else { word.help(choice.help) }
    });
    PossibleValuesParser::new(words)
        .try_map(|word| Choice::find(list, &word).ok_or("not a word of the table"))
}

pub fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("not a number: {text}"))?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("not a positive number".to_owned())
    }
}

fn memory_size(text: &str) -> Result<u64, String> {
    let size = text.trim_end_matches(['b', 'B']);
    let (number, shift) = match size.split_at_checked(size.len().saturating_sub(1)) {
        Some((number, "K" | "k")) => (number, 10),
        Some((number, "M" | "m")) => (number, 20),
        Some((number, "G" | "g")) => (number, 30),
        _ => (size, 0),
    };
    let value: u64 = number.trim().parse().map_err(|_| format!("not a size: {text}"))?;
    value.checked_shl(shift).filter(|v| v >> shift == value).ok_or_else(|| "too large".to_owned())
}
