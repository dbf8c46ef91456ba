//! Two masses at the ends of a beam that is elastic against racking: m·dv/dt = F ± (k·s + c·ds/dt) − friction, with skew s = x₂ − x₁ − square.

use crate::slide::Slide;
use shared::config::{AxisSettings, GantrySettings, Rates, Sensors};
use shared::feedback::Reading;
use shared::units::Position;

pub const TICK_HZ: f64 = 20_000.0;
pub const RATES: Rates = Rates { velocity_loop_hz: TICK_HZ, position_loop_divider: 5 };

/// Racking stiffness, N/m, and damping, N·s/m.
pub const STIFFNESS_N_PER_M: f64 = 0.2e6;
const DAMPING_N_S_PER_M: f64 = 500.0;

/// Dry friction of each end, N.
pub const COULOMB_N: f64 = 20.0;

/// Encoders, m per count.
pub const COUNT_M: f64 = 0.25e-6;

/// Position of the second end less that of the first on a square beam, m.
pub const SQUARE_M: f64 = 0.3e-3;

pub const LIMIT_M: f64 = 0.4e-3;
pub const FORCE_LIMIT_N: f64 = 200.0;

/// Settings of the first motor, and of the second with another position gain, as each has its own loop.
pub fn settings(reference_offset_m: f64) -> [AxisSettings; 2] {
    let first = AxisSettings {
        position_gain_per_s: 25.0,
        feedforward_percent: 100.0,
        velocity_gain_n_s_per_m: 3000.0,
        force_limit_n: FORCE_LIMIT_N,
        sensors: Sensors::MOTOR,
        following_error_limit_m: 2e-3,
        travel_m: Some([-0.005, 0.09]),
        stop_deceleration_m_per_s2: 1.0,
        ..AxisSettings::default()
    };
    let gantry = GantrySettings { first: 0, skew_limit_m: LIMIT_M, reference_offset_m };
    [first, AxisSettings { position_gain_per_s: 30.0, gantry: Some(gantry), ..first }]
}

#[derive(Clone, Copy)]
pub struct Beam {
    /// Position of each end, m.
    pub at_m: [f64; 2],
    velocity: [f64; 2],
    /// Dry friction of each end, N.
    pub coulomb_n: [f64; 2],
    /// Places at which the encoders count from.
    start_m: [f64; 2],
}

impl Beam {
    /// With the first end at a place and skew, at rest.
    pub fn at(first_m: f64, skew_m: f64) -> Self {
        let at_m = [first_m, first_m + SQUARE_M + skew_m];
        Self { at_m, velocity: [0.0; 2], coulomb_n: [COULOMB_N; 2], start_m: at_m }
    }

    /// Skew, m.
    pub fn skew_m(&self) -> f64 {
        self.at_m[1] - self.at_m[0] - SQUARE_M
    }

    /// Moves by a tick under the forces of the motors, N.
    pub fn step(&mut self, forces_n: [f64; 2]) {
        let racking_n =
            STIFFNESS_N_PER_M * self.skew_m() + DAMPING_N_S_PER_M * (self.velocity[1] - self.velocity[0]);
        let forces_n = [forces_n[0] + racking_n, forces_n[1] - racking_n];
        for (end, force_n) in forces_n.into_iter().enumerate() {
            let slide = Slide { mass_kg: 15.0, viscous_n_s_per_m: 100.0, coulomb_n: self.coulomb_n[end] };
            slide.step(&mut self.at_m[end], &mut self.velocity[end], force_n, 1.0 / TICK_HZ);
        }
    }

    /// What the encoder of an end reads at a place.
    pub fn count(&self, end: usize, m: f64) -> Position {
        Position::from_m(((m - self.start_m[end]) / COUNT_M).floor() * COUNT_M).unwrap()
    }

    pub fn readings(&self) -> [Reading; 2] {
        [0, 1].map(|end| Reading { motor: self.count(end, self.at_m[end]), table: None })
    }
}
