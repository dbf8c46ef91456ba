//! An STM32F405 with two drives. The wiring table is in `docs/firmware.md`.

mod axis;

use embedded_hal::pwm::SetDutyCycle;
use shared::axis::Reading;
use shared::drive::{Board, Duty, Station};
use shared::machine::Machine;
use shared::safety::Power;
use shared::scalar::Fixed;
use stm32f4xx_hal::gpio::{Input, Output, PB14, PB15, PC6, PC7, PC13, PinState};
use stm32f4xx_hal::pac::{self, Peripherals, TIM1, TIM2, TIM3, TIM4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::{C1, C2, CounterHz, Event, Flag, PwmChannel};
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use stm32f4xx_hal::{ClearFlags, Listen, ReadFlags};

use crate::setup::{self, AXES, SetupError};
use axis::Axis;

/// The pins and timers that a tick uses.
pub struct Hardware {
    x: Axis<Qei<TIM3>, PwmChannel<TIM1, C1>, PC6<Output>>,
    y: Axis<Qei<TIM4>, PwmChannel<TIM1, C2>, PC7<Output>>,
    enable_output: PB14<Output>,
    enable_switch: PB15<Input>,
    fault_light: PC13<Output>,
    tick_timer: CounterHz<TIM2>,
    watchdog: IndependentWatchdog,
}

impl Hardware {
    /// Sets clocks, pins and timers up and starts ticks, drives off.
    ///
    /// # Errors
    /// The [`SetupError`] of a value in [`setup`] that is wrong.
    ///
    /// # Panics
    /// Where the timer cannot give the tick rate, or the crystal the clock: both are constants.
    pub fn new(
        device: Peripherals,
        machine: &'static mut Machine<Fixed, AXES>,
    ) -> Result<(Self, Station<'static, Fixed, AXES>), SetupError> {
        let clocks = Config::hse(setup::CRYSTAL_HZ.Hz()).sysclk(168.MHz());
        let mut rcc = device.RCC.freeze(clocks);
        let (a, b, c) =
            (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));

        // First of all: the drives are off.
        let enable_output = b.pb14.into_push_pull_output_in_state(PinState::Low);

        let (_, (pwm_x, pwm_y, ..)) = device.TIM1.pwm_hz(setup::PWM_HZ.Hz(), &mut rcc);
        let (mut pwm_x, mut pwm_y) = (pwm_x.with(a.pa8), pwm_y.with(a.pa9));
        for pwm in [&mut pwm_x as &mut dyn SetDutyCycle<Error = _>, &mut pwm_y] {
            let _ = pwm.set_duty_cycle_fully_off();
        }
        pwm_x.enable();
        pwm_y.enable();

        let counter_x = Qei::new(device.TIM3, (a.pa6, a.pa7), &mut rcc);
        let counter_y = Qei::new(device.TIM4, (b.pb6, b.pb7), &mut rcc);
        let [encoder_x, encoder_y] = setup::encoders([counter_x.count(), counter_y.count()])?;
        let station = setup::station(machine, pwm_x.max_duty_cycle())?;

        let mut tick_timer = device.TIM2.counter_hz(&mut rcc);
        tick_timer.start(setup::TICK_HZ.Hz()).expect("168 MHz divide down to it");
        tick_timer.listen(Event::Update);
        // A hundred ticks or more: resets the chip, and the drives with it, when ticks stay away.
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.start(10.millis());

        let hardware = Self {
            x: Axis {
                encoder: encoder_x,
                counter: counter_x,
                pwm: pwm_x,
                direction: c.pc6.into_push_pull_output(),
            },
            y: Axis {
                encoder: encoder_y,
                counter: counter_y,
                pwm: pwm_y,
                direction: c.pc7.into_push_pull_output(),
            },
            enable_output,
            // A broken wire reads as open.
            enable_switch: b.pb15.into_pull_down_input(),
            fault_light: c.pc13.into_push_pull_output_in_state(PinState::High),
            tick_timer,
            watchdog,
        };
        Ok((hardware, station))
    }

    /// Acknowledges the timer: what is pending at the end of the tick is the next one.
    pub fn begin_tick(&mut self) {
        self.tick_timer.clear_flags(Flag::Update);
        self.watchdog.feed();
    }
}

impl Board<AXES> for Hardware {
    fn readings(&mut self) -> [Reading; AXES] {
        [self.x.position(), self.y.position()].map(|motor| Reading { motor, table: None })
    }

    fn switch_closed(&mut self) -> bool {
        self.enable_switch.is_high()
    }

    fn set_duties(&mut self, [x, y]: [Duty; AXES]) {
        self.x.set(x);
        self.y.set(y);
    }

    fn set_power(&mut self, power: Power) {
        self.enable_output.set_state((power == Power::On).into());
        // The light hangs between the pin and the supply.
        self.fault_light.set_state((!matches!(power, Power::Faulted(_))).into());
    }

    fn is_late(&mut self) -> bool {
        self.tick_timer.flags().contains(Flag::Update)
    }
}

/// Puts the drives off from anywhere, whatever state the program is in.
pub fn drives_off() {
    // SAFETY: one write to a set-reset register, which takes nothing from whoever owns the port.
    let port = unsafe { &*pac::GPIOB::ptr() };
    port.bsrr().write(|w| w.br14().set_bit());
}
