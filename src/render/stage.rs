//! From [`Drawn`] to buffers and meshes: packs what changed, writes the clock, keeps the chunks.

use std::collections::{HashMap, VecDeque};

use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, VisibilityRange};
use bevy::light::{NotShadowCaster, TransmittedShadowReceiver};
use bevy::mesh::MeshTag;
use bevy::prelude::*;
use bevy::render::storage::ShaderBuffer;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use bytemuck::{Pod, Zeroable};

use super::bark::BarkImage;
use super::drawn::{DrawSettings, Drawn, Ghost, Look, MARK_COLORS, Marks, StepFraction, Wind};
use super::material::{ChunkMeshes, Detail, PlantExtension, PlantMaterial};
use super::overlay::RAMP;
use super::pack::{Chunk, Class, Packed, pack};
use super::record::{PlantEntry, Record};

/// Organs in both states together up to which packing is done at once.
const AT_ONCE: usize = 1500;
/// Length of a frame that is slow in any case, so that packing does not lengthen it by much, seconds.
const SLOW: f32 = 0.1;
/// Frames for which chunks in buffers that were given up stay beside the new ones, which are not drawn at once.
const LEAVING: u8 = 8;
/// Distance at which wood is drawn with fewer sides: limbs, branches, twigs, metres.
const FEWER_SIDES: [f32; 3] = [40.0, 24.0, 12.0];
/// "For ever", metres.
const FAR: f32 = 1.0e6;

/// What a [`Drawn`] has on the graphics card.
#[derive(Component, Default)]
pub struct Stage {
    /// What is being packed on another thread, and of what.
    packing: Option<(Drawn, Task<Packed>)>,
    /// What is packed, until it lands.
    packed: Option<(Drawn, Packed)>,
    /// What is shown.
    shown: Option<Drawn>,
    sheets: Option<Sheets>,
    chunks: Vec<ChunkEntities>,
    /// Chunks in buffers that were given up, those buffers, and how many frames they still have.
    leaving: Vec<(Vec<ChunkEntities>, Sheets, u8)>,
    births: [Vec<u32>; 2],
}

impl Stage {
    /// Whether what is shown is what the host last asked for.
    pub fn is_settled(&self) -> bool {
        self.packing.is_none() && self.packed.is_none() && self.leaving.is_empty() && self.shown.is_some()
    }
}

/// A chunk on screen. It keeps class and capacity for life: an entity whose mesh or material changes is drawn for a
/// frame with the one it had.
struct ChunkEntities {
    class: Class,
    capacity: u8,
    near: Entity,
    far: Entity,
}

/// Buffers and materials that belong together.
#[derive(Clone)]
struct Sheets {
    wood: Sheet,
    leaves: Sheet,
    plants: Handle<ShaderBuffer>,
    /// Plants there is room for.
    room: usize,
    clock: Handle<ShaderBuffer>,
}

/// Records of one kind.
#[derive(Clone)]
struct Sheet {
    records: Handle<ShaderBuffer>,
    marks: Handle<ShaderBuffer>,
    /// Records there is room for.
    room: usize,
    material: Handle<PlantMaterial>,
}

/// What changes every frame, as `plants.wgsl` reads it.
#[derive(Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
struct Clock {
    time: [f32; 4],
    show: [f32; 4],
    marks: [[f32; 4]; 3],
    ghost: [f32; 4],
    ramp: [[f32; 4]; 16],
}

/// Begins to pack what changed.
pub(super) fn begin_packing(
    mut commands: Commands,
    settings: Res<DrawSettings>,
    time: Res<Time<Real>>,
    mut drawn: Query<(Entity, &Drawn, Option<&mut Stage>)>,
) {
    for (entity, drawn, stage) in &mut drawn {
        let Some(mut stage) = stage else {
            commands.entity(entity).insert(Stage::default());
            continue;
        };
        if stage.packing.is_some() || stage.shown.as_ref().is_some_and(|shown| is_same(shown, drawn)) {
            continue;
        }
        let of = drawn.clone();
        let at_once = settings.pack_at_once || time.delta_secs() > SLOW;
        if at_once || of.before.len() + of.now.len() < AT_ONCE {
            let packed = pack(&of.before, &of.now);
            stage.packed = Some((of, packed));
        } else {
            let (before, now) = (of.before.clone(), of.now.clone());
            let task = AsyncComputeTaskPool::get().spawn(async move { pack(&before, &now) });
            stage.packing = Some((of, task));
        }
    }
}

fn is_same(a: &Drawn, b: &Drawn) -> bool {
    std::sync::Arc::ptr_eq(&a.before, &b.before) && std::sync::Arc::ptr_eq(&a.now, &b.now)
}

/// Everything chunks are made from.
#[derive(bevy::ecs::system::SystemParam)]
pub(super) struct Store<'w> {
    buffers: ResMut<'w, Assets<ShaderBuffer>>,
    materials: ResMut<'w, Assets<PlantMaterial>>,
    meshes: ResMut<'w, Assets<Mesh>>,
    chunk_meshes: ResMut<'w, ChunkMeshes>,
    bark: Res<'w, BarkImage>,
    settings: Res<'w, DrawSettings>,
}

/// Shows what has been packed, in buffers that hold it.
pub(super) fn land(mut commands: Commands, mut store: Store, mut stages: Query<(Entity, &mut Stage, &Look)>) {
    for (entity, mut stage, look) in &mut stages {
        let stage = &mut *stage;
        for (gone, _, frames) in &mut stage.leaving {
            *frames -= 1;
            if *frames == 0 {
                despawn_chunks(&mut commands, gone.drain(..));
            }
        }
        stage.leaving.retain(|(_, _, frames)| *frames > 0);
        if let Some((of, mut task)) = stage.packing.take() {
            match check_ready(&mut task) {
                Some(packed) => stage.packed = Some((of, packed)),
                None => stage.packing = Some((of, task)),
            }
        }
        let Some((of, packed)) = stage.packed.take() else { continue };
        let sheets = match stage.sheets.take() {
            Some(sheets) if sheets.hold(&packed) => sheets,
            given_up => {
                if let Some(old) = given_up {
                    stage.leaving.push((core::mem::take(&mut stage.chunks), old, LEAVING));
                }
                store.sheets(&packed)
            }
        };
        store.fill(&sheets, &packed);
        stage.births =
            [&packed.rings, &packed.blades].map(|records| records.iter().map(Record::birth).collect());
        show_chunks(&mut commands, &mut store, entity, &mut stage.chunks, &packed.chunks, &sheets, look);
        stage.sheets = Some(sheets);
        stage.shown = Some(of);
    }
}

/// Writes the clocks: the one thing that changes every frame.
pub(super) fn write_clocks(
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    wind: Res<Wind>,
    settings: Res<DrawSettings>,
    stages: Query<(&Stage, &Drawn, &StepFraction, &Look)>,
) {
    for (stage, drawn, fraction, look) in &stages {
        let Some(sheets) = &stage.sheets else { continue };
        let current = stage.shown.as_ref().is_some_and(|shown| is_same(shown, drawn));
        let fraction = if current { fraction.0.clamp(0.0, 1.0) } else { 1.0 };
        let toward = wind.direction.normalize_or_zero();
        let ghost = look.ghost.unwrap_or_default();
        let Ghost { color, share } = ghost;
        let clock = Clock {
            time: [fraction, wind.seconds, wind.strength, settings.leaf_distance],
            show: [
                toward.x,
                toward.y,
                look.overlay.map_or(-1.0, |overlay| overlay.number()),
                if look.ghost.is_some() { 1.0 } else { 0.0 },
            ],
            marks: MARK_COLORS,
            ghost: [color.red, color.green, color.blue, share],
            ramp: RAMP.map(|[r, g, b]| [r, g, b, 1.0]),
        };
        write(&mut buffers, &sheets.clock, bytemuck::bytes_of(&clock).to_vec());
    }
}

/// Writes the marks that changed.
pub(super) fn write_marks(
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    stages: Query<(Ref<Stage>, Ref<Marks>), Or<(Changed<Marks>, Changed<Stage>)>>,
) {
    for (stage, marks) in &stages {
        let Some(sheets) = &stage.sheets else { continue };
        // A stage counts as changed whenever it was looked at; without marks there is nothing to follow.
        if marks.is_empty() && !marks.is_changed() {
            continue;
        }
        for (sheet, births) in [&sheets.wood, &sheets.leaves].into_iter().zip(&stage.births) {
            let mut words = marks.bits(births);
            words.resize(sheet.room.div_ceil(16), 0);
            write(&mut buffers, &sheet.marks, bytemuck::cast_slice(&words).to_vec());
        }
    }
}

/// Ghosts cast no shadow.
pub(super) fn follow_looks(mut commands: Commands, stages: Query<(&Stage, &Look), Changed<Look>>) {
    for (stage, look) in &stages {
        for entity in stage.chunks.iter().flat_map(|chunk| [chunk.near, chunk.far]) {
            match look.ghost {
                Some(_) => commands.entity(entity).insert(NotShadowCaster),
                None => commands.entity(entity).remove::<NotShadowCaster>(),
            };
        }
    }
}

fn write(buffers: &mut Assets<ShaderBuffer>, handle: &Handle<ShaderBuffer>, bytes: Vec<u8>) {
    if let Some(mut buffer) = buffers.get_mut(handle) {
        buffer.data = Some(bytes);
    }
}

impl Sheets {
    fn hold(&self, packed: &Packed) -> bool {
        packed.rings.len() <= self.wood.room
            && packed.blades.len() <= self.leaves.room
            && packed.plants.len() <= self.room
    }
}

impl Store<'_> {
    /// New buffers and materials with room for what is packed and some growth.
    fn sheets(&mut self, packed: &Packed) -> Sheets {
        let room = packed.plants.len().next_power_of_two();
        let plants = self.buffer(room * size_of::<PlantEntry>());
        let clock = self.buffer(size_of::<Clock>());
        let wood = self.sheet(packed.rings.len(), &plants, &clock, false);
        let leaves = self.sheet(packed.blades.len(), &plants, &clock, true);
        Sheets { wood, leaves, plants, room, clock }
    }

    fn sheet(
        &mut self,
        records: usize,
        plants: &Handle<ShaderBuffer>,
        clock: &Handle<ShaderBuffer>,
        leaf: bool,
    ) -> Sheet {
        let room = (records + records / 4).next_power_of_two().max(256);
        let records = self.buffer(room * size_of::<Record>());
        let marks = self.buffer(room.div_ceil(16) * 4);
        let extension = PlantExtension {
            records: records.clone(),
            plants: plants.clone(),
            clock: clock.clone(),
            marks: marks.clone(),
            bark: self.bark.0.clone(),
            leaf,
        };
        let base = StandardMaterial {
            perceptual_roughness: 0.8,
            reflectance: if leaf { 0.35 } else { 0.2 },
            diffuse_transmission: if leaf { 0.4 } else { 0.0 },
            cull_mode: if leaf { None } else { Some(bevy::render::render_resource::Face::Back) },
            ..default()
        };
        let material = self.materials.add(PlantMaterial { base, extension });
        Sheet { records, marks, room, material }
    }

    fn buffer(&mut self, bytes: usize) -> Handle<ShaderBuffer> {
        self.buffers.add(ShaderBuffer::new(&vec![0; bytes], RenderAssetUsages::RENDER_WORLD))
    }

    /// Writes what is packed, filled up to the buffers' size so that they stay in place.
    fn fill(&mut self, sheets: &Sheets, packed: &Packed) {
        for (sheet, records) in [(&sheets.wood, &packed.rings), (&sheets.leaves, &packed.blades)] {
            let mut bytes = Vec::with_capacity(sheet.room * size_of::<Record>());
            bytes.extend_from_slice(bytemuck::cast_slice(records));
            bytes.resize(sheet.room * size_of::<Record>(), 0);
            write(&mut self.buffers, &sheet.records, bytes);
        }
        let mut bytes = Vec::with_capacity(sheets.room * size_of::<PlantEntry>());
        bytes.extend_from_slice(bytemuck::cast_slice(&packed.plants));
        bytes.resize(sheets.room * size_of::<PlantEntry>(), 0);
        write(&mut self.buffers, &sheets.plants, bytes);
    }
}

fn despawn_chunks(commands: &mut Commands, chunks: impl IntoIterator<Item = ChunkEntities>) {
    for gone in chunks {
        commands.entity(gone.near).despawn();
        commands.entity(gone.far).despawn();
    }
}

/// Makes the entities show these chunks, with as little change as can be.
fn show_chunks(
    commands: &mut Commands,
    store: &mut Store,
    parent: Entity,
    entities: &mut Vec<ChunkEntities>,
    chunks: &[Chunk],
    sheets: &Sheets,
    look: &Look,
) {
    let mut free: HashMap<(Class, u8), VecDeque<ChunkEntities>> = HashMap::new();
    for entity in entities.drain(..) {
        free.entry((entity.class, entity.capacity)).or_default().push_back(entity);
    }
    for chunk in chunks {
        let there = free.get_mut(&(chunk.class, chunk.capacity)).and_then(VecDeque::pop_front);
        let shown = there.unwrap_or_else(|| {
            let mut spawn = |detail| {
                let mesh = store.chunk_meshes.get(&mut store.meshes, chunk.class, chunk.capacity, detail);
                let leaf = matches!(chunk.class, Class::Blades(_));
                let material = if leaf { &sheets.leaves.material } else { &sheets.wood.material };
                let drawn = (Mesh3d(mesh), MeshMaterial3d(material.clone()));
                let mut entity = commands.spawn((ChildOf(parent), NoAutoAabb, drawn));
                if leaf {
                    entity.insert(TransmittedShadowReceiver);
                }
                if look.ghost.is_some() {
                    entity.insert(NotShadowCaster);
                }
                entity.id()
            };
            let (near, far) = (spawn(Detail::Near), spawn(Detail::Far));
            ChunkEntities { class: chunk.class, capacity: chunk.capacity, near, far }
        });
        let edge = far_from(chunk, &store.settings);
        let last = if chunk.class == Class::Twigs { store.settings.twig_distance.max(edge) } else { FAR };
        for (start, end, entity) in [(0.0, edge, shown.near), (edge, last, shown.far)] {
            commands.entity(entity).insert((
                MeshTag(chunk.first),
                Aabb::from_min_max(chunk.min, chunk.max),
                VisibilityRange { start_margin: start..start, end_margin: end..end, use_aabb: true },
            ));
        }
        entities.push(shown);
    }
    despawn_chunks(commands, free.into_values().flatten());
}

/// The distance from its middle at which a chunk is drawn with less detail, metres, in whole strides so that few
/// different ones are there.
fn far_from(chunk: &Chunk, settings: &DrawSettings) -> f32 {
    const STRIDE: f32 = 8.0;
    let reach = (chunk.max - chunk.min).length() * 0.5;
    let from = match chunk.class {
        // At a fifth of the leaves every fourth blade is enough, also for the nearest leaf of the chunk.
        Class::Blades(_) => settings.leaf_distance * 5.0 * chunk.blade,
        Class::Limbs => FEWER_SIDES[0],
        Class::Branches => FEWER_SIDES[1],
        Class::Twigs => FEWER_SIDES[2],
    };
    ((from + reach) / STRIDE).ceil() * STRIDE
}
