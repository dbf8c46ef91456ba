//! Evaluation of a round-robin term of an axis.

use super::axis::AxisCompensation;
use super::geometry::Straightness;
use super::kind::CompensationKind;
use super::pitch::Pitch;
use super::round_robin::{Inputs, RoundRobinTerm};
use super::settings::PitchSource;
use super::state::State;
use crate::scalar::{Fixed, Scalar};

impl<S: Scalar> AxisCompensation<S> {
    /// Evaluates a round-robin term: at 1 m/s and 4 kHz with all seven on two axes, each of them is evaluated every 3.5 mm.
    #[inline(never)]
    pub(super) fn evaluate<const N: usize>(
        &self,
        term: RoundRobinTerm,
        state: &mut State<S>,
        axis: usize,
        Inputs { motions, clock }: &Inputs<S, N>,
    ) {
        let Some(own) = motions.get(axis) else { return };
        let active = &state.active;
        match term {
            RoundRobinTerm::Pitch => {
                let pitch = self.pitch.as_ref().filter(|_| active.has(CompensationKind::Pitch));
                let correction = pitch.map_or(S::ZERO, |pitch| pitch.correction(own));
                match self.pitch.as_ref().map(Pitch::source) {
                    Some(PitchSource::Scale) => state.round_robin.scale_pitch = correction,
                    _ => state.round_robin.screw_pitch = correction,
                }
                state.round_robin.add_up();
            }
            RoundRobinTerm::Straightness => {
                let shape = self.straightness.as_ref().filter(|_| active.has(CompensationKind::Straightness));
                let correction = |(source, shape): &(u8, Straightness<S>)| {
                    shape.correction(motions.get(usize::from(*source)).unwrap_or(own))
                };
                state.round_robin.straightness = shape.map_or(S::ZERO, correction);
                state.round_robin.add_up();
            }
            RoundRobinTerm::Intalk => {
                let talk = self.intalk.as_ref().filter(|_| active.has(CompensationKind::Intalk));
                state.round_robin.intalk =
                    talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            RoundRobinTerm::Crosstalk => {
                let talk = self.crosstalk.as_ref().filter(|_| active.has(CompensationKind::Crosstalk));
                state.round_robin.crosstalk =
                    talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            RoundRobinTerm::Drift => {
                let drift = self.drift.as_ref().filter(|_| active.has(CompensationKind::Drift));
                state.round_robin.drift =
                    drift.map_or(S::ZERO, |drift| drift.correction(clock.wrapping_sub(state.set_at)));
                state.round_robin.add_up();
            }
            RoundRobinTerm::Load => {
                state.round_robin.load = self.load.as_ref().map_or(Fixed::ZERO, |load| load.at(own.position));
            }
            RoundRobinTerm::AdditionalFriction => {
                let map = self.friction_map.as_ref().map_or(Fixed::ZERO, |map| map.at(own.position));
                let cold = self
                    .model
                    .as_ref()
                    .map_or(Fixed::ZERO, |model| model.cold_friction(clock.wrapping_sub(state.set_at)));
                state.round_robin.friction = map + cold;
            }
        }
    }
}
