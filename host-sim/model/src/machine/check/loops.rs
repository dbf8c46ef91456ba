//! Consistency of the filters and limits of the controller, checked by the code in `shared` that uses them.

use shared::config::{
    AxisConfig, AxisSettings, ConfigError, GainSchedule, NOTCHES, Notches, Rates, SCHEDULE_POINTS,
};
use shared::interpolate::smooth::{Filter, WINDOW};
use shared::units::TRAVEL_LIMIT_M;

use super::Context;
use crate::axis::PerNotch;
use crate::servo;
use files::error::InputError;

impl Context<'_> {
    /// The filter of the path, whose windows are whole numbers of samples.
    pub(super) fn smoothing(&self, sample_rate_hz: f64) -> Result<(), InputError> {
        let filters = &self.settings.filters;
        let windows = [("smoothing_s", filters.smoothing_s), ("smoothing_jerk_s", filters.smoothing_jerk_s)];
        let window = windows.into_iter().find(|(_, time_s)| time_s.is_some());
        if let (Some((key, _)), Some(_)) = (window, filters.smoothing_time_constant_s) {
            return Err(self.refuse("smoothing_time_constant_s", &format!("no such key, as {key} is given")));
        }
        if let (None, Some(_)) = (filters.smoothing_s, filters.smoothing_jerk_s) {
            return Err(self.refuse("smoothing_s", "a value beside smoothing_jerk_s"));
        }
        for (key, time_s) in windows {
            // A mean over one sample has no effect.
            if time_s.is_some_and(|time_s| (time_s * sample_rate_hz).round() < 2.0) {
                let what = format!("two samples ({} s) or more", 2.0 / sample_rate_hz);
                return Err(self.refuse(key, &what));
            }
        }
        if filters.smoothing_jerk_s > filters.smoothing_s {
            return Err(self.refuse("smoothing_jerk_s", "a time no longer than smoothing_s"));
        }
        if Filter::new(&servo::smoothing(filters), sample_rate_hz).is_ok() {
            return Ok(());
        }
        if filters.smoothing_time_constant_s.is_some() {
            return Err(self.refuse("smoothing_time_constant_s", "a time of at most a million samples"));
        }
        let longest_s = WINDOW as f64 / sample_rate_hz;
        let what = format!("at most {WINDOW} samples ({longest_s} s) including smoothing_jerk_s");
        Err(self.refuse("smoothing_s", &what))
    }

    /// The filters of the force, and the observer of the velocity.
    pub(super) fn filters(&self, velocity_loop_hz: f64) -> Result<(), InputError> {
        let filters = &self.settings.filters;
        self.notches()?;
        self.complete(&[
            ("low_pass_frequency_hz", filters.low_pass_frequency_hz),
            ("low_pass_damping_ratio", filters.low_pass_damping_ratio),
        ])?;
        let rates = Rates { velocity_loop_hz, position_loop_divider: 1 };
        let check = |settings: AxisSettings, key: &dyn Fn(&str) -> String| match AxisConfig::<f64>::new(
            &settings, rates,
        ) {
            Err(ConfigError::OutOfRange { name, min, max })
                if ["notch", "low_pass", "velocity_observer"].iter().any(|of| name.starts_with(of)) =>
            {
                Err(self.refuse(&key(name), &format!("a number from {min} to {max}")))
            }
            _ => Ok(()),
        };
        let Notches(notches) = servo::notches(filters);
        let count = notches.iter().flatten().count();
        for (index, notch) in notches.into_iter().enumerate() {
            let notches = Notches([notch, None, None, None]);
            check(AxisSettings { notches, ..AxisSettings::default() }, &|name| {
                PerNotch::key(name, index, count)
            })?;
        }
        let low_pass = servo::low_pass(filters);
        let velocity_source = servo::velocity_source(&self.settings.controller);
        check(AxisSettings { low_pass, velocity_source, ..AxisSettings::default() }, &str::to_owned)
    }

    /// The keys of the notches have as many numbers each, one for each notch.
    fn notches(&self) -> Result<(), InputError> {
        let filters = &self.settings.filters;
        let keys = [
            ("notch_frequency_hz", &filters.notch_frequency_hz),
            ("notch_width_hz", &filters.notch_width_hz),
            ("notch_depth", &filters.notch_depth),
        ];
        let counts = keys.map(|(key, values)| (key, values.as_ref().map(|values| values.0.len())));
        self.complete(&counts)?;
        let (first_key, first) = counts[0];
        for (key, count) in counts {
            if count.is_some_and(|count| !(1..=NOTCHES).contains(&count)) {
                return Err(self.refuse(key, &format!("1 to {NOTCHES} numbers")));
            }
            if count != first {
                return Err(self.refuse(key, &format!("as many numbers as {first_key} has")));
            }
        }
        Ok(())
    }

    /// The points of the gain schedule, checked by the controller in f64.
    pub(super) fn gain_schedule(&self, rates: Rates) -> Result<(), InputError> {
        let schedule = &self.settings.schedule;
        let keys = [
            ("gain_schedule_position_mm", &schedule.position_mm),
            ("gain_schedule_speed_mm_per_s", &schedule.speed_mm_per_s),
        ];
        if let [(first, Some(_)), (second, Some(_))] = keys {
            return Err(self.refuse(second, &format!("no such key, as {first} is given")));
        }
        let given = keys.iter().find_map(|(key, places)| Some((*key, places.as_ref()?)));
        let (key, places, ratios) = match (given, &schedule.ratio) {
            (None, None) => return Ok(()),
            (None, Some(_)) => {
                return Err(self.refuse("gain_schedule_position_mm", "a value beside gain_schedule_ratio"));
            }
            (Some((key, _)), None) => {
                return Err(self.refuse("gain_schedule_ratio", &format!("a value beside {key}")));
            }
            (Some((key, places)), Some(ratios)) => (key, &places.0, &ratios.0),
        };
        if !(2..=SCHEDULE_POINTS).contains(&places.len()) {
            return Err(self.refuse(key, &format!("2 to {SCHEDULE_POINTS} numbers")));
        }
        if places.len() != ratios.len() {
            return Err(self.refuse("gain_schedule_ratio", &format!("as many numbers as {key} has")));
        }
        let Some(kv) = self.settings.controller.velocity_gain_n_s_per_m else {
            return Err(self.refuse("velocity_gain_n_s_per_m", &format!("a value beside {key}")));
        };
        let settings = AxisSettings {
            velocity_gain_n_s_per_m: kv,
            gain_schedule: servo::gain_schedule(schedule),
            ..AxisSettings::default()
        };
        match AxisConfig::<f64>::new(&settings, rates) {
            Err(ConfigError::OutOfRange { name: "gain_schedule_ratio", min, max }) => {
                Err(self.refuse("gain_schedule_ratio", &format!("numbers from {min} to {max}")))
            }
            Err(ConfigError::OutOfRange {
                name: "gain_schedule_position" | "gain_schedule_speed",
                max,
                ..
            }) => {
                let spacing = 1e3 * GainSchedule::LEAST_SPACING;
                Err(self
                    .refuse(key, &format!("ascending numbers, {spacing} or more apart, up to {}", 1e3 * max)))
            }
            _ => Ok(()),
        }
    }

    /// Brake and preload.
    pub(super) fn holding(&self) -> Result<(), InputError> {
        let holding = &self.settings.holding;
        self.complete(&[
            ("brake_release_s", holding.brake_release_s),
            ("brake_engage_s", holding.brake_engage_s),
        ])?;
        match (holding.preload_n, self.settings.controller.force_limit_n) {
            (Some(preload_n), Some(limit_n)) if preload_n.abs() > limit_n => {
                Err(self
                    .refuse("preload_n", &format!("a number from -{limit_n} to {limit_n}, the force limit")))
            }
            (Some(preload_n), _) if !preload_n.is_finite() => {
                Err(self.refuse("preload_n", "a finite number"))
            }
            _ => Ok(()),
        }
    }

    /// Requires all of these keys or none.
    fn complete<T>(&self, keys: &[(&str, Option<T>)]) -> Result<(), InputError> {
        let given = keys.iter().find(|(_, value)| value.is_some());
        let missing = keys.iter().find(|(_, value)| value.is_none());
        match (given, missing) {
            (Some((given, _)), Some((missing, _))) => {
                Err(self.refuse(missing, &format!("a value beside {given}")))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn travel(&self) -> Result<(), InputError> {
        let Some([least, greatest]) = self.settings.limits.travel_mm else { return Ok(()) };
        let limit_mm = 1e3 * TRAVEL_LIMIT_M;
        for (index, end_mm) in [least, greatest].into_iter().enumerate() {
            if end_mm.abs() > limit_mm {
                let what = format!("a position within {limit_mm} mm of zero");
                return Err(self.refuse(&format!("travel_mm[{index}]"), &what));
            }
        }
        if least < greatest {
            return Ok(());
        }
        Err(self.refuse("travel_mm[1]", "a number above the first"))
    }
}
