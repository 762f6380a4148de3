use burgeon::plant::measure::Form;
use burgeon::prelude::*;
use burgeon::scenario::{Garden, Scenario};
use std::collections::BTreeMap;
use std::sync::Arc;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let name = args.get(1).cloned().unwrap_or("lam_king".into());
    let steps: u32 = args.get(2).and_then(|s| s.parse().ok()).unwrap_or(8);
    let seed: u64 = args.get(3).and_then(|s| s.parse().ok()).unwrap_or(1);
    let mut sp = Species::default();
    if name != "lam_king" {
        sp = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME).from_str(&std::fs::read_to_string(&name).unwrap()).unwrap();
    }
    let n = sp.name.clone();
    let mut sc = Scenario::default();
    sc.plants[0].species = n.clone();
    if let Ok(s) = std::env::var("FACE") { sc.sensing.leaf_face = s.parse().unwrap(); sc.sensing.bud_face = s.parse().unwrap(); }
    let mut g = Garden::new(sc, BTreeMap::from([(n, Arc::new(sp))]), seed, burgeon::environment::workers::Workers::default()).unwrap();
    for _ in 0..steps {
        let r = g.step().unwrap().clone();
        let f: Form = r.form;
        println!("{:3} org {:6} int {:6} leaf {:5} ap {:4} lat {:5} h {:5.2} w {:5.2} d {:.3} light {:.2} inc {:8.2} up {:7.2} gr {:8.2} wood {:7.2} lost {:6.2} store {:8.2} t {:.2}/{:.2}/{:.2} bal {:.1e}", r.step, f.organs, f.internodes, f.leaves, f.apical_buds, f.lateral_buds, f.height_m, f.crown_width_m, f.trunk_diameter_m, f.mean_light, r.income, r.upkeep, r.growth, r.wood, r.lost, r.store, r.seconds.generate, r.seconds.update, r.seconds.sense, g.snapshot().plants[0].as_ref().unwrap().ledger.imbalance());
    }
    println!("hash {:016x}", g.snapshot().hash());
}
