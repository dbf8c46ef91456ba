//! One axis of the simulated machine: a motor and a table, coupled by a screw with a dead zone.
//!
//! m₁·dv₁/dt = force − F, m₂·dv₂/dt = F − b·v₂ − friction, F = k·(e ∓ w/2) + c·(v₁ − v₂) outside of the dead zone w of the
//! difference e = x₁ − x₂, and 0 within. Coulomb friction stops the table within a step, and holds it.
//!
//! Velocities are f32, positions are integers: a step of 12.5 µs at 1 mm/s is 12 nm, which an f32 position would lose.

use shared::feedback::Reading;
use shared::units::{PER_M, PER_NM, Position};

use crate::setup::TICK_HZ;

/// A count of the motor encoders and of the linear scales, position units: 50 nm.
pub const COUNT: i64 = 50 * PER_NM;

/// Distance between the index pulses of the motor encoders, m: a turn of the screw.
pub const LEAD_M: f64 = 5e-3;

/// Position of an index pulse, m.
pub const INDEX_M: f64 = -0.0917;

/// Mass of the motor side, reflected to the table, kg.
pub const MOTOR_MASS_KG: f32 = 6.0;
/// Mass of the table, kg.
pub const TABLE_MASS_KG: f32 = 9.0;
/// Stiffness of the screw, N/m.
pub const STIFFNESS_N_PER_M: f32 = 50e6;
/// Damping of the screw, N·s/m.
pub const DAMPING_N_S_PER_M: f32 = 5000.0;
/// Position of the table at which the hard stop begins that can be put before x, in the negative direction, m.
pub const STOP_M: f64 = -0.06;
/// Stiffness of the hard stop, N/m.
pub const STOP_N_PER_M: f32 = 10e6;
/// Damping of the hard stop, N·s/m.
pub const STOP_N_S_PER_M: f32 = 3000.0;
/// Mass that can be put on the table, kg.
pub const ADDED_MASS_KG: f32 = 3.0;
/// Acceleration of gravity, m/s².
pub const GRAVITY_M_PER_S2: f32 = 9.81;
/// Coulomb friction of the table, N.
pub const COULOMB_N: f32 = 20.0;
/// Friction of a closed brake on the motor, N.
pub const BRAKE_N: f32 = 1000.0;
/// Viscous friction of the table, N·s/m.
pub const VISCOUS_N_S_PER_M: f32 = 100.0;

/// Steps per tick.
const STEPS: u32 = 4;

/// Time of a step, s. The resonance has 3700 rad/s: ω·h = 0.05.
const STEP_S: f32 = 1.0 / (TICK_HZ * STEPS) as f32;

/// Position units in a metre.
#[expect(clippy::cast_possible_truncation, reason = "rounded to 24 bits")]
const UNITS: f32 = PER_M as f32;

/// Which sensors of an axis are frozen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frozen {
    /// The encoder of the motor.
    pub encoder: bool,
    /// The linear scale.
    pub scale: bool,
}

/// What acts on an axis beside its drive.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a condition of its own")]
pub struct Surroundings {
    /// Force on the motor, N.
    pub motor_n: f32,
    /// Force on the table, N.
    pub table_n: f32,
    /// Coulomb friction of the table beside [`COULOMB_N`], N.
    pub drag_n: f32,
    /// The axis is vertical: the weight of motor side and table, which have no counterweight, acts downwards.
    pub vertical: bool,
    /// [`ADDED_MASS_KG`] is on the table.
    pub loaded: bool,
    /// Its brake is closed.
    pub braked: bool,
    /// The hard stop at [`STOP_M`] is there.
    pub stopped: bool,
}

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
    /// Motor and table as their sensors read them.
    read_motor: i64,
    read_table: i64,
    /// Position at power-up, position units: readings count from there.
    start: i64,
    /// Turn of the motor from index pulse to index pulse.
    turn: i64,
    /// Reading at the last index pulse.
    index: Option<Position>,
}

impl AxisPlant {
    /// At rest at a position, with a dead zone of the screw.
    #[expect(clippy::cast_possible_truncation, reason = "a width, and a position within the travel")]
    pub fn new(backlash_m: f64, start_m: f64) -> Self {
        let start = (start_m * PER_M) as i64;
        Self {
            half_gap_m: 0.5 * backlash_m as f32,
            motor: start,
            table: start,
            motor_velocity: 0.0,
            table_velocity: 0.0,
            read_motor: start,
            read_table: start,
            start,
            turn: turn(start),
            index: None,
        }
    }

    /// Moves by the time of a tick under a force (N) of the drive. A sensor that is frozen is not read.
    pub fn step(&mut self, force_n: f32, surroundings: Surroundings, frozen: Frozen) {
        let table_mass_kg = if surroundings.loaded { TABLE_MASS_KG + ADDED_MASS_KG } else { TABLE_MASS_KG };
        let weight_n =
            if surroundings.vertical { GRAVITY_M_PER_S2 * (MOTOR_MASS_KG + table_mass_kg) } else { 0.0 };
        let force_n = force_n + surroundings.motor_n;
        for _ in 0..STEPS {
            let screw_n = self.screw_force();
            self.motor_velocity += STEP_S / MOTOR_MASS_KG * (force_n - screw_n);
            if surroundings.braked {
                self.motor_velocity -= within(self.motor_velocity, STEP_S / MOTOR_MASS_KG * BRAKE_N);
            }
            let stop_n = if surroundings.stopped { self.stop_force() } else { 0.0 };
            let moving =
                screw_n + surroundings.table_n - weight_n + stop_n - VISCOUS_N_S_PER_M * self.table_velocity;
            let free = self.table_velocity + STEP_S / table_mass_kg * moving;
            let friction = STEP_S / table_mass_kg * (COULOMB_N + surroundings.drag_n);
            self.table_velocity = free - within(free, friction);
            #[expect(clippy::cast_possible_truncation, reason = "a position unit")]
            let way = |velocity: f32| (velocity * (STEP_S * UNITS)) as i64;
            self.motor = self.motor.wrapping_add(way(self.motor_velocity));
            self.table = self.table.wrapping_add(way(self.table_velocity));
        }
        if !frozen.encoder {
            self.read_motor = self.motor;
        }
        if !frozen.scale {
            self.read_table = self.table;
        }
        let turn = turn(self.motor);
        if turn != self.turn {
            // Between the two turns: the pulse is at the beginning of the later one.
            let pulse = turn.max(self.turn) * LEAD + INDEX;
            (self.turn, self.index) = (turn, Some(self.counted(pulse)));
        }
    }

    /// Position of the motor, position units.
    pub(super) const fn motor(&self) -> i64 {
        self.motor
    }

    /// Position of the table, position units.
    pub(super) const fn table(&self) -> i64 {
        self.table
    }

    /// Velocity of the table, m/s.
    pub(super) const fn table_velocity(&self) -> f32 {
        self.table_velocity
    }

    /// Moves motor and table to a position, at rest, without index pulses.
    pub(super) const fn move_to(&mut self, position: i64) {
        (self.motor, self.table) = (position, position);
        (self.motor_velocity, self.table_velocity) = (0.0, 0.0);
        (self.turn, self.index) = (turn(position), None);
    }

    /// The reading at the index pulse since the last call.
    pub const fn take_index(&mut self) -> Option<Position> {
        self.index.take()
    }

    /// Whether the table is below a position, m.
    pub fn is_below(&self, m: f64) -> bool {
        (self.table as f64) < m * PER_M
    }

    /// Limit switches: whether the table is below the first position or above the second, m.
    pub fn at_limits(&self, [below, above]: [f64; 2]) -> [bool; 2] {
        [self.is_below(below), !self.is_below(above)]
    }

    /// The reading of a position in whole counts from the start.
    const fn counted(&self, position: i64) -> Position {
        Position(position.wrapping_sub(self.start).div_euclid(COUNT).wrapping_mul(COUNT))
    }

    /// Force of the motor on the table, N.
    fn screw_force(&self) -> f32 {
        let stretch = self.motor.wrapping_sub(self.table) as f32 / UNITS;
        let beyond = stretch - within(stretch, self.half_gap_m);
        let force =
            STIFFNESS_N_PER_M * beyond + DAMPING_N_S_PER_M * (self.motor_velocity - self.table_velocity);
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

    /// Force of the hard stop on the table, N: it can only push.
    fn stop_force(&self) -> f32 {
        let depth = STOP.wrapping_sub(self.table) as f32 / UNITS;
        if depth > 0.0 { (STOP_N_PER_M * depth - STOP_N_S_PER_M * self.table_velocity).max(0.0) } else { 0.0 }
    }

    /// Encoder and scale in whole counts.
    pub fn reading(&self) -> Reading {
        Reading { motor: self.counted(self.read_motor), table: Some(self.counted(self.read_table)) }
    }
}

/// Lead, position units.
#[expect(clippy::cast_possible_truncation, reason = "within the travel")]
pub(super) const LEAD: i64 = (LEAD_M * PER_M) as i64;

/// Position of the hard stop, position units.
#[expect(clippy::cast_possible_truncation, reason = "within the travel")]
const STOP: i64 = (STOP_M * PER_M) as i64;

/// Position of an index pulse, position units.
#[expect(clippy::cast_possible_truncation, reason = "within the travel")]
const INDEX: i64 = (INDEX_M * PER_M) as i64;

/// A value limited to ± `limit`; `clamp` could panic.
const fn within(value: f32, limit: f32) -> f32 {
    value.max(-limit).min(limit)
}

/// Number of the turn of the motor, counted from an index pulse.
const fn turn(position: i64) -> i64 {
    position.wrapping_sub(INDEX).div_euclid(LEAD)
}
