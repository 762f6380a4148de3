//! The shortest way to a tree.

use bevy::prelude::*;
use burgeon::prelude::*;

#[test]
fn a_tree_grows() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));
    app.world_mut().spawn((Plant::new(Species::default(), 7), Transform::default()));

    grow(app.world_mut(), 5);

    let leaves = app.world_mut().query::<&Leaf>().iter(app.world()).count();
    assert!(leaves > 10, "{leaves} leaves after five steps");
}
