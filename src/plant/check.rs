//! Whether a snapshot is one that growth can go on from.

use bevy::math::{Quat, Vec3};

use super::{NO_PARENT, OrganState, PlantRecord, Snapshot};
use crate::files::FARTHEST_M;
use crate::limits;
use crate::species::parameter::ParameterError;

/// Most a counter may hold: growth adds to them, and they must not run over.
const COUNT: u32 = 1 << 30;
/// Longest an internode may be, metres: a little over the most a species may ask for.
const LONGEST: f32 = 10.1;
/// Thickest a stem may be, metres: far beyond any, and still a number to reckon with.
const THICKEST: f32 = 1.0e5;

/// Why a snapshot cannot be restored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SnapshotError {
    /// A column has not one entry for each organ.
    #[error("column `{column}` has {length} entries for {organs} organs")]
    Column {
        /// The column.
        column: &'static str,
        /// Its entries.
        length: usize,
        /// The organs.
        organs: usize,
    },
    /// Births do not rise, or reach the number of the next birth.
    #[error("organ {organ} has birth number {birth}, after {after} and before {before}")]
    Birth {
        /// The organ, by index.
        organ: usize,
        /// Its birth number.
        birth: u32,
        /// The birth before it, 0 for the first organ.
        after: u32,
        /// The number of the next birth.
        before: u32,
    },
    /// The organ it grows from does not come before it, is no internode, or is another plant's.
    #[error("organ {organ} cannot grow from organ {parent}")]
    Parent {
        /// The organ, by index.
        organ: usize,
        /// What it claims to grow from, by index.
        parent: u32,
    },
    /// It is of no living plant.
    #[error("organ {organ} is of plant {plant}, which does not live")]
    Plant {
        /// The organ, by index.
        organ: usize,
        /// The plant, by index.
        plant: u32,
    },
    /// A number of an organ is not finite or out of range.
    #[error("`{field}` of organ {organ} is {value}")]
    Organ {
        /// The organ, by index.
        organ: usize,
        /// The number.
        field: &'static str,
        /// Its value.
        value: String,
    },
    /// A number of a plant is not finite or out of range.
    #[error("`{field}` of plant {plant} is {value}")]
    PlantNumber {
        /// The plant, by index.
        plant: usize,
        /// The number.
        field: &'static str,
        /// Its value.
        value: String,
    },
    /// A parameter of a plant's species is out of range.
    #[error("the species of plant {plant}: {source}")]
    Species {
        /// The plant, by index.
        plant: usize,
        /// Which parameter.
        source: ParameterError,
    },
    /// There is more than growth allows.
    #[error("{count} {what}; at most {most} are allowed")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        count: u64,
        /// How much there may be.
        most: u64,
    },
}

impl Snapshot {
    /// Checks that it is a state growth can go on from: one entry for each organ in every column, births rising,
    /// parents earlier and internodes, plants alive, every number finite and in range.
    ///
    /// # Errors
    /// The first thing that is not so.
    pub fn check(&self) -> Result<(), SnapshotError> {
        self.check_columns()?;
        let most = |what, count: u64, most: u64| match count <= most {
            true => Ok(()),
            false => Err(SnapshotError::TooMany { what, count, most }),
        };
        most("organs", self.len() as u64, limits::ORGANS as u64)?;
        most("steps", self.step.into(), limits::STEPS.into())?;
        most("births", self.next_birth.into(), u64::from(u32::MAX) - limits::ORGANS as u64)?;
        for (index, plant) in self.plants.iter().enumerate() {
            if let Some(record) = plant {
                check_plant(index, record, self.step)?;
            }
        }
        for i in 0..self.len() {
            self.check_family(i)?;
            self.check_numbers(i)?;
        }
        self.check_signals()
    }

    fn check_signals(&self) -> Result<(), SnapshotError> {
        let mut last = None;
        for (organ, signals) in &self.signals {
            let organ = *organ as usize;
            let wrong = |value: &str| SnapshotError::Organ { organ, field: "signals", value: value.into() };
            if last.is_some_and(|last| organ <= last) {
                return Err(wrong("listed out of order"));
            }
            last = Some(organ);
            if !matches!(self.state.get(organ), Some(OrganState::ApicalBud(..))) {
                return Err(wrong("of no apical bud"));
            }
            if !signals.is_finite() {
                return Err(wrong("not finite"));
            }
        }
        Ok(())
    }

    fn check_columns(&self) -> Result<(), SnapshotError> {
        let organs = self.len();
        let columns = [
            ("parent", self.parent.len()),
            ("plant", self.plant.len()),
            ("lineage", self.lineage.len()),
            ("span", self.span.len()),
            ("order", self.order.len()),
            ("attachment", self.attachment.len()),
            ("pose", self.pose.len()),
            ("exposure", self.exposure.len()),
            ("allotment", self.allotment.len()),
            ("flow", self.flow.len()),
            ("state", self.state.len()),
        ];
        match columns.into_iter().find(|(_, length)| *length != organs) {
            None => Ok(()),
            Some((column, length)) => Err(SnapshotError::Column { column, length, organs }),
        }
    }

    fn check_family(&self, organ: usize) -> Result<(), SnapshotError> {
        let (birth, before) = (self.birth[organ], self.next_birth);
        let last = organ.checked_sub(1).map(|last| self.birth[last]);
        if birth >= before || last.is_some_and(|last| birth <= last) {
            return Err(SnapshotError::Birth { organ, birth, after: last.unwrap_or_default(), before });
        }
        let plant = self.plant[organ];
        if !matches!(self.plants.get(plant as usize), Some(Some(_))) {
            return Err(SnapshotError::Plant { organ, plant });
        }
        let parent = self.parent[organ];
        let bears = parent == NO_PARENT
            || (parent as usize) < organ
                && matches!(self.state[parent as usize], OrganState::Internode(..))
                && self.plant[parent as usize] == plant;
        if bears { Ok(()) } else { Err(SnapshotError::Parent { organ, parent }) }
    }

    fn check_numbers(&self, organ: usize) -> Result<(), SnapshotError> {
        let wrong = |(field, value): (&'static str, String)| SnapshotError::Organ { organ, field, value };
        let check = || {
            let (span, pose, seen, flow) =
                (&self.span[organ], &self.pose[organ], &self.exposure[organ], &self.flow[organ]);
            real("span.start", span.start)?;
            real("span.end", span.end)?;
            count("order", self.order[organ])?;
            turn("attachment", self.attachment[organ])?;
            place("pose.position", pose.position)?;
            turn("pose.rotation", pose.rotation)?;
            share("exposure.light", seen.light)?;
            share("exposure.space", seen.space)?;
            real("allotment", self.allotment[organ])?;
            real("flow.income", flow.income)?;
            real("flow.upkeep", flow.upkeep)?;
            match &self.state[organ] {
                OrganState::Internode(wood, node) => {
                    ok((0.0..=LONGEST).contains(&wood.length), "length", wood.length)?;
                    ok((0.0..=THICKEST).contains(&wood.radius), "radius", wood.radius)?;
                    size("height_since_node", wood.height_since_node)?;
                    size("height_in_branch", wood.height_in_branch)?;
                    size("pipe", wood.pipe)?;
                    count("poor_steps", wood.poor_steps)?;
                    count("node", node.map_or(0, |node| node.ordinal))
                }
                OrganState::ApicalBud(bud, steering, target) => {
                    real("phyllotaxis", bud.phyllotaxis)?;
                    size("height_since_node", bud.height_since_node)?;
                    size("height_in_branch", bud.height_in_branch)?;
                    count("nodes", bud.nodes)?;
                    count("starved", bud.starved)?;
                    count("substeps", steering.substeps)?;
                    place("target.heading", target.heading)?;
                    real("target.fitness", target.fitness)
                }
                OrganState::LateralBud(bud, target) => {
                    count("dormancy", bud.dormancy)?;
                    count("starved", bud.starved)?;
                    share("rank", bud.rank)?;
                    place("target.heading", target.heading)?;
                    real("target.fitness", target.fitness)
                }
                OrganState::Leaf(leaf) => share("size", leaf.size),
            }
        };
        check().map_err(wrong)
    }
}

type Checked = Result<(), (&'static str, String)>;

fn ok(good: bool, field: &'static str, value: impl ToString) -> Checked {
    if good { Ok(()) } else { Err((field, value.to_string())) }
}

fn real(field: &'static str, x: f32) -> Checked {
    ok(x.is_finite(), field, x)
}

fn size(field: &'static str, x: f32) -> Checked {
    ok(x.is_finite() && x >= 0.0, field, x)
}

/// A share may be off by a rounding.
fn share(field: &'static str, x: f32) -> Checked {
    ok((-1e-3..=1.001).contains(&x), field, x)
}

fn count(field: &'static str, n: u32) -> Checked {
    ok(n <= COUNT, field, n)
}

/// Twice the farthest anything may stand: what stands there still grows.
fn place(field: &'static str, at: Vec3) -> Checked {
    ok(at.is_finite() && at.abs().max_element() <= 2.0 * FARTHEST_M as f32, field, at)
}

fn turn(field: &'static str, turn: Quat) -> Checked {
    ok(turn.is_finite() && (turn.length() - 1.0).abs() < 0.1, field, turn)
}

fn check_plant(plant: usize, record: &PlantRecord, step: u32) -> Result<(), SnapshotError> {
    record.species.validate().map_err(|source| SnapshotError::Species { plant, source })?;
    let ledger = &record.ledger;
    let energies = [
        ("store.stored", record.store.stored),
        ("ledger.opened", ledger.opened),
        ("ledger.income", ledger.income),
        ("ledger.upkeep", ledger.upkeep),
        ("ledger.growth", ledger.growth),
        ("ledger.wood", ledger.wood),
        ("ledger.lost", ledger.lost),
        ("ledger.closed", ledger.closed),
        ("ledger.unpaid", ledger.unpaid),
    ];
    let check = || {
        for (field, energy) in energies {
            ok(energy.is_finite(), field, energy)?;
        }
        let germinated = record.store.germinated.unwrap_or_default();
        ok(germinated <= step, "store.germinated", germinated)?;
        place("position", record.position)?;
        turn("rotation", record.rotation)
    };
    check().map_err(|(field, value)| SnapshotError::PlantNumber { plant, field, value })
}
