//! Ticks of a machine of two axes, each with path and position loops.

use std::hint::black_box;

use shared::axis::Reading;
use shared::config::{AxisSettings, Law, LowPass, Notch, Notches, Rates, ScaleLimits, Sensors};
use shared::interpolate::Block;
use shared::machine::Machine;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use crate::compared::Compared;

/// Ticks per call.
const TICKS: u32 = 1000;

/// An axis with all its features.
fn full_settings() -> AxisSettings {
    AxisSettings {
        law: Law::Hpc,
        feedforward_percent: 80.0,
        velocity_lag_s: 0.5 / 20_000.0,
        notches: Notches([
            Some(Notch { frequency_hz: 400.0, width_hz: 100.0, depth: 0.9 }),
            None,
            None,
            None,
        ]),
        low_pass: Some(LowPass { frequency_hz: 900.0, damping_ratio: 0.7 }),
        sensors: Sensors::Dual { time_constant_s: 0.05, limits: ScaleLimits::DEFAULT },
        // The simulated axes follow their commands exactly, so that the force may stay saturated.
        saturation_time_s: 1e5,
        ..AxisSettings::default()
    }
}

/// A machine in the middle of a block, drives on.
fn moving<S: Scalar>(block: &Block<2>) -> Machine<S, 2> {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
    let mut machine = Machine::new(rates, &[full_settings(); 2], [Position(0); 2]).unwrap();
    machine.push(block).unwrap();
    machine.enable();
    let mut readings = [Reading { motor: Position(0), table: Some(Position(0)) }; 2];
    for _ in 0..2 * TICKS {
        readings = follow(&machine.tick(&readings).commands);
    }
    machine
}

/// Readings of axes that follow their commands exactly, with the table 1 µm behind the motor.
fn follow(commands: &[Position; 2]) -> [Reading; 2] {
    commands.map(|motor| Reading { motor, table: Some(motor - (1000 << 20)) })
}

fn row<S: Scalar>(compared: &mut Compared, motion: &str, block: &Block<2>) {
    let start = moving::<S>(block);
    let name = |format: &str| format!("tick of two axes on {motion}, {format}");
    compared.row(&name(S::NAME), &name(f64::NAME), TICKS, || {
        let mut machine = black_box(start.clone());
        let mut readings = follow(&[Position(0); 2]);
        for _ in 0..TICKS {
            let output = machine.tick(black_box(&readings));
            readings = follow(&output.commands);
            black_box(&output);
        }
        assert!(machine.power() == shared::safety::Power::On);
    });
}

pub fn measure(compared: &mut Compared) {
    let line = Block::line([0.1, 0.05], 0.1, 2.0);
    let arc = Block::arc([0, 1], [-0.05, 0.0], 1.0, 0.1, 2.0);
    for (motion, block) in [("a line", line), ("an arc", arc)] {
        row::<f64>(compared, motion, &block);
        row::<f32>(compared, motion, &block);
        row::<Fixed>(compared, motion, &block);
    }
}
