//! Share codes: a tree in a line of text, to be grown again by whoever gets it.
//!
//! ```text
//! base64url( version, packed?, body, check )
//! version  one byte; its highest bit says that the body is deflated
//! body     postcard
//! check    the lower three bytes of the CRC-32 of all before it
//! ```
//!
//! A scenario that ships with Burgeon is named by two bytes, and takes fewer than thirty characters unless it was
//! edited; any other is written out.

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde::{Deserialize, Serialize};

use super::{FileError, ResolvedScenario, ScenarioError, parse_value};
use crate::assets::Library;
use crate::limits;
use crate::scenario::{Scenario, TimedEdit};
use crate::species::Species;
use crate::species::parameter::ParameterError;

const VERSION: u8 = 1;
const PACKED: u8 = 0x80;
const CHECK: usize = 3;

/// Why a text is no share code; nothing of it was used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShareError {
    /// It has a character that no code has.
    #[error("not a share code: character {at} is {character:?}")]
    Character {
        /// Which character, from 1.
        at: usize,
        /// The character.
        character: char,
    },
    /// It is too short, or a character is missing or too many.
    #[error("not a whole share code: {characters} characters")]
    Cut {
        /// Its characters.
        characters: usize,
    },
    /// It is longer than [`limits::CODE_CHARACTERS`], or unpacks to more than a file may hold.
    #[error(
        "a share code has at most {} characters, and unpacks to at most {} bytes",
        limits::CODE_CHARACTERS,
        limits::FILE_BYTES
    )]
    TooLong,
    /// It was mistyped.
    #[error("a character of the share code is wrong, or some are missing: its check does not fit")]
    Check,
    /// It was made by another version.
    #[error("share code version {0}; this program reads version {VERSION}")]
    Version(u8),
    /// Its check fits, but it holds something else.
    #[error("the share code holds something else than a tree: {0}")]
    Malformed(String),
    /// It names a scenario this program does not ship.
    #[error("the share code is of a scenario this program does not have")]
    NoSuchScenario,
    /// Its scenario or an edit is not sound.
    #[error("the share code's scenario: {0}")]
    Scenario(#[from] ScenarioError),
    /// A parameter it sets is not sound.
    #[error("the share code's species: {0}")]
    Parameter(#[from] ParameterError),
    /// A species it names is not to be had.
    #[error("the share code's species: {0}")]
    Species(#[from] FileError),
}

/// What a share code holds: all that is needed to grow a tree again.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedTree {
    /// The scenario as it begins, with its species.
    pub resolved: ResolvedScenario,
    /// Edits made by hand, in the order they were made.
    pub edits: Vec<TimedEdit>,
    /// Seed of the run.
    pub seed: u64,
    /// Steps to grow.
    pub steps: u32,
}

#[derive(Serialize, Deserialize)]
enum Body {
    /// A shipped scenario as it is.
    Plain { id: [u8; 2], seed: u64, steps: u32 },
    /// A shipped scenario, edited.
    Edited { id: [u8; 2], seed: u64, steps: u32, edits: Vec<TimedEdit>, species: Vec<SharedSpecies> },
    /// A scenario of someone's own.
    Whole {
        scenario: Box<Scenario>,
        seed: u64,
        steps: u32,
        edits: Vec<TimedEdit>,
        species: Vec<SharedSpecies>,
    },
}

#[derive(Serialize, Deserialize)]
enum SharedSpecies {
    /// A shipped one but for some parameters.
    Changed(String, Vec<(String, String)>),
    /// Another one.
    Own(Box<Species>),
}

/// Two bytes that stand for the name of a shipped scenario; a test keeps them apart.
fn id_of(name: &str) -> [u8; 2] {
    let crc = crc32fast::hash(name.as_bytes()).to_le_bytes();
    [crc[0], crc[1]]
}

impl SharedTree {
    /// The code.
    ///
    /// # Errors
    /// [`ShareError::TooLong`].
    pub fn code(&self) -> Result<String, ShareError> {
        let library = Library::embedded();
        let scenario = &self.resolved.scenario;
        let shipped = library.scenario(&scenario.name).ok().filter(|found| found.scenario == *scenario);
        let species = shared_species(&self.resolved, &library);
        let (seed, steps) = (self.seed, self.steps);
        let body = match shipped {
            Some(_) if self.edits.is_empty() && species.is_empty() => {
                Body::Plain { id: id_of(&scenario.name), seed, steps }
            }
            Some(_) => {
                Body::Edited { id: id_of(&scenario.name), seed, steps, edits: self.edits.clone(), species }
            }
            None => {
                let scenario = Box::new(scenario.clone());
                Body::Whole { scenario, seed, steps, edits: self.edits.clone(), species }
            }
        };
        let plain = postcard::to_stdvec(&body).map_err(|e| ShareError::Malformed(e.to_string()))?;
        let packed = compress_to_vec(&plain, 9);
        let mut bytes = match packed.len() < plain.len() {
            true => [&[VERSION | PACKED], &packed[..]].concat(),
            false => [&[VERSION], &plain[..]].concat(),
        };
        let check = crc32fast::hash(&bytes).to_le_bytes();
        bytes.extend_from_slice(&check[..CHECK]);
        let code = encode(&bytes);
        if code.len() > limits::CODE_CHARACTERS || plain.len() as u64 > limits::FILE_BYTES {
            return Err(ShareError::TooLong);
        }
        Ok(code)
    }

    /// What a code holds. Space around and within it does not matter.
    ///
    /// # Errors
    /// [`ShareError`] if it is no code, damaged, of another version, or holds what is not sound.
    pub fn from_code(code: &str) -> Result<Self, ShareError> {
        let bytes = decode(code)?;
        let Some((body, check)) = bytes.split_last_chunk::<CHECK>() else {
            return Err(ShareError::Cut { characters: code.chars().count() });
        };
        if crc32fast::hash(body).to_le_bytes()[..CHECK] != *check {
            return Err(ShareError::Check);
        }
        let Some((version, body)) = body.split_first() else {
            return Err(ShareError::Cut { characters: code.chars().count() });
        };
        if version & !PACKED != VERSION {
            return Err(ShareError::Version(version & !PACKED));
        }
        let unpacked;
        let plain = if version & PACKED == 0 {
            body
        } else {
            unpacked = decompress_to_vec_with_limit(body, limits::FILE_BYTES as usize)
                .map_err(|e| ShareError::Malformed(e.to_string()))?;
            &unpacked
        };
        match postcard::take_from_bytes::<Body>(plain) {
            Ok((body, [])) => Self::from_body(body),
            Ok(_) => Err(ShareError::Malformed("more than a tree".into())),
            Err(e) => Err(ShareError::Malformed(e.to_string())),
        }
    }

    fn from_body(body: Body) -> Result<Self, ShareError> {
        let library = Library::embedded();
        let shipped = |id: [u8; 2]| {
            let name = library.scenario_names().into_iter().find(|name| id_of(name) == id);
            library.scenario(&name.ok_or(ShareError::NoSuchScenario)?).map_err(ShareError::from)
        };
        let (mut resolved, seed, steps, edits, species) = match body {
            Body::Plain { id, seed, steps } => (shipped(id)?, seed, steps, Vec::new(), Vec::new()),
            Body::Edited { id, seed, steps, edits, species } => (shipped(id)?, seed, steps, edits, species),
            Body::Whole { scenario, seed, steps, edits, species } => {
                let mut scenario = *scenario;
                scenario.validate()?;
                scenario.order_edits();
                (ResolvedScenario { scenario, species: Default::default() }, seed, steps, edits, species)
            }
        };
        if steps > limits::STEPS {
            return Err(ShareError::Malformed(format!("{steps} steps")));
        }
        for shared in species {
            let species = match shared {
                SharedSpecies::Own(species) => {
                    species.validate()?;
                    *species
                }
                SharedSpecies::Changed(name, values) => {
                    let mut species = Species { name: name.clone(), ..library.species(&name)? };
                    for (parameter, value) in values {
                        species.set(&parameter, &parse_value(&value))?;
                    }
                    species
                }
            };
            resolved.species.insert(species.name.clone(), species);
        }
        // Edits made by hand may sow what the scenario does not.
        let mut all = resolved.scenario.clone();
        all.edits.extend(edits.iter().cloned());
        all.validate()?;
        for (name, _) in all.species_named() {
            if !resolved.species.contains_key(name) {
                let species = Species { name: name.to_string(), ..library.species(name)? };
                resolved.species.insert(name.to_string(), species);
            }
        }
        Ok(Self { resolved, edits, seed, steps })
    }
}

/// What must be told of the species: those that are not just as shipped.
fn shared_species(resolved: &ResolvedScenario, library: &Library) -> Vec<SharedSpecies> {
    let told = resolved.species.iter().filter_map(|(name, species)| {
        let shipped = library.species(name).ok().map(|shipped| Species { name: name.clone(), ..shipped });
        let Some(shipped) = shipped else { return Some(SharedSpecies::Own(Box::new(species.clone()))) };
        if shipped == *species {
            return None;
        }
        let mut again = shipped.clone();
        let values: Vec<(String, String)> = species.differing(&shipped).map(|(p, v)| (p.into(), v)).collect();
        let told = values.iter().all(|(parameter, value)| again.set(parameter, &parse_value(value)).is_ok());
        // A text about it has changed, too: then all of it is told, for the same hash.
        Some(match told && again == *species {
            true => SharedSpecies::Changed(name.clone(), values),
            false => SharedSpecies::Own(Box::new(species.clone())),
        })
    });
    told.collect()
}

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// Base64 for addresses (RFC 4648, section 5), without padding.
fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0_u32, |word, i| word << 8 | u32::from(*chunk.get(i).unwrap_or(&0)));
        for i in 0..=chunk.len() {
            text.push(char::from(LETTERS[(word >> (18 - 6 * i)) as usize & 63]));
        }
    }
    text
}

fn decode(text: &str) -> Result<Vec<u8>, ShareError> {
    if text.len() > limits::CODE_CHARACTERS {
        return Err(ShareError::TooLong);
    }
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut word, mut bits, mut characters) = (0_u32, 0, 0);
    for (at, character) in text.chars().enumerate().filter(|(_, c)| !c.is_whitespace()) {
        let Some(value) = LETTERS.iter().position(|letter| char::from(*letter) == character) else {
            return Err(ShareError::Character { at: at + 1, character });
        };
        characters += 1;
        word = word << 6 | value as u32;
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((word >> bits) as u8);
            word &= (1 << bits) - 1;
        }
    }
    // Left over are fewer than six bits, all of them 0.
    if bits >= 6 || word != 0 {
        return Err(ShareError::Cut { characters });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_from_their_letters() {
        for n in 0..50_u8 {
            let bytes: Vec<u8> = (0..n).map(|i| i.wrapping_mul(97) ^ n).collect();
            assert_eq!(decode(&encode(&bytes)).unwrap(), bytes);
        }
        assert_eq!(encode(b"\xfb\xff"), "-_8");
        assert!(matches!(decode("ab+c"), Err(ShareError::Character { at: 3, character: '+' })));
        assert!(matches!(decode("a"), Err(ShareError::Cut { characters: 1 })));
    }

    #[test]
    fn every_shipped_scenario_has_two_bytes_of_its_own() {
        let names = Library::embedded().scenario_names();
        let mut ids: Vec<[u8; 2]> = names.iter().map(|name| id_of(name)).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), names.len());
    }
}
