//! Quadrature counters on TIM3, TIM4, TIM5 and TIM8, with the counter latched at an index pulse on channel 3.

use shared::feedback::counter::Counter;
use shared::feedback::encoder::Encoder;
use shared::feedback::long_count::LongCount;
use shared::units::Position;
use stm32f4xx_hal::pac::{TIM3, TIM4, TIM5, TIM8};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::setup::SetupError;

/// A timer in encoder mode.
///
/// The input filters accept an edge after eight equal samples at 42 MHz (84 MHz for TIM8), 190 ns: they suppress interference of
/// the PWM and allow 2.6 million counts per second.
pub trait EncoderTimer: Enable + Reset {
    /// Value of the counter.
    type Count: Copy;

    /// Sets up inputs and counter. The pins must already be assigned to the timer.
    fn start(&self);

    /// The counter.
    fn count(&self) -> Self::Count;

    /// The counter at the last index pulse since the previous call.
    fn take_index(&self) -> Option<Self::Count>;
}

/// The register blocks differ in type and have the same registers.
macro_rules! encoder_timer {
    ($($timer:ident: $count:ident,)*) => {$(
        impl EncoderTimer for $timer {
            type Count = $count;

            fn start(&self) {
                self.ccmr1_input().write(|w| {
                    w.cc1s().ti1().ic1f().fdts_div2_n8();
                    w.cc2s().ti2().ic2f().fdts_div2_n8()
                });
                self.ccmr2_input().write(|w| w.cc3s().ti3().ic3f().fdts_div2_n8());
                self.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit().cc3e().set_bit());
                self.smcr().write(|w| w.sms().encoder_mode_3());
                self.arr().write(|w| w.arr().set($count::MAX));
                self.cr1().write(|w| w.cen().set_bit());
            }

            fn count(&self) -> $count {
                self.cnt().read().cnt().bits()
            }

            fn take_index(&self) -> Option<$count> {
                // Reading the captured value clears the flag.
                let captured = self.sr().read().cc3if().bit_is_set();
                captured.then(|| self.ccr3().read().ccr().bits())
            }
        }
    )*};
}

encoder_timer! {
    TIM3: u16,
    TIM4: u16,
    TIM5: u32,
    TIM8: u16,
}

/// A 16-bit counter and its conversion to a position.
pub struct Quadrature<Timer> {
    timer: Timer,
    encoder: Encoder,
}

impl<Timer: EncoderTimer<Count = u16>> Quadrature<Timer> {
    /// Starts the counter, with position zero at the present position.
    ///
    /// # Errors
    /// [`SetupError::Encoder`] unless the magnitude of a count is 1 pm to 1 mm.
    pub fn new(timer: Timer, metres_per_count: f64, rcc: &mut Rcc) -> Result<Self, SetupError> {
        Timer::enable(rcc);
        Timer::reset(rcc);
        timer.start();
        let encoder = Encoder::new(metres_per_count, timer.count());
        Ok(Self { encoder: encoder.ok_or(SetupError::Encoder)?, timer })
    }

    /// The position.
    pub fn position(&mut self) -> Position {
        self.encoder.read(self.timer.count())
    }

    /// The position at an index pulse since the previous call. To be called after [`Quadrature::position`] of the same tick.
    pub fn take_index(&mut self) -> Option<Position> {
        self.timer.take_index().map(|count| self.encoder.position_at(count))
    }
}

/// A counter of 32 bits without a conversion, at the input of a scale where there is none: an axis may follow it.
pub struct FreeCounter(TIM5);

impl FreeCounter {
    /// Starts the counter.
    pub fn new(timer: TIM5, rcc: &mut Rcc) -> Self {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        timer.start();
        Self(timer)
    }

    /// The counter.
    pub fn count(&self) -> u32 {
        self.0.count()
    }
}

/// A counter of 16 bits, counted on over 32, as [`FreeCounter`].
pub struct LongFreeCounter {
    timer: TIM8,
    count: LongCount,
}

impl LongFreeCounter {
    /// Starts the counter.
    pub fn new(timer: TIM8, rcc: &mut Rcc) -> Self {
        TIM8::enable(rcc);
        TIM8::reset(rcc);
        timer.start();
        Self { count: LongCount::at(timer.count()), timer }
    }

    /// The counter. To be called in every tick.
    pub fn count(&mut self) -> u32 {
        self.count.read(self.timer.count())
    }
}

/// A 32-bit counter and its conversion to a position.
pub struct LongQuadrature<Timer> {
    timer: Timer,
    counter: Counter,
}

impl<Timer: EncoderTimer<Count = u32>> LongQuadrature<Timer> {
    /// Starts the counter, with position zero at the present position.
    ///
    /// # Errors
    /// [`SetupError::Encoder`] unless the magnitude of a count is 1 pm to 1 µm.
    pub fn new(timer: Timer, metres_per_count: f64, rcc: &mut Rcc) -> Result<Self, SetupError> {
        Timer::enable(rcc);
        Timer::reset(rcc);
        timer.start();
        let counter = Counter::new(metres_per_count, timer.count());
        Ok(Self { counter: counter.ok_or(SetupError::Encoder)?, timer })
    }

    /// The position.
    pub fn position(&self) -> Position {
        self.counter.position(self.timer.count())
    }

    /// The position at an index pulse since the previous call.
    pub fn take_index(&self) -> Option<Position> {
        self.timer.take_index().map(|count| self.counter.position(count))
    }
}
