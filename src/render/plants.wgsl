// Plants between two growth steps: every vertex mixes both states of its organ by the clock.
// One file for what is seen and for depth and shadow; `LEAF` picks blades, else branches.

#import bevy_pbr::{
    mesh_functions,
    mesh_view_bindings::view,
    view_transformations::position_world_to_clip,
}

#ifdef PREPASS_PIPELINE
#import bevy_pbr::prepass_io::VertexOutput
#else
#import bevy_pbr::{
    forward_io::{VertexOutput, FragmentOutput},
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing, alpha_discard},
}
#endif

struct Plant {
    // Where it stands; the colour of its bark's marks.
    base: vec4<f32>,
    crown_before: vec4<f32>,
    crown_now: vec4<f32>,
    // Old bark; which pattern it has.
    bark: vec4<f32>,
    // Bark of twigs; the radius from which bark is old.
    twig: vec4<f32>,
    leaf: vec4<f32>,
    margin: array<vec4<f32>, 4>,
}

struct Clock {
    // Part of the step, wind time in seconds, wind strength, share of leaves kept at a metre's distance.
    time: vec4<f32>,
    // Wind direction x, z; overlay (-1 none, 0 light, 1 space, 2 energy, 3 radius, 4 age, 5 order); ghost.
    show: vec4<f32>,
    // Colours of marks 1 to 3, and how strong each is.
    marks: array<vec4<f32>, 3>,
    // Colour of a ghost; how much of it stays.
    ghost: vec4<f32>,
    // Light of its own, in the first part.
    fill: vec4<f32>,
    // False colours from 0 to 1.
    ramp: array<vec4<f32>, 16>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<storage, read> records: array<vec4<u32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var<storage, read> plants: array<Plant>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var<storage, read> clock: Clock;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var<storage, read> marks: array<u32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(104) var bark_texture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(105) var bark_sampler: sampler;

const BASE: u32 = 1u;
const DYING: u32 = 2u;
const TAU: f32 = 6.2831853;
// Least radius of a branch as it is drawn, in pixels: a tube of three sides is one pixel wide.
const THINNEST: f32 = 0.6;
// Patterns of bark that differ from ridges, in the order of `BarkPattern`.
const SMOOTH: f32 = 1.0;
const PLATES: f32 = 2.0;
const BANDED: f32 = 3.0;
const RINGED: f32 = 4.0;

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    // Unit in bits 0 to 15, place around or side in 16 to 23, end or point of the margin in 24 to 31.
    @location(0) packed: u32,
}

// What both kinds of organ come to.
struct Point {
    position: vec3<f32>,
    normal: vec3<f32>,
    uv: vec2<f32>,
    uv_b: vec2<f32>,
    color: vec4<f32>,
    nothing: bool,
}

fn window(bits: u32, t: f32) -> f32 {
    let start = f32(bits & 0xffu) / 255.0;
    let end = f32((bits >> 8u) & 0xffu) / 255.0;
    return saturate((t - start) / (end - start));
}

fn turn(a: u32, b: u32) -> vec4<f32> {
    return vec4(unpack2x16snorm(a), unpack2x16snorm(b));
}

fn rotate(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

fn rotate_about(v: vec3<f32>, axis: vec3<f32>, angle: f32) -> vec3<f32> {
    let c = cos(angle);
    return v * c + cross(axis, v) * sin(angle) + axis * dot(axis, v) * (1.0 - c);
}

fn mark_of(record: u32) -> u32 {
    return (marks[record / 16u] >> ((record % 16u) * 2u)) & 3u;
}

// How far wind moves what is at a place: smooth in space, so that nothing comes apart.
fn sway(p: vec3<f32>, base: vec3<f32>) -> vec3<f32> {
    let wind = vec3(clock.show.x, 0.0, clock.show.y);
    let high = max(p.y - base.y, 0.0);
    let time = clock.time.y;
    let out = length(p.xz - base.xz);
    let bend = high * high / (high + 5.0);
    let gust = 0.55 + 0.45 * sin(time * 0.7 - dot(wind.xz, p.xz) * 0.16) + 0.25 * sin(time * 1.63 + base.x + base.z);
    let along = wind * (0.011 * bend * gust);
    let phase = p * vec3(0.9, 0.6, 1.1);
    let limbs = vec3(
        sin(time * 1.9 + phase.x + phase.y * 0.7),
        0.7 * sin(time * 2.3 + phase.z + phase.x * 0.5),
        sin(time * 1.7 + phase.z - phase.y * 0.8)
    ) * (0.004 * out * (0.4 + gust));
    return (along + limbs) * clock.time.z;
}

// How far what falls has fallen.
fn fall(p: f32, base_y: f32, y: f32) -> f32 {
    return min(2.6 * p * p, max(y - base_y, 0.0));
}

fn ramp(x: f32) -> vec3<f32> {
    let at = saturate(x) * 15.0;
    let low = min(u32(at), 14u);
    return mix(clock.ramp[low].rgb, clock.ramp[low + 1u].rgb, at - f32(low));
}

// False colour of an organ, with 1 where there is one to show.
fn overlay(who: u32, before: u32, now: u32, t: f32) -> vec4<f32> {
    let shown = i32(clock.show.z);
    if shown < 0 {
        return vec4(0.0);
    }
    if shown == 4 {
        return vec4(ramp(f32(who >> 24u) / 255.0), 1.0);
    }
    if shown == 5 {
        return vec4(ramp(f32((who >> 16u) & 0xffu) / 7.0), 1.0);
    }
    let values = mix(unpack4x8unorm(before), unpack4x8unorm(now), t);
    return vec4(ramp(values[shown]), 1.0);
}

struct RingState {
    center: vec3<f32>,
    radius: f32,
    // A number of its axis' own, 0 to 1.
    chance: f32,
    frame: vec4<f32>,
    along: f32,
    who: u32,
    flags: u32,
    before: u32,
    now: u32,
}

fn ring(index: u32) -> RingState {
    let a = records[index * 4u];
    let b = records[index * 4u + 1u];
    let c = records[index * 4u + 2u];
    let d = records[index * 4u + 3u];
    let t = clock.time.x;
    var out: RingState;
    out.flags = c.w >> 16u;
    out.chance = f32(out.flags >> 8u) / 255.0;
    out.who = d.y;
    out.before = d.z;
    out.now = d.w;
    let p = window(b.y >> 16u, t);
    let radii = unpack2x16float(a.w);
    let shift = vec3(unpack2x16float(b.x), unpack2x16float(b.y).x);
    let base = plants[out.who & 0xffffu].base.xyz;
    out.center = bitcast<vec3<f32>>(a.xyz);
    out.along = bitcast<f32>(c.z);
    out.frame = turn(c.x, c.y);
    if (out.flags & DYING) != 0u {
        out.radius = radii.x * (1.0 - smoothstep(0.5, 1.0, p));
        out.center += sway(out.center, base);
        out.center.y -= fall(p, base.y, out.center.y);
    } else {
        out.center += shift * (1.0 - p);
        out.radius = mix(radii.x, radii.y, p);
        out.frame = normalize(mix(turn(b.z, b.w), out.frame, p));
        out.along += unpack2x16float(c.w).x * (1.0 - p);
        out.center += sway(out.center, base);
    }
    return out;
}

// Bark of a stem of that radius: young on twigs, old on stout stems.
fn bark_color(plant: u32, radius: f32) -> vec3<f32> {
    let oldest = plants[plant].twig.w;
    let t = saturate((radius / max(oldest, 1e-6) - 0.25) / 0.75);
    let age = select(t * t * (3.0 - 2.0 * t), 1.0, oldest <= 0.0);
    return mix(plants[plant].twig.rgb, plants[plant].bark.rgb, age);
}

// Metres that a pixel of this view spans at a place; 0 in a light's view, where nothing is widened.
fn pixel(at: vec3<f32>) -> f32 {
    let eye = view.lod_view_world_position.xyz;
#ifdef PREPASS_PIPELINE
    if distance(view.world_position, eye) > 1e-3 {
        return 0.0;
    }
#endif
    let span = 2.0 / (view.clip_from_view[1][1] * view.viewport.w);
    let is_orthographic = view.clip_from_view[3][3] == 1.0;
    return select(span * distance(at, eye), span, is_orthographic);
}

// The radius a branch is drawn with. What is thinner than a pixel would fall apart into dashes, so it is drawn a pixel
// wide; of what is thinner than a quarter of one, the fewer axes the thinner, so that far crowns are not too dense.
fn drawn_radius(radius: f32, chance: f32, at: vec3<f32>) -> f32 {
    let thinnest = THINNEST * pixel(at);
    if radius >= thinnest || radius <= 0.0 {
        return radius;
    }
    let keep = mix(-0.08, 1.08, saturate(4.0 * radius / thinnest));
    return thinnest * (1.0 - smoothstep(keep - 0.08, keep + 0.08, chance));
}

fn branch(first: u32, packed: u32, world_from_local: mat4x4<f32>) -> Point {
    var out: Point;
    let index = first + (packed & 0xffffu) + (packed >> 24u);
    // The segment leads to the ring after the unit's own.
    let far = first + (packed & 0xffffu) + 1u;
    out.nothing = ((records[far * 4u + 2u].w >> 16u) & BASE) != 0u;
    let at = ring(index);
    let u = f32((packed >> 16u) & 0xffu) / 240.0;
    let around = u * TAU;
    let side = rotate(at.frame, vec3(cos(around), 0.0, -sin(around)));
    let place = (world_from_local * vec4(at.center, 1.0)).xyz;
    // Pixels are told in the world, radii where the plant stands.
    let scale = max(length(world_from_local[1].xyz), 1e-9);
    out.position = at.center + side * drawn_radius(at.radius * scale, at.chance, place) / scale;
    out.normal = side;
    out.uv = vec2(u, at.along);
    let false_color = overlay(at.who, at.before, at.now, clock.time.x);
    let plant = at.who & 0xffffu;
    // The pattern rides on the radius, which stays well below.
    out.uv_b = vec2(min(at.radius, 15.0) + 16.0 * plants[plant].bark.w, false_color.a);
    let own = bark_color(plant, at.radius);
    // The colour of the bark's marks rides on the mark, which is below 4.
    let tint = 4.0 * plants[plant].base.w;
    out.color = vec4(mix(own, false_color.rgb, false_color.a), f32(mark_of(far)) + tint);
    return out;
}

// The share of leaves kept at a distance, each the larger for it.
fn kept(distance: f32) -> f32 {
    return clamp(clock.time.w / max(distance, 0.01), 0.0625, 1.0);
}

fn blade(first: u32, packed: u32) -> Point {
    var out: Point;
    let index = first + (packed & 0xffffu);
    let a = records[index * 4u];
    let b = records[index * 4u + 1u];
    let c = records[index * 4u + 2u];
    let d = records[index * 4u + 3u];
    let t = clock.time.x;
    let time = clock.time.y;
    let flags = c.w >> 16u;
    let who = d.y;
    let plant = who & 0xffffu;
    let base = plants[plant].base.xyz;
    let scales = unpack2x16float(a.w);
    out.nothing = (flags & BASE) != 0u;

    let petiole = vec3(unpack2x16float(b.z), unpack2x16float(b.w).x);
    var midrib = vec3(unpack2x16float(b.w).y, unpack2x16float(c.x));
    let last = unpack2x16float(c.z);
    var across = vec3(unpack2x16float(c.y), last.x);
    let chance = last.y;

    let p = window(b.y >> 16u, t);
    var attached = bitcast<vec3<f32>>(a.xyz);
    var scale: f32;
    var fallen = 0.0;
    if (flags & DYING) != 0u {
        scale = scales.x * (1.0 - smoothstep(0.55, 1.0, p));
        fallen = p;
    } else {
        let q = window(c.w, t);
        scale = mix(scales.x, scales.y, q);
        attached += vec3(unpack2x16float(b.x), unpack2x16float(b.y).x) * (1.0 - p);
    }
    attached += sway(attached, base);

    // Fewer leaves at a distance: each shrinks away before the next level leaves it out.
    let distance = length(view.lod_view_world_position.xyz - attached) / max(plants[plant].leaf.w, 0.001);
    let keep = kept(distance);
    let rank_bits = reverseBits(packed & 0xfu) >> 28u;
    let order = (f32(rank_bits) + 0.5) / 16.0;
    let here = 1.0 - smoothstep(keep - 0.02, keep + 0.04, order);
    scale *= select(here / sqrt(keep), 1.0, keep >= 1.0);
    out.nothing = out.nothing || scale <= 0.0;

    // Flutter about the stalk, and a half fold while the blade is young.
    let unit_midrib = normalize(midrib);
    let phase = chance * TAU;
    let flutter = clock.time.z * (0.10 + 0.10 * sin(time * 0.9 + attached.x * 0.4 + attached.z * 0.3));
    across = rotate_about(across, unit_midrib, flutter * sin(time * (5.0 + 3.0 * chance) + phase));
    let level = normalize(across);
    midrib = rotate_about(midrib, level, flutter * 0.8 * sin(time * (3.1 + 2.0 * chance) + phase * 1.7));
    if fallen > 0.0 {
        let spin = fallen * (4.0 + 5.0 * chance);
        midrib = rotate_about(midrib, vec3(0.0, 1.0, 0.0), spin);
        across = rotate_about(rotate_about(across, vec3(0.0, 1.0, 0.0), spin), normalize(midrib), spin * 1.3);
        let drift = vec3(clock.show.x, 0.0, clock.show.y) * fallen * 0.5
            + 0.25 * fallen * vec3(sin(phase + fallen * 6.0), 0.0, cos(phase * 1.3 + fallen * 5.0));
        attached += drift;
        attached.y -= fall(fallen, base.y, attached.y) * (0.5 + 0.6 * chance);
    }

    let point = packed >> 24u;
    let side = f32((packed >> 16u) & 0xffu) - 1.0;
    var s = 0.0;
    var width = 0.0;
    if point > 0u {
        let row = plants[plant].margin[(point - 1u) / 2u];
        let at = select(row.xy, row.zw, (point - 1u) % 2u == 1u);
        s = at.x;
        width = at.y;
    }
    let face = normalize(cross(across, midrib));
    // Blades curl down towards the tip and are a little hollow.
    let droop = (0.18 + 0.25 * chance) * s * s * length(midrib);
    let hollow = 0.22 * abs(side) * width * length(across);
    var at = vec3(0.0);
    if point > 0u {
        at = petiole + midrib * s + across * (side * width) - face * droop + face * hollow;
    }
    out.position = attached + at * scale;
    out.uv = vec2(side * width, s);

    let crown = mix(plants[plant].crown_before, plants[plant].crown_now, t);
    let outward = (attached - crown.xyz) * vec3(1.0, 1.25, 1.0);
    let depth = saturate(length(outward) / max(crown.w * 1.4, 0.05));
    let round = normalize(outward + vec3(0.0, 0.35 * crown.w + 0.01, 0.0));
    let curl = normalize(face + normalize(across) * (-side * 0.22) + unit_midrib * (0.4 * s));
    out.normal = normalize(mix(curl, round, 0.55));

    let false_color = overlay(who, d.z, d.w, t);
    var color = plants[plant].leaf.rgb;
    // No two leaves are of one green: some yellower, some bluer; the inner ones deeper.
    let other = fract(chance * 7.31);
    color *= mix(vec3(1.02, 1.12, 1.02), vec3(1.65, 1.48, 1.05), chance) * (0.88 + 0.24 * other);
    // Young leaves are fresh and light, falling ones turn.
    let young = saturate(1.0 - scales.x / max(scales.y, 0.001)) * (1.0 - t);
    color = mix(color, color * vec3(1.35, 1.25, 0.7), young);
    if fallen > 0.0 {
        color = mix(color, vec3(0.42, 0.27, 0.06) * (0.7 + 0.6 * other), smoothstep(0.0, 0.35, fallen));
    }
    out.color = vec4(mix(color, false_color.rgb, false_color.a), f32(mark_of(index)));
    // How open to the sky it lies, for what light gets in.
    out.uv_b = vec2(mix(0.35, 1.0, depth * depth), false_color.a);
    return out;
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let first = mesh_functions::get_tag(vertex.instance_index);
    let world_from_local = mesh_functions::get_world_from_local(vertex.instance_index);
#ifdef LEAF
    let point = blade(first, vertex.packed);
#else
    let point = branch(first, vertex.packed, world_from_local);
#endif
    out.world_position = mesh_functions::mesh_position_local_to_world(world_from_local, vec4(point.position, 1.0));
    out.position = position_world_to_clip(out.world_position.xyz);
    if point.nothing {
        out.position = vec4(2.0, 2.0, 2.0, 1.0);
    }
    out.uv = point.uv;
#ifdef PREPASS_PIPELINE
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    out.world_normal = mesh_functions::mesh_normal_local_to_world(point.normal, vertex.instance_index);
#endif
#ifdef MOTION_VECTOR_PREPASS
    let previous = mesh_functions::get_previous_world_from_local(vertex.instance_index);
    out.previous_world_position = mesh_functions::mesh_position_local_to_world(previous, vec4(point.position, 1.0));
#endif
#else
    out.world_normal = mesh_functions::mesh_normal_local_to_world(point.normal, vertex.instance_index);
#endif
    out.uv_b = point.uv_b;
    out.color = point.color;
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance_index;
#endif
#ifdef VISIBILITY_RANGE_DITHER
    out.visibility_range_dither =
        mesh_functions::get_visibility_range_dither_level(vertex.instance_index, world_from_local[3]);
#endif
    return out;
}

#ifndef PREPASS_PIPELINE
// Bark at one size of tile: normal x, y, height, colour.
fn bark_at(around: f32, along: f32, tiles: f32) -> vec4<f32> {
    return textureSample(bark_texture, bark_sampler, vec2(around * tiles, along));
}

// Colour of five bits a channel, each the root of how bright it is.
fn mark_color(bits: i32) -> vec3<f32> {
    let roots = vec3(f32((bits >> 10) & 31), f32((bits >> 5) & 31), f32(bits & 31)) / 31.0;
    return roots * roots;
}

// Which way texture runs across a surface that has no tangents.
fn bumped(normal: vec3<f32>, position: vec3<f32>, uv: vec2<f32>, bump: vec2<f32>) -> vec3<f32> {
    let dx = dpdx(position);
    let dy = dpdy(position);
    let du = vec2(dpdx(uv.x), dpdy(uv.x));
    let dv = vec2(dpdx(uv.y), dpdy(uv.y));
    let perp_x = cross(dy, normal);
    let perp_y = cross(normal, dx);
    let tangent = perp_x * du.x + perp_y * du.y;
    let bitangent = perp_x * dv.x + perp_y * dv.y;
    let longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if longest <= 1e-20 {
        return normal;
    }
    let scale = inverseSqrt(longest);
    return normalize(normal - (tangent * bump.x + bitangent * bump.y) * scale);
}

// A regular pattern of thresholds, 0..1.
fn screen_door(at: vec2<f32>) -> f32 {
    let cell = vec2<u32>(at) % 4u;
    let pattern = array<u32, 16>(0u, 8u, 2u, 10u, 12u, 4u, 14u, 6u, 3u, 11u, 1u, 9u, 15u, 7u, 13u, 5u);
    return (f32(pattern[cell.y * 4u + cell.x]) + 0.5) / 16.0;
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
#ifdef VISIBILITY_RANGE_DITHER
    bevy_pbr::pbr_functions::visibility_range_dither(in.position, in.visibility_range_dither);
#endif
    let ghost = clock.show.w > 0.5;
    if ghost && screen_door(in.position.xy) > clock.ghost.a {
        discard;
    }
    var pbr = pbr_input_from_standard_material(in, is_front);
    var color = in.color.rgb;
    let tag = i32(round(in.color.a));
    let plain = 1.0 - in.uv_b.y;
#ifdef LEAF
    // Paler veins: the midrib and six pairs that leave it at an angle.
    let across = abs(in.uv.x);
    let sharp = fwidth(in.uv.y) * 6.0;
    let rib = 1.0 - smoothstep(0.02, 0.07 + sharp, across);
    let along = fract((in.uv.y - across * 0.45) * 7.0);
    let vein = (1.0 - smoothstep(0.06, 0.16 + sharp * 4.0, min(along, 1.0 - along))) * saturate(1.0 - sharp * 4.0);
    color *= 1.0 + plain * (0.35 * rib + 0.12 * vein - 0.06);
    let under = !is_front;
    if under {
        color = mix(color, color * vec3(0.92, 0.98, 1.05) + vec3(0.02), 0.6 * plain);
    }
    pbr.material.perceptual_roughness = 0.62;
    pbr.material.diffuse_transmission = 0.5;
    pbr.diffuse_occlusion = vec3(in.uv_b.x);
#else
    let pattern = floor(in.uv_b.x / 16.0 + 0.001);
    let radius = in.uv_b.x - 16.0 * pattern;
    // Tiles double in number as a stem doubles in girth, one set fading into the next.
    let level = max(log2(max(TAU * radius, 1e-4) / 0.32), 0.0);
    let tiles = exp2(floor(level));
    let along = in.uv.y / 0.42;
    let bark = mix(bark_at(in.uv.x, along, tiles), bark_at(in.uv.x, along, tiles * 2.0), fract(level));
    // Twigs are smooth.
    let streak = bark_at(in.uv.x, in.uv.y * 2.3, 2.0).a;
    var rough = smoothstep(0.004, 0.05, radius) * plain;
    let blotch = bark_at(in.uv.x, in.uv.y * 1.8, 1.0).a;
    let flake = bark_at(in.uv.x, in.uv.y * 4.0, 2.0 * tiles).a;
    if pattern == SMOOTH || pattern == BANDED {
        rough *= 0.3;
    }
    // How much of the marks shows: as `Bark::at` has it, by what this tile's noise comes to.
    var shows = 0.0;
    if pattern == PLATES {
        rough *= 0.7;
        shows = 0.8 * (1.0 - smoothstep(0.01, 0.05, abs(flake - 0.5)));
    }
    if pattern == BANDED {
        // Level streaks and dark spots; the foot of a stout trunk is furrowed.
        let foot = smoothstep(0.07, 0.13, radius);
        let furrow = foot * (1.0 - smoothstep(0.4, 0.66, bark.b));
        shows = max(max(smoothstep(0.56, 0.64, streak), smoothstep(0.70, 0.76, blotch)), furrow);
        rough *= 1.0 + 2.0 * foot;
    }
    if pattern == RINGED {
        let ring = abs(fract(in.uv.y / 0.09) - 0.5);
        shows = 0.55 * (1.0 - smoothstep(0.0, 0.22, ring));
    }
    color = mix(color, mark_color(tag >> 2), shows * smoothstep(0.02, 0.05, radius) * plain);
    let crust = bark.a - 0.5;
    color *= mix(1.0, (0.55 + 1.0 * bark.b) * (1.0 + 0.3 * crust), 0.35 * plain + 0.65 * rough);
    color *= mix(vec3(1.0), vec3(1.0 + 0.14 * crust, 1.0, 1.0 - 0.16 * crust), rough);
    let bump = (bark.rg * 2.0 - 1.0) * 1.6 * rough;
    pbr.N = bumped(pbr.N, in.world_position.xyz, vec2(in.uv.x * max(TAU * radius, 0.01), in.uv.y), bump);
    pbr.material.perceptual_roughness = 0.92;
    pbr.diffuse_occlusion = vec3(mix(1.0, 0.55 + 0.45 * bark.b, rough));
#endif
    if ghost {
        color = mix(color, clock.ghost.rgb, 0.75);
    }
    pbr.material.base_color = vec4(color, 1.0);
    var out: FragmentOutput;
    out.color = apply_pbr_lighting(pbr);
    // Edges catch it most, as light from behind would.
    let edge = 1.0 - abs(dot(pbr.N, pbr.V));
    let fill = clock.fill.x * (color * 0.7 + vec3(0.05, 0.055, 0.03) * edge * edge);
    out.color = vec4(out.color.rgb + fill, out.color.a);
    let mark = tag & 3;
    if mark > 0 {
        let glow = clock.marks[mark - 1];
        let rim = 0.45 + 0.55 * (1.0 - abs(dot(pbr.N, pbr.V)));
        out.color = vec4(mix(out.color.rgb, glow.rgb, glow.a * rim), out.color.a);
    }
    out.color = main_pass_post_lighting_processing(pbr, out.color);
    return out;
}
#endif
