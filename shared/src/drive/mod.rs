//! The controller with drives behind it: what a board provides, and the tick that uses it.
//!
//! A board implements [`Board`] over its timers and pins and calls [`Station::tick`] from a timer
//! interrupt. All that decides anything is here, where a host can test it.

pub mod duty;
pub mod switch;

pub use duty::{Amplifier, Duty};
pub use switch::{EnableSwitch, Turn};

use crate::axis::Reading;
use crate::machine::Machine;
use crate::safety::{Fault, Power};
use crate::scalar::Scalar;

/// The world outside the controller, as a board sees it.
pub trait Board<const N: usize> {
    /// The sensors of every axis, now.
    fn readings(&mut self) -> [Reading; N];

    /// Whether the enable switch is closed. A broken wire must read as open.
    fn switch_closed(&mut self) -> bool;

    /// Sets the PWM of every axis until the next tick.
    fn set_duties(&mut self, duties: [Duty; N]);

    /// Sets the enable output, which must be on in [`Power::On`] only, and shows the state.
    fn set_power(&mut self, power: Power);

    /// Whether the next tick is due already.
    fn is_late(&mut self) -> bool;
}

/// Why a power stage cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveError {
    /// The force at full duty is not from 1 mN to 131 kN.
    FullScale,
    /// The PWM has no counts.
    NoPwm,
}

impl core::fmt::Display for DriveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::FullScale => write!(f, "force at full duty: expected 1e-3 to 131000 N"),
            Self::NoPwm => write!(f, "PWM: expected at least one count"),
        }
    }
}

impl core::error::Error for DriveError {}

/// A machine, its power stages and its enable switch. The machine, which is large, stays where the board keeps it.
#[derive(Debug)]
pub struct Station<'m, S: Scalar, const N: usize> {
    machine: &'m mut Machine<S, N>,
    amplifiers: [Amplifier<S>; N],
    switch: EnableSwitch,
}

impl<'m, S: Scalar, const N: usize> Station<'m, S, N> {
    /// Drives off until the switch is closed afresh.
    #[must_use]
    pub const fn new(
        machine: &'m mut Machine<S, N>,
        amplifiers: [Amplifier<S>; N],
        switch: EnableSwitch,
    ) -> Self {
        Self { machine, amplifiers, switch }
    }

    /// One tick, from the sensors to the power stages. Cannot fail; a fault leaves them off.
    pub fn tick(&mut self, board: &mut impl Board<N>) {
        match self.switch.look(board.switch_closed()) {
            Some(Turn::Enable) => self.machine.enable(),
            Some(Turn::Disable) => self.machine.disable(),
            None => {}
        }
        let output = self.machine.tick(&board.readings());
        let mut duties = [Duty::default(); N];
        // Forces are zero while the drives are off.
        for ((duty, amplifier), force) in duties.iter_mut().zip(&self.amplifiers).zip(output.forces) {
            *duty = amplifier.duty(force);
        }
        board.set_duties(duties);
        board.set_power(self.machine.power());
        if board.is_late() {
            self.machine.fault(Fault::Overrun);
            board.set_power(self.machine.power());
            board.set_duties([Duty::default(); N]);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::boxed::Box;

    use super::*;
    use crate::config::{AxisSettings, Rates};
    use crate::interpolate::Block;
    use crate::safety::Hazard;
    use crate::scalar::Fixed;
    use crate::units::Position;

    const SETTLING: u32 = 10;

    struct Bench {
        at: Position,
        closed: bool,
        late: bool,
        duty: Duty,
        power: Power,
    }

    impl Board<1> for Bench {
        fn readings(&mut self) -> [Reading; 1] {
            [Reading { motor: self.at, table: None }]
        }

        fn switch_closed(&mut self) -> bool {
            self.closed
        }

        fn set_duties(&mut self, [duty]: [Duty; 1]) {
            self.duty = duty;
        }

        fn set_power(&mut self, power: Power) {
            self.power = power;
        }

        fn is_late(&mut self) -> bool {
            self.late
        }
    }

    /// A station that has just been enabled, with a line to travel, and its bench.
    fn running() -> (Station<'static, Fixed, 1>, Bench) {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
        let axis = AxisSettings { following_error_limit_m: 1e-3, ..AxisSettings::default() };
        let machine = Box::leak(Box::new(Machine::new(rates, &[axis], [Position(0)]).unwrap()));
        machine.push(&Block::line([0.1], 0.1, 5.0)).unwrap();
        let mut station =
            Station::new(machine, [Amplifier::new(1000.0, 8400).unwrap()], EnableSwitch::new(SETTLING));
        let mut bench =
            Bench { at: Position(0), closed: false, late: false, duty: Duty::default(), power: Power::Off };
        close(&mut station, &mut bench);
        assert_eq!(bench.power, Power::On);
        (station, bench)
    }

    fn run(station: &mut Station<'_, Fixed, 1>, bench: &mut Bench, ticks: u32) {
        for _ in 0..ticks {
            station.tick(bench);
        }
    }

    fn close(station: &mut Station<'_, Fixed, 1>, bench: &mut Bench) {
        bench.closed = false;
        run(station, bench, 2 * SETTLING);
        assert_eq!(bench.power, Power::Off);
        bench.closed = true;
        run(station, bench, 2 * SETTLING);
    }

    #[test]
    fn pushes_towards_the_command() {
        let (mut station, mut bench) = running();
        run(&mut station, &mut bench, 40);
        assert!(!bench.duty.reverse && bench.duty.counts > 0, "{:?}", bench.duty);
    }

    #[test]
    fn a_late_tick_puts_the_drives_off_at_once_and_until_a_fresh_edge() {
        let (mut station, mut bench) = running();
        run(&mut station, &mut bench, 40);
        bench.late = true;
        station.tick(&mut bench);
        assert_eq!((bench.power, bench.duty), (Power::Faulted(Fault::Overrun), Duty::default()));
        bench.late = false;
        run(&mut station, &mut bench, 1000);
        assert_eq!((bench.power, bench.duty), (Power::Faulted(Fault::Overrun), Duty::default()));
        // The path was broken off: enabled again, the axis holds where it was moved meanwhile.
        bench.at = Position::from_m(0.02).unwrap();
        close(&mut station, &mut bench);
        assert_eq!((bench.power, bench.duty), (Power::On, Duty::default()));
    }

    #[test]
    fn an_opened_switch_puts_the_drives_off_in_the_same_tick() {
        let (mut station, mut bench) = running();
        run(&mut station, &mut bench, 40);
        bench.closed = false;
        station.tick(&mut bench);
        assert_eq!((bench.power, bench.duty), (Power::Off, Duty::default()));
        bench.at = Position::from_m(0.02).unwrap();
        close(&mut station, &mut bench);
        assert_eq!((bench.power, bench.duty), (Power::On, Duty::default()));
    }

    #[test]
    fn a_following_error_puts_the_drives_off_in_the_same_tick() {
        let (mut station, mut bench) = running();
        bench.at = Position::from_m(2e-3).unwrap();
        station.tick(&mut bench);
        let fault = Power::Faulted(Fault::Axis { axis: 0, hazard: Hazard::FollowingError });
        assert_eq!((bench.power, bench.duty), (fault, Duty::default()));
    }
}
