//! Tables that a trace adds to fitted values, so that tracing the same logs with the written file gives the same result:
//! the centres of the tolerances, and the zeros and sampling instants of the logs.

use serde::{Deserialize, Serialize};

use super::number_table::number_table;
use crate::axis::{Tolerated, tolerated_keys};
use crate::effects::{Effect, Windup};

/// A fitted mass or stiffness may deviate from its nominal value by up to this many tolerances. One that is farther off has
/// a wrong unit or belongs to another machine.
pub const MAX_TOLERANCES: f64 = 4.0;

/// How many tolerances friction may move by: it changes with load, temperature and age, and which few users know as well as they declare.
const MAX_FRICTION_TOLERANCES: f64 = 10.0;

/// The range in which a fit may move a value, from its nominal value and its relative tolerance: up to [`MAX_TOLERANCES`] in either
/// direction, as a factor, friction further. A lower stiffness is the effect `windup`.
#[must_use]
pub fn fit_range(value: &Tolerated, nominal: f64, tolerance: f64) -> [f64; 2] {
    if value.is_poorly_determined() {
        return [nominal * (1.0 - tolerance), nominal * (1.0 + tolerance)];
    }
    let is_friction = ["coulomb_n", "viscous_n_s_per_m", "motor_coulomb_n"].contains(&value.key);
    let most = if is_friction { MAX_FRICTION_TOLERANCES } else { MAX_TOLERANCES };
    let factor = 1.0 + most * tolerance;
    let least = nominal / factor;
    let is_stiffness = value.key == "stiffness_n_per_um";
    let least = if is_stiffness { least.max(Windup::max_stiffness(nominal, tolerance)) } else { least };
    [least, nominal * factor]
}

macro_rules! nominal {
    ($($group:ident ($is_of_controller:literal): $($key:ident),+;)+) => {
        /// `[axis.NAME.nominal]`: the values before a trace fitted them. Tolerances are centred on them, so that repeated fits do not
        /// drift away. An absent value is equal to that of the axis.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Nominal {
            $($(
                #[doc = concat!("Nominal value of `", stringify!($key), "`.")]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $key: Option<f64>,
            )+)+
            /// Nominal values of the first effects of the axis, in the same order. Further effects have none.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            pub effect: Vec<Effect>,
        }

        impl Nominal {
            /// The nominal value of a key; `None`: that of the axis.
            #[must_use]
            pub fn get(&self, key: &str) -> Option<f64> {
                match key {
                    $($(stringify!($key) => self.$key,)+)+
                    _ => None,
                }
            }

            /// Sets the nominal value of a key.
            pub fn set(&mut self, key: &str, value: f64) {
                match key {
                    $($(stringify!($key) => self.$key = Some(value),)+)+
                    _ => {}
                }
            }
        }
    };
}

tolerated_keys!(nominal);

number_table! {
    /// `[axis.NAME.log_offsets]`: zeros and sampling instants of the logs to which the values of an axis were fitted. They
    /// are the initial values when a trace fits them again. An absent value is 0.
    LogOffsets {
        /// Zero of the linear scale relative to that of the motor.
        table_zero_um,
        /// Zero of the tool-point probe relative to that of the table.
        tool_zero_um,
        /// Delay of the linear scale relative to the motor; negative: early.
        table_late_ms,
        /// Delay of the tool-point probe relative to the scale; negative: early.
        tool_late_ms,
        /// Delay of the logged force relative to the motor; negative: early.
        force_late_ms,
        /// Age of the velocity in the velocity loop, in addition to that of a backward difference.
        speed_late_ms,
        /// Delay of the drive's force relative to the reading of the sensors; negative: early.
        drive_late_ms,
        /// Step of the controller's filter; 0: exact discretization.
        filter_step_ms,
        /// Time constant of a drive whose velocity is commanded.
        velocity_time_constant_ms,
        /// Rate 1/Ti of the integral part of such a drive.
        velocity_integral_per_s,
        /// Coulomb friction over the moved mass, of a drive whose velocity is commanded.
        velocity_friction_m_per_s2,
        /// Dead time of a drive whose velocity or position is commanded.
        drive_dead_time_ms,
        /// What the trace left unexplained from the command to the tool, rms on logs that it did not fit if there were any, without
        /// noise: a prediction may be wrong by it.
        unexplained_um,
    }
}
