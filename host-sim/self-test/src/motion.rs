//! Sampled paths for the motions of a session: circles in both directions, travel in steps, a small circle, a square
//! standing on its corner.

use std::f64::consts::TAU;

use super::servo::SAMPLE_S;

/// A segment of a path that starts and ends at rest, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// Stand still, s.
    Dwell(f64),
    /// Straight line to a point.
    Line([f64; 2]),
    /// Arc around a centre, in turns, positive counter-clockwise.
    Arc([f64; 2], f64),
}

/// Speed and acceleration of a motion, mm/s and mm/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// Along the path.
    pub speed: f64,
    /// Along the path, of trapezoidal ramps.
    pub acceleration: f64,
    /// Number of samples over which the speed along the path is averaged; 0 or 1: not at all. A ramp then has a jerk of
    /// at most the acceleration divided by their time.
    pub averaged_samples: usize,
}

impl Pace {
    /// Time for a length from rest to rest, s.
    fn time_s(&self, length: f64) -> f64 {
        let speed = self.reached_speed(length);
        length / speed + speed / self.acceleration
    }

    /// Largest speed over a length, mm/s; a short length limits it.
    fn reached_speed(&self, length: f64) -> f64 {
        self.speed.min((length * self.acceleration).sqrt())
    }

    /// Length travelled at a time since the start, mm.
    fn travelled(&self, length: f64, time_s: f64) -> f64 {
        let total_s = self.time_s(length);
        if time_s >= total_s {
            return length;
        }
        let speed = self.reached_speed(length);
        let ramp_s = speed / self.acceleration;
        let from_end_s = total_s - time_s;
        if time_s < ramp_s {
            0.5 * self.acceleration * time_s * time_s
        } else if from_end_s < ramp_s {
            length - 0.5 * self.acceleration * from_end_s * from_end_s
        } else {
            speed * (time_s - 0.5 * ramp_s)
        }
    }
}

/// Commanded positions (mm) at each sample; all segments at one pace.
#[must_use]
pub fn sampled(start: [f64; 2], segments: &[Segment], pace: Pace) -> Vec<[f64; 2]> {
    let mut positions = Vec::new();
    let mut from = start;
    for segment in segments {
        match *segment {
            Segment::Dwell(time_s) => positions.extend(vec![from; to_count((time_s / SAMPLE_S).round())]),
            Segment::Line(to) => {
                let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
                let length = libm::hypot(dx, dy);
                positions.extend(
                    fractions(pace, length)
                        .map(|fraction| [from[0] + fraction * dx, from[1] + fraction * dy]),
                );
                from = to;
            }
            Segment::Arc(centre, turns) => {
                let [dx, dy] = [from[0] - centre[0], from[1] - centre[1]];
                let turned = |fraction: f64| {
                    let (sin, cos) = libm::sincos(TAU * turns * fraction);
                    [centre[0] + cos * dx - sin * dy, centre[1] + sin * dx + cos * dy]
                };
                positions.extend(fractions(pace, TAU * turns.abs() * libm::hypot(dx, dy)).map(turned));
                from = turned(1.0);
            }
        }
    }
    positions
}

/// Fraction of a length travelled at each sample, both ends included.
fn fractions(pace: Pace, length: f64) -> impl Iterator<Item = f64> {
    let averaged = pace.averaged_samples.max(1);
    let samples = to_count((pace.time_s(length) / SAMPLE_S).ceil()) + averaged - 1;
    let travelled = move |i: usize| pace.travelled(length, SAMPLE_S * i as f64);
    // Before its start, a motion has travelled 0.
    let average = move |i: usize| {
        (0..averaged.min(i + 1)).map(|back| travelled(i - back)).sum::<f64>() / averaged as f64
    };
    (0..=samples).map(move |i| if averaged == 1 { travelled(i) } else { average(i) } / length)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "seconds of samples, not negative"
)]
fn to_count(samples: f64) -> usize {
    samples as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_takes_its_length_over_the_speed_and_one_ramp() {
        let pace = Pace { speed: 50.0, acceleration: 1000.0, ..Pace::default() };
        let positions = sampled([0.0; 2], &[Segment::Dwell(0.25), Segment::Line([30.0, 40.0])], pace);
        // 250 samples of rest; 50 mm / 50 mm/s + 50/1000 s = 1.05 s: 1051 samples with both ends, one more where the
        // quotient rounds up.
        assert!((1301..=1302).contains(&positions.len()), "{}", positions.len());
        assert_eq!(positions[positions.len() - 1].map(f64::to_bits), [30.0_f64, 40.0].map(f64::to_bits));
        let speeds: Vec<f64> =
            positions.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / SAMPLE_S).collect();
        let top = numerics::max_abs(speeds.iter().copied());
        assert!((top - 50.0).abs() < 1e-6, "{top}");
        let jumps = numerics::max_abs(speeds.windows(2).map(|w| (w[1] - w[0]) / SAMPLE_S));
        assert!(jumps < 1000.0 + 1e-3, "{jumps}");
    }

    #[test]
    fn an_arc_stays_on_its_circle_and_has_its_number_of_turns() {
        let pace = Pace { speed: 40.0, acceleration: 2000.0, ..Pace::default() };
        let positions = sampled([10.0, 0.0], &[Segment::Arc([0.0, 0.0], 1.25)], pace);
        assert!(positions.iter().all(|p| (p[0].hypot(p[1]) - 10.0).abs() < 1e-9));
        let last = positions[positions.len() - 1];
        assert!(last[0].abs() < 1e-9 && (last[1] - 10.0).abs() < 1e-9, "{last:?}");
    }

    #[test]
    fn a_short_line_never_reaches_the_speed() {
        let pace = Pace { speed: 100.0, acceleration: 1000.0, ..Pace::default() };
        // A triangle: 2·√(1/1000) s.
        assert!((pace.time_s(1.0) - 2.0 * 1e-3_f64.sqrt()).abs() < 1e-12);
        assert!((pace.travelled(1.0, 1e-3_f64.sqrt()) - 0.5).abs() < 1e-12);
    }
}
