//! A gantry in machine units, and what its two motors have to declare alike: soft limits, greatest speed, and the axis filter of the path.

use super::check::{finite, positive, ranged};
use super::error::ConfigError;
use super::gantry_settings::GantrySettings;
use super::settings::{AxisSettings, Rates};
use crate::units::PER_M;

/// A gantry in machine units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GantryConfig {
    /// Axis of the first motor.
    pub first: usize,
    /// Greatest skew, position units.
    pub skew_limit: u64,
    /// Distance by which the second motor moves to a square beam in a position tick, position units.
    pub squaring_step: i64,
}

impl GantryConfig {
    /// Checks and converts the gantry of each axis that is the second motor of one.
    ///
    /// # Errors
    /// The axis, and [`ConfigError`] for what is out of its range, for a first motor that is no other axis or that is one of another
    /// gantry, and for what both have to declare alike.
    pub fn of_axes<const N: usize>(
        settings: &[AxisSettings; N],
        rates: Rates,
    ) -> Result<[Option<Self>; N], (usize, ConfigError)> {
        let mut gantries = [None; N];
        for (axis, (own, slot)) in settings.iter().zip(&mut gantries).enumerate() {
            let Some(gantry) = own.gantry else { continue };
            let rejected = |error| (axis, error);
            let first = first_motor(axis, gantry, settings).map_err(rejected)?;
            alike(own, &settings[first]).map_err(rejected)?;
            *slot = Some(Self::new(gantry, first, rates).map_err(rejected)?);
        }
        Ok(gantries)
    }

    fn new(gantry: GantrySettings, first: usize, rates: Rates) -> Result<Self, ConfigError> {
        let limit_m = positive("gantry.skew_limit_m", gantry.skew_limit_m)?;
        let limit_m = ranged("gantry.skew_limit_m", limit_m, 0.0, GantrySettings::MOST_SKEW_M)?;
        let offset_m = finite("gantry.reference_offset_m", gantry.reference_offset_m)?;
        let most = GantrySettings::MOST_OFFSET_M;
        ranged("gantry.reference_offset_m", offset_m, -most, most)?;
        let step_m = GantrySettings::SQUARING_M_PER_S / rates.position_loop_hz();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; saturates")]
        let [skew_limit, squaring_step] = [limit_m * PER_M, (step_m * PER_M).max(1.0)].map(|n| n as u64);
        Ok(Self { first, skew_limit, squaring_step: squaring_step.cast_signed() })
    }
}

/// The first motor of a second one: another axis, which is a motor of no other gantry.
fn first_motor<const N: usize>(
    second: usize,
    gantry: GantrySettings,
    settings: &[AxisSettings; N],
) -> Result<usize, ConfigError> {
    let first = usize::from(gantry.first);
    let has_other = settings.iter().enumerate().any(|(axis, other)| {
        axis != second && other.gantry.is_some_and(|other| usize::from(other.first) == first)
    });
    let is_free = settings.get(first).is_some_and(|first| first.gantry.is_none()) && first != second;
    if is_free && !has_other {
        return Ok(first);
    }
    Err(ConfigError::NotAnotherAxis { name: "gantry.first", axes: u8::try_from(N).unwrap_or(u8::MAX) })
}

/// Whether the second motor declares what the first does.
fn alike(second: &AxisSettings, first: &AxisSettings) -> Result<(), ConfigError> {
    let pairs = [
        ("travel_m", second.travel_m == first.travel_m),
        ("fastest_m_per_s", second.fastest_m_per_s == first.fastest_m_per_s),
        ("smoothing", second.smoothing == first.smoothing),
    ];
    match pairs.into_iter().find(|(_, is_alike)| !is_alike) {
        Some((name, _)) => Err(ConfigError::NotOfFirstMotor(name)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

    const GANTRY: GantrySettings =
        GantrySettings { first: 0, skew_limit_m: 0.5e-3, reference_offset_m: -1.2e-3 };

    fn axes(gantries: [Option<GantrySettings>; 4]) -> [AxisSettings; 4] {
        gantries.map(|gantry| AxisSettings { gantry, ..AxisSettings::default() })
    }

    fn refused(axes: &[AxisSettings; 4]) -> (usize, ConfigError) {
        GantryConfig::of_axes(axes, RATES).unwrap_err()
    }

    /// 1 mm/s in position ticks at 4 kHz are 250 nm.
    #[test]
    fn a_gantry_is_converted_for_the_axis_of_its_second_motor() {
        let gantries = GantryConfig::of_axes(&axes([None, None, Some(GANTRY), None]), RATES).unwrap();
        let nm = crate::units::PER_NM;
        let expected =
            GantryConfig { first: 0, skew_limit: 500_000 * nm.unsigned_abs(), squaring_step: 250 * nm };
        assert_eq!(gantries, [None, None, Some(expected), None]);
        let two = [None, None, Some(GANTRY), Some(GantrySettings { first: 1, ..GANTRY })];
        assert!(GantryConfig::of_axes(&axes(two), RATES).is_ok());
    }

    #[test]
    fn a_first_motor_is_another_axis_and_of_no_other_gantry() {
        let error = ConfigError::NotAnotherAxis { name: "gantry.first", axes: 4 };
        let with = |first| Some(GantrySettings { first, ..GANTRY });
        for (gantries, axis) in [
            ([None, None, with(2), None], 2),
            ([None, None, None, with(4)], 3),
            ([None, with(0), with(0), None], 1),
            ([None, with(0), with(1), None], 2),
            ([with(1), with(0), None, None], 0),
        ] {
            assert_eq!(refused(&axes(gantries)), (axis, error), "{gantries:?}");
        }
    }

    #[test]
    fn limits_and_offset_have_their_ranges() {
        let of = |gantry| refused(&axes([None, Some(gantry), None, None])).1;
        for skew_limit_m in [0.0, -1e-3] {
            let error = ConfigError::NotPositive("gantry.skew_limit_m");
            assert_eq!(of(GantrySettings { skew_limit_m, ..GANTRY }), error);
        }
        let name = "gantry.skew_limit_m";
        let error = ConfigError::OutOfRange { name, min: 0.0, max: GantrySettings::MOST_SKEW_M };
        assert_eq!(of(GantrySettings { skew_limit_m: 0.0101, ..GANTRY }), error);
        let name = "gantry.reference_offset_m";
        for reference_offset_m in [-0.101, 0.101] {
            let error = ConfigError::OutOfRange { name, min: -0.1, max: 0.1 };
            assert_eq!(of(GantrySettings { reference_offset_m, ..GANTRY }), error);
        }
        let error = ConfigError::NotFinite(name);
        assert_eq!(of(GantrySettings { reference_offset_m: f64::NAN, ..GANTRY }), error);
    }

    #[test]
    fn both_motors_declare_what_they_do_together_alike() {
        type Change = (&'static str, fn(&mut AxisSettings));
        let changes: [Change; 3] = [
            ("travel_m", |axis| axis.travel_m = Some([-0.1, 0.2])),
            ("fastest_m_per_s", |axis| axis.fastest_m_per_s = Some(0.2)),
            ("smoothing", |axis| axis.smoothing = crate::interpolate::Smoothing::Trapezoid { time_s: 0.01 }),
        ];
        for (name, change) in changes {
            let mut axes = axes([None, Some(GANTRY), None, None]);
            change(&mut axes[1]);
            assert_eq!(refused(&axes), (1, ConfigError::NotOfFirstMotor(name)));
            change(&mut axes[0]);
            assert!(GantryConfig::of_axes(&axes, RATES).is_ok(), "{name}");
        }
    }
}
