//! Errors of screw and tool as compensation settings.

use std::f64::consts::TAU;

use shared::compensate::CompensationSettings;
use shared::compensate::settings::{POINTS, Pitch, PitchSource, Points, Straightness, Talk, TimePoints};

use crate::compensate::cycles::{self, Wave};
use model::effects::{Mode, PeriodicError};
use model::position_curve::PositionCurve;
use plant::parameters::AxisParameters;
use plant::screw::Screw;
use plant::tool_parameters::ToolParameters;

/// Table of a drift: this many time constants, after which 1 % of it is left.
const DRIFT_TIME_CONSTANTS: f64 = 4.6;

/// Evenly spaced values over a travel, m.
pub fn points(travel_m: [f64; 2], value: impl Fn(f64) -> f64) -> Points {
    let spacing_m = (travel_m[1] - travel_m[0]) / (POINTS - 1) as f64;
    let at = |k: usize| value(spacing_m.mul_add(k as f64, travel_m[0]));
    Points { start_m: travel_m[0], spacing_m, values: (0..POINTS).map(at).collect() }
}

/// Compensation of everything but forces, for an axis of a machine with axes of these names. Also the number of periodic
/// errors for which the controller has no table.
#[must_use]
pub fn of_axis(
    parameters: &AxisParameters,
    names: &[String],
    travel_m: [f64; 2],
    start_s: f64,
) -> (CompensationSettings, usize) {
    let screw = &parameters.screw;
    let (screw_cycles, screw_left) = cycles::tables(screw.periodic.iter().map(wave).collect());
    let (dividing, dividing_left) = cycles::tables(parameters.resolver.iter().map(wave).collect());
    let source = |name: &str| names.iter().position(|n| n == name).and_then(|i| u8::try_from(i).ok());
    let tool = &parameters.tool;
    let um_s2_per_m = |coefficient: f64| Talk::Constant(1e-6 * coefficient);
    let crosstalk =
        tool.crosstalk.first().and_then(|talk| Some((source(&talk.source)?, um_s2_per_m(talk.um_s2_per_m))));
    let straightness = straightness(tool, source);
    // A tool that oscillates also lags behind the table by its acceleration over ω².
    let intalk_um_s2_per_m = tool.intalk.um_s2_per_m - tool.modes().map(lag_um_s2_per_m).sum::<f64>();
    let settings = CompensationSettings {
        pitch: pitch(screw, travel_m),
        backlash_width_m: Some(1e-6 * parameters.reversal_width_um())
            .filter(|&width_m| screw.gap_map.is_empty() && width_m > 0.0),
        screw: screw_cycles,
        dividing,
        intalk: (intalk_um_s2_per_m != 0.0).then(|| um_s2_per_m(intalk_um_s2_per_m)),
        crosstalk,
        // The effect is declared on the first axis and depends on the second.
        squareness: (tool.squareness.um_per_m != 0.0).then_some((1, 1e-6 * tool.squareness.um_per_m)),
        straightness,
        drift: drift_table(tool, start_s),
        ..CompensationSettings::default()
    };
    (settings, screw_left + dividing_left)
}

/// The displacement over the position of one other axis, that of the first map, or of the first bow where there is no map: a table over the
/// knots of the maps. Beyond these, the displacement is not known, and the table keeps its end.
fn straightness(tool: &ToolParameters, index_of: impl Fn(&str) -> Option<u8>) -> Option<(u8, Straightness)> {
    let source = tool.straightness_maps.first().map(|(source, _)| source);
    let source = source.or_else(|| tool.straightness.first().map(|bow| &bow.source))?;
    let index = index_of(source)?;
    let bows = || tool.straightness.iter().filter(|bow| bow.source == *source);
    let maps = || tool.straightness_maps.iter().filter(|(of, _)| of == source).map(|(_, curve)| curve);
    let Some(travel_m) =
        maps().filter_map(PositionCurve::range).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    else {
        return Some((index, Straightness::Quadratic(1e-6 * bows().map(|bow| bow.um_per_m2).sum::<f64>())));
    };
    let of_bows = |y: f64| bows().map(|bow| bow.offset_m(y)).sum::<f64>();
    let of_maps = |y: f64| maps().map(|curve| curve.value(y)).sum::<f64>();
    Some((index, Straightness::Over(points(travel_m, |y| of_bows(y) + of_maps(y)))))
}

/// Lag of the tool behind the table in a mode far below its frequency, µm per m/s².
fn lag_um_s2_per_m(mode: Mode) -> f64 {
    1e6 * mode.participation / (TAU * mode.frequency_hz).powi(2)
}

/// Table over the session time of the drifts, for a compensation that is set at `start_s` on the session clock.
fn drift_table(tool: &ToolParameters, start_s: f64) -> Option<TimePoints> {
    let longest_s = tool.drifts.iter().map(|drift| drift.time_constant_s).reduce(f64::max)?;
    let spacing_s = DRIFT_TIME_CONSTANTS * longest_s / (POINTS - 1) as f64;
    let at = |k: usize| tool.drifts.iter().map(|drift| drift.offset_m(spacing_s * k as f64)).sum();
    Some(TimePoints { start_s: -start_s, spacing_s, values: (0..POINTS).map(at).collect() })
}

fn wave(error: &PeriodicError) -> Wave<'_> {
    Wave {
        period_m: 1e-3 * error.period_mm,
        amplitude: error.amplitude_um,
        value: Box::new(|position_m| error.error_m(position_m)),
    }
}

/// The part of the pitch error that is not periodic. Where the gap varies along the travel, it is part of the tables of both
/// directions: in + direction the table is behind the screw by half of the gap.
fn pitch(screw: &Screw, travel_m: [f64; 2]) -> Option<Pitch> {
    let error_m =
        |x: f64| screw.error_m(x) - screw.periodic.iter().map(|error| error.error_m(x)).sum::<f64>();
    let has_error = screw.progressive.slope_um_per_m != 0.0 || !screw.map.is_empty();
    let has_gap_map = !screw.gap_map.is_empty();
    (has_error || has_gap_map).then(|| Pitch {
        of: PitchSource::Screw,
        forward: points(travel_m, |x| {
            error_m(x) - if has_gap_map { screw.half_difference_m(x) } else { 0.0 }
        }),
        backward: has_gap_map.then(|| points(travel_m, |x| error_m(x) + screw.half_difference_m(x))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{self, Backlash, PitchProgressive};

    /// A slope of 20 µm/m over ±0.1 m: ±2 µm at the ends. With a gap from 4 µm to 8 µm: less half of it in + direction.
    #[test]
    fn a_gap_that_varies_is_part_of_the_pitch_tables() {
        let mut parameters = AxisParameters::default();
        parameters.screw.progressive = PitchProgressive { slope_um_per_m: 20.0 };
        let names = ["x".to_owned(), "y".to_owned()];
        let travel_m = [-0.1, 0.1];
        let settings = of_axis(&parameters, &names, travel_m, 0.0).0;
        let pitch = settings.pitch.unwrap();
        assert!(pitch.backward.is_none() && settings.backlash_width_m.is_none());
        assert!(
            (pitch.forward.values[0] + 2e-6).abs() < 1e-15 && (pitch.forward.values[63] - 2e-6).abs() < 1e-15
        );
        parameters.screw.backlash = Backlash { width_um: 4.0 };
        assert_eq!(of_axis(&parameters, &names, travel_m, 0.0).0.backlash_width_m, Some(4e-6));
        parameters.screw.gap_map = PositionCurve::new(&[-0.1, 0.1], &[0.0, 4e-6]);
        let settings = of_axis(&parameters, &names, travel_m, 0.0).0;
        let pitch = settings.pitch.unwrap();
        assert!(settings.backlash_width_m.is_none());
        assert!((pitch.forward.values[63] - (2e-6 - 4e-6)).abs() < 1e-15);
        assert!((pitch.backward.unwrap().values[63] - (2e-6 + 4e-6)).abs() < 1e-15);
    }

    /// A map of 4 µm per 0.1 m over ±0.1 m of y, and a bow of 300 µm/m² of the same guide, 3 µm at ± 0.1 m: −4 + 3 and 4 + 3 µm at the ends. The
    /// bow alone is a coefficient.
    #[test]
    fn bow_and_map_of_a_guide_are_one_table() {
        let mut parameters = AxisParameters::default();
        parameters.tool.straightness =
            vec![effects::Straightness { um_per_m2: 300.0, source: "y".to_owned() }];
        let names = ["x".to_owned(), "y".to_owned()];
        let of = |parameters: &AxisParameters| {
            of_axis(parameters, &names, [-0.05, 0.05], 0.0).0.straightness.unwrap()
        };
        assert!(matches!(of(&parameters), (1, Straightness::Quadratic(bow)) if (bow - 300e-6).abs() < 1e-15));
        let curve = PositionCurve::over_mm(&[-100.0, 0.0, 100.0], &[-4.0, 0.0, 4.0], 1e-6);
        parameters.tool.straightness_maps = vec![("y".to_owned(), curve)];
        let (source, Straightness::Over(table)) = of(&parameters) else { panic!("no table") };
        assert_eq!((source, table.start_m), (1, -0.1));
        let ends = [table.values[0], table.values[POINTS - 1]];
        assert!((ends[0] + 1e-6).abs() < 1e-15 && (ends[1] - 7e-6).abs() < 1e-15, "{ends:?}");
    }
}
