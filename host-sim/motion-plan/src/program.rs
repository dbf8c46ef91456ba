//! A motion as G-code.

use std::fmt::Write;
use std::str::FromStr;

use indexmap::IndexMap;
use motion::{Block, Direction, Motion, Sweep};

/// The control that reads a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// LinuxCNC: exact path G61.1; G4 P in seconds.
    LinuxCnc,
    /// Siemens Sinumerik: exact stop G60; G4 F in seconds.
    Siemens,
    /// Fanuc: exact stop mode G61; G4 X in seconds.
    Fanuc,
}

impl FromStr for Dialect {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "linuxcnc" => Ok(Self::LinuxCnc),
            "siemens" => Ok(Self::Siemens),
            "fanuc" => Ok(Self::Fanuc),
            _ => Err("expected linuxcnc, siemens or fanuc".to_owned()),
        }
    }
}

impl Dialect {
    /// A comment.
    fn comment(self, text: &str) -> String {
        match self {
            Self::Siemens => format!("; {text}\n"),
            Self::LinuxCnc | Self::Fanuc => format!("({})\n", text.replace(['(', ')'], "'")),
        }
    }

    /// Millimetres, absolute, exact stop, plane of the first two axes.
    const fn begin(self) -> &'static str {
        match self {
            Self::LinuxCnc => "G21 G90 G94 G17 G61.1\n",
            Self::Siemens => "G71 G90 G94 G17 G60\n",
            Self::Fanuc => "G21 G90 G94 G17 G61\n",
        }
    }

    const fn end(self) -> &'static str {
        match self {
            Self::LinuxCnc => "M2\n",
            Self::Siemens => "M30\n",
            Self::Fanuc => "M30\n%\n",
        }
    }

    fn dwell(self, seconds: f64) -> String {
        match self {
            Self::LinuxCnc => format!("G4 P{seconds:.2}\n"),
            Self::Siemens => format!("G4 F{seconds:.2}\n"),
            Self::Fanuc => format!("G4 X{seconds:.2}\n"),
        }
    }
}

/// The program of a motion. G-code has no acceleration: the greatest one is in a comment, and where the control allows less, or more,
/// it is the control's that acts.
#[must_use]
pub fn of(motion: &Motion, dialect: Dialect) -> String {
    let mut text = if dialect == Dialect::Fanuc { "%\nO0001\n".to_owned() } else { String::new() };
    let acceleration = motion
        .blocks
        .iter()
        .filter_map(|block| Some(block.pace()?.acceleration_m_per_s2))
        .fold(0.0, f64::max);
    text += &dialect
        .comment(&format!("{}: written by lost-motion plan, without a tool or a workpiece", motion.name));
    text += &dialect
        .comment(&format!("planned for at most {acceleration} m/s^2; check the travel before the first run"));
    text += dialect.begin();
    // Writing into a text does not fail.
    let _ = writeln!(text, "G0 {}", words(&motion.start_mm));
    let mut at_mm = motion.start_mm.clone();
    for block in &motion.blocks {
        text += &line(block, &mut at_mm, dialect);
    }
    text + dialect.end()
}

fn words(mm: &IndexMap<String, f64>) -> String {
    let word = |(axis, mm): (&String, &f64)| format!("{}{}", axis.to_uppercase(), number(*mm));
    mm.iter().map(word).collect::<Vec<_>>().join(" ")
}

/// To 1 µm, with a point, which Fanuc needs.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

fn line(block: &Block, at_mm: &mut IndexMap<String, f64>, dialect: Dialect) -> String {
    match block {
        Block::Dwell { seconds } => dialect.dwell(*seconds),
        Block::Line { to_mm, pace } => {
            let moved = to_mm.iter().filter(|(axis, mm)| at_mm.get(*axis) != Some(mm));
            let moved: IndexMap<String, f64> = moved.map(|(axis, mm)| (axis.clone(), *mm)).collect();
            at_mm.clone_from(to_mm);
            format!("G1 {} F{:.1}\n", words(&moved), pace.feed_mm_per_min)
        }
        Block::Arc { plane, centre_mm, sweep, pace } => {
            let from_mm = [at_mm[&plane[0]], at_mm[&plane[1]]];
            let (is_positive, turns, to_mm) = match sweep {
                Sweep::Turns(turns) => (*turns > 0.0, turns.abs(), from_mm),
                Sweep::To { to_mm, direction } => (*direction == Direction::Positive, 1.0, *to_mm),
            };
            (at_mm[&plane[0]], at_mm[&plane[1]]) = (to_mm[0], to_mm[1]);
            let code = if is_positive { "G3" } else { "G2" };
            let ends: IndexMap<String, f64> = plane.iter().cloned().zip(to_mm).collect();
            let centre = [centre_mm[0] - from_mm[0], centre_mm[1] - from_mm[1]].map(number);
            let letters = plane.each_ref().map(|axis| centre_letter(axis));
            let one = format!(
                "{code} {} {}{} {}{} F{:.1}\n",
                words(&ends),
                letters[0],
                centre[0],
                letters[1],
                centre[1],
                pace.feed_mm_per_min
            );
            // A plan has whole turns alone.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few turns")]
            one.repeat(turns.round().max(1.0) as usize)
        }
    }
}

/// The letter of the centre along an axis.
fn centre_letter(axis: &str) -> char {
    match axis {
        "y" => 'J',
        "z" => 'K',
        _ => 'I',
    }
}
