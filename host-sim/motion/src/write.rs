//! Writes a motion as the text of its file.

use std::fmt::Write;

use indexmap::IndexMap;
use shared::interpolate::Ramps;

use super::block::{Block, Direction, Motion, Pace, Sweep};

impl Motion {
    /// Text of the motion file, which is read as this motion, with a comment before it.
    #[must_use]
    pub fn to_toml(&self, comment: &str) -> String {
        let mut text = comment.lines().fold(String::new(), |text, line| text + "# " + line + "\n");
        let first = self.blocks.iter().find_map(Block::pace);
        // Writing into a text does not fail. A motion of dwells alone has no pace, but its file needs one.
        let (feed, acceleration) =
            first.map_or((1000.0, 1.0), |pace| (pace.feed_mm_per_min, pace.acceleration_m_per_s2));
        let _ = writeln!(
            text,
            "name = {:?}\nfeed_mm_per_min = {feed:?}\nacceleration_m_per_s2 = {acceleration:?}\nstart_mm = {{ {} }}",
            self.name,
            positions(&self.start_mm)
        );
        text + &self.blocks.iter().map(block).collect::<String>()
    }
}

impl Block {
    /// Feed, acceleration, ramps and joint; `None`: a standstill.
    #[must_use]
    pub const fn pace(&self) -> Option<&Pace> {
        match self {
            Self::Dwell { .. } => None,
            Self::Line { pace, .. } | Self::Arc { pace, .. } => Some(pace),
        }
    }
}

fn positions(mm: &IndexMap<String, f64>) -> String {
    mm.iter().map(|(axis, mm)| format!("{axis} = {mm:?}")).collect::<Vec<_>>().join(", ")
}

fn block(block: &Block) -> String {
    match block {
        Block::Dwell { seconds } => format!("\n[[block]]\ndwell_s = {seconds:?}\n"),
        Block::Line { to_mm, pace } => {
            format!("\n[[block]]\nline_to_mm = {{ {} }}\n{}", positions(to_mm), pace_text(pace))
        }
        Block::Arc { plane: [first, second], centre_mm: [x, y], sweep, pace } => {
            let end = match sweep {
                Sweep::Turns(turns) => format!("turns = {turns:?}"),
                Sweep::To { to_mm: [x, y], direction } => {
                    let direction = match direction {
                        Direction::Positive => "positive",
                        Direction::Negative => "negative",
                    };
                    format!("to_mm = {{ {first} = {x:?}, {second} = {y:?} }}, direction = \"{direction}\"")
                }
            };
            format!(
                "\n[[block]]\narc = {{ plane = [\"{first}\", \"{second}\"], centre_mm = {{ {first} = {x:?}, {second} = {y:?} }}, {end} }}\n{}",
                pace_text(pace)
            )
        }
    }
}

fn pace_text(pace: &Pace) -> String {
    let Pace { feed_mm_per_min, acceleration_m_per_s2, ramps, joint_tolerance_um } = pace;
    let mut text =
        format!("feed_mm_per_min = {feed_mm_per_min:?}\nacceleration_m_per_s2 = {acceleration_m_per_s2:?}\n");
    text += &match ramps {
        Ramps::Trapezoid => String::new(),
        Ramps::SCurve { jerk_m_per_s3 } => {
            format!("ramps = \"s-curve\"\njerk_m_per_s3 = {jerk_m_per_s3:?}\n")
        }
        Ramps::Exponential => "ramps = \"exponential\"\n".to_owned(),
        Ramps::AfterInterpolation => "ramps = \"after-interpolation\"\n".to_owned(),
    };
    if *joint_tolerance_um > 0.0 {
        text += &format!("joint_tolerance_um = {joint_tolerance_um:?}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let text = "name = \"m\"\nfeed_mm_per_min = 1234.5\nacceleration_m_per_s2 = 0.7\nstart_mm = { x = 10.0, y = -3.5 }\n\
                    [[block]]\ndwell_s = 0.5\n\
                    [[block]]\nline_to_mm = { x = 20.25 }\njoint_tolerance_um = 4.0\n\
                    [[block]]\narc = { plane = [\"x\", \"y\"], centre_mm = { x = 30.25, y = -3.5 }, turns = -1.5 }\nfeed_mm_per_min = 800.0\n\
                    [[block]]\narc = { plane = [\"x\", \"y\"], centre_mm = { x = 30.25, y = -3.5 }, to_mm = { x = 30.25, y = 6.5 }, direction = \"negative\" }\n\
                    ramps = \"s-curve\"\njerk_m_per_s3 = 20.0\n";
        let motion = Motion::parse(text, "m.toml").unwrap();
        let again = Motion::parse(&motion.to_toml("A motion.\nTwo lines."), "again.toml").unwrap();
        assert_eq!(again, motion);
    }
}
