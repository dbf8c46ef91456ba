//! Acceleration after interpolation: a filter of each axis behind the path.
//!
//! | filter | response | a circle of radius R at ω shrinks to |
//! |---|---|---|
//! | trapezoid | mean over T | R·sinc(ωT/2) |
//! | S-curve | mean over T₁, then over T₂ | R·sinc(ωT₁/2)·sinc(ωT₂/2) |
//! | exponential | first-order lag τ | R/√(1 + ω²τ²) |
//!
//! sinc x = sin x/x; of n ticks Δ it is sin(nωΔ/2)/(n·sin(ωΔ/2)), of the lag with share α per tick
//! α/√(1 + (1 − α)² − 2(1 − α)·cos ωΔ). All of it integer, and each comes to rest on the very place
//! that it is given: n·y + r = Σx holds exactly for the mean y, and r is 0 once all x are equal.

use serde::{Deserialize, Serialize};

use super::error::{Field, PathError};
use crate::integer::mul_q32;
use crate::units::Position;

/// Ticks that the windows of an axis have together: 128 ms at 4 kHz, 4 kB an axis.
pub const WINDOW: usize = 512;

/// Least share of the lag per tick, 32 fraction bits: 2²⁰ ticks.
const LEAST_SHARE: f64 = 4096.0;

/// The filter of an axis, in SI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Smoothing {
    /// The command is the path.
    #[default]
    None,
    /// A step of speed becomes a ramp.
    Trapezoid {
        /// T.
        time_s: f64,
    },
    /// It becomes a ramp with rounded ends.
    SCurve {
        /// T₁, the longer of the two.
        time_s: f64,
        /// T₂.
        jerk_time_s: f64,
    },
    /// It becomes an exponential.
    Exponential {
        /// τ.
        time_constant_s: f64,
    },
}

/// A tick with 16 fraction bits.
const ONE_TICK: u64 = 1 << 16;

/// What a filter does to a kink of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rounding {
    /// A step of velocity leaves the kink by so many ticks of it, 16 fraction bits.
    pub deviation: u64,
    /// Accelerations beside the kink, by so many ticks² of them, 16 fraction bits.
    pub deviation_by_acceleration: u64,
    /// And is stretched to an acceleration over so many ticks, at least one, 16 fraction bits.
    pub stretch: u64,
    /// Whose own rise takes so many ticks, at least one, 16 fraction bits.
    pub rise: u64,
    /// Joints that follow each other within so many ticks add up, 16 fraction bits.
    pub window: u64,
}

impl Rounding {
    /// Without a filter a step of velocity is taken within a tick.
    pub const NONE: Self = Self {
        deviation: 0,
        deviation_by_acceleration: 0,
        stretch: ONE_TICK,
        rise: ONE_TICK,
        window: ONE_TICK,
    };

    /// The one that rounds more and stretches less.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        Self {
            deviation: self.deviation.max(other.deviation),
            deviation_by_acceleration: self.deviation_by_acceleration.max(other.deviation_by_acceleration),
            stretch: self.stretch.min(other.stretch),
            rise: self.rise.min(other.rise),
            window: self.window.max(other.window),
        }
    }
}

/// The filter of an axis, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// None.
    Pass,
    /// One mean.
    Mean(Divisor),
    /// Two.
    Means(Divisor, Divisor),
    /// 2³² of it is the whole lag in one tick.
    Lag(u32),
}

/// A number of ticks and its reciprocal with 32 fraction bits, rounded up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor {
    ticks: u16,
    reciprocal: u32,
}

impl Divisor {
    /// From 2 to [`WINDOW`] ticks.
    fn new(ticks: u16) -> Self {
        Self { ticks, reciprocal: u32::MAX / u32::from(ticks.max(2)) + 1 }
    }
}

impl Filter {
    /// Makes the filter for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// [`PathError`] with [`Field::Smoothing`]: times that are not finite, negative, longer together than
    /// [`WINDOW`] ticks, or in the wrong order; a time constant above 2²⁰ ticks.
    pub fn new(smoothing: &Smoothing, rate_hz: f64) -> Result<Self, PathError> {
        match *smoothing {
            Smoothing::None => Ok(Self::Pass),
            Smoothing::Trapezoid { time_s } => Ok(Self::of(ticks(time_s, rate_hz)?, 0)),
            Smoothing::SCurve { time_s, jerk_time_s } => {
                let (long, short) = (ticks(time_s, rate_hz)?, ticks(jerk_time_s, rate_hz)?);
                if short > long || usize::from(long + short) > WINDOW {
                    return Err(PathError::TooLarge(Field::Smoothing));
                }
                Ok(Self::of(long, short))
            }
            Smoothing::Exponential { time_constant_s } => {
                if !time_constant_s.is_finite() {
                    return Err(PathError::NotFinite(Field::Smoothing));
                }
                if time_constant_s <= 0.0 {
                    return Err(PathError::NotPositive(Field::Smoothing));
                }
                // 1 − e^(−1/τ): the lag then decays as the continuous one does.
                let share = -libm::expm1(-1.0 / (time_constant_s * rate_hz)) * 4_294_967_296.0;
                if share < LEAST_SHARE {
                    return Err(PathError::TooLarge(Field::Smoothing));
                }
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates at 1")]
                Ok(Self::Lag(share as u32))
            }
        }
    }

    fn of(long: u16, short: u16) -> Self {
        match (long, short) {
            (0 | 1, _) => Self::Pass,
            (_, 0 | 1) => Self::Mean(Divisor::new(long)),
            _ => Self::Means(Divisor::new(long), Divisor::new(short)),
        }
    }

    /// Rounding of a kink that is passed with v|t| + a·t²/2 on its two sides.
    ///
    /// When the filter is half through, the command is off by half the step times the mean of that over the
    /// window: v·T/8 + a·T²/48 for the mean over T, v·(T₁ + T₂²/(3T₁))/8 + a·(T₁² + T₂²)/48 for two. The
    /// lag is off by no more than what it still has of the first side after τ: (v·τ + a·τ²)/e.
    #[must_use]
    pub fn rounding(&self) -> Rounding {
        const ONE: u64 = ONE_TICK;
        let means = |long: u64, short: u64| Rounding {
            deviation: ONE * (3 * long * long + short * short) / (24 * long),
            deviation_by_acceleration: ONE * (long * long + short * short) / 48,
            stretch: ONE * long,
            rise: ONE * short.max(1),
            window: ONE * (long + short),
        };
        match self {
            Self::Pass => Rounding::NONE,
            Self::Mean(long) => means(long.ticks.into(), 0),
            Self::Means(long, short) => means(long.ticks.into(), short.ticks.into()),
            Self::Lag(share) => {
                let lag = (1u64 << 48) / u64::from((*share).max(1));
                // 1/e = 0.3679
                let deviation = lag * 3679 / 10_000;
                let by_acceleration = (u128::from(deviation) * u128::from(lag)) >> 16;
                Rounding {
                    deviation,
                    deviation_by_acceleration: u64::try_from(by_acceleration).unwrap_or(u64::MAX),
                    stretch: lag.max(ONE),
                    rise: ONE,
                    // Steps that follow each other after d ticks add up to 1/(1 − e^(−d/τ)), below 1 + τ/d of one.
                    window: lag.max(ONE),
                }
            }
        }
    }

    /// Ticks after which the filter has forgotten what was before, where there is such a number.
    const fn memory(&self) -> u16 {
        match self {
            Self::Pass | Self::Lag(_) => 0,
            Self::Mean(long) => long.ticks,
            Self::Means(long, short) => long.ticks + short.ticks,
        }
    }
}

/// The filters of all axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filters<const N: usize> {
    /// One an axis.
    pub axes: [Filter; N],
    /// What the axis that rounds most does to a kink.
    pub rounding: Rounding,
    /// Whether any of them does anything.
    pub smooth: bool,
}

impl<const N: usize> Filters<N> {
    /// The command of every axis is the path.
    pub const PASS: Self = Self { axes: [Filter::Pass; N], rounding: Rounding::NONE, smooth: false };

    /// Makes the filters for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn new(smoothing: &[Smoothing; N], rate_hz: f64) -> Result<Self, PathError> {
        let mut made = Self::PASS;
        let mut rounding: Option<Rounding> = None;
        for (filter, smoothing) in made.axes.iter_mut().zip(smoothing) {
            *filter = Filter::new(smoothing, rate_hz)?;
            let this = filter.rounding();
            rounding = Some(rounding.map_or(this, |other| other.worse(this)));
        }
        made.smooth = made.axes.iter().any(|filter| *filter != Filter::Pass);
        made.rounding = rounding.unwrap_or(Rounding::NONE);
        Ok(made)
    }
}

fn ticks(seconds: f64, rate_hz: f64) -> Result<u16, PathError> {
    let ticks = libm::rint(seconds * rate_hz);
    if !ticks.is_finite() {
        return Err(PathError::NotFinite(Field::Smoothing));
    }
    if seconds < 0.0 {
        return Err(PathError::NotPositive(Field::Smoothing));
    }
    if ticks > WINDOW as f64 {
        return Err(PathError::TooLarge(Field::Smoothing));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 512")]
    Ok(ticks as u16)
}

/// What the filter of an axis remembers.
#[derive(Clone, Debug)]
pub struct State {
    /// The windows, one behind the other.
    past: [i64; WINDOW],
    means: [Mean; 2],
    /// What the filter shows.
    place: i64,
    /// What it was given last, and for how many ticks that has not changed.
    target: i64,
    still: u16,
}

/// A mean over a window that was filled with one place when it began.
#[derive(Clone, Copy, Debug)]
struct Mean {
    began_at: i64,
    /// Whether the window has been written once round.
    full: bool,
    next: u16,
    shows: i64,
    /// Sum of the window less ticks times what it shows.
    rest: i64,
}

impl Mean {
    const fn at(place: i64) -> Self {
        Self { began_at: place, full: false, next: 0, shows: place, rest: 0 }
    }

    /// Takes one value in and the oldest one out of the window.
    fn step(&mut self, window: &mut [i64], divisor: Divisor, value: i64) -> i64 {
        if let Some(slot) = window.get_mut(usize::from(self.next)) {
            let oldest = if self.full { *slot } else { self.began_at };
            self.rest = self.rest.wrapping_add(value.wrapping_sub(oldest));
            *slot = value;
        }
        self.next += 1;
        if self.next >= divisor.ticks {
            (self.next, self.full) = (0, true);
        }
        // The reciprocal is rounded up: a rest of n gives 1, one below n gives 0. What a large rest
        // gives too much comes back with the next tick, for the rest itself is exact.
        let more = mul_q32(self.rest, divisor.reciprocal);
        self.shows = self.shows.wrapping_add(more);
        self.rest = self.rest.wrapping_sub(more.wrapping_mul(i64::from(divisor.ticks)));
        self.shows
    }
}

impl State {
    /// At rest.
    #[must_use]
    pub const fn at(place: Position) -> Self {
        let place = place.0;
        Self { past: [0; WINDOW], means: [Mean::at(place); 2], place, target: place, still: u16::MAX }
    }

    /// At rest somewhere else: nothing of the windows has to be written for it.
    pub const fn stand_at(&mut self, place: Position) {
        self.means = [Mean::at(place.0); 2];
        (self.place, self.target, self.still) = (place.0, place.0, u16::MAX);
    }

    /// Takes the path's next place and gives the command.
    pub fn step(&mut self, filter: &Filter, target: Position) -> Position {
        self.still = if target.0 == self.target { self.still.saturating_add(1) } else { 0 };
        self.target = target.0;
        let [first, second] = &mut self.means;
        self.place = match *filter {
            Filter::Pass => target.0,
            Filter::Mean(long) => first.step(&mut self.past, long, target.0),
            Filter::Means(long, short) => {
                let (head, tail) =
                    self.past.split_at_mut_checked(usize::from(long.ticks)).unwrap_or_default();
                let mean = first.step(head, long, target.0);
                second.step(tail, short, mean)
            }
            Filter::Lag(part) => {
                let lag = target.0.wrapping_sub(self.place);
                // Rounded away from zero, so that the rest of the lag is not for ever.
                self.place.wrapping_add(mul_q32(lag, part)).wrapping_add(i64::from(lag > 0))
            }
        };
        Position(self.place)
    }

    /// Whether the command stands on the path's place and stays there while that does.
    #[must_use]
    pub const fn is_settled(&self, filter: &Filter) -> bool {
        self.place == self.target && self.still >= filter.memory()
    }
}
