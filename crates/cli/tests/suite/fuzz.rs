//! Random command lines and mutated problem files: every one ends in an answer or in a refusal of the
//! contract. Seeded; the nightly run is
//! `cargo test --release -p lindstedt-cli --test suite fuzz -- --ignored`.

mod files;
mod lines;

use serde_json::Value;

/// A number of the environment.
pub fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// How many, unless the environment says how many.
pub fn count(usual: usize) -> usize {
    number("LINDSTEDT_FUZZ").map_or(usual, |count| count as usize)
}

/// Infinities and NaN as words of their own; those of the question are repeated in the answer.
pub fn not_a_number(text: &str, question: &str) -> Option<String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut words = text.split(|c: char| !is_word(c));
    let named = |word: &&str| {
        let word = word.to_ascii_lowercase();
        matches!(&*word, "inf" | "nan") && !question.to_lowercase().contains(&word)
    };
    words.find(named).map(ToOwned::to_owned)
}

/// The hint of a refusal in JSON; nothing where it is no refusal.
pub fn refusal(shown: &str) -> Option<(String, String, String)> {
    let value: Value = serde_json::from_str(shown).ok()?;
    let error = value.get("error").filter(|error| error.is_object())?;
    let part = |name: &str| error[name].as_str().unwrap_or_default().to_owned();
    Some((part("code"), part("message"), part("hint")))
}
