//! Quadrature counters on TIM3, TIM4, TIM5 and TIM8, latched by the timer of the ticks on channel 4 and at an index pulse on channel 3.

use stm32f4xx_hal::pac::{TIM3, TIM4, TIM5, TIM8};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::two_drives::counters::{Counters, IndexedCounter, Timers};

/// The counters of this chip.
pub struct BoardCounters;

impl Counters for BoardCounters {
    type X = TIM3;
    type Y = TIM4;
    type XScale = TIM5;
    type YScale = TIM8;
}

/// A timer that can count edges.
///
/// The input filters accept an edge after eight equal samples at 42 MHz (84 MHz for TIM8), 190 ns: they suppress interference of
/// the PWM and allow 2.6 million counts per second.
trait EncoderTimer: Enable + Reset {
    /// Sets up inputs and counter. The pins must already be assigned to the timer.
    fn set_up(&self);
}

/// The register blocks differ in type and have the same registers.
macro_rules! encoder_timer {
    ($($timer:ident: $count:ident, latched by $tick:ident,)*) => {$(
        impl EncoderTimer for $timer {
            fn set_up(&self) {
                self.ccmr1_input().write(|w| {
                    w.cc1s().ti1().ic1f().fdts_div2_n8();
                    w.cc2s().ti2().ic2f().fdts_div2_n8()
                });
                self.ccmr2_input().write(|w| {
                    w.cc3s().ti3().ic3f().fdts_div2_n8();
                    w.cc4s().trc()
                });
                self.ccer()
                    .write(|w| w.cc1e().set_bit().cc2e().set_bit().cc3e().set_bit().cc4e().set_bit());
                self.smcr().write(|w| w.ts().$tick().sms().encoder_mode_3());
                self.arr().write(|w| w.arr().set($count::MAX));
                self.cr1().write(|w| w.cen().set_bit());
            }
        }

        impl IndexedCounter for $timer {
            type Count = $count;

            fn count(&self) -> $count {
                self.cnt().read().cnt().bits()
            }

            fn latched(&self) -> $count {
                self.ccr4().read().ccr().bits()
            }

            fn take_index(&self) -> Option<$count> {
                // Reading the captured value clears the flag.
                let captured = self.sr().read().cc3if().bit_is_set();
                captured.then(|| self.ccr3().read().ccr().bits())
            }
        }
    )*};
}

// The input of each timer to which TIM2, the timer of the ticks, is connected (RM0090, tables of TIMx_SMCR in chapters 17 and 18).
encoder_timer! {
    TIM3: u16, latched by itr1,
    TIM4: u16, latched by itr1,
    TIM5: u32, latched by itr0,
    TIM8: u16, latched by itr1,
}

fn started<Timer: EncoderTimer>(timer: Timer, rcc: &mut Rcc) -> Timer {
    Timer::enable(rcc);
    Timer::reset(rcc);
    timer.set_up();
    timer
}

/// Starts the counters: motor encoders of X and Y, scales of X and Y.
pub fn start((x, y, x_scale, y_scale): (TIM3, TIM4, TIM5, TIM8), rcc: &mut Rcc) -> Timers<BoardCounters> {
    Timers {
        x: started(x, rcc),
        y: started(y, rcc),
        x_scale: started(x_scale, rcc),
        y_scale: started(y_scale, rcc),
    }
}
