//! Acceleration after interpolation: a filter per axis behind the path.
//!
//! | filter | response | a circle of radius R at ω shrinks to |
//! |---|---|---|
//! | trapezoid | mean over T | R·sinc(ωT/2) |
//! | S-curve | mean over T₁, then over T₂ | R·sinc(ωT₁/2)·sinc(ωT₂/2) |
//! | exponential | first-order lag τ | R/√(1 + ω²τ²) |
//!
//! with sinc x = sin x/x. For n ticks of Δ it is sin(nωΔ/2)/(n·sin(ωΔ/2)), and for the lag with the factor α per tick
//! α/√(1 + (1 − α)² − 2(1 − α)·cos ωΔ). In integer arithmetic, each filter comes to rest exactly at its input: the mean y
//! with remainder r satisfies n·y + r = Σx exactly, and r is 0 when all x are equal. Two means are one recursion with one
//! division, by n = n₁·n₂: Σx grows by s per tick, and s by x(t) − x(t − n₁) − x(t − n₂) + x(t − n₁ − n₂).
//!
//! # Example
//!
//! A step of the position through a mean over 4 ticks is a ramp of 4 ticks.
//!
//! ```
//! use shared::interpolate::smooth::state::State;
//! use shared::interpolate::smooth::{Filters, Smoothing};
//! use shared::units::Position;
//!
//! let filters = Filters::new(&[Smoothing::Trapezoid { time_s: 0.004 }], 1000.0)?;
//! let mut state = State::at([Position(0)]);
//! let outputs = [(); 5].map(|()| {
//!     state.step(&filters, &[Position(4000)], true);
//!     state.outputs()[0].0
//! });
//! assert_eq!(outputs, [1000, 2000, 3000, 4000, 4000]);
//! # Ok::<(), shared::interpolate::PathError>(())
//! ```

pub mod state;

use serde::{Deserialize, Serialize};

use super::error::{Field, PathError};

/// Greatest total length of the windows of an axis, ticks: 128 ms at 4 kHz, 4 kB per axis.
pub const WINDOW: usize = 512;

/// Least α of the lag, 32 fraction bits: a time constant of 2²⁰ ticks.
const MIN_ALPHA: f64 = 4096.0;

/// The filter of an axis, in SI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Smoothing {
    /// No filter: the command is the path.
    #[default]
    None,
    /// A mean: a step of speed becomes a ramp.
    Trapezoid {
        /// T, s.
        time_s: f64,
    },
    /// Two means: a step of speed becomes a ramp with limited jerk.
    SCurve {
        /// T₁, the longer of the two, s.
        time_s: f64,
        /// T₂, s.
        jerk_time_s: f64,
    },
    /// A first-order lag: a step of speed becomes an exponential.
    Exponential {
        /// τ, s.
        time_constant_s: f64,
    },
}

/// One tick with 16 fraction bits.
const ONE_TICK: u64 = 1 << 16;

/// The effect of a filter on a corner of the path, all with 16 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CornerRounding {
    /// κ: distance from the corner per velocity step, ticks.
    pub deviation: u64,
    /// κ₂: distance from the corner per acceleration of the adjacent ramps, ticks².
    pub deviation_by_acceleration: u64,
    /// T: duration over which a velocity step is spread, at least one tick.
    pub stretch: u64,
    /// T': rise time of the acceleration of that, at least one tick.
    pub rise: u64,
    /// W: the effects of joints within this time add up, ticks.
    pub window: u64,
}

impl CornerRounding {
    /// Without a filter a velocity step is taken within a tick.
    pub const NONE: Self = Self {
        deviation: 0,
        deviation_by_acceleration: 0,
        stretch: ONE_TICK,
        rise: ONE_TICK,
        window: ONE_TICK,
    };

    /// The worst case of two filters: most deviation, least stretch.
    #[must_use]
    pub fn worst_of(self, other: Self) -> Self {
        Self {
            deviation: self.deviation.max(other.deviation),
            deviation_by_acceleration: self.deviation_by_acceleration.max(other.deviation_by_acceleration),
            stretch: self.stretch.min(other.stretch),
            rise: self.rise.min(other.rise),
            window: self.window.max(other.window),
        }
    }
}

/// The filter of an axis, in machine units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// No filter.
    Pass,
    /// A moving mean over a number of ticks, and twice that number.
    Mean(u16, Divisor),
    /// Two moving means in series, the longer first, and the product of their ticks.
    Means([u16; 2], Divisor),
    /// A first-order lag with α, 32 fraction bits.
    Lag(u32),
}

/// A divisor n and its reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor {
    value: u32,
    /// 2³²/n, rounded up, so that a multiple of n is divided exactly.
    upper: i32,
    /// (2⁶⁴/n − 2³²·`upper`)/2, rounded down.
    half_lower: i32,
}

impl Divisor {
    /// From 3 to 2¹⁶.
    fn new(value: u32) -> Self {
        let value = value.clamp(3, 1 << 16);
        let upper = (1u64 << 32).div_ceil(u64::from(value)).cast_signed();
        let lower = (1i128 << 64) / i128::from(value) - (i128::from(upper) << 32);
        #[expect(clippy::cast_possible_truncation, reason = "below 2³¹, and from −2³² to 0")]
        Self { value, upper: upper as i32, half_lower: (lower >> 1) as i32 }
    }

    /// x/n: rounded down from 0 to 2³¹, off by up to two units for other numbers up to 2⁶⁰ in magnitude.
    fn quotient(&self, x: i64) -> i64 {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the words, both signed: one instruction for a product"
        )]
        let (upper, lower) = ((x.wrapping_add(1 << 31) >> 32) as i32, x as i32);
        let word = |a: i32, b: i32| i64::from(a).wrapping_mul(i64::from(b));
        let cross = word(lower, self.upper).wrapping_add(word(upper << 1, self.half_lower));
        word(upper, self.upper).wrapping_add(cross >> 32)
    }
}

impl Filter {
    /// Converts the settings for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// [`PathError`] with [`Field::Smoothing`] for times that are not finite, negative, longer in total than [`WINDOW`] ticks or
    /// in the wrong order, and for a time constant above 2²⁰ ticks.
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
                // α = 1 − e^(−1/τ): the lag decays as the continuous one.
                let alpha = -libm::expm1(-1.0 / (time_constant_s * rate_hz)) * 4_294_967_296.0;
                if alpha < MIN_ALPHA {
                    return Err(PathError::TooLarge(Field::Smoothing));
                }
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates at 1")]
                Ok(Self::Lag(alpha as u32))
            }
        }
    }

    fn of(long: u16, short: u16) -> Self {
        match (long, short) {
            (0 | 1, _) => Self::Pass,
            (_, 0 | 1) => Self::Mean(long, Divisor::new(2 * u32::from(long))),
            _ => Self::Means([long, short], Divisor::new(u32::from(long) * u32::from(short))),
        }
    }

    /// The rounding of a corner whose sides are passed with v·|t| + a·t²/2.
    ///
    /// With the corner in the middle of the window, the distance from it is half the step times the mean of that over the
    /// window: v·T/8 + a·T²/48 for a mean over T, v·(T₁ + T₂²/(3T₁))/8 + a·(T₁² + T₂²)/48 for two. For the lag it is at most
    /// what remains of the first side after τ: (v·τ + a·τ²)/e.
    #[must_use]
    pub fn rounding(&self) -> CornerRounding {
        const ONE: u64 = ONE_TICK;
        let means = |long: u64, short: u64| CornerRounding {
            deviation: ONE * (3 * long * long + short * short) / (24 * long),
            deviation_by_acceleration: ONE * (long * long + short * short) / 48,
            stretch: ONE * long,
            rise: ONE * short.max(1),
            window: ONE * (long + short),
        };
        match self {
            Self::Pass => CornerRounding::NONE,
            Self::Mean(long, _) => means((*long).into(), 0),
            Self::Means([long, short], _) => means((*long).into(), (*short).into()),
            Self::Lag(alpha) => {
                let lag = (1u64 << 48) / u64::from((*alpha).max(1));
                // 1/e = 0.3679
                let deviation = lag * 3679 / 10_000;
                let by_acceleration = (u128::from(deviation) * u128::from(lag)) >> 16;
                CornerRounding {
                    deviation,
                    deviation_by_acceleration: u64::try_from(by_acceleration).unwrap_or(u64::MAX),
                    stretch: lag.max(ONE),
                    rise: ONE,
                    // Steps every d ticks add up to 1/(1 − e^(−d/τ)) of one step, which is below 1 + τ/d.
                    window: lag.max(ONE),
                }
            }
        }
    }

    /// Ticks after which the output is independent of older inputs; 0 for the lag, whose memory is unlimited.
    const fn memory(&self) -> u16 {
        match self {
            Self::Pass | Self::Lag(_) => 0,
            Self::Mean(long, _) => *long,
            Self::Means([long, short], _) => *long + *short,
        }
    }
}

/// The filters of all axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filters<const N: usize> {
    /// One per axis.
    pub axes: [Filter; N],
    /// Worst case of the rounding over the axes.
    pub rounding: CornerRounding,
    /// Whether any axis has a filter.
    pub active: bool,
    /// Ticks after which no output depends on older inputs.
    memory: u16,
    /// Set if every axis has the same two means.
    common_means: Option<CommonMeans>,
}

/// Two means that are the same on every axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct CommonMeans {
    ticks: [u16; 2],
    divisor: Divisor,
}

impl<const N: usize> Filters<N> {
    /// No filters.
    pub const PASS: Self = Self {
        axes: [Filter::Pass; N],
        rounding: CornerRounding::NONE,
        active: false,
        memory: 0,
        common_means: None,
    };

    /// Converts the settings for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn new(smoothing: &[Smoothing; N], rate_hz: f64) -> Result<Self, PathError> {
        let mut filters = Self::PASS;
        let mut rounding: Option<CornerRounding> = None;
        for (filter, smoothing) in filters.axes.iter_mut().zip(smoothing) {
            *filter = Filter::new(smoothing, rate_hz)?;
            let own = filter.rounding();
            rounding = Some(rounding.map_or(own, |other| other.worst_of(own)));
        }
        filters.active = filters.axes.iter().any(|filter| *filter != Filter::Pass);
        filters.memory = filters.axes.iter().map(Filter::memory).max().unwrap_or(0);
        filters.rounding = rounding.unwrap_or(CornerRounding::NONE);
        filters.common_means = match filters.axes.first() {
            Some(first @ &Filter::Means(ticks, divisor)) if filters.axes.iter().all(|axis| axis == first) => {
                Some(CommonMeans { ticks, divisor })
            }
            _ => None,
        };
        Ok(filters)
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const RATE_HZ: f64 = 4000.0;

    /// Times of less than two ticks are none.
    #[test]
    fn a_mean_of_one_tick_is_no_filter() {
        for ticks in [0.0, 1.0] {
            assert_eq!(
                Filter::new(&Smoothing::Trapezoid { time_s: ticks / RATE_HZ }, RATE_HZ),
                Ok(Filter::Pass)
            );
        }
        assert!(
            Filter::new(&Smoothing::Trapezoid { time_s: 2.0 / RATE_HZ }, RATE_HZ)
                .is_ok_and(|f| f != Filter::Pass)
        );
    }

    /// The window has 512 ticks.
    #[test]
    fn the_longest_filter_fills_the_window() {
        let new = |ticks: f64| Filter::new(&Smoothing::Trapezoid { time_s: ticks / RATE_HZ }, RATE_HZ);
        assert!(new(512.0).is_ok());
        for ticks in [513.0, 600.0] {
            assert_eq!(new(ticks), Err(PathError::TooLarge(Field::Smoothing)));
        }
    }

    /// By the documentation of [`Filter::rounding`]: T/8 and T²/48 for a mean over 40 ticks, (T₁ + T₂²/(3T₁))/8 and (T₁² + T₂²)/48 for 40 and
    /// 20; τ/e and τ²/e for a lag of 25 ticks, whose α has an error of 1/(2τ).
    #[test]
    fn the_rounding_of_a_corner_is_that_of_the_filter() {
        let rounding = |smoothing| Filter::new(&smoothing, RATE_HZ).unwrap().rounding();
        let near = |q16: u64, exact: f64, relative: f64| {
            let found = q16 as f64 / 65_536.0;
            assert!((found - exact).abs() <= relative * exact + 1e-4, "{found}, {exact}");
        };
        let (time_s, jerk_time_s) = (40.0 / RATE_HZ, 20.0 / RATE_HZ);
        for (smoothing, t2) in
            [(Smoothing::Trapezoid { time_s }, 0.0), (Smoothing::SCurve { time_s, jerk_time_s }, 20.0f64)]
        {
            let CornerRounding { deviation, deviation_by_acceleration, stretch, rise, window } =
                rounding(smoothing);
            near(deviation, (40.0 + t2 * t2 / 120.0) / 8.0, 0.0);
            near(deviation_by_acceleration, (1600.0 + t2 * t2) / 48.0, 0.0);
            near(stretch, 40.0, 0.0);
            near(rise, t2.max(1.0), 0.0);
            near(window, 40.0 + t2, 0.0);
        }
        let lag = rounding(Smoothing::Exponential { time_constant_s: 25.0 / RATE_HZ });
        near(lag.deviation, 25.0 / core::f64::consts::E, 0.03);
        near(lag.deviation_by_acceleration, 625.0 / core::f64::consts::E, 0.05);
        near(lag.stretch, 25.0, 0.03);
        near(lag.window, 25.0, 0.03);
        near(lag.rise, 1.0, 0.0);
    }

    proptest! {
        /// The upper word of the reciprocal alone divides a positive word, and is rounded up by less than one: for n up to 2¹⁶ the
        /// excess, x/2³², does not reach the next multiple below n·2¹⁶. The products of the lower words are omitted, less than
        /// two units together.
        #[test]
        fn a_quotient_is_exact_near_zero_and_near_elsewhere(n in 3u32..=1 << 16, x in -(1i64 << 60)..1 << 60, small in 0i64..1 << 16) {
            let divisor = Divisor::new(n);
            prop_assert_eq!(divisor.quotient(small), small / i64::from(n));
            prop_assert_eq!(divisor.quotient(i64::from(n)), 1);
            prop_assert_eq!(divisor.quotient(i64::from(n) - 1), 0);
            prop_assert!(divisor.quotient(-small) < 0 || small == 0);
            let off = divisor.quotient(x) - x.div_euclid(i64::from(n));
            prop_assert!(off.abs() <= 2, "{off}");
        }
    }
}
