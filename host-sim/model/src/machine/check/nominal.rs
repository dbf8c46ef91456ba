//! What a trace has written beside fitted values: it has to belong to them.

use super::{Context, parameters};
use crate::machine::nominal::TOLERATED;
use crate::range::Range;
use files::error::InputError;

/// Farther zeros are a slip of the unit: a metre.
const FARTHEST_ZERO_UM: f64 = 1e6;

/// Rounding of a value at the wall of its tolerance, as a share of it.
const ROUNDING: f64 = 1e-9;

impl Context<'_> {
    /// The `nominal` table: values and effects that the axis has, and a value no farther from its nominal one than the
    /// tolerance allows.
    pub(super) fn nominal(&self) -> Result<(), InputError> {
        let Some(nominal) = &self.axis.nominal else { return Ok(()) };
        let percent = self.settings.mechanics.plant_tolerance_percent.unwrap_or(0.0);
        for value in TOLERATED {
            let Some(centre) = (value.nominal)(nominal) else { continue };
            let key = format!("nominal.{}", value.key);
            Range::NotNegative.check(&format!("{}.{key}", self.key), centre, self.document)?;
            let Some(fitted) = (value.get)(self.settings) else {
                return Err(self.refuse(&key, &format!("no such key, as {} is not given", value.key)));
            };
            if (fitted - centre).abs() > (0.01 * percent + ROUNDING) * centre {
                let what = format!("a value within plant_tolerance_percent ({percent}) of {key} ({centre})");
                return Err(self.refuse(value.key, &what));
            }
        }
        for (index, effect) in nominal.effect.iter().enumerate() {
            let key = format!("{}.nominal.effect[{index}]", self.key);
            parameters(effect, &key, self.document)?;
            let own = self.axis.effect.get(index);
            if own.is_none_or(|own| own.name() != effect.name()) {
                let there = own.map_or("none", |own| own.name());
                let what = format!("the effect that the axis has in this place ({there})");
                return Err(self.document.refuse(&format!("{key}.name"), &what));
            }
        }
        Ok(())
    }

    /// The `log_offsets` table: zeros on the machine, instants within a sample.
    pub(super) fn log_offsets(&self, sample_rate_hz: f64) -> Result<(), InputError> {
        let Some(offsets) = &self.axis.log_offsets else { return Ok(()) };
        for (key, value) in offsets.all() {
            if let Some(value) = value {
                let max = if key.ends_with("_um") { FARTHEST_ZERO_UM } else { 1e3 / sample_rate_hz };
                Range::Within(max).check(&format!("{}.log_offsets.{key}", self.key), value, self.document)?;
            }
        }
        Ok(())
    }
}
