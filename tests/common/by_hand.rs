//! A few organs set by hand under Bevy's minimal plugins.

use bevy::ecs::system::RunSystemOnce;
use bevy::math::ops;
use bevy::prelude::*;
use burgeon::BurgeonPlugins;
use burgeon::growth::generation::Condemned;
use burgeon::plant::{
    Allotment, ApicalBud, Attachment, BranchOrder, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
    GrowsFrom, GrowthSpan, GrowthTarget, Identity, Internode, LateralBud, Leaf, LeafState, Lineage,
    NO_PARENT, Node, OrganKind, Plant, Pose, Roster,
};
use burgeon::species::Species;
use burgeon::tropism::Steering;

/// A plant whose organs a test sets one by one.
pub struct Nursery {
    /// The app it stands in.
    pub app: App,
    /// The plant.
    pub plant: Entity,
}

impl Nursery {
    /// A germinated plant without organs or energy.
    pub fn new(species: Species) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, BurgeonPlugins));
        let store = EnergyStore { stored: 0.0, germinated: Some(0) };
        let plant = app.world_mut().spawn((Plant::new(species, 7), Transform::default(), store)).id();
        Self { app, plant }
    }

    /// Fills the store.
    pub fn store(mut self, energy: f64) -> Self {
        self.app.world_mut().get_mut::<EnergyStore>(self.plant).unwrap().stored = energy;
        self
    }

    /// Runs one system and nothing else.
    pub fn run<M>(&mut self, system: impl IntoSystem<(), (), M>) {
        self.app.world_mut().run_system_once(system).unwrap();
    }

    /// A straight stem segment on another, or on the plant.
    pub fn stem(&mut self, on: Option<Entity>, length: f32) -> Entity {
        self.turned_stem(on, length, Quat::IDENTITY)
    }

    /// A stem segment turned relative to the one below.
    pub fn turned_stem(&mut self, on: Option<Entity>, length: f32, attachment: Quat) -> Entity {
        let species = self.species();
        let radius = species.twig_radius_m;
        let below = on.map_or(0.0, |on| self.get::<Internode>(on).height_in_branch);
        let order = on.map_or(0, |on| self.get::<BranchOrder>(on).0);
        let turned = attachment != Quat::IDENTITY;
        let internode = Internode {
            length,
            radius,
            height_since_node: length,
            height_in_branch: if turned { length } else { below + length },
            pipe: ops::powf(radius, species.pipe_exponent),
            poor_steps: 0,
            sag: 0.0,
        };
        let order = order + u32::from(turned);
        self.organ(on, OrganKind::Internode, order, attachment, (internode, Node::default()))
    }

    /// A leaf of some size (0..1) in some light that has looked around.
    pub fn leaf(&mut self, on: Entity, size: f32, light: f32) -> Entity {
        let state = if size < 1.0 { LeafState::Growing } else { LeafState::Terminated };
        let state = (Leaf { size, state }, lit(light), Allotment(0.0));
        self.organ(Some(on), OrganKind::Leaf, self.get::<BranchOrder>(on).0, Quat::IDENTITY, state)
    }

    /// An apical bud in some light with some energy.
    pub fn apical_bud(&mut self, on: Option<Entity>, light: f32, energy: f32) -> Entity {
        let order = on.map_or(0, |on| self.get::<BranchOrder>(on).0);
        let state = (
            ApicalBud::default(),
            Steering::default(),
            GrowthTarget::default(),
            lit(light),
            Allotment(energy),
        );
        self.organ(on, OrganKind::ApicalBud, order, Quat::IDENTITY, state)
    }

    /// A lateral bud in some light with some energy.
    pub fn lateral_bud(&mut self, on: Entity, dormancy: u32, light: f32, energy: f32) -> Entity {
        let bud = LateralBud { dormancy, ..default() };
        let order = self.get::<BranchOrder>(on).0 + 1;
        let state = (bud, GrowthTarget::default(), lit(light), Allotment(energy));
        self.organ(Some(on), OrganKind::LateralBud, order, Quat::from_rotation_x(0.9), state)
    }

    /// Any organ.
    pub fn organ(
        &mut self,
        on: Option<Entity>,
        kind: OrganKind,
        order: u32,
        attachment: Quat,
        state: impl Bundle,
    ) -> Entity {
        let parent =
            on.map_or(NO_PARENT, |on| self.roster().entity.iter().position(|&e| e == on).unwrap() as u32);
        let (tip, below) = on.map_or((Vec3::ZERO, Quat::IDENTITY), |on| {
            let pose = self.get::<Pose>(on);
            (pose.tip(self.get::<Internode>(on).length), pose.rotation)
        });
        let pose = Pose { position: tip, rotation: below * attachment };
        let plant = self.plant;
        let world = self.app.world_mut();
        let entity = world
            .spawn((
                GrowsFrom(on.unwrap_or(plant)),
                GrowthSpan::step(0),
                BranchOrder(order),
                Attachment(attachment),
                pose,
                EnergyFlow::default(),
                state,
            ))
            .id();
        let birth = world.resource_mut::<Roster>().bear(entity, parent, 0, kind);
        let lineage = Lineage::SEED.child(birth);
        world.entity_mut(entity).insert(Identity { plant, birth, lineage });
        entity
    }

    /// A component of an organ or of the plant.
    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app.world().get::<C>(entity).unwrap()
    }

    /// A component of an organ or of the plant, to be changed.
    pub fn set<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        entity: Entity,
        value: C,
    ) {
        *self.app.world_mut().get_mut::<C>(entity).unwrap() = value;
    }

    /// Whether an organ lives.
    pub fn lives(&self, entity: Entity) -> bool {
        self.roster().entity.contains(&entity) && self.app.world().get_entity(entity).is_ok()
    }

    /// Living organs of a kind, in birth order.
    pub fn all(&self, kind: OrganKind) -> Vec<Entity> {
        let roster = self.roster();
        (0..roster.len()).filter(|&i| roster.kind[i] == kind).map(|i| roster.entity[i]).collect()
    }

    /// Birth number of an organ.
    pub fn birth(&self, entity: Entity) -> u32 {
        self.get::<Identity>(entity).birth
    }

    /// What is condemned so far.
    pub fn condemned(&self) -> &[(u32, Cause)] {
        &self.app.world().resource::<Condemned>().0
    }

    /// Energy in the store.
    pub fn stored(&self) -> f64 {
        self.get::<EnergyStore>(self.plant).stored
    }

    /// The books.
    pub fn ledger(&self) -> EnergyLedger {
        *self.get::<EnergyLedger>(self.plant)
    }

    /// The species.
    pub fn species(&self) -> Species {
        Species::clone(&self.get::<Plant>(self.plant).species)
    }

    fn roster(&self) -> &Roster {
        self.app.world().resource::<Roster>()
    }
}

fn lit(light: f32) -> Exposure {
    Exposure { light, space: 1.0, sensed: true }
}
