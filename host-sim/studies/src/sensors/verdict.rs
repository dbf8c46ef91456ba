//! Whether dual feedback is as accurate as full-closed control and has the margins of semi-closed control.

use super::SensorStudy;
use super::row::Row;
use files::format::significant;

/// A contour error is as small as another if it is at most this multiple of it.
const AS_ACCURATE: f64 = 1.1;

/// A highest position gain is as high as another if it is at least this fraction of it.
const AS_HIGH: f64 = 0.9;

impl SensorStudy {
    /// The row of a loop.
    #[must_use]
    pub fn row(&self, feedback: &str, controller: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.feedback == feedback && row.controller == controller)
    }

    /// Two sentences for each control law: accuracy of dual feedback beside the table's, margins beside the motor's.
    #[must_use]
    pub fn verdicts(&self) -> Vec<String> {
        ["p", "hpc"].into_iter().filter_map(|law| self.verdict(law)).flatten().collect()
    }

    fn verdict(&self, law: &str) -> Option<[String; 2]> {
        let [motor, table, dual] = ["motor", "table", "dual"].map(|feedback| self.row(feedback, law));
        let (motor, table, dual) = (motor?, table?, dual?);
        let [before, after] = [
            [table, dual, motor].map(|row| row.uncompensated.circle_rms_um),
            [table, dual, motor].map(|row| row.compensated.circle_rms_um),
        ];
        let is_accurate = |errors: [f64; 3]| errors[1] <= AS_ACCURATE * errors[0];
        let gains = [motor, dual, table].map(|row| row.highest_position_gain_per_s.unwrap_or(0.0));
        let is_high = gains[1] >= AS_HIGH * gains[0];
        let has = |is: bool| if is { "has" } else { "does not have" };
        let um = |errors: [f64; 3]| {
            let [table, dual, motor] = errors.map(|um| significant(um, 3));
            format!("{dual} µm rms beside {table} µm (semi-closed: {motor} µm)")
        };
        let per_s = gains.map(|gain| significant(gain, 3));
        let name = law.to_uppercase();
        Some([
            format!(
                "{name}: dual feedback {} the accuracy of full-closed control on the circle: {}; with compensation it {} it: {}.",
                has(is_accurate(before)),
                um(before),
                has(is_accurate(after)),
                um(after)
            ),
            format!(
                "{name}: dual feedback {} the margins of semi-closed control: highest Kp {}/s beside {}/s \
                 (full-closed: {}/s).",
                has(is_high),
                per_s[1],
                per_s[0],
                per_s[2]
            ),
        ])
    }
}
