//! The compensations of all axes of a machine.

use super::axis::{self, AxisCompensation};
use super::kind::Item;
use super::motion::Motion;
use crate::axis::Reading;
use crate::scalar::Scalar;
use crate::units::Position;

/// The compensations of a machine.
#[derive(Clone, Debug)]
pub struct Compensation<S: Scalar, const N: usize> {
    axes: [Option<AxisCompensation<S>>; N],
    states: [axis::State<S>; N],
    motions: [Motion<S>; N],
    any: bool,
}

impl<S: Scalar, const N: usize> Compensation<S, N> {
    /// None yet, of axes that stand at zero.
    pub const NONE: Self = Self {
        axes: [None; N],
        states: [axis::State::NEW; N],
        motions: [Motion::at(Position(0)); N],
        any: false,
    };

    /// None yet, of axes that stand at a place.
    #[must_use]
    pub fn none(start: [Position; N]) -> Self {
        Self { motions: start.map(Motion::at), ..Self::NONE }
    }

    /// Forgets all there is, for axes that stand at a place, in place: tables are large.
    pub fn reset(&mut self, start: &[Position; N]) {
        for axis in &mut self.axes {
            *axis = None;
        }
        self.states = [axis::State::NEW; N];
        self.motions = start.map(Motion::at);
        self.any = false;
    }

    /// Replaces what is compensated on an axis; what is corrected now goes over to it.
    pub fn replace(&mut self, axis: usize, made: AxisCompensation<S>) {
        if let Some(place) = self.axes.get_mut(axis) {
            *place = Some(made);
            self.any = true;
        }
    }

    /// Switches one compensation of an axis on or off.
    pub fn switch(&mut self, axis: usize, item: Item, on: bool) {
        if let Some(state) = self.states.get_mut(axis) {
            state.switch(item, on);
        }
    }

    /// Takes the axes to stand somewhere else.
    pub fn stand_at(&mut self, places: &[Position; N]) {
        self.motions = places.map(Motion::at);
    }

    /// What is added to the commands of axes that stand, position units.
    #[must_use]
    pub fn standing(&self) -> [i64; N] {
        self.states.each_ref().map(AxisCompensation::standing)
    }

    /// With every tick: the readings without what their resolvers add.
    pub fn readings(&mut self, readings: &[Reading; N]) -> [Reading; N] {
        let mut corrected = *readings;
        if self.any {
            for ((reading, axis), state) in corrected.iter_mut().zip(&self.axes).zip(&mut self.states) {
                if let Some(axis) = axis {
                    reading.motor = axis.reading(state, reading.motor);
                }
            }
        }
        corrected
    }

    /// With every command: what to add to it, position units.
    pub fn commands(&mut self, commands: &[Position; N]) -> [i64; N] {
        let mut corrections = [0; N];
        // Also without a compensation: one that is given under way goes on from how the axes move then.
        for (motion, command) in self.motions.iter_mut().zip(commands) {
            motion.step(*command);
        }
        if self.any {
            for (i, ((correction, axis), state)) in
                corrections.iter_mut().zip(&self.axes).zip(&mut self.states).enumerate()
            {
                if let Some(axis) = axis {
                    *correction = axis.command(state, i, &self.motions);
                }
            }
        }
        corrections
    }

    /// With every tick: what to add to the forces.
    pub fn forces(&mut self, readings: &[Reading; N]) -> [S; N] {
        let mut forces = [S::default(); N];
        if self.any {
            for (((force, axis), state), reading) in
                forces.iter_mut().zip(&self.axes).zip(&mut self.states).zip(readings)
            {
                if let Some(axis) = axis {
                    *force = axis.force(state, reading.motor);
                }
            }
        }
        forces
    }
}
