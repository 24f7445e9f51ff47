//! The native part of the Python package: cases, questions, answers and arrays, nothing computed.
//!
//! A question is a verb with options that are text, as on the command line; an answer crosses as JSON
//! and as the pages that the program prints. Work runs on a thread of its own without the
//! interpreter's lock; the thread that asked looks every 20 ms whether Ctrl-C was pressed, and stops it.

mod arrays;
mod case;
mod failure;
mod found;
mod options;
mod verbs;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<case::Case>()?;
    module.add_class::<found::Found>()?;
    module.add_class::<arrays::Frequency>()?;
    module.add_class::<arrays::Motions>()?;
    module.add_class::<arrays::Motion>()?;
    module.add_class::<arrays::Averaged>()?;
    module.add_class::<work::Means>()?;
    module.add_function(wrap_pyfunction!(case::problems, module)?)
}
