//! Evaluation of a slow term of an axis.

use super::axis::AxisCompensation;
use super::geometry::Straightness;
use super::kind::CompensationKind;
use super::pitch::Pitch;
use super::settings::PitchSource;
use super::slow::{Inputs, SlowTerm};
use super::state::State;
use crate::scalar::{Fixed, Scalar};

impl<S: Scalar> AxisCompensation<S> {
    /// Evaluates a slow term: at 1 m/s and 4 kHz with all seven on two axes, each of them is evaluated every 3.5 mm.
    #[inline(never)]
    pub(super) fn evaluate<const N: usize>(
        &self,
        term: SlowTerm,
        state: &mut State<S>,
        axis: usize,
        Inputs { motions, clock }: &Inputs<S, N>,
    ) {
        let Some(own) = motions.get(axis) else { return };
        let active = &state.active;
        match term {
            SlowTerm::Pitch => {
                let pitch = self.pitch.as_ref().filter(|_| active.has(CompensationKind::Pitch));
                let correction = pitch.map_or(S::ZERO, |pitch| pitch.correction(own));
                match self.pitch.as_ref().map(Pitch::source) {
                    Some(PitchSource::Scale) => state.slow.scale_pitch = correction,
                    _ => state.slow.screw_pitch = correction,
                }
                state.slow.add_up();
            }
            SlowTerm::Straightness => {
                let shape = self.straightness.as_ref().filter(|_| active.has(CompensationKind::Straightness));
                let correction = |(source, shape): &(u8, Straightness<S>)| {
                    shape.correction(motions.get(usize::from(*source)).unwrap_or(own))
                };
                state.slow.straightness = shape.map_or(S::ZERO, correction);
                state.slow.add_up();
            }
            SlowTerm::Intalk => {
                let talk = self.intalk.as_ref().filter(|_| active.has(CompensationKind::Intalk));
                state.slow.intalk = talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Crosstalk => {
                let talk = self.crosstalk.as_ref().filter(|_| active.has(CompensationKind::Crosstalk));
                state.slow.crosstalk = talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Drift => {
                let drift = self.drift.as_ref().filter(|_| active.has(CompensationKind::Drift));
                state.slow.drift =
                    drift.map_or(S::ZERO, |drift| drift.correction(clock.wrapping_sub(state.set_at)));
                state.slow.add_up();
            }
            SlowTerm::Load => {
                state.slow.load = self.load.as_ref().map_or(Fixed::ZERO, |load| load.at(own.position));
            }
            SlowTerm::AdditionalFriction => {
                let map = self.friction_map.as_ref().map_or(Fixed::ZERO, |map| map.at(own.position));
                let cold = self
                    .model
                    .as_ref()
                    .map_or(Fixed::ZERO, |model| model.cold_friction(clock.wrapping_sub(state.set_at)));
                state.slow.friction = map + cold;
            }
        }
    }
}
