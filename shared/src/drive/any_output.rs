//! A drive output that is chosen by a table of the board.

use super::amplifier::{Amplifier, DriveError, Duty};
use super::analog::{AnalogOutput, AnalogSettings};
use super::output::{Demand, DriveOutput};
use super::step::{StepOutput, Steps};
use crate::scalar::Scalar;

/// The drive of an axis, as a table declares it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveSettings {
    /// A torque drive with PWM and direction: force at full duty, N, negative for reversed wiring.
    Pwm {
        /// Force at full duty, N.
        full_duty_n: f64,
    },
    /// A torque drive with a ±10 V input.
    Analog(AnalogSettings),
    /// A drive with step and direction inputs, which closes its own loops.
    Steps {
        /// Travel per step, m; negative for the other direction.
        step_m: f64,
    },
}

/// The input of a drive, as its pins get it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveSignal {
    /// PWM and direction.
    Pwm(Duty),
    /// Counts of a converter.
    Analog(u16),
    /// Steps and direction.
    Steps {
        /// The steps, for their counter.
        steps: Steps,
        /// The pulse of a step, half a PWM period long, with its direction: at most one step in a period.
        pulse: Duty,
    },
}

/// An output of any kind.
#[derive(Clone, Copy, Debug)]
pub enum AnyOutput<S: Scalar> {
    /// PWM and direction.
    Pwm(Amplifier<S>),
    /// ±10 V.
    Analog(AnalogOutput<S>),
    /// Step and direction.
    Steps {
        /// The steps to the command.
        output: StepOutput,
        /// PWM counts of the pulse of a step.
        pulse_counts: u16,
    },
}

impl<S: Scalar> AnyOutput<S> {
    /// The output for a drive, on a board with `full_counts` PWM counts and at most `max_steps` steps per tick.
    ///
    /// # Errors
    /// [`DriveError`] for the value that is rejected.
    pub fn new(settings: &DriveSettings, full_counts: u16, max_steps: u8) -> Result<Self, DriveError> {
        match settings {
            DriveSettings::Pwm { full_duty_n } => Amplifier::new(*full_duty_n, full_counts).map(Self::Pwm),
            DriveSettings::Analog(settings) => AnalogOutput::new(settings).map(Self::Analog),
            DriveSettings::Steps { step_m } => {
                let output = StepOutput::new(*step_m, max_steps)?;
                Ok(Self::Steps { output, pulse_counts: full_counts / 2 })
            }
        }
    }
}

impl<S: Scalar> DriveOutput<S> for AnyOutput<S> {
    type Signal = DriveSignal;

    fn follows_force(&self) -> bool {
        !matches!(self, Self::Steps { .. })
    }

    fn signal(&mut self, demand: &Demand<S>) -> DriveSignal {
        match self {
            Self::Pwm(output) => DriveSignal::Pwm(output.signal(demand)),
            Self::Analog(output) => DriveSignal::Analog(output.signal(demand)),
            Self::Steps { output, pulse_counts } => steps_signal(output.signal(demand), *pulse_counts),
        }
    }

    fn off(&mut self) -> DriveSignal {
        match self {
            Self::Pwm(output) => DriveSignal::Pwm(DriveOutput::<S>::off(output)),
            Self::Analog(output) => DriveSignal::Analog(output.off()),
            Self::Steps { output, pulse_counts } => {
                steps_signal(DriveOutput::<S>::off(output), *pulse_counts)
            }
        }
    }
}

const fn steps_signal(steps: Steps, pulse_counts: u16) -> DriveSignal {
    let counts = if steps.count > 0 { pulse_counts } else { 0 };
    DriveSignal::Steps { steps, pulse: Duty { reverse: steps.reverse, counts } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;
    use crate::units::Position;

    const FULL: u16 = 8400;

    fn output(drive: DriveSettings) -> AnyOutput<Fixed> {
        AnyOutput::new(&drive, FULL, 1).unwrap()
    }

    fn force(force_n: f64) -> Demand<Fixed> {
        Demand { force: Fixed::signal(force_n), command: Position(0) }
    }

    /// A force of −100 N of 400 N is a quarter of the counts with the direction high; the sign of the wiring turns the direction
    /// alone; a force beyond full scale is full duty; off is no duty.
    #[test]
    fn a_force_becomes_duty_and_direction() {
        for (full_duty_n, negative) in [(400.0, true), (-400.0, false)] {
            let mut output = output(DriveSettings::Pwm { full_duty_n });
            let pwm = |reverse, counts| DriveSignal::Pwm(Duty { reverse, counts });
            assert_eq!(output.signal(&force(-100.0)), pwm(negative, 2100));
            assert_eq!(output.signal(&force(200.0)), pwm(!negative, 4200));
            assert_eq!(output.signal(&force(2000.0)), pwm(!negative, FULL));
            assert_eq!(output.signal(&force(0.0)), pwm(false, 0));
            assert_eq!(output.off(), pwm(false, 0));
        }
    }

    /// Two steps of 1 µm forwards, a reversal with a tick for the direction, and a step back; off keeps the direction and has no
    /// pulse.
    #[test]
    fn a_command_becomes_step_pulses() {
        let mut output = output(DriveSettings::Steps { step_m: 1e-6 });
        let signal = |reverse, count, counts| DriveSignal::Steps {
            steps: Steps { reverse, count },
            pulse: Duty { reverse, counts },
        };
        let half = FULL / 2;
        for (command_um, expected) in [
            (2.0, signal(false, 1, half)),
            (2.0, signal(false, 1, half)),
            (2.0, signal(false, 0, 0)),
            (1.0, signal(true, 0, 0)),
            (1.0, signal(true, 1, half)),
            (1.0, signal(true, 0, 0)),
        ] {
            let command = Position::from_m(command_um * 1e-6).unwrap();
            assert_eq!(output.signal(&Demand { force: Fixed::ZERO, command }), expected);
        }
        assert_eq!(output.off(), signal(true, 0, 0));
    }

    /// Several steps in a tick, which a board with one pulse per period cannot make, are one pulse.
    #[test]
    fn several_steps_are_one_pulse() {
        let mut output = AnyOutput::<Fixed>::new(&DriveSettings::Steps { step_m: 1e-6 }, FULL, 3).unwrap();
        let command = Position::from_m(3e-6).unwrap();
        let pulse = Duty { reverse: false, counts: FULL / 2 };
        let steps = Steps { reverse: false, count: 3 };
        assert_eq!(
            output.signal(&Demand { force: Fixed::ZERO, command }),
            DriveSignal::Steps { steps, pulse }
        );
    }

    /// ±10 V have no pulse: the signal is the counts of the converter.
    #[test]
    fn counts_reach_the_converter_unchanged() {
        let settings = AnalogSettings { full_scale_n: 300.0, zero: 2048, span: 2047, max: 4095 };
        let mut output = output(DriveSettings::Analog(settings));
        for (force_n, counts) in [(0.0, 2048), (300.0, 4095), (-300.0, 1)] {
            assert_eq!(output.signal(&force(force_n)), DriveSignal::Analog(counts));
        }
        assert_eq!(output.off(), DriveSignal::Analog(2048));
    }
}
