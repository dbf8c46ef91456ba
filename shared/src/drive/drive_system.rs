//! The controller with its power stages, enable switch and status light.

use super::amplifier::Amplifier;
use super::board::Board;
use super::enable_switch::{EnableSwitch, SwitchEvent};
use super::first_motion::FirstMotion;
use super::inputs::{Inputs, SupplyLimits};
use super::limit_guard::LimitGuard;
use super::output::{Demand, DriveOutput};
use super::status_light::StatusLight;
use crate::feedback::{OriginShift, Reading};
use crate::homing::Homing;
use crate::machine::{Machine, Output};
use crate::safety::{Fault, FaultKind};
use crate::scalar::Scalar;
use crate::units::Position;

/// A machine with its power stages, enable switch and status light. The machine, which is large, is borrowed.
#[derive(Debug)]
pub struct DriveSystem<'m, S: Scalar, const N: usize, O = Amplifier<S>> {
    machine: &'m mut Machine<S, N>,
    pub(super) outputs: [O; N],
    switch: EnableSwitch,
    light: StatusLight,
    enabling: Enabling,
    /// The direction check that runs or that ran last.
    pub(super) first_motion: Option<FirstMotion<S, N>>,
    supply_limits: SupplyLimits,
    limit_guard: LimitGuard<N>,
    /// Origin of each axis, from the position at power-up.
    pub(super) origins: [OriginShift; N],
    /// The homing that runs or that ran last, and its axis.
    pub(super) homing: Option<(usize, Homing)>,
    inputs: Inputs<N>,
    readings: [Reading; N],
}

/// What switches the drives on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Enabling {
    /// The enable switch.
    BySwitch,
    /// A host, while the switch permits it: since it was closed as a new edge and until it opens, or the hardware stops the
    /// drives.
    ByHost {
        /// Whether the switch permits it.
        armed: bool,
    },
}

/// A host has asked for an enable that the enable switch does not permit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotArmed;

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
            limit_guard: LimitGuard::new(),
            origins: [OriginShift { motor: 0, table: 0 }; N],
            homing: None,
            first_motion: None,
            inputs: Inputs::NONE,
            readings: [Reading { motor: Position(0), table: None }; N],
            enabling: Enabling::BySwitch,
        }
    }

    /// The same with a host that enables the drives: closing the switch then only permits it.
    #[must_use]
    pub fn enabled_by_host(self) -> Self {
        Self { enabling: Enabling::ByHost { armed: false }, ..self }
    }

    /// Enables the drives at the next tick, for a host. No effect until a fault is acknowledged.
    ///
    /// # Errors
    /// [`NotArmed`] if the switch does not permit it: it is open, has not been opened and closed since the start or since a
    /// stop by hardware, or enables the drives by itself.
    pub fn enable_by_host(&mut self) -> Result<(), NotArmed> {
        if !self.is_armed() {
            return Err(NotArmed);
        }
        self.machine.enable();
        Ok(())
    }

    /// Whether the switch permits that a host enables the drives.
    #[must_use]
    pub const fn is_armed(&self) -> bool {
        matches!(self.enabling, Enabling::ByHost { armed: true })
    }

    /// The same with limits of the supply.
    #[must_use]
    pub const fn with_supply_limits(mut self, limits: SupplyLimits) -> Self {
        self.supply_limits = limits;
        self
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

    /// The machine, for operations that are not part of a tick: blocks, settings.
    pub const fn machine_mut(&mut self) -> &mut Machine<S, N> {
        self.machine
    }

    /// One tick, from the sensors to the power stages. It cannot fail; a fault that switches the drives off acts in the same tick.
    pub fn tick(&mut self, board: &mut impl Board<N, O::Signal>) -> Tick<S, N> {
        let event = self.switch.update(board.enable_switch_closed());
        self.inputs = board.inputs();
        let from_power_up = board.readings();
        self.machine.set_limit_switches(self.inputs.axes.map(|axis| axis.limits));
        self.home_tick(&from_power_up);
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
        // Before the stages are enabled, so that stopped ones are not.
        self.check_inputs(&output.commands, was_on);
        if self.inputs.emergency_stop {
            self.disarm();
        }
        if board.hardware_stop_active() {
            self.disarm();
            self.machine.fault(Fault::HardwareStop);
        }
        self.drive(board, &output.forces);
        if board.next_tick_due() {
            self.machine.fault(Fault::Overrun);
            self.drive(board, &output.forces);
        }
        board.set_light(self.light.is_lit(self.machine.power(), output.warning));
        Tick { readings: self.readings, output }
    }

    const fn disarm(&mut self) {
        if let Enabling::ByHost { armed } = &mut self.enabling {
            *armed = false;
        }
    }

    /// The fault of the supply.
    pub(super) const fn supply_fault(&self) -> Option<Fault> {
        self.supply_limits.fault(&self.inputs.supply)
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
        let homing = self.homing.as_ref().filter(|(_, homing)| homing.is_running()).map(|(axis, _)| *axis);
        for (axis, (input, onto_switch)) in self.inputs.axes.iter().zip(onto_switch).enumerate() {
            // A homing reacts to the switches itself.
            let at_limit = onto_switch && homing != Some(axis);
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
        board.set_duties(signals);
        board.set_enabled(forces.is_some());
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::boxed::Box;

    use super::super::amplifier::Duty;
    use super::*;
    use crate::config::{AxisSettings, Rates};
    use crate::interpolate::Block;
    use crate::safety::Power;
    use crate::scalar::Fixed;

    const SETTLING: u32 = 10;
    const BLINK: u32 = 50;

    #[expect(clippy::struct_excessive_bools, reason = "inputs and outputs of one bit")]
    struct Bench {
        at: Position,
        closed: bool,
        stopped: bool,
        late: bool,
        duty: Duty,
        enabled: bool,
        lit: bool,
    }

    impl Board<1> for Bench {
        fn readings(&mut self) -> [Reading; 1] {
            [Reading { motor: self.at, table: None }]
        }

        fn enable_switch_closed(&mut self) -> bool {
            self.closed
        }

        fn hardware_stop_active(&mut self) -> bool {
            self.stopped
        }

        fn set_duties(&mut self, [duty]: [Duty; 1]) {
            self.duty = duty;
        }

        fn set_enabled(&mut self, enabled: bool) {
            self.enabled = enabled;
        }

        fn set_light(&mut self, lit: bool) {
            self.lit = lit;
        }

        fn next_tick_due(&mut self) -> bool {
            self.late
        }
    }

    /// A system that has just been enabled with a line to follow, and its test bench.
    fn running() -> (DriveSystem<'static, Fixed, 1>, Bench) {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
        let axis = AxisSettings { following_error_limit_m: 1e-3, ..AxisSettings::default() };
        let machine = Box::leak(Box::new(Machine::new(rates, &[axis], [Position(0)]).unwrap()));
        machine.push(&Block::line([0.1], 0.1, 5.0)).unwrap();
        let amplifiers = [Amplifier::new(1000.0, 8400).unwrap()];
        let mut system =
            DriveSystem::new(machine, amplifiers, EnableSwitch::new(SETTLING), StatusLight::new(BLINK));
        let mut bench = Bench {
            at: Position(0),
            closed: false,
            stopped: false,
            late: false,
            duty: Duty::default(),
            enabled: false,
            lit: false,
        };
        close(&mut system, &mut bench);
        assert!(bench.enabled && !bench.lit);
        (system, bench)
    }

    fn run(system: &mut DriveSystem<'_, Fixed, 1>, bench: &mut Bench, ticks: u32) {
        for _ in 0..ticks {
            system.tick(bench);
        }
    }

    fn close(system: &mut DriveSystem<'_, Fixed, 1>, bench: &mut Bench) {
        bench.closed = false;
        run(system, bench, 2 * SETTLING);
        assert!(!bench.enabled);
        bench.closed = true;
        run(system, bench, 2 * SETTLING);
    }

    /// With a host, the closed switch only permits an enable: not before a new edge, and no longer once it is open or the
    /// hardware has stopped the drives.
    #[test]
    fn a_host_enables_only_while_the_switch_permits_it() {
        let (system, mut bench) = running();
        let mut system = system.enabled_by_host();
        // Off by the previous way of enabling: the switch is closed without a new edge.
        system.machine_mut().disable();
        run(&mut system, &mut bench, 2 * SETTLING);
        assert!(!bench.enabled && !system.is_armed());
        assert_eq!(system.enable_by_host(), Err(NotArmed));
        close(&mut system, &mut bench);
        assert!(!bench.enabled && system.is_armed(), "the switch alone enables");
        assert_eq!(system.enable_by_host(), Ok(()));
        run(&mut system, &mut bench, 1);
        assert!(bench.enabled);
        bench.closed = false;
        run(&mut system, &mut bench, 1);
        assert_eq!((bench.enabled, system.enable_by_host()), (false, Err(NotArmed)));
        close(&mut system, &mut bench);
        system.enable_by_host().unwrap();
        run(&mut system, &mut bench, 1);
        bench.stopped = true;
        run(&mut system, &mut bench, 1);
        assert_eq!((bench.enabled, system.enable_by_host()), (false, Err(NotArmed)));
        // The stop is released and the fault acknowledged, but the switch has not been operated.
        bench.stopped = false;
        system.machine_mut().disable();
        run(&mut system, &mut bench, 3 * SETTLING);
        assert_eq!((bench.enabled, system.enable_by_host()), (false, Err(NotArmed)));
    }

    #[test]
    fn the_force_acts_towards_the_command() {
        let (mut system, mut bench) = running();
        run(&mut system, &mut bench, 40);
        assert!(!bench.duty.reverse && bench.duty.counts > 0, "{:?}", bench.duty);
    }

    /// Asserts that the stages are disabled, the duty is zero, and the light is on unless the drives are off without a fault.
    fn assert_off(system: &DriveSystem<'_, Fixed, 1>, bench: &Bench, power: Power) {
        assert_eq!((system.machine.power(), bench.enabled, bench.duty), (power, false, Duty::default()));
        assert_eq!(bench.lit, power != Power::Off);
    }

    #[test]
    fn an_overrun_or_a_hardware_stop_disables_the_stages_until_a_new_edge() {
        for fault in [Fault::Overrun, Fault::HardwareStop] {
            let (mut system, mut bench) = running();
            run(&mut system, &mut bench, 40);
            (bench.late, bench.stopped) = (fault == Fault::Overrun, fault == Fault::HardwareStop);
            system.tick(&mut bench);
            assert_off(&system, &bench, Power::Faulted(fault));
            (bench.late, bench.stopped) = (false, false);
            run(&mut system, &mut bench, 1000);
            assert_off(&system, &bench, Power::Faulted(fault));
            // The path was discarded: enabled again, the axis holds its new position.
            bench.at = Position::from_m(0.02).unwrap();
            close(&mut system, &mut bench);
            assert_eq!((bench.enabled, bench.lit, bench.duty), (true, false, Duty::default()));
        }
    }

    #[test]
    fn a_hardware_stop_prevents_an_enable() {
        let (mut system, mut bench) = running();
        bench.stopped = true;
        bench.closed = false;
        run(&mut system, &mut bench, 2 * SETTLING);
        bench.closed = true;
        for _ in 0..3 * SETTLING {
            system.tick(&mut bench);
            assert!(!bench.enabled);
        }
        assert_off(&system, &bench, Power::Faulted(Fault::HardwareStop));
    }

    #[test]
    fn opening_the_switch_disables_the_stages_in_the_same_tick() {
        let (mut system, mut bench) = running();
        run(&mut system, &mut bench, 40);
        bench.closed = false;
        system.tick(&mut bench);
        assert_off(&system, &bench, Power::Off);
        bench.at = Position::from_m(0.02).unwrap();
        close(&mut system, &mut bench);
        assert_eq!((bench.enabled, bench.duty), (true, Duty::default()));
    }

    #[test]
    fn a_following_error_disables_the_stages_in_the_same_tick() {
        let (mut system, mut bench) = running();
        bench.at = Position::from_m(2e-3).unwrap();
        system.tick(&mut bench);
        let fault = Fault::Axis { axis: 0, kind: FaultKind::FollowingError };
        assert_off(&system, &bench, Power::Faulted(fault));
    }

    /// During a stop along the path the stages stay enabled: they decelerate the axis. From 0.1 m/s with the 5 m/s² of the
    /// block, which exceeds the 2 m/s² of a stop, it takes 20 ms: 400 ticks.
    #[test]
    fn the_stages_stay_enabled_until_a_stop_has_ended() {
        let (mut system, mut bench) = running();
        let follow = |system: &mut DriveSystem<'_, Fixed, 1>, bench: &mut Bench| {
            system.tick(bench);
            bench.at = system.machine.command()[0];
        };
        for _ in 0..2000 {
            follow(&mut system, &mut bench);
        }
        let fault = Fault::Axis { axis: 0, kind: FaultKind::SoftLimit };
        system.machine.fault(fault);
        let mut ticks = 0;
        while system.machine.power() == Power::Stopping(fault) {
            follow(&mut system, &mut bench);
            ticks += 1;
            let stopped = system.machine.power() == Power::Faulted(fault);
            assert_eq!((bench.enabled, bench.lit), (!stopped, true));
            assert!(ticks < 2000);
        }
        assert!((398..=402).contains(&ticks), "{ticks}");
        assert_off(&system, &bench, Power::Faulted(fault));
    }

    /// A warning blinks until the drives are disabled.
    #[test]
    fn a_warning_blinks() {
        let (mut system, mut bench) = running();
        system.machine.fault(Fault::Axis { axis: 0, kind: FaultKind::ScaleLost });
        let lit = (0..4 * BLINK).map(|_| {
            system.tick(&mut bench);
            bench.lit
        });
        assert_eq!(lit.filter(|lit| *lit).count(), 2 * BLINK as usize);
        assert!(bench.enabled);
    }
}
