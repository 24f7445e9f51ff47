//! Cost of charts.
fn main() {
    divan::main();
}
