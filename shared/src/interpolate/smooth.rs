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
//! use shared::interpolate::smooth::{Filters, Smoothing, State};
//! use shared::units::Position;
//!
//! let filters = Filters::new(&[Smoothing::Trapezoid { time_s: 0.004 }], 1000.0)?;
//! let mut state = State::at([Position(0)]);
//! let outputs = [(); 5].map(|()| state.step(&filters, &[Position(4000)])[0].0);
//! assert_eq!(outputs, [1000, 2000, 3000, 4000, 4000]);
//! # Ok::<(), shared::interpolate::PathError>(())
//! ```

use serde::{Deserialize, Serialize};

use super::error::{Field, PathError};
use crate::integer::{mul_q32, mul_q32_shifted};
use crate::units::Position;

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
    /// A moving mean over a number of ticks.
    Mean(u16, Divisor),
    /// Two moving means in series, the longer first, and the product of their ticks.
    Means([u16; 2], Divisor),
    /// A first-order lag with α, 32 fraction bits.
    Lag(u32),
}

/// A divisor and its reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor {
    value: u32,
    /// 2^(32 + `shift`)/value, rounded up: 32 bits.
    reciprocal: u32,
    shift: u32,
}

impl Divisor {
    /// From 2 to [`WINDOW`]².
    fn new(value: u32) -> Self {
        let value = value.max(2);
        let shift = (value - 1).ilog2();
        let reciprocal = (1u64 << (32 + shift)).div_ceil(u64::from(value));
        #[expect(clippy::cast_possible_truncation, reason = "the value is above 2^shift")]
        Self { value, reciprocal: reciprocal as u32, shift }
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
            (_, 0 | 1) => Self::Mean(long, Divisor::new(long.into())),
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

/// State of the filters of all axes.
#[derive(Clone, Debug)]
pub struct State<const N: usize> {
    /// The last inputs; the next ones are written at `next`. Inputs before the last [`State::rest_at`] count as those of it, so
    /// that the window need not be written then.
    window: [[i64; N]; WINDOW],
    next: u16,
    /// Number of inputs written, up to the length of the window.
    written: u16,
    /// Whether every filter has all the inputs that it depends on.
    is_filled: bool,
    /// Number of ticks for which no input has changed.
    unchanged_ticks: u16,
    axes: [AxisState; N],
    /// Last outputs.
    outputs: [Position; N],
}

/// State of the filter of an axis.
#[derive(Clone, Copy, Debug)]
struct AxisState {
    /// Input at the last rest.
    initial: i64,
    /// Growth of the sum of two means per tick.
    growth: i64,
    /// Sum − divisor·output of the means.
    remainder: i64,
    /// Last input.
    input: i64,
}

impl AxisState {
    const fn at(position: Position) -> Self {
        let position = position.0;
        Self { initial: position, growth: 0, remainder: 0, input: position }
    }

    /// Two means: inputs now, after the ticks of each, and after the sum of both.
    fn add_to_means(&mut self, output: &mut Position, [now, long, short, both]: [i64; 4], divisor: &Divisor) {
        let growth = now.wrapping_sub(long).wrapping_sub(short.wrapping_sub(both));
        self.growth = self.growth.wrapping_add(growth);
        self.add(output, self.growth, divisor);
    }

    /// Adds to the sum that the output is a fraction of.
    fn add(&mut self, output: &mut Position, growth: i64, divisor: &Divisor) {
        let remainder = self.remainder.wrapping_add(growth);
        // The reciprocal is rounded up: a remainder of n gives 1, one below n gives 0. An excess for a large remainder is
        // corrected in the next tick, since the remainder itself is exact.
        let change = mul_q32_shifted(remainder, divisor.reciprocal, divisor.shift);
        *output += change;
        self.remainder = remainder.wrapping_sub(change.wrapping_mul(i64::from(divisor.value)));
    }
}

impl<const N: usize> State<N> {
    /// At rest at zero.
    pub const AT_ZERO: Self = Self {
        window: [[0; N]; WINDOW],
        next: 0,
        written: 0,
        is_filled: false,
        unchanged_ticks: u16::MAX,
        axes: [AxisState::at(Position(0)); N],
        outputs: [Position(0); N],
    };

    /// At rest.
    #[must_use]
    pub fn at(positions: [Position; N]) -> Self {
        Self { axes: positions.map(AxisState::at), outputs: positions, ..Self::AT_ZERO }
    }

    /// Rests at other positions, without writing the window.
    pub fn rest_at(&mut self, positions: &[Position; N]) {
        (self.axes, self.outputs) = (positions.map(AxisState::at), *positions);
        (self.written, self.is_filled, self.unchanged_ticks) = (0, false, u16::MAX);
    }

    /// The last commands.
    #[must_use]
    pub const fn outputs(&self) -> &[Position; N] {
        &self.outputs
    }

    /// The commands for positions on the path, once per position tick.
    pub fn step(&mut self, filters: &Filters<N>, inputs: &[Position; N]) -> [Position; N] {
        let mut changed = false;
        for (axis, input) in self.axes.iter_mut().zip(inputs) {
            changed |= axis.input != input.0;
            axis.input = input.0;
        }
        self.unchanged_ticks = if changed { 0 } else { self.unchanged_ticks.saturating_add(1) };
        match &filters.common_means {
            Some(means) if self.is_filled => self.step_together(means),
            _ => self.step_each(filters),
        }
        if let Some(slot) = self.window.get_mut(Self::index(self.next)) {
            *slot = inputs.map(|input| input.0);
        }
        self.next = self.next.wrapping_add(1);
        self.outputs
    }

    /// Two means that are the same on every axis, for a window that has been filled.
    fn step_together(&mut self, means: &CommonMeans) {
        let [long, short] = means.ticks;
        let delayed = |ticks| self.window.get(Self::index(self.next.wrapping_sub(ticks)));
        let (Some(longs), Some(shorts), Some(both)) = (delayed(long), delayed(short), delayed(long + short))
        else {
            return;
        };
        for ((((axis, output), long), short), both) in
            self.axes.iter_mut().zip(&mut self.outputs).zip(longs).zip(shorts).zip(both)
        {
            axis.add_to_means(output, [axis.input, *long, *short, *both], &means.divisor);
        }
    }

    /// Any filters.
    #[inline(never)]
    fn step_each(&mut self, filters: &Filters<N>) {
        for (i, filter) in filters.axes.iter().enumerate() {
            let delayed = |ticks| self.delayed(i, ticks);
            let taps = match filter {
                Filter::Mean(long, _) => [delayed(*long), 0, 0],
                Filter::Means([long, short], _) => [delayed(*long), delayed(*short), delayed(*long + *short)],
                Filter::Pass | Filter::Lag(_) => [0; 3],
            };
            let (Some(axis), Some(output)) = (self.axes.get_mut(i), self.outputs.get_mut(i)) else { return };
            let ([long, short, both], input) = (taps, axis.input);
            match filter {
                Filter::Pass => *output = Position(input),
                Filter::Mean(_, divisor) => axis.add(output, input.wrapping_sub(long), divisor),
                Filter::Means(_, divisor) => axis.add_to_means(output, [input, long, short, both], divisor),
                Filter::Lag(alpha) => {
                    let lag = Position(input) - *output;
                    // Rounded away from zero, so that the lag ends.
                    let change = mul_q32(lag, *alpha).wrapping_add(i64::from(lag > 0));
                    *output += change;
                }
            }
        }
        self.written = self.written.saturating_add(1);
        self.is_filled = self.written >= filters.memory;
    }

    /// The input of an axis 1 to [`WINDOW`] ticks ago.
    fn delayed(&self, axis: usize, ticks: u16) -> i64 {
        let written =
            self.window.get(Self::index(self.next.wrapping_sub(ticks))).filter(|_| ticks <= self.written);
        let initial = || self.axes.get(axis).map_or(0, |axis| axis.initial);
        written.and_then(|inputs| inputs.get(axis)).copied().unwrap_or_else(initial)
    }

    /// Place in the window.
    fn index(count: u16) -> usize {
        usize::from(count) % WINDOW
    }

    /// Whether the commands have reached the inputs, and stay there while these do not change.
    #[must_use]
    pub fn is_settled(&self, filters: &Filters<N>) -> bool {
        self.unchanged_ticks >= filters.memory
            && self.axes.iter().zip(&self.outputs).all(|(axis, output)| output.0 == axis.input)
    }
}
