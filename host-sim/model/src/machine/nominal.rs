//! What a machine file with fitted values keeps beside them, so that the file says the same again on the same logs:
//! the values that the tolerance is about, and the zeros and instants of the logs.

use serde::{Deserialize, Serialize};

use super::number_table::number_table;
use crate::axis::Settings;
use crate::effects::Effect;

/// A mechanical value that `plant_tolerance_percent` is about.
pub struct Tolerated {
    /// Key of the axis and of its `nominal` table.
    pub key: &'static str,
    /// The value of an axis.
    pub get: fn(&Settings) -> Option<f64>,
    /// Sets the value of an axis.
    pub set: fn(&mut Settings, f64),
    /// The value in a `nominal` table.
    pub nominal: fn(&Nominal) -> Option<f64>,
    /// Sets the value in a `nominal` table.
    pub set_nominal: fn(&mut Nominal, f64),
}

macro_rules! tolerated {
    ($($key:ident),+ $(,)?) => {
        /// `[axis.NAME.nominal]`: the values as they were before a trace fitted them. `plant_tolerance_percent` is about
        /// these: a file that is fitted again and again does not move away from them. What is absent is its own nominal
        /// value.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Nominal {
            $(
                #[doc = concat!("Of `", stringify!($key), "`.")]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $key: Option<f64>,
            )+
            /// Of the first effects of the axis, in their order; those behind them are their own.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            pub effect: Vec<Effect>,
        }

        /// All values that have a tolerance.
        pub const TOLERATED: &[Tolerated] = &[$(Tolerated {
            key: stringify!($key),
            get: |settings| settings.mechanics.$key,
            set: |settings, value| settings.mechanics.$key = Some(value),
            nominal: |nominal| nominal.$key,
            set_nominal: |nominal, value| nominal.$key = Some(value),
        }),+];
    };
}

tolerated!(
    motor_mass_kg,
    table_mass_kg,
    stiffness_n_per_um,
    damping_n_s_per_m,
    coulomb_n,
    viscous_n_s_per_m,
    motor_coulomb_n,
    presliding_stiffness_n_per_um,
    presliding_damping_n_s_per_m,
);

number_table! {
    /// `[axis.NAME.log_offsets]`: zeros and instants of the logs that the values of an axis were fitted to. A trace begins
    /// with them and fits them anew; nothing else uses them. What is absent is 0.
    LogOffsets {
        /// Zero of the linear scale against the motor's.
        table_zero_um,
        /// Zero of the tool-point probe against the table's.
        tool_zero_um,
        /// How late the linear scale is read after the motor; negative: early.
        table_late_ms,
        /// How late the tool-point probe is read after the scale; negative: early.
        tool_late_ms,
        /// How late the force is logged against the motor; negative: early.
        force_late_ms,
        /// Age of the velocity in the velocity loop, beyond that of a plain difference.
        speed_late_ms,
        /// How much later than the sensors are read the drive's force acts; negative: earlier.
        drive_late_ms,
        /// Length of the controller's steps of its filter; 0: it steps exactly.
        filter_step_ms,
    }
}
