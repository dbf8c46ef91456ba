//! Contacts that may wait for a sample: their state is that of two of the last three samples.
//!
//! | input | waits | reason |
//! |---|---|---|
//! | home switch | yes | the homing keeps the readings of the first of the samples that agree: nothing is lost by the wait |
//! | probe | yes | the same; the axis is stopped a tick later, by speed · tick, 15 µm at 0.3 m/s, which the probe yields anyway |
//! | limit switch | yes | what follows is a deceleration along the path of many ticks; a spike must not stop a machine |
//! | limit switch during a direction check | no | its force has no loop; with dead sensors the switch alone ends it |
//! | emergency stop, stop by hardware | no | the hardware has cut the stages in the same moment, and nobody may have to wait |
//! | drive fault | no | the force is not what the loop computes: each further tick of a short circuit heats the stage |
//! | enable switch, opening | no | what a person relies on acts in the same tick |
//! | enable switch, closing | longer | [`EnableSwitch`](super::EnableSwitch): all samples of the settling time agree |
//! | signals of an encoder, signal of a scale | no | a single bad sample makes a wrong position, which stays wrong |
//! | bus voltage, temperature | no | converters, not contacts; the voltage of a braking drive rises within a few ticks |
//!
//! A change without bounces is seen one tick after its first sample; with a bounce between, two ticks. A single sample that differs from its
//! neighbours is never seen. The first samples after the start count at once: there is nothing before them.
//!
//! # Example
//!
//! ```
//! use shared::drive::debounce::TwoOfThree;
//!
//! let mut contacts = TwoOfThree::NEW;
//! let seen = [0, 1, 0, 0, 1, 1, 1, 0, 1, 0, 0].map(|sample| contacts.update(sample));
//! assert_eq!(seen, [0, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0]);
//! ```

use super::inputs::Inputs;

/// Up to 32 contacts, each a bit.
#[derive(Clone, Copy, Debug)]
pub struct TwoOfThree {
    /// The last sample and the one before; `None` before the first.
    samples: Option<[u32; 2]>,
}

impl TwoOfThree {
    /// Before the first sample.
    pub const NEW: Self = Self { samples: None };

    /// The state after another sample, once per tick.
    pub const fn update(&mut self, sample: u32) -> u32 {
        let [last, before] = match self.samples {
            Some(samples) => samples,
            None => [sample; 2],
        };
        self.samples = Some([sample, last]);
        (sample & (last | before)) | (last & before)
    }

    /// The sample before the present one.
    const fn before(&self) -> u32 {
        match self.samples {
            Some([_, before]) => before,
            None => 0,
        }
    }
}

/// Bits of an axis: limit switches, home switch.
const PER_AXIS: u32 = 3;

/// Axes whose contacts fit a word with the probe.
const AXES: usize = 10;

/// The contacts of a board.
#[derive(Clone, Copy, Debug)]
pub(super) struct Debounce(TwoOfThree);

impl Debounce {
    pub const NEW: Self = Self(TwoOfThree::NEW);

    /// The inputs with the state of the contacts that may wait, once per tick. The contacts of axes beyond the tenth do not wait.
    pub fn update<const N: usize>(&mut self, mut inputs: Inputs<N>) -> Inputs<N> {
        let mut sample = u32::from(inputs.probe_touched);
        for axis in inputs.axes.iter().take(AXES).rev() {
            let [negative, positive] = axis.limits.map(u32::from);
            sample = sample << PER_AXIS | u32::from(axis.home) << 2 | positive << 1 | negative;
        }
        let mut state = self.0.update(sample);
        for axis in inputs.axes.iter_mut().take(AXES) {
            axis.limits = [state & 1 != 0, state & 2 != 0];
            axis.home = state & 4 != 0;
            state >>= PER_AXIS;
        }
        inputs.probe_touched = state & 1 != 0;
        inputs
    }

    /// Ticks since the first of the samples by which the home switch of an axis has just become active.
    pub fn ticks_since_home(&self, axis: usize) -> usize {
        self.ticks_since(axis, 2)
    }

    /// Ticks since the first of the samples by which the probe of a board with a number of axes has just been touched.
    pub fn ticks_since_touch(&self, axes: usize) -> usize {
        self.ticks_since(axes.min(AXES), 0)
    }

    /// 1 if the sample before the present one has the contact, 2 with a bounce between.
    fn ticks_since(&self, axis: usize, bit: u32) -> usize {
        let shift = u32::try_from(axis).unwrap_or(0).wrapping_mul(PER_AXIS).wrapping_add(bit);
        if self.0.before().wrapping_shr(shift) & 1 != 0 { 1 } else { 2 }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::drive::AxisInputs;

    proptest! {
        /// From the third sample on, the state of each contact is that of most of the last three samples, whatever the others are; from the
        /// first to the second it is that of the first ones. Nothing else of the inputs changes.
        #[test]
        fn the_state_is_that_of_two_of_three_samples(samples in prop::collection::vec(any::<[[bool; 3]; 3]>(), 3..40), probe in prop::collection::vec(any::<bool>(), 40)) {
            let mut debounce = Debounce::NEW;
            let inputs = |k: usize| {
                let axes = samples[k].map(|[negative, positive, home]| AxisInputs {
                    limits: [negative, positive], home, drive_fault: k.is_multiple_of(2), ..AxisInputs::NONE
                });
                Inputs { axes, probe_touched: probe[k], emergency_stop: k.is_multiple_of(3), ..Inputs::NONE }
            };
            for k in 0..samples.len() {
                let state = debounce.update(inputs(k));
                let most = |of: &dyn Fn(&Inputs<3>) -> bool| {
                    (0..3).filter(|back| of(&inputs(k.saturating_sub(*back)))).count() >= 2
                };
                let mut expected = inputs(k);
                for axis in 0..3 {
                    expected.axes[axis].limits = [0, 1].map(|end| most(&|inputs| inputs.axes[axis].limits[end]));
                    expected.axes[axis].home = most(&|inputs| inputs.axes[axis].home);
                }
                expected.probe_touched = most(&|inputs| inputs.probe_touched);
                prop_assert_eq!(state, expected, "sample {}", k);
            }
        }
    }

    /// The sample by which a contact is closed first: the one before, or the one before that with a bounce between; for each of its own.
    #[test]
    fn the_first_sample_that_agrees_is_known() {
        for (samples, ticks) in [([false, true, true], 1), ([true, false, true], 2)] {
            for contact in 0..3 {
                let mut debounce = Debounce::NEW;
                debounce.update(Inputs::<2>::NONE);
                let mut state = Inputs::<2>::NONE;
                for closed in samples {
                    let mut inputs = Inputs::<2>::NONE;
                    match contact {
                        2 => inputs.probe_touched = closed,
                        axis => inputs.axes[axis].home = closed,
                    }
                    state = debounce.update(inputs);
                }
                let closed = [state.axes[0].home, state.axes[1].home, state.probe_touched];
                assert_eq!(closed, [0, 1, 2].map(|other| other == contact));
                let since = [
                    debounce.ticks_since_home(0),
                    debounce.ticks_since_home(1),
                    debounce.ticks_since_touch(2),
                ];
                assert_eq!(since[contact], ticks, "contact {contact}");
            }
        }
    }

    /// Ten axes fill the word with the probe; the contacts of an eleventh are as read.
    #[test]
    fn contacts_beyond_the_word_do_not_wait() {
        let mut debounce = Debounce::NEW;
        debounce.update(Inputs::<11>::NONE);
        let closed = AxisInputs { limits: [true; 2], home: true, ..AxisInputs::NONE };
        let inputs = Inputs { axes: [closed; 11], probe_touched: true, ..Inputs::NONE };
        let first = debounce.update(inputs);
        assert!(first.axes[..10].iter().all(|axis| *axis == AxisInputs::NONE) && first.axes[10] == closed);
        assert!(!first.probe_touched);
        assert_eq!(debounce.update(inputs), inputs);
        assert_eq!((debounce.ticks_since_home(9), debounce.ticks_since_touch(11)), (1, 1));
    }
}
