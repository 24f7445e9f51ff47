//! Words that are not one of a closed list.

/// A word that is not one of a closed list.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} {found:?}; known: {}", known.join(", "))]
pub struct UnknownName {
    /// What was expected.
    pub what: &'static str,
    /// The word, at most 60 characters of it.
    pub found: String,
    /// The words there are.
    pub known: Vec<&'static str>,
}

impl UnknownName {
    /// The member of a list with that name.
    ///
    /// # Errors
    /// [`UnknownName`] with the names there are.
    pub fn find<T: Copy>(
        what: &'static str,
        text: &str,
        all: &[T],
        name: fn(T) -> &'static str,
    ) -> Result<T, Self> {
        all.iter().copied().find(|member| name(*member) == text).ok_or_else(|| {
            let known = all.iter().map(|member| name(*member)).collect();
            Self { what, found: text.chars().take(60).collect(), known }
        })
    }
}
