//! The kinds of plant: one table of parameters a species is made of.
//!
//! [`Species`] is generated from that table, and so are its defaults, its validation, `burgeon describe` and
//! `--set`. The defaults are those of `lam_king`: the paper's constants alone (`LK-16`).

pub mod parameter;

use bevy::prelude::*;

use crate::shape::bark::BarkPattern;
use crate::shape::foliage::FoliageForm;
use crate::shape::outline::LeafOutline;
use crate::tropism::Spread;
use parameter::{ByOrder, Color, Range, parameters};

/// How a plant shares its surplus among its buds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, serde::Serialize, serde::Deserialize)]
pub enum Allocation {
    /// To leaves, then buds, in order of exposure until it is gone (`LK-12`).
    #[default]
    ByExposure,
    /// By vigour that flows from the base and splits at every fork (Borchert & Honda; Palubicki 2009).
    ByVigour,
}

/// Which reading of a cube map counts as light (`LK-13`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, serde::Serialize, serde::Deserialize)]
pub enum LightReading {
    /// The share of pixels that show sky or a lamp: the paper's.
    #[default]
    Share,
    /// Radiance x solid angle over that of a full open sky, lamps and sun by shadow rays.
    Radiance,
}

parameters! {
    /// The parameters of a kind of plant.
    pub struct Species {
        // Form
        /// Angle at which a side axis leaves its parent stem, by order of that.
        branching_angle_deg: ByOrder = ByOrder::all(50.0), "deg", Range::real(0.0, 180.0);
        /// Widest turn of a bud in one step: the half angle of the cone it searches.
        bending_angle_deg: f32 = 40.0, "deg", Range::real(0.0, 180.0);
        /// Angle about the stem from one leaf to the next.
        phyllotaxis_deg: f32 = 137.5, "deg", Range::real(0.0, 360.0);
        /// Chance in the angles at which organs leave a stem and in those about it, standard deviation.
        angle_spread_deg: f32 = 6.0, "deg", Range::real(0.0, 90.0);
        /// Length grown between two nodes.
        node_spacing_m: f32 = 0.2, "m", Range::real(0.001, 10.0);
        /// Longest straight segment; a longer node spacing is made of several.
        internode_m: f32 = 0.2, "m", Range::real(0.001, 10.0);
        /// Longest growth of a bud in one step, at full energy; by exposure.
        extension_m: f32 = 0.2, "m", Range::real(0.001, 10.0);
        /// Leaves formed at a node.
        leaves_per_node: u32 = 3, "", Range::whole(0, 12);
        /// Lateral buds formed at a node.
        lateral_buds_per_node: u32 = 0, "", Range::whole(0, 12);
        /// Lateral buds in a ring at the end of a growth unit, by order of the axis that bears them: whorls.
        whorl_buds: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 24.0);
        /// Planation: how far buds of a level axis turn into the level plane, by its order; 0 not, 1 wholly.
        planation: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 1.0);
        /// Apical buds formed at a node, besides the one that goes on if the axis continues.
        apical_buds_per_node: u32 = 3, "", Range::whole(0, 12);
        /// Whether the bud that forms a node goes on as the same axis; if not, it ends in its node's buds.
        axis_continues: bool = false, "", Range::any();
        /// Highest branch order; axes of this order bear no buds.
        max_order: u32 = 24, "", Range::whole(0, 255);

        // Leaves
        /// Length of the largest leaf.
        leaf_length_m: f32 = 0.12, "m", Range::real(0.001, 10.0);
        /// Width of the largest leaf.
        leaf_width_m: f32 = 0.06, "m", Range::real(0.001, 10.0);
        /// Outline of the blade.
        leaf_outline: LeafOutline = LeafOutline::Elliptic, "", Range::any();
        /// Blades a leaf organ stands for; a tall tree cannot carry every leaf.
        leaf_cluster: u32 = 1, "", Range::whole(1, 64);
        /// How the blades of a leaf organ stand on the stalk they share.
        foliage: FoliageForm = FoliageForm::Tuft, "", Range::any();
        /// Length of that stalk; 0: as short as the blades allow.
        foliage_length_m: f32 = 0.0, "m", Range::real(0.0, 10.0);
        /// How far blades and the end of their stalk hang: 0 not, 1 straight down.
        leaf_hang: f32 = 0.0, "", Range::real(0.0, 1.0);
        /// Angle of a leaf to its stem.
        leaf_angle_deg: f32 = 60.0, "deg", Range::real(0.0, 180.0);
        /// Angle by which a leaf sinks away from its stem each step, up to 150 degrees.
        leaf_droop_deg: f32 = 0.0, "deg/step", Range::real(0.0, 180.0);
        /// Life of a leaf, after which it falls and hands what it earned in its last step to its stem; 0: until it is shed.
        leaf_life_steps: u32 = 0, "steps", Range::whole(0, 10_000);
        /// Largest part of a leaf's final size grown in one step.
        leaf_growth: f32 = 1.0, "1/step", Range::real(0.01, 1.0);

        // Buds
        /// Dormancy of a new lateral bud.
        dormancy_steps: u32 = 0, "steps", Range::whole(0, 10_000);
        /// Light below which a lateral bud's dormancy stands still.
        dormancy_light: f32 = 0.0, "", Range::real(0.0, 1.0);
        /// Energy allotted below which a lateral bud's dormancy stands still.
        dormancy_energy: f32 = 0.0, "energy", Range::real(0.0, 1.0e6);
        /// Steps a bud waits for enough light and energy before it dies; 0: for ever.
        patience_steps: u32 = 0, "steps", Range::whole(0, 10_000);
        /// Where in a growth unit buds demand most: 1 its tip (acrotony), 0.5 its middle (mesotony), 0 its base (basitony).
        favoured_rank: f32 = 1.0, "", Range::real(0.0, 1.0);
        /// Demand of the bud farthest from the favoured place relative to one there.
        acrotony_base: f32 = 1.0, "", Range::real(0.0, 1.0);
        /// Power at which demand rises towards the favoured place.
        acrotony_power: f32 = 1.0, "", Range::real(0.0, 10.0);
        /// Epitony: demand of buds on the upper side of a level axis above that at its flanks; below 0 the lower side's.
        epitony: f32 = 0.0, "", Range::real(-1.0, 1.0);
        /// Chance a step that the terminal bud of a grown axis dies, by order (sympodial growth).
        terminal_death: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 1.0);
        /// Angle between the shoots that follow a dead terminal bud and its axis.
        fork_angle_deg: f32 = 33.0, "deg", Range::real(0.0, 180.0);
        /// Shoots that follow a dead terminal bud.
        fork_shoots: u32 = 2, "", Range::whole(1, 6);

        // Choosing where to grow
        /// Which reading of a cube map counts as light.
        light_reading: LightReading = LightReading::Share, "", Range::any();
        /// Weight of light in a candidate's fitness.
        weight_light: f32 = 1.0, "", Range::real(0.0, 100.0);
        /// Weight of space in a candidate's fitness.
        weight_space: f32 = 1.0, "", Range::real(0.0, 100.0);
        /// Weight of the present heading in a candidate's fitness.
        weight_heading: f32 = 0.05, "", Range::real(0.0, 100.0);
        /// Weight of the set-point angle in a candidate's fitness, by order.
        weight_set_point: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 100.0);
        /// Set-point angle to the vertical by order: 0 up, 90 level, 180 down.
        set_point_deg: ByOrder = ByOrder::all(0.0), "deg", Range::real(0.0, 180.0);
        /// Set-point angle when the plant is old, by order; empty: as when it is young.
        set_point_old_deg: ByOrder = ByOrder::none(), "deg", Range::real(0.0, 180.0);
        /// Height above the ground at which shoots of side axes stop; 0: they stop on it.
        ground_clearance_m: f32 = 0.0, "m", Range::real(0.0, 100.0);
        /// Whether its shoots grow round wood in their way, their own plant's and others', instead of through it.
        avoids_wood: bool = true, "", Range::any();
        /// Positions a bud compares, the straight one included.
        candidates: u32 = 17, "", Range::whole(1, 256);
        /// Whether light and space are stretched to 0..1 over the candidates before they are weighed.
        rescale_fitness: bool = true, "", Range::any();
        /// Side of the cubes in which leaves, and buds that make no long shoot, share one look around; 0: each its own.
        light_cell_m: f32 = 0.0, "m", Range::real(0.0, 10.0);
        /// Distance beyond which free space no longer counts.
        space_range_m: f32 = 1.0, "m", Range::real(0.01, 1000.0);
        /// Disturbance: random crookedness of a new shoot, standard deviation, sensed and corrected later: 0 none, 20 zigzag, 90 no course at all.
        wander_deg: f32 = 0.0, "deg", Range::real(0.0, 90.0);

        // Energy
        /// How surplus energy is shared.
        allocation: Allocation = Allocation::ByExposure, "", Range::any();
        /// Energy in the seed.
        seed_energy: f32 = 12.0, "energy", Range::real(0.0, 1.0e6);
        /// Share of the store released for growth each step.
        store_release: f32 = 0.5, "1/step", Range::real(0.0, 1.0);
        /// Energy a full-grown leaf earns in a step in full light.
        leaf_income: f32 = 2.0, "energy/step", Range::real(0.0, 1000.0);
        /// Whether a leaf earns in the step it unfolds in too, by the light its bud saw; else from the next, by its own.
        leaf_earns_at_once: bool = false, "", Range::any();
        /// Curvature of income against light: 0 proportional, larger saturates earlier, `(1+k)L/(L+k)` with k = 1/this.
        light_saturation: f32 = 0.0, "", Range::real(0.0, 100.0);
        /// Share of the day the stomata are open.
        stomata_open: f32 = 1.0, "", Range::real(0.0, 1.0);
        /// Energy a full-grown leaf uses in a step.
        leaf_upkeep: f32 = 0.15, "energy/step", Range::real(0.0, 1000.0);
        /// Energy an apical bud uses in a step.
        bud_upkeep: f32 = 0.05, "energy/step", Range::real(0.0, 1000.0);
        /// Energy living wood uses in a step.
        wood_upkeep: f32 = 0.0, "energy/m3/step", Range::real(0.0, 1.0e9);
        /// Energy to grow a leaf to full size.
        leaf_cost: f32 = 0.5, "energy", Range::real(0.001, 1.0e6);
        /// Energy to grow a metre of shoot.
        shoot_cost: f32 = 5.0, "energy/m", Range::real(0.001, 1.0e6);
        /// Energy to lay down wood.
        wood_cost: f32 = 0.0, "energy/m3", Range::real(0.0, 1.0e9);
        /// Share of the surplus kept for wood before shoots are fed.
        wood_share: f32 = 0.0, "", Range::real(0.0, 1.0);
        /// Most of what is stored that wood may take in a step; the rest is put by for later steps.
        wood_draw: f32 = 1.0, "1/step", Range::real(0.0, 1.0);
        /// Largest share of the organs shed in one step for a deficit.
        shed_share: f32 = 0.2, "", Range::real(0.0, 1.0);

        // Vigour (allocation ByVigour)
        /// Apical control by order of the main axis: above 0 favours it over its laterals, 0.1 makes a spire, below 0 favours them.
        apical_control: ByOrder = ByOrder::all(0.0), "", Range::real(-0.99, 0.99);
        /// Change of apical control each step of the plant's age.
        apical_control_ageing: f32 = 0.0, "1/step", Range::real(-1.0, 1.0);
        /// Apical control does not fall below this with age.
        apical_control_least: f32 = -0.99, "", Range::real(-0.99, 0.99);
        /// Most internodes a bud grows in one step, by order.
        flush_internodes: ByOrder = ByOrder::all(4.0), "", Range::real(0.0, 100.0);
        /// Most internodes a bud grows in one step when the plant is old, by order; empty: as when it is young.
        flush_old: ByOrder = ByOrder::none(), "", Range::real(0.0, 100.0);
        /// Steps over which a plant ages: what it does when old sets in evenly; 0: it never ages.
        ageing_steps: u32 = 0, "steps", Range::whole(0, 10_000);
        /// Height at which water no longer rises and nothing grows; 0: none.
        height_limit_m: f32 = 0.0, "m", Range::real(0.0, 1000.0);
        /// Power at which growth fades towards that height: low early, high only near it.
        height_limit_power: f32 = 3.0, "", Range::real(0.1, 20.0);
        /// Vigour (in internodes) below which a bud stays dormant.
        vigour_short: f32 = 0.25, "internodes", Range::real(0.0, 1.0);
        /// Length of the internode of a short shoot relative to a full one.
        short_internode: f32 = 0.12, "", Range::real(0.001, 1.0);
        /// Internodes of the shoot a seed opens with, at least one, as far as its energy goes; by vigour.
        seedling_internodes: f32 = 0.0, "internodes", Range::real(0.0, 1000.0);
        /// Share of the energy that living buds leave which opens new ones on bare old wood; 0: cut back, it stays bare.
        sprouting: f32 = 0.0, "1/step", Range::real(0.0, 1.0);
        /// Income per living node below which a side axis is poor.
        prune_income: f32 = 0.0, "energy/step", Range::real(0.0, 1000.0);
        /// Steps a side axis may be poor before it is shed, the poorest first; 0: never shed.
        prune_patience: u32 = 0, "steps", Range::whole(0, 10_000);

        // Wood
        /// Pipe exponent: radius^n of a stem is the sum of radius^n of what it bears.
        pipe_exponent: f32 = 2.2, "", Range::real(1.0, 5.0);
        /// Radius of a stem that bears nothing yet.
        twig_radius_m: f32 = 0.006, "m", Range::real(0.0001, 1.0);
        /// Stiffness of wood under years of load, by order: low hangs, 2 holds; 0: no load bends it.
        stiffness_gpa: ByOrder = ByOrder::all(0.0), "GPa", Range::real(0.0, 1000.0);

        // Steering
        /// Sub-steps until a correction takes effect: 0 at once, 1 to 4 livens a stem, more swings in long waves.
        steering_lag: u32 = 0, "sub-steps", Range::whole(0, 30);
        /// Compensation ratio, 1 / (gain x lag): high steers sluggishly and straight, below about 0.7 swings wider and wider; without lag it is 1 / gain, and 1 reaches the target at once.
        compensation_ratio: f32 = 1.0, "", Range::real(0.01, 100.0);
        /// Integral control, times the gain: takes away a steady lean; too much of it swings.
        steering_integral: f32 = 0.0, "", Range::real(0.0, 1.0);
        /// Derivative control, times the gain: damps swings; too much of it shivers.
        steering_derivative: f32 = 0.0, "", Range::real(0.0, 10.0);
        /// Error with which a tip senses its own heading, standard deviation: 0 true, 20 wavering, 90 lost.
        sensing_error_deg: f32 = 0.0, "deg", Range::real(0.0, 90.0);
        /// Distribution of the disturbance `wander_deg`; if uniform, that is its greatest angle.
        wander_spread: Spread = Spread::Gaussian, "", Range::any();
        /// Steady disturbance that circles about the stem as it grows (nutation), each sub-step: 0 none, 10 coils.
        nutation_deg: f32 = 0.0, "deg", Range::real(0.0, 90.0);
        /// Length grown while nutation circles once: a hundredth of a shoot makes a fine screw, all of it one bow.
        nutation_m: f32 = 1.0, "m", Range::real(0.001, 1000.0);
        /// Phototropism by order: weight in the target of the heading that light and space chose; 0 is blind to them: nothing else drawing it, a shoot goes straight on; 100 is blind to all else.
        phototropism: ByOrder = ByOrder::all(1.0), "", Range::real(0.0, 100.0);
        /// Gravitropism by order: weight of up in the target; below 0 of down, and shoots hang; 100 stands every shoot upright, -100 lets it hang straight, both blind to light.
        gravitropism: ByOrder = ByOrder::all(0.0), "", Range::real(-100.0, 100.0);
        /// Orthotropism by order: weight of up that an axis reaches only with length; large turns its end upright.
        orthotropism: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 100.0);
        /// Length of an axis over which its orthotropism rises from nothing: short turns it up at once, long never quite.
        orthotropism_m: f32 = 1.0, "m", Range::real(0.001, 1000.0);
        /// Plagiotropism by order: weight of the level in the target; large spreads shoots flat.
        plagiotropism: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 100.0);
        /// Autotropism by order: weight of the heading in which the axis left its parent stem; large keeps it straight.
        autotropism: ByOrder = ByOrder::all(0.0), "", Range::real(0.0, 100.0);

        // Calendar
        /// Growth steps in a year.
        steps_per_year: u32 = 1, "1/year", Range::whole(1, 366);
        /// Steps of a flush, from the first of a year on: after it the plant rests, puts by what it earns and extends no shoot until the next; 0: it never rests.
        flush_steps: u32 = 0, "steps", Range::whole(0, 366);
        /// Flushes in a year, evenly apart; so many that one follows the other at once leave no time to rest.
        flushes: u32 = 1, "1/year", Range::whole(1, 12);

        // Looks
        /// Colour of bark on stout stems, sRGB.
        bark_color: Color = Color::hex(0x6B6155), "", Range::real(0.0, 1.0);
        /// Colour of bark on twigs, sRGB.
        bark_young_color: Color = Color::hex(0x6B6155), "", Range::real(0.0, 1.0);
        /// Colour of streaks, cracks and rings in bark, sRGB.
        bark_mark_color: Color = Color::hex(0x3A342C), "", Range::real(0.0, 1.0);
        /// Radius of a stem from which its bark is old; 0: it always is.
        bark_old_radius_m: f32 = 0.0, "m", Range::real(0.0, 10.0);
        /// What old bark is like.
        bark_pattern: BarkPattern = BarkPattern::Furrowed, "", Range::any();
        /// Whether it keeps leaves in winter; others are shown bare then.
        evergreen: bool = false, "", Range::any();
        /// Colour of leaves, sRGB.
        leaf_color: Color = Color::hex(0x4A7A28), "", Range::real(0.0, 1.0);
    }
}

impl Species {
    /// Parameters in which it differs from another, with its values as after `=` in `--set`.
    pub fn differing<'a>(&'a self, from: &'a Self) -> impl Iterator<Item = (&'static str, String)> + 'a {
        Self::parameters().iter().filter_map(|row| {
            let value = self.get(row.name)?;
            (from.get(row.name)? != value).then(|| (row.name, value.to_string()))
        })
    }

    /// Branching angle of a side axis of a parent of this order, radians.
    pub fn branching_angle(&self, parent_order: u32) -> f32 {
        self.branching_angle_deg.get(parent_order).to_radians()
    }

    /// How old a plant is, 0 as a seedling to 1 from the end of its ageing on.
    pub fn maturity(&self, age: u32) -> f32 {
        if self.ageing_steps == 0 { 0.0 } else { (age as f32 / self.ageing_steps as f32).min(1.0) }
    }

    /// Whether a plant of that age (steps) rests between two flushes.
    pub fn rests(&self, age: u32) -> bool {
        // A year that does not divide evenly makes some flushes begin a step later than others.
        let into_year = (age % self.steps_per_year) * self.flushes % self.steps_per_year;
        self.flush_steps > 0 && into_year / self.flushes >= self.flush_steps
    }

    /// Set-point angle of an axis of a plant as old as that, radians.
    pub fn set_point(&self, order: u32, maturity: f32) -> f32 {
        aged(&self.set_point_deg, &self.set_point_old_deg, order, maturity).to_radians()
    }

    /// Most internodes a bud of a plant as old as that grows in a step.
    pub fn flush(&self, order: u32, maturity: f32) -> f32 {
        aged(&self.flush_internodes, &self.flush_old, order, maturity)
    }

    /// How far the largest leaf organ reaches from its stem, metres.
    pub fn leaf_reach_m(&self) -> f32 {
        self.leaf_length_m + self.foliage_length_m
    }

    /// Area of the largest leaf organ, all its blades together, square metres.
    pub fn leaf_area(&self) -> f32 {
        self.leaf_length_m
            * self.leaf_width_m
            * self.leaf_outline.fill()
            * self.foliage.blades(self.leaf_cluster)
    }
}

/// A value between that of a young plant and that of an old one, if that differs.
fn aged(young: &ByOrder, old: &ByOrder, order: u32, maturity: f32) -> f32 {
    let from = young.get(order);
    old.at(order).map_or(from, |old| from + (old - from) * maturity)
}
