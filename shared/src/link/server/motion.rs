//! Motions and jogs.

use super::super::HostedDrive;
use super::super::message::{Jog, PerAxis};
use super::super::port::SharedDrive;
use super::super::refusal::Refusal;
use super::super::report::Activity;
use super::block_limits::{SPEED_SHARE, axis_speeds, most_percent};
use super::state::{Motion, ServerState};
use crate::homing::HomingSettings;
use crate::interpolate::feed_hold::MOST_PERCENT;
use crate::interpolate::{Block, BlockOf, PathError};
use crate::scalar::Scalar;
use crate::units::{Position, TRAVEL_LIMIT_M};

/// Attempts to append a block while the path goes on to its next block.
const ATTEMPTS: usize = 4;

impl<const N: usize> Motion<N> {
    /// Plans a block on a copy of the queue and passes it to the path, with `and_then` in the same access. A relative block also
    /// moves axes that are not homed.
    fn append<'m, S: Scalar>(
        &mut self,
        block: &Block<N>,
        relative: bool,
        drive: &mut impl SharedDrive<'m, S, N>,
        and_then: impl Fn(&mut HostedDrive<'m, S, N>),
    ) -> Result<(), PathError> {
        for _ in 0..ATTEMPTS {
            let not_homed = drive.with(|drive| drive.machine().copy_queue(&mut self.plan))?;
            let not_homed = if relative { [false; N] } else { not_homed };
            self.plan.push_holding(block, &not_homed)?;
            let adopted: Result<bool, PathError> = drive.with(|drive| {
                let adopted = drive.machine_mut().adopt_queue(&self.plan)?;
                if adopted {
                    and_then(drive);
                }
                Ok(adopted)
            });
            if adopted? {
                return Ok(());
            }
        }
        Err(PathError::QueueFull)
    }
}

impl<const N: usize> ServerState<N> {
    /// Discards the blocks. The next motion starts from the present command.
    pub(super) fn new_motion<'m, S: Scalar>(
        &mut self,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let start = drive.with(|drive| drive.is_at_rest().map(|()| drive.machine().command()))?;
        self.motion.blocks.clear();
        self.motion.most_percent = MOST_PERCENT;
        (self.motion.start, self.motion.end) = (start, start);
        Ok(())
    }

    /// Checks a block behind the previous ones and keeps it.
    pub(super) fn add_block<'m, S: Scalar>(
        &mut self,
        block: &BlockOf<PerAxis<f64>>,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let board = u8::try_from(N).unwrap_or(u8::MAX);
        let block = &block.of_axes().ok_or(Refusal::Axes { board })?;
        let number = u16::try_from(self.motion.blocks.len()).unwrap_or(u16::MAX);
        if self.motion.blocks.is_full() {
            return Err(Refusal::MotionFull { max: number });
        }
        // A motion that runs is not changed.
        let refused = |error| Refusal::Path { block: number, error };
        let not_homed = drive.with(|drive| {
            if drive.activity() == Activity::Motion {
                return Err(Refusal::Moving);
            }
            drive.machine().copy_queue(&mut self.motion.plan).map_err(refused)
        })?;
        self.check_speed(block, number)?;
        let end = self.motion.plan.check(block, self.motion.end, &not_homed).map_err(refused)?;
        let permitted = most_percent(block, self.motion.end, &self.settings);
        self.motion.most_percent = self.motion.most_percent.min(permitted);
        // The capacity was checked.
        let _ = self.motion.blocks.push(*block);
        self.motion.end = end;
        Ok(())
    }

    /// Refuses a block in which an axis is as fast as a motor can be.
    fn check_speed(&self, block: &Block<N>, number: u16) -> Result<(), Refusal> {
        let speeds = axis_speeds(block, self.motion.end);
        for ((axis, settings), speed) in (0..).zip(&self.settings.axes).zip(speeds) {
            let limit_m_per_s =
                settings.fastest_m_per_s.map_or(f64::INFINITY, |fastest| SPEED_SHARE * fastest);
            // A feed that is no number is refused when the block is planned.
            if speed > limit_m_per_s {
                return Err(Refusal::TooFast { block: number, axis, limit_m_per_s });
            }
        }
        Ok(())
    }

    /// Starts the motion; its blocks are passed to the path one by one.
    pub(super) fn start_motion<'m, S: Scalar>(
        &mut self,
        blocks: u16,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let found = u16::try_from(self.motion.blocks.len()).unwrap_or(u16::MAX);
        if blocks != found || found == 0 {
            return Err(Refusal::BlockCount { found });
        }
        let (start, most_percent) = (self.motion.start, self.motion.most_percent);
        drive.with(|drive| {
            drive.can_start()?;
            if drive.machine().command() != start {
                return Err(Refusal::Displaced);
            }
            drive.start_motion(found, most_percent);
            Ok(())
        })
    }

    /// Passes the next block of a motion that runs to the path.
    pub(super) fn feed_motion<'m, S: Scalar>(&mut self, drive: &mut impl SharedDrive<'m, S, N>) {
        let left = drive.with(|drive| {
            let runs = drive.activity() == Activity::Motion && drive.machine().has_room();
            if runs { drive.blocks_left() } else { 0 }
        });
        let count = self.motion.blocks.len();
        let Some(number) = count.checked_sub(usize::from(left)).filter(|_| left > 0) else { return };
        let Some(block) = self.motion.blocks.get(number).copied() else { return };
        match self.motion.append(&block, false, drive, HostedDrive::block_passed) {
            Ok(()) | Err(PathError::QueueFull) => {}
            // It was checked, so that this is a stop of the path meanwhile: the rest is discarded.
            Err(_) => drive.with(HostedDrive::stop),
        }
    }

    /// Starts to home an axis, with the other motor of its gantry.
    pub(super) fn home<'m, S: Scalar>(
        &mut self,
        axis: u8,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let axis = usize::from(axis);
        let settings_of = |axis: usize| -> Result<&HomingSettings, Refusal> {
            let settings = self.identity.homing.get(axis).ok_or(Refusal::NoSuchAxis)?;
            settings.as_ref().ok_or(Refusal::NotAvailable)
        };
        let settings = settings_of(axis)?;
        let Some(second) = drive.with(|drive| drive.machine().second_motor(axis)) else {
            return drive.with(|drive| drive.home(axis, settings));
        };
        let both = [settings, settings_of(second)?];
        let gantry = self.settings.axes.get(second).and_then(|axis| axis.gantry);
        let offset_m = gantry.ok_or(Refusal::NoSuchAxis)?.reference_offset_m;
        drive.with(|drive| drive.home_gantry(axis, both, offset_m))
    }

    /// Plans the next motion of a homing or a probing that waits for it.
    pub(super) fn feed_legs<'m, S: Scalar>(&mut self, drive: &mut impl SharedDrive<'m, S, N>) {
        let Some(leg) = drive.with(|drive| drive.leg()) else { return };
        let planned = self.motion.append(&leg, true, drive, |_| {});
        drive.with(|drive| drive.leg_planned(planned));
    }

    /// Jogs an axis, or renews the jog.
    pub(super) fn jog<'m, S: Scalar>(
        &mut self,
        jog: &Jog,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let at_speed = jog.distance_m.is_none();
        if at_speed && self.motion.jog == Some(*jog) && drive.with(HostedDrive::renew_jog) {
            return Ok(());
        }
        let axis = usize::from(jog.axis);
        let settings = self.settings.axes.get(axis).ok_or(Refusal::NoSuchAxis)?;
        let start = drive.with(|drive| {
            drive.has_own_command(axis)?;
            drive.can_start().map(|()| drive.machine().command())
        })?;
        let mut to_m = start.map(Position::to_m);
        let [least_m, greatest_m] = settings.travel_m.unwrap_or([-TRAVEL_LIMIT_M, TRAVEL_LIMIT_M]);
        if let Some(coordinate) = to_m.get_mut(axis) {
            *coordinate = if let Some(distance_m) = jog.distance_m {
                *coordinate + distance_m
            } else {
                let travel_m = libm::copysign(Jog::MAX_TRAVEL_M, jog.velocity_m_per_s);
                (*coordinate + travel_m).max(least_m).min(greatest_m)
            };
        }
        let block = Block::line(to_m, libm::fabs(jog.velocity_m_per_s), jog.acceleration_m_per_s2);
        self.motion.end = start;
        self.check_speed(&block, 0)?;
        let permitted = most_percent(&block, start, &self.settings);
        let refused = |error| Refusal::Path { block: 0, error };
        let and_then = |drive: &mut HostedDrive<'m, S, N>| drive.start_jog(at_speed, permitted);
        self.motion.append(&block, true, drive, and_then).map_err(refused)?;
        self.motion.jog = at_speed.then_some(*jog);
        Ok(())
    }
}
