//! Dual feedback: the motor's reading, shifted until it agrees with the table's.
//!
//! Soeda's system (1977) holds two phase detectors. The first compares the command with the resolver
//! and drives the motor; the second compares the resolver with the scale, and through K'/s shifts the
//! phase that the resolver is excited with. The resolver then shows, with Qo' the motor, Qo the table
//! and the shift added to the motor's own phase,
//!
//! ```text
//! Qf = Qo' + (Qo − Qf)·K'/s          so       Qf = s/(s + K')·Qo' + K'/(s + K')·Qo
//! Qf = Qo' + K'/(s + K')·(Qo − Qo')
//! ```
//!
//! The second and third form are the first solved for Qf. Motor plus low-passed difference, with the
//! crossover at K', is thus the same thing as a shifted excitation; above K' the loop closes on the
//! motor, which is stiff and quiet, and below it on the table, where the work is. [`Feedback`] is
//! written in the first form, with positions for phases: they wrap alike and are as exact.
//!
//! ```text
//! shift += share·(table − (motor + shift))       share = 1 − e^(−tick·K')
//! feedback = motor + shift
//! ```
//!
//! steps it exactly for readings held over a tick. With a share of one it is the table itself, to the
//! bit: the full-closed loop.
//!
//! # What becomes of the lost motion
//!
//! With the lost motion ΔQ = Qo' − Qo, K = 1/T of the position loop, K' = 1/T', and no command, the
//! table moves by
//!
//! ```text
//! Qo/ΔQ = 1/((1 + Ts)(1 + T's)) − 1 = −s(T + T' + TT's)/((1 + Ts)(1 + T's))
//! step of ΔQ, T ≠ T':  Qo = −ΔQ·(T·e^(−t/T) − T'·e^(−t/T'))/(T − T')
//!             T = T':  Qo = −ΔQ·(1 + t/T)·e^(−t/T)
//! ramp, r a second,
//!             T ≠ T':  Qo = −r·(T²(1 − e^(−t/T)) − T'²(1 − e^(−t/T')))/(T − T') → −r·(T + T')
//!             T = T':  Qo = −r·(2T − (2T + t)·e^(−t/T))
//! ```
//!
//! Its magnitude rises as ω(T + T'), passes 1 at ω = 1/√(2TT') and is nowhere above 2/√3 (1.25 dB, at
//! T = T' and ω = √2/T). The breaks are at 1/(T + T'), where the rising line meets 0 dB, 1/T, 1/T'
//! (poles) and (T + T')/(TT') (zero). What the second detector sees does not depend on the loop:
//!
//! ```text
//! Qc = Qo − Qf = −s/(s + K')·ΔQ
//! step ΔQb:  −ΔQb·e^(−K't)      ramp ΔQp a second:  −ΔQp/K'·(1 − e^(−K't))      both: their sum
//! ```
//!
//! For both at once this is a mean of the backlash `ΔQb` and of `ΔQp`/K', weighted from the one at first
//! to the other in the end. So it never exceeds the greater of the two (nor, where their signs agree,
//! falls below the lesser), and each part stays below the lost motion that causes it.
//!
//! The paper is at hand as a scan read by machine, without its figures. In it,
//!
//! - the condition over the partial fractions reads `T = T'`; it must be T ≠ T';
//! - `ΔQp` stands for `ΔQp`/K', which is the same number only for its K' of one a second;
//! - Qc is said to exceed neither `ΔQp` nor `ΔQb`. Its own two cases, and the formula, say: not the
//!   greater one;
//! - a magnitude above 1 is said to rule out T' far below T. By its own formula the magnitude is the
//!   same with T and T' exchanged, and is highest, 2/√3, where they are equal.
//!
//! # The scale lost, and back
//!
//! Without a reading of the table the shift stands still: the loop is semi-closed from that tick on,
//! and the feedback moves as the motor moves, nothing else. When the scale is back, the distance
//! between it and the feedback is taken off it and fades from there with a time constant of its own,
//! the same in every number format; after it has faded, the table counts as it is. [`Feedback::scale`]
//! tells which of these it is.
//!
//! # Example
//!
//! The table lags by 10 µm all at once; dual feedback takes it in with its time constant, 1 − 1/e after T.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates, Sensors};
//! use shared::feedback::dual::State;
//! use shared::units::Position;
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let sensors = Sensors::Dual { time_constant_s: 0.05 };
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

use super::fade::Fade;
use crate::scalar::Scalar;
use crate::units::Position;

/// Which sensors close the position loop.
#[derive(Clone, Copy, Debug)]
pub enum Feedback<S: Scalar> {
    /// Motor encoder alone (semi-closed loop).
    Motor,
    /// Linear scale alone (full-closed loop).
    Table {
        /// How a scale that was lost comes back.
        fade: Fade,
    },
    /// Both.
    Dual {
        /// 1 − e^(−tick·K').
        share: S::Gain,
        /// How a scale that was lost comes back.
        fade: Fade,
    },
}

/// What the loop makes of the linear scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The loop closes on the motor alone.
    NotUsed,
    /// Read and used.
    Used,
    /// Read, and what it differed by when it came back still fades.
    FadingIn,
    /// Needed and not read: the loop is semi-closed.
    Missing,
}

/// What stands between the motor and the feedback.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Feedback − motor: the shift of the resolver's excitation, position units.
    shift: i64,
    /// Taken off the table since it came back, position units.
    fading: i64,
    missing: bool,
}

impl State {
    /// Settled on the difference of two readings.
    #[must_use]
    pub const fn settled(motor: Position, table: Option<Position>) -> Self {
        let (shift, missing) = match table {
            Some(table) => (table.0.wrapping_sub(motor.0), false),
            None => (0, true),
        };
        Self { shift, fading: 0, missing }
    }
}

impl<S: Scalar> Feedback<S> {
    /// Whether the loop uses a linear scale.
    #[must_use]
    pub const fn needs_table(&self) -> bool {
        !matches!(self, Self::Motor)
    }

    /// Where the loop finds the axis when it starts on these readings.
    #[must_use]
    pub fn settled(&self, motor: Position, table: Option<Position>) -> Position {
        match self {
            Self::Motor => motor,
            Self::Table { .. } | Self::Dual { .. } => table.unwrap_or(motor),
        }
    }

    /// The position to close the loop on.
    pub fn position(&self, state: &mut State, motor: Position, table: Option<Position>) -> Position {
        let fade = match self {
            Self::Motor => return motor,
            Self::Table { fade } | Self::Dual { fade, .. } => fade,
        };
        let feedback = motor + state.shift;
        if let Some(table) = table {
            state.fading = if state.missing { table - feedback } else { fade.step(state.fading) };
            // Phase detector 2.
            let ahead = (table - feedback).wrapping_sub(state.fading);
            let step = match self {
                Self::Dual { share, .. } => S::to_distance(S::from_distance(ahead) * *share),
                _ => ahead,
            };
            state.shift = state.shift.wrapping_add(step);
        }
        state.missing = table.is_none();
        motor + state.shift
    }

    /// What the last call of [`Feedback::position`] made of the scale.
    #[must_use]
    pub const fn scale(&self, state: &State) -> Scale {
        match (self, state) {
            (Self::Motor, _) => Scale::NotUsed,
            (_, State { missing: true, .. }) => Scale::Missing,
            (_, State { fading: 0, .. }) => Scale::Used,
            _ => Scale::FadingIn,
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

    fn fade() -> Fade {
        Fade::new(0.1 / TICK)
    }

    fn dual<S: Scalar>(time_constant: f64) -> Feedback<S> {
        Feedback::Dual { share: S::gain(1.0 - (-TICK / time_constant).exp()), fade: fade() }
    }

    /// A step of the difference appears as 1 − e^(−t/T).
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
        // Each tick rounds to a unit, 1e-6 nm, of which 1/share = 1600 ticks' worth stays: half of
        // them, if all were rounded one way.
        assert!(worst_nm::<f64>() < 1e-3, "{}", worst_nm::<f64>());
        // The share is right to 2⁻²⁵ of itself: 3e-8 of 10 µm, beside that.
        assert!(worst_nm::<f32>() < 2e-3, "{}", worst_nm::<f32>());
        // The share rounds to 2⁻²⁵ of 6.2e-4: 5e-5 relative, 0.18 nm where the slope is greatest.
        assert!(worst_nm::<Fixed>() < 0.25, "{}", worst_nm::<Fixed>());
    }

    /// The motor in uneven motion, the table behind it by up to 20 µm.
    fn readings(tick: i64) -> (Position, Position) {
        let motor = tick * 1234 * PER_NM + (tick * tick % 977) * PER_NM / 7;
        let lag = 10_000 * PER_NM + (tick * 37 % 10_000) * PER_NM;
        (Position(motor), Position(motor - lag))
    }

    #[test]
    fn the_table_alone_is_the_table_to_the_bit() {
        let feedback = Feedback::<Fixed>::Table { fade: fade() };
        let (motor, table) = readings(0);
        let mut state = State::settled(motor, Some(table));
        for tick in 0..10_000 {
            let (motor, table) = readings(tick);
            assert_eq!(feedback.position(&mut state, motor, Some(table)), table);
            assert_eq!(feedback.scale(&state), Scale::Used);
        }
        assert_eq!(Feedback::<Fixed>::Motor.scale(&state), Scale::NotUsed);
    }

    /// While the scale is away the feedback moves as the motor does, to the unit.
    fn holds<S: Scalar>(feedback: Feedback<S>) {
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
            assert_eq!(feedback.scale(&state), Scale::Missing);
        }
    }

    #[test]
    fn a_lost_scale_leaves_no_jump() {
        holds(Feedback::<Fixed>::Table { fade: fade() });
        holds(dual::<Fixed>(0.01));
        holds(dual::<f32>(0.01));
        holds(dual::<f64>(0.01));
    }

    /// Feedback − motor, in nm, after a scale that was lost comes back 100 µm from where it was: once a tick.
    fn comeback<S: Scalar>(feedback: Feedback<S>, ticks: usize) -> Vec<f64> {
        let place = Position(0);
        let mut state = State::settled(place, Some(place));
        feedback.position(&mut state, place, None);
        let table = Position(100_000 * PER_NM);
        (0..ticks)
            .map(|_| {
                let found = feedback.position(&mut state, place, Some(table));
                let left = feedback.scale(&state) == Scale::FadingIn;
                assert_eq!(left, state.fading != 0);
                1e9 * found.to_m()
            })
            .collect()
    }

    #[test]
    fn a_scale_that_is_back_fades_in_with_the_time_constant() {
        let table = comeback(Feedback::<Fixed>::Table { fade: fade() }, 45_000);
        // Nothing in the first tick; then 1 − e^(−t/T). What is stepped by at least a unit more than
        // the share of it is ahead of that by at most a unit a tick over T, 2000 units: 0.002 nm; half a
        // step of the share, 2⁻³³ of 5e-4, is 100 µm·2.3e-7/e = 0.009 nm at t = T.
        for (tick, nm) in (0u32..).zip(&table) {
            let exact = 100_000.0 * (1.0 - (-f64::from(tick) * TICK / 0.1).exp());
            assert!((nm - exact).abs() < 0.012, "{tick}: {nm} for {exact}");
        }
        // 10¹¹ units sink to the 2000 that a unit a tick clears in 18 T, and those in 0.7 T.
        assert!(table[38_000..].iter().all(|nm| nm.to_bits() == 100_000f64.to_bits()));
        assert!(table[34_000] < 100_000.0);
    }

    #[test]
    fn dual_feedback_fades_in_and_follows_at_the_crossover() {
        // Two first-order lags, T = 0.1 and T' = 0.01, as in the closed form.
        fn worst<S: Scalar>() -> f64 {
            let (slow, fast) = (0.1, 0.01);
            (0u32..)
                .zip(comeback(dual::<S>(fast), 40_000))
                .map(|(tick, nm)| {
                    let t = f64::from(tick) * TICK;
                    let left = (slow * (-t / slow).exp() - fast * (-t / fast).exp()) / (slow - fast);
                    (nm - 100_000.0 * (1.0 - left)).abs()
                })
                .fold(0.0, f64::max)
        }
        // The fading distance is used a tick early for a held input, at its steepest 10⁻⁴ m/0.1 s.
        let held = 100_000.0 * TICK / 0.1;
        for worst in [worst::<Fixed>(), worst::<f32>(), worst::<f64>()] {
            assert!(worst < held && worst > 0.2 * held, "{worst} of {held}");
        }
    }

    proptest! {
        /// Whatever comes and goes, the feedback moves with the motor, but for what fades in a tick.
        #[test]
        fn nothing_jumps(seen in prop::collection::vec((any::<bool>(), -1_000_000_000_000i64..1_000_000_000_000), 1..300)) {
            let feedback = Feedback::<Fixed>::Table { fade: fade() };
            let mut state = State::settled(Position(0), Some(Position(0)));
            let (mut last, mut was_read, mut offset, mut farthest) = (Position(0), true, 0i64, 0);
            for (read, motor) in seen {
                // The table slips on the motor while nobody looks.
                if !was_read && !read {
                    offset = motor / 3;
                    farthest = farthest.max(offset.unsigned_abs());
                }
                let motor = Position(motor);
                let found = feedback.position(&mut state, motor, read.then(|| motor + offset));
                let shift = Position(found - motor);
                // Two slips can lie between; a tick takes 1/2000 of that, and a unit.
                prop_assert!((shift - last).unsigned_abs() <= 2 * farthest / 1999 + 1);
                last = shift;
                was_read = read;
            }
        }
    }
}
