//! Writing results.

use crate::failure::{FILE, Failure};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a result to the file asked for or to standard output.
///
/// A reader that closes the pipe early (`| head`) is no failure.
pub fn write(out: Option<&Path>, text: &str) -> Result<(), Failure> {
    let Some(path) = out else {
        let mut stdout = std::io::stdout().lock();
        return match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                Err(trouble("standard output", &error))
            }
            _ => Ok(()),
        };
    };
    std::fs::write(path, text).map_err(|error| trouble(&path.display().to_string(), &error))
}

/// Fails now rather than after the work if a file cannot be written.
pub fn check_file(path: &Path) -> Result<(), Failure> {
    let existed = path.exists();
    let opened = std::fs::OpenOptions::new().append(true).create(true).open(path);
    opened.map_err(|error| trouble(&path.display().to_string(), &error))?;
    if !existed {
        let _ = std::fs::remove_file(path);
    }
    Ok(())
}

/// Whether the name of a file ends so.
pub fn is(path: &Path, kind: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind))
}

/// Refuses names that are neither figure nor table.
pub fn check_plots(paths: &[PathBuf]) -> Result<(), Failure> {
    match paths.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
        None => Ok(()),
        Some(path) => {
            let message = format!("cannot plot to {}", path.display());
            Err(Failure::usage("plot", message, "the name must end in .svg or .csv"))
        }
    }
}

/// Writes a figure or a table.
pub fn write_file(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| trouble(&path.display().to_string(), &error))
}

/// A failure of the file system.
pub fn trouble(what: &str, error: &std::io::Error) -> Failure {
    Failure {
        exit: FILE,
        code: "file",
        message: format!("cannot write {what}: {error}"),
        hint: String::new(),
    }
}
