//! Each compensation cancels its effect and can be switched alone. No correction exceeds its declared rate or bound,
//! whatever is set, switched or replaced.
//!
//! The expected corrections are computed here in f64 from the definitions of the effects.

mod bounds;
mod cancels;
mod force;
mod in_motion;
mod refused;
mod sensors;
mod waits;

use std::f64::consts::TAU;

use proptest::prelude::*;
use shared::compensate::settings::{
    Cycle, Factor, ForceModel, FrictionWarmUp, Pitch, PitchSource, Points, Product, Reversal, Straightness,
    Stribeck, TableFriction, Talk, TimePoints,
};
use shared::compensate::{AxisCompensation, AxisOf, Compensation, CompensationKind, CompensationSettings};
use shared::config::{ConfigError, Rates};
use shared::machine::Reading;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_M, Position};

const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 1 };
const RATE_HZ: f64 = 4000.0;
/// The first of two axes.
const FIRST_AXIS: AxisOf = AxisOf { axis: 0, axes: 2 };

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

fn points(start_m: f64, spacing_m: f64, value: impl Fn(f64) -> f64) -> Points {
    let values = (0..64).map(|k| value(start_m + spacing_m * f64::from(k))).collect();
    Points { start_m, spacing_m, values }
}

struct TwoAxes<S: Scalar> {
    all: Compensation<S, 2>,
    /// Corrections of the last tick by channel: commands (m), motor readings (m), forces (N).
    added: [[f64; 2]; 3],
}

impl<S: Scalar> TwoAxes<S> {
    fn new(settings: [&CompensationSettings; 2]) -> Self {
        let mut all = Compensation::none([position(0.0); 2]);
        for (axis, settings) in settings.into_iter().enumerate() {
            all.replace(axis, &AxisCompensation::new(settings, RATES, AxisOf { axis, axes: 2 }).unwrap());
        }
        Self { all, added: [[0.0; 2]; 3] }
    }

    fn tick(&mut self, command_m: [f64; 2], motor_m: [f64; 2]) {
        let raw = motor_m.map(|m| Reading { motor: position(m), table: None });
        let readings = self.all.readings(&raw);
        let commands = self.all.commands(&command_m.map(position));
        let forces = self.all.forces(&readings);
        for axis in 0..2 {
            self.added[0][axis] = commands[axis].total.distance() as f64 / PER_M;
            self.added[1][axis] = (readings[axis].motor - raw[axis].motor) as f64 / PER_M;
            self.added[2][axis] = forces[axis].value();
        }
    }

    /// 2000 ticks in a straight line, then 2000 ticks at rest, in which the rate limiters reach their targets.
    fn settle(&mut self, from: [f64; 2], to: [f64; 2]) {
        for k in 0..=4000 {
            let fraction = (f64::from(k) / 2000.0).min(1.0);
            let positions = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * fraction);
            self.tick(positions, positions);
        }
    }
}
