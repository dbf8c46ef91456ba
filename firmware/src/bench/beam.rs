//! A beam between the tables of x and of the last axis, which makes a gantry of both.
//!
//! Its stiffness against racking and its damping push the two tables towards a square beam, on which the table of the last axis is at that
//! of x + [`SQUARE_M`]. Where it is put on, it has skew, which the friction of the tables holds while the drives are off.

use super::axis::AxisPlant;
use shared::units::PER_M;

/// Racking stiffness, N/m: at 0.1 mm as much as the friction of a table.
pub const STIFFNESS_N_PER_M: f32 = 0.2e6;

/// Damping, N·s/m.
pub const DAMPING_N_S_PER_M: f32 = 500.0;

/// Position of the last table less that of x on a square beam, m: its index pulses are at other places of the beam.
pub const SQUARE_M: f64 = 40e-6;

/// Skew with which the beam is put on, m.
pub const SKEW_M: f64 = 80e-6;

/// Friction that can be added to the last table, N: more than its drive has.
pub const DRAG_N: f32 = 400.0;

#[expect(clippy::cast_possible_truncation, reason = "rounded to 24 bits")]
const UNITS: f32 = PER_M as f32;

#[expect(clippy::cast_possible_truncation, reason = "within the travel")]
const fn units(m: f64) -> i64 {
    (m * PER_M) as i64
}

/// The beam, and whether it is on the tables.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beam {
    is_on: bool,
}

impl Beam {
    /// Puts the beam on or takes it away, and gives the force on the last table, N; that on x is the opposite. Putting it on moves the last
    /// axis.
    pub fn force_n(&mut self, is_wanted: bool, axes: &mut [AxisPlant]) -> f32 {
        let [first, .., last] = axes else { return 0.0 };
        if is_wanted && !self.is_on {
            last.move_to(first.table() + units(SQUARE_M + SKEW_M));
        }
        self.is_on = is_wanted;
        if !is_wanted {
            return 0.0;
        }
        let skew = last.table().wrapping_sub(first.table()).wrapping_sub(const { units(SQUARE_M) });
        let speed = last.table_velocity() - first.table_velocity();
        -STIFFNESS_N_PER_M * (skew as f32 / UNITS) - DAMPING_N_S_PER_M * speed
    }
}
