//! Dual feedback: the motor reading, shifted until it agrees with the table reading.
//!
//! Soeda's system (1977) has two phase detectors. The first compares the command with the resolver
//! and drives the motor; the second compares the resolver with the scale and, through an integrator K'/s, shifts the
//! phase of the resolver excitation. With the motor position Qo', the table position Qo and the shift added to the phase
//! of the motor, the resolver reads
//!
//! ```text
//! Qf = Qo' + (Qo − Qf)·K'/s          so       Qf = s/(s + K')·Qo' + K'/(s + K')·Qo
//! Qf = Qo' + K'/(s + K')·(Qo − Qo')
//! ```
//!
//! The second and third form are the first solved for Qf. A shifted excitation is thus equivalent to the motor position
//! plus the low-pass filtered difference with the crossover K': above K' the loop closes on the motor, which is stiff and
//! has little noise, and below it on the table. [`Feedback`] implements the first form with positions in place of
//! phases: they wrap in the same way and are as exact.
//!
//! ```text
//! shift += fraction·(table − (motor + shift))       fraction = 1 − e^(−tick·K')
//! feedback = motor + shift
//! ```
//!
//! This is the exact discretisation for readings held over a tick. With a fraction of 1 the feedback is the table
//! reading, bit for bit: the full-closed loop.
//!
//! # Response to lost motion
//!
//! With the lost motion ΔQ = Qo' − Qo, the position gain K = 1/T, K' = 1/T' and a constant command, the table moves by
//!
//! ```text
//! Qo/ΔQ = 1/((1 + Ts)(1 + T's)) − 1 = −s(T + T' + TT's)/((1 + Ts)(1 + T's))
//! step of ΔQ, T ≠ T':  Qo = −ΔQ·(T·e^(−t/T) − T'·e^(−t/T'))/(T − T')
//!             T = T':  Qo = −ΔQ·(1 + t/T)·e^(−t/T)
//! ramp r per second,
//!             T ≠ T':  Qo = −r·(T²(1 − e^(−t/T)) − T'²(1 − e^(−t/T')))/(T − T') → −r·(T + T')
//!             T = T':  Qo = −r·(2T − (2T + t)·e^(−t/T))
//! ```
//!
//! The magnitude of Qo/ΔQ rises as ω(T + T'), is 1 at ω = 1/√(2TT') and never exceeds 2/√3 (1.25 dB, at
//! T = T' and ω = √2/T). The corner frequencies are 1/(T + T'), where the low-frequency asymptote meets 0 dB, 1/T and 1/T'
//! (poles) and (T + T')/(TT') (zero). The output of the second detector does not depend on the position loop:
//!
//! ```text
//! Qc = Qo − Qf = −s/(s + K')·ΔQ
//! step ΔQb:  −ΔQb·e^(−K't)      ramp ΔQp per second:  −ΔQp/K'·(1 − e^(−K't))      both: their sum
//! ```
//!
//! For a step and a ramp together this is a weighted mean of the backlash `ΔQb` (weight 1 at first) and of `ΔQp`/K'
//! (weight 1 in the end). So its magnitude never exceeds the greater of the two (nor, if their signs agree, falls below
//! the lesser), and each part is below the lost motion that causes it.
//!
//! The text of the paper was available as a scan with character recognition, without its figures. It differs from the
//! derivation above:
//!
//! - the condition above the partial fractions reads `T = T'`; it must be T ≠ T';
//! - `ΔQp` is used for `ΔQp`/K', which is the same number only for the paper's K' of 1/s;
//! - it states that Qc exceeds neither `ΔQp` nor `ΔQb`. By its own two cases and the formula, Qc does not exceed the
//!   greater one;
//! - it states that a magnitude above 1 rules out T' far below T. By its own formula the magnitude is symmetric in T and
//!   T', and is highest, 2/√3, when they are equal.
//!
//! # Loss and return of the scale
//!
//! Without a reading of the table the shift is held: the loop is semi-closed from that tick on, and the feedback follows
//! the motor. When the scale returns, its difference from the feedback is subtracted from the reading as an offset that
//! fades out with a time constant of its own ([`super::exponential_decay`]), the same in every number format; after that the
//! reading is used as it is. [`Feedback::scale_status`] reports the phase.
//!
//! # Example
//!
//! The table falls behind by 10 µm in one step. The feedback follows with the time constant T: by 1 − 1/e after T.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates, ScaleLimits, Sensors};
//! use shared::feedback::dual::State;
//! use shared::units::Position;
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let sensors = Sensors::Dual { time_constant_s: 0.05, limits: ScaleLimits::DEFAULT };
//! let settings = AxisSettings { sensors, ..AxisSettings::default() };
//! let axis = AxisConfig::<f64>::new(&settings, rates).unwrap();
//! let (motor, table) = (Position(0), Position::from_m(-10e-6).unwrap());
//! let mut state = State::settled(motor, Some(motor));
//! let mut feedback = motor;
//! for _ in 0..1000 {
//!     feedback = axis.feedback.position(&mut state, motor, Some(table));
//! }
//! let exact = -10e-6 * (1.0 - (-1f64).exp());
//! assert!((feedback.to_m() - exact).abs() < 1e-12);
//! ```

use super::exponential_decay::ExponentialDecay;
use crate::scalar::Scalar;
use crate::units::Position;

/// The sensors that close the position loop, with their constants.
#[derive(Clone, Copy, Debug)]
pub enum Feedback<S: Scalar> {
    /// Motor encoder alone (semi-closed loop).
    Motor,
    /// Linear scale alone (full-closed loop).
    Table {
        /// Fade-out of the offset of a scale that has returned.
        fade: ExponentialDecay,
    },
    /// Both.
    Dual {
        /// Fraction of the difference that is corrected per position tick, 1 − e^(−tick·K').
        fraction: S::Gain,
        /// Fade-out of the offset of a scale that has returned.
        fade: ExponentialDecay,
    },
}

/// How the loop uses the linear scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleStatus {
    /// The loop closes on the motor alone.
    NotUsed,
    /// Read and used.
    Used,
    /// Read, with an offset that is fading out after its return.
    FadingIn,
    /// No reading: the loop is semi-closed.
    Missing,
}

/// State of the feedback.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Feedback − motor (the shift of the resolver excitation), position units.
    shift: i64,
    /// Offset that is subtracted from the table reading since its return, position units.
    offset: i64,
    scale: Scale,
}

/// The scale of a loop that uses one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Scale {
    #[default]
    Used,
    /// With the offset.
    FadingIn,
    Missing,
}

impl State {
    /// Settled at the difference of two readings.
    #[must_use]
    pub const fn settled(motor: Position, table: Option<Position>) -> Self {
        let (shift, scale) = match table {
            Some(table) => (table.0.wrapping_sub(motor.0), Scale::Used),
            None => (0, Scale::Missing),
        };
        Self { shift, offset: 0, scale }
    }

    /// The filter after the readings of motor and table have been shifted by these distances, position units.
    #[must_use]
    pub const fn shifted(self, motor: i64, table: i64) -> Self {
        Self { shift: self.shift.wrapping_add(table).wrapping_sub(motor), ..self }
    }
}

impl<S: Scalar> Feedback<S> {
    /// Whether the loop uses a linear scale.
    #[must_use]
    pub const fn uses_scale(&self) -> bool {
        !matches!(self, Self::Motor)
    }

    /// The feedback of a loop that is closed at these readings.
    #[must_use]
    pub fn settled(&self, motor: Position, table: Option<Position>) -> Position {
        match self {
            Self::Motor => motor,
            Self::Table { .. } | Self::Dual { .. } => table.unwrap_or(motor),
        }
    }

    /// The feedback position, once per position tick.
    pub fn position(&self, state: &mut State, motor: Position, table: Option<Position>) -> Position {
        if let Self::Motor = self {
            return motor;
        }
        let feedback = motor + state.shift;
        let Some(table) = table else {
            state.scale = Scale::Missing;
            return feedback;
        };
        // Second phase detector.
        let mut difference = table - feedback;
        if state.scale != Scale::Used {
            difference = self.fade_in(state, difference);
        }
        let step = match self {
            Self::Dual { fraction, .. } => S::to_distance(S::from_distance(difference) * *fraction),
            _ => difference,
        };
        state.shift = state.shift.wrapping_add(step);
        feedback + step
    }

    /// The difference for a scale that has returned.
    #[cold]
    #[inline(never)]
    fn fade_in(&self, state: &mut State, difference: i64) -> i64 {
        state.offset = match self {
            Self::Table { fade } | Self::Dual { fade, .. } if state.scale == Scale::FadingIn => {
                fade.step(state.offset)
            }
            _ => difference,
        };
        state.scale = if state.offset == 0 { Scale::Used } else { Scale::FadingIn };
        difference.wrapping_sub(state.offset)
    }

    /// How the last call of [`Feedback::position`] used the scale.
    #[must_use]
    pub const fn scale_status(&self, state: &State) -> ScaleStatus {
        match (self, state.scale) {
            (Self::Motor, _) => ScaleStatus::NotUsed,
            (_, Scale::Missing) => ScaleStatus::Missing,
            (_, Scale::Used) => ScaleStatus::Used,
            (_, Scale::FadingIn) => ScaleStatus::FadingIn,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;
    use crate::units::PER_NM;

    const TICK: f64 = 1.0 / 20_000.0;

    fn fade() -> ExponentialDecay {
        ExponentialDecay::new(0.1 / TICK)
    }

    fn dual<S: Scalar>(time_constant: f64) -> Feedback<S> {
        Feedback::Dual { fraction: S::gain(1.0 - (-TICK / time_constant).exp()), fade: fade() }
    }

    /// The response to a step of the difference is 1 − e^(−t/T).
    fn worst_nm<S: Scalar>() -> f64 {
        let time_constant = 0.08;
        let feedback = dual::<S>(time_constant);
        let mut state = State::default();
        let step = Position::from_m(10e-6);
        let mut worst = 0.0f64;
        for k in 1..=10_000 {
            let nm = 1e9 * feedback.position(&mut state, Position(0), step).to_m();
            let exact = 10_000.0 * (1.0 - f64::exp(-f64::from(k) * TICK / time_constant));
            worst = worst.max((nm - exact).abs());
        }
        worst
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn follows_the_table_with_its_time_constant() {
        // Each tick rounds by up to half a position unit, 0.5e-6 nm, and 1/fraction = 1600 ticks accumulate.
        assert!(worst_nm::<f64>() < 1e-3, "{}", worst_nm::<f64>());
        // In addition, the fraction is rounded to 2⁻²⁵ of itself: 3e-8 of 10 µm.
        assert!(worst_nm::<f32>() < 2e-3, "{}", worst_nm::<f32>());
        // The fraction, 6.2e-4, is rounded by 2⁻²⁵: 5e-5 relative, 0.18 nm at the greatest slope.
        assert!(worst_nm::<Fixed>() < 0.25, "{}", worst_nm::<Fixed>());
    }

    /// Readings of a motor in uneven motion with the table 10 to 20 µm behind.
    fn readings(tick: i64) -> (Position, Position) {
        let motor = tick * 1234 * PER_NM + (tick * tick % 977) * PER_NM / 7;
        let lag = 10_000 * PER_NM + (tick * 37 % 10_000) * PER_NM;
        (Position(motor), Position(motor - lag))
    }

    #[test]
    fn full_closed_feedback_is_the_table_reading_to_the_bit() {
        let feedback = Feedback::<Fixed>::Table { fade: fade() };
        let (motor, table) = readings(0);
        let mut state = State::settled(motor, Some(table));
        for tick in 0..10_000 {
            let (motor, table) = readings(tick);
            assert_eq!(feedback.position(&mut state, motor, Some(table)), table);
            assert_eq!(feedback.scale_status(&state), ScaleStatus::Used);
        }
        assert_eq!(Feedback::<Fixed>::Motor.scale_status(&state), ScaleStatus::NotUsed);
    }

    /// While the scale is lost the feedback follows the motor, to the position unit.
    fn follows_motor_without_scale<S: Scalar>(feedback: Feedback<S>) {
        let (motor, table) = readings(0);
        let mut state = State::settled(motor, Some(table));
        for tick in 0..5000 {
            let (motor, table) = readings(tick);
            feedback.position(&mut state, motor, Some(table));
        }
        let held = state.shift;
        assert!((-20_000 * PER_NM..-10_000 * PER_NM).contains(&held), "{held}");
        for tick in 5000..10_000 {
            let (motor, _) = readings(tick);
            assert_eq!(feedback.position(&mut state, motor, None), motor + held);
            assert_eq!(feedback.scale_status(&state), ScaleStatus::Missing);
        }
    }

    #[test]
    fn the_loss_of_the_scale_causes_no_jump() {
        follows_motor_without_scale(Feedback::<Fixed>::Table { fade: fade() });
        follows_motor_without_scale(dual::<Fixed>(0.01));
        follows_motor_without_scale(dual::<f32>(0.01));
        follows_motor_without_scale(dual::<f64>(0.01));
    }

    /// Feedback − motor in every tick, nm, after a lost scale returns with an offset of 100 µm.
    fn after_return<S: Scalar>(feedback: Feedback<S>, ticks: usize) -> Vec<f64> {
        let motor = Position(0);
        let mut state = State::settled(motor, Some(motor));
        feedback.position(&mut state, motor, None);
        let table = Position(100_000 * PER_NM);
        (0..ticks)
            .map(|_| {
                let position = feedback.position(&mut state, motor, Some(table));
                let fading = feedback.scale_status(&state) == ScaleStatus::FadingIn;
                assert_eq!(fading, state.offset != 0);
                1e9 * position.to_m()
            })
            .collect()
    }

    #[test]
    fn a_scale_that_returns_fades_in_with_the_time_constant() {
        let table = after_return(Feedback::<Fixed>::Table { fade: fade() }, 45_000);
        // Zero in the first tick, then 1 − e^(−t/T). Rounding away from zero is at most a unit per tick over T, 2000 units:
        // 0.002 nm. Half a step of the fraction, 2⁻³³ of 5e-4, is 100 µm·2.3e-7/e = 0.009 nm at t = T.
        for (tick, nm) in (0u32..).zip(&table) {
            let exact = 100_000.0 * (1.0 - (-f64::from(tick) * TICK / 0.1).exp());
            assert!((nm - exact).abs() < 0.012, "{tick}: {nm}, expected {exact}");
        }
        // 10¹¹ units decay to 2000 in 18 T; the remainder, at a unit per tick, in 0.7 T.
        assert!(table[38_000..].iter().all(|nm| nm.to_bits() == 100_000f64.to_bits()));
        assert!(table[34_000] < 100_000.0);
    }

    #[test]
    fn dual_feedback_fades_in_and_follows_at_the_crossover() {
        // Two first-order lags in series, T = 0.1 and T' = 0.01.
        fn worst<S: Scalar>() -> f64 {
            let (slow, fast) = (0.1, 0.01);
            (0u32..)
                .zip(after_return(dual::<S>(fast), 40_000))
                .map(|(tick, nm)| {
                    let t = f64::from(tick) * TICK;
                    let remaining = (slow * (-t / slow).exp() - fast * (-t / fast).exp()) / (slow - fast);
                    (nm - 100_000.0 * (1.0 - remaining)).abs()
                })
                .fold(0.0, f64::max)
        }
        // The fading offset is that of the end of the tick, where a held input has that of its start: an error of a tick at
        // the greatest slope, 10⁻⁴ m/0.1 s.
        let held = 100_000.0 * TICK / 0.1;
        for worst in [worst::<Fixed>(), worst::<f32>(), worst::<f64>()] {
            assert!(worst < held && worst > 0.2 * held, "{worst}, bound {held}");
        }
    }

    proptest! {
        /// Through any loss and return of the scale, the feedback follows the motor to within the fade of one tick.
        #[test]
        fn the_feedback_never_jumps(readings in prop::collection::vec((any::<bool>(), -1_000_000_000_000i64..1_000_000_000_000), 1..300)) {
            let feedback = Feedback::<Fixed>::Table { fade: fade() };
            let mut state = State::settled(Position(0), Some(Position(0)));
            let (mut last, mut was_read, mut offset, mut max_offset) = (Position(0), true, 0i64, 0);
            for (read, motor) in readings {
                // The table slips relative to the motor while the scale is lost.
                if !was_read && !read {
                    offset = motor / 3;
                    max_offset = max_offset.max(offset.unsigned_abs());
                }
                let motor = Position(motor);
                let position = feedback.position(&mut state, motor, read.then(|| motor + offset));
                let shift = Position(position - motor);
                // The difference is at most two slips; a tick corrects 1/2000 of it, and one unit for the rounding.
                prop_assert!((shift - last).unsigned_abs() <= 2 * max_offset / 1999 + 1);
                last = shift;
                was_read = read;
            }
        }
    }
}
