//! Whether what is on screen is all that is to be there.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy::prelude::*;
use bevy::render::render_resource::PipelineCache;
use bevy::render::{Render, RenderApp, RenderSystems};

/// Whether a shader was still being compiled in the last frame drawn, a resource.
#[derive(Resource, Debug, Clone, Default)]
pub(crate) struct Compiling(Arc<AtomicBool>);

impl Compiling {
    /// Has it told by the renderer of an app that has one.
    pub fn watch(app: &mut App) {
        let compiling = Self::default();
        app.insert_resource(compiling.clone());
        if let Some(render) = app.get_sub_app_mut(RenderApp) {
            let tell = |cache: Res<PipelineCache>, compiling: Res<Self>| {
                compiling.0.store(cache.waiting_pipelines().next().is_some(), Ordering::Relaxed);
            };
            render.insert_resource(compiling).add_systems(Render, tell.in_set(RenderSystems::Cleanup));
        }
    }

    /// Whether it was.
    pub fn is_under_way(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
