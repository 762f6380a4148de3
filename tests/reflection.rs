//! Everything the crate keeps in a world can be looked at by reflection.

use std::any::TypeId;
use std::collections::HashMap;

use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::prelude::*;
use burgeon::prelude::*;

/// Components and resources a world knows, and how large they are.
fn known(app: &App) -> HashMap<TypeId, String> {
    let known = app.world().components().iter_registered();
    known
        .filter_map(|info| {
            let what = format!("{:?}, {} bytes, {}", info.id(), info.layout().size(), info.name());
            Some((info.type_id()?, what))
        })
        .collect()
}

#[test]
fn every_component_and_resource_is_in_the_registry() {
    let mut without = App::new();
    without.add_plugins(MinimalPlugins).register_type::<Name>();
    without.world_mut().spawn(Transform::default()).with_child(Transform::default());
    without.update();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));
    let world = app.world_mut();
    world.spawn(Plant::new(Species::named("oak").unwrap(), 7));
    world.spawn((Solid::block(Vec3::ONE), Transform::from_xyz(1.0, 0.5, 0.0)));
    world.spawn(Lamp::new(10.0, 0.2));
    world.spawn(Sun { strength: 1.0 });
    grow(world, 4);
    app.update();

    let others = known(&without);
    let ours: Vec<_> = known(&app).into_iter().filter(|(id, _)| !others.contains_key(id)).collect();
    // 33 of our own when this was written; a test that sees none of them would say nothing.
    assert!(ours.len() > 30, "{}", ours.len());
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let missing: Vec<_> = ours.iter().filter(|(id, _)| registry.get(*id).is_none()).collect();
    assert!(missing.is_empty(), "not registered; `register_type` belongs into their plugins: {missing:#?}");
    for registration in ours.iter().filter_map(|(id, _)| registry.get(*id)) {
        let path = registration.type_info().type_path();
        assert!(
            registration.data::<ReflectComponent>().is_some(),
            "{path} lacks #[reflect(Component)] or (Resource)"
        );
    }
}

#[test]
fn a_plant_shows_its_species() {
    let oak = Plant::new(Species::named("oak").unwrap(), 7);
    let bevy::reflect::ReflectRef::Struct(plant) = oak.reflect_ref() else { panic!("a plant is a struct") };
    let species =
        plant.field("species").and_then(|field| field.try_downcast_ref::<std::sync::Arc<Species>>());
    assert_eq!(species.unwrap().name, "oak");
}
