//! Burgeon grows trees: every bud, internode and leaf is an entity.

pub mod assets;
pub mod chance;
pub mod environment;
pub mod files;
pub mod growth;
pub mod limits;
pub mod plant;
pub mod scenario;
pub mod shape;
pub mod species;
pub mod tropism;
