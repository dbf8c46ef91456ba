//! Evenly spaced values over a position, with linear interpolation.
//!
//! The index is computed by a multiplication: there is no division in a tick. Outside its travel a [`Table`] keeps the value
//! of its end; a [`PeriodicTable`] repeats.
//!
//! # Example
//!
//! ```
//! use shared::compensate::names::PointsNames;
//! use shared::compensate::settings::Points;
//! use shared::compensate::table::{Table, ValueRange};
//! use shared::units::Position;
//!
//! let values = [0.0, 10.0, 30.0].into_iter().collect();
//! let points = Points { start_m: 0.1, spacing_m: 0.01, values };
//! let names = PointsNames { start: "start_m", spacing: "spacing_m", values: "values" };
//! let table = Table::<f64>::new(&names, &points, ValueRange { unit: 1.0, bound: 100.0 })?;
//! let at = |m| table.at(Position::from_m(m).unwrap());
//! assert!((at(0.115) - 20.0).abs() < 1e-5);
//! assert_eq!(at(0.0), 0.0);
//! assert!((at(1.0) - 30.0).abs() < 1e-5);
//! # Ok::<(), shared::config::ConfigError>(())
//! ```

use super::names::{CycleNames, PointsNames};
use super::settings::{self, POINTS, Points};
use crate::config::ConfigError;
use crate::config::check::ranged;
use crate::integer::shifted;
use crate::scalar::Scalar;
use crate::units::{PER_M, Position, TRAVEL_LIMIT_M};

/// [`POINTS`] is two to this power.
const POINTS_LOG2: u32 = POINTS.ilog2();

/// Unit and range of the values of a table.
#[derive(Clone, Copy, Debug)]
pub struct ValueRange {
    /// SI value of a signal of 1.
    pub unit: f64,
    /// Greatest magnitude of a value, SI.
    pub bound: f64,
}

/// Values over a travel.
#[derive(Clone, Copy, Debug)]
pub struct Table<S: Scalar> {
    /// One more than the points, so that the last has a neighbour.
    values: [S; POINTS + 1],
    start: Position,
    /// Distance from the first to the last point, position units shifted right by `shift`.
    span: u32,
    shift: u32,
    /// Points per shifted unit, 55 fraction bits. A span has 30 bits, so that this has 25 to 32.
    per_unit: u32,
}

/// Least period, m: that of an interferometer, below which no screw, encoder or motor has one.
const MIN_PERIOD_M: f64 = 1e-7;

/// Values over a period.
#[derive(Clone, Copy, Debug)]
pub struct PeriodicTable<S: Scalar> {
    values: [S; POINTS + 1],
    /// Periods per 2¹² position units, 64 fraction bits.
    per_unit: u64,
}

impl<S: Scalar> Table<S> {
    /// Converts points in SI.
    ///
    /// # Errors
    /// [`ConfigError`] with one of `names`: fewer than 2 points, a travel that is not from 1.1 µm to 100 m, or a value that is not
    /// finite or exceeds the bound, or neighbours that differ by the range of the number format (131 kN).
    pub fn new(names: &PointsNames, points: &Points, range: ValueRange) -> Result<Self, ConfigError> {
        let values = signals(names.values, &points.values, range)?;
        let count = points.values.len();
        let spaces = (count - 1) as f64;
        let length = points.spacing_m * spaces;
        // A travel below 2³⁰ units, 1 µm, would not have 30 bits.
        let travel_m = 1.1e-6..TRAVEL_LIMIT_M;
        if !travel_m.contains(&length) {
            let (min, max) = (travel_m.start / spaces, travel_m.end / spaces);
            return Err(ConfigError::OutOfRange { name: names.spacing, min, max });
        }
        let start = Position::from_m(points.start_m).ok_or(ConfigError::OutOfRange {
            name: names.start,
            min: -TRAVEL_LIMIT_M,
            max: TRAVEL_LIMIT_M,
        })?;
        let units = length * PER_M;
        // 30 bits of the span: a nanometre on a metre.
        let shift = (libm::log2(units) - 29.0).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 27, and 31 bits")]
        let (shift, span) = (shift as u32, (units / libm::exp2(libm::floor(shift))) as u32);
        let per_unit = libm::floor(spaces / f64::from(span.max(1)) * 36_028_797_018_963_968.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let per_unit = per_unit as u32;
        Ok(Self { values, start, span, shift, per_unit })
    }

    /// The value at a position.
    #[must_use]
    pub fn at(&self, position: Position) -> S {
        let distance = (position - self.start).max(0).cast_unsigned();
        let distance = shifted(distance, self.shift).min(self.span);
        let index = (u64::from(distance) * u64::from(self.per_unit)) >> 23;
        #[expect(clippy::cast_possible_truncation, reason = "at most 64 and its fraction")]
        let (whole, fraction_q32) = ((index >> 32) as usize, index as u32);
        interpolate(&self.values, whole, fraction_q32)
    }
}

impl<S: Scalar> PeriodicTable<S> {
    /// Zero everywhere.
    pub const ZERO: Self = Self { values: [S::ZERO; POINTS + 1], per_unit: 0 };

    /// Converts the points of a period in SI, the first at position zero.
    ///
    /// # Errors
    /// [`ConfigError`] with one of `names`: not 2 to [`POINTS`] points, a period that is not from 0.1 µm to 100 m, or a value
    /// that is not finite or exceeds the bound.
    pub fn new(names: &CycleNames, cycle: &settings::Cycle, range: ValueRange) -> Result<Self, ConfigError> {
        let points = &cycle.values;
        let count = points.len();
        check_count(names.values, count)?;
        // Resampled to POINTS points, so that the phase is the index.
        let mut resampled = [0.0; POINTS];
        for (k, value) in resampled.iter_mut().enumerate() {
            let at = k as f64 * count as f64 / POINTS as f64;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 64")]
            let (whole, fraction) = (at as usize, at - libm::floor(at));
            let [from, to] =
                [whole % count, (whole + 1) % count].map(|i| points.get(i).copied().unwrap_or(0.0));
            *value = from + (to - from) * fraction;
        }
        let values = signals(names.values, &resampled, range)?;
        let [first, .., last] = resampled;
        check_difference::<S>(names.values, first - last, range.unit)?;
        let period_m = ranged(names.period, cycle.period_m, MIN_PERIOD_M, TRAVEL_LIMIT_M)?;
        let units = period_m * PER_M / 4096.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates at one unit")]
        let per_unit = libm::rint(18_446_744_073_709_551_616.0 / units) as u64;
        Ok(Self { values, per_unit })
    }

    /// The value at a position. The phase is exact to 2⁻²³ of a period anywhere on ±2 m of 0.1 mm periods.
    #[must_use]
    pub fn at(&self, position: Position) -> S {
        let periods = (position.0 >> 12).cast_unsigned().wrapping_mul(self.per_unit);
        let phase = (periods >> 32) as u32;
        interpolate(&self.values, (phase >> (32 - POINTS_LOG2)) as usize, phase << POINTS_LOG2)
    }
}

/// The range of a difference of neighbours: see [`Scalar::lerp`].
fn check_difference<S: Scalar>(name: &'static str, difference: f64, unit: f64) -> Result<(), ConfigError> {
    let max = S::SIGNAL_LIMIT * unit;
    if difference.abs() < max {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange { name, min: -max / 2.0, max: max / 2.0 })
    }
}

/// The number of values of a table.
fn check_count(name: &'static str, count: usize) -> Result<(), ConfigError> {
    #[expect(clippy::cast_possible_truncation, reason = "64")]
    let max = POINTS as u16;
    if (2..=POINTS).contains(&count) { Ok(()) } else { Err(ConfigError::Count { name, max }) }
}

fn signals<S: Scalar>(
    name: &'static str,
    points: &[f64],
    range: ValueRange,
) -> Result<[S; POINTS + 1], ConfigError> {
    check_count(name, points.len())?;
    let ValueRange { unit, bound } = range;
    let mut values = [S::default(); POINTS + 1];
    for (value, &point) in values.iter_mut().zip(points) {
        if !point.is_finite() {
            return Err(ConfigError::NotFinite(name));
        }
        if point.abs() > bound {
            return Err(ConfigError::OutOfRange { name, min: -bound, max: bound });
        }
        *value = S::signal(point / unit);
    }
    for (point, next) in points.iter().zip(points.iter().skip(1)) {
        check_difference::<S>(name, next - point, unit)?;
    }
    // After the last point: the first one for a full (periodic) table; else the last one, which gets the weight 0.
    let next = if points.len() == POINTS { values.first() } else { values.get(points.len() - 1) };
    let next = next.copied().unwrap_or_default();
    if let Some(value) = values.get_mut(points.len()) {
        *value = next;
    }
    Ok(values)
}

/// The value between two points.
#[inline]
fn interpolate<S: Scalar>(values: &[S; POINTS + 1], whole: usize, fraction_q32: u32) -> S {
    let whole = whole & (POINTS - 1);
    let at = |i: usize| values.get(i).copied().unwrap_or_default();
    at(whole).lerp(at(whole + 1), fraction_q32)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;
    use crate::compensate::names::{SCREW, points_names};
    use crate::scalar::Fixed;

    fn position(m: f64) -> Position {
        Position::from_m(m).unwrap()
    }

    fn table<S: Scalar>(
        start_m: f64,
        spacing_m: f64,
        points: &[f64],
        bound: f64,
    ) -> Result<Table<S>, ConfigError> {
        let points = Points { start_m, spacing_m, values: points.iter().copied().collect() };
        Table::new(&points_names!("pitch"), &points, ValueRange { unit: 1.0, bound })
    }

    fn harmonic(amplitude: f64, phase_rad: f64, period_m: f64) -> PeriodicTable<Fixed> {
        let cycle = settings::Cycle::harmonic(amplitude, period_m, phase_rad);
        PeriodicTable::new(&SCREW[0], &cycle, ValueRange { unit: 1.0, bound: amplitude }).unwrap()
    }

    /// Distance from linear interpolation at a fraction of the travel, from one spacing before its start to one after its
    /// end.
    fn error<S: Scalar>(start: f64, spacing: f64, points: &[f64], fraction: f64) -> f64 {
        let table = table::<S>(start, spacing, points, 1e4).unwrap();
        let at = (fraction * (points.len() as f64 + 1.0) - 1.0).clamp(0.0, points.len() as f64 - 1.0);
        let x = start + spacing * (fraction * (points.len() as f64 + 1.0) - 1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 62")]
        let k = (at.floor().min(points.len() as f64 - 2.0)) as usize;
        let exact = points[k] + (points[k + 1] - points[k]) * (at - k as f64);
        (table.at(position(x)).value() - exact).abs()
    }

    proptest! {
        /// Linear between points and constant outside. The position is rounded to 2⁻²⁹ of the span and the fraction to 2⁻²⁴.
        /// With 64 points that differ by up to 200 the error is 200·64·2⁻²⁹ + 200·2⁻²⁴, plus four times half a step of
        /// 2⁻¹⁴ in fixed point, or 2⁻²⁴ of the position in f32.
        #[test]
        fn a_table_is_straight_between_its_points(
            start in -2.0..2.0f64, spacing in 1e-4..0.05f64, fraction in 0.0..1.0f64,
            points in prop::collection::vec(-100.0..100.0f64, 2..=POINTS),
        ) {
            prop_assert!(error::<Fixed>(start, spacing, &points, fraction) < 3e-4);
            prop_assert!(error::<f32>(start, spacing, &points, fraction) < 1e-4);
            prop_assert!(error::<f64>(start, spacing, &points, fraction) < 5e-5);
        }

        /// Linear interpolation of a sine at 64 points has an error of up to (2π/64)²/8 = 1.2e-3 of the amplitude.
        #[test]
        fn a_harmonic_is_its_sine(at in -2.0..2.0f64, period in 1e-4..0.05f64, phase in 0.0..TAU) {
            let cycle = harmonic(100.0, phase, period);
            let exact = 100.0 * (TAU * at / period + phase).sin();
            let off = (cycle.at(position(at)).value() - exact).abs();
            prop_assert!(off < 0.125, "{off}");
        }

        /// After up to 100 periods the phase differs by at most 2⁻²³ of a period, which changes the value by 2π·100·2⁻²³, and
        /// the value is rounded to a step.
        #[test]
        fn a_cycle_repeats(at in -0.1..0.1f64, period_nm in 100_000u32..20_000_000, turns in -100i32..100) {
            let period = f64::from(period_nm) * 1e-9;
            let cycle = harmonic(100.0, 0.3, period);
            let from = position(at);
            let on = from + i64::from(turns) * i64::from(period_nm) * crate::units::PER_NM;
            let off = (cycle.at(on).value() - cycle.at(from).value()).abs();
            prop_assert!(off < 4e-4, "{off}");
        }
    }

    /// Four points, whose corners are among the 64 that they are resampled to: straight between them, and from the last to the first, also
    /// behind zero. A phase of 2⁻²³ of the greatest slope, 4·12 per period, is 6e-6.
    #[test]
    fn a_cycle_of_a_few_points_is_straight_between_them() {
        let points = [1.0, 8.0, -4.0, 2.0];
        let cycle = settings::Cycle { period_m: 0.01, values: points.into_iter().collect() };
        let range = ValueRange { unit: 1.0, bound: 10.0 };
        let periodic = PeriodicTable::<f64>::new(&SCREW[0], &cycle, range).unwrap();
        for k in -400..800i32 {
            let quarters = f64::from(k) / 100.0;
            let whole = quarters.floor();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
            let from = whole.rem_euclid(4.0) as usize;
            let exact = points[from] + (points[(from + 1) % 4] - points[from]) * (quarters - whole);
            let value = periodic.at(position(0.0025 * quarters));
            assert!((value - exact).abs() < 1e-5, "{quarters}: {value}, {exact}");
        }
    }

    /// The last point of a full period has the first as its neighbour: 131 072 apart they are refused, as any other two.
    #[test]
    fn the_ends_of_a_cycle_are_neighbours() {
        let of = |half: f64| {
            let values = (0..64).map(|k| half - half * f64::from(k) / 31.5).collect();
            let cycle = settings::Cycle { period_m: 0.01, values };
            PeriodicTable::<Fixed>::new(&SCREW[0], &cycle, ValueRange { unit: 1.0, bound: 1e5 }).err()
        };
        assert_eq!(of(65_535.0), None);
        let error = ConfigError::OutOfRange { name: "screw[0].values", min: -65_536.0, max: 65_536.0 };
        assert_eq!(of(65_536.5), Some(error));
    }

    #[test]
    fn rejected_tables_are_named() {
        let new = |points: &[f64], spacing| table::<Fixed>(0.0, spacing, points, 10.0).unwrap_err();
        let name = "pitch.values";
        assert_eq!(new(&[1.0], 0.1), ConfigError::Count { name, max: 64 });
        assert_eq!(new(&[1.0, f64::NAN], 0.1), ConfigError::NotFinite(name));
        assert_eq!(new(&[1.0, 11.0], 0.1), ConfigError::OutOfRange { name, min: -10.0, max: 10.0 });
        assert!(table::<Fixed>(0.0, 0.1, &[-10.0, 10.0], 10.0).is_ok());
        let spacing = ConfigError::OutOfRange { name: "pitch.spacing_m", min: 1.1e-6, max: TRAVEL_LIMIT_M };
        assert_eq!(new(&[1.0, 2.0], 0.0), spacing);
        // The travel is that of two spaces.
        let spacing = ConfigError::OutOfRange { name: "pitch.spacing_m", min: 0.55e-6, max: 50.0 };
        for m in [0.54e-6, 50.0] {
            assert_eq!(new(&[1.0, 2.0, 3.0], m), spacing);
        }
        for m in [0.56e-6, 49.9] {
            assert!(table::<Fixed>(0.0, m, &[1.0, 2.0, 3.0], 10.0).is_ok());
        }
        for m in [101.0, -101.0] {
            let error = ConfigError::OutOfRange { name: "pitch.start_m", min: -100.0, max: 100.0 };
            assert_eq!(table::<Fixed>(m, 0.1, &[1.0, 2.0], 10.0).unwrap_err(), error);
        }
        // Neighbours may differ by the range of a signal, 131 072.
        let steep = |from, to| table::<Fixed>(0.0, 0.1, &[from, to], 1e5).err();
        let error = ConfigError::OutOfRange { name, min: -65_536.0, max: 65_536.0 };
        assert_eq!((steep(-65_536.0, 65_535.0), steep(65_536.0, -65_535.0)), (None, None));
        assert_eq!((steep(-65_536.0, 65_536.0), steep(65_536.0, -65_536.0)), (Some(error), Some(error)));
        let values = [-131_072.0, 131_072.0].into_iter().collect();
        let points = Points { start_m: 0.0, spacing_m: 0.1, values };
        let range = ValueRange { unit: 2.0, bound: 1e6 };
        let error = ConfigError::OutOfRange { name, min: -131_072.0, max: 131_072.0 };
        assert_eq!(Table::<Fixed>::new(&points_names!("pitch"), &points, range).err(), Some(error));
        let too_many = signals::<Fixed>(name, &[0.0; 65], ValueRange { unit: 1.0, bound: 10.0 }).unwrap_err();
        assert_eq!(too_many, ConfigError::Count { name, max: 64 });
    }
}
