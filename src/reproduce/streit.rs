//! The figures of Streit, Federl & Sousa.

pub mod control;
mod models;
pub mod palms;
pub mod plants;
pub mod surface;

use core::fmt::Display;

/// A table as CSV: a header, then rows.
fn csv<const N: usize, T: Display>(header: [&str; N], rows: impl IntoIterator<Item = [T; N]>) -> String {
    let mut text = header.join(",") + "\n";
    for row in rows {
        text += &row.map(|cell| cell.to_string()).join(",");
        text.push('\n');
    }
    text
}
