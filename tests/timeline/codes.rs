//! Codes that carry a tree.

use super::*;

fn regrown(code: &str) -> Timeline {
    let shared = SharedTree::from_code(code).unwrap();
    let mut again = Timeline::from_shared(shared, Library::embedded(), workers()).unwrap();
    catch_up(&mut again);
    again
}

#[test]
fn a_code_of_under_thirty_characters_grows_a_shipped_scenario() {
    for name in Library::embedded().scenario_names() {
        let resolved = Library::embedded().scenario(&name).unwrap();
        for (seed, steps) in [(1, 20), (u64::MAX, limits::STEPS)] {
            let tree = SharedTree { resolved: resolved.clone(), edits: Vec::new(), seed, steps };
            let code = tree.code().unwrap();
            assert!(code.len() < 30, "{name}: {code}");
            assert_eq!(SharedTree::from_code(&code).unwrap(), tree);
        }
    }
    let shipped = Library::embedded().scenario("figure_1d").unwrap();
    let mut timeline = Timeline::new(shipped, 3, Library::embedded(), workers()).unwrap();
    grow_to(&mut timeline, 4);
    let code = timeline.code().unwrap();
    println!("figure_1d, seed 3, 4 steps: {code}");
    let again = regrown(&format!(" {}\n{} ", &code[..5], &code[5..]));
    assert_eq!((again.present(), again.hash(4)), (4, timeline.hash(4)));
}

#[test]
fn a_code_holds_edits_changed_parameters_and_scenarios_of_ones_own() {
    let mut resolved = Library::embedded().scenario("figure_1d").unwrap();
    resolved.species.get_mut("lam_king").unwrap().leaf_income = 2.345;
    let mut own = small();
    own.scenario.name = "my own".into();
    own.species.get_mut("lam_king").unwrap().description = "Another text.".into();
    for resolved in [resolved, own] {
        let mut timeline = Timeline::new(resolved, 9, Library::embedded(), workers()).unwrap();
        grow_to(&mut timeline, 4);
        timeline.edit(1, Edit::Plant(Planting { at: Vec3::X * 2.0, ..default() })).unwrap();
        timeline
            .edit(2, Edit::Move { name: "wall".into(), to: Vec3::new(0.4, 1.5, 0.1), turn_deg: 7.5 })
            .unwrap();
        timeline.edit(3, Edit::Remove { name: "wall".into() }).unwrap();
        timeline.undo().unwrap();
        catch_up(&mut timeline);
        let code = timeline.code().unwrap();
        println!("{}: {} characters", timeline.begun().scenario.name, code.len());
        let again = regrown(&code);
        assert_eq!(again.hash(4), timeline.hash(4));
        assert_eq!(again.made(), timeline.made());
    }
}

#[test]
fn what_is_no_code_is_told() {
    let mut timeline = timeline(2);
    timeline.edit(1, Edit::Remove { name: "wall".into() }).unwrap();
    catch_up(&mut timeline);
    let code = timeline.code().unwrap();
    for i in 0..code.len() {
        let other = if code.as_bytes()[i] == b'A' { "B" } else { "A" };
        let mut bad = code.clone();
        bad.replace_range(i..=i, other);
        assert!(
            matches!(SharedTree::from_code(&bad), Err(ShareError::Check | ShareError::Cut { .. })),
            "{bad}"
        );
        let error = SharedTree::from_code(&code[..i]).unwrap_err();
        assert!(matches!(error, ShareError::Check | ShareError::Cut { .. }), "{error}");
    }
    assert!(matches!(
        SharedTree::from_code("no code!"),
        Err(ShareError::Character { at: 8, character: '!' })
    ));
    assert_eq!(SharedTree::from_code(&"A".repeat(limits::CODE_CHARACTERS + 1)), Err(ShareError::TooLong));
}

proptest! {
    #[test]
    fn any_text_as_a_code_is_an_error_not_a_panic(text in "[A-Za-z0-9_-]{0,60}|\\PC{0,30}") {
        prop_assert!(SharedTree::from_code(&text).is_err());
    }
}
