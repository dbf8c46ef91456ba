//! Drives under the control of a host: what runs in every tick.

mod excitation;
mod feed_override;
mod following;
mod gantry;
mod halts;
mod measuring;
mod probing;
mod rest;
mod settings;
mod status;

use super::feed_override::FeedOverride;
use super::halt::Halt;
use super::history::FaultHistory;
use super::refusal::Refusal;
use super::report::{Activity, Times};
use super::stream::StreamQueue;
use super::watch::{HostWatch, Silence};
use crate::capture::{CaptureMemory, ChannelSteps, Quantisers};
use crate::drive::direction_check::DirectionCheckSettings;
use crate::drive::{AnyOutput, Board, DriveSignal, DriveSystem};
use crate::excitation::Excitation;
use crate::feedback::Reading;
use crate::figures::RmsMeter;
use crate::homing::{HardStopSettings, HomingError, HomingSettings};
use crate::interpolate::feed_hold::FeedState;
use crate::interpolate::{Block, PathError};
use crate::machine::Machine;
use crate::safety::{Fault, Power};
use crate::scalar::Scalar;
use crate::units::Position;

/// A drive system with the supervision of its host, a recording and a stream.
#[derive(Debug)]
pub struct HostedDrive<'m, S: Scalar, const N: usize> {
    system: DriveSystem<'m, S, N, AnyOutput<S>>,
    watch: HostWatch,
    activity: Activity,
    /// Blocks of the motion that have not been passed to the path yet.
    blocks_left: u16,
    jog_ticks: u32,
    /// Ticks until a jog at a speed ends.
    jog_remaining: Option<u32>,
    capture: CaptureMemory<'m, N>,
    stream: StreamQueue<N>,
    quantisers: Quantisers<N>,
    history: FaultHistory,
    feed_override: FeedOverride,
    /// The force by which a frequency response is measured.
    excitation: Option<Excitation<S>>,
    /// What somebody without the session has asked for, as long as the host of the session has not been told.
    halted_by_other: Option<Halt>,
    tick: u64,
    readings: [Reading; N],
    /// Forces since the last tick.
    forces: [S; N],
    /// Sums of squares of following errors and forces, over a second.
    rms_meter: RmsMeter<N>,
}

impl<'m, S: Scalar, const N: usize> HostedDrive<'m, S, N> {
    /// Drives off, without a host, with a memory for recordings.
    #[must_use]
    pub fn new(
        system: DriveSystem<'m, S, N, AnyOutput<S>>,
        tick_hz: u32,
        times: Times,
        steps: &ChannelSteps<N>,
        capture: &'m mut [u8],
    ) -> Self {
        let ticks = |ms: u16| (u32::from(ms) * (tick_hz / 100) / 10).max(1);
        Self {
            system: system.enabled_by_host(),
            watch: HostWatch::new(ticks(times.hold_ms), ticks(times.off_ms)),
            activity: Activity::Idle,
            blocks_left: 0,
            jog_ticks: ticks(times.jog_ms),
            jog_remaining: None,
            capture: CaptureMemory::new(capture),
            stream: StreamQueue::OFF,
            quantisers: Quantisers::new(steps),
            history: FaultHistory::EMPTY,
            feed_override: FeedOverride::NONE,
            excitation: None,
            halted_by_other: None,
            tick: 0,
            readings: [Reading { motor: Position(0), table: None }; N],
            forces: [S::ZERO; N],
            rms_meter: RmsMeter::new(tick_hz),
        }
    }

    /// One tick. It cannot fail.
    pub fn tick(&mut self, board: &mut impl Board<N, DriveSignal>) {
        self.supervise();
        self.excite();
        let tick = self.system.tick(board);
        let machine = self.system.machine();
        let power = machine.power();
        self.history.update(self.tick, power, machine.warning());
        let aligned = !power.is_on() || machine.was_position_tick();
        let captured = self.capture.takes(self.tick, !tick.output.done, aligned);
        let streamed = self.stream.takes(self.tick, aligned);
        if captured || streamed {
            // The forces that acted during the tick that ends with these readings.
            let sample = self.quantisers.sample(&tick.output.commands, &tick.readings, &self.forces);
            if captured {
                self.capture.append(&sample);
            }
            if streamed {
                self.stream.append(&sample);
            }
        }
        self.readings = tick.readings;
        self.forces = if power.is_on() { tick.output.forces } else { [S::ZERO; N] };
        let runs_sequence = self.system.runs_sequence();
        if self.excitation.is_some() {
            // A fault ends it, also one that stops a path and lets the drives on.
            if power != Power::On {
                self.end_excitation();
            }
        } else if !power.is_on() || machine.is_at_rest() && self.blocks_left == 0 && !runs_sequence {
            (self.activity, self.jog_remaining) = (Activity::Idle, None);
        }
        if !power.is_on() {
            self.blocks_left = 0;
            self.end_override();
        }
        self.measure(&tick.output.commands);
        self.tick += 1;
    }

    /// Reacts to the silence of the host, and to a jog that was not renewed.
    fn supervise(&mut self) {
        if self.watch.is_gone() {
            self.system.expire_direction_check();
        }
        match self.watch.tick(self.machine().power().is_on()) {
            Some(Silence::Hold) if !self.machine().is_at_rest() => {
                self.machine_mut().hold();
                self.history.held(self.tick);
            }
            Some(Silence::Hold) => self.end_excitation(),
            // Nothing is interrupted that somebody would have to acknowledge.
            Some(Silence::Off) if self.machine().power() == Power::On && self.is_at_rest().is_ok() => {
                self.machine_mut().disable_in_order();
                self.history.switched_off(self.tick);
            }
            // The drives go off by themselves.
            Some(Silence::Off) if matches!(self.machine().power(), Power::Disabling(_)) => {}
            Some(Silence::Off) => {
                self.machine_mut().fault(Fault::HostSilent);
            }
            _ => {}
        }
        match &mut self.jog_remaining {
            Some(0) => {
                self.system.machine_mut().discard_path();
                self.jog_remaining = None;
            }
            Some(remaining) => *remaining -= 1,
            None => {}
        }
    }

    /// A request of the present session has been received.
    pub const fn heard(&mut self) {
        self.watch.heard();
    }

    /// A session was opened; a request has to follow ([`HostWatch::greeted`]). A direction check, an excitation and the
    /// override of the previous one end, and what its host was to be told is not told to another one.
    pub fn greeted(&mut self) {
        self.watch.greeted();
        self.halted_by_other = None;
        self.end_override();
        self.end_excitation();
        self.system.expire_direction_check();
    }

    /// Whether no host has opened a session or sent a request for [`Times::hold_ms`].
    #[must_use]
    pub const fn host_is_silent(&self) -> bool {
        self.watch.is_silent()
    }

    /// Ticks since the start.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.tick
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &Machine<S, N> {
        self.system.machine()
    }

    /// The machine, for blocks and compensations.
    pub const fn machine_mut(&mut self) -> &mut Machine<S, N> {
        self.system.machine_mut()
    }

    /// Enables the drives with the next tick; no effect if they are on.
    ///
    /// # Errors
    /// [`Refusal::Faulted`], [`Refusal::NotArmed`], [`Refusal::BrakesMove`].
    pub fn enable(&mut self) -> Result<(), Refusal> {
        let power = self.machine().power();
        if let Some(fault) = power.fault() {
            return Err(Refusal::Faulted(fault));
        }
        match power {
            Power::Off => self.system.enable_by_host().map_err(Refusal::NotArmed),
            Power::On | Power::Enabling => Ok(()),
            _ => Err(Refusal::BrakesMove),
        }
    }

    /// Acknowledges a fault.
    ///
    /// # Errors
    /// [`Refusal::DrivesOn`].
    pub fn clear(&mut self) -> Result<(), Refusal> {
        if self.machine().power().is_on() {
            return Err(Refusal::DrivesOn);
        }
        self.machine_mut().disable();
        Ok(())
    }

    /// Whether a motion or a jog could start.
    ///
    /// # Errors
    /// [`Refusal::DrivesOff`], [`Refusal::Faulted`], [`Refusal::BrakesMove`], [`Refusal::Moving`].
    pub fn can_start(&self) -> Result<(), Refusal> {
        let power = self.machine().power();
        if let Some(fault) = power.fault() {
            return Err(Refusal::Faulted(fault));
        }
        match power {
            Power::On => self.is_at_rest(),
            Power::Off => Err(Refusal::DrivesOff),
            _ => Err(Refusal::BrakesMove),
        }
    }

    /// Whether nothing moves.
    ///
    /// # Errors
    /// [`Refusal::Moving`].
    pub fn is_at_rest(&self) -> Result<(), Refusal> {
        let machine = self.machine();
        let is_idle = machine.is_at_rest() && self.activity == Activity::Idle;
        if is_idle && machine.feed_state() == FeedState::Running { Ok(()) } else { Err(Refusal::Moving) }
    }

    /// Starts a motion of a number of blocks, which the server passes to the path, and which permits an override up to a value.
    pub fn start_motion(&mut self, blocks: u16, most_percent: u8) {
        (self.activity, self.blocks_left) = (Activity::Motion, blocks);
        self.permit_override(most_percent);
    }

    /// The activity that a block, which has just been appended, belongs to. A jog at a speed needs renewals; it permits an override up
    /// to a value.
    pub fn start_jog(&mut self, at_speed: bool, most_percent: u8) {
        self.activity = Activity::Jog;
        self.permit_override(most_percent);
        self.jog_remaining = at_speed.then_some(self.jog_ticks);
    }

    /// Renews a jog at a speed. False if none runs.
    pub const fn renew_jog(&mut self) -> bool {
        if let Some(remaining) = &mut self.jog_remaining {
            *remaining = self.jog_ticks;
            return true;
        }
        false
    }

    /// What the axes do.
    #[must_use]
    pub const fn activity(&self) -> Activity {
        self.activity
    }

    /// Blocks of the motion that have not been passed to the path yet.
    #[must_use]
    pub const fn blocks_left(&self) -> u16 {
        self.blocks_left
    }

    /// A block of the motion has been passed to the path.
    pub const fn block_passed(&mut self) {
        self.blocks_left = self.blocks_left.saturating_sub(1);
    }

    /// Continues after a hold.
    ///
    /// # Errors
    /// [`Refusal::NotHeld`].
    pub fn resume(&mut self) -> Result<(), Refusal> {
        match self.machine().feed_state() {
            FeedState::Holding | FeedState::Held => {
                self.machine_mut().resume();
                Ok(())
            }
            _ => Err(Refusal::NotHeld),
        }
    }

    /// Starts to home an axis.
    ///
    /// # Errors
    /// As [`HostedDrive::can_start`]; [`Refusal::SecondMotor`], [`Refusal::Homing`].
    pub fn home(&mut self, axis: usize, settings: &HomingSettings) -> Result<(), Refusal> {
        self.has_own_command(axis)?;
        self.can_start()?;
        let started = self.system.home(axis, settings);
        self.homing_started(started)
    }

    /// Starts to home an axis to a hard stop.
    ///
    /// # Errors
    /// As [`HostedDrive::home`].
    pub(in crate::link) fn home_to_stop(
        &mut self,
        axis: usize,
        settings: &HardStopSettings,
    ) -> Result<(), Refusal> {
        self.has_own_command(axis)?;
        self.can_start()?;
        if !self.system.follows_force(axis) {
            return Err(Refusal::NotAvailable);
        }
        let started = self.system.home_to_stop(axis, settings);
        self.homing_started(started)
    }

    fn homing_started(&mut self, started: Result<(), HomingError>) -> Result<(), Refusal> {
        started.map_err(|error| Refusal::Homing(error.into()))?;
        self.activity = Activity::Homing;
        // Its speeds are those at which it finds its mark or stop.
        self.permit_override(100);
        Ok(())
    }

    /// Prepares a check of the direction of an axis.
    ///
    /// # Errors
    /// [`Refusal::Direction`], [`Refusal::NoSuchAxis`].
    pub fn check_direction(&mut self, axis: usize, settings: &DirectionCheckSettings) -> Result<(), Refusal> {
        if axis >= N {
            return Err(Refusal::NoSuchAxis);
        }
        Ok(self.system.check_direction(axis, settings)?)
    }

    /// Whether a direction check waits for the enable switch or pushes.
    #[must_use]
    pub fn is_checking(&self) -> bool {
        self.system.is_checking()
    }

    /// The motion that a homing or a probing waits for.
    #[must_use]
    pub fn leg(&self) -> Option<Block<N>> {
        self.system.leg()
    }

    /// The motion that a homing or a probing waited for was appended to the path, or rejected.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        self.system.leg_planned(planned);
    }

    /// The recording.
    pub const fn capture(&mut self) -> &mut CaptureMemory<'m, N> {
        &mut self.capture
    }

    /// The stream.
    pub const fn stream(&mut self) -> &mut StreamQueue<N> {
        &mut self.stream
    }

    /// The last faults and warnings.
    #[must_use]
    pub const fn history(&self) -> &FaultHistory {
        &self.history
    }

    /// A fault of the board itself.
    pub fn fault(&mut self, fault: Fault) {
        self.machine_mut().fault(fault);
    }
}
