//! An axis of a machine file: its settings, the effects found, and the tables that a trace adds.

use serde::{Deserialize, Serialize};

use super::evidence::Evidence;
use super::nominal::{LogOffsets, Nominal};
use crate::axis::{
    AxisName, Controller, Drive, Feedback, Field, Filters, Gantry, Holding, KeyNames, Law, Limits, Mechanics,
    PerNotch, PerPoint, Pid, Schedule, Sensors, Settings, TOLERATED, Tolerances, axis_keys,
};
use crate::effects::Effect;
use crate::friction_curve::Curve;
use crate::residual_law::ResidualLaw;
use crate::residual_table::ResidualTable;
use crate::servo::VelocityDrive;

/// One declared axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "AxisTable", into = "AxisTable")]
pub struct Axis {
    /// Controller, filters, limits, brake and preload, mechanics, sensors.
    pub settings: Settings,
    /// Values and effects before a trace fitted them; absent: not fitted.
    pub nominal: Option<Nominal>,
    /// Zeros and sampling instants of the logs, as fitted by a trace.
    pub log_offsets: Option<LogOffsets>,
    /// Effects found, in the order in which they were added.
    pub effect: Vec<Effect>,
    /// What a trace knows of the first of these effects, in the same order.
    pub evidence: Vec<Evidence>,
    /// Residuals that no effect describes, as tables.
    pub empirical: Vec<ResidualTable>,
    /// Residuals that no effect describes, as equations.
    pub residual_law: Vec<ResidualLaw>,
}

impl Axis {
    /// Whether it contains residuals that no effect describes.
    #[must_use]
    pub const fn has_residuals(&self) -> bool {
        !self.empirical.is_empty() || !self.residual_law.is_empty()
    }

    /// A drive whose velocity is commanded, as a trace has fitted it to logs.
    #[must_use]
    pub fn fitted_velocity_drive(&self) -> VelocityDrive {
        let offsets = self.log_offsets.unwrap_or_default();
        VelocityDrive {
            time_constant_s: 1e-3 * offsets.velocity_time_constant_ms.unwrap_or(0.0),
            integral_per_s: offsets.velocity_integral_per_s.unwrap_or(0.0),
            dead_time_s: 1e-3 * offsets.drive_dead_time_ms.unwrap_or(0.0),
            friction_m_per_s2: offsets.velocity_friction_m_per_s2.unwrap_or(0.0),
        }
    }

    /// This axis with the values and effects before they were fitted.
    #[must_use]
    pub fn at_nominal(&self) -> Self {
        let mut axis = Self { nominal: None, log_offsets: None, evidence: Vec::new(), ..self.clone() };
        let Some(nominal) = &self.nominal else { return axis };
        for value in TOLERATED {
            if let Some(number) = nominal.get(value.key) {
                (value.set)(&mut axis.settings, number);
            }
        }
        for (effect, nominal) in axis.effect.iter_mut().zip(&nominal.effect) {
            effect.clone_from(nominal);
        }
        axis
    }
}

/// The table `[axis.NAME]` of the file, in which all settings are flat keys, and the conversions from and to [`Axis`].
/// Nested structs with serde's `flatten` would accept unknown keys and lose the line of an error.
macro_rules! axis_table {
    ($(
        $(#[$group_doc:meta])*
        $group:ident: $Group:ident {
            $($(#[$doc:meta])* $field:ident $(($key:literal))?: $type:ty $([$range:expr])?,)+
        }
    )+) => {
        #[derive(Default, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        struct AxisTable {
            $($(
                $(#[serde(rename = $key)])?
                #[serde(skip_serializing_if = "Field::is_absent")]
                $field: $type,
            )+)+
            #[serde(skip_serializing_if = "Option::is_none")]
            nominal: Option<Nominal>,
            #[serde(skip_serializing_if = "Option::is_none")]
            log_offsets: Option<LogOffsets>,
            #[serde(skip_serializing_if = "Vec::is_empty")]
            effect: Vec<Effect>,
            #[serde(skip_serializing_if = "Vec::is_empty")]
            evidence: Vec<Evidence>,
            #[serde(skip_serializing_if = "Vec::is_empty")]
            empirical: Vec<ResidualTable>,
            #[serde(rename = "law", skip_serializing_if = "Vec::is_empty")]
            residual_law: Vec<ResidualLaw>,
        }

        impl From<AxisTable> for Axis {
            fn from(table: AxisTable) -> Self {
                Self {
                    settings: Settings {
                        names: KeyNames::default(),
                        $($group: $Group { $($field: table.$field,)+ },)+
                    },
                    nominal: table.nominal,
                    log_offsets: table.log_offsets,
                    effect: table.effect,
                    evidence: table.evidence,
                    empirical: table.empirical,
                    residual_law: table.residual_law,
                }
            }
        }

        impl From<Axis> for AxisTable {
            fn from(axis: Axis) -> Self {
                Self {
                    $($($field: axis.settings.$group.$field,)+)+
                    nominal: axis.nominal,
                    log_offsets: axis.log_offsets,
                    effect: axis.effect,
                    evidence: axis.evidence,
                    empirical: axis.empirical,
                    residual_law: axis.residual_law,
                }
            }
        }
    };
}

axis_keys!(axis_table);
