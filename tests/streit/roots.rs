//! Roots whose surface grows.

use super::*;

#[test]
fn st_02_the_tip_angles_of_figure_3a() {
    let flank = |most| Relel { most, centre: 3.0, spread: 1.0 };
    for (time, derived, printed) in [(0.126, 18.07, 18.1), (0.380, 54.50, 54.5), (0.633, 90.79, 90.8)] {
        let angle = bend(flank(2.0), flank(1.0), time, 12.0, 1.0, 2000).tip_angle.to_degrees();
        println!("ST-2 t = {time}: {angle:.3} degrees, the paper {printed}");
        assert!((angle - derived).abs() < 0.05 && (angle - printed).abs() < 0.05, "{angle}");
    }
    // Proportional to the difference of the rates, and to nothing else.
    let angle = |upper, lower| bend(flank(upper), flank(lower), 0.1, 12.0, 1.0, 500).tip_angle;
    assert!((angle(3.0, 1.0) - 2.0 * angle(2.0, 1.0)).abs() < 1e-4 && angle(1.5, 1.5) == 0.0);
}

#[test]
fn st_03_different_zones_make_a_kink() {
    let upper = Relel { most: 3.0, centre: 3.0, spread: 0.7 };
    let lower = Relel { most: 1.0, centre: 5.0, spread: 1.0 };
    let root = bend(upper, lower, 0.5, 12.0, 1.0, 1200);
    let at = |distance: f32| root.bends[((12.0 - distance) * 100.0) as usize];
    assert!(at(3.0) > 0.0 && at(5.5) < 0.0, "it bends one way at the one zone, the other way at the other");
    let plain = bend(Relel { most: 2.0, ..upper }, Relel { most: 1.0, ..upper }, 0.5, 12.0, 1.0, 1200);
    assert!(plain.bends.iter().all(|bend| *bend >= 0.0));
}

#[test]
fn st_04_a_level_root_bends_until_it_is_aligned_and_a_hanging_one_grows_straight() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    for columns in [2, 12] {
        let settings = RootSettings { columns, ..RootSettings::default() };
        let mut root = AuxinRoot::new(settings, level).unwrap();
        let angles: Vec<f32> = (0..60)
            .map(|_| {
                root.grow(1.0);
                root.tip_angle().to_degrees()
            })
            .collect();
        println!(
            "ST-4, {columns} columns: tip to gravity by hour {angles:.1?}, {:.1} mm long",
            root.length()
        );
        assert!(angles[0] > 60.0 && angles[59] < 5.0, "{angles:?}");
        assert!(root.assemble().iter().all(|p| p.position.z.abs() < 0.01 * root.length()));
        let mut hanging = AuxinRoot::new(settings, Quat::from_rotation_z(core::f32::consts::PI)).unwrap();
        hanging.grow(30.0);
        assert!(hanging.tip_angle() < 1e-3 && hanging.length() > 12.0, "{}", hanging.length());
    }
}

#[test]
fn st_04_zone_transport_and_inhibition_change_the_shape() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    let hours_to_45 = |settings: RootSettings| {
        let mut root = AuxinRoot::new(settings, level).unwrap();
        (1..400).find(|_| {
            root.grow(0.25);
            root.tip_angle() < 45_f32.to_radians()
        })
    };
    let plain = RootSettings::default();
    let weak = hours_to_45(RootSettings { inhibition: 0.5, ..plain });
    let slow = hours_to_45(RootSettings { transport: 0.5, ..plain });
    let usual = hours_to_45(plain).unwrap();
    println!("ST-4: quarter hours to 45 degrees {usual}, weak inhibition {weak:?}, slow transport {slow:?}");
    assert!(weak.is_none_or(|t| t > usual) && slow.is_none_or(|t| t > usual));
    // Without inhibition, or with an even split, nothing bends.
    for even in [RootSettings { inhibition: 0.0, ..plain }, RootSettings { bias: 0.0, ..plain }] {
        let mut root = AuxinRoot::new(even, level).unwrap();
        root.grow(10.0);
        assert!((root.tip_angle() - core::f32::consts::FRAC_PI_2).abs() < 1e-3);
    }
    assert!(AuxinRoot::new(RootSettings { columns: 1, ..plain }, level).is_err());
    assert!(AuxinRoot::new(RootSettings { length: f32::NAN, ..plain }, level).is_err());
}

#[test]
fn st_04_a_solid_root_turned_about_the_vertical_is_the_same_root_turned() {
    let settings = RootSettings { columns: 16, taper: 0.5, ..RootSettings::default() };
    let level = Quat::from_rotation_z(-1.2);
    let turn = Quat::from_rotation_y(1.3);
    let [mut here, mut there] = [level, turn * level].map(|base| AuxinRoot::new(settings, base).unwrap());
    here.grow(12.0);
    there.grow(12.0);
    for (a, b) in here.assemble().iter().zip(there.assemble()) {
        assert!((turn * a.position).distance(b.position) < 1e-3);
    }
}
