//! A gardener: tends a [`Timeline`] on a thread of its own, so that whoever asks never waits.
//!
//! Orders go in, news come out; neither ever blocks the caller. Orders are obeyed between two steps, so from an edit
//! to the first snapshot that shows it is at most the rest of one step, and the four steps after an edit, in which it
//! is seen and answered, do not wait for their beat. What grows is the same as without a gardener: the clock decides when a
//! step is grown, never how.
//!
//! ```
//! # use std::time::Duration;
//! # use burgeon::assets::Library;
//! # use burgeon::environment::workers::Workers;
//! # use burgeon::scenario::{Gardener, GardenerSettings, News, Order, Timeline};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let library = Library::embedded();
//! let timeline = Timeline::new(library.scenario("figure_1d")?, 1, library, Workers::new(1)?)?;
//! let gardener = Gardener::start(timeline, GardenerSettings::default())?;
//! gardener.order(Order::Step)?;
//! while let Some(news) = gardener.wait(Duration::from_secs(60)) {
//!     if let News::Grown(view, progress) = news {
//!         assert_eq!((view.step, progress.present), (1, 1));
//!         break;
//!     }
//! }
//! gardener.quit();
//! # Ok(())
//! # }
//! ```

mod work;

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use bevy::prelude::*;

use image::RgbImage;

use super::{Autosave, Edit, GardenError, Timeline, TimelineError, View, Why};
use crate::export::film::FilmError;
use crate::export::harvest::HarvestError;
use crate::files::{FileError, ResolvedScenario, SaveError, ShareError, SharedTree};
use crate::plant::Tombstone;
use crate::plant::measure::StepRecord;

/// What a gardener can be told to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Grow on and on.
    Play,
    /// Stop growing. Catching up after an edit goes on.
    Pause,
    /// Grow one step.
    Step,
    /// How many steps a second are grown while playing; 0 and less, or what is no number: as many as can be.
    Pace(f32),
    /// Show a step: [`News::Seen`]. A later one takes the place of one still on its way.
    Seek(u32),
    /// Show a step of the course before the last fork: [`News::GhostSeen`].
    SeekGhost(u32),
    /// Forget the course before the last fork.
    DropGhost,
    /// Make an edit.
    Edit {
        /// At which step; `None`: at the head.
        step: Option<u32>,
        /// What is changed.
        edit: Edit,
        /// Whether it takes the place of the last edit, as a drag goes on ([`Timeline::amend`]).
        drag: bool,
    },
    /// Take back the last edit.
    Undo,
    /// Make the edit undone last again.
    Redo,
    /// Go back to step 0; edits stay.
    Restart,
    /// Go back to step 0 under another seed.
    Seed(u64),
    /// Begin another scenario, with a seed.
    Begin(Box<ResolvedScenario>, u64),
    /// Take up a save, a run or a scenario from a file.
    Load(PathBuf),
    /// Take up the tree of a share code.
    LoadCode(String),
    /// Save everything to a file, to be taken up again: [`News::Saved`].
    Save(PathBuf),
    /// Write the scenario with its edits as RON.
    SaveScenario(PathBuf),
    /// Write `run.ron`.
    SaveRun(PathBuf),
    /// Tell the share code: [`News::Code`].
    Share,
    /// Tell all that is needed to grow the tree once more, beside this one: [`News::Copied`].
    Copy,
    /// Tell why the organ with a birth number is as it is at a step: [`News::Explained`]. A later one takes the place
    /// of one still on its way.
    Explain {
        /// The step.
        step: u32,
        /// The birth number.
        birth: u32,
    },
    /// Tell all organs that went: [`News::Fallen`].
    Fallen,
    /// Tell every step in numbers: [`News::Records`].
    Records,
    /// Write every export of a step into a folder, beside the work: [`News::Saved`] with the folder.
    Export {
        /// The step.
        step: u32,
        /// The folder.
        folder: PathBuf,
    },
    /// Draw the film of all steps that are kept, beside the work, as a GIF: [`News::Saved`].
    Film(PathBuf),
    /// Draw them as a sequence of pictures into a folder, beside the work: [`News::Saved`] with the folder.
    Pictures(PathBuf),
    /// How many bytes of snapshots are kept ([`Timeline::set_budget`]).
    Budget(usize),
    /// Save the autosave, if there is one, and end.
    Quit,
}

/// What a gardener tells.
#[derive(Debug)]
pub enum News {
    /// A step was grown: the head as it is now, its edits made.
    Grown(View, Progress),
    /// The head has changed otherwise: by an edit, undo, redo, restart or another garden.
    Changed {
        /// The head as it is now.
        view: View,
        /// How far things are.
        progress: Progress,
        /// How many organs the edit shed; `None` if there was no edit, or growth has yet to come to it.
        shed: Option<usize>,
    },
    /// Another garden has taken the place of the one before; told once it has been shown.
    Began {
        /// The name of its scenario.
        scenario: String,
        /// The save it was read from, if it was.
        save: Option<PathBuf>,
    },
    /// The step that was sought.
    Seen(View),
    /// The step of the old course that was sought; `None` if it is not kept.
    GhostSeen(u32, Option<View>),
    /// Playing, pausing or the pace has changed.
    Status(Progress),
    /// A file was written.
    Saved(PathBuf),
    /// The share code.
    Code(String),
    /// All that is needed to grow the tree once more.
    Copied(Box<SharedTree>),
    /// What there is to say of an organ.
    Explained(Box<Explained>),
    /// All organs that went, the newest last.
    Fallen(Vec<Tombstone>),
    /// Every step in numbers.
    Records(Vec<StepRecord>),
    /// An order was not carried out; all is as it was.
    Refused(GardenerError),
    /// Growth stopped at a limit; what has grown is kept.
    Stopped(GardenError),
    /// It has ended.
    Ended,
}

/// What there is to say of an organ at a step.
#[derive(Debug, Clone)]
pub struct Explained {
    /// The step asked for.
    pub step: u32,
    /// The birth number asked for.
    pub birth: u32,
    /// What it is, if it lived then.
    pub why: Option<Why>,
    /// What it saw: six faces unfolded, if it looked around.
    pub picture: Option<RgbImage>,
    /// What became of it, if it has gone since.
    pub tombstone: Option<Tombstone>,
}

impl Explained {
    /// Explains an organ of a timeline and draws what it saw.
    ///
    /// # Errors
    /// As [`Timeline::explain`].
    pub fn of(timeline: &Timeline, step: u32, birth: u32) -> Result<Self, GardenError> {
        let why = timeline.explain(step, birth)?;
        let tombstone = timeline.tombstone(birth).copied();
        let picture = why.as_ref().and_then(|why| why.picture(&timeline.now()));
        Ok(Self { step, birth, why, picture, tombstone })
    }
}

/// How far things are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Progress {
    /// The last step grown.
    pub present: u32,
    /// The step growth is on its way back to, if it is.
    pub catching_up: Option<u32>,
    /// Whether it plays.
    pub playing: bool,
    /// Steps a second while playing; `None`: as many as can be.
    pub pace: Option<f32>,
    /// Organs at the head.
    pub organs: usize,
    /// Edits that can be undone.
    pub undoable: usize,
    /// Edits that can be made again.
    pub redoable: usize,
    /// Edits that could not be made in this course.
    pub lapsed: usize,
    /// Last step of the course before the last fork, if that is kept.
    pub ghost: Option<u32>,
    /// The seed.
    pub seed: u64,
    /// Bytes of snapshots kept.
    pub bytes: usize,
}

/// Why an order was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum GardenerError {
    /// The timeline could not do it.
    #[error(transparent)]
    Timeline(#[from] TimelineError),
    /// A step could not be grown again.
    #[error(transparent)]
    Garden(#[from] GardenError),
    /// A save could not be read or written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A share code could not be read or made.
    #[error(transparent)]
    Share(#[from] ShareError),
    /// A file could not be written; what was there is untouched.
    #[error("{}: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Not every export could be written.
    #[error(transparent)]
    Harvest(#[from] HarvestError),
    /// A film or its pictures could not be written.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// There is nothing to undo or redo.
    #[error("there is nothing to {0}")]
    Nothing(&'static str),
}

/// The gardener has ended and takes no orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the gardener has ended")]
pub struct Gone;

/// How a gardener begins.
#[derive(Debug, Default)]
pub struct GardenerSettings {
    /// Whether it plays at once.
    pub playing: bool,
    /// Steps a second while playing; `None`: as many as can be.
    pub pace: Option<f32>,
    /// The step at which it stops playing; `None`: at none.
    pub until: Option<u32>,
    /// Where it saves now and then, and how often at most.
    pub autosave: Option<(Autosave, Duration)>,
}

/// Tends a timeline on a thread of its own. A resource, if a host wants it to be one.
#[derive(Resource, Debug)]
pub struct Gardener {
    orders: Sender<Order>,
    news: Mutex<Receiver<News>>,
    thread: Option<JoinHandle<()>>,
    ending: Mutex<Option<Ending>>,
}

/// Tells when a gardener has ended, its last save written, even if whoever held it has dropped it.
#[derive(Debug)]
pub struct Ending(Receiver<Result<Option<PathBuf>, SaveError>>);

impl Ending {
    /// Waits until the gardener has ended. It does so when told to, or when it is dropped. Gives the file that what has
    /// grown last is in; `None` if there was nothing to save, or nowhere.
    ///
    /// # Errors
    /// If what has grown last could not be saved.
    pub fn wait(self) -> Result<Option<PathBuf>, SaveError> {
        // A gardener that panicked says nothing; its panic has been told.
        self.0.recv().unwrap_or(Ok(None))
    }
}

impl Gardener {
    /// Sets a gardener to work. The first news is the head as it is.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(timeline: Timeline, settings: GardenerSettings) -> io::Result<Self> {
        let (orders, inbox) = mpsc::channel();
        let (outbox, news) = mpsc::channel();
        let (end, ending) = mpsc::channel();
        let thread = thread::Builder::new().name("burgeon gardener".into()).spawn(move || {
            // Whoever does not wait for it will not miss it.
            let _ = end.send(work::Work::new(timeline, settings, inbox, outbox).run());
        })?;
        let ending = Mutex::new(Some(Ending(ending)));
        Ok(Self { orders, news: Mutex::new(news), thread: Some(thread), ending })
    }

    /// What tells when it has ended; `None` if it was taken before. For hosts whose loop takes the gardener along.
    pub fn ending(&self) -> Option<Ending> {
        self.ending.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Gives an order and returns at once.
    ///
    /// # Errors
    /// [`Gone`] if the gardener has ended.
    pub fn order(&self, order: Order) -> Result<(), Gone> {
        self.orders.send(order).map_err(|_| Gone)
    }

    /// The next news, if there is any; returns at once.
    pub fn news(&self) -> Option<News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }

    /// Waits for the next news; `None` if there is none in that time, or the gardener has ended and told all.
    pub fn wait(&self, longest: Duration) -> Option<News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(longest).ok()
    }

    /// Whether it has ended.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Has it save its autosave and end, and waits for that: the rest of a step at most, and the writing.
    pub fn quit(mut self) {
        let _ = self.order(Order::Quit);
        if let Some(thread) = self.thread.take() {
            // Should it have panicked, there is nothing left to wait for.
            let _ = thread.join();
        }
    }
}

impl Drop for Gardener {
    /// Tells it to end, and does not wait: [`Gardener::ending`] does.
    fn drop(&mut self) {
        let _ = self.order(Order::Quit);
    }
}
