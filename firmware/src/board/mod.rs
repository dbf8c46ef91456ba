//! An STM32F405 with two drives. The wiring table is in `docs/firmware.md`.

mod clock;
mod quadrature;
mod stage;
mod tick;

use shared::axis::Reading;
use shared::drive::{Board, DriveSystem, Duty};
use shared::machine::Machine;
use shared::scalar::Fixed;
use stm32f4xx_hal::gpio::{Input, Output, PB15, PC13, PinState, Pull};
use stm32f4xx_hal::pac::{Peripherals, TIM3, TIM4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::setup::{self, AXES, SetupError};
use quadrature::Quadrature;
use stage::{Pins, Stages};
use tick::TickTimer;

/// The pins and timers of a tick.
pub struct Hardware {
    x: Quadrature<TIM3>,
    y: Quadrature<TIM4>,
    stages: Stages,
    enable_switch: PB15<Input>,
    fault_light: PC13<Output>,
    tick_timer: TickTimer,
    watchdog: IndependentWatchdog,
}

impl Hardware {
    /// Initialises clocks, pins and timers, configures the machine, and starts the ticks with the drives off.
    ///
    /// # Errors
    /// [`SetupError`] for an invalid value in [`setup`].
    pub fn new(
        device: Peripherals,
        machine: &'static mut Machine<Fixed, AXES>,
    ) -> Result<(Self, DriveSystem<'static, Fixed, AXES>), SetupError> {
        let mut rcc = device.RCC.constrain();
        // The stages are disabled first, before the wait for the crystal.
        let b = device.GPIOB.split(&mut rcc);
        let enable = b.pb14.into_push_pull_output_in_state(PinState::Low);
        let previous_fault = clock::previous_fault(&rcc);

        let mut rcc = clock::set_up(rcc);
        let (a, c) = (device.GPIOA.split(&mut rcc), device.GPIOC.split(&mut rcc));
        let pins =
            Pins { enable, directions: (c.pc6.into_push_pull_output(), c.pc7.into_push_pull_output()) };
        // With the pull-down, a broken wire stops the drives.
        let stop = b.pb12.into_alternate().internal_resistor(Pull::Down);
        let timer_pins = (a.pa8.into_alternate(), a.pa9.into_alternate(), stop);
        let stages = Stages::new(device.TIM1, pins, timer_pins, &mut rcc);

        // Pull-ups: an open input does not float.
        let _ = (
            a.pa6.into_alternate::<2>().internal_resistor(Pull::Up),
            a.pa7.into_alternate::<2>().internal_resistor(Pull::Up),
            b.pb6.into_alternate::<2>().internal_resistor(Pull::Up),
            b.pb7.into_alternate::<2>().internal_resistor(Pull::Up),
        );
        let [x, y] = setup::METRES_PER_COUNT;
        let (x, y) = (Quadrature::new(device.TIM3, x, &mut rcc)?, Quadrature::new(device.TIM4, y, &mut rcc)?);

        let system = setup::drive_system(machine, stages.full_counts(), previous_fault)?;

        let tick_timer = TickTimer::new(device.TIM2, &mut rcc);
        // 10 ms, at least a hundred ticks: without ticks the watchdog resets the chip, and the stages with it.
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.start(10.millis());

        let hardware = Self {
            x,
            y,
            stages,
            // With the pull-down, a broken wire reads as open.
            enable_switch: b.pb15.into_pull_down_input(),
            fault_light: c.pc13.into_push_pull_output_in_state(PinState::High),
            tick_timer,
            watchdog,
        };
        Ok((hardware, system))
    }

    /// The first step of a tick, at the start of the PWM period.
    pub fn begin_tick(&mut self) {
        self.stages.begin_period();
        self.tick_timer.acknowledge();
        self.watchdog.feed();
    }
}

impl Board<AXES> for Hardware {
    fn readings(&mut self) -> [Reading; AXES] {
        [self.x.position(), self.y.position()].map(|motor| Reading { motor, table: None })
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.enable_switch.is_high()
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.stages.are_stopped()
    }

    fn set_duties(&mut self, duties: [Duty; AXES]) {
        self.stages.set(duties);
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.stages.set_enabled(enabled);
    }

    fn set_light(&mut self, lit: bool) {
        // The light is connected between the pin and the supply: active low.
        self.fault_light.set_state((!lit).into());
    }

    fn next_tick_due(&mut self) -> bool {
        self.tick_timer.is_due()
    }
}

/// Disables the power stages from any context and in any state of the program.
pub fn drives_off() {
    Stages::cut();
}
