// Heights, widths and diameters: field knowledge, to a third either way; sources in the species' files. Crown bases:
// of oak, birch, spruce, pine and beech Hasenauer 2000 for eighty years in the open, the others field knowledge; from
// 0.15 of the height below, as of younger crowns, to a fifth above. Drooping shares by the angles of branches: 100 to
// 180 degrees in birch, spruce and willow, below 45 in poplar, hazel and candelabra tree. Leaves over the crown's area
// on the ground: oak 5, birch and pine 3, beech 7, to a third either way, to a half for the pine, whose crown is thin
// here; spruce up to 10.5 (Picea abies of 152 years); broadleaved trees of which nothing is known 2 to 7, the mean of
// all; not asked of columns, and of the willow, whose twigs stand for many. Where a crown is widest: as in the outline of a
// full-grown one (field knowledge), to a quarter of the height either way; a pine from the cone of young ones up.

/// A figure, to a third either way.
fn third(figure: f64) -> Option<(f64, f64)> {
    Some((figure * 2.0 / 3.0, figure * 4.0 / 3.0))
}

/// A crown's width, metres: the one given, or what the outline of a grown tree makes of its height.
fn width([given, outlined]: [f64; 2]) -> (f64, f64) {
    (given.min(outlined) * 2.0 / 3.0, given.max(outlined) * 4.0 / 3.0)
}

/// A share of the height, to a quarter of it either way.
fn around(share: f64) -> Option<(f64, f64)> {
    Some((share - 0.25, share + 0.25))
}

/// Branches to each of the next order of Strahler: 4.35 of an apple tree and 4.00 of a birch (Barker, Cumming & Horsfield
/// 1973), the mean of both for other crowns that spread, to a third either way. Not asked of spruce and willow, whose
/// leaf organs stand for their finest twigs, of bundles of rods (poplar, hazel), and of what hardly branches.
fn branching(name: &str) -> Option<(f64, f64)> {
    match name {
        "apple" => third(4.35),
        "silver_birch" => third(4.0),
        "oak" | "scots_pine" | "japanese_maple" | "umbrella_acacia" | "beech" => third(4.2),
        _ => None,
    }
}

fn figures_at_thirty() -> Vec<Figures> {
    const RISES: Option<(f64, f64)> = Some((0.0, 0.1));
    const EITHER: Option<(f64, f64)> = Some((0.05, 0.5));
    const HANGS: Option<(f64, f64)> = Some((0.5, 1.0));
    const BROADLEAVED: Option<(f64, f64)> = Some((2.0, 7.0));
    [
        ("oak", 11.0, [8.0, 9.9], 0.28, 0.15, around(0.5), EITHER, third(5.0)),
        ("silver_birch", 15.0, [7.0, 7.5], 0.25, 0.24, around(0.4), HANGS, third(3.0)),
        ("norway_spruce", 13.0, [6.0, 4.6], 0.25, 0.11, around(0.1), HANGS, Some((5.0, 10.5))),
        ("scots_pine", 11.0, [6.0, 6.1], 0.25, 0.36, Some((0.1, 0.95)), EITHER, Some((1.5, 4.5))),
        ("lombardy_poplar", 22.0, [3.0, 4.0], 0.45, 0.05, around(0.4), RISES, None),
        ("weeping_willow", 13.0, [14.0, 13.7], 0.65, 0.15, around(0.5), HANGS, None),
        ("japanese_maple", 5.0, [5.5, 5.5], 0.13, 0.15, around(0.6), EITHER, BROADLEAVED),
        ("umbrella_acacia", 5.0, [8.0, 8.0], 0.13, 0.5, around(0.9), EITHER, BROADLEAVED),
        ("beech", 12.0, [9.0, 10.2], 0.25, 0.06, around(0.4), EITHER, third(7.0)),
        ("apple", 6.5, [7.0, 7.2], 0.25, 0.2, around(0.5), EITHER, BROADLEAVED),
        ("hazel", 5.5, [5.5, 5.5], 0.09, 0.15, around(0.75), RISES, BROADLEAVED),
        ("palm", 16.0, [8.0, 8.0], 0.3, 0.8, around(0.9), None, None),
        ("candelabra", 8.0, [4.0, 4.0], 0.3, 0.4, None, RISES, None),
    ]
    .into_iter()
    .map(|(name, height, widths, diameter, base, widest, droops, leaves)| {
        let bands = [
            third(height),
            Some(width(widths)),
            Some((base - 0.15, base + 0.2)),
            widest,
            droops,
            third(diameter),
            None,
            leaves,
            None,
            branching(name),
        ];
        Figures { name, bands }
    })
    .collect()
}

/// Stems of ten years are thinner here than the figures say: two fifths of them are enough.
fn figures_at_ten() -> Vec<Figures> {
    [
        ("oak", 4.5, [2.5, 4.0], 0.06),
        ("silver_birch", 6.5, [3.5, 3.3], 0.08),
        ("norway_spruce", 3.0, [1.8, 1.8], 0.04),
        ("scots_pine", 3.0, [2.3, 2.3], 0.05),
        ("lombardy_poplar", 9.0, [1.5, 1.6], 0.13),
        ("weeping_willow", 8.0, [7.0, 7.0], 0.25),
        ("japanese_maple", 2.5, [2.0, 2.0], 0.04),
        ("umbrella_acacia", 2.5, [3.0, 3.0], 0.05),
        ("beech", 4.0, [3.5, 3.4], 0.05),
        ("apple", 3.5, [3.0, 3.8], 0.08),
        ("hazel", 4.0, [3.5, 3.5], 0.04),
        ("palm", 7.0, [8.0, 8.0], 0.3),
        ("candelabra", 3.0, [1.0, 1.0], 0.1),
    ]
    .into_iter()
    .map(|(name, height, widths, diameter)| {
        let mut bands = [None; MEASURES.len()];
        bands[0] = third(height);
        bands[1] = Some(width(widths));
        bands[5] = Some((0.4 * diameter, diameter * 4.0 / 3.0));
        Figures { name, bands }
    })
    .collect()
}
