//! Step and direction to a drive that closes its own loops.
//!
//! The output emits steps until they are nearest to the command, with a hysteresis: a step follows when the command is three
//! quarters of a step away, so that the distance stays below that at rest, and a command that oscillates by less than half
//! a step causes none. A tick emits at most a declared number of steps; after a change of direction, one tick passes without a
//! step, so that the direction input of the drive has settled.
//!
//! The sum of the steps is the reading of such an axis ([`StepCounter`]). A command faster than the drive can step then shows
//! as a following error and switches the drives off. What the motor does with the steps is not seen: a linear scale is.

use super::amplifier::DriveError;
use super::output::{Demand, DriveOutput};
use crate::scalar::Scalar;
use crate::units::Position;

/// The steps of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// Whether they are in the negative direction of the drive.
    pub reverse: bool,
    /// Number of steps.
    pub count: u8,
}

/// A step output.
#[derive(Clone, Copy, Debug)]
pub struct StepOutput {
    /// Position units per step.
    step: i64,
    /// Whether the positive direction of the axis is the negative one of the drive.
    inverted: bool,
    max_per_tick: u8,
    /// Sum of the steps.
    emitted: Position,
    reverse: bool,
}

/// Shortest and longest step, m.
const STEP_RANGE_M: [f64; 2] = [1e-10, 1e-3];

impl StepOutput {
    /// A drive that moves the axis by `step_m` per step, at most `max_per_tick` of them in a tick. The length is rounded to a
    /// position unit; it is negative if the positive direction of the drive is the negative one of the axis.
    ///
    /// # Errors
    /// [`DriveError::Step`] unless the magnitude of a step is 0.1 nm to 1 mm and there is at least one per tick.
    pub fn new(step_m: f64, max_per_tick: u8) -> Result<Self, DriveError> {
        let magnitude_m = libm::fabs(step_m);
        let [min, max] = STEP_RANGE_M;
        let step = Position::from_m(magnitude_m).filter(|_| (min..=max).contains(&magnitude_m));
        match step {
            Some(Position(step)) if max_per_tick > 0 => {
                let inverted = step_m < 0.0;
                Ok(Self { step, inverted, max_per_tick, emitted: Position(0), reverse: false })
            }
            _ => Err(DriveError::Step),
        }
    }

    /// The counter of the steps of this drive.
    #[must_use]
    pub const fn counter(&self) -> StepCounter {
        StepCounter { step: if self.inverted { -self.step } else { self.step }, position: Position(0) }
    }

    fn steps_to(&mut self, command: Position) -> Steps {
        let pending = command - self.emitted;
        // Three quarters of a step.
        let threshold = (self.step - self.step / 4).unsigned_abs();
        if pending.unsigned_abs() < threshold {
            return Steps { reverse: self.reverse, count: 0 };
        }
        let reverse = (pending < 0) != self.inverted;
        if reverse != self.reverse {
            self.reverse = reverse;
            return Steps { reverse, count: 0 };
        }
        let step = if pending < 0 { -self.step } else { self.step };
        let mut count = 0;
        while count < self.max_per_tick && (command - self.emitted).unsigned_abs() >= threshold {
            // Three quarters of a step and more: a step leads nearer, and never further than a quarter beyond.
            self.emitted += step;
            count += 1;
        }
        Steps { reverse, count }
    }
}

impl<S: Scalar> DriveOutput<S> for StepOutput {
    type Signal = Steps;

    fn follows_force(&self) -> bool {
        false
    }

    fn signal(&mut self, demand: &Demand<S>) -> Steps {
        self.steps_to(demand.command)
    }

    fn off(&mut self) -> Steps {
        Steps { reverse: self.reverse, count: 0 }
    }
}

/// The position of a step drive by its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepCounter {
    /// Position units per step in the positive direction of the drive.
    step: i64,
    position: Position,
}

impl StepCounter {
    /// Adds the steps of a tick.
    pub fn add(&mut self, steps: Steps) {
        let distance = self.step.wrapping_mul(i64::from(steps.count));
        self.position += if steps.reverse { -distance } else { distance };
    }

    /// The position.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A position unit is 2⁻²⁰ nm: a step of 1 µm is 1,048,576,000 units.
    const STEP: i64 = 1_048_576_000;

    fn run(output: &mut StepOutput, commands: impl Iterator<Item = i64>) -> (StepCounter, u32) {
        let (mut counter, mut most) = (output.counter(), 0);
        for command in commands {
            let steps = output.signal(&Demand { force: 0.0f64, command: Position(command) });
            counter.add(steps);
            most = most.max(u32::from(steps.count));
        }
        (counter, most)
    }

    proptest! {
        /// The counter follows a command that is slower than the step rate to within a step and the tick of a reversal, and ends
        /// within three quarters of a step. Steps in the wrong direction would make it diverge.
        #[test]
        fn the_steps_follow_the_command(amplitude in 1.0..200.0f64, inverted: bool, max in 1u8..5) {
            let mut output = StepOutput::new(if inverted { -1e-6 } else { 1e-6 }, max).unwrap();
            let mut counter = output.counter();
            let ticks = 20_000;
            // Fastest at the start: 2π·amplitude/ticks steps in a tick, below 0.1.
            for tick in 0..=ticks {
                let angle = core::f64::consts::TAU * f64::from(tick) / f64::from(ticks);
                let command = Position::from_m(amplitude * 1e-6 * libm::sin(angle)).unwrap();
                counter.add(output.signal(&Demand { force: 0.0f64, command }));
                let distance = (command - counter.position()).unsigned_abs();
                prop_assert!(distance < (STEP - STEP / 4 + STEP / 10).unsigned_abs(), "{distance}");
            }
        }

        /// Back and forth by less than half a step: at most the first step.
        #[test]
        fn a_small_oscillation_causes_no_steps(centre in -1000i64..1000, swing in 0i64..(STEP / 2 - 1)) {
            let mut output = StepOutput::new(1e-6, 1).unwrap();
            let _ = run(&mut output, (0..5000).map(|_| centre * STEP / 100));
            let _ = run(&mut output, [centre * STEP / 100 + swing, centre * STEP / 100].into_iter());
            let (_, most) = run(&mut output, (0..50).flat_map(|_| [centre * STEP / 100, centre * STEP / 100 + swing]));
            prop_assert_eq!(most, 0);
        }
    }

    #[test]
    fn a_tick_has_at_most_the_declared_steps() {
        for max in [1, 3] {
            let mut output = StepOutput::new(1e-6, max).unwrap();
            // Ten steps a tick.
            let (counter, most) = run(&mut output, (1..=100).map(|tick| tick * 10 * STEP));
            assert_eq!(most, u32::from(max));
            assert_eq!(counter.position(), Position(100 * i64::from(max) * STEP));
        }
    }

    /// After a change of direction a tick without a step, also with an inverted drive.
    #[test]
    fn the_direction_settles_before_a_step() {
        for step_m in [1e-6, -1e-6] {
            let mut output = StepOutput::new(step_m, 4).unwrap();
            let mut last = Steps::default();
            for command in [5, 5, 5, -5, -5, -5, -5, 5, 5, 5].map(|steps| Position(steps * STEP)) {
                let steps = output.signal(&Demand { force: 0.0f64, command });
                assert!(steps.count == 0 || steps.reverse == last.reverse, "{steps:?} after {last:?}");
                last = steps;
            }
        }
    }

    /// Three quarters of a step away a step follows, one unit before that none, in both directions.
    #[test]
    fn a_step_follows_at_three_quarters_and_no_unit_before() {
        let threshold = STEP / 4 * 3;
        for sign in [1, -1] {
            for (distance, steps) in [(threshold - 1, 0), (threshold, 1)] {
                let mut output = StepOutput::new(1e-6, 4).unwrap();
                // The first tick sets the direction.
                let (counter, _) = run(&mut output, [sign * distance; 3].into_iter());
                assert_eq!(counter.position(), Position(sign * steps * STEP), "{distance} units");
            }
        }
    }

    /// The direction remains while the drives are off: the next step in it follows at once, and finds it settled.
    #[test]
    fn off_keeps_the_direction() {
        for (step_m, reverse) in [(1e-6, true), (-1e-6, false)] {
            let mut output = StepOutput::new(step_m, 1).unwrap();
            let back = Demand { force: 0.0f64, command: Position(-100 * STEP) };
            let _ = [(); 2].map(|()| output.signal(&back));
            assert_eq!(DriveOutput::<f64>::off(&mut output), Steps { reverse, count: 0 });
            assert_eq!(output.signal(&back), Steps { reverse, count: 1 });
        }
    }

    #[test]
    fn off_emits_nothing() {
        let mut output = StepOutput::new(1e-6, 4).unwrap();
        let _ = output.signal(&Demand { force: 0.0f64, command: Position(100 * STEP) });
        assert_eq!(DriveOutput::<f64>::off(&mut output).count, 0);
    }

    #[test]
    fn invalid_steps_are_rejected() {
        for step_m in [0.0, f64::NAN, 0.9e-10, 1.1e-3, -1.1e-3, f64::INFINITY] {
            assert_eq!(StepOutput::new(step_m, 1).err(), Some(DriveError::Step), "{step_m}");
        }
        assert_eq!(StepOutput::new(1e-6, 0).err(), Some(DriveError::Step));
        assert!(StepOutput::new(1e-10, 1).is_ok() && StepOutput::new(-1e-3, 255).is_ok());
    }
}
