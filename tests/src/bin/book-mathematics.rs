//! A preprocessor of mdBook: the mathematics of every page as MathML. Reads `[context, book]`
//! from standard input and writes the book.

use lindstedt_tests::mathematics::preprocess;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().nth(1).as_deref() == Some("supports") {
        return Ok(());
    }
    preprocess(std::io::stdin().lock(), std::io::stdout().lock())
}
