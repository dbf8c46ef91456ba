//! What came out, in sentences, and what the print leaves open.

use super::identify::Candidate;
use super::travel::Z;
use super::{Experiment, X, identify, machines, travel, without_noise};
use report::number::significant;

impl Experiment {
    /// What came out, in sentences.
    pub fn said(&self) -> Vec<String> {
        let three = |value: f64| significant(value, 3);
        let factor = |c: &Candidate| {
            if c.helps() { format!("factor {}", three(c.factor)) } else { "no factor helps".to_owned() }
        };
        let ranking: Vec<String> =
            self.candidates.iter().map(|c| format!("{} {} ({})", c.name, three(c.left), factor(c))).collect();
        let found = self.candidates.first().map_or(String::new(), |c| format!("{}, {}", c.name, factor(c)));
        let in_talk = |of: &dyn Fn(usize) -> f64| [0, 1, 2].map(|axis| three(of(axis))).join(", ");
        let [raw, before, after] = self.left_um();
        let coefficients = [self.before.tool_um_s2_per_m[(X, Z)], self.after.tool_um_s2_per_m[(X, Z)]];
        let [move_raw, move_before, move_after] =
            [0.0, coefficients[0], coefficients[1]].map(|c| without_noise(self.travelled.left_um(X, c)));
        let alone = travel::by_jerk_alone(travel::WAY_M, travel::PRINTED.jerk_m_per_s3);
        let [printed, faster, harder] = self.commanded;
        vec![
            format!(
                "A machine whose guideways have {} of the catalogue's stiffness, and {} % of scatter about that, is \
                 measured on circles in three planes. Each part of the catalogue's model gets a factor in its turn; \
                 what it leaves on circles at another acceleration, in standard deviations of the readings: {}; the \
                 catalogue as it is, {}.",
                machines::TRUE_SHARE,
                100.0 * machines::GUIDEWAY_SCATTER,
                ranking.join(", "),
                three(identify::distance(&self.judge, &self.before, machines::WEIGHTS)),
            ),
            format!(
                "Found: {}. Error at the tool on the judging circles, rms without the probe's noise: \
                 {} µm; the catalogue's machine leaves {} µm of it, the identified one {} µm.",
                found,
                three(raw),
                three(before),
                three(after),
            ),
            format!(
                "In-talk of x, y and z by the ellipses, µm·s²/m: measured {}; the catalogue {}; identified {}.",
                in_talk(&|axis| self.judge.talk_um_s2_per_m[(axis, axis)]),
                in_talk(&|axis| self.before.tool_um_s2_per_m[(axis, axis)]),
                in_talk(&|axis| self.after.tool_um_s2_per_m[(axis, axis)]),
            ),
            format!(
                "The same coefficients on the 20 mm move of the true machine: {} µm in x, of which the catalogue leaves \
                 {} and the identified machine {}. By least squares over the whole move the cross-talk is {} µm·s²/m, on \
                 the circles {} with a standard error of {}.",
                three(move_raw),
                three(move_before),
                three(move_after),
                three(self.travelled.coefficient(X)),
                three(self.measured.talk_um_s2_per_m[(X, Z)]),
                significant(self.measured.deviation_um_s2_per_m[(X, Z)], 2),
            ),
            format!(
                "What keeps the 20 mm move below 10 m/s² is the jerk, not the speed: with the jerk alone the \
                 acceleration is the cube root of s·j²/2, {} m/s², at a speed of a²/j, {} m/s of the 0.5 allowed. The \
                 interpolator commands {} m/s²; with twice the speed allowed {} m/s², with a jerk of {} m/s³ {} m/s². The \
                 axis itself reaches {} m/s²: its position loop lags.",
                three(alone.acceleration_m_per_s2),
                three(alone.speed_m_per_s),
                three(printed.acceleration_m_per_s2),
                three(faster.acceleration_m_per_s2),
                three(harder.jerk_m_per_s3),
                three(harder.acceleration_m_per_s2),
                three(self.simulated.at_most(X).0),
            ),
        ]
    }
}

/// What the print leaves open, what was read, and why.
pub const NOTES: [&str; 5] = [
    "The paper prints neither masses nor stiffness nor gains. The machine is ours; three of its values are chosen for \
     what the paper reports: the distance of the ram's screw for the cross-talk of −0.55, the share of the true \
     guideways for the −1.55, and Kp for the 4.7 m/s² of the simulated circle. These rows, and the factor between the first two, agree by \
     choice; the others are what follows.",
    "Equations (1), (2) and (12) to (16) are missing from the scan; they are read as the moment of the drive force \
     about the centre of gravity, M·q″ + D·q′ + K·q = B·f, and its state space.",
    "The paper says that the set acceleration was not reached because of the settings of jerk and speed. A speed of \
     30,000 mm/min is never reached on 20 mm with 250 m/s³; jerk and way alone are the limit.",
    "3.7 µm over 7.9 m/s² is −0.47, not −0.48; within the rounding of both figures it may be −0.46 to −0.48. Either \
     way it is an eighth less than the −0.55 of the circles, which the paper calls quite similar. Here the structure is \
     linear and its lowest mode lies at 30 Hz, so move and circles have one coefficient but for a few percent of \
     dynamics: with −0.55 given on the circles, neither −0.48 nor 3.7 µm can come out.",
    "7.9 m/s² depends on the gains, which are not printed. With Kp from the circle, and the velocity loop by the usual \
     rule, the axis reaches a little less.",
];
