//! The controller with its power stages, enable switch and status light.

use super::amplifier::Amplifier;
use super::board::Board;
use super::debounce::Debounce;
use super::direction_check::DirectionCheck;
use super::enable_switch::{EnableSwitch, SwitchEvent};
use super::enabling::{Enabling, NotArmed};
use super::inputs::{Inputs, Supply, SupplyLimits};
use super::limit_guard::LimitGuard;
use super::output::{Demand, DriveOutput};
use super::sequence::Sequence;
use super::status_light::StatusLight;
use super::tick_watch::{TickClock, TickCounts, TickWatch};
use crate::feedback::{OriginShift, Reading};
use crate::figures::Thermistor;
use crate::machine::{Machine, Output};
use crate::safety::{Fault, FaultKind};
use crate::scalar::Scalar;
use crate::units::Position;

/// A direction check with the force of its axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionCheckRun<S, const N: usize> {
    pub check: DirectionCheck<N>,
    pub force: S,
}

/// A machine with its power stages, enable switch and status light. The machine, which is large, is borrowed.
#[derive(Debug)]
pub struct DriveSystem<'m, S: Scalar, const N: usize, O = Amplifier<S>> {
    machine: &'m mut Machine<S, N>,
    pub(super) outputs: [O; N],
    switch: EnableSwitch,
    light: StatusLight,
    /// The direction check that runs or that ran last.
    pub(super) direction_check_run: Option<DirectionCheckRun<S, N>>,
    enabling: Enabling,
    supply_limits: SupplyLimits,
    /// The thermistor of the power stages, whose counts are among the inputs.
    thermistor: Option<Thermistor>,
    limit_guard: LimitGuard<N>,
    pub(super) tick_watch: TickWatch,
    /// Origin of each axis, from the position at power-up.
    pub(super) origins: [OriginShift; N],
    /// The homing or probing that runs or that ran last, and its axis.
    pub(super) sequence: Option<(usize, Sequence)>,
    /// Forces of the last tick.
    pub(super) forces: [S; N],
    inputs: Inputs<N>,
    pub(super) debounce: Debounce,
    /// The limit switches as they are read, for a direction check.
    pub(super) limit_samples: [[bool; 2]; N],
    /// The last tick, and the one before it.
    recent: [Moment<N>; 2],
    readings: [Reading; N],
    /// Whether the last tick has enabled the power stages.
    stages_enabled: bool,
}

/// What the axes were at the start of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<const N: usize> {
    /// Readings from power-up.
    pub readings: [Reading; N],
    /// Commands.
    pub commands: [Position; N],
}

impl<const N: usize> Moment<N> {
    /// Before the first tick.
    const NONE: Self =
        Self { readings: [Reading { motor: Position(0), table: None }; N], commands: [Position(0); N] };
}

/// What a tick has read and computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick<S, const N: usize> {
    /// Readings of all axes.
    pub readings: [Reading; N],
    /// Result of the controller.
    pub output: Output<S, N>,
}

impl<'m, S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'m, S, N, O> {
    /// Drives off until the switch is opened and closed.
    #[must_use]
    pub const fn new(
        machine: &'m mut Machine<S, N>,
        outputs: [O; N],
        switch: EnableSwitch,
        light: StatusLight,
    ) -> Self {
        Self {
            machine,
            outputs,
            switch,
            light,
            supply_limits: SupplyLimits::NONE,
            thermistor: None,
            limit_guard: LimitGuard::new(),
            tick_watch: TickWatch::new(None),
            origins: [OriginShift { motor: 0, table: 0 }; N],
            sequence: None,
            forces: [S::ZERO; N],
            direction_check_run: None,
            inputs: Inputs::NONE,
            debounce: Debounce::NEW,
            limit_samples: [[false; 2]; N],
            recent: [Moment::NONE; 2],
            readings: Moment::<N>::NONE.readings,
            enabling: Enabling::BySwitch,
            stages_enabled: false,
        }
    }

    /// Lets a host enable the drives: closing the switch then only permits it.
    #[must_use]
    pub const fn enabled_by_host(mut self) -> Self {
        self.enabling = Enabling::ByHost { armed: false };
        self
    }

    /// Enables the drives at the next tick, for a host. No effect until a fault is acknowledged.
    ///
    /// # Errors
    /// As [`DriveSystem::armed`].
    pub fn enable_by_host(&mut self) -> Result<(), NotArmed> {
        self.armed()?;
        self.machine.enable();
        Ok(())
    }

    /// Whether a host may enable the drives.
    ///
    /// # Errors
    /// [`NotArmed`]: what does not permit it.
    pub const fn armed(&self) -> Result<(), NotArmed> {
        match self.enabling {
            _ if self.inputs.emergency_stop => Err(NotArmed::EmergencyStop),
            Enabling::ByHost { armed: true } => Ok(()),
            Enabling::ByHost { armed: false } | Enabling::BySwitch => Err(NotArmed::Switch),
        }
    }

    /// Whether the last tick has enabled the power stages: they remain so until the next one, also if the drives have been disabled
    /// since.
    #[must_use]
    pub const fn are_stages_enabled(&self) -> bool {
        self.stages_enabled
    }

    /// Sets limits of the supply.
    #[must_use]
    pub const fn with_supply_limits(mut self, limits: SupplyLimits) -> Self {
        self.supply_limits = limits;
        self
    }

    /// Sets the thermistor of the power stages, with its limit. A board that has one gives its counts among the inputs, and no temperature.
    #[must_use]
    pub const fn with_thermistor(mut self, thermistor: Thermistor) -> Self {
        self.thermistor = Some(thermistor);
        self
    }

    /// Sets how ticks are timed, and how many late and missed ones are no fault. Without it none is.
    #[must_use]
    pub const fn with_tick_clock(mut self, clock: TickClock) -> Self {
        self.tick_watch = TickWatch::new(Some(clock));
        self
    }

    /// Late and missed ticks since the start.
    #[must_use]
    pub fn tick_counts(&self) -> TickCounts {
        self.tick_watch.counts()
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &Machine<S, N> {
        self.machine
    }

    /// The inputs of the last tick.
    #[must_use]
    pub const fn inputs(&self) -> &Inputs<N> {
        &self.inputs
    }

    /// The readings of the last tick, from the origins of the axes.
    #[must_use]
    pub const fn readings(&self) -> &[Reading; N] {
        &self.readings
    }

    /// Whether the drive of an axis produces the force of the controller; false for a step drive, and if there is no such axis.
    #[must_use]
    pub fn follows_force(&self, axis: usize) -> bool {
        self.outputs.get(axis).is_some_and(DriveOutput::follows_force)
    }

    /// The machine, for operations that are not part of a tick: blocks, settings.
    pub const fn machine_mut(&mut self) -> &mut Machine<S, N> {
        self.machine
    }

    /// One tick, from the sensors to the power stages. It cannot fail; a fault that switches the drives off acts in the same tick.
    pub fn tick(&mut self, board: &mut impl Board<N, O::Signal>) -> Tick<S, N> {
        self.tick_watch.started(board.started_at(), self.stages_enabled);
        let event = self.switch.update(board.enable_switch_closed());
        let samples = board.inputs();
        self.limit_samples = samples.axes.map(|axis| axis.limits);
        self.inputs = self.debounce.update(samples);
        let from_power_up = board.readings();
        self.machine.set_limit_switches(self.inputs.axes.map(|axis| axis.limits));
        if self.machine.follows() {
            self.machine.set_counters(self.inputs.axes.map(|axis| axis.counter));
        }
        self.home_tick(&from_power_up);
        self.probe_tick();
        let [last, _] = self.recent;
        self.recent = [Moment { readings: from_power_up, commands: self.machine.command() }, last];
        for ((reading, raw), origin) in self.readings.iter_mut().zip(from_power_up).zip(self.origins) {
            *reading = raw.shifted(origin);
        }
        if self.is_checking() {
            self.disarm();
            let readings = self.readings;
            let output = self.check_tick(board, event, &readings);
            board.set_light(self.light.is_lit(self.machine.power(), None));
            return Tick { readings, output };
        }
        match event {
            Some(SwitchEvent::Enable) => match &mut self.enabling {
                Enabling::BySwitch => self.machine.enable(),
                Enabling::ByHost { armed } => *armed = true,
            },
            Some(SwitchEvent::Disable) => {
                self.disarm();
                self.machine.disable();
            }
            None => {}
        }
        let was_on = self.machine.power().is_on();
        let output = self.machine.tick(&self.readings);
        self.forces = output.forces;
        // Before the stages are enabled, so that stopped ones are not.
        self.check_inputs(&output.commands, was_on);
        if self.inputs.emergency_stop {
            self.disarm();
        }
        if board.hardware_stop_active() {
            self.disarm();
            self.machine.fault(Fault::HardwareStop);
        }
        if self.tick_watch.is_exceeded() {
            self.machine.fault(Fault::Overrun);
        }
        self.drive(board, &output.forces);
        // The stages have their force, and a stop by an input of this tick acts on the command that is computed here.
        self.machine.prepare();
        if self.stages_enabled {
            self.tick_watch.ended(board.next_tick_due());
            if self.tick_watch.is_exceeded() {
                self.machine.fault(Fault::Overrun);
                self.drive(board, &output.forces);
            }
        }
        board.set_light(self.light.is_lit(self.machine.power(), output.warning));
        Tick { readings: self.readings, output }
    }

    /// What the axes were some ticks before the present one, 1 or 2.
    pub(super) fn before(&self, ticks: usize) -> &Moment<N> {
        let [last, earlier] = &self.recent;
        if ticks == 1 { last } else { earlier }
    }

    pub(super) const fn disarm(&mut self) {
        if let Enabling::ByHost { armed } = &mut self.enabling {
            *armed = false;
        }
    }

    /// The fault of the supply.
    pub(super) const fn supply_fault(&self) -> Option<Fault> {
        match (self.supply_limits.fault(&self.inputs.supply), self.thermistor, self.inputs.thermistor_counts)
        {
            (None, Some(thermistor), Some(counts)) if thermistor.is_too_hot(counts) => {
                Some(Fault::OverTemperature)
            }
            (fault, ..) => fault,
        }
    }

    /// The supply, with the temperature of a thermistor. Not for a tick.
    #[must_use]
    pub fn supply(&self) -> Supply {
        match (self.thermistor, self.inputs.thermistor_counts) {
            (Some(thermistor), Some(counts)) => {
                Supply { temperature_mc: thermistor.temperature_mc(counts), ..self.inputs.supply }
            }
            _ => self.inputs.supply,
        }
    }

    /// Raises the faults of the inputs. Drives that have come on in this tick go off again at once, also by a fault that would stop a
    /// path.
    fn check_inputs(&mut self, commands: &[Position; N], was_on: bool) {
        if self.inputs.emergency_stop {
            self.machine.fault(Fault::EmergencyStop);
        }
        if let Some(fault) = self.supply_fault() {
            if self.machine.power().is_on() && !was_on {
                self.machine.disable();
                self.machine.inhibit_enable(fault);
            }
            self.machine.fault(fault);
        }
        let onto_switch = self.limit_guard.moves_onto_switch(&self.inputs.axes, commands);
        let homing = self.homing_axis();
        let homing_too = homing.and_then(|axis| self.machine.second_motor(axis));
        for (axis, (input, onto_switch)) in self.inputs.axes.iter().zip(onto_switch).enumerate() {
            // A homing reacts to the switches itself.
            let is_homed = [homing, homing_too].contains(&Some(axis));
            let at_limit = onto_switch && !is_homed;
            let faults = [
                (FaultKind::DriveFault, input.drive_fault),
                (FaultKind::EncoderSignal, input.bad_encoder_signal),
                (FaultKind::LimitSwitch, at_limit),
            ];
            for (kind, _) in faults.into_iter().filter(|(_, present)| *present) {
                #[expect(clippy::cast_possible_truncation, reason = "fewer axes than 256")]
                self.machine.fault(Fault::Axis { axis: axis as u8, kind });
            }
        }
    }

    /// Continues after the origin of an axis has been shifted.
    pub(super) fn shift_origin(&mut self, axis: usize, before: [Position; N], shift: OriginShift) {
        if let (Some(origin), Some(before), Some(after)) =
            (self.origins.get_mut(axis), before.get(axis), self.machine.command().get(axis))
        {
            *origin = origin.then(shift);
            self.limit_guard.shift(axis, *after - *before);
        }
    }

    /// Passes the forces of the machine to the drives, or disables them.
    fn drive(&mut self, board: &mut impl Board<N, O::Signal>, forces: &[S; N]) {
        let on = self.machine.power().is_on();
        self.pass_on(board, on.then_some(forces));
    }

    /// Passes forces to the drives; `None` disables them.
    pub(super) fn pass_on(&mut self, board: &mut impl Board<N, O::Signal>, forces: Option<&[S; N]>) {
        let commands = self.machine.corrected_command();
        let mut demands = [Demand { force: S::ZERO, command: Position(0) }; N];
        for (((demand, force), command), origin) in
            demands.iter_mut().zip(forces.unwrap_or(&[S::ZERO; N])).zip(commands).zip(self.origins)
        {
            *demand = Demand { force: *force, command: command - origin.motor };
        }
        let mut demands = demands.iter();
        let signals =
            self.outputs.each_mut().map(|output| match demands.next().filter(|_| forces.is_some()) {
                Some(demand) => output.signal(demand),
                None => output.off(),
            });
        board.set_signals(signals);
        self.stages_enabled = forces.is_some();
        board.set_enabled(self.stages_enabled);
        board.set_brakes_open(self.machine.are_brakes_open());
    }
}

#[cfg(test)]
mod tests;
