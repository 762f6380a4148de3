//! Saves that nobody asked for: what grows survives a crash, whatever starts after it, and any number of windows.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::SavedRun;
use crate::files::SaveError;
use crate::limits;

/// Ending of a save.
const SAVE: &str = ".burgeon";
/// Ending of one whose session has not ended in order.
const UNFINISHED: &str = ".unfinished.burgeon";
/// Ending of what a running session holds.
const LOCK: &str = ".lock";
/// Most characters of a scenario's name in that of its save.
const NAME: usize = 40;

/// The folder that sessions are saved in. The rule:
///
/// - Every garden of every session has a file of its own, `NAME.unfinished.burgeon`: no two windows write the same, and
///   no start writes over what another left.
/// - Nothing is written before there is something to lose: a step or an edit beyond what the session began with or
///   took up.
/// - When a session ends in order, or leaves a garden for another, the file becomes `NAME.burgeon`. Of these the newest
///   [`limits::SESSIONS`] are kept.
/// - What a crash leaves stays unfinished, and nothing but its being taken up or dismissed changes that: taken up, it
///   becomes as one that ended in order once what came of it is saved itself.
/// - `NAME.lock` is held by whoever writes; a session that runs is nobody else's to take up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sessions {
    folder: PathBuf,
}

/// What a session left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeptSession {
    /// Its save.
    pub file: PathBuf,
    /// What grew, by the name of its scenario, as far as a file name tells.
    pub scenario: String,
    /// When it was saved last.
    pub when: SystemTime,
    /// Whether it was cut short.
    pub unfinished: bool,
}

impl Sessions {
    /// Sessions in a folder, which is made when one is saved.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What is left of sessions that run no more, the newest first. A folder that cannot be read has none.
    pub fn kept(&self) -> Vec<KeptSession> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut kept: Vec<_> = entries.filter_map(|entry| self.kept_at(&entry.path())).collect();
        kept.sort_by(|a, b| (b.when, &b.file).cmp(&(a.when, &a.file)));
        kept
    }

    /// Saves nothing yet; has a file of its own once there is something to save.
    pub fn begin(&self) -> Autosave {
        Autosave { sessions: self.clone(), place: None, from: None }
    }

    /// No longer counts a session that was cut short as unfinished. Its save stays, as that of one that ended in order;
    /// of those the oldest beyond the limit go.
    ///
    /// # Errors
    /// If its file cannot be renamed; it is as it was then.
    pub fn settle(&self, file: &Path) -> io::Result<()> {
        if self.kept_at(file).is_some_and(|kept| kept.unfinished) {
            finish(file)?;
        }
        self.tidy();
        Ok(())
    }

    /// Removes the oldest saves beyond the limit.
    fn tidy(&self) {
        for old in self.kept().into_iter().filter(|kept| !kept.unfinished).skip(limits::SESSIONS) {
            // One too many is no harm; it is tried again next time.
            let _ = fs::remove_file(&old.file);
        }
    }

    /// Whether a file is the save of a session, not one that a user named.
    pub(super) fn is_own(&self, file: &Path) -> bool {
        file.parent() == Some(&self.folder) && stem(file).is_some()
    }

    fn kept_at(&self, file: &Path) -> Option<KeptSession> {
        let stem = stem(file)?;
        let (_, scenario) = numbers_and_name(stem)?;
        let there = fs::metadata(file).ok().filter(fs::Metadata::is_file)?;
        let is_running = File::open(self.folder.join(format!("{stem}{LOCK}")))
            .is_ok_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)));
        (!is_running).then(|| KeptSession {
            file: file.to_path_buf(),
            scenario: scenario.to_owned(),
            when: there.modified().unwrap_or(SystemTime::UNIX_EPOCH),
            unfinished: file.to_string_lossy().ends_with(UNFINISHED),
        })
    }

    /// A place that no other session has.
    fn claim(&self, scenario: &str) -> io::Result<Place> {
        fs::create_dir_all(&self.folder)?;
        let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
        let name: String = scenario.chars().take(NAME).map(plain).collect();
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs();
        for number in 1_u32.. {
            let stem = format!("{name}-{now}-{number}");
            let beside = |ending: &str| self.folder.join(format!("{stem}{ending}"));
            let lock_file = beside(LOCK);
            let lock = match File::create_new(&lock_file) {
                Ok(lock) => lock,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
            };
            // Where files cannot be locked a running session can be taken up as well: what is read is a copy.
            let _ = lock.lock();
            let place = Place { file: beside(UNFINISHED), lock_file, _lock: lock };
            // A session of the same second may have ended already.
            if !place.file.exists() && !beside(SAVE).exists() {
                return Ok(place);
            }
            place.free();
        }
        Err(io::Error::other("no name is free for a save"))
    }
}

/// The name of a session, if a file is named as a save of one is.
fn stem(file: &Path) -> Option<&str> {
    let name = file.file_name()?.to_str()?;
    let stem = name.strip_suffix(UNFINISHED).or(name.strip_suffix(SAVE))?;
    numbers_and_name(stem).map(|_| stem)
}

/// The two numbers at the end of a session's name, and the scenario's name before them.
fn numbers_and_name(stem: &str) -> Option<([u64; 2], &str)> {
    let (rest, number) = stem.rsplit_once('-')?;
    let (name, second) = rest.rsplit_once('-')?;
    Some(([second.parse().ok()?, number.parse().ok()?], name))
}

/// Gives an unfinished save the name of one that ended in order, and takes its lock away.
fn finish(unfinished: &Path) -> io::Result<PathBuf> {
    let name = unfinished.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(UNFINISHED).unwrap_or(&name);
    let finished = unfinished.with_file_name(format!("{stem}{SAVE}"));
    if finished.exists() {
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, "a save of that name is there"));
    }
    fs::rename(unfinished, &finished)?;
    // Left of a crash, or held by whoever finishes.
    let _ = fs::remove_file(unfinished.with_file_name(format!("{stem}{LOCK}")));
    Ok(finished)
}

/// Where a garden is saved, this session's alone.
#[derive(Debug)]
struct Place {
    file: PathBuf,
    lock_file: PathBuf,
    _lock: File,
}

impl Place {
    /// Gives up a place nothing was written to.
    fn free(self) {
        // What is left of a lock that nobody holds says nothing.
        let _ = fs::remove_file(&self.lock_file);
    }
}

/// Saves the garden of a session now and then; [`Sessions`] tells the rule. The file is replaced whole or not at all.
///
/// Dropped without [`Autosave::finish`], as by a crash, it leaves an unfinished session.
#[derive(Debug)]
pub struct Autosave {
    sessions: Sessions,
    place: Option<Place>,
    /// The save that was taken up.
    from: Option<PathBuf>,
}

impl Autosave {
    /// Where it is, if anything was to be saved yet.
    pub fn file(&self) -> Option<&Path> {
        self.place.as_ref().map(|place| place.file.as_path())
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written; what was saved before is still there.
    pub fn write(&mut self, saved: &SavedRun) -> Result<(), SaveError> {
        let place = match self.place.take() {
            Some(place) => place,
            None => self.sessions.claim(&saved.run.scenario.name).map_err(|source| SaveError::Io {
                file: self.sessions.folder.display().to_string(),
                source,
            })?,
        };
        let written = saved.write(&place.file);
        self.place = Some(place);
        written?;
        if let Some(from) = self.from.take() {
            // What cannot be settled is offered once more.
            let _ = self.sessions.settle(&from);
        }
        Ok(())
    }

    /// Leaves the garden for another, which was read from a save or is new: the one before is saved as it was written
    /// last, the other goes to a file of its own.
    ///
    /// # Errors
    /// If what was saved last cannot be renamed; it is still there, as that of a session cut short.
    pub fn turn_to(&mut self, save: Option<&Path>) -> io::Result<()> {
        let finished = self.finish();
        self.from = save.filter(|save| self.sessions.is_own(save)).map(Path::to_path_buf);
        finished.map(drop)
    }

    /// Ends in order: nothing more is to come. Gives the file, if anything was saved.
    ///
    /// # Errors
    /// If what was saved last cannot be renamed; it is still there, as that of a session cut short.
    pub fn finish(&mut self) -> io::Result<Option<PathBuf>> {
        let Some(place) = self.place.take() else { return Ok(None) };
        if !place.file.exists() {
            place.free();
            return Ok(None);
        }
        let finished = finish(&place.file)?;
        drop(place);
        self.sessions.tidy();
        Ok(Some(finished))
    }

    /// Whether a file is the save of a session, not one that a user named.
    pub(super) fn is_own(&self, file: &Path) -> bool {
        self.sessions.is_own(file)
    }
}
