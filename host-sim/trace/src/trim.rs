//! What a machine file leaves open of the instants at which a machine samples and a log records.
//!
//! Channels are read one after the other and a drive steps its filters in its own way; a tenth of a sample of that
//! belongs to any log. It is fitted so that no effect is made of it, held to those bounds, and not reported. An effect
//! that says the same (`latency`, `velocity_lag`) takes its place.

use shared::config::Rates;

use model::axis::Law;
use model::effects::{Channel, Coordinate, Effect, Latency, Stage};
use model::machine::Axis;
use model::machine::nominal::LogOffsets;
use plant::parameters::AxisParameters;

/// Which instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instant {
    /// Of the linear scale against the motor's.
    Table,
    /// Of the probe against the scale's.
    Tool,
    /// Of the force against the motor's.
    Force,
    /// Of the speed that the velocity loop sees.
    Speed,
    /// Of the drive's force against the sensors' reading.
    Drive,
    /// Length of the steps that the controller takes its filter in; at zero they are exact.
    Filter,
}

/// How late each instant is, s; negative: early.
#[derive(Clone, Debug, Default)]
pub struct Trims {
    late_s: [f64; 6],
}

impl Instant {
    const ALL: [Self; 6] = [Self::Table, Self::Tool, Self::Force, Self::Speed, Self::Drive, Self::Filter];

    /// The stage in which it shows.
    fn stage(self) -> Stage {
        match self {
            Self::Table => Stage::Table,
            Self::Tool => Stage::Tool,
            Self::Force => Stage::Force,
            Self::Speed | Self::Drive | Self::Filter => Stage::Motor,
        }
    }

    /// Whether an axis has it.
    fn is_of(self, axis: &Axis) -> bool {
        self != Self::Filter || axis.settings.controller.law == Some(Law::Hpc)
    }

    /// Earliest and latest, s.
    fn bounds_s(self, rates: Rates) -> [f64; 2] {
        let tick_s = 1.0 / rates.velocity_loop_hz;
        let sample_s = tick_s * f64::from(rates.position_loop_divider);
        match self {
            Self::Table | Self::Tool => [-0.1 * sample_s, 0.1 * sample_s],
            // A force stands for an interval, a position for an instant.
            Self::Force => [-0.25 * sample_s, 0.25 * sample_s],
            Self::Speed => [0.0, 0.25 * tick_s],
            // Early alone: a drive that acts late is one that sees the speed late.
            Self::Drive => [-0.15 * tick_s, 0.0],
            Self::Filter => [0.0, 0.1 * sample_s],
        }
    }

    /// Whether an effect says it already.
    fn is_told_by(self, effect: &Effect) -> bool {
        match effect {
            Effect::Latency(late) => match late.channel {
                Channel::Table => self == Self::Table,
                Channel::Tool => self == Self::Tool,
                Channel::Force => self == Self::Force,
            },
            Effect::VelocityLag(_) => self == Self::Speed,
            _ => false,
        }
    }
}

impl Trims {
    /// As an axis's machine file has them, within their bounds.
    #[must_use]
    pub fn of(axis: &Axis, rates: Rates) -> Self {
        let mut trims = Self::default();
        let Some(offsets) = &axis.log_offsets else { return trims };
        for (instant, (_, ms)) in Instant::ALL.into_iter().zip(offsets.instants_ms()) {
            let [lower, upper] = instant.bounds_s(rates);
            trims.late_s[instant as usize] = (1e-3 * ms.unwrap_or(0.0)).clamp(lower, upper);
        }
        trims
    }

    /// Writes the instants that no effect tells and that are not at zero.
    pub fn write(&self, axis: &Axis, offsets: &mut LogOffsets) {
        let keys = [
            &mut offsets.table_late_ms,
            &mut offsets.tool_late_ms,
            &mut offsets.force_late_ms,
            &mut offsets.speed_late_ms,
            &mut offsets.drive_late_ms,
            &mut offsets.filter_step_ms,
        ];
        for (instant, key) in Instant::ALL.into_iter().zip(keys) {
            let ms = 1e3 * self.late_s[instant as usize];
            let is_told = axis.effect.iter().any(|effect| instant.is_told_by(effect));
            *key = (ms != 0.0 && !is_told).then_some(ms);
        }
    }

    /// The instants that a fit of these stages may trim, with what it may make of them and how far it is likely to go,
    /// ms. One that an effect tells keeps its place, so that a model with the effect has the slots of one without, but
    /// stands at zero.
    #[must_use]
    pub fn coordinates(
        &self,
        stages: &[Stage],
        axis: &Axis,
        rates: Rates,
    ) -> Vec<(Instant, Coordinate, f64)> {
        let coordinate = |instant: Instant| {
            let [lower, upper] = instant.bounds_s(rates).map(|s| 1e3 * s);
            let reach = upper.max(-lower);
            let step = 0.02 * reach;
            let coordinate = if axis.effect.iter().any(|effect| instant.is_told_by(effect)) {
                Coordinate::between(0.0, step, 0.0, 0.0)
            } else {
                Coordinate::between(1e3 * self.late_s[instant as usize], step, lower, upper)
            };
            // Beforehand it is as likely as not within half of its bounds.
            (instant, coordinate, 0.5 * reach)
        };
        let shown = Instant::ALL.into_iter();
        let shown = shown.filter(|instant| stages.contains(&instant.stage()) && instant.is_of(axis));
        shown.map(coordinate).collect()
    }

    /// Sets an instant, ms.
    pub fn set_ms(&mut self, instant: Instant, ms: f64) {
        self.late_s[instant as usize] = 1e-3 * ms;
    }

    /// The parameters of an axis with its instants trimmed.
    #[must_use]
    pub fn applied(&self, mut parameters: AxisParameters, effects: &[Effect]) -> AxisParameters {
        let open = |instant: Instant| !effects.iter().any(|effect| instant.is_told_by(effect));
        let channels = [
            (Instant::Table, Channel::Table),
            (Instant::Tool, Channel::Tool),
            (Instant::Force, Channel::Force),
        ];
        for (instant, channel) in channels {
            if open(instant) {
                parameters.latency.push(Latency { channel, ms: 1e3 * self.late_s[instant as usize] });
            }
        }
        if open(Instant::Speed) {
            parameters.servo.lag.ms += 1e3 * self.late_s[Instant::Speed as usize];
        }
        parameters.servo.drive_late_s += self.late_s[Instant::Drive as usize];
        parameters.servo.filter_step_s = self.late_s[Instant::Filter as usize];
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::VelocityLag;

    const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };

    #[test]
    fn an_effect_takes_the_place_of_a_trim() {
        let mut trims = Trims::default();
        trims.set_ms(Instant::Speed, 0.05);
        let stages = [Stage::Motor, Stage::Tool];
        let of = |effects: &[Effect], law| {
            let mut axis = Axis { effect: effects.to_vec(), ..Axis::default() };
            axis.settings.controller.law = Some(law);
            let trimmed = trims.coordinates(&stages, &axis, RATES);
            trimmed.into_iter().map(|(instant, c, _)| (instant, c.value, c.upper)).collect::<Vec<_>>()
        };
        // A tenth of 1 ms, a quarter of 0.25 ms; early alone.
        let [tool, drive] = [(Instant::Tool, 0.0, 0.1), (Instant::Drive, 0.0, 0.0)];
        assert_eq!(of(&[], Law::P), [tool, (Instant::Speed, 0.05, 0.0625), drive]);
        let lag = [Effect::VelocityLag(VelocityLag { ms: 0.1 })];
        assert_eq!(of(&lag, Law::P), [tool, (Instant::Speed, 0.0, 0.0), drive]);
        // Only high-order control has a filter to step.
        assert_eq!(of(&lag, Law::Hpc)[3], (Instant::Filter, 0.0, 0.1));
        let mut parameters = AxisParameters::default();
        parameters.servo.lag.ms = 0.1;
        // 0.1 ms of the effect alone, 0.15 with the trim where no effect says it.
        assert!((trims.applied(parameters.clone(), &lag).servo.lag.ms - 0.1).abs() < 1e-12);
        assert!((trims.applied(parameters, &[]).servo.lag.ms - 0.15).abs() < 1e-12);
    }
}
