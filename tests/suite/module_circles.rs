//! Within a crate no two modules use each other, directly or through others. A module is a file;
//! it uses another when a path in its text (in `use` or inline) leads there, re-exports followed to
//! where the name is written. A module and those inside it are one thing to a reader: what they use
//! of each other does not count. And crates import what the book's table of them says.
//!
//! Only the standard library: `.ci/run` compiles this file alone and runs it before all else.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

type Module = Vec<String>;

/// The modules of a crate, with the imports of each.
#[derive(Default)]
struct Crate {
    /// The text of every module, without comments, literals and unit tests.
    texts: BTreeMap<Module, String>,
    /// Names that a module imports, with the paths that they stand for.
    imports: BTreeMap<Module, BTreeMap<String, Module>>,
}

impl Crate {
    fn read(source: &Path) -> Result<Self, Box<dyn Error>> {
        let mut found = Self::default();
        found.add(source, &Module::new())?;
        Ok(found.with_imports())
    }

    fn with_imports(mut self) -> Self {
        for (module, text) in &self.texts {
            let names = used(text).into_iter().flat_map(|tree| leaves(&tree)).collect();
            self.imports.insert(module.clone(), names);
        }
        self
    }

    fn add(&mut self, folder: &Path, above: &Module) -> Result<(), Box<dyn Error>> {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
            let own = above.iter().cloned().chain([name.to_owned()]).collect();
            if path.is_dir() {
                self.add(&path, &own)?;
            } else if path.extension().is_some_and(|end| end == "rs") && name != "tests" {
                let root = matches!(name, "mod" | "lib" | "main");
                let text = bare(&std::fs::read_to_string(&path)?);
                self.texts.insert(if root { above.clone() } else { own }, text);
            }
        }
        Ok(())
    }

    /// The module in which the path ends, as it reads in a module; nothing for another crate.
    fn resolve(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (first, rest) = path.split_first()?;
        let inner = |module: Module| self.descend(module, rest, depth);
        match first.as_str() {
            "crate" => inner(Module::new()),
            "self" => inner(from.clone()),
            "super" => inner(from.split_last()?.1.to_vec()),
            name => {
                let child = child(from, name);
                if self.texts.contains_key(&child) {
                    return inner(child);
                }
                let import = self.imports.get(from)?.get(name).filter(|_| depth < 9)?;
                let whole: Module = import.iter().chain(rest).cloned().collect();
                self.resolve(from, &whole, depth + 1)
            }
        }
    }

    fn descend(&self, module: Module, path: &[String], depth: usize) -> Option<Module> {
        let Some((first, rest)) = path.split_first() else { return Some(module) };
        if first == "super" {
            return self.descend(module.split_last()?.1.to_vec(), rest, depth);
        }
        let child = child(&module, first);
        if self.texts.contains_key(&child) {
            return self.descend(child, rest, depth);
        }
        // What a module re-exports comes from where it is written.
        let import = self.imports.get(&module).and_then(|names| names.get(first));
        let real = import.filter(|_| depth < 9).and_then(|import| {
            let whole: Module = import.iter().chain(rest).cloned().collect();
            self.resolve(&module, &whole, depth + 1)
        });
        Some(real.unwrap_or(module))
    }

    /// The modules that a module uses.
    fn edges(&self, module: &Module) -> BTreeSet<Module> {
        let text = self.texts.get(module).map_or("", String::as_str);
        let trees = used(text).into_iter().flat_map(|tree| leaves(&tree)).map(|(_, path)| path);
        let found = trees.chain(inline(text)).filter_map(|path| self.resolve(module, &path, 0));
        found.filter(|target| !target.starts_with(module) && !module.starts_with(target)).collect()
    }

    /// Sets of modules each of which is reached from the others.
    fn circles(&self) -> BTreeSet<Vec<Module>> {
        let edges: BTreeMap<&Module, BTreeSet<Module>> =
            self.texts.keys().map(|module| (module, self.edges(module))).collect();
        let reached = |start: &Module| {
            let mut seen = BTreeSet::new();
            let mut open = vec![start];
            while let Some(module) = open.pop() {
                for next in edges.get(module).into_iter().flatten() {
                    if seen.insert(next) {
                        open.push(next);
                    }
                }
            }
            seen
        };
        let all: BTreeMap<&Module, BTreeSet<&Module>> =
            self.texts.keys().map(|module| (module, reached(module))).collect();
        let circle = |module: &&Module| -> Vec<Module> {
            let mutual = |other: &&&Module| all[*other].contains(*module);
            all[*module].iter().filter(mutual).map(|other| (*other).clone()).collect()
        };
        all.keys().map(circle).filter(|circle| circle.len() > 1).collect()
    }
}

fn child(module: &Module, name: &str) -> Module {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

/// The text without comments, literals and the unit tests at its end.
fn bare(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code = |line: &str| -> String {
        let code = line.split("//").next().unwrap_or_default();
        code.split('"').step_by(2).collect::<Vec<_>>().join("\"")
    };
    text.lines().map(code).collect::<Vec<_>>().join("\n")
}

/// What stands between `use` and its semicolon, every time.
fn used(text: &str) -> Vec<String> {
    let starts = |line: &&str| {
        let words = line.trim_start();
        let words = words.strip_prefix("pub").map_or(words, |rest| {
            rest.strip_prefix("(crate)").or(rest.strip_prefix("(super)")).unwrap_or(rest)
        });
        words.trim_start().starts_with("use ")
    };
    let mut list = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.find(starts) {
        let mut tree = line.split_once("use ").map_or(String::new(), |(_, rest)| rest.to_owned());
        while !tree.contains(';') {
            let Some(line) = lines.next() else { break };
            tree.push_str(line);
        }
        list.push(tree.split(';').next().unwrap_or_default().to_owned());
    }
    list
}

/// The names that a tree of imports brings, with their paths.
fn leaves(tree: &str) -> Vec<(String, Module)> {
    let tree = tree.trim();
    let Some((head, inner)) = tree.split_once('{') else {
        let (path, name) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path: Module = path.split("::").map(|word| word.trim().to_owned()).collect();
        if path.last().is_some_and(|last| last == "self" || last == "*") && path.len() > 1 {
            path.pop();
        }
        let last = path.last().cloned().unwrap_or_default();
        return vec![(if name.is_empty() { last } else { name.trim().to_owned() }, path)];
    };
    let inner = inner.rsplit_once('}').map_or(inner, |(inner, _)| inner);
    let mut parts = vec![String::new()];
    let mut depth = 0;
    for c in inner.chars() {
        match c {
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        parts.last_mut().into_iter().for_each(|part| part.push(c));
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| leaves(&format!("{head}{}", part.trim()))).collect()
}

/// The paths outside of `use`: words joined by `::`.
fn inline(text: &str) -> Vec<Module> {
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    let words = text.split(|c: char| !word(c)).filter(|path| path.contains("::"));
    let path = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    words.map(path).filter(|path| !path[0].is_empty()).collect()
}

/// Every circle of a crate, as the modules in it.
fn shown(name: &str, found: &Crate) -> Vec<String> {
    let join = |module: &Module| match module.is_empty() {
        true => "crate".to_owned(),
        false => module.join("::"),
    };
    let circle = |circle: &Vec<Module>| {
        format!("{name}: {}", circle.iter().map(join).collect::<Vec<_>>().join(", "))
    };
    found.circles().iter().map(circle).collect()
}

#[test]
fn no_module_circles() -> Result<(), Box<dyn Error>> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let mut circles = BTreeSet::new();
    for entry in std::fs::read_dir(crates)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        circles.extend(shown(name, &Crate::read(&path.join("src"))?));
    }
    assert!(circles.is_empty(), "modules use each other: {circles:#?}");
    Ok(())
}

#[test]
fn a_circle_is_found() {
    let crate_of = |texts: [(&str, &str); 4]| {
        let texts = texts.map(|(name, text)| {
            let path = name.split("::").filter(|name| !name.is_empty()).map(str::to_owned);
            (path.collect(), bare(text))
        });
        Crate { texts: BTreeMap::from(texts), ..Crate::default() }.with_imports()
    };
    // a uses b inline, b uses a::c by a name that the root re-exports, under another name.
    let root = "mod a;\nmod b;\npub use a::c::{Deep as High,\n    other};";
    let a = "//! crate::b\nmod c;\nfn f() { crate::b::g() }";
    let circle =
        crate_of([("", root), ("a", a), ("a::c", "use crate::b;"), ("b", "use super::High;")]);
    assert_eq!(shown("x", &circle), ["x: a::c, b"]);
    let b = "// crate::a::c\nfn g() { \"crate::a\" }\n#[cfg(test)]\nmod tests {\n use crate::a::c::Deep;";
    let none = crate_of([("", root), ("a", a), ("a::c", "use super::super::b;"), ("b", b)]);
    assert_eq!(shown("x", &none), [""; 0]);
}

/// Of a row of words, as "all", the crates named are among those imported.
#[test]
fn crates_import_what_the_book_says() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/src/contributing/architecture.md"))?;
    let mut rows = 0;
    for line in page.lines().filter(|line| line.starts_with("| `")) {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let name = cells.next().unwrap_or_default().trim_matches('`');
        let cell = cells.next_back().unwrap_or_default();
        let said: BTreeSet<&str> = cell.split('`').skip(1).step_by(2).collect();
        let folder = if name == "tests" || name == "python" { "" } else { "crates" };
        let manifest = std::fs::read_to_string(root.join(folder).join(name).join("Cargo.toml"))?;
        let from = manifest.split("\n[dependencies]\n").nth(1).unwrap_or_default();
        let ours = from.lines().take_while(|line| !line.starts_with('[')).filter_map(|line| {
            let name = line.strip_suffix(".workspace = true")?.strip_prefix("lindstedt")?;
            Some(if name.is_empty() { "lindstedt" } else { name.trim_start_matches('-') })
        });
        let ours: BTreeSet<&str> = ours.collect();
        let whole = !cell.contains("all") && !cell.contains("below");
        let right = if whole { said == ours } else { said.is_subset(&ours) };
        assert!(right, "{name}: the book says {cell}, its manifest {ours:?}");
        rows += 1;
    }
    assert_eq!(rows, std::fs::read_dir(root.join("crates"))?.count() + 2);
    Ok(())
}
