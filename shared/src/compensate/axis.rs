//! The compensations of one axis: what they compute in a tick.

use super::active::Active;
use super::backlash::Backlash;
use super::cycles::Cycles;
use super::drift::Drift;
use super::force::{Force, Surroundings};
use super::geometry::{Squareness, Straightness};
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use super::pitch::Pitch;
use super::products::Products;
use super::reversal::Reversal;
use super::round_robin::{Inputs, RoundRobinList};
use super::slew::Slew;
use super::state::{RoundRobinTerms, State};
use super::table::Table;
use super::talk::Talk;
use crate::scalar::{Fixed, Scalar};
use crate::units::Position;

/// The compensations of one axis.
// In this order: one instruction reaches the first 4 KiB, and the tables of the round-robin terms are read in turn.
#[repr(C)]
// Its copy needs no stack.
#[derive(Clone, Copy, Debug)]
pub struct AxisCompensation<S: Scalar> {
    /// Of the command, per position tick.
    pub(super) command: Slew<S>,
    /// Of the motor reading, per tick.
    pub(super) reading: Slew<S>,
    /// Of the force, per tick.
    pub(super) force: Slew<S>,
    /// The axes that the cross-talk and the squareness come from.
    pub(super) crosstalk_source: u8,
    pub(super) squareness_source: u8,
    /// The round-robin terms that there are.
    pub(super) round_robin: RoundRobinList,
    pub(super) reversal: Option<Reversal<S>>,
    pub(super) dividing: Cycles<S>,
    pub(super) ripple: Cycles<S>,
    pub(super) screw: Cycles<S>,
    /// Force feed-forward, with its tables over the position.
    pub(super) model: Option<Force>,
    pub(super) backlash: Option<Backlash<S>>,
    /// Error units per N on the table.
    pub(super) stretch: Option<S::Gain>,
    pub(super) squareness: Option<Squareness<S>>,
    pub(super) pitch: Option<Pitch<S>>,
    pub(super) intalk: Option<Talk<S>>,
    pub(super) crosstalk: Option<Talk<S>>,
    pub(super) straightness: Option<(u8, Straightness<S>)>,
    pub(super) load: Option<Table<Fixed>>,
    pub(super) friction_map: Option<Table<Fixed>>,
    pub(super) drift: Option<Drift<S>>,
    pub(super) products: Products<S>,
}

impl<S: Scalar> AxisCompensation<S> {
    /// No compensation.
    pub const NONE: Self = Self {
        command: Slew::ZERO,
        reading: Slew::ZERO,
        force: Slew::ZERO,
        crosstalk_source: 0,
        squareness_source: 0,
        round_robin: RoundRobinList::EMPTY,
        reversal: None,
        dividing: Cycles::NONE,
        ripple: Cycles::NONE,
        screw: Cycles::NONE,
        model: None,
        backlash: None,
        stretch: None,
        squareness: None,
        pitch: None,
        intalk: None,
        crosstalk: None,
        straightness: None,
        load: None,
        friction_map: None,
        drift: None,
        products: Products::NONE,
    };

    /// The kinds that there are, one bit for each.
    // A table and no match of a kind: its jump table would have a trap, and the tick has none.
    fn kinds(&self) -> u32 {
        let present = [
            (CompensationKind::Pitch, self.pitch.is_some()),
            (CompensationKind::Backlash, self.backlash.is_some()),
            (CompensationKind::Dividing, !self.dividing.is_empty()),
            (CompensationKind::Reversal, self.reversal.is_some()),
            (CompensationKind::Intalk, self.intalk.is_some()),
            (CompensationKind::Crosstalk, self.crosstalk.is_some()),
            (CompensationKind::Squareness, self.squareness.is_some()),
            (CompensationKind::Straightness, self.straightness.is_some()),
            (CompensationKind::Ripple, !self.ripple.is_empty()),
            (CompensationKind::Screw, !self.screw.is_empty()),
            (CompensationKind::Force, self.model.is_some()),
            (CompensationKind::Stretch, self.stretch.is_some()),
            (CompensationKind::Drift, self.drift.is_some()),
            (CompensationKind::Products, !self.products.is_empty()),
        ];
        present.into_iter().fold(0, |bits, (kind, is_present)| bits | u32::from(is_present) << kind as u32)
    }

    /// Lists what a tick computes. To be called when a compensation is set or switched.
    pub(super) fn activate(&self, state: &mut State<S>) {
        let mut active = Active::listed(self.model.is_some(), state.switched_on(self.kinds()));
        if let Some(backlash) = self.backlash.as_ref().filter(|_| active.has(CompensationKind::Backlash)) {
            active.half_backlash = backlash.half();
        }
        if let Some(stretch) = self.stretch.filter(|_| active.has(CompensationKind::Stretch)) {
            active.stretch = stretch;
        }
        if let Some(squareness) =
            self.squareness.as_ref().filter(|_| active.has(CompensationKind::Squareness))
        {
            active.squareness = squareness.minus_k();
        }
        if !active.has(CompensationKind::Reversal) {
            (state.pulse, state.pulse_force) = (S::ZERO, S::ZERO);
        }
        state.active = active;
    }

    /// Evaluates all round-robin terms, and starts the force model with the present motion: for a compensation that has just been
    /// set. Not part of a tick.
    pub(super) fn start<const N: usize>(&self, state: &mut State<S>, axis: usize, inputs: &Inputs<S, N>) {
        (state.round_robin, state.set_at) = (RoundRobinTerms::NONE, inputs.clock);
        for term in self.round_robin.iter() {
            self.evaluate(term, state, axis, inputs);
        }
        if let (Some(model), Some(own)) = (&self.model, inputs.motions.get(axis)) {
            model.start(&mut state.model, own);
        }
    }

    /// Computes the correction of the command, once per command.
    #[inline(never)]
    pub(super) fn correct_command<const N: usize>(
        &self,
        state: &mut State<S>,
        axis: usize,
        motions: &[CommandMotion<S>; N],
    ) {
        let Some(own) = motions.get(axis) else { return };
        let acceleration_of =
            |axis: u8| motions.get(usize::from(axis)).map_or(S::ZERO, |motion| motion.acceleration);
        self.forces_of_motion(state, own);
        let mut screw = Self::screw_correction(state, own);
        let round_robin = &state.round_robin;
        let mut sum = own.acceleration * round_robin.intalk
            + acceleration_of(self.crosstalk_source) * round_robin.crosstalk;
        if let Some(other) = motions.get(usize::from(self.squareness_source)) {
            sum += S::from_position(other.position) * state.active.squareness;
        }
        let mut tool = round_robin.tool + S::round(sum);
        if state.active.has_rare() {
            if state.active.has(CompensationKind::Screw) {
                screw = screw - self.screw.at(own.position);
            }
            if state.active.has(CompensationKind::Products) {
                tool = tool + self.products.correction(motions);
            }
        }
        self.command.step(&mut state.screw, screw);
        self.command.step(&mut state.command, screw + tool);
    }

    /// The correction for errors between motor and scale, error units, before bound and rate.
    #[inline]
    fn screw_correction(state: &State<S>, own: &CommandMotion<S>) -> S {
        let active = &state.active;
        let backlash = if own.forward { active.half_backlash } else { -active.half_backlash };
        let mut screw = state.round_robin.screw_pitch + backlash;
        if active.has_model() {
            screw = screw + S::round(S::from_fixed(state.model.on_table) * active.stretch);
        }
        screw
    }

    /// The forces that depend on the commanded motion: the pulse at a reversal, and the feed-forward.
    #[inline]
    fn forces_of_motion(&self, state: &mut State<S>, own: &CommandMotion<S>) {
        if state.active.has(CompensationKind::Reversal)
            && let Some(reversal) = &self.reversal
        {
            state.pulse_force = reversal.force(&mut state.pulse, own);
        }
        if state.active.has_model()
            && let Some(model) = &self.model
        {
            let (load, friction) = (state.round_robin.load, state.round_robin.friction);
            model.update(&mut state.model, own.position, Surroundings { load, friction });
        }
    }

    /// The motor reading with the error of the resolver corrected, once per tick.
    #[inline]
    pub(super) fn reading(&self, state: &mut State<S>, motor: Position) -> Position {
        let mut error = S::ZERO;
        if state.active.has(CompensationKind::Dividing) {
            error = self.dividing.at(motor);
        } else if state.reading == error {
            // A previous correction has returned to zero.
            return motor;
        }
        motor - self.reading.step(&mut state.reading, error).distance()
    }

    /// The force to add, once per tick.
    #[inline(never)]
    pub(super) fn force(&self, state: &mut State<S>, motor: Position) -> S {
        let target = self.force_target(state, motor);
        self.force.step(&mut state.force, target)
    }

    /// Sets the force to what it approaches, without its limited rate, and returns it.
    pub(super) fn settle_force(&self, state: &mut State<S>, motor: Position) -> S {
        state.force = self.force_target(state, motor).clamp_magnitude(self.force.bound);
        state.force
    }

    #[inline]
    fn force_target(&self, state: &State<S>, motor: Position) -> S {
        let mut target = state.pulse_force;
        if state.active.has(CompensationKind::Force) {
            target = target + S::from_fixed(state.model.applied);
        }
        if state.active.has(CompensationKind::Ripple) {
            target = target - self.ripple.at(motor);
        }
        target
    }
}
