//! The book becomes HTML: through the preprocessor that `docs/book.toml` names, as mdBook calls it,
//! and through the Markdown parser of mdBook. So a page that would come out wrong is found without
//! mdBook, which takes two minutes to build.

use super::{Outcome, included, links, root};
use lindstedt_tests::mathematics::preprocess;
use pulldown_cmark::{Options, Parser, html::push_html};
use serde_json::{Value, json};
use std::error::Error;
use std::path::PathBuf;

/// The pages in the order of the summary, with the files that they include.
fn chapters() -> Result<Vec<(PathBuf, String)>, Box<dyn Error>> {
    let folder = root().join("docs/src");
    let summary = std::fs::read_to_string(folder.join("SUMMARY.md"))?;
    let mut list = Vec::new();
    for path in links(&summary).iter().map(|link| folder.join(link)) {
        let mut text = String::new();
        for line in std::fs::read_to_string(&path)?.lines() {
            match included(&path, line) {
                Some(file) => text.push_str(&std::fs::read_to_string(file)?),
                None => text.push_str(line),
            }
            text.push('\n');
        }
        list.push((path, text));
    }
    Ok(list)
}

/// What the preprocessor makes of the pages, in their order.
fn preprocessed(pages: &[String]) -> Result<Vec<String>, Box<dyn Error>> {
    let chapter =
        |text: &String| json!({"Chapter": {"name": "", "content": text, "sub_items": []}});
    let items: Vec<Value> = pages.iter().map(chapter).collect();
    let book = json!([{"renderer": "html", "mdbook_version": "0.5.4"}, {"items": items}]);
    let mut written = Vec::new();
    preprocess(book.to_string().as_bytes(), &mut written)?;
    let book: Value = serde_json::from_slice(&written)?;
    let items = book["items"].as_array().ok_or("no items")?;
    let content = |item: &Value| item["Chapter"]["content"].as_str().map(str::to_owned);
    Ok(items.iter().map(content).collect::<Option<_>>().ok_or("no content")?)
}

fn html(markdown: &str) -> String {
    let options = Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_HEADING_ATTRIBUTES;
    let mut text = String::new();
    push_html(&mut text, Parser::new_ext(markdown, options));
    text
}

/// What is wrong with a page: a formula not drawn, spoiled by the Markdown around it, or cut off by
/// a paragraph that ends within it; an inclusion that is left; a table that is text.
fn fault(markdown: &str, html: &str) -> Option<String> {
    let prose = without_code(html);
    let math = |text: &str| (text.matches("<math").count(), text.matches("</math>").count());
    let (drawn, kept) = (math(&without_code(markdown)), math(&prose));
    let mut rest = prose.as_str();
    while let Some((_, formula)) = rest.split_once("<math") {
        let (formula, after) = formula.split_once("</math>").unwrap_or((formula, ""));
        if let Some(tag) = ["<p>", "</p>", "<em>", "<li>", "</td>", "<a "]
            .iter()
            .find(|tag| formula.contains(**tag))
        {
            return Some(format!("{tag} within a formula"));
        }
        rest = after;
    }
    if drawn != kept || kept.0 != kept.1 {
        return Some(format!("{drawn:?} formulas in Markdown, {kept:?} in HTML"));
    }
    ["$$", "{{#", "&lt;math", "<p>|"]
        .iter()
        .find(|sign| prose.contains(**sign))
        .map(|s| s.to_string())
}

/// The text without what is between `<code` and its end.
fn without_code(html: &str) -> String {
    let mut parts = html.split("<code");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once("</code>").map_or("", |(_, rest)| rest))
}

#[test]
fn every_page_becomes_html() -> Outcome {
    let settings = std::fs::read_to_string(root().join("docs/book.toml"))?;
    assert!(settings.contains("debug/book-mathematics\"") && settings.contains("src = \"src\""));
    let (paths, pages): (Vec<_>, Vec<_>) = chapters()?.into_iter().unzip();
    let pages = preprocessed(&pages)?;
    let mut formulas = 0;
    for (path, page) in paths.iter().zip(&pages) {
        let html = html(page);
        assert_eq!(fault(page, &html), None, "{}", path.display());
        assert!(html.contains("<h1"), "{} has no title", path.display());
        formulas += html.matches("<math").count();
    }
    assert!(paths.len() > 30 && formulas > 100, "{} pages, {formulas} formulas", paths.len());
    Ok(())
}

#[test]
fn a_spoiled_page_is_found() -> Outcome {
    let found = |page: &str| -> Result<Option<String>, Box<dyn Error>> {
        let page = preprocessed(&[page.to_owned()])?.swap_remove(0);
        Ok(fault(&page, &html(&page)))
    };
    assert_eq!(found("# a\n\n$x_1*y*z_2$ and `$$`\n\n| a |\n|---|\n| $x$ |\n")?, None);
    assert!(found("# a\n\n{{#include missing}}\n")?.is_some());
    assert!(found("# a\n\n| a |\n|--|--|\n| b |\n")?.is_some());
    // Formulas that nobody escaped.
    for page in ["<math>*a*</math>", "<math>a\n\nb</math>", "\\<math>a</math>", "a $$b$$"] {
        assert!(fault(page, &html(page)).is_some(), "{page}");
    }
    Ok(())
}
