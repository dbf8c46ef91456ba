//! The envelope of an axis: ceilings of its settings, which are compiled into the program of a board.

use super::error::ConfigError;
use super::gantry_settings::GantrySettings;
use super::settings::{AxisSettings, Sensors};

/// Ceilings of the settings of an axis.
///
/// Settings beyond one are refused with its name. A limit that has a ceiling has to be declared: settings that leave a
/// monitor out are refused, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEnvelope {
    /// Least and greatest soft limit, m. `None`: the axis has no ends, and settings may be without soft limits.
    pub travel_m: Option<[f64; 2]>,
    /// Ceiling of [`AxisSettings::fastest_m_per_s`], m/s, above 0. Motions are limited to 90 % of what is declared.
    pub fastest_m_per_s: f64,
    /// Ceiling of [`AxisSettings::force_limit_n`], N, above 0.
    pub force_limit_n: f64,
    /// Ceiling of [`AxisSettings::saturation_time_s`], s, above 0.
    pub saturation_time_s: f64,
    /// Ceiling of [`AxisSettings::following_error_limit_m`], m, above 0.
    pub following_error_limit_m: f64,
    /// Ceiling of [`Sensors::frozen_encoder_limit_m`], m, above 0; with a scale in the loop also of its frozen limit.
    pub frozen_encoder_limit_m: f64,
    /// Ceiling of [`Sensors::scale_disagreement_limit_m`], m, above 0. `None`: the axis has no linear scale, and settings must not
    /// use one.
    pub scale_disagreement_limit_m: Option<f64>,
    /// Least [`AxisSettings::stop_deceleration_m_per_s2`], m/s², above 0: a slower stop takes too long.
    pub stop_deceleration_m_per_s2: f64,
    /// Greatest sum of the amplitudes with which a frequency response is measured ([`crate::excitation`]), N; 0: none is measured.
    pub excitation_limit_n: f64,
    /// Ceiling of [`GantrySettings::skew_limit_m`](super::GantrySettings::skew_limit_m), m, above 0. `None`: the axis is not the second
    /// motor of a gantry.
    pub gantry_skew_limit_m: Option<f64>,
}

impl AxisEnvelope {
    /// Whether settings are within the envelope.
    ///
    /// # Errors
    /// [`ConfigError`] for the first setting that is beyond it ([`ConfigError::AboveCeiling`], [`ConfigError::BelowFloor`]), that is
    /// missing ([`ConfigError::NotMonitored`]), or that uses a scale or a gantry which is not there ([`ConfigError::NoScale`],
    /// [`ConfigError::NoGantry`]).
    pub const fn check(&self, settings: &AxisSettings) -> Result<(), ConfigError> {
        let ceilings = [
            ("fastest_m_per_s", settings.fastest_m_per_s, self.fastest_m_per_s),
            ("force_limit_n", Some(settings.force_limit_n), self.force_limit_n),
            ("saturation_time_s", Some(settings.saturation_time_s), self.saturation_time_s),
            ("following_error_limit_m", Some(settings.following_error_limit_m), self.following_error_limit_m),
            (
                "frozen_encoder_limit_m",
                settings.sensors.frozen_encoder_limit_m(),
                self.frozen_encoder_limit_m,
            ),
        ];
        let mut rest = ceilings.as_slice();
        while let [(name, value, ceiling), others @ ..] = rest {
            if let Err(error) = declared_up_to(name, *value, *ceiling) {
                return Err(error);
            }
            rest = others;
        }
        if let Err(error) = self.check_scale(&settings.sensors) {
            return Err(error);
        }
        if let Err(error) = self.check_travel(settings.travel_m) {
            return Err(error);
        }
        if let Err(error) = self.check_gantry(settings.gantry) {
            return Err(error);
        }
        let deceleration = settings.stop_deceleration_m_per_s2;
        at_least("stop_deceleration_m_per_s2", deceleration, self.stop_deceleration_m_per_s2)
    }

    const fn check_scale(&self, sensors: &Sensors) -> Result<(), ConfigError> {
        match (self.scale_disagreement_limit_m, sensors) {
            (Some(ceiling), _) => {
                declared_up_to("scale_disagreement_limit_m", sensors.scale_disagreement_limit_m(), ceiling)
            }
            (None, Sensors::Motor { scale_disagreement_limit_m: None, .. }) => Ok(()),
            (None, Sensors::Motor { .. }) => Err(ConfigError::NoScale("scale_disagreement_limit_m")),
            (None, Sensors::Table(_) | Sensors::Dual { .. }) => Err(ConfigError::NoScale("sensors")),
        }
    }

    const fn check_gantry(&self, gantry: Option<GantrySettings>) -> Result<(), ConfigError> {
        match (self.gantry_skew_limit_m, gantry) {
            (_, None) => Ok(()),
            (None, Some(_)) => Err(ConfigError::NoGantry("gantry")),
            (Some(ceiling), Some(gantry)) => {
                declared_up_to("gantry.skew_limit_m", Some(gantry.skew_limit_m), ceiling)
            }
        }
    }

    const fn check_travel(&self, travel_m: Option<[f64; 2]>) -> Result<(), ConfigError> {
        let name = "travel_m";
        match (self.travel_m, travel_m) {
            (None, _) => Ok(()),
            (Some([_, ceiling]), None) => Err(ConfigError::NotMonitored { name, ceiling }),
            (Some([floor, ceiling]), Some([least, greatest])) => {
                if let Err(error) = at_least(name, least, floor) {
                    return Err(error);
                }
                declared_up_to(name, Some(greatest), ceiling)
            }
        }
    }
}

/// A setting that has to be declared, and to be at most its ceiling.
const fn declared_up_to(name: &'static str, value: Option<f64>, ceiling: f64) -> Result<(), ConfigError> {
    match value {
        None => Err(ConfigError::NotMonitored { name, ceiling }),
        Some(value) if !value.is_finite() => Err(ConfigError::NotFinite(name)),
        Some(value) if value > ceiling => Err(ConfigError::AboveCeiling { name, value, ceiling }),
        Some(_) => Ok(()),
    }
}

const fn at_least(name: &'static str, value: f64, floor: f64) -> Result<(), ConfigError> {
    if !value.is_finite() {
        return Err(ConfigError::NotFinite(name));
    }
    if value < floor { Err(ConfigError::BelowFloor { name, value, floor }) } else { Ok(()) }
}
