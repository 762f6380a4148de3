//! One table drives every parameter: its default, range, unit and help.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::{Allocation, LightReading};
use crate::shape::bark::BarkPattern;
use crate::shape::foliage::FoliageForm;
use crate::shape::outline::LeafOutline;
use crate::tropism::Spread;

/// What values a parameter may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// A real number between two bounds, both allowed.
    Real {
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
    },
    /// A whole number between two bounds, both allowed.
    Whole {
        /// Least.
        min: u32,
        /// Greatest.
        max: u32,
    },
    /// Whatever its type allows.
    Any,
}

impl Range {
    /// Real numbers from `min` to `max`.
    pub const fn real(min: f64, max: f64) -> Self {
        Self::Real { min, max }
    }

    /// Whole numbers from `min` to `max`.
    pub const fn whole(min: u32, max: u32) -> Self {
        Self::Whole { min, max }
    }

    /// No bounds but the type's.
    pub const fn any() -> Self {
        Self::Any
    }

    /// Whether a number lies in it.
    pub fn holds(&self, x: f64) -> bool {
        match *self {
            Self::Real { min, max } => x.is_finite() && x >= min && x <= max,
            Self::Whole { min, max } => x.fract() == 0.0 && x >= f64::from(min) && x <= f64::from(max),
            Self::Any => x.is_finite(),
        }
    }
}

impl core::fmt::Display for Range {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Real { min, max } => write!(f, "{min} to {max}"),
            Self::Whole { min, max } => write!(f, "a whole number, {min} to {max}"),
            Self::Any => write!(f, "any"),
        }
    }
}

/// A parameter's value of any type.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A real number.
    Real(f64),
    /// A whole number.
    Whole(u32),
    /// Yes or no.
    Flag(bool),
    /// Numbers by branch order, or the three parts of a colour.
    List(Vec<f64>),
    /// One of a few names.
    Choice(String),
}

impl core::fmt::Display for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Real(x) => write!(f, "{x}"),
            Self::Whole(n) => write!(f, "{n}"),
            Self::Flag(b) => write!(f, "{b}"),
            Self::List(xs) => {
                write!(f, "[")?;
                for (i, x) in xs.iter().enumerate() {
                    write!(f, "{}{x}", if i > 0 { ", " } else { "" })?;
                }
                write!(f, "]")
            }
            Self::Choice(name) => write!(f, "{name}"),
        }
    }
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name of the field.
    pub name: &'static str,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// What values it may take.
    pub range: Range,
    /// Names it may take, for a choice.
    pub choices: &'static [&'static str],
    /// Its default.
    pub default: Value,
    /// A sentence of help.
    pub help: &'static str,
}

impl Parameter {
    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        if !self.choices.is_empty() {
            return self.choices.join(" | ");
        }
        match self.default {
            Value::Flag(_) => "true | false".into(),
            Value::List(_) if self.name.ends_with("_color") => format!("three numbers, each {}", self.range),
            Value::List(_) => format!("a number or a list of numbers, each {}", self.range),
            _ => self.range.to_string(),
        }
    }
}

/// Why a parameter could not be set.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// No such parameter.
    #[error("there is no parameter `{name}`{}", .nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
    Unknown {
        /// The name given.
        name: String,
        /// The most similar name there is.
        nearest: Option<&'static str>,
    },
    /// The value is of the wrong type or out of range.
    #[error("`{name}` is {value}; allowed: {allowed}")]
    Invalid {
        /// The parameter.
        name: &'static str,
        /// The value given.
        value: String,
        /// What is allowed.
        allowed: String,
    },
}

/// A type a parameter can have.
pub trait ParameterType: Sized {
    /// Names it may take, for a choice.
    const CHOICES: &'static [&'static str] = &[];
    /// As a value of any type.
    fn to_value(&self) -> Value;
    /// From a value; `None` if the type is wrong.
    fn from_value(value: &Value) -> Option<Self>;
    /// Whether it lies in the range.
    fn holds(&self, range: &Range) -> bool;
}

impl ParameterType for f32 {
    fn to_value(&self) -> Value {
        // The shortest decimal that reads back as this f32, not its exact binary value.
        Value::Real(self.to_string().parse().unwrap_or(f64::from(*self)))
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Real(x) => Some(*x as f32),
            Value::Whole(n) => Some(*n as f32),
            _ => None,
        }
    }
    fn holds(&self, range: &Range) -> bool {
        range.holds(self.to_string().parse().unwrap_or(f64::NAN))
    }
}

impl ParameterType for u32 {
    fn to_value(&self) -> Value {
        Value::Whole(*self)
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Whole(n) => Some(*n),
            _ => None,
        }
    }
    fn holds(&self, range: &Range) -> bool {
        range.holds(f64::from(*self))
    }
}

impl ParameterType for bool {
    fn to_value(&self) -> Value {
        Value::Flag(*self)
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Flag(b) => Some(*b),
            _ => None,
        }
    }
    fn holds(&self, _: &Range) -> bool {
        true
    }
}

/// A number for each branch order; the last stands for all higher ones.
///
/// In files one number stands for a list of one.
#[derive(Debug, Clone, PartialEq, Default, Reflect, Serialize)]
#[serde(transparent)]
pub struct ByOrder(pub SmallVec<[f32; 6]>);

impl<'de> Deserialize<'de> for ByOrder {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            One(f32),
            List(SmallVec<[f32; 6]>),
        }
        if !deserializer.is_human_readable() {
            return Ok(Self(SmallVec::deserialize(deserializer)?));
        }
        Ok(match Written::deserialize(deserializer)? {
            Written::One(value) => Self::all(value),
            Written::List(values) => Self(values),
        })
    }
}

impl ByOrder {
    /// No numbers at all.
    pub fn none() -> Self {
        Self::default()
    }

    /// The same for every order.
    pub fn all(value: f32) -> Self {
        Self(SmallVec::from_slice(&[value]))
    }

    /// The number of an order, `None` if the list is empty.
    pub fn at(&self, order: u32) -> Option<f32> {
        self.0.get(order as usize).or(self.0.last()).copied()
    }

    /// The number of an order, 0 if the list is empty.
    pub fn get(&self, order: u32) -> f32 {
        self.at(order).unwrap_or(0.0)
    }
}

impl<const N: usize> From<[f32; N]> for ByOrder {
    fn from(values: [f32; N]) -> Self {
        Self(values.into_iter().collect())
    }
}

impl ParameterType for ByOrder {
    fn to_value(&self) -> Value {
        Value::List(self.0.iter().map(|x| x.to_string().parse().unwrap_or(f64::NAN)).collect())
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::List(xs) => Some(Self(xs.iter().map(|x| *x as f32).collect())),
            Value::Real(x) => Some(Self::all(*x as f32)),
            Value::Whole(n) => Some(Self::all(*n as f32)),
            _ => None,
        }
    }
    fn holds(&self, range: &Range) -> bool {
        self.0.len() <= crate::limits::ORDERS && self.0.iter().all(|x| x.holds(range))
    }
}

/// A colour, sRGB parts 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Color(pub [f32; 3]);

impl Color {
    /// From 0xRRGGBB.
    pub fn hex(rgb: u32) -> Self {
        Self([16, 8, 0].map(|shift| ((rgb >> shift) & 255) as f32 / 255.0))
    }

    /// Linear parts.
    pub fn linear(&self) -> [f32; 3] {
        self.0.map(|c| if c <= 0.04045 { c / 12.92 } else { bevy::math::ops::powf((c + 0.055) / 1.055, 2.4) })
    }
}

impl ParameterType for Color {
    fn to_value(&self) -> Value {
        Value::List(self.0.iter().map(|x| x.to_string().parse().unwrap_or(f64::NAN)).collect())
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::List(xs) if xs.len() == 3 => Some(Self([xs[0] as f32, xs[1] as f32, xs[2] as f32])),
            _ => None,
        }
    }
    fn holds(&self, range: &Range) -> bool {
        self.0.iter().all(|x| x.holds(range))
    }
}

macro_rules! choice {
    ($type:ty : $($name:ident),+) => {
        impl ParameterType for $type {
            const CHOICES: &'static [&'static str] = &[$(stringify!($name)),+];
            fn to_value(&self) -> Value {
                Value::Choice(match self { $(Self::$name => stringify!($name)),+ }.into())
            }
            fn from_value(value: &Value) -> Option<Self> {
                match value {
                    Value::Choice(name) => match name.as_str() { $(stringify!($name) => Some(Self::$name),)+ _ => None },
                    _ => None,
                }
            }
            fn holds(&self, _: &Range) -> bool {
                true
            }
        }
    };
}

choice!(Allocation: ByExposure, ByVigour);
choice!(LightReading: Share, Radiance);
choice!(Spread: Gaussian, Uniform);
choice!(LeafOutline: Elliptic, Ovate, Lobed, Lanceolate, Needle, Rhombic, Heart, Palmate);
choice!(BarkPattern: Furrowed, Smooth, Plates, Banded, Ringed);
choice!(FoliageForm: Tuft, Spray, Needles, Frond);

/// Writes a struct, its defaults and its table from one list of rows.
macro_rules! parameters {
    (
        $(#[$meta:meta])*
        pub struct $Table:ident {
            $( #[doc = $help:literal] $name:ident : $type:ty = $default:expr, $unit:literal, $range:expr; )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Reflect, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $Table {
            /// Version of the file format.
            pub version: u32,
            /// Its name.
            pub name: String,
            /// What it is, for people.
            pub description: String,
            /// Where its figures come from.
            pub source: String,
            $( #[doc = $help] pub $name: $type, )*
        }

        impl Default for $Table {
            fn default() -> Self {
                Self {
                    version: 1,
                    name: "lam_king".into(),
                    description: String::new(),
                    source: String::new(),
                    $( $name: $default, )*
                }
            }
        }

        impl $Table {
            /// The table of parameters, in the order of the struct.
            pub fn parameters() -> &'static [parameter::Parameter] {
                static TABLE: std::sync::LazyLock<Vec<parameter::Parameter>> = std::sync::LazyLock::new(|| {
                    let default = $Table::default();
                    vec![$( parameter::Parameter {
                        name: stringify!($name),
                        unit: $unit,
                        range: $range,
                        choices: <$type as parameter::ParameterType>::CHOICES,
                        default: parameter::ParameterType::to_value(&default.$name),
                        help: $help.trim_ascii(),
                    } ),*]
                });
                &TABLE
            }

            /// The value of a parameter, `None` if there is none of that name.
            pub fn get(&self, name: &str) -> Option<parameter::Value> {
                match name {
                    $( stringify!($name) => Some(parameter::ParameterType::to_value(&self.$name)), )*
                    _ => None,
                }
            }

            /// Sets a parameter.
            ///
            /// # Errors
            /// [`ParameterError`](parameter::ParameterError) if there is none of that name, or the value is of
            /// the wrong type or out of range; nothing is changed then.
            pub fn set(&mut self, name: &str, value: &parameter::Value) -> Result<(), parameter::ParameterError> {
                match name {
                    $( stringify!($name) => {
                        let range = $range;
                        match <$type as parameter::ParameterType>::from_value(value) {
                            Some(new) if parameter::ParameterType::holds(&new, &range) => { self.$name = new; Ok(()) }
                            _ => Err(parameter::invalid(Self::parameters(), stringify!($name), value)),
                        }
                    } )*
                    _ => Err(parameter::unknown(Self::parameters(), name)),
                }
            }

            /// Checks every parameter against its range.
            ///
            /// # Errors
            /// The first parameter out of range.
            pub fn validate(&self) -> Result<(), parameter::ParameterError> {
                $(
                    if !parameter::ParameterType::holds(&self.$name, &$range) {
                        return Err(parameter::invalid(
                            Self::parameters(),
                            stringify!($name),
                            &parameter::ParameterType::to_value(&self.$name),
                        ));
                    }
                )*
                Ok(())
            }
        }
    };
}
pub(crate) use parameters;

pub(crate) fn invalid(table: &'static [Parameter], name: &str, value: &Value) -> ParameterError {
    match table.iter().find(|p| p.name == name) {
        Some(p) => {
            ParameterError::Invalid { name: p.name, value: shorten(&value.to_string()), allowed: p.allowed() }
        }
        None => unknown(table, name),
    }
}

pub(crate) fn unknown(table: &'static [Parameter], name: &str) -> ParameterError {
    let nearest = nearest(name, table.iter().map(|p| p.name));
    ParameterError::Unknown { name: shorten(name), nearest }
}

/// The name most like a mistyped one, if any is like it at all.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Nobody mistypes more than this, and comparing costs the product of the lengths.
    const LONGEST: usize = 64;
    if name.is_empty() || name.len() > LONGEST {
        return None;
    }
    let mut best = (500, None);
    for candidate in known {
        let likeness = 2000 * shared_letters(candidate, name) / (candidate.len() + name.len());
        if likeness > best.0 {
            best = (likeness, Some(candidate));
        }
    }
    best.1
}

/// A text short enough for a message.
pub(crate) fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    let flat = text.trim();
    match flat.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &flat[..end]),
        None => flat.into(),
    }
}

/// Length of the longest common subsequence, a cheap measure of likeness.
fn shared_letters(a: &str, b: &str) -> usize {
    let b = b.as_bytes();
    let mut row = vec![0usize; b.len() + 1];
    for x in a.bytes() {
        let mut diagonal = 0;
        for (j, &y) in b.iter().enumerate() {
            let above = row[j + 1];
            row[j + 1] = if x == y { diagonal + 1 } else { above.max(row[j]) };
            diagonal = above;
        }
    }
    row[b.len()]
}
