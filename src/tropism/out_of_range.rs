//! The one error of settings that are numbers.

/// A setting is out of its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{what} is {value}; allowed: {allowed}")]
pub struct OutOfRange {
    /// What is out of range.
    pub what: &'static str,
    /// Its value.
    pub value: f32,
    /// What it may be.
    pub allowed: &'static str,
}

/// Checks settings: what each is, its value, its least, its most, and both in words.
pub(super) fn check<const N: usize>(
    parts: [(&'static str, f32, f32, f32, &'static str); N],
) -> Result<(), OutOfRange> {
    match parts.into_iter().find(|(_, value, least, most, _)| !(*least..=*most).contains(value)) {
        Some((what, value, _, _, allowed)) => Err(OutOfRange { what, value, allowed }),
        None => Ok(()),
    }
}
