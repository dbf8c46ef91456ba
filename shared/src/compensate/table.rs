//! Evenly spaced values over a position, with straight lines between them.
//!
//! The index is a product: no division in a tick. A table over a travel holds its ends outside; a periodic
//! one goes round.

use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::{PER_M, Position, TRAVEL_LIMIT_M};

/// Points of a table, at the most.
pub const POINTS: usize = 64;

/// Values over a travel.
#[derive(Clone, Copy, Debug)]
pub struct Table<S: Scalar> {
    /// One more than the places, so that the last has a neighbour.
    values: [S; POINTS + 1],
    start: Position,
    /// Position units from the first to the last point, after the shift.
    span: u32,
    shift: u32,
    /// Points per shifted unit, 55 fraction bits: a span has 30, so that these are 25 to 32.
    per_unit: u32,
}

/// Values over a period.
#[derive(Clone, Copy, Debug)]
pub struct Cycle<S: Scalar> {
    values: [S; POINTS + 1],
    /// Of a turn for 2¹² position units, 64 fraction bits.
    per_unit: u64,
}

impl<S: Scalar> Table<S> {
    /// Points from `start_m`, `spacing_m` apart; `unit` of them is one as a signal.
    ///
    /// # Errors
    /// By `name`: fewer than 2 or more than [`POINTS`] points, a spacing that is not above zero, a value that
    /// is not finite or lies beyond ±`bound`.
    pub fn new(
        name: &'static str,
        points: &[f64],
        start_m: f64,
        spacing_m: f64,
        unit: f64,
        bound: f64,
    ) -> Result<Self, ConfigError> {
        if points.len() < 2 {
            return Err(ConfigError::NotPositive(name));
        }
        let values = signals(name, points, unit, bound)?;
        let length = spacing_m * (points.len() - 1) as f64;
        let out_of_range = ConfigError::OutOfRange { name, min: 0.0, max: TRAVEL_LIMIT_M };
        // Shorter than 2³⁰ units, 1 µm, it would not have those bits.
        if !(1.1e-6..TRAVEL_LIMIT_M).contains(&length) {
            return Err(out_of_range);
        }
        let start = Position::from_m(start_m).ok_or(out_of_range)?;
        let units = length * PER_M;
        // 30 bits of the span are kept: a nanometre on a metre.
        let shift = (libm::log2(units) - 29.0).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 27, and 31 bits")]
        let (shift, span) = (shift as u32, (units / libm::exp2(libm::floor(shift))) as u32);
        let per_unit =
            libm::floor((points.len() - 1) as f64 / f64::from(span.max(1)) * 36_028_797_018_963_968.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let per_unit = per_unit as u32;
        Ok(Self { values, start, span, shift, per_unit })
    }

    /// The value at a place.
    #[must_use]
    pub fn at(&self, place: Position) -> S {
        let beyond = (place - self.start) >> self.shift;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the span")]
        let beyond = beyond.clamp(0, i64::from(self.span)) as u32;
        between(&self.values, (u64::from(beyond) * u64::from(self.per_unit)) >> 23)
    }
}

impl<S: Scalar> Cycle<S> {
    /// Points of one period, the first at position zero.
    ///
    /// # Errors
    /// As [`Table::new`].
    pub fn new(
        name: &'static str,
        points: &[f64],
        period_m: f64,
        unit: f64,
        bound: f64,
    ) -> Result<Self, ConfigError> {
        let mut round = [0.0; POINTS];
        let count = points.len();
        if !(2..=POINTS).contains(&count) {
            return Err(ConfigError::OutOfRange { name, min: 2.0, max: POINTS as f64 });
        }
        // As many points as the table has places, so that the phase is the index.
        for (k, value) in round.iter_mut().enumerate() {
            let at = k as f64 * count as f64 / POINTS as f64;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 64")]
            let (whole, part) = (at as usize, at - libm::floor(at));
            let [from, to] =
                [whole % count, (whole + 1) % count].map(|i| points.get(i).copied().unwrap_or(0.0));
            *value = from + (to - from) * part;
        }
        let values = signals(name, &round, unit, bound)?;
        let units = period_m * PER_M / 4096.0;
        if !(units >= 1.0 && period_m < TRAVEL_LIMIT_M) {
            return Err(ConfigError::OutOfRange { name, min: 4096.0 / PER_M, max: TRAVEL_LIMIT_M });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates at one unit")]
        let per_unit = libm::rint(18_446_744_073_709_551_616.0 / units) as u64;
        Ok(Self { values, per_unit })
    }

    /// A sine: amplitude·sin(2π·x/period + phase).
    ///
    /// # Errors
    /// As [`Table::new`].
    pub fn harmonic(
        name: &'static str,
        amplitude: f64,
        phase_rad: f64,
        period_m: f64,
        unit: f64,
        bound: f64,
    ) -> Result<Self, ConfigError> {
        let points = core::array::from_fn::<f64, POINTS, _>(|k| {
            amplitude * libm::sin(core::f64::consts::TAU * k as f64 / POINTS as f64 + phase_rad)
        });
        Self::new(name, &points, period_m, unit, bound)
    }

    /// The value at a place: the same after every period, to 2⁻²³ of it anywhere on ±2 m of 0.1 mm periods.
    #[must_use]
    pub fn at(&self, place: Position) -> S {
        let turns = (place.0 >> 12).cast_unsigned().wrapping_mul(self.per_unit);
        between(&self.values, (turns >> 32) * POINTS as u64)
    }
}

fn signals<S: Scalar>(
    name: &'static str,
    points: &[f64],
    unit: f64,
    bound: f64,
) -> Result<[S; POINTS + 1], ConfigError> {
    if points.len() > POINTS {
        return Err(ConfigError::OutOfRange { name, min: 2.0, max: POINTS as f64 });
    }
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
    // Behind the last point: the first again, for a cycle; a table never gets there but by nothing.
    let next = if points.len() == POINTS { values.first() } else { values.get(points.len() - 1) };
    let next = next.copied().unwrap_or_default();
    if let Some(value) = values.get_mut(points.len()) {
        *value = next;
    }
    Ok(values)
}

/// The value at an index with 32 fraction bits.
fn between<S: Scalar>(values: &[S; POINTS + 1], index: u64) -> S {
    #[expect(clippy::cast_possible_truncation, reason = "at most 64 and its fraction")]
    let (whole, part) = ((index >> 32) as usize & (POINTS - 1), index as u32);
    let at = |i: usize| values.get(i).copied().unwrap_or_default();
    let (from, to) = (at(whole), at(whole + 1));
    from.lerp(to, part)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    fn place(m: f64) -> Position {
        Position::from_m(m).unwrap()
    }

    fn table_is_straight<S: Scalar>(start: f64, spacing: f64, points: &[f64], way: f64) -> f64 {
        let table = Table::<S>::new("table", points, start, spacing, 1.0, 1e4).unwrap();
        let at = (way * (points.len() as f64 + 1.0) - 1.0).clamp(0.0, points.len() as f64 - 1.0);
        let x = start + spacing * (way * (points.len() as f64 + 1.0) - 1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 62")]
        let k = (at.floor().min(points.len() as f64 - 2.0)) as usize;
        let exact = points[k] + (points[k + 1] - points[k]) * (at - k as f64);
        (table.at(place(x)).value() - exact).abs()
    }

    proptest! {
        /// Straight between points and level outside. The place is rounded to 2⁻²⁹ of the span and the fraction
        /// to 2⁻²⁴: 64 points of up to 100 differ by 200 in one of them, 200·64·2⁻²⁹ + 200·2⁻²⁴, and four times half a step
        /// of 2⁻¹⁴, or f32's 2⁻²⁴ of the place.
        #[test]
        fn a_table_is_straight_between_its_points(
            start in -2.0..2.0f64, spacing in 1e-4..0.05f64, way in 0.0..1.0f64,
            points in prop::collection::vec(-100.0..100.0f64, 2..=POINTS),
        ) {
            prop_assert!(table_is_straight::<Fixed>(start, spacing, &points, way) < 3e-4);
            prop_assert!(table_is_straight::<f32>(start, spacing, &points, way) < 1e-4);
            prop_assert!(table_is_straight::<f64>(start, spacing, &points, way) < 5e-5);
        }

        /// The chord of a sine over 2π/64 leaves (2π/64)²/8 = 1.2e-3 of the amplitude, one way only.
        #[test]
        fn a_harmonic_is_its_sine(at in -2.0..2.0f64, period in 1e-4..0.05f64, phase in 0.0..TAU) {
            let cycle = Cycle::<Fixed>::harmonic("cycle", 100.0, phase, period, 1.0, 100.0).unwrap();
            let exact = 100.0 * (TAU * at / period + phase).sin();
            let off = (Scalar::value(cycle.at(place(at))) - exact).abs();
            prop_assert!(off < 0.125, "{off}");
        }

        /// Some thousand periods on, the value is the same but for 2⁻²³ of a period: 2π·100·2⁻²³ and a step.
        #[test]
        fn a_cycle_repeats(at in -0.1..0.1f64, period_nm in 100_000u32..20_000_000, turns in -100i32..100) {
            let period = f64::from(period_nm) * 1e-9;
            let cycle = Cycle::<Fixed>::harmonic("cycle", 100.0, 0.3, period, 1.0, 100.0).unwrap();
            let from = place(at);
            let on = from + i64::from(turns) * i64::from(period_nm) * crate::units::PER_NM;
            let off = (Scalar::value(cycle.at(on)) - Scalar::value(cycle.at(from))).abs();
            prop_assert!(off < 4e-4, "{off}");
        }
    }

    #[test]
    fn refuses_by_name() {
        let new = |points: &[f64], spacing| {
            Table::<Fixed>::new("pitch", points, 0.0, spacing, 1.0, 10.0).unwrap_err()
        };
        assert_eq!(new(&[1.0], 0.1), ConfigError::NotPositive("pitch"));
        assert_eq!(new(&[1.0, f64::NAN], 0.1), ConfigError::NotFinite("pitch"));
        assert!(matches!(new(&[1.0, 11.0], 0.1), ConfigError::OutOfRange { name: "pitch", .. }));
        assert!(matches!(new(&[1.0, 2.0], 0.0), ConfigError::OutOfRange { name: "pitch", .. }));
        assert!(matches!(new(&[0.0; 65], 0.1), ConfigError::OutOfRange { name: "pitch", .. }));
    }
}
