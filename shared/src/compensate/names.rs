//! Names of settings for messages: the path of a setting within [`CompensationSettings`](super::CompensationSettings), which is
//! its key in a compensation file, too.

use super::settings::{CYCLES, PRODUCTS as MOST_PRODUCTS};

/// The names of the settings of a table.
#[derive(Clone, Copy, Debug)]
pub struct PointsNames {
    /// Position or time of the first value.
    pub start: &'static str,
    /// Distance or time between values.
    pub spacing: &'static str,
    /// The values.
    pub values: &'static str,
}

/// The names of the settings of a periodic table.
#[derive(Clone, Copy, Debug)]
pub struct CycleNames {
    /// Length of the period.
    pub period: &'static str,
    /// The values.
    pub values: &'static str,
}

/// The names of the settings of a rise of friction towards standstill.
#[derive(Clone, Copy, Debug)]
pub struct StribeckNames {
    /// Friction above Coulomb friction.
    pub excess: &'static str,
    /// Velocity at which it has fallen to 1/e.
    pub velocity: &'static str,
}

/// The names of the settings of a product.
#[derive(Clone, Copy, Debug)]
pub struct ProductNames {
    /// Error at the full scale of all factors.
    pub amplitude: &'static str,
    /// The factors.
    pub factors: &'static str,
}

macro_rules! points_names {
    ($table:literal) => {
        $crate::compensate::names::PointsNames {
            start: concat!($table, ".start_m"),
            spacing: concat!($table, ".spacing_m"),
            values: concat!($table, ".values"),
        }
    };
}
pub(super) use points_names;

macro_rules! stribeck_names {
    ($table:literal) => {
        $crate::compensate::names::StribeckNames {
            excess: concat!($table, ".excess_n"),
            velocity: concat!($table, ".velocity_m_per_s"),
        }
    };
}
pub(super) use stribeck_names;

macro_rules! cycle_names {
    ($($table:literal)*) => {
        [$(CycleNames { period: concat!($table, ".period_m"), values: concat!($table, ".values") }),*]
    };
}

macro_rules! product_names {
    ($($product:literal)*) => {
        [$(ProductNames {
            amplitude: concat!($product, ".amplitude_m"),
            factors: concat!($product, ".factors"),
        }),*]
    };
}

/// Products of commanded quantities.
pub const PRODUCTS: [ProductNames; MOST_PRODUCTS] = product_names!("products[0]" "products[1]" "products[2]");

/// Periodic errors of the screw.
pub const SCREW: [CycleNames; CYCLES] = cycle_names!("screw[0]" "screw[1]");

/// Dividing errors of the motor resolver.
pub const DIVIDING: [CycleNames; CYCLES] = cycle_names!("dividing[0]" "dividing[1]");

/// Force ripple of the motor.
pub const RIPPLE: [CycleNames; CYCLES] = cycle_names!("ripple[0]" "ripple[1]");

/// Thermal drift over the time.
pub const DRIFT: PointsNames =
    PointsNames { start: "drift.start_s", spacing: "drift.spacing_s", values: "drift.values" };
