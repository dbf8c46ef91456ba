//! A motion as a program of a control: LinuxCNC, Siemens SINUMERIK or Fanuc.
//!
//! The commands are those of ISO 6983 that all three have (G1, G2, G3, G4, G17 to G19, G21, G90, G94); they differ in comments, dwell,
//! exact stop, the blending of corners, and the end of a program. Acceleration and ramps are settings of the control: the program says in a comment which ones the
//! motion has.

use std::fmt::Write;

use super::block::{Block, Direction, Motion, Sweep};
use shared::interpolate::Ramps;

/// A control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// LinuxCNC 2.8 or later.
    Linuxcnc,
    /// SINUMERIK 840D and ONE, in its own language.
    Siemens,
    /// Fanuc 0i and 30i with increment system IS-B: 1 µm.
    Fanuc,
}

/// Axes that a program may move, with the letter of the offset of an arc's centre.
const LETTERS: [(&str, char, Option<char>); 6] = [
    ("x", 'X', Some('I')),
    ("y", 'Y', Some('J')),
    ("z", 'Z', Some('K')),
    ("u", 'U', None),
    ("v", 'V', None),
    ("w", 'W', None),
];

/// Why a motion has no program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoProgram {
    /// An axis that has no letter, or is rotary: a feed in mm/min does not say how fast it turns.
    #[error("expected axes x, y, z, u, v or w, found {0}")]
    Axis(String),
    /// An arc of axes that no plane has.
    #[error("expected an arc of two of x, y and z, found {0} and {1}")]
    Plane(String, String),
}

impl Control {
    /// Decimals of a position, mm. A control with an increment of 1 µm rounds or refuses more.
    const fn decimals(self) -> usize {
        match self {
            Self::Linuxcnc => 5,
            Self::Siemens => 4,
            Self::Fanuc => 3,
        }
    }

    /// A remark.
    fn remark(self, text: &str) -> String {
        match self {
            Self::Siemens => format!("; {text}"),
            // Parentheses would end the remark.
            Self::Linuxcnc | Self::Fanuc => format!("({})", text.replace(['(', ')'], "")),
        }
    }

    fn dwell(self, seconds: f64) -> String {
        match self {
            Self::Linuxcnc => format!("G4 P{seconds:.3}"),
            Self::Siemens => format!("G4 F{seconds:.3}"),
            Self::Fanuc => format!("G4 X{seconds:.3}"),
        }
    }

    /// How the end of a block is approached: exactly, or within a tolerance. Fanuc has no tolerance in the program.
    fn joint(self, tolerance_um: f64) -> String {
        let tolerance_mm = 1e-3 * tolerance_um;
        match self {
            Self::Siemens if tolerance_um <= 0.0 => "G60".to_owned(),
            Self::Linuxcnc | Self::Fanuc if tolerance_um <= 0.0 => "G61".to_owned(),
            Self::Linuxcnc => format!("G64 P{tolerance_mm:.5}"),
            Self::Siemens => format!("G641 ADIS={tolerance_mm:.4}"),
            Self::Fanuc => "G64".to_owned(),
        }
    }
}

/// The program of a motion.
///
/// # Errors
/// [`NoProgram`] for a motion with other axes or planes than those of the control.
pub fn program(motion: &Motion, control: Control) -> Result<String, NoProgram> {
    let mut writer = Writer::new(motion, control)?;
    for block in &motion.blocks {
        writer.block(block)?;
    }
    Ok(writer.ended())
}

/// A program that is being written.
struct Writer {
    control: Control,
    text: String,
    /// Letters of the axes, in the order of the motion.
    axes: Vec<(String, char)>,
    position_mm: Vec<f64>,
    /// Plane, joint, feed, and acceleration with ramps as they were last written.
    state: [String; 4],
}

impl Writer {
    fn new(motion: &Motion, control: Control) -> Result<Self, NoProgram> {
        let letter = |name: &String| {
            let known = LETTERS.iter().find(|(axis, ..)| axis == name);
            known.map(|(_, letter, _)| (name.clone(), *letter)).ok_or_else(|| NoProgram::Axis(name.clone()))
        };
        let axes = motion.start_mm.keys().map(letter).collect::<Result<Vec<_>, _>>()?;
        let position_mm = motion.start_mm.values().copied().collect();
        let mut writer = Self { control, text: String::new(), axes, position_mm, state: Default::default() };
        let name: String = motion.name.chars().filter(|c| c.is_ascii_graphic() || *c == ' ').collect();
        if control == Control::Fanuc {
            writer.line("%");
            writer.line(&format!("O1000 {}", control.remark(&name.to_uppercase())));
        } else {
            writer.line(&control.remark(&name));
        }
        writer.line(
            &control.remark("Check travel and clearance. The zero of the program is the zero of the motion."),
        );
        writer.line(if control == Control::Siemens { "G71 G90 G94 G40" } else { "G21 G90 G94 G40" });
        let first = motion.blocks.iter().find_map(|block| match block {
            Block::Line { pace, .. } | Block::Arc { pace, .. } => Some(pace.feed_mm_per_min),
            Block::Dwell { .. } => None,
        });
        let start = writer.words(&writer.position_mm);
        writer.line(&format!("G1 {start} F{:.1}", first.unwrap_or(1000.0)));
        Ok(writer)
    }

    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// Writes a command unless it is in force.
    fn once(&mut self, kind: usize, command: String) {
        if self.state[kind] != command {
            self.line(&command);
            self.state[kind] = command;
        }
    }

    /// A position of all axes.
    fn words(&self, position_mm: &[f64]) -> String {
        let decimals = self.control.decimals();
        let mut text = String::new();
        for ((_, letter), mm) in self.axes.iter().zip(position_mm) {
            let separator = if text.is_empty() { "" } else { " " };
            // Writing into a text does not fail. The addition makes −0 a 0.
            let _ = write!(text, "{separator}{letter}{:.decimals$}", rounded(*mm, decimals) + 0.0);
        }
        text
    }

    fn block(&mut self, block: &Block) -> Result<(), NoProgram> {
        let pace = match block {
            Block::Dwell { seconds } => {
                let dwell = self.control.dwell(*seconds);
                self.line(&dwell);
                return Ok(());
            }
            Block::Line { pace, .. } | Block::Arc { pace, .. } => *pace,
        };
        let ramps = match pace.ramps {
            Ramps::Trapezoid => "constant while it lasts".to_owned(),
            Ramps::SCurve { jerk_m_per_s3 } => format!("jerk {jerk_m_per_s3} m/s3"),
            Ramps::Exponential => "exponential ramps".to_owned(),
            Ramps::AfterInterpolation => "no ramps, filtered after the interpolation".to_owned(),
        };
        let acceleration = format!("acceleration {} m/s2, {ramps}", pace.acceleration_m_per_s2);
        let acceleration = self.control.remark(&acceleration);
        self.once(3, acceleration);
        self.once(1, self.control.joint(pace.joint_tolerance_um));
        let feed = format!("F{:.1}", pace.feed_mm_per_min);
        self.once(2, feed);
        match block {
            Block::Dwell { .. } => {}
            Block::Line { to_mm, .. } => {
                for ((name, _), position_mm) in self.axes.iter().zip(&mut self.position_mm) {
                    *position_mm = to_mm.get(name).copied().unwrap_or(*position_mm);
                }
                let words = self.words(&self.position_mm);
                self.line(&format!("G1 {words}"));
            }
            Block::Arc { plane, centre_mm, sweep, .. } => self.arc(plane, *centre_mm, *sweep)?,
        }
        Ok(())
    }

    /// An arc: whole circles, each a block of its own, and the rest.
    fn arc(&mut self, plane: &[String; 2], centre_mm: [f64; 2], sweep: Sweep) -> Result<(), NoProgram> {
        let unknown = || NoProgram::Plane(plane[0].clone(), plane[1].clone());
        let index = |name: &String| self.axes.iter().position(|(axis, _)| axis == name).ok_or_else(unknown);
        let axes = [index(&plane[0])?, index(&plane[1])?];
        let code = |a: &str, b: &str| match (a, b) {
            // G18 is the plane of z and x, in this order.
            ("x", "y") => Some(("G17", true)),
            ("y", "x") => Some(("G17", false)),
            ("z", "x") => Some(("G18", true)),
            ("x", "z") => Some(("G18", false)),
            ("y", "z") => Some(("G19", true)),
            ("z", "y") => Some(("G19", false)),
            _ => None,
        };
        let (plane_code, is_in_order) = code(&plane[0], &plane[1]).ok_or_else(unknown)?;
        let from_mm = axes.map(|axis| self.position_mm[axis]);
        let radius = [0, 1].map(|i| from_mm[i] - centre_mm[i]);
        let (circles, end_mm, is_positive) = match sweep {
            Sweep::To { to_mm, direction } => (0, Some(to_mm), direction == Direction::Positive),
            Sweep::Turns(turns) => {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few turns")]
                let circles = (turns.abs() + 1e-9).floor() as usize;
                let rest = turns.abs() - circles as f64;
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * turns.signum() * rest);
                let end_mm = [
                    centre_mm[0] + radius[0] * cos - radius[1] * sin,
                    centre_mm[1] + radius[0] * sin + radius[1] * cos,
                ];
                (circles, (rest > 1e-9).then_some(end_mm), turns > 0.0)
            }
        };
        self.once(0, plane_code.to_owned());
        let command = if is_positive == is_in_order { "G3" } else { "G2" };
        for _ in 0..circles {
            self.sweep(command, axes, radius);
        }
        if let Some(end_mm) = end_mm {
            axes.into_iter().zip(end_mm).for_each(|(axis, mm)| self.position_mm[axis] = mm);
            self.sweep(command, axes, radius);
        }
        Ok(())
    }

    /// A block of an arc to the present position; `radius` is from its centre to its start, mm.
    fn sweep(&mut self, command: &str, axes: [usize; 2], radius: [f64; 2]) {
        let decimals = self.control.decimals();
        let mut line = format!("{command} {}", self.words(&self.position_mm));
        for (axis, radius_mm) in axes.into_iter().zip(radius) {
            let letter = LETTERS
                .iter()
                .find(|(name, ..)| *name == self.axes[axis].0)
                .and_then(|(_, _, offset)| *offset);
            // Writing into a text does not fail.
            let _ =
                write!(line, " {}{:.decimals$}", letter.unwrap_or('I'), rounded(-radius_mm, decimals) + 0.0);
        }
        self.line(&line);
    }

    fn ended(mut self) -> String {
        match self.control {
            Control::Linuxcnc => self.line("M2"),
            Control::Siemens => self.line("M30"),
            Control::Fanuc => {
                self.line("M30");
                self.line("%");
            }
        }
        self.text
    }
}

/// A number as it is printed, so that −0.00 is not.
fn rounded(value: f64, decimals: usize) -> f64 {
    let units = libm::pow(10.0, decimals as f64);
    libm::round(value * units) / units
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTION: &str = "name = 'a (b)'\nfeed_mm_per_min = 2000.0\nacceleration_m_per_s2 = 1.0\nstart_mm = { x = 50.0, y = 0.0, z = 5.0 }\n\
        [[block]]\ndwell_s = 0.25\n\
        [[block]]\narc = { plane = ['x', 'y'], centre_mm = { x = 0.0, y = 0.0 }, turns = 1.25 }\n\
        [[block]]\narc = { plane = ['x', 'y'], centre_mm = { x = 0.0, y = 0.0 }, turns = -0.25 }\n\
        [[block]]\narc = { plane = ['x', 'z'], centre_mm = { x = 40.0, z = 5.0 }, turns = 0.5 }\n\
        [[block]]\nline_to_mm = { x = 20.0, z = 0.0 }\nfeed_mm_per_min = 500.0\njoint_tolerance_um = 20.0\n\
        [[block]]\nline_to_mm = { x = 20.0, y = 10.0 }\n";

    fn motion() -> Motion {
        Motion::parse(MOTION, "p.toml").unwrap()
    }

    /// The points that a program runs through: an independent interpreter of the few commands, with 90 points an arc.
    fn points(program: &str) -> Vec<[f64; 3]> {
        let (mut at, mut plane, mut points) = ([0.0; 3], [0, 1], Vec::new());
        for line in program.lines().filter(|line| !line.starts_with(['(', ';', '%', 'O'])) {
            let (mut to, mut offset, mut motion) = (at, [0.0; 3], None);
            for word in line.split_whitespace() {
                let (letter, number) = word.split_at(1);
                let value = || number.parse::<f64>().unwrap();
                match (letter, number) {
                    ("G", "17") => plane = [0, 1],
                    ("G", "18") => plane = [2, 0],
                    ("G", "19") => plane = [1, 2],
                    ("G", "1" | "2" | "3") => motion = Some(number),
                    ("G", "4") => break,
                    ("X" | "Y" | "Z", _) => to["XYZ".find(letter).unwrap()] = value(),
                    ("I" | "J" | "K", _) => offset["IJK".find(letter).unwrap()] = value(),
                    _ => {}
                }
            }
            let turned = |i: u32, motion: &str| {
                let [a, b] = plane;
                let centre = [at[a] + offset[a], at[b] + offset[b]];
                let angle = |p: [f64; 3]| (p[b] - centre[1]).atan2(p[a] - centre[0]);
                let sign = if motion == "3" { 1.0 } else { -1.0 };
                let full = std::f64::consts::TAU;
                let sweep = (sign * (angle(to) - angle(at))).rem_euclid(full);
                let sweep = if (1e-4..full - 1e-4).contains(&sweep) { sweep } else { full };
                let angle = angle(at) + sign * sweep * f64::from(i) / 90.0;
                let radius = offset[a].hypot(offset[b]);
                let mut point = to;
                (point[a], point[b]) = (centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin());
                point
            };
            match motion {
                Some("1") => points.push(to),
                Some(motion) => points.extend((1..=90).map(|i| turned(i, motion))),
                None => {}
            }
            at = to;
        }
        points
    }

    /// Start, 1.25 turns and a quarter back in x and y, half a turn from x to z, a line with a corner that is blended, and one without z. The positions are
    /// those of the motion within the decimals of the control.
    #[test]
    fn a_program_runs_through_the_points_of_the_motion() {
        for (control, tolerance_mm) in
            [(Control::Linuxcnc, 1e-5), (Control::Siemens, 1e-4), (Control::Fanuc, 1e-3)]
        {
            let text = program(&motion(), control).unwrap();
            let points = points(&text);
            let is_near = |point: &[f64; 3], expected: [f64; 3]| {
                let off = point.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 2.0 * tolerance_mm, "{control:?}: {point:?} {expected:?}\n{text}");
            };
            assert_eq!(points.len(), 1 + 4 * 90 + 2, "{text}");
            is_near(&points[0], [50.0, 0.0, 5.0]);
            for (i, point) in (1_u32..).zip(&points[1..91]) {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 90.0).sin_cos();
                is_near(point, [50.0 * cos, 50.0 * sin, 5.0]);
            }
            is_near(&points[180], [0.0, 50.0, 5.0]);
            // The quarter back passes the first quadrant, not the other three.
            assert!(points[181..270].iter().all(|point| point[0] > 0.0 && point[1] > 0.0));
            is_near(&points[270], [50.0, 0.0, 5.0]);
            // From +x to +z: upwards.
            is_near(&points[315], [40.0, 0.0, 15.0]);
            is_near(&points[360], [30.0, 0.0, 5.0]);
            is_near(&points[361], [20.0, 0.0, 0.0]);
            is_near(&points[362], [20.0, 10.0, 0.0]);
        }
    }

    #[test]
    fn each_control_has_its_own_words() {
        let of = |control| program(&motion(), control).unwrap();
        let has = |text: &str, lines: &[&str]| {
            for line in lines {
                assert!(text.lines().any(|own| own == *line), "{line}\n{text}");
            }
        };
        has(
            &of(Control::Linuxcnc),
            &["(a b)", "G21 G90 G94 G40", "G4 P0.250", "G61", "G64 P0.02000", "F500.0", "M2"],
        );
        has(
            &of(Control::Siemens),
            &["; a (b)", "G71 G90 G94 G40", "G4 F0.250", "G60", "G641 ADIS=0.0200", "M30"],
        );
        has(&of(Control::Fanuc), &["%", "O1000 (A B)", "G4 X0.250", "G61", "G64", "M30", "G18"]);
        assert!(!of(Control::Fanuc).contains("-0.000"));
    }

    #[test]
    fn axes_without_a_letter_are_refused() {
        let of =
            |text: &str| program(&Motion::parse(text, "p").unwrap(), Control::Fanuc).unwrap_err().to_string();
        let rotary = MOTION.replace("z = ", "c = ").replace("'z'", "'c'");
        assert_eq!(of(&rotary), "expected axes x, y, z, u, v or w, found c");
        let other = MOTION.replace("z = ", "w = ").replace("'z'", "'w'");
        assert_eq!(of(&other), "expected an arc of two of x, y and z, found x and w");
    }
}
