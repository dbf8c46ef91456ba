//! Quadrature counters, latched in hardware at the start of a tick and at an index pulse, and their conversion to positions. Their registers are those of
//! the chip.

use shared::feedback::counter::Counter;
use shared::feedback::encoder::Encoder;
use shared::feedback::long_count::LongCount;
use shared::units::Position;

use crate::setup::SetupError;

/// A running timer in encoder mode.
pub trait IndexedCounter {
    /// Value of the counter.
    type Count: Copy;

    /// The counter now.
    fn count(&self) -> Self::Count;

    /// The counter when the present tick was due, also if the program begins it late, by less than a period: at 1 m/s, 5 µs are 5 µm.
    fn latched(&self) -> Self::Count;

    /// The counter at the last index pulse since the previous call.
    fn take_index(&self) -> Option<Self::Count>;
}

/// The types of the counters of a chip.
pub trait Counters {
    /// Motor encoder of X.
    type X: IndexedCounter<Count = u16>;
    /// Motor encoder of Y.
    type Y: IndexedCounter<Count = u16>;
    /// Scale of X.
    type XScale: IndexedCounter<Count = u32>;
    /// Scale of Y.
    type YScale: IndexedCounter<Count = u16>;
}

/// The running counters of motor encoders and scales.
pub struct Timers<C: Counters> {
    /// Motor encoder of X.
    pub x: C::X,
    /// Motor encoder of Y.
    pub y: C::Y,
    /// Scale of X.
    pub x_scale: C::XScale,
    /// Scale of Y.
    pub y_scale: C::YScale,
}

/// A 16-bit counter and its conversion to a position.
pub struct Quadrature<Timer> {
    timer: Timer,
    encoder: Encoder,
}

impl<Timer: IndexedCounter<Count = u16>> Quadrature<Timer> {
    /// Position zero is the present position.
    ///
    /// # Errors
    /// [`SetupError::Encoder`] unless the magnitude of a count is 1 pm to 1 mm.
    pub fn new(timer: Timer, metres_per_count: f64) -> Result<Self, SetupError> {
        let encoder = Encoder::new(metres_per_count, timer.count());
        Ok(Self { encoder: encoder.ok_or(SetupError::Encoder)?, timer })
    }

    /// The position at the start of the tick.
    pub fn position(&mut self) -> Position {
        self.encoder.read(self.timer.latched())
    }

    /// The position at an index pulse since the previous call. To be called after [`Quadrature::position`] of the same tick.
    pub fn take_index(&mut self) -> Option<Position> {
        self.timer.take_index().map(|count| self.encoder.position_at(count))
    }
}

/// A counter of 32 bits without a conversion, at the input of a scale where there is none: an axis may follow it.
pub struct FreeCounter<Timer>(pub Timer);

impl<Timer: IndexedCounter<Count = u32>> FreeCounter<Timer> {
    /// The counter at the start of the tick.
    pub fn count(&self) -> u32 {
        self.0.latched()
    }
}

/// A counter of 16 bits, counted on over 32, as [`FreeCounter`].
pub struct LongFreeCounter<Timer> {
    timer: Timer,
    count: LongCount,
}

impl<Timer: IndexedCounter<Count = u16>> LongFreeCounter<Timer> {
    /// From the present count on.
    pub fn new(timer: Timer) -> Self {
        Self { count: LongCount::at(timer.count()), timer }
    }

    /// The counter at the start of the tick. To be called in every tick.
    pub fn count(&mut self) -> u32 {
        self.count.read(self.timer.latched())
    }
}

/// A 32-bit counter and its conversion to a position.
pub struct LongQuadrature<Timer> {
    timer: Timer,
    counter: Counter,
}

impl<Timer: IndexedCounter<Count = u32>> LongQuadrature<Timer> {
    /// Position zero is the present position.
    ///
    /// # Errors
    /// [`SetupError::Encoder`] unless the magnitude of a count is 1 pm to 1 µm.
    pub fn new(timer: Timer, metres_per_count: f64) -> Result<Self, SetupError> {
        let counter = Counter::new(metres_per_count, timer.count());
        Ok(Self { counter: counter.ok_or(SetupError::Encoder)?, timer })
    }

    /// The position at the start of the tick.
    pub fn position(&self) -> Position {
        self.counter.position(self.timer.latched())
    }

    /// The position at an index pulse since the previous call.
    pub fn take_index(&self) -> Option<Position> {
        self.timer.take_index().map(|count| self.counter.position(count))
    }
}
