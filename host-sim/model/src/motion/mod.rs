//! The motion file: where the axes stand at the beginning, and what they do then, block by block.

mod arc;
mod pace;

use std::path::Path;

use indexmap::IndexMap;
use serde::Deserialize;
use shared::interpolate::Ramps;

use files::axis_name::{AXIS_NAME, is_axis_name};
use files::document::{Document, read_text};
use files::error::InputError;

/// Shorter lines and radii are none: 1 nm.
const SHORTEST_MM: f64 = 1e-6;
/// 100 m: more is a slip of the unit.
const LONGEST_TRAVEL_MM: f64 = 1e5;
/// Longer motions are a slip of the unit, and would fill the memory with their log.
const LONGEST_S: f64 = 3600.0;

/// A motion that has been checked: every block can be run from where the one before it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// For people and file names.
    pub name: String,
    /// Where the axes stand at the beginning; names all axes, in the order of the file.
    pub start_mm: IndexMap<String, f64>,
    /// What they do, one after the other.
    pub blocks: Vec<Block>,
}

/// One block.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Standstill.
    Dwell {
        /// How long.
        seconds: f64,
    },
    /// A straight line of all axes.
    Line {
        /// Target of every axis, also of those that stay.
        to_mm: IndexMap<String, f64>,
        /// How fast.
        pace: Pace,
    },
    /// An arc of two axes about a centre, starting where they stand.
    Arc {
        /// First and second axis: counter-clockwise leads from the first's + to the second's +.
        plane: [String; 2],
        /// Centre, in the order of the plane.
        centre_mm: [f64; 2],
        /// How far round.
        sweep: Sweep,
        /// How fast.
        pace: Pace,
    },
}

/// How far round an arc leads. Positive is counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// By signed turns.
    Turns(f64),
    /// To a point on the circle.
    To {
        /// In the order of the plane.
        to_mm: [f64; 2],
        /// Which way.
        direction: Direction,
    },
}

/// Sense of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// From the plane's first axis towards its second.
    Positive,
    /// The other way.
    Negative,
}

/// How a line or an arc is travelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Path speed.
    pub feed_mm_per_min: f64,
    /// Path acceleration.
    pub acceleration_m_per_s2: f64,
    /// How the speed rises and falls.
    pub ramps: Ramps,
    /// Greatest distance from the corner behind the block; 0: exact stop.
    pub joint_tolerance_um: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMotion {
    name: String,
    feed_mm_per_min: f64,
    acceleration_m_per_s2: f64,
    ramps: Option<pace::Kind>,
    jerk_m_per_s3: Option<f64>,
    joint_tolerance_um: Option<f64>,
    start_mm: IndexMap<String, f64>,
    #[serde(default)]
    block: Vec<RawBlock>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBlock {
    dwell_s: Option<f64>,
    line_to_mm: Option<IndexMap<String, f64>>,
    arc: Option<RawArc>,
    feed_mm_per_min: Option<f64>,
    acceleration_m_per_s2: Option<f64>,
    ramps: Option<pace::Kind>,
    jerk_m_per_s3: Option<f64>,
    joint_tolerance_um: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawArc {
    plane: [String; 2],
    centre_mm: IndexMap<String, f64>,
    turns: Option<f64>,
    to_mm: Option<IndexMap<String, f64>>,
    direction: Option<Direction>,
}

impl Motion {
    /// Reads a motion file.
    ///
    /// # Errors
    /// If it cannot be read, or a block cannot be run.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a motion file; `source` is for messages.
    ///
    /// # Errors
    /// If a block cannot be run.
    pub fn parse(text: &str, source: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, source)?;
        let raw: RawMotion = document.deserialize()?;
        let mut run = Run::begin(&raw, &document)?;
        run.pace.jerk_is_used(&raw.block, &document)?;
        let mut blocks = Vec::with_capacity(raw.block.len());
        for (index, block) in raw.block.into_iter().enumerate() {
            blocks.push(run.block(block, &format!("block[{index}]"))?);
        }
        if blocks.is_empty() {
            return Err(document.refuse("block", "at least one [[block]]"));
        }
        Ok(Self { name: raw.name, start_mm: run.start_mm, blocks })
    }
}

/// The motion up to some block.
struct Run<'a> {
    document: &'a Document<'a>,
    pace: pace::Defaults,
    start_mm: IndexMap<String, f64>,
    position_mm: IndexMap<String, f64>,
    /// At least; acceleration comes on top.
    duration_s: f64,
}

impl<'a> Run<'a> {
    fn begin(raw: &RawMotion, document: &'a Document<'a>) -> Result<Self, InputError> {
        if let Some(name) = raw.start_mm.keys().find(|name| !is_axis_name(name)) {
            return Err(document.refuse(&format!("start_mm.{name}"), AXIS_NAME));
        }
        let mut start_mm = IndexMap::new();
        for key in document.children("start_mm") {
            let name = &key["start_mm.".len()..];
            within_travel(raw.start_mm[name], key, document)?;
            start_mm.insert(name.to_owned(), raw.start_mm[name]);
        }
        if start_mm.is_empty() {
            return Err(document.refuse("start_mm", "at least one axis"));
        }
        Ok(Self {
            document,
            pace: pace::Defaults::of(raw, document)?,
            position_mm: start_mm.clone(),
            start_mm,
            duration_s: 0.0,
        })
    }

    fn block(&mut self, raw: RawBlock, key: &str) -> Result<Block, InputError> {
        let pace = pace::Own::of(&raw);
        match (raw.dwell_s, raw.line_to_mm, raw.arc) {
            (Some(seconds), None, None) => self.dwell(seconds, &pace, key),
            (None, Some(to_mm), None) => self.line(&to_mm, &pace, key),
            (None, None, Some(arc)) => self.arc(arc, &pace, key),
            _ => Err(self.document.refuse(key, "exactly one of dwell_s, line_to_mm, arc")),
        }
    }

    fn dwell(&mut self, seconds: f64, pace: &pace::Own, key: &str) -> Result<Block, InputError> {
        if *pace != pace::Own::default() {
            let what = "a dwell without feed, acceleration, ramps, jerk or tolerance";
            return Err(self.document.refuse(key, what));
        }
        let seconds = positive(seconds, &format!("{key}.dwell_s"), self.document)?;
        self.lasts(seconds, key)?;
        Ok(Block::Dwell { seconds })
    }

    fn line(
        &mut self,
        named_mm: &IndexMap<String, f64>,
        pace: &pace::Own,
        key: &str,
    ) -> Result<Block, InputError> {
        let mut to_mm = self.position_mm.clone();
        for (name, &target_mm) in named_mm {
            let key = format!("{key}.line_to_mm.{name}");
            *to_mm.get_mut(name).ok_or_else(|| self.unknown_axis(&key))? = target_mm;
            within_travel(target_mm, &key, self.document)?;
        }
        let steps_mm = to_mm.values().zip(self.position_mm.values()).map(|(to, from)| to - from);
        let length_mm = steps_mm.map(|step_mm| step_mm * step_mm).sum::<f64>().sqrt();
        if length_mm < SHORTEST_MM {
            let what = "a target away from where the axes stand";
            return Err(self.document.refuse(&format!("{key}.line_to_mm"), what));
        }
        let pace = self.pace(pace, length_mm, key)?;
        self.position_mm.clone_from(&to_mm);
        Ok(Block::Line { to_mm, pace })
    }

    fn arc(&mut self, arc: RawArc, pace: &pace::Own, key: &str) -> Result<Block, InputError> {
        let names = self.start_mm.keys().map(String::as_str).collect::<Vec<_>>();
        let from_mm = |name: &String| self.position_mm.get(name).copied();
        let planned = arc::Planned::of(&arc, from_mm, &names, &format!("{key}.arc"), self.document)?;
        let pace = self.pace(pace, planned.length_mm, key)?;
        for (name, end_mm) in arc.plane.iter().zip(planned.end_mm) {
            self.position_mm[name] = end_mm;
        }
        Ok(Block::Arc { plane: arc.plane, centre_mm: planned.centre_mm, sweep: planned.sweep, pace })
    }

    /// How a block of that length is travelled; it counts as having been.
    fn pace(&mut self, own: &pace::Own, length_mm: f64, key: &str) -> Result<Pace, InputError> {
        let pace = self.pace.with(own, key, self.document)?;
        self.lasts(60.0 * length_mm / pace.feed_mm_per_min, key)?;
        Ok(pace)
    }

    fn lasts(&mut self, seconds: f64, key: &str) -> Result<(), InputError> {
        self.duration_s += seconds;
        if self.duration_s <= LONGEST_S {
            return Ok(());
        }
        let what = format!("an end within {LONGEST_S} s");
        Err(self.document.refuse(key, &what))
    }

    fn unknown_axis(&self, key: &str) -> InputError {
        let names: Vec<&str> = self.start_mm.keys().map(String::as_str).collect();
        unknown_axis(&names, key, self.document)
    }
}

fn unknown_axis(names: &[&str], key: &str, document: &Document<'_>) -> InputError {
    document.refuse(key, &format!("an axis that start_mm names ({})", names.join(", ")))
}

fn positive(value: f64, key: &str, document: &Document<'_>) -> Result<f64, InputError> {
    if value > 0.0 { Ok(value) } else { Err(document.refuse(key, "a number above 0")) }
}

fn within_travel(value_mm: f64, key: &str, document: &Document<'_>) -> Result<(), InputError> {
    if value_mm.abs() <= LONGEST_TRAVEL_MM {
        return Ok(());
    }
    Err(document.refuse(key, &format!("a travel within {LONGEST_TRAVEL_MM} mm of zero")))
}

#[cfg(test)]
mod tests;
