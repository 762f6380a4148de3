//! Earlier sessions: what was cut short is offered, and what is kept can be taken up again.

use std::time::{Duration, SystemTime};

use bevy::prelude::*;

use super::act::Action;
use super::state::Toasts;
use crate::scenario::{KeptSession, Order, Sessions};

/// Earlier sessions; none where nothing is saved by itself.
#[derive(Resource, Debug, Default)]
pub struct Recent {
    sessions: Option<Sessions>,
    offered: Vec<KeptSession>,
}

impl Recent {
    /// Sessions of a folder, those of them offered that were cut short.
    pub fn new(sessions: Sessions) -> Self {
        let offered = sessions.kept().into_iter().filter(|kept| kept.unfinished).collect();
        Self { sessions: Some(sessions), offered }
    }

    /// The newest session that was cut short and neither taken up nor dismissed since.
    pub fn offered(&self) -> Option<&KeptSession> {
        self.offered.first()
    }

    /// Whether sessions are saved.
    pub(super) fn is_kept(&self) -> bool {
        self.sessions.is_some()
    }

    /// Every session there is to take up, the newest first, as it is on disk now.
    pub fn list(&self) -> Vec<KeptSession> {
        self.sessions.as_ref().map(Sessions::kept).unwrap_or_default()
    }
}

/// Offers no longer what is taken up or dismissed.
pub(super) fn follow(
    mut actions: MessageReader<Action>,
    mut recent: ResMut<Recent>,
    mut toasts: ResMut<Toasts>,
) {
    for action in actions.read() {
        let (Action::Dismiss(file) | Action::Tell(Order::Load(file))) = action else { continue };
        recent.offered.retain(|kept| kept.file != *file);
        if let (Action::Dismiss(_), Some(sessions)) = (action, &recent.sessions)
            && let Err(why) = sessions.settle(file)
        {
            toasts.warn(format!("{}: {why}", file.display()));
        }
    }
}

/// A session in a few words: what grew, and how long ago.
pub(super) fn words(kept: &KeptSession, now: SystemTime) -> String {
    let ago = now.duration_since(kept.when).unwrap_or_default();
    format!("{}, {}", kept.scenario, since(ago))
}

fn since(ago: Duration) -> String {
    let minutes = ago.as_secs() / 60;
    let (number, unit) = match minutes {
        0 => return "just now".into(),
        1..60 => (minutes, "minute"),
        60..1440 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{number} {unit}{} ago", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_told_in_words() {
        let words_of = |seconds| since(Duration::from_secs(seconds));
        assert_eq!(words_of(59), "just now");
        assert_eq!(words_of(60), "1 minute ago");
        assert_eq!(words_of(59 * 60), "59 minutes ago");
        assert_eq!(words_of(3600), "1 hour ago");
        assert_eq!(words_of(50 * 3600), "2 days ago");
    }
}
