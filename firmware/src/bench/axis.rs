//! One axis of the simulated machine: a motor and a table, coupled by a screw with a dead zone.
//!
//! m₁·dv₁/dt = force − F, m₂·dv₂/dt = F − b·v₂ − friction, F = k·(e ∓ w/2) + c·(v₁ − v₂) outside of the dead zone w of the
//! difference e = x₁ − x₂, and 0 within. Coulomb friction stops the table within a step, and holds it.
//!
//! Velocities are f32, positions are integers: a step of 12.5 µs at 1 mm/s is 12 nm, which an f32 position would lose.

use shared::feedback::Reading;
use shared::units::{PER_M, Position};

use super::COUNT;
use crate::setup::TICK_HZ;

/// Mass of the motor side, reflected to the table, kg.
pub const MOTOR_MASS_KG: f32 = 6.0;
/// Mass of the table, kg.
pub const TABLE_MASS_KG: f32 = 9.0;
/// Stiffness of the screw, N/m.
pub const STIFFNESS_N_PER_M: f32 = 50e6;
/// Damping of the screw, N·s/m.
pub const DAMPING_N_S_PER_M: f32 = 5000.0;
/// Coulomb friction of the table, N.
pub const COULOMB_N: f32 = 20.0;
/// Viscous friction of the table, N·s/m.
pub const VISCOUS_N_S_PER_M: f32 = 100.0;

/// Steps per tick.
const STEPS: u32 = 4;

/// Time of a step, s. The resonance has 3700 rad/s: ω·h = 0.05.
const STEP_S: f32 = 1.0 / (TICK_HZ * STEPS) as f32;

/// Position units in a metre.
const UNITS: f32 = PER_M as f32;

/// An axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisPlant {
    /// Half of the dead zone, m.
    half_gap_m: f32,
    /// Motor and table, position units.
    motor: i64,
    table: i64,
    /// Velocities, m/s.
    motor_velocity: f32,
    table_velocity: f32,
    /// The motor as its encoder reads it.
    read_motor: i64,
}

impl AxisPlant {
    /// At rest at zero.
    #[expect(clippy::cast_possible_truncation, reason = "a width")]
    pub fn new(backlash_m: f64) -> Self {
        Self {
            half_gap_m: 0.5 * backlash_m as f32,
            motor: 0,
            table: 0,
            motor_velocity: 0.0,
            table_velocity: 0.0,
            read_motor: 0,
        }
    }

    /// Moves by the time of a tick under a force (N) on the motor. A frozen encoder is not read.
    pub fn step(&mut self, force_n: f32, read: bool) {
        for _ in 0..STEPS {
            let screw_n = self.screw_force();
            self.motor_velocity += STEP_S / MOTOR_MASS_KG * (force_n - screw_n);
            let moving = screw_n - VISCOUS_N_S_PER_M * self.table_velocity;
            let free = self.table_velocity + STEP_S / TABLE_MASS_KG * moving;
            let friction = STEP_S / TABLE_MASS_KG * COULOMB_N;
            self.table_velocity = free - free.clamp(-friction, friction);
            #[expect(clippy::cast_possible_truncation, reason = "a position unit")]
            let way = |velocity: f32| (velocity * (STEP_S * UNITS)) as i64;
            self.motor = self.motor.wrapping_add(way(self.motor_velocity));
            self.table = self.table.wrapping_add(way(self.table_velocity));
        }
        if read {
            self.read_motor = self.motor;
        }
    }

    /// Force of the motor on the table, N.
    fn screw_force(&self) -> f32 {
        let stretch = self.motor.wrapping_sub(self.table) as f32 / UNITS;
        let beyond = stretch - stretch.clamp(-self.half_gap_m, self.half_gap_m);
        let force = STIFFNESS_N_PER_M * beyond
            + DAMPING_N_S_PER_M * (self.motor_velocity - self.table_velocity);
        // A flank can only push.
        if beyond > 0.0 {
            force.max(0.0)
        } else if beyond < 0.0 {
            force.min(0.0)
        } else if self.half_gap_m > 0.0 {
            0.0
        } else {
            force
        }
    }

    /// Encoder and scale in whole counts.
    pub fn reading(&self) -> Reading {
        let counts = |position: i64| Position(position.div_euclid(COUNT).wrapping_mul(COUNT));
        Reading { motor: counts(self.read_motor), table: Some(counts(self.table)) }
    }
}
