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
use super::record::Record;

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
    packing: Option<(Drawn, Task<Load>)>,
    /// What is packed, until it lands.
    packed: Option<(Drawn, Load)>,
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
    clock: Handle<ShaderBuffer>,
    rooms: Rooms,
}

/// Records of wood, records of leaves and plants there is room for.
type Rooms = [usize; 3];

/// Records of one kind.
#[derive(Clone)]
struct Sheet {
    records: Handle<ShaderBuffer>,
    marks: Handle<ShaderBuffer>,
    material: Handle<PlantMaterial>,
}

/// What is packed, as buffers take it: filled up to their size, so that they stay in place.
struct Load {
    rooms: Rooms,
    /// Wood, leaves, plants.
    bytes: [Vec<u8>; 3],
    births: [Vec<u32>; 2],
    chunks: Vec<Chunk>,
}

impl Load {
    /// Packs for buffers that are there, if they hold it, else for larger ones with room for some growth.
    fn of(drawn: &Drawn, there: Option<Rooms>) -> Self {
        fn filled<T: Pod>(things: &[T], room: usize) -> Vec<u8> {
            let mut bytes = Vec::with_capacity(room * size_of::<T>());
            bytes.extend_from_slice(bytemuck::cast_slice(things));
            bytes.resize(room * size_of::<T>(), 0);
            bytes
        }
        let Packed { rings, blades, plants, chunks } = pack(&drawn.before, &drawn.now);
        let needed = [rings.len(), blades.len(), plants.len()];
        let rooms = there.filter(|there| there.iter().zip(needed).all(|(&room, needed)| needed <= room));
        let rooms = rooms.unwrap_or_else(|| {
            let [wood, leaves] = [needed[0], needed[1]].map(|n| (n + n / 4).next_power_of_two().max(256));
            [wood, leaves, needed[2].next_power_of_two()]
        });
        Self {
            rooms,
            bytes: [filled(&rings, rooms[0]), filled(&blades, rooms[1]), filled(&plants, rooms[2])],
            births: [&rings, &blades].map(|records| records.iter().map(Record::birth).collect()),
            chunks,
        }
    }
}

/// What changes every frame, as `plants.wgsl` reads it.
#[derive(Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
struct Clock {
    time: [f32; 4],
    show: [f32; 4],
    marks: [[f32; 4]; 3],
    ghost: [f32; 4],
    fill: [f32; 4],
    ramp: [[f32; 4]; 16],
}

/// Begins to pack what changed.
pub(super) fn begin_packing(
    mut commands: Commands,
    settings: Res<DrawSettings>,
    time: Res<Time<Real>>,
    mut drawn: Query<(Entity, &Drawn, &StepFraction, Option<&mut Stage>)>,
) {
    for (entity, drawn, fraction, stage) in &mut drawn {
        let Some(mut stage) = stage else {
            commands.entity(entity).insert(Stage::default());
            continue;
        };
        let of = left_of(drawn, fraction);
        if stage.packing.is_some() || stage.shown.as_ref().is_some_and(|shown| is_same(shown, &of)) {
            continue;
        }
        let there = stage.sheets.as_ref().map(|sheets| sheets.rooms);
        let at_once = settings.pack_at_once || time.delta_secs() > SLOW;
        if at_once || of.before.len() + of.now.len() < AT_ONCE {
            let load = Load::of(&of, there);
            stage.packed = Some((of, load));
        } else {
            let task = {
                let of = of.clone();
                AsyncComputeTaskPool::get().spawn(async move { Load::of(&of, there) })
            };
            stage.packing = Some((of, task));
        }
    }
}

/// What is to be drawn of it. Where nothing lives and all has fallen, no mesh is left that something could be seen of:
/// it may be long until the next step.
fn left_of(drawn: &Drawn, fraction: &StepFraction) -> Drawn {
    if drawn.now.is_empty() && fraction.0 >= 1.0 { Drawn::still(drawn.now.clone()) } else { drawn.clone() }
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
                Some(load) => stage.packed = Some((of, load)),
                None => stage.packing = Some((of, task)),
            }
        }
        let Some((of, Load { rooms, bytes, births, chunks })) = stage.packed.take() else { continue };
        let sheets = match stage.sheets.take() {
            Some(sheets) if sheets.rooms == rooms => {
                let buffers = [&sheets.wood.records, &sheets.leaves.records, &sheets.plants];
                for (buffer, bytes) in buffers.into_iter().zip(bytes) {
                    write(&mut store.buffers, buffer, bytes);
                }
                sheets
            }
            given_up => {
                if let Some(old) = given_up {
                    stage.leaving.push((core::mem::take(&mut stage.chunks), old, LEAVING));
                }
                store.sheets(rooms, bytes)
            }
        };
        stage.births = births;
        show_chunks(&mut commands, &mut store, entity, &mut stage.chunks, &chunks, &sheets, look);
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
        let current = stage.shown.as_ref().is_some_and(|shown| is_same(shown, &left_of(drawn, fraction)));
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
            fill: [look.fill, 0.0, 0.0, 0.0],
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
        let both = [&sheets.wood, &sheets.leaves].into_iter().zip(sheets.rooms);
        for ((sheet, room), births) in both.zip(&stage.births) {
            let mut words = marks.bits(births);
            words.resize(room.div_ceil(16), 0);
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

impl Store<'_> {
    /// New buffers and materials.
    fn sheets(&mut self, rooms: Rooms, [wood, leaves, plants]: [Vec<u8>; 3]) -> Sheets {
        let plants = self.buffer(plants);
        let clock = self.buffer(vec![0; size_of::<Clock>()]);
        let wood = self.sheet(wood, rooms[0], &plants, &clock, false);
        let leaves = self.sheet(leaves, rooms[1], &plants, &clock, true);
        Sheets { wood, leaves, plants, clock, rooms }
    }

    fn sheet(
        &mut self,
        records: Vec<u8>,
        room: usize,
        plants: &Handle<ShaderBuffer>,
        clock: &Handle<ShaderBuffer>,
        leaf: bool,
    ) -> Sheet {
        let records = self.buffer(records);
        let marks = self.buffer(vec![0; room.div_ceil(16) * 4]);
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
        Sheet { records, marks, material }
    }

    fn buffer(&mut self, bytes: Vec<u8>) -> Handle<ShaderBuffer> {
        let asset_usage = RenderAssetUsages::RENDER_WORLD;
        self.buffers.add(ShaderBuffer { data: Some(bytes), asset_usage, ..default() })
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
