//! What is said beside the results.

use lindstedt_report::harmless;
use std::io::Write;

/// One line on standard error; a stream that is closed or full is no reason to fail.
pub fn warn(message: &str) {
    let _ = writeln!(std::io::stderr(), "lindstedt: {}", harmless(message));
}
