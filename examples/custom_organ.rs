//! An organ of your own: side buds that have slept in good light open as flowers, and the tree pays for them.
//!
//! ```sh
//! cargo run --no-default-features --example custom_organ
//! ```

use bevy::prelude::*;
use burgeon::prelude::*;

/// A bud that flowers. A component like any other: it goes when its bud is shed.
#[derive(Component)]
struct Flower {
    /// Step it opened in.
    opened: u32,
}

/// Light a bud flowers in; half a sphere of sky, as on open ground, is 0.5.
const LIGHT: f32 = 0.4;

/// What a flower costs; 1 is what a full-grown leaf of `lam_king` earns in a step of full light.
const COST: f64 = 0.5;

/// Opens flowers. Walks the roster, not a query, so that the same bud is served first every time.
fn flower(
    mut commands: Commands,
    step: Res<StepCount>,
    roster: Res<Roster>,
    buds: Query<(&Identity, &LateralBud, &Exposure), Without<Flower>>,
    mut books: Query<(&mut EnergyStore, &mut EnergyLedger)>,
) {
    for &entity in &roster.entity {
        let Ok((identity, bud, exposure)) = buds.get(entity) else { continue };
        let Ok((mut store, mut ledger)) = books.get_mut(identity.plant) else { continue };
        let ready = bud.state == LateralBudState::Dormant && exposure.sensed && exposure.light > LIGHT;
        if ready && store.stored >= COST {
            // What the store gives, the ledger books: income and spending still agree.
            store.stored -= COST;
            ledger.growth += COST;
            commands.entity(entity).insert(Flower { opened: step.0 });
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));
    // The stages of a step are sets: a system goes into one, or between two.
    app.add_systems(GrowthStep, flower.after(Stage::Update).before(Stage::Sense));

    let world = app.world_mut();
    let tree = world.spawn((Plant::new(Species::named("oak")?, 4), Transform::default())).id();
    for year in 0..10 {
        grow(world, 1);
        let new = world.query::<&Flower>().iter(world).filter(|f| f.opened == year).count();
        let books = world.get::<EnergyLedger>(tree).ok_or("the tree is gone")?;
        println!("year {year}: {new:3} new flowers, books off by {:.0e}", books.imbalance());
    }
    Ok(())
}
