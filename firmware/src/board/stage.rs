//! The power stages: PWM of TIM1, direction pins, the enable pin and that of the brakes.
//!
//! TIM1 is configured by its registers: PWM drivers of libraries let the outputs restart automatically after a break (AOE)
//! and let the pins float while the outputs are off (OSSI).
//!
//! The pulse is at the end of the period (PWM mode 2); what the signals are is in [`crate::two_drives`].

use stm32f4xx_hal::gpio::{Alternate, Output, PA8, PA9, PB12, PB14, PC10, PC11, PD2};
use stm32f4xx_hal::pac::{self, TIM1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::dac::AnalogOutputs;
use crate::setup::{self, AXES};

/// The pins that are switched by the program.
pub struct Pins {
    /// Enable input of both stages, active high.
    pub enable: PB14<Output>,
    /// Holding brakes of all axes, high: open.
    pub brakes: PD2<Output>,
    /// High for a negative force.
    pub directions: (PC10<Output>, PC11<Output>),
}

impl Pins {
    /// Enable and brakes are outputs already, so that they are low from the start on.
    pub fn new(enable: PB14<Output>, brakes: PD2<Output>, (x, y): (PC10, PC11)) -> Self {
        Self { enable, brakes, directions: (x.into_push_pull_output(), y.into_push_pull_output()) }
    }
}

/// The pins of the timer: two PWM outputs, and the break input, which stops the PWM in hardware while it is low. Their types
/// prove that they are assigned to the timer.
pub type TimerPins = (PA8<Alternate<1>>, PA9<Alternate<1>>, PB12<Alternate<1>>);

/// Both power stages.
pub struct Stages {
    timer: TIM1,
    pins: Pins,
    analog: AnalogOutputs,
    full_counts: u16,
}

impl Stages {
    /// Starts the PWM with its outputs off and low.
    ///
    /// # Panics
    /// If a PWM period is not 1 to 65,535 counts. Clock and PWM frequency are constants.
    pub fn new(
        timer: TIM1,
        pins: Pins,
        _timer_pins: TimerPins,
        analog: AnalogOutputs,
        rcc: &mut Rcc,
    ) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        let period = rcc.clocks.timclk2().raw() / setup::PWM_HZ;
        let full_counts = u16::try_from(period).expect("168 MHz over 20 kHz");

        timer.arr().write(|w| w.arr().set(full_counts - 1));
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode2().oc1pe().set_bit();
            w.oc2m().pwm_mode2().oc2pe().set_bit()
        });
        // A compare value beyond the period gives no pulse.
        timer.ccr1().write(|w| w.ccr().set(full_counts));
        timer.ccr2().write(|w| w.ccr().set(full_counts));
        timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        // Idle outputs are low (OIS of CR2). Each update triggers the timer of the ticks.
        timer.cr2().write(|w| w.mms().update());
        // Outputs are off until the program sets MOE, and are switched off by a low break input or a clock failure; they
        // never switch on by themselves. Lock level 2 protects these bits (except MOE) and the polarities until a reset.
        timer.bdtr().write(|w| {
            w.bke().set_bit().bkp().clear_bit().aoe().clear_bit().moe().clear_bit();
            w.ossr().set_bit().ossi().set_bit().lock().level2()
        });
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit().bif().clear_bit());
        timer.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
        Self { timer, pins, analog, full_counts }
    }

    /// PWM counts of full duty.
    pub const fn full_counts(&self) -> u16 {
        self.full_counts
    }

    /// Sets the direction pins.
    pub fn set_directions(&mut self, [x, y]: [bool; AXES]) {
        self.pins.directions.0.set_state(x.into());
        self.pins.directions.1.set_state(y.into());
    }

    /// Sets the compare value of an axis, for the next period.
    pub fn set_compare(&mut self, axis: usize, counts: u16) {
        let compare = if axis == 0 { self.timer.ccr1() } else { self.timer.ccr2() };
        compare.write(|w| w.ccr().set(counts));
    }

    /// Sets the analogue output of an axis.
    pub fn set_analog(&mut self, axis: usize, counts: u16) {
        self.analog.set(axis, counts);
    }

    /// Enables or disables the stages immediately.
    pub fn set_outputs(&mut self, on: bool) {
        self.timer.bdtr().modify(|_, w| w.moe().bit(on));
        self.pins.enable.set_state(on.into());
    }

    /// Opens or closes the brakes.
    pub fn set_brakes_open(&mut self, open: bool) {
        self.pins.brakes.set_state(open.into());
    }

    /// Whether the break has been active since the last call. The flag cannot be cleared while the input is low.
    pub fn take_stop(&mut self) -> bool {
        let stopped = self.timer.sr().read().bif().bit_is_set();
        if stopped {
            self.timer.sr().modify(|_, w| w.bif().clear_bit());
        }
        stopped
    }

    /// Disables the stages, closes the brakes and sets the analogue outputs to 0 V, from any context and in any state of the program.
    pub fn cut() {
        // SAFETY: these writes to set-reset registers and to the main output enable can only switch off.
        let (port, brakes, timer) = unsafe { (&*pac::GPIOB::ptr(), &*pac::GPIOD::ptr(), &*TIM1::ptr()) };
        port.bsrr().write(|w| w.br14().set_bit());
        brakes.bsrr().write(|w| w.br2().set_bit());
        timer.bdtr().modify(|_, w| w.moe().clear_bit());
        AnalogOutputs::cut();
    }
}
