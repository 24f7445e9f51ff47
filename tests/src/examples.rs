//! The examples of the library, as `cargo test --workspace` has built them: no test runs cargo. A test
//! of one package alone would run an old example, so what is older than a source is refused.

use std::env::consts::EXE_SUFFIX;
use std::error::Error;
use std::path::{Path, PathBuf};

/// An example, in the folder beside `deps`, in which the test lies that runs.
///
/// # Errors
/// It is not there or older than one of its sources.
pub fn example(name: &str) -> Result<PathBuf, Box<dyn Error>> {
    let own = std::env::current_exe()?;
    let profile = own.parent().and_then(Path::parent).ok_or("no profile folder")?;
    let path = profile.join(format!("examples/{name}{EXE_SUFFIX}"));
    let sources = std::fs::read_to_string(path.with_extension("d")).unwrap_or_default();
    match outdated(&path, &sources) {
        None => Ok(path),
        Some(why) => {
            let build = "`cargo build --release --package lindstedt --examples` builds it";
            Err(format!("example {name}: {why}; {build}").into())
        }
    }
}

/// What is wrong with a built file, whose sources cargo listed as `file: source source ...`.
fn outdated(path: &Path, sources: &str) -> Option<String> {
    let changed = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified()).ok();
    let Some(built) = changed(path) else { return Some("not built".to_owned()) };
    let Some((_, sources)) = sources.split_once(": ") else { return Some("no sources".to_owned()) };
    // A blank within a name is written with a backslash.
    let list = sources.trim().replace("\\ ", "\0");
    let mut list = list.split_whitespace().map(|source| PathBuf::from(source.replace('\0', " ")));
    let newer = list.find(|source| changed(source).is_none_or(|changed| changed > built))?;
    Some(format!("older than {}", newer.display()))
}

#[cfg(test)]
mod tests {
    use super::outdated;
    use std::error::Error;
    use std::path::Path;
    use std::time::{Duration, SystemTime};

    #[test]
    fn what_is_older_than_a_source_is_refused() -> Result<(), Box<dyn Error>> {
        let folder = std::env::temp_dir().join(format!("lindstedt program {}", std::process::id()));
        std::fs::create_dir_all(&folder)?;
        let (built, source) = (folder.join("built"), folder.join("source.rs"));
        let list = format!("built: {}", source.display().to_string().replace(' ', "\\ "));
        let at = |path: &Path, seconds| {
            let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
            std::fs::File::create(path)?.set_modified(time)
        };
        assert_eq!(outdated(&built, &list).as_deref(), Some("not built"));
        at(&built, 2000)?;
        assert!(outdated(&built, &list).is_some());
        at(&source, 1000)?;
        assert_eq!(outdated(&built, &list), None);
        assert!(outdated(&built, "").is_some());
        at(&source, 3000)?;
        assert!(outdated(&built, &list).is_some_and(|why| why.starts_with("older than")));
        std::fs::remove_dir_all(folder)?;
        Ok(())
    }
}
