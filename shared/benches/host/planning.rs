//! Planning of a block from rest to rest, compared with `rsruckig` with the same limits.
//!
//! `rsruckig` plans only the speed over time, from any state to any state. `shared` also checks the block and plans its
//! geometry in integers; the block starts and ends at rest.

use std::hint::black_box;

use rsruckig::prelude::{InputParameter, Ruckig, Synchronization, ThrowErrorHandler, Trajectory};
use shared::interpolate::block::{Block, Joint, Ramps, Shape};
use shared::interpolate::planned::PlannedBlock;
use shared::interpolate::smooth::Filter;
use shared::units::Position;

use crate::compared::Compared;

const FEED_M_PER_S: f64 = 0.1;
const ACCELERATION_M_PER_S2: f64 = 2.0;
const JERK_M_PER_S3: f64 = 50.0;

/// The peer of all rows: the path length alone, as `shared` plans it.
const PEER: &str = "rsruckig, one axis";

/// From lengths that do not reach the acceleration limit to lengths that reach the feed.
const LENGTHS_M: [f64; 8] = [1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];

#[expect(clippy::cast_possible_truncation, reason = "eight")]
const BLOCKS: u32 = LENGTHS_M.len() as u32;

fn theirs<const AXES: usize>(compared: &mut Compared, name: &str) {
    let mut planner = Ruckig::<AXES, ThrowErrorHandler>::new(None, 1.0 / 20_000.0);
    let mut trajectory = Trajectory::new(None);
    let inputs = LENGTHS_M.map(|length| {
        let mut input = InputParameter::<AXES>::new(None);
        input.synchronization = Synchronization::Phase;
        for axis in 0..AXES {
            input.target_position[axis] = length / (axis + 1) as f64;
            input.max_velocity[axis] = FEED_M_PER_S;
            input.max_acceleration[axis] = ACCELERATION_M_PER_S2;
            input.max_jerk[axis] = JERK_M_PER_S3;
        }
        input
    });
    compared.row(name, PEER, BLOCKS, || {
        for input in &inputs {
            planner.calculate(black_box(input), &mut trajectory).unwrap();
            black_box(&trajectory);
        }
    });
}

fn ours(compared: &mut Compared, name: &str, ramps: Ramps, shape: impl Fn(f64) -> Shape<2>) {
    let blocks = LENGTHS_M.map(|length| Block {
        shape: shape(length),
        feed_m_per_s: FEED_M_PER_S,
        acceleration_m_per_s2: ACCELERATION_M_PER_S2,
        ramps,
        joint: Joint::Stop,
    });
    let rounding = Filter::Pass.rounding();
    compared.row(name, PEER, BLOCKS, || {
        for block in &blocks {
            black_box(PlannedBlock::new(black_box(block), [Position(0); 2], 20_000.0, &rounding).unwrap());
        }
    });
}

pub fn measure(compared: &mut Compared) {
    theirs::<1>(compared, PEER);
    theirs::<2>(compared, "rsruckig, a line of two axes");
    let s_curve = Ramps::SCurve { jerk_m_per_s3: JERK_M_PER_S3 };
    for (name, ramps) in
        [("S-curve", s_curve), ("trapezoidal", Ramps::Trapezoid), ("exponential", Ramps::Exponential)]
    {
        let line = |length| Shape::Line { to_m: [length, length / 2.0] };
        ours(compared, &format!("a line, {name}"), ramps, line);
        let turns = |length: f64| length / (0.02 * core::f64::consts::TAU);
        let arc = |length| Shape::Arc { plane: [0, 1], centre_m: [0.02, 0.0], turns: turns(length) };
        ours(compared, &format!("an arc, {name}"), ramps, arc);
    }
}
