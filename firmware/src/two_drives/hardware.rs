//! The board of a tick, by its table and the registers of its chip.

use shared::axis::Reading;
use shared::drive::step::StepCounter;
use shared::drive::{AxisInputs, Board, DriveSettings, DriveSignal, Inputs, LinearInput, StepOutput, Supply};

use super::counters::Timers;
use super::stages::Stages;
use super::switches::{Levels, Switches};
use super::{Conversions, Registers, Sensors};
use crate::setup::{self, AXES, AxisTable, SetupError, TemperatureSensor};

/// The pins and timers of a tick.
pub struct Hardware<R: Registers> {
    table: &'static [AxisTable; AXES],
    registers: R,
    sensors: Sensors<R::Counters>,
    bus: LinearInput,
    /// `None`: a thermistor, whose counts are given to the drive system.
    temperature: Option<LinearInput>,
    stages: Stages,
    /// Steps of the axes with step drives.
    steps: [Option<StepCounter>; AXES],
    /// Inputs of the present tick.
    switches: Switches,
    conversions: Conversions,
}

/// A converter's input by slope and offset, in the units of its value.
fn linear_input([slope, offset]: [f64; 2]) -> Result<LinearInput, SetupError> {
    LinearInput::new(slope, offset).ok_or(SetupError::Converter)
}

/// The scale of a linear temperature sensor; `None`: a thermistor is fitted.
fn linear_temperature() -> Result<Option<LinearInput>, SetupError> {
    match core::hint::black_box(&setup::TEMPERATURE) {
        TemperatureSensor::Linear(scale) => linear_input(*scale).map(Some),
        TemperatureSensor::Thermistor(_) => Ok(None),
    }
}

/// The counter of a step drive.
fn step_counter(axis: AxisTable) -> Option<StepCounter> {
    match axis.drive {
        DriveSettings::Steps { step_m } => StepOutput::new(step_m, 1).ok().map(|output| output.counter()),
        DriveSettings::Pwm { .. } | DriveSettings::Analog(_) => None,
    }
}

impl<R: Registers> Hardware<R> {
    /// Registers that were started, with the stages off, their counters, and PWM counts of full duty. Position zero is the present
    /// position.
    ///
    /// # Errors
    /// [`SetupError`] for an invalid value of the table.
    pub fn new(
        table: &'static [AxisTable; AXES],
        registers: R,
        timers: Timers<R::Counters>,
        full_counts: u16,
    ) -> Result<Self, SetupError> {
        Ok(Self {
            table,
            sensors: Sensors::new(table, timers)?,
            bus: linear_input([setup::BUS_MV_PER_COUNT, 0.0])?,
            temperature: linear_temperature()?,
            stages: Stages::new(full_counts),
            steps: table.map(step_counter),
            switches: Switches::new(R::WIRING, Levels::default()),
            conversions: Conversions::default(),
            registers,
        })
    }

    /// The first step of a tick, at the start of the PWM period.
    pub fn begin_tick(&mut self) {
        self.stages.begin_period(&mut self.registers);
        self.registers.acknowledge_tick();
        self.switches = Switches::new(R::WIRING, self.registers.levels());
        self.conversions = self.registers.conversions();
        self.sensors.read(&self.conversions, self.switches.scale_signals(self.table));
    }

    fn axis_inputs(&mut self, axis: usize) -> AxisInputs {
        let Some(table) = self.table.get(axis) else { return AxisInputs::NONE };
        AxisInputs {
            motor_index: self.sensors.motor_index(axis),
            scale_index: self.sensors.scale_index(axis),
            bad_encoder_signal: !self.sensors.is_good(axis),
            signals: self.sensors.signals(axis),
            counter: self.sensors.counter(axis),
            ..self.switches.axis(axis, table)
        }
    }
}

impl<R: Registers> Board<AXES, DriveSignal> for Hardware<R> {
    fn inputs(&mut self) -> Inputs<AXES> {
        let Conversions { bus, temperature, .. } = self.conversions;
        Inputs {
            axes: core::array::from_fn(|axis| self.axis_inputs(axis)),
            emergency_stop: self.switches.is_stopped(),
            probe_touched: self.switches.is_probe_touched(),
            supply: Supply {
                bus_mv: Some(self.bus.value(bus).max(0).cast_unsigned()),
                temperature_mc: self.temperature.map(|sensor| sensor.value(temperature)),
            },
            thermistor_counts: self.temperature.is_none().then_some(temperature),
        }
    }

    fn readings(&mut self) -> [Reading; AXES] {
        let mut readings = self.sensors.readings();
        for (reading, steps) in readings.iter_mut().zip(&self.steps) {
            if let Some(steps) = steps {
                reading.motor = steps.position();
            }
        }
        readings
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.switches.enable_switch_closed()
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.registers.take_stop()
    }

    fn set_signals(&mut self, signals: [DriveSignal; AXES]) {
        for (signal, counter) in signals.iter().zip(&mut self.steps) {
            if let (DriveSignal::Steps { steps, .. }, Some(counter)) = (signal, counter) {
                counter.add(*steps);
            }
        }
        self.stages.set(&mut self.registers, signals);
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.stages.set_enabled(&mut self.registers, enabled);
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.registers.set_brakes_open(open);
    }

    fn set_light(&mut self, lit: bool) {
        self.registers.set_light(lit);
    }

    fn next_tick_due(&mut self) -> bool {
        self.registers.tick_is_due()
    }

    fn started_at(&mut self) -> Option<u32> {
        Some(self.registers.started_at())
    }
}
