//! What a gardener does all day.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::thread;
use std::time::{Duration, Instant};

use super::{Explained, GardenerError, GardenerSettings, News, Order, Progress};
use crate::assets::Opened;
use crate::environment::workers::Workers;
use crate::export::harvest::{export_all, make_folder};
use crate::export::picture::PictureSettings;
use crate::files::{SaveError, SharedTree, is_save, write_whole};
use crate::scenario::{Autosave, SavedRun, Timeline, Visit};

/// Whether to go on.
#[derive(PartialEq, Eq)]
enum Then {
    GoOn,
    End,
}

pub(super) struct Work {
    timeline: Timeline,
    inbox: Receiver<Order>,
    outbox: Sender<News>,
    /// Orders that came and wait.
    orders: VecDeque<Order>,
    playing: bool,
    pace: Option<f32>,
    /// The step at which it stops playing.
    until: Option<u32>,
    /// When the next step is to be grown while playing.
    due: Instant,
    visit: Option<Visit>,
    /// Steps that do not wait for their beat.
    prompt: u8,
    autosave: Option<(Autosave, Duration)>,
    saved: Instant,
    changed: bool,
}

/// Steps until an edit is answered: buds see what was changed at the end of the next, a correction is sent in the one
/// after, and a shoot of a single internode, whose signals are one sub-step late, turns in the third, or in the fourth if
/// it had nothing to grow with in one of them.
const ANSWER: u8 = 4;

impl Work {
    pub fn new(
        timeline: Timeline,
        settings: GardenerSettings,
        inbox: Receiver<Order>,
        outbox: Sender<News>,
    ) -> Self {
        let now = Instant::now();
        let mut work = Self {
            timeline,
            inbox,
            outbox,
            orders: VecDeque::new(),
            playing: settings.playing,
            pace: None,
            until: settings.until,
            due: now,
            visit: None,
            prompt: 0,
            autosave: settings.autosave,
            saved: now,
            changed: false,
        };
        work.set_pace(settings.pace.unwrap_or_default());
        work
    }

    /// Works until told to end, or until nobody can tell any more. Gives the file that what has grown last is in.
    pub fn run(mut self) -> Result<Option<PathBuf>, SaveError> {
        self.tell_changed(None);
        while self.hear() == Then::GoOn {
            if let Some(order) = self.orders.pop_front() {
                if self.is_overtaken(&order) {
                    continue;
                }
                match self.obey(order) {
                    Ok(Then::GoOn) => {}
                    Ok(Then::End) => break,
                    Err(why) => self.tell(News::Refused(why)),
                }
            } else if self.visit.is_some() {
                self.walk();
            } else if self.has_to_grow() {
                self.grow();
            }
            self.save_now_and_then(false);
        }
        let saved = self.finish();
        self.tell(News::Ended);
        saved
    }

    /// A host that no longer listens will not miss it.
    fn tell(&self, news: News) {
        let _ = self.outbox.send(news);
    }

    fn has_to_grow(&self) -> bool {
        self.timeline.catching_up().is_some() || (self.playing && Instant::now() >= self.due)
    }

    /// Takes in the orders that have come; waits for one while there is nothing else to do.
    fn hear(&mut self) -> Then {
        if self.orders.is_empty() && self.visit.is_none() && !self.has_to_grow() {
            let first = match self.until_something_is_due() {
                Some(time) => self.inbox.recv_timeout(time),
                None => self.inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match first {
                Ok(order) => self.orders.push_back(order),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Then::End,
            }
        }
        loop {
            match self.inbox.try_recv() {
                Ok(order) => self.orders.push_back(order),
                Err(TryRecvError::Empty) => return Then::GoOn,
                Err(TryRecvError::Disconnected) if self.orders.is_empty() => return Then::End,
                Err(TryRecvError::Disconnected) => return Then::GoOn,
            }
        }
    }

    fn until_something_is_due(&self) -> Option<Duration> {
        let now = Instant::now();
        let step = self.playing.then(|| self.due.saturating_duration_since(now));
        let save = self.autosave.as_ref().filter(|_| self.changed);
        let save = save.map(|(_, every)| every.saturating_sub(now.saturating_duration_since(self.saved)));
        step.into_iter().chain(save).min()
    }

    /// Whether the next order makes this one needless, as while dragging or scrubbing.
    fn is_overtaken(&self, order: &Order) -> bool {
        match (order, self.orders.front()) {
            (Order::Seek(_), Some(Order::Seek(_)))
            | (Order::Explain { .. }, Some(Order::Explain { .. }))
            | (Order::Fallen, Some(Order::Fallen))
            | (Order::Records, Some(Order::Records)) => true,
            (
                Order::Edit { step, edit, drag: true },
                Some(Order::Edit { step: next_step, edit: next, drag: true }),
            ) => step == next_step && next.replaces(edit),
            _ => false,
        }
    }

    fn obey(&mut self, order: Order) -> Result<Then, GardenerError> {
        match order {
            Order::Play => self.play(true),
            Order::Pause => self.play(false),
            Order::Step => self.grow(),
            Order::Pace(pace) => {
                self.set_pace(pace);
                self.tell(News::Status(self.progress()));
            }
            Order::Seek(step) => self.seek(step)?,
            Order::SeekGhost(step) => {
                let view = self.timeline.ghost().and_then(|ghost| ghost.view(step));
                self.tell(News::GhostSeen(step, view));
            }
            Order::DropGhost => {
                self.timeline.drop_ghost();
                self.tell(News::Status(self.progress()));
            }
            Order::Edit { step, edit, drag } => {
                let step = step.unwrap_or(self.timeline.present());
                let outcome =
                    if drag { self.timeline.amend(step, edit)? } else { self.timeline.edit(step, edit)? };
                self.prompt = if drag { self.prompt } else { ANSWER };
                self.change(outcome.map(|outcome| outcome.shed));
            }
            Order::Undo => {
                self.timeline.undo().ok_or(GardenerError::Nothing("undo"))?;
                self.change(None);
            }
            Order::Redo => {
                self.timeline.redo().ok_or(GardenerError::Nothing("redo"))?;
                self.change(None);
            }
            Order::Restart => {
                self.timeline.restart();
                self.change(None);
            }
            Order::Seed(seed) => {
                self.timeline.reseed(seed)?;
                self.change(None);
            }
            Order::Begin(resolved, seed) => {
                let timeline =
                    Timeline::new(*resolved, seed, self.timeline.library(), self.timeline.workers())?;
                self.take_up(timeline, None);
            }
            Order::Load(path) => self.load(&path)?,
            Order::LoadCode(code) => self.take_up_shared(SharedTree::from_code(&code)?)?,
            Order::Save(path) => {
                self.timeline.save().write(&path)?;
                self.tell(News::Saved(path));
            }
            Order::SaveScenario(path) => {
                let text = self.timeline.scenario().to_ron();
                self.write(&path, &text)?;
            }
            Order::SaveRun(path) => {
                let text = self.timeline.run_file().to_ron();
                self.write(&path, &text)?;
            }
            Order::Share => {
                let code = self.timeline.code()?;
                self.tell(News::Code(code));
            }
            Order::Copy => self.tell(News::Copied(Box::new(self.timeline.shared()))),
            Order::Explain { step, birth } => {
                let explained = Explained::of(&self.timeline, step, birth)?;
                self.tell(News::Explained(Box::new(explained)));
            }
            Order::Fallen => self.tell(News::Fallen(self.timeline.fallen().to_vec())),
            Order::Records => self.tell(News::Records(self.timeline.records().to_vec())),
            Order::Export { step, folder } => {
                let harvest = self.timeline.harvest(step)?.ok_or_else(|| self.timeline.not_grown(step))?;
                self.beside(folder, move |folder, workers| {
                    export_all(&harvest, folder, workers)?;
                    Ok(())
                })?;
            }
            Order::Film(path) => {
                let (reel, palette) = self.timeline.reel();
                self.beside(path, move |path, workers| Ok(reel.save(&palette, workers, path, || ())?))?;
            }
            Order::Pictures(folder) => {
                let (reel, palette) = self.timeline.reel();
                self.beside(folder, move |folder, workers| {
                    make_folder(folder)?;
                    reel.save_pictures(&palette, PictureSettings::default(), workers, folder, || ())?;
                    Ok(())
                })?;
            }
            Order::Budget(bytes) => self.timeline.set_budget(bytes),
            Order::Quit => return Ok(Then::End),
        }
        Ok(Then::GoOn)
    }

    fn play(&mut self, playing: bool) {
        self.playing = playing;
        self.due = Instant::now();
        self.tell(News::Status(self.progress()));
    }

    fn set_pace(&mut self, pace: f32) {
        // Slower than a step in a day is no pace.
        self.pace = (pace.is_finite() && pace > 0.0).then(|| pace.max(1.0e-5));
        self.due = Instant::now();
    }

    fn seek(&mut self, step: u32) -> Result<(), GardenerError> {
        self.visit = None;
        if let Some(view) = self.timeline.view(step) {
            self.tell(News::Seen(view));
            return Ok(());
        }
        self.visit = self.timeline.visit(step);
        match &self.visit {
            Some(_) => Ok(()),
            None => Err(self.timeline.not_grown(step).into()),
        }
    }

    /// Goes on to the step that is sought.
    fn walk(&mut self) {
        let Some(mut visit) = self.visit.take() else { return };
        match self.timeline.go_on(&mut visit) {
            Ok(Some(view)) => self.tell(News::Seen(view)),
            Ok(None) => self.visit = Some(visit),
            Err(why) => self.tell(News::Refused(why.into())),
        }
    }

    fn grow(&mut self) {
        let catching_up = self.timeline.catching_up().is_some();
        match self.timeline.advance() {
            Ok(_) => {
                self.changed = true;
                self.prompt = self.prompt.saturating_sub(1);
                if !catching_up && self.prompt > 0 {
                    self.due = Instant::now();
                } else if !catching_up {
                    let beat = self.pace.map_or(Duration::ZERO, |pace| Duration::from_secs_f32(1.0 / pace));
                    // A beat that was missed is not made up for.
                    self.due = (self.due + beat).max(Instant::now());
                }
                if self.until == Some(self.timeline.present()) {
                    self.playing = false;
                }
                if let Some(view) = self.timeline.view(self.timeline.present()) {
                    self.tell(News::Grown(view, self.progress()));
                }
            }
            Err(why) => {
                self.playing = false;
                self.tell(News::Stopped(why));
                self.tell(News::Status(self.progress()));
            }
        }
    }

    /// The timeline was changed by hand.
    fn change(&mut self, shed: Option<usize>) {
        self.visit = None;
        self.changed = true;
        self.due = Instant::now();
        self.tell_changed(shed);
    }

    fn tell_changed(&self, shed: Option<usize>) {
        if let Some(view) = self.timeline.view(self.timeline.present()) {
            self.tell(News::Changed { view, progress: self.progress(), shed });
        }
    }

    fn load(&mut self, path: &Path) -> Result<(), GardenerError> {
        let (library, workers) = (self.timeline.library(), self.timeline.workers());
        if is_save(path) {
            let timeline = Timeline::resume(SavedRun::read(path)?, library, workers)?;
            self.take_up(timeline, Some(path));
            return Ok(());
        }
        // With its folder it is a path, whatever its name.
        let argument = if path.is_absolute() { path.to_path_buf() } else { Path::new(".").join(path) };
        let (resolved, seed, steps) = match library.open(&argument.display().to_string())? {
            Opened::Scenario(resolved) => (*resolved, self.timeline.seed(), 0),
            Opened::Run(run) => (run.resolved(), run.seed, run.steps),
        };
        self.take_up_shared(SharedTree { resolved, edits: Vec::new(), seed, steps })
    }

    fn take_up_shared(&mut self, shared: SharedTree) -> Result<(), GardenerError> {
        let (library, workers) = (self.timeline.library(), self.timeline.workers());
        let timeline = Timeline::from_shared(shared, library, workers)?;
        self.take_up(timeline, None);
        Ok(())
    }

    fn take_up(&mut self, mut timeline: Timeline, save: Option<&Path>) {
        self.save_now_and_then(true);
        if let Some((autosave, _)) = &mut self.autosave {
            let path = autosave.file().map(Path::to_path_buf).unwrap_or_default();
            if let Err(source) = autosave.turn_to(save) {
                self.tell(News::Refused(GardenerError::Write { path, source }));
            }
        }
        timeline.adopt_settings(&self.timeline);
        self.timeline = timeline;
        self.change(None);
        // It can be had again as it was taken up.
        self.changed = false;
        let scenario = self.timeline.scenario().name;
        // A session's save is not the file its garden is to be saved to.
        let is_own = |save: &&Path| self.autosave.as_ref().is_some_and(|(autosave, _)| autosave.is_own(save));
        let save = save.filter(|save| !is_own(save)).map(Path::to_path_buf);
        self.tell(News::Began { scenario, save });
    }

    fn write(&self, path: &Path, text: &str) -> Result<(), GardenerError> {
        write_whole(path, &[text.as_bytes()])
            .map_err(|source| GardenerError::Write { path: path.into(), source })?;
        self.tell(News::Saved(path.into()));
        Ok(())
    }

    /// Has something written by a thread of its own, so that growth does not wait, and tells of it.
    fn beside(
        &self,
        path: PathBuf,
        write: impl FnOnce(&Path, &Workers) -> Result<(), GardenerError> + Send + 'static,
    ) -> Result<(), GardenerError> {
        let (outbox, workers, to) = (self.outbox.clone(), self.timeline.workers(), path.clone());
        let write = move || {
            let news = match write(&to, &workers) {
                Ok(()) => News::Saved(to),
                Err(why) => News::Refused(why),
            };
            // A host that no longer listens will not miss it.
            let _ = outbox.send(news);
        };
        match thread::Builder::new().name("burgeon export".into()).spawn(write) {
            Ok(_) => Ok(()),
            Err(source) => Err(GardenerError::Write { path, source }),
        }
    }

    fn save_now_and_then(&mut self, now: bool) {
        let Some((autosave, every)) = &mut self.autosave else { return };
        if !self.changed || !(now || self.saved.elapsed() >= *every) {
            return;
        }
        // What fails is tried again when it is due again, not at once.
        self.saved = Instant::now();
        match autosave.write(&self.timeline.save()) {
            Ok(()) => self.changed = false,
            Err(why) => self.tell(News::Refused(why.into())),
        }
    }

    /// Saves what is not yet saved, for the last time.
    fn finish(&mut self) -> Result<Option<PathBuf>, SaveError> {
        let Some((autosave, _)) = &mut self.autosave else { return Ok(None) };
        if self.changed {
            autosave.write(&self.timeline.save())?;
        }
        let file = autosave.file().map_or_else(String::new, |file| file.display().to_string());
        autosave.finish().map_err(|source| SaveError::Io { file, source })
    }

    fn progress(&self) -> Progress {
        let timeline = &self.timeline;
        let (undoable, redoable) = timeline.undoable();
        Progress {
            present: timeline.present(),
            catching_up: timeline.catching_up(),
            playing: self.playing,
            pace: self.pace,
            organs: timeline.now().len(),
            undoable,
            redoable,
            lapsed: timeline.lapsed().count(),
            ghost: timeline.ghost().map(|ghost| ghost.end()),
            seed: timeline.seed(),
            bytes: timeline.bytes(),
        }
    }
}
