//! The pins of drives against a list of the accesses that they have to make, in order (`embedded-hal-mock`).

use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as PinAccess};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmAccess};
use shared::drive::output::{Demand, DriveOutput};
use shared::drive::pins::{Dac, PwmDirection, SignalPort};
use shared::drive::step::{StepOutput, Steps};
use shared::drive::{Amplifier, Duty};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const FULL: u16 = 8400;

/// A port that must see these directions and duties, one pair for each signal.
fn port(expected: &[(State, u16)]) -> PwmDirection<Pwm, Pin> {
    let directions: Vec<_> = expected.iter().map(|(state, _)| PinAccess::set(*state)).collect();
    let duties: Vec<_> = expected
        .iter()
        .flat_map(|(_, duty)| [PwmAccess::max_duty_cycle(FULL), PwmAccess::set_duty_cycle(*duty)])
        .collect();
    PwmDirection { pwm: Pwm::new(&duties), direction: Pin::new(&directions) }
}

fn done(mut port: PwmDirection<Pwm, Pin>) {
    port.pwm.done();
    port.direction.done();
}

/// A force of −100 N of 400 N is a quarter of the counts with the direction high; the sign of the wiring turns the direction
/// alone; off is no duty.
#[test]
fn a_force_becomes_duty_and_direction() {
    for (full_n, negative, positive) in [(400.0, State::High, State::Low), (-400.0, State::Low, State::High)]
    {
        let mut output = Amplifier::<Fixed>::new(full_n, FULL).unwrap();
        let mut port = port(&[(negative, 2100), (positive, 4200), (State::Low, 0), (State::Low, 0)]);
        for force_n in [-100.0, 200.0, 0.0] {
            let demand = Demand { force: Fixed::signal(force_n), command: Position(0) };
            port.set(output.signal(&demand)).unwrap();
        }
        port.set(DriveOutput::<Fixed>::off(&mut output)).unwrap();
        done(port);
    }
}

/// A duty beyond the range of the PWM is cut to full duty.
#[test]
fn a_duty_is_never_more_than_full() {
    let mut port = port(&[(State::Low, FULL)]);
    port.set(Duty { reverse: false, counts: u16::MAX }).unwrap();
    done(port);
}

/// Two steps of 1 µm forwards, a reversal with a tick for the direction, and a step back.
#[test]
fn a_command_becomes_step_pulses() {
    let mut output = StepOutput::new(1e-6, 1).unwrap();
    let half = FULL / 2;
    let mut port = port(&[
        (State::Low, half),
        (State::Low, half),
        (State::Low, 0),
        (State::High, 0),
        (State::High, half),
        (State::High, 0),
    ]);
    for command_um in [2.0, 2.0, 2.0, 1.0, 1.0, 1.0] {
        let command = Position::from_m(command_um * 1e-6).unwrap();
        port.set(output.signal(&Demand { force: 0.0f64, command })).unwrap();
    }
    done(port);
}

/// Without a step there is no pulse.
#[test]
fn no_step_is_no_pulse() {
    let mut port = port(&[(State::High, 0)]);
    port.set(Steps { reverse: true, count: 0 }).unwrap();
    done(port);
}

struct Recorder(Vec<u16>);

impl Dac for Recorder {
    type Error = std::convert::Infallible;

    fn set_counts(&mut self, counts: u16) -> Result<(), Self::Error> {
        self.0.push(counts);
        Ok(())
    }
}

#[test]
fn counts_reach_the_converter_unchanged() {
    let mut dac = Recorder(Vec::new());
    for counts in [0, 2048, 4095] {
        dac.set(counts).unwrap();
    }
    assert_eq!(dac.0, [0, 2048, 4095]);
}
