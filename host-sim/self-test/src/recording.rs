//! Errors between the sensors and the log, which the control loops do not see.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use files::log::{AxisLog, Log};
use numerics::noise::box_muller;

use super::plant::STEP_S;

/// Errors of the recorder of both axes; an error of value 0 is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Recorder {
    /// Standard deviation of the instants at which the channels are read, s.
    pub jitter_s: f64,
    /// Probability that a row is lost and the row before stands in its place.
    pub repeated: f64,
}

impl Recorder {
    /// Replaces the rows that are lost.
    pub fn lose_rows(&self, log: &mut Log, random: &mut ChaCha8Rng) {
        if self.repeated == 0.0 {
            return;
        }
        for row in 1..log.len() {
            if random.random_bool(self.repeated) {
                for axis in &mut log.axes {
                    let AxisLog { command, motor, table, tool, force, .. } = axis;
                    for channel in [command, motor, table, tool, force].into_iter().flatten() {
                        channel[row] = channel[row - 1];
                    }
                }
            }
        }
    }
}

/// Errors of the recording of one axis; an error of value 0 is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Recording {
    /// Samples by which the command is logged late.
    pub command_late: f64,
    /// Relative error of the logged force, that of the torque constant.
    pub force_gain: f64,
    /// Relative error of the probe.
    pub probe_gain: f64,
    /// Angle of the probe against the other axis: the probe adds angle·(other axis's tool − centre). A turned probe has opposite
    /// angles on both axes.
    pub probe_turn_rad: f64,
    /// Position of the other axis at which a turned probe reads the same.
    pub probe_centre_m: f64,
}

impl Recording {
    /// What the probe reads of the tool on this axis and on the other, m.
    #[must_use]
    pub fn probed_m(&self, own_m: f64, other_m: f64) -> f64 {
        if self.probe_turn_rad == 0.0 && self.probe_gain == 0.0 {
            return own_m;
        }
        (1.0 + self.probe_gain) * (own_m + self.probe_turn_rad * (other_m - self.probe_centre_m))
    }

    /// The command that is logged for a sample, mm: `late` samples ago, interpolated.
    #[must_use]
    pub fn command_mm(&self, positions: &[[f64; 2]], sample: usize, axis: usize) -> f64 {
        if self.command_late == 0.0 {
            return positions[sample][axis];
        }
        let last = positions.len() - 1;
        let at = (sample as f64 - self.command_late).clamp(0.0, last as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the samples")]
        let before = at.floor() as usize;
        let fraction = at - before as f64;
        let next = positions[(before + 1).min(last)][axis];
        positions[before][axis] + fraction * (next - positions[before][axis])
    }
}

/// Readings at an instant that differs from that of the sample by noise of a standard deviation, s. `before` are the readings
/// one step of the plant earlier.
#[must_use]
pub fn jittered<const N: usize>(
    now: [[f64; N]; 2],
    before: [[f64; N]; 2],
    jitter_s: f64,
    random: &mut ChaCha8Rng,
) -> [[f64; N]; 2] {
    if jitter_s == 0.0 {
        return now;
    }
    let steps = jitter_s * box_muller(random) / STEP_S;
    [0, 1].map(|i| {
        std::array::from_fn(|channel| {
            let (now, before) = (now[i][channel], before[i][channel]);
            now + steps * (now - before)
        })
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_turned_probe_adds_the_angle_times_the_other_axis_and_keeps_distances() {
        let angle = 0.4e-3;
        let turned = |probe_turn_rad| Recording { probe_turn_rad, ..Recording::default() };
        let [x_m, y_m] = [0.03, -0.05];
        let probed = [turned(angle).probed_m(x_m, y_m), turned(-angle).probed_m(y_m, x_m)];
        assert!(
            (probed[0] - x_m - angle * y_m).abs() < 1e-15 && (probed[1] - y_m + angle * x_m).abs() < 1e-15
        );
        // A rotation keeps the distance up to angle²/2.
        assert!((probed[0].hypot(probed[1]) / x_m.hypot(y_m) - 1.0 - 0.5 * angle * angle).abs() < 1e-12);
        let scaled = Recording { probe_gain: 5e-4, probe_centre_m: 0.01, ..turned(angle) };
        assert!((scaled.probed_m(x_m, 0.01) - x_m * (1.0 + 5e-4)).abs() < 1e-15);
        assert_eq!(Recording::default().probed_m(x_m, y_m).to_bits(), x_m.to_bits());
    }

    #[test]
    fn a_late_command_is_that_of_an_earlier_instant() {
        let positions: Vec<[f64; 2]> = (0..10).map(|i| [2.0 * f64::from(i), 1.0]).collect();
        let logged = |command_late: f64, sample| {
            Recording { command_late, ..Recording::default() }.command_mm(&positions, sample, 0)
        };
        for (late, sample, expected) in
            [(0.4, 5, 9.2), (-0.4, 5, 10.8), (1.5, 5, 7.0), (0.4, 0, 0.0), (-0.4, 9, 18.0)]
        {
            assert!((logged(late, sample) - expected).abs() < 1e-12, "{late} {sample}");
        }
    }

    #[test]
    fn jitter_moves_a_ramp_by_its_speed() {
        let (speed, jitter_s) = (100.0, 50e-6);
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let moved = (0..10_000).map(|_| {
            let [[x], [y]] = jittered([[7.0], [7.0]], [[7.0 - speed * STEP_S], [7.0]], jitter_s, &mut random);
            assert!((y - 7.0).abs() < f64::EPSILON);
            x - 7.0
        });
        // 100 mm/s for 50 µs: 5 µm; the scatter of 10 000 values is known to 0.7 %.
        let scatter = numerics::rms(moved.collect::<Vec<_>>());
        assert!((scatter / (speed * jitter_s) - 1.0).abs() < 0.03, "{scatter}");
    }
}
