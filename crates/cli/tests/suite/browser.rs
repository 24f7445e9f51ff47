//! The report and the figures of the book in a real browser, headless Chromium, offline: glyphs, width,
//! print. Without a browser these tests say so on standard output and check nothing; what needs no
//! browser is checked in any case.

mod chromium;

use crate::program::{command, root};
use chromium::{Chromium, skipped};
use serde_json::Value as Json;
use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

type Outcome = Result<(), Box<dyn Error>>;

/// The folder of `lindstedt paper --quick`, written once for all tests.
pub fn folder() -> Result<&'static Path, Box<dyn Error>> {
    static FOLDER: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let made = FOLDER.get_or_init(|| write_report().map_err(|error| error.to_string()));
    Ok(made.as_deref().map_err(Clone::clone)?)
}

fn write_report() -> Result<PathBuf, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("paper");
    let run = command(&["paper", "--quick", "--quiet", "--out"]).arg(&folder).output()?;
    assert!(run.status.success(), "paper: {run:?}");
    let said = String::from_utf8(run.stdout)?;
    let page = folder.join("report.html");
    let expected = format!("wrote {} (", page.display());
    assert!(said.starts_with(&expected) && said.contains(" statements: "), "{said}");
    Ok(folder)
}

fn page() -> Result<String, Box<dyn Error>> {
    Ok(std::fs::read_to_string(folder()?.join("report.html"))?)
}

/// The counts and what fails of every section stand before the first section; the page is dark where its reader wants that.
#[test]
fn the_first_screen() -> Outcome {
    let html = page()?;
    let (first, _) = html.split_once("id=\"trust\"").ok_or("no findings")?;
    assert!(first.contains("138 statements: ") && first.contains("names no journal and no year"));
    let (_, fails) = first.split_once("id=\"fails\"").ok_or("nothing fails")?;
    let (fails, _) = fails.split_once("</section>").ok_or("no end")?;
    assert_eq!(fails.matches("<li>").count(), 3, "{fails}");
    assert!(html.contains("(prefers-color-scheme: dark)"));
    Ok(())
}

/// The text of the page is what the net holds of `lindstedt paper --quick`.
#[test]
fn the_report_as_text() -> Outcome {
    let text = std::fs::read_to_string(folder()?.join("report.txt"))?;
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/net/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description("lindstedt paper --quick");
    settings.bind(|| insta::assert_snapshot!("paper-quick", format!("==== text (exit 0)\n{text}")));
    Ok(())
}

/// The values of an attribute.
fn attributes<'a>(html: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    html.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// Nothing is fetched, all links lead somewhere, all formulas are there.
#[test]
fn the_page_is_self_contained() -> Outcome {
    let html = page()?;
    for part in html.split("http").skip(1) {
        assert!(part.starts_with("://www.w3.org/"), "http{}", &part[..40.min(part.len())]);
    }
    for forbidden in ["<link", "@import", "url(", "<iframe", "<img", " src="] {
        assert!(!html.contains(forbidden), "{forbidden}");
    }
    let ids = attributes(&html, "id");
    let distinct: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), distinct.len(), "an id twice");
    for target in attributes(&html, "href") {
        match target.strip_prefix('#') {
            Some(id) => assert!(distinct.contains(id), "no place {target}"),
            None => assert!(folder()?.join(target).is_file(), "no file {target}"),
        }
    }
    for number in 1..=51 {
        assert!(html.contains(&format!(">({number})</a>")), "no formula ({number})");
    }
    assert!(html.matches("<svg").count() >= 4 && html.matches("<math>").count() > 500);
    Ok(())
}

/// What the page says of itself in a window of that width.
fn probe(name: &str, html: &str, width: u32) -> Result<Option<Json>, Box<dyn Error>> {
    let Some(browser) = Chromium::find() else {
        skipped(name)?;
        return Ok(None);
    };
    browser.probe(name, html, (width, 900)).map(Some)
}

fn list<'a>(found: &'a Json, key: &str) -> &'a [Json] {
    found[key].as_array().map_or(&[], Vec::as_slice)
}

fn number(found: &Json, key: &str) -> f64 {
    found[key].as_f64().unwrap_or(f64::NAN)
}

#[test]
fn on_a_wide_screen() -> Outcome {
    let Some(found) = probe("wide", &page()?, 1200)? else { return Ok(()) };
    assert!(list(&found, "missing").is_empty(), "no glyphs for {}", found["missing"]);
    assert!(list(&found, "requests").is_empty(), "requests: {}", found["requests"]);
    assert!(list(&found, "outside").is_empty(), "text outside its figure: {}", found["outside"]);
    assert!(number(&found, "characters") > 20.0, "too few characters were looked at: {found}");
    assert!(number(&found, "scroll") <= number(&found, "width"), "{found}");
    // Formulas have a height of their own: they are laid out, not shown as tags.
    assert!(number(&found, "fractions") > 30.0 && number(&found, "flat") == 0.0, "{found}");
    Ok(())
}

#[test]
fn on_a_narrow_screen() -> Outcome {
    let Some(found) = probe("narrow", &page()?, 360)? else { return Ok(()) };
    assert_eq!(number(&found, "width"), 360.0, "the window has another width");
    assert!(number(&found, "scroll") <= 360.0, "the page is wider than the screen: {found}");
    Ok(())
}

/// As printed: nothing wider than an A4 page between its margins, all evidence open.
#[test]
fn in_print() -> Outcome {
    let html = page()?;
    assert_eq!(html.matches("@media print").count(), 1);
    let printed = html.replace("@media print", "@media all");
    // 210 mm less two margins of 16 mm, 96 dots per inch.
    let Some(found) = probe("print", &printed, 672)? else { return Ok(()) };
    assert!(number(&found, "scroll") <= number(&found, "width"), "cut at the right: {found}");
    assert_eq!(number(&found, "folded"), 0.0, "evidence is not printed: {found}");
    let Some(browser) = Chromium::find() else { return Ok(()) };
    let pdf = browser.print(&folder()?.join("report.html"))?;
    assert!(pdf.starts_with(b"%PDF"));
    let text = String::from_utf8_lossy(&pdf);
    let pages = text.matches("/Type /Page\n").count() + text.matches("/Type /Page ").count();
    assert!((10..=80).contains(&pages), "{pages} pages");
    Ok(())
}

/// All figures of the book and of the report, on one page: every word inside its picture, every glyph there.
#[test]
fn figures() -> Outcome {
    let mut html = "<!DOCTYPE html><meta charset=\"utf-8\"><body>".to_owned();
    let mut count = 0;
    for folder in [root().join("docs/src/figures"), folder()?.to_path_buf()] {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "svg") {
                html += &std::fs::read_to_string(&path)?;
                count += 1;
            }
        }
    }
    html += "</body>";
    assert!(count >= 5, "{count} figures");
    let Some(found) = probe("figures", &html, 1200)? else { return Ok(()) };
    for key in ["missing", "outside", "requests", "bare"] {
        assert!(list(&found, key).is_empty(), "{key}: {}", found[key]);
    }
    assert!(number(&found, "figures") >= f64::from(count), "{found}");
    Ok(())
}

/// The probe sees what it looks for.
#[test]
fn the_probe_can_fail() -> Outcome {
    let bad = "<!DOCTYPE html><meta charset=\"utf-8\"><body><p>x\u{379}\u{3b1}</p>\
               <details><summary>s</summary>hidden</details>\
               <div style=\"width:2000px\">wide</div>\
               <img src=\"http://nowhere.invalid/x.png\">\
               <svg width=\"100\" height=\"50\"><text x=\"90\" y=\"20\">outside</text></svg></body>";
    let Some(found) = probe("bad", bad, 360)? else { return Ok(()) };
    assert_eq!(found["missing"], serde_json::json!(["U+379"]), "{found}");
    assert!(number(&found, "scroll") > 1999.0, "{found}");
    assert_eq!(list(&found, "outside").len(), 1, "{found}");
    assert_eq!(number(&found, "folded"), 1.0, "{found}");
    assert_eq!(list(&found, "requests").len(), 1, "{found}");
    Ok(())
}
