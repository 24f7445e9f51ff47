//! A preprocessor of mdBook: the mathematics of every page as MathML. Reads `[context, book]`
//! from standard input and writes the book.

use lindstedt_tests::mathematics::render;
use serde_json::Value;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().nth(1).as_deref() == Some("supports") {
        return Ok(());
    }
    let (_, mut book): (Value, Value) = serde_json::from_reader(std::io::stdin())?;
    chapters(&mut book)?;
    serde_json::to_writer(std::io::stdout(), &book)?;
    Ok(())
}

/// Every `content`, at any depth.
fn chapters(value: &mut Value) -> Result<(), String> {
    match value {
        Value::Object(map) => {
            if let Some(Value::String(content)) = map.get_mut("content") {
                *content = render(content)?;
            }
            map.values_mut().try_for_each(chapters)
        }
        Value::Array(list) => list.iter_mut().try_for_each(chapters),
        _ => Ok(()),
    }
}
