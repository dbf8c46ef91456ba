//! Checks that the tables written by a trace, `nominal`, `evidence` and `log_offsets`, match the fitted values.

use super::{Context, parameters};
use crate::axis::{Drive, TOLERATED};
use crate::machine::nominal::fit_range;
use crate::range::Range;
use files::error::InputError;

/// Largest offset of a zero, 1 m. A larger one has a wrong unit.
const FARTHEST_ZERO_UM: f64 = 1e6;

/// Longest dead time of a drive, in samples.
const LONGEST_DEAD_TIME: f64 = 10.0;

/// Largest time constant, ms, and rate, 1/s, of a drive.
const LARGEST_OF_DRIVE: f64 = 1e3;

/// Relative rounding error of a value at a bound of its tolerance.
const ROUNDING: f64 = 1e-9;

impl Context<'_> {
    /// The `tolerance_percent` table: percentages, of values that the axis has.
    pub(super) fn tolerances(&self) -> Result<(), InputError> {
        let Some(tolerances) = &self.settings.mechanics.tolerance_percent else { return Ok(()) };
        for value in TOLERATED {
            let Some(percent) = (value.own_tolerance_percent)(tolerances) else { continue };
            let key = format!("tolerance_percent.{}", value.key);
            Range::UpTo(100.0).check(&format!("{}.{key}", self.key), percent, self.document)?;
            if (value.get)(self.settings).is_none() {
                return Err(self.refuse(&key, &format!("no such key, as {} is not given", value.key)));
            }
        }
        Ok(())
    }

    /// The `evidence` tables: each names the effect of its place, and has as many half widths as that has values, or none.
    pub(super) fn evidence(&self) -> Result<(), InputError> {
        for (index, evidence) in self.axis.evidence.iter().enumerate() {
            let key = |key: &str| format!("evidence[{index}].{key}");
            let Some(effect) = self.axis.effect.get(index) else {
                return Err(self.refuse(&format!("evidence[{index}]"), "an effect with this number"));
            };
            if evidence.effect != effect.name() {
                let what = format!("{}, the name of effect[{index}]", effect.name());
                return Err(self.refuse(&key("effect"), &what));
            }
            let count = effect.values().len();
            if ![0, count].contains(&evidence.half_widths.len()) {
                return Err(self.refuse(&key("half_widths"), &format!("{count} numbers, one for each value")));
            }
            if evidence.half_widths.iter().any(|half_width| *half_width < 0.0) {
                return Err(self.refuse(&key("half_widths"), "numbers not below 0"));
            }
            for (index, effect) in evidence.alternatives.iter().enumerate() {
                let key = format!("{}.{}[{index}]", self.key, key("alternative"));
                parameters(effect, &key, self.document)?;
            }
        }
        Ok(())
    }

    /// The `nominal` table. The axis must have the same values and effects, and its values must be in the range of a fit,
    /// [`fit_range`].
    pub(super) fn nominal(&self) -> Result<(), InputError> {
        let Some(nominal) = &self.axis.nominal else { return Ok(()) };
        for value in TOLERATED {
            let Some(centre) = nominal.get(value.key) else { continue };
            let key = format!("nominal.{}", value.key);
            Range::NotNegative.check(&format!("{}.{key}", self.key), centre, self.document)?;
            let Some(fitted) = (value.get)(self.settings) else {
                return Err(self.refuse(&key, &format!("no such key, as {} is not given", value.key)));
            };
            let tolerance = value.tolerance(self.settings);
            let [least, most] = fit_range(value, centre, tolerance);
            if fitted < least * (1.0 - ROUNDING) || fitted > most * (1.0 + ROUNDING) {
                let what = format!(
                    "a value that a fit may give, {least} to {most}, from {key} ({centre}) and its tolerance ({} %)",
                    100.0 * tolerance
                );
                return Err(self.refuse(value.key, &what));
            }
        }
        for (index, effect) in nominal.effect.iter().enumerate() {
            let key = format!("{}.nominal.effect[{index}]", self.key);
            parameters(effect, &key, self.document)?;
            let own = self.axis.effect.get(index);
            if own.is_none_or(|own| own.name() != effect.name()) {
                let own_name = own.map_or("none", |own| own.name());
                let what = format!("the effect of the axis at the same index ({own_name})");
                return Err(self.document.refuse(&format!("{key}.name"), &what));
            }
        }
        Ok(())
    }

    /// The `log_offsets` table: zeros within [`FARTHEST_ZERO_UM`], instants within a sample, or [`LONGEST_DEAD_TIME`] where the drive is
    /// not declared, and its time constant and rate within [`LARGEST_OF_DRIVE`].
    pub(super) fn log_offsets(&self, sample_rate_hz: f64) -> Result<(), InputError> {
        let Some(offsets) = &self.axis.log_offsets else { return Ok(()) };
        for (key, value) in offsets.all() {
            if let Some(value) = value {
                let sample_ms = 1e3 / sample_rate_hz;
                let max = match key {
                    "velocity_time_constant_ms"
                    | "velocity_integral_per_s"
                    | "velocity_friction_m_per_s2" => LARGEST_OF_DRIVE,
                    "drive_dead_time_ms" => LONGEST_DEAD_TIME * sample_ms,
                    "table_late_ms" | "tool_late_ms" if self.settings.controller.drive == Drive::Stepper => {
                        LONGEST_DEAD_TIME * sample_ms
                    }
                    zero if zero.ends_with("_um") => FARTHEST_ZERO_UM,
                    _ => sample_ms,
                };
                Range::Within(max).check(&format!("{}.log_offsets.{key}", self.key), value, self.document)?;
            }
        }
        Ok(())
    }
}
