//! Laws of residuals as settings of the controller, as far as it knows the variables of a term by its commands.

use shared::compensate::CompensationSettings;
use shared::compensate::settings::{Cycle, FACTORS, Factor, POINTS, Points, Product, Straightness};

use crate::compensate::tables::points;
use model::axis::Feedback;
use model::machine::Axis;
use model::residual_law::{Hysteresis, Term, Variables, WavePosition};
use model::residual_table::{TableChannel, TableVariable as V};

/// Full scale of a velocity in a product, m/s.
const FULL_M_PER_S: f64 = 1.0;

/// Full scale of an acceleration in a product, m/s².
const FULL_M_PER_S2: f64 = 10.0;

/// Least full scale of a position in a product, m: that of the controller is 1 mm.
const LEAST_FULL_M: f64 = 5e-3;

/// Least number of points of a table in a period of a wave: linear interpolation then leaves up to (2π/8)²/8 = 8 % of its amplitude.
const LEAST_POINTS: f64 = 8.0;

/// The axes of a law.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Number of the axis.
    pub own: u8,
    /// Number of the first other axis; that of the axis itself if there is none.
    pub other: u8,
    /// The travel of the axis, m.
    pub travel_m: [f64; 2],
    /// The travel of the other one, m.
    pub other_travel_m: [f64; 2],
}

/// Why the controller does not compensate a term of a law of an axis, and what to do instead; `None`: it does.
#[must_use]
pub fn refused(axis: &Axis, channel: TableChannel, term: &Term) -> Option<(&'static str, &'static str)> {
    let feedback = axis.settings.sensors.feedback;
    let find = "find its cause";
    match (channel, term) {
        (TableChannel::Motor, _) => Some((
            "it describes how the motor follows its command, and a correction of the command passes through the same loops",
            "tune the loops",
        )),
        (TableChannel::Force, _) => {
            Some(("it describes the force of the drive and not a displacement", find))
        }
        (TableChannel::Table, _) if feedback != Feedback::Motor => Some((
            "the loop reads the scale, and moves the table to its command",
            "measure at the tool: what the scale does not read is a law of the tool",
        )),
        (_, Term::Hysteresis { .. }) => {
            Some(("the controller has no memory of the direction over a distance", find))
        }
        (_, Term::Product { of, .. }) if of.iter().any(|one| matches!(one, V::ForceN | V::TimeS)) => Some((
            "the controller does not correct a displacement by the measured force or by the time",
            find,
        )),
        (_, Term::Product { of, .. }) if of.len() > FACTORS => {
            Some(("the controller has products of at most three factors", find))
        }
        (_, Term::Wave { over: WavePosition::PositionMm, .. }) if feedback != Feedback::Motor => Some((
            "the controller has periodic tables only of errors that the scale in the loop reads",
            "close the loop by the motor",
        )),
        _ => None,
    }
}

/// Adds the compensation of a term. A wave without a table, or with too few points, and a product beyond the number that there may be
/// are not added.
pub fn add(settings: &mut CompensationSettings, term: &Term, place: &Place) {
    match term {
        Term::Product { of, coefficient } => {
            // More products than the controller has are listed as without a setting.
            let _ = settings.products.push(product(of, *coefficient, place));
        }
        Term::Wave { over: WavePosition::PositionMm, period_mm, .. } => {
            let period_m = 1e-3 * period_mm;
            let at = |k: usize| wave_m(term, period_m * k as f64 / POINTS as f64);
            let _ = settings.screw.push(Cycle { period_m, values: (0..POINTS).map(at).collect() });
        }
        Term::Wave { over: WavePosition::OtherPositionMm, period_mm, .. } => {
            let shape = with_wave(settings.straightness.as_ref(), term, place);
            if let Some(points) = shape.filter(|points| 1e-3 * period_mm >= LEAST_POINTS * points.spacing_m) {
                settings.straightness = Some((place.other, Straightness::Over(points)));
            }
        }
        Term::Hysteresis { .. } => {}
    }
}

/// The product at its full scale.
fn product(of: &[V], coefficient: f64, place: &Place) -> Product {
    let mut amplitude_m = 1e-6 * coefficient;
    let mut factor = |variable: &V| {
        let (factor, full_scale) = factor(*variable, place);
        amplitude_m *= full_scale;
        factor
    };
    let factors = of.iter().map(&mut factor).collect();
    Product { amplitude_m, factors }
}

/// A variable as a factor, and its full scale in the unit of the variable.
fn factor(variable: V, place: &Place) -> (Factor, f64) {
    let axis = if variable.is_of_other_axis() { place.other } else { place.own };
    match variable {
        V::PositionMm | V::OtherPositionMm => {
            let [from, to] = if axis == place.own { place.travel_m } else { place.other_travel_m };
            let full_scale_m = from.abs().max(to.abs()).max(LEAST_FULL_M);
            (Factor::Position { axis, full_scale_m }, 1e3 * full_scale_m)
        }
        V::VelocityMPerS | V::OtherVelocityMPerS => {
            (Factor::Velocity { axis, full_scale_m_per_s: FULL_M_PER_S }, FULL_M_PER_S)
        }
        V::SpeedMPerS => (Factor::Speed { axis, full_scale_m_per_s: FULL_M_PER_S }, FULL_M_PER_S),
        V::AccelerationMPerS2 | V::OtherAccelerationMPerS2 => {
            (Factor::Acceleration { axis, full_scale_m_per_s2: FULL_M_PER_S2 }, FULL_M_PER_S2)
        }
        // Terms with a force or the time are refused before.
        V::Direction | V::OtherDirection | V::ForceN | V::TimeS => (Factor::Direction { axis }, 1.0),
    }
}

/// The straightness over the other axis with a wave added; `None` if it is over another one.
fn with_wave(present: Option<&(u8, Straightness)>, term: &Term, place: &Place) -> Option<Points> {
    match present {
        None => Some(points(place.other_travel_m, |y| wave_m(term, y))),
        Some((source, _)) if *source != place.other => None,
        Some((_, Straightness::Quadratic(m_per_m2))) => {
            Some(points(place.other_travel_m, |y| m_per_m2 * y * y + wave_m(term, y)))
        }
        Some((_, Straightness::Over(table))) => {
            let value =
                |(k, value): (usize, &f64)| value + wave_m(term, table.start_m + table.spacing_m * k as f64);
            Some(Points { values: table.values.iter().enumerate().map(value).collect(), ..table.clone() })
        }
    }
}

/// A position of the variables of a wave.
struct At {
    position_mm: f64,
}

impl Variables for At {
    fn value(&self, _: V) -> f64 {
        self.position_mm
    }
}

/// The value of a wave at a position, both m.
fn wave_m(term: &Term, position_m: f64) -> f64 {
    let parts = term.parts(&At { position_mm: 1e3 * position_m }, &mut Hysteresis::default());
    1e-6 * parts.iter().zip(term.coefficients()).map(|(part, coefficient)| part * coefficient).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const PLACE: Place = Place { own: 1, other: 0, travel_m: [-0.05, 0.1], other_travel_m: [-0.2, 0.05] };

    fn wave(over: WavePosition, period_mm: f64) -> Term {
        Term::Wave { over, period_mm, cosine: 3.0, sine: 4.0 }
    }

    /// 0.002 µm/(mm·mm·m/s²) at 100 mm, 200 mm and 10 m/s²: 400 µm.
    #[test]
    fn a_product_has_the_value_of_its_term_at_full_scale() {
        let of = [V::PositionMm, V::OtherPositionMm, V::OtherAccelerationMPerS2];
        let made = product(&of, 0.002, &PLACE);
        assert!((made.amplitude_m - 400e-6).abs() < 1e-15, "{made:?}");
        let expected = [
            Factor::Position { axis: 1, full_scale_m: 0.1 },
            Factor::Position { axis: 0, full_scale_m: 0.2 },
            Factor::Acceleration { axis: 0, full_scale_m_per_s2: 10.0 },
        ];
        assert_eq!(made.factors[..], expected);
    }

    /// Added to a straightness of 100 µm/m², the wave of 80 mm is a table over the other axis; one of 20 mm, five points, is not added.
    #[test]
    fn a_wave_over_the_other_axis_is_part_of_the_straightness() {
        let mut settings = CompensationSettings {
            straightness: Some((0, Straightness::Quadratic(100e-6))),
            ..CompensationSettings::default()
        };
        add(&mut settings, &wave(WavePosition::OtherPositionMm, 80.0), &PLACE);
        let Some((0, Straightness::Over(table))) = &settings.straightness else { panic!("{settings:?}") };
        for (k, value) in table.values.iter().enumerate() {
            let y = -0.2 + 0.25 * k as f64 / 63.0;
            let phase = TAU * y / 0.08;
            let expected = 100e-6 * y * y + 1e-6 * (3.0 * phase.cos() + 4.0 * phase.sin());
            assert!((value - expected).abs() < 1e-15, "{k}: {value} {expected}");
        }
        let before = settings.clone();
        add(&mut settings, &wave(WavePosition::OtherPositionMm, 20.0), &PLACE);
        assert_eq!(settings, before);
    }

    #[test]
    fn a_wave_over_the_axis_is_a_table_of_a_period() {
        let mut settings = CompensationSettings::default();
        add(&mut settings, &wave(WavePosition::PositionMm, 10.0), &PLACE);
        let [cycle] = &settings.screw[..] else { panic!("{settings:?}") };
        // A quarter of the period on: the sine.
        assert!((cycle.period_m - 0.01).abs() < 1e-15 && (cycle.values[16] - 4e-6).abs() < 1e-15);
    }

    #[test]
    fn what_the_controller_does_not_know_is_refused() {
        let mut axis = Axis::default();
        let product = |of: &[V]| Term::Product { of: of.to_vec(), coefficient: 1.0 };
        let speed = product(&[V::SpeedMPerS]);
        assert!(refused(&axis, TableChannel::Tool, &speed).is_none());
        assert!(refused(&axis, TableChannel::Table, &speed).is_none());
        for channel in [TableChannel::Motor, TableChannel::Force] {
            assert!(refused(&axis, channel, &speed).is_some());
        }
        let hysteresis = Term::Hysteresis { distance_mm: 3.0, coefficient: 1.0 };
        for term in [product(&[V::ForceN]), product(&[V::TimeS]), product(&[V::PositionMm; 4]), hysteresis] {
            assert!(refused(&axis, TableChannel::Tool, &term).is_some(), "{term:?}");
        }
        axis.settings.sensors.feedback = Feedback::Dual;
        assert!(refused(&axis, TableChannel::Table, &speed).is_some());
        assert!(refused(&axis, TableChannel::Tool, &speed).is_none());
        assert!(refused(&axis, TableChannel::Tool, &wave(WavePosition::PositionMm, 10.0)).is_some());
    }
}
