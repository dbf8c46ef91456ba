//! An STM32F405 with two drives. The wiring table is in `docs/firmware.md`.

mod clock;
mod converter;
mod dac;
pub mod flash;
pub mod link;
mod quadrature;
mod sensors;
mod stage;
mod switches;
mod tick;
pub mod uart;
pub mod usb;
pub mod watchdog;

use shared::axis::Reading;
use shared::drive::step::StepCounter;
use shared::drive::{AxisInputs, Board, DriveSettings, DriveSignal, Inputs, LinearInput, StepOutput, Supply};
use shared::link::report::Identity;
use shared::link::{HostedDrive, TwoPorts};
use shared::machine::Machine;
use shared::safety::Fault;
use shared::scalar::Fixed;
use stm32f4xx_hal::gpio::{Output, PC13, PinState, Pull};

use stm32f4xx_hal::pac::{FLASH, Peripherals};
use stm32f4xx_hal::prelude::*;

use crate::setup::{self, AXES, AxisTable, SetupError, TemperatureSensor};
use converter::{Conversions, Converters};
use dac::AnalogOutputs;
use sensors::{Sensors, Timers};
use stage::{Pins, Stages};
use switches::Switches;
use tick::TickTimer;
use watchdog::Watchdog;

/// The pins and timers of a tick.
pub struct Hardware {
    table: &'static [AxisTable; AXES],
    sensors: Sensors,
    converters: Converters,
    bus: LinearInput,
    /// `None`: a thermistor, whose counts are given to the drive system.
    temperature: Option<LinearInput>,
    stages: Stages,
    /// Steps of the axes with step drives.
    steps: [Option<StepCounter>; AXES],
    fault_light: PC13<Output>,
    tick_timer: TickTimer,
    /// Inputs of the present tick.
    switches: Switches,
    conversions: Conversions,
}

/// The parts of the board that run independently of each other.
pub struct Parts {
    /// For the tick.
    pub hardware: Hardware,
    /// The controller, for the tick and the server of the link.
    pub drive: link::Drive,
    /// Ports of the link, for the server.
    pub ports: usb::Ports,
    /// The serial port, for its interrupt.
    pub interrupt: uart::UartInterrupt,
    /// Fed by each tick.
    pub watchdog: Watchdog,
    /// For the settings.
    pub flash: FLASH,
    /// The fault that ended the previous run.
    pub previous_fault: Option<Fault>,
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

impl Parts {
    /// Initialises clocks, pins and timers, configures the machine, and starts the ticks with the drives off.
    ///
    /// # Errors
    /// [`SetupError`] for an invalid value in [`setup`].
    pub fn new(
        device: Peripherals,
        machine: &'static mut Machine<Fixed, AXES>,
        queues: &'static mut uart::Queues,
    ) -> Result<Self, SetupError> {
        // Read at run time, so that what is built and tested has every alternative of the table.
        let table = core::hint::black_box(&setup::TABLE);
        let mut rcc = device.RCC.constrain();
        // The stages are disabled first, before the wait for the crystal.
        let b = device.GPIOB.split(&mut rcc);
        let enable = b.pb14.into_push_pull_output_in_state(PinState::Low);
        let brakes = device.GPIOD.split(&mut rcc).pd2.into_push_pull_output_in_state(PinState::Low);
        let previous_fault = clock::previous_fault(&rcc);

        let mut rcc = clock::set_up(rcc);
        let (a, c) = (device.GPIOA.split(&mut rcc), device.GPIOC.split(&mut rcc));
        let analog = (a.pa4.into_analog(), a.pa5.into_analog());
        let analog = AnalogOutputs::new(device.DAC, analog, table.map(zero_volts), &mut rcc);
        let pins = Pins::new(enable, brakes, (c.pc10, c.pc11));
        // With the pull-down, a broken wire stops the drives.
        let stop = b.pb12.into_alternate().internal_resistor(Pull::Down);
        let pwm = (a.pa8.into_alternate(), a.pa9.into_alternate(), stop);
        let stages = Stages::new(device.TIM1, pins, pwm, analog, &mut rcc);
        // Pull-ups: an open input does not float.
        macro_rules! counter_inputs {
            ($($pin:expr => $function:literal,)*) => {
                let _ = ($($pin.into_alternate::<$function>().internal_resistor(Pull::Up),)*);
            };
        }
        counter_inputs! {
            a.pa6 => 2, a.pa7 => 2, b.pb0 => 2,
            b.pb6 => 2, b.pb7 => 2, b.pb8 => 2,
            a.pa0 => 2, a.pa1 => 2, a.pa2 => 2,
            c.pc6 => 3, c.pc7 => 3, c.pc8 => 3,
        }
        let (supply, x) =
            ((c.pc0.into_analog(), c.pc1.into_analog()), (c.pc2.into_analog(), c.pc3.into_analog()));
        let pins = (supply, x, (c.pc4.into_analog(), c.pc5.into_analog()));
        let converters = Converters::new(device.ADC1, device.ADC2, &device.ADC_COMMON, pins, &mut rcc);
        let timers = Timers { x: device.TIM3, y: device.TIM4, x_scale: device.TIM5, y_scale: device.TIM8 };
        let sensors = Sensors::new(table, timers, &mut rcc)?;
        switches::set_up(
            (a.pa3, a.pa10, a.pa15),
            (b.pb1, b.pb2, b.pb3, b.pb5, b.pb9, b.pb13, b.pb15),
            (c.pc9, c.pc12),
        );
        let pins = (b.pb10.into_alternate(), b.pb11.into_alternate());
        let (uart, interrupt) = uart::start(device.USART3, pins, queues, &mut rcc);
        // SAFETY: the peripherals exist once.
        let (capture, usb_memory) = unsafe { link::core_coupled_memory() };
        let core = (device.OTG_FS_GLOBAL, device.OTG_FS_DEVICE, device.OTG_FS_PWRCLK);
        let usb_pins = (a.pa11.into_alternate(), a.pa12.into_alternate());
        let ports = TwoPorts::new(uart, usb::start(core, usb_pins, usb_memory, &mut rcc));

        let system = setup::drive_system(machine, stages.full_counts())?;
        let Identity { tick_hz, times, steps, .. } = &setup::IDENTITY;
        let drive = HostedDrive::new(system, *tick_hz, *times, steps, capture);
        let watchdog = Watchdog::start(device.IWDG);

        let hardware = Hardware {
            table,
            sensors,
            converters,
            bus: linear_input([setup::BUS_MV_PER_COUNT, 0.0])?,
            temperature: linear_temperature()?,
            stages,
            steps: table.map(step_counter),
            fault_light: c.pc13.into_push_pull_output_in_state(PinState::High),
            tick_timer: TickTimer::new(device.TIM2, &mut rcc),
            switches: Switches::default(),
            conversions: Conversions::default(),
        };
        Ok(Self { hardware, drive, ports, interrupt, watchdog, flash: device.FLASH, previous_fault })
    }
}

/// Starts the counter of the clock cycles of the core, by which the ticks are timed. To be called before they start.
pub fn start_cycle_counter(mut processor: cortex_m::Peripherals) {
    processor.DCB.enable_trace();
    processor.DWT.enable_cycle_counter();
}

/// Counts of the converter for 0 V.
const fn zero_volts(axis: AxisTable) -> u16 {
    match axis.drive {
        DriveSettings::Analog(settings) => settings.zero,
        DriveSettings::Pwm { .. } | DriveSettings::Steps { .. } => 2048,
    }
}

/// The counter of a step drive.
fn step_counter(axis: AxisTable) -> Option<StepCounter> {
    match axis.drive {
        DriveSettings::Steps { step_m } => StepOutput::new(step_m, 1).ok().map(|output| output.counter()),
        DriveSettings::Pwm { .. } | DriveSettings::Analog(_) => None,
    }
}

impl Hardware {
    /// The first step of a tick, at the start of the PWM period.
    pub fn begin_tick(&mut self) {
        self.stages.begin_period();
        self.tick_timer.acknowledge();
        self.switches = Switches::read();
        self.conversions = self.converters.read();
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

impl Board<AXES, DriveSignal> for Hardware {
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
        self.stages.are_stopped()
    }

    fn set_signals(&mut self, signals: [DriveSignal; AXES]) {
        for (signal, counter) in signals.iter().zip(&mut self.steps) {
            if let (DriveSignal::Steps { steps, .. }, Some(counter)) = (signal, counter) {
                counter.add(*steps);
            }
        }
        self.stages.set(signals);
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.stages.set_enabled(enabled);
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.stages.set_brakes_open(open);
    }

    fn set_light(&mut self, lit: bool) {
        // The light is connected between the pin and the supply: active low.
        self.fault_light.set_state((!lit).into());
    }

    fn next_tick_due(&mut self) -> bool {
        self.tick_timer.is_due()
    }

    fn started_at(&mut self) -> Option<u32> {
        Some(self.tick_timer.started_at())
    }
}

/// Disables the power stages and closes the brakes, from any context and in any state of the program.
pub fn drives_off() {
    Stages::cut();
}
