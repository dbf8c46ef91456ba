//! The tick of four axes with the rates of the board and everything enabled, in fixed point.

use core::hint::black_box;

use shared::axis::Reading;
use shared::interpolate::Block;
use shared::link::message::MAX_AXES;
use shared::machine::{Machine, Output};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use super::count::Counter;
use super::motion::{ACCELERATION_M_PER_S2, Axis, FEED_M_PER_S, RAMPS, all_compensations, full_axis};
use crate::setup;

/// Ticks that are counted, 0.25 s: the blocks end within them.
const TICKS: usize = 5000;

/// A line of all four axes, an arc of two of them, and a line of all back to the start.
const PROGRAM: [Block<MAX_AXES>; 3] = [
    Block::line([0.003, 0.002, -0.001, 0.0015], FEED_M_PER_S, ACCELERATION_M_PER_S2).with_ramps(RAMPS),
    Block::arc([0, 1], [0.001, 0.002], 1.25, FEED_M_PER_S, ACCELERATION_M_PER_S2).with_ramps(RAMPS),
    Block::line([0.0; MAX_AXES], FEED_M_PER_S, ACCELERATION_M_PER_S2).with_ramps(RAMPS),
];

/// A machine with the program queued and the enable requested. `None` if it rejects a setting or a block.
fn machine() -> Option<Machine<Fixed, MAX_AXES>> {
    let mut machine = Machine::new(setup::RATES, &[full_axis(); MAX_AXES], [Position(0); MAX_AXES]).ok()?;
    for axis in 0..MAX_AXES {
        machine.compensate(axis, &all_compensations(axis)).ok()?;
    }
    for block in &PROGRAM {
        machine.push(block).ok()?;
    }
    machine.enable();
    Some(machine)
}

fn tick(machine: &mut Machine<Fixed, MAX_AXES>, readings: &[Reading; MAX_AXES]) -> Output<Fixed, MAX_AXES> {
    let output = machine.tick(readings);
    machine.prepare();
    output
}

/// The tick of four axes with the rates of the board: of all ticks, and of those with position loops. `None` if the machine rejects its
/// settings, or does not complete the motion.
#[inline(never)]
pub fn of_the_tick_of_four_axes(counter: &mut Counter) -> Option<()> {
    let mut recorded = [[Reading { motor: Position(0), table: None }; MAX_AXES]; TICKS];
    let mut moving = machine()?;
    let (mut axes, mut forces) = ([Axis::default(); MAX_AXES], [Fixed::default(); MAX_AXES]);
    let mut last = None;
    for readings in &mut recorded {
        for ((axis, force), reading) in axes.iter_mut().zip(&forces).zip(readings.iter_mut()) {
            *reading = axis.step(force.value());
        }
        let output = tick(&mut moving, readings);
        forces = output.forces;
        last = Some(output);
    }
    last.filter(|output| output.enabled && output.done)?;
    let (first, others) = recorded.split_first()?;
    let mut started = machine()?;
    tick(&mut started, first);
    let stride = setup::RATES.position_loop_divider as usize;
    let mut every = black_box(started.clone());
    counter.part("board of four axes, all on", Fixed::NAME, others, |readings| tick(&mut every, readings));
    let position = ("board of four axes, position tick", Fixed::NAME);
    counter.last_of_each(position, (others, stride), |readings| tick(&mut started, readings));
    Some(())
}
