//! Growth steps.
fn main() {}
