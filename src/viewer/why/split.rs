//! The split view: the same seed under another setting, beside the garden, seen from the same side.
//!
//! The twin's plants stand far away on the same meadow, out of the haze of the first; a second camera looks at them
//! just as the first looks at its own.

use std::sync::Arc;

use bevy::camera::Viewport;
use bevy::math::ops;
use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use super::twin::Twin;
use crate::assets::Library;
use crate::files::SharedTree;
use crate::growth::Mechanisms;
use crate::render::{Drawn, OutdoorCamera, StepFraction};
use crate::scenario::{Edit, Fixtures, News, Order};
use crate::viewer::{Course, Shown};

/// How far away the twin stands, metres.
const APART: Vec3 = Vec3::new(170.0, 0.0, 0.0);

/// Marks what belongs to the twin on screen.
#[derive(Component)]
pub struct OfTwin;

/// The second garden and what it is to be.
#[derive(Resource, Default)]
pub struct Split {
    /// Whether the copy it begins from has been asked for, and what differs then.
    wanted: Option<Mechanisms>,
    twin: Option<Twin>,
    /// What differs.
    other: Mechanisms,
    error: Option<String>,
    /// What stands on screen.
    standing: Option<Arc<Fixtures>>,
    /// The part of the window that panels leave free, in physical pixels: left, top, width, height.
    pub free: Option<[u32; 4]>,
}

impl Split {
    /// Whether there is a second garden.
    pub fn is_open(&self) -> bool {
        self.twin.is_some()
    }

    /// Takes in what the first garden's gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Copied(copy) => {
                if let Some(other) = self.wanted.take() {
                    self.begin(SharedTree::clone(copy), other);
                }
            }
            // Another course, or another garden: the twin would no longer be one.
            News::Changed { progress, .. } if self.twin.is_some() && progress.present == 0 => self.close(),
            _ => {}
        }
    }

    fn begin(&mut self, copy: SharedTree, other: Mechanisms) {
        match Twin::begin(copy, Edit::Mechanisms(other), Library::embedded()) {
            Ok(twin) => (self.twin, self.error) = (Some(twin), None),
            Err(why) => self.error = Some(why.to_string()),
        }
    }

    /// Ends it.
    pub fn close(&mut self) {
        self.twin = None;
        self.standing = None;
    }

    /// The choice of what differs.
    pub fn choose(&mut self, ui: &mut egui::Ui, now: Mechanisms, orders: &mut Vec<Order>) {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new("beside it, without").weak());
            for (name, other) in [
                ("light", Mechanisms { light: !now.light, ..now }),
                ("space", Mechanisms { space: !now.space, ..now }),
                ("energy", Mechanisms { energy: !now.energy, ..now }),
            ] {
                let open = self.twin.is_some() && self.other == other;
                let help = "The same seed with this switch turned over, grown beside it";
                if ui.selectable_label(open, name).on_hover_text(help).clicked() {
                    self.close();
                    if !open {
                        (self.wanted, self.other) = (Some(other), other);
                        orders.push(Order::Copy);
                    }
                }
            }
        });
        if let Some(error) = &self.error {
            ui.colored_label(ui.visuals().error_fg_color, error);
        }
    }
}

/// Has the twin keep step.
pub fn follow_twin(mut split: ResMut<Split>, shown: Res<Shown>, course: Res<Course>) {
    let split = split.bypass_change_detection();
    let (Some(twin), Some(view)) = (&mut split.twin, &shown.view) else { return };
    if let Err(gone) = twin.follow(view.step, course.progress.present) {
        split.close();
        split.error = Some(format!("beside it: {gone}"));
    }
}

/// Shows the twin, or takes it away.
pub fn show_twin(
    mut commands: Commands,
    mut split: ResMut<Split>,
    windows: Query<&Window>,
    first: Query<(&Transform, &Projection), (With<OutdoorCamera>, Without<OfTwin>)>,
    mut camera: Query<(&mut Camera, &mut Transform, &mut Projection), (With<OutdoorCamera>, With<OfTwin>)>,
    mut drawn: Query<&mut Drawn, With<OfTwin>>,
    all: Query<Entity, With<OfTwin>>,
) {
    let split = split.bypass_change_detection();
    let Some(view) = split.twin.as_ref().and_then(Twin::view) else {
        all.iter().for_each(|entity| commands.entity(entity).despawn());
        return;
    };
    match drawn.single_mut() {
        Ok(mut drawn) => {
            if !Arc::ptr_eq(&drawn.now, &view.shot) {
                *drawn = Drawn { before: view.shot.clone(), now: view.shot.clone() };
            }
        }
        Err(_) => {
            let plants = Drawn { before: view.shot.clone(), now: view.shot.clone() };
            commands.spawn((OfTwin, plants, StepFraction(1.0), Transform::from_translation(APART)));
        }
    }
    if !split.standing.as_ref().is_some_and(|there| Arc::ptr_eq(there, &view.standing)) {
        for entity in all.iter().filter(|entity| camera.get(*entity).is_err() && drawn.get(*entity).is_err())
        {
            commands.entity(entity).despawn();
        }
        let moved = |at: Transform| at.with_translation(at.translation + APART);
        for solid in &view.standing.solids {
            commands.spawn((OfTwin, solid.thing, moved(solid.transform())));
        }
        for lamp in &view.standing.lamps {
            commands.spawn((OfTwin, lamp.thing, moved(lamp.transform())));
        }
        split.standing = Some(view.standing.clone());
    }
    let (Ok(window), Ok((from, lens))) = (windows.single(), first.single()) else { return };
    let whole = UVec2::new(window.physical_width().max(2), window.physical_height().max(2));
    let [left, top, width, height] = split.free.unwrap_or([0, 0, whole.x, whole.y]);
    let half = UVec2::new((width / 2).max(1), height.max(1));
    let corner = UVec2::new((left + width).saturating_sub(half.x), top);
    if (corner + half).cmpgt(whole).any() {
        return;
    }
    let viewport = Viewport { physical_position: corner, physical_size: half, ..default() };
    let Projection::Perspective(lens) = lens else { return };
    // As large as the first sees its own: the same metres a pixel.
    let tan = ops::tan(0.5 * lens.fov);
    let fov = 2.0 * ops::atan(tan * half.y as f32 / whole.y as f32);
    let lens = Projection::Perspective(PerspectiveProjection { fov, ..lens.clone() });
    // What the first shows in the middle of its half is in the middle here.
    let middle = Vec2::new(left as f32 + 0.25 * width as f32, top as f32 + 0.5 * height as f32);
    let off = (middle - 0.5 * whole.as_vec2()) * 2.0 * tan / whole.y as f32;
    let toward = (*from.forward() + *from.right() * off.x - *from.up() * off.y).normalize_or(*from.forward());
    let stand = Transform::from_translation(from.translation + APART).looking_to(toward, from.up());
    match camera.single_mut() {
        Ok((mut camera, mut at, mut projection)) => {
            camera.viewport = Some(viewport);
            *at = stand;
            *projection = lens;
        }
        Err(_) => {
            let camera = Camera { order: 3, viewport: Some(viewport), ..default() };
            commands.spawn((OfTwin, OutdoorCamera, camera, lens, stand, Msaa::Off));
        }
    }
}
