//! The text of a problem file: TOML with positions, then key by key.

use crate::file::{LARGEST_FILE, ProblemFile};
use crate::file_error::{FileError, FileErrorKind};
use crate::reader::Reader;
use crate::reading::read;
use crate::schema::Schema;

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
        let missing = || {
            let message = "one of the keys `equation` and `equations` is needed".to_owned();
            reader.error(FileErrorKind::Toml { message }, 0)
        };
        read(&reader, schema.with_equations().ok_or_else(missing)?)
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
