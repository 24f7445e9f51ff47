//! Writing results: every file appears whole under its name, or what was there stays.

use crate::failure::Failure;
use same_file::is_same_file;
use std::fs::{File, OpenOptions, Permissions, metadata};
use std::io::{BufWriter, Error, ErrorKind, IntoInnerError, Result, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// A younger file may be one that is about to be locked.
const STALE: Duration = Duration::from_secs(60);
/// Links that are followed at most.
const MOST_LINKS: usize = 40;

/// Writes a result to the file asked for or to standard output.
///
/// A reader that closes the pipe early (`| head`) is no failure.
pub fn write(out: Option<&Path>, text: &str) -> std::result::Result<(), Failure> {
    if let Some(path) = out {
        return write_file(path, text);
    }
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(trouble("standard output", &error))
        }
        _ => Ok(()),
    }
}

/// Writes a file beside the one that a name leads to, and gives it the name when its last byte is on the disk.
pub fn write_file(path: &Path, text: &str) -> std::result::Result<(), Failure> {
    write_with(path, |to| to.write_all(text.as_bytes()).map(|()| true)).map(drop)
}

/// The same for what is written piece by piece. What was there stays, too, where `write` says that there is nothing
/// to be kept; whether there was.
pub fn write_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<bool>,
) -> std::result::Result<bool, Failure> {
    let written = || -> Result<bool> {
        let target = target(path)?;
        // A device or a pipe has no name to take over.
        if metadata(&target).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            let mut to = BufWriter::new(OpenOptions::new().write(true).open(&target)?);
            return write(&mut to).and_then(|kept| to.flush().map(|()| kept));
        }
        let mut to = BufWriter::new(beside(&target)?);
        if !write(&mut to)? {
            return Ok(false);
        }
        let file = to.into_inner().map_err(IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        file.persist(&target).map(|_| true).map_err(|error| error.error)
    };
    written().map_err(|error| trouble(&path.display().to_string(), &error))
}

/// Fails now rather than after the work if a file cannot be written; makes and deletes nothing that stays.
pub fn check_file(path: &Path) -> std::result::Result<(), Failure> {
    let checked = || -> Result<()> {
        let target = target(path)?;
        match metadata(&target) {
            // To open a pipe waits for its reader.
            Ok(found) if !found.is_file() && !found.is_dir() => Ok(()),
            _ => beside(&target).map(drop),
        }
    };
    checked().map_err(|error| trouble(&path.display().to_string(), &error))
}

/// An empty file in the folder of another one, with its permissions, if that one may be written.
fn beside(target: &Path) -> Result<NamedTempFile> {
    let folder = folder(target);
    let prefix = prefix(target);
    remove_stale(folder, &prefix);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let there: Option<Permissions> = match OpenOptions::new().append(true).open(target) {
        Ok(file) => Some(file.metadata()?.permissions()),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let file = builder.tempfile_in(folder)?;
    // Whoever looks for stale files sees that this one is not.
    let _ = file.as_file().try_lock();
    if let Some(permissions) = there {
        file.as_file().set_permissions(permissions)?;
    }
    Ok(file)
}

/// What the name of a file begins with while it is written.
fn prefix(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default();
    format!(".lindstedt-{:08x}-", crc32fast::hash(name.as_encoded_bytes()))
}

/// Removes what a run left that was killed while it wrote the same file: nobody holds it.
fn remove_stale(folder: &Path, prefix: &str) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let named = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with(prefix);
        let old = |file: &File| {
            let modified = file.metadata().and_then(|found| found.modified());
            modified.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > STALE))
        };
        if named(&entry.file_name())
            && File::open(entry.path()).is_ok_and(|file| old(&file) && file.try_lock().is_ok())
        {
            // What cannot be removed does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Where a name leads to, through links, whether anything is there or not.
fn target(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&path) {
            Ok(link) => path = folder(&path).join(link),
            Err(_) => {
                let name = path.file_name().ok_or(ErrorKind::InvalidInput)?;
                return Ok(folder(&path).canonicalize()?.join(name));
            }
        }
    }
    Err(Error::other("too many links"))
}

/// Refuses two names of one file, of which at least one is written.
pub fn check_distinct(
    written: &[(&str, &Path)],
    read: Option<(&str, &Path)>,
) -> std::result::Result<(), Failure> {
    let all: Vec<_> = read.into_iter().chain(written.iter().copied()).collect();
    for (place, (what, path)) in all.iter().enumerate() {
        let same = |other: &Path| {
            let targets = target(path).ok().zip(target(other).ok());
            targets.is_some_and(|(a, b)| a == b) || is_same_file(path, other).unwrap_or(false)
        };
        if let Some((other, _)) = all[..place].iter().find(|(_, other)| same(other)) {
            let message = format!("{what} and {other} are one file, {}", path.display());
            return Err(Failure::usage("same-file", message, "give each a name of its own"));
        }
    }
    Ok(())
}

/// Whether the name of a file ends so.
pub fn is(path: &Path, kind: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind))
}

/// Refuses names that are neither figure nor table.
pub fn check_plots(paths: &[PathBuf]) -> std::result::Result<(), Failure> {
    match paths.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
        None => Ok(()),
        Some(path) => {
            let message = format!("cannot plot to {}", path.display());
            Err(Failure::usage("plot", message, "the name must end in .svg or .csv"))
        }
    }
}

/// The file that lines are added to, for this run alone.
pub fn open_to_append(path: &Path) -> Result<File> {
    let file = OpenOptions::new().append(true).create(true).open(path)?;
    match file.try_lock() {
        Err(std::fs::TryLockError::WouldBlock) => Err(Error::other("another run writes it")),
        // Where files cannot be locked nothing is known about other runs.
        _ => Ok(file),
    }
}

/// A failure of the file system.
pub fn trouble(what: &str, error: &Error) -> Failure {
    Failure::file(format!("cannot write {what}: {error}"), "")
}
