//! Saves: a garden in the middle of its life, in one checked file.
//!
//! ```text
//! "BURGEON\x1a"  magic
//! u32            version of the format, little-endian
//! u64            length of the payload
//! u32            CRC-32 of version, length and payload
//! payload        postcard
//! ```

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::read::write_whole;
use crate::limits;
use crate::scenario::GardenSaveError;

const MAGIC: [u8; 8] = *b"BURGEON\x1a";
const VERSION: u32 = 6;
const HEADER: usize = 8 + 4 + 8 + 4;

/// What is wrong with a save; nothing of it was used.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// It could not be read or written; a failed write leaves the old file as it was.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// It is some other file.
    #[error("{file}: not a Burgeon save")]
    NotASave {
        /// The file.
        file: String,
    },
    /// It was written by another version.
    #[error("{file}: save version {version}; this program reads version {VERSION}")]
    Version {
        /// The file.
        file: String,
        /// Its version.
        version: u32,
    },
    /// It is larger than [`limits::SAVE_BYTES`].
    #[error("{file}: {bytes} bytes; a save has at most {limit}")]
    TooLarge {
        /// The file.
        file: String,
        /// Its bytes.
        bytes: u64,
        /// The most allowed.
        limit: u64,
    },
    /// Its end is missing.
    #[error("{file}: cut short: {present} of {expected} bytes")]
    Truncated {
        /// The file.
        file: String,
        /// Bytes there.
        present: u64,
        /// Bytes there should be.
        expected: u64,
    },
    /// Something follows its end.
    #[error("{file}: {extra} bytes too many")]
    TrailingBytes {
        /// The file.
        file: String,
        /// Bytes after the end.
        extra: u64,
    },
    /// It was damaged.
    #[error("{file}: damaged: its checksum does not match")]
    Checksum {
        /// The file.
        file: String,
    },
    /// Its payload is sound but not what was asked for.
    #[error("{file}: holds something else than expected: {reason}")]
    Malformed {
        /// The file.
        file: String,
        /// What does not fit.
        reason: String,
    },
    /// It is whole, but no garden can be in such a state.
    #[error("{file}: not a garden that can grow on: {source}")]
    Unsound {
        /// The file.
        file: String,
        /// What is wrong.
        source: GardenSaveError,
    },
}

fn checksum(header: &[u8], payload: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(header);
    crc.update(payload);
    crc.finalize()
}

/// Writes a save: a temporary file in the same folder, flushed, then renamed over the old one.
///
/// # Errors
/// If it is too large or cannot be written; the old file is untouched then.
pub fn write_save<T: Serialize>(path: &Path, value: &T) -> Result<(), SaveError> {
    let file = path.display().to_string();
    let payload = postcard::to_stdvec(value)
        .map_err(|e| SaveError::Malformed { file: file.clone(), reason: e.to_string() })?;
    let bytes = payload.len() as u64;
    if bytes > limits::SAVE_BYTES {
        return Err(SaveError::TooLarge { file, bytes, limit: limits::SAVE_BYTES });
    }
    let mut sized = [0; 12];
    sized[..4].copy_from_slice(&VERSION.to_le_bytes());
    sized[4..].copy_from_slice(&bytes.to_le_bytes());
    let crc = checksum(&sized, &payload).to_le_bytes();
    write_whole(path, &[&MAGIC, &sized, &crc, &payload]).map_err(|source| SaveError::Io { file, source })
}

/// Reads a save back.
///
/// # Errors
/// If it cannot be read, is no save, of another version, too large, cut short, too long, damaged, or holds
/// something else.
pub fn read_save<T: DeserializeOwned>(path: &Path) -> Result<T, SaveError> {
    let file = path.display().to_string();
    let io = |source| SaveError::Io { file: file.clone(), source };
    // A pipe would be waited for, a device never ends.
    if !std::fs::metadata(path).map_err(io)?.is_file() {
        return Err(SaveError::NotASave { file });
    }
    let mut reader = File::open(path).map_err(io)?;
    if !is_save(path) {
        let mut start = Vec::new();
        reader.take(HEADER as u64).read_to_end(&mut start).map_err(io)?;
        return decode(&start, file);
    }
    let present = reader.metadata().map_err(io)?.len();
    let most = limits::SAVE_BYTES + HEADER as u64;
    if present > most {
        return Err(SaveError::TooLarge { file, bytes: present, limit: limits::SAVE_BYTES });
    }
    // Grows with what is really there, whatever the header claims.
    let mut bytes = Vec::new();
    reader.by_ref().take(most).read_to_end(&mut bytes).map_err(io)?;
    decode(&bytes, file)
}

/// Whether a file begins as a save does.
pub fn is_save(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    let is_file = std::fs::metadata(path).is_ok_and(|there| there.is_file());
    is_file && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC
}

fn decode<T: DeserializeOwned>(bytes: &[u8], file: String) -> Result<T, SaveError> {
    let present = bytes.len() as u64;
    let start = bytes.len().min(MAGIC.len());
    if bytes[..start] != MAGIC[..start] {
        return Err(SaveError::NotASave { file });
    }
    let Some((header, payload)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(SaveError::Truncated { file, present, expected: HEADER as u64 });
    };
    let [_, _, _, _, _, _, _, _, v0, v1, v2, v3, l0, l1, l2, l3, l4, l5, l6, l7, c0, c1, c2, c3] = *header;
    let version = u32::from_le_bytes([v0, v1, v2, v3]);
    if version != VERSION {
        return Err(SaveError::Version { file, version });
    }
    let length = u64::from_le_bytes([l0, l1, l2, l3, l4, l5, l6, l7]);
    if length > limits::SAVE_BYTES {
        return Err(SaveError::TooLarge { file, bytes: length, limit: limits::SAVE_BYTES });
    }
    let expected = HEADER as u64 + length;
    if present < expected {
        return Err(SaveError::Truncated { file, present, expected });
    }
    if present > expected {
        return Err(SaveError::TrailingBytes { file, extra: present - expected });
    }
    if checksum(&header[8..20], payload) != u32::from_le_bytes([c0, c1, c2, c3]) {
        return Err(SaveError::Checksum { file });
    }
    match postcard::take_from_bytes::<T>(payload) {
        Ok((value, [])) => Ok(value),
        Ok((_, rest)) => Err(SaveError::TrailingBytes { file, extra: rest.len() as u64 }),
        Err(e) => Err(SaveError::Malformed { file, reason: e.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn save() -> (tempfile::TempDir, std::path::PathBuf, Vec<u32>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("garden.save");
        let value: Vec<u32> = (0..40).collect();
        write_save(&path, &value).unwrap();
        (folder, path, value)
    }

    #[test]
    fn reads_back_what_was_written() {
        let (_folder, path, value) = save();
        assert_eq!(read_save::<Vec<u32>>(&path).unwrap(), value);
    }

    #[test]
    fn every_flipped_bit_and_every_cut_is_a_typed_error() {
        let (_folder, path, _) = save();
        let good = std::fs::read(&path).unwrap();
        for i in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[i] ^= 1 << bit;
                assert!(decode::<Vec<u32>>(&bad, String::new()).is_err(), "byte {i} bit {bit}");
            }
            let cut = decode::<Vec<u32>>(&good[..i], String::new());
            assert!(matches!(cut, Err(SaveError::Truncated { .. })), "{i} bytes");
        }
        let long = [&good[..], &[0]].concat();
        assert!(matches!(decode::<Vec<u32>>(&long, String::new()), Err(SaveError::TrailingBytes { .. })));
        assert!(matches!(decode::<Vec<u32>>(b"PNG", String::new()), Err(SaveError::NotASave { .. })));
        assert!(matches!(
            decode::<Vec<String>>(&good, String::new()),
            Err(SaveError::Malformed { .. } | SaveError::TrailingBytes { .. })
        ));
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        struct Unwritable;
        impl Serialize for Unwritable {
            fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
                Err(serde::ser::Error::custom("no"))
            }
        }
        let (folder, path, value) = save();
        assert!(write_save(&path, &Unwritable).is_err());
        assert_eq!(read_save::<Vec<u32>>(&path).unwrap(), value);
        // A folder stands where the file should go: the rename fails, and nothing is left over.
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        assert!(matches!(write_save(&taken, &value), Err(SaveError::Io { .. })));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
