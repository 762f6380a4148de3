//! Follows the gardener's news.

use bevy::prelude::*;

use super::act::{GONE, show};
use super::state::{Chosen, Course, Past, Shown, Toasts};
use super::why::inspector::Answers;
use super::why::split::Split;
use crate::scenario::{Gardener, News, Order, Progress, View};

/// Takes in what the gardener tells.
pub(super) fn follow(
    gardener: Option<Res<Gardener>>,
    mut shown: ResMut<Shown>,
    mut course: ResMut<Course>,
    mut past: ResMut<Past>,
    mut chosen: ResMut<Chosen>,
    mut toasts: ResMut<Toasts>,
    mut answers: Option<ResMut<Answers>>,
    mut split: Option<ResMut<Split>>,
) {
    let Some(gardener) = gardener else { return };
    let mut there = true;
    while let Some(news) = gardener.news() {
        if let Some(answers) = &mut answers {
            answers.hear(&news);
        }
        if let Some(split) = &mut split {
            split.hear(&news);
        }
        match news {
            News::Grown(view, progress) => {
                course.stopped = false;
                note(&mut course, progress, &view);
                arrive(&mut shown, &past, view, true);
                there &= seek_ghost(&gardener, &shown, &course);
            }
            News::Changed { view, progress, shed } => {
                course.stopped = false;
                note(&mut course, progress, &view);
                if past.0.is_some_and(|step| step >= progress.present) {
                    past.0 = None;
                }
                arrive(&mut shown, &past, view, shed.is_some());
                if progress.ghost.is_none() {
                    shown.ghost = None;
                }
                there &= seek_ghost(&gardener, &shown, &course);
                if let Some(shed) = shed.filter(|shed| *shed > 0) {
                    toasts.tell(format!("{} shed", super::panels::bars::organs(shed)));
                }
            }
            News::Began { scenario, save } => {
                course.scenario = scenario;
                course.save = save;
                course.began += 1;
                (past.0, *chosen) = (None, Chosen::Nothing);
            }
            News::Seen(view) => {
                if past.0 == Some(view.step) {
                    show(&mut shown, view, false);
                    there &= seek_ghost(&gardener, &shown, &course);
                }
            }
            News::GhostSeen(_, view) => {
                if shown.with_ghost {
                    shown.ghost = view;
                }
            }
            News::Status(progress) => course.progress = progress,
            News::Saved(path) => toasts.tell(format!("saved {}", path.display())),
            News::Code(code) => toasts.tell(format!("share code: {code}")),
            News::Refused(why) => toasts.warn(why),
            News::Stopped(why) => {
                course.stopped = true;
                toasts.warn(format!("{why}; what has grown is kept"));
            }
            News::Ended => toasts.warn(GONE),
            // The panels have heard.
            News::Explained(_) | News::Fallen(_) | News::Records(_) | News::Copied(_) => {}
        }
    }
    if !there {
        toasts.warn(GONE);
    }
}

/// Keeps progress and records in line with the head.
fn note(course: &mut Course, progress: Progress, view: &View) {
    course.progress = progress;
    course.records.retain(|record| record.step < view.step);
    course.records.extend(view.record);
}

fn arrive(shown: &mut Shown, past: &Past, view: View, grew: bool) {
    shown.head = Some(view.clone());
    shown.live = past.0.is_none();
    if shown.live {
        show(shown, view, grew);
    }
}

/// Asks for the step of the old course that belongs beside what is shown; false if nobody is there to ask.
fn seek_ghost(gardener: &Gardener, shown: &Shown, course: &Course) -> bool {
    let (Some(end), Some(view)) = (course.progress.ghost, &shown.view) else { return true };
    if shown.with_ghost {
        return gardener.order(Order::SeekGhost(view.step.min(end))).is_ok();
    }
    true
}
