//! The figures of the papers, grown and measured.
