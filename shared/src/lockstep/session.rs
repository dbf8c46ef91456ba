//! The board's side of the [`crate::lockstep::protocol`]: it answers every order, whatever the bytes are.

#[cfg(test)]
mod tests;

use crate::SOURCES;
use crate::feedback::Reading;
use crate::lockstep::protocol::{
    AXES, Answer, FRAME, LONGEST_ORDER, Order, Part, Rejection, Setup, TickResult, decode,
};
use crate::machine::{Machine, MachineConfig, MachineError, Output};
use crate::scalar::{Fixed, Format, Scalar};

/// Measures the cost of a tick.
pub trait Meter {
    /// Called immediately before a tick.
    fn start(&mut self);

    /// Called immediately after it. Returns its cost in instructions or cycles.
    fn stop(&mut self) -> u32;
}

/// A meter that always returns 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeter;

impl Meter for NoMeter {
    fn start(&mut self) {}

    fn stop(&mut self) -> u32 {
        0
    }
}

/// A host's session with a board.
#[derive(Debug, Default)]
pub struct Session {
    machine: SessionMachine,
    /// The parts of an order that have been received.
    parts: heapless::Vec<u8, LONGEST_ORDER>,
}

/// The machine that the host has set up, in the number format that it has chosen.
#[derive(Debug, Default)]
#[expect(clippy::large_enum_variant, reason = "one session, and nothing to allocate it from")]
enum SessionMachine {
    /// No setup yet.
    #[default]
    Empty,
    /// Fixed point.
    Fixed(Machine<Fixed, AXES>),
    /// Single precision.
    F32(Machine<f32, AXES>),
    /// Double precision.
    F64(Machine<f64, AXES>),
}

impl Session {
    /// No setup yet. For a static: a session is too large for the stack of a chip.
    pub const NEW: Self = Self { machine: SessionMachine::Empty, parts: heapless::Vec::new() };

    /// Executes the order in a frame. `None`: the host has ended the run.
    pub fn answer(&mut self, frame: &[u8; FRAME], meter: &mut impl Meter) -> Option<Answer> {
        match decode(frame) {
            Ok(Order::Part(part)) => self.append(&part, meter),
            whole => {
                // An incomplete order in parts is discarded.
                self.parts.clear();
                match whole {
                    Ok(order) => self.machine.execute(&order, meter),
                    Err(_) => Some(Answer::Rejected(Rejection::Unreadable)),
                }
            }
        }
    }

    /// Appends a part of an order, and executes the order with its last part.
    fn append(&mut self, part: &Part, meter: &mut impl Meter) -> Option<Answer> {
        if self.parts.extend_from_slice(&part.bytes).is_err() {
            self.parts.clear();
            return Some(Answer::Rejected(Rejection::Unreadable));
        }
        if !part.last {
            return Some(Answer::Ready);
        }
        let order = decode(&self.parts);
        self.parts.clear();
        match order {
            Ok(order) => self.machine.execute(&order, meter),
            Err(_) => Some(Answer::Rejected(Rejection::Unreadable)),
        }
    }
}

impl SessionMachine {
    fn execute(&mut self, order: &Order, meter: &mut impl Meter) -> Option<Answer> {
        Some(match (order, self) {
            (Order::End, _) => return None,
            (Order::Identify, _) => Answer::Sources(SOURCES),
            (Order::Setup(setup), machine) => machine.set_up(setup),
            (_, Self::Empty) => Answer::Rejected(Rejection::NotSetUp),
            (order, Self::Fixed(machine)) => execute(machine, order, meter),
            (order, Self::F32(machine)) => execute(machine, order, meter),
            (order, Self::F64(machine)) => execute(machine, order, meter),
        })
    }

    fn set_up(&mut self, setup: &Setup) -> Answer {
        // Configured in place: a machine is too large for the stack of a chip.
        macro_rules! set_up {
            ($format:ident) => {
                MachineConfig::new(setup.rates, &setup.axes).map(|config| {
                    *self = Self::$format(Machine::UNCONFIGURED);
                    if let Self::$format(machine) = self {
                        machine.configure(config, &setup.start);
                    }
                })
            };
        }
        answer(match setup.format {
            Format::Fixed => set_up!(Fixed),
            Format::F32 => set_up!(F32),
            Format::F64 => set_up!(F64),
        })
    }
}

fn execute<S: Scalar>(machine: &mut Machine<S, AXES>, order: &Order, meter: &mut impl Meter) -> Answer {
    match order {
        Order::Compensate(axis, settings) => answer(machine.compensate(usize::from(*axis), settings)),
        Order::Switch(axis, item, on) => answer(machine.switch(usize::from(*axis), *item, *on)),
        Order::Change(axis, settings) => answer(machine.change(usize::from(*axis), settings)),
        Order::Block(block) => answer(machine.push(block).map_err(MachineError::from)),
        Order::Enable => {
            machine.enable();
            Answer::Ready
        }
        Order::Disable => {
            machine.disable();
            Answer::Ready
        }
        Order::Fault(fault) => {
            machine.fault(*fault);
            Answer::Ready
        }
        Order::Hold => {
            machine.hold();
            Answer::Ready
        }
        Order::Resume => {
            machine.resume();
            Answer::Ready
        }
        Order::Stop => {
            machine.discard_path();
            Answer::Ready
        }
        Order::Override(percent) => {
            machine.set_override(*percent);
            Answer::Ready
        }
        Order::Tick(readings) => {
            meter.start();
            let output = tick(machine, readings);
            let cost = meter.stop();
            Answer::Tick(TickResult {
                force_bits: output.forces.map(Scalar::bits),
                commands: output.commands,
                power: machine.power(),
                warning: output.warning,
                done: output.done,
                cost,
            })
        }
        // Handled by the session.
        Order::Part(_) | Order::Setup(_) | Order::Identify | Order::End => {
            Answer::Rejected(Rejection::Unreadable)
        }
    }
}

fn answer(result: Result<(), MachineError>) -> Answer {
    let refusal = match result {
        Ok(()) => return Answer::Ready,
        Err(MachineError::Path(error)) => Rejection::Path(error),
        // No order of this protocol sets an origin.
        Err(MachineError::NoSuchAxis | MachineError::PathRunning) => Rejection::NoSuchAxis,
        #[expect(clippy::cast_possible_truncation, reason = "the protocol has two axes")]
        Err(MachineError::Config { axis, .. }) => Rejection::Settings { axis: axis as u8 },
    };
    Answer::Rejected(refusal)
}

/// The tick with what it computes ahead, as a function that is never inlined: it is what the meter measures, and where the test that looks for panics in
/// the program of the chip starts.
#[inline(never)]
fn tick<S: Scalar>(machine: &mut Machine<S, AXES>, readings: &[Reading; AXES]) -> Output<S, AXES> {
    let output = machine.tick(readings);
    machine.prepare();
    output
}
