//! The motion file: where the axes stand at the beginning, and what they do then, block by block.

use std::f64::consts::TAU;
use std::path::Path;

use indexmap::IndexMap;
use serde::Deserialize;

use crate::document::{Document, read_text};
use crate::error::InputError;
use crate::machine::{AXIS_NAME, is_axis_name};

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

/// One block. Its feed is along the path.
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
        /// Path speed.
        feed_mm_per_min: f64,
        /// Path acceleration.
        acceleration_m_per_s2: f64,
    },
    /// An arc of two axes about a centre, starting where they stand.
    Arc {
        /// First and second axis: counter-clockwise leads from the first's + to the second's +.
        plane: [String; 2],
        /// Centre, in the order of the plane.
        centre_mm: [f64; 2],
        /// How far round; + is counter-clockwise.
        turns: f64,
        /// Path speed.
        feed_mm_per_min: f64,
        /// Path acceleration.
        acceleration_m_per_s2: f64,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMotion {
    name: String,
    feed_mm_per_min: f64,
    acceleration_m_per_s2: f64,
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawArc {
    plane: [String; 2],
    centre_mm: IndexMap<String, f64>,
    turns: f64,
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
    feed_mm_per_min: f64,
    acceleration_m_per_s2: f64,
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
        for key in document.inside("start_mm") {
            let name = &key["start_mm.".len()..];
            within_travel(raw.start_mm[name], key, document)?;
            start_mm.insert(name.to_owned(), raw.start_mm[name]);
        }
        if start_mm.is_empty() {
            return Err(document.refuse("start_mm", "at least one axis"));
        }
        let positive = |key, value| positive(value, key, document);
        Ok(Self {
            document,
            feed_mm_per_min: positive("feed_mm_per_min", raw.feed_mm_per_min)?,
            acceleration_m_per_s2: positive("acceleration_m_per_s2", raw.acceleration_m_per_s2)?,
            position_mm: start_mm.clone(),
            start_mm,
            duration_s: 0.0,
        })
    }

    fn block(&mut self, raw: RawBlock, key: &str) -> Result<Block, InputError> {
        let pace = (raw.feed_mm_per_min, raw.acceleration_m_per_s2);
        match (raw.dwell_s, raw.line_to_mm, raw.arc) {
            (Some(seconds), None, None) => self.dwell(seconds, pace, key),
            (None, Some(to_mm), None) => self.line(&to_mm, pace, key),
            (None, None, Some(arc)) => self.arc(arc, pace, key),
            _ => Err(self.document.refuse(key, "exactly one of dwell_s, line_to_mm, arc")),
        }
    }

    fn dwell(
        &mut self,
        seconds: f64,
        pace: (Option<f64>, Option<f64>),
        key: &str,
    ) -> Result<Block, InputError> {
        if pace != (None, None) {
            return Err(self.document.refuse(key, "a dwell without feed or acceleration"));
        }
        let seconds = positive(seconds, &format!("{key}.dwell_s"), self.document)?;
        self.lasts(seconds, key)?;
        Ok(Block::Dwell { seconds })
    }

    fn line(
        &mut self,
        named_mm: &IndexMap<String, f64>,
        pace: (Option<f64>, Option<f64>),
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
        let (feed_mm_per_min, acceleration_m_per_s2) = self.pace(pace, length_mm, key)?;
        self.position_mm.clone_from(&to_mm);
        Ok(Block::Line { to_mm, feed_mm_per_min, acceleration_m_per_s2 })
    }

    fn arc(&mut self, arc: RawArc, pace: (Option<f64>, Option<f64>), key: &str) -> Result<Block, InputError> {
        let document = self.document;
        let inner = |name: &str| format!("{key}.arc.{name}");
        let centre_mm = self.centre(&arc, key)?;
        let from_mm = [self.position_mm[&arc.plane[0]], self.position_mm[&arc.plane[1]]];
        let radius_mm = (from_mm[0] - centre_mm[0]).hypot(from_mm[1] - centre_mm[1]);
        if radius_mm < SHORTEST_MM {
            let what = "a centre away from where the axes stand";
            return Err(document.refuse(&inner("centre_mm"), what));
        }
        if arc.turns == 0.0 {
            return Err(document.refuse(&inner("turns"), "a number other than 0"));
        }
        // The whole circle, whichever part of it the arc passes.
        for centre_mm in centre_mm {
            within_travel(centre_mm.abs() + radius_mm, &inner("centre_mm"), document)?;
        }
        let length_mm = TAU * radius_mm * arc.turns.abs();
        let (feed_mm_per_min, acceleration_m_per_s2) = self.pace(pace, length_mm, key)?;
        self.turn(&arc, from_mm, centre_mm);
        let RawArc { plane, turns, .. } = arc;
        Ok(Block::Arc { plane, centre_mm, turns, feed_mm_per_min, acceleration_m_per_s2 })
    }

    /// The centre in the order of the plane, which has to be two axes of the motion.
    fn centre(&self, arc: &RawArc, key: &str) -> Result<[f64; 2], InputError> {
        let refuse = |name: &str, what: &str| self.document.refuse(&format!("{key}.arc.{name}"), what);
        let [first, second] = &arc.plane;
        for (index, name) in arc.plane.iter().enumerate() {
            if !self.start_mm.contains_key(name) {
                return Err(self.unknown_axis(&format!("{key}.arc.plane[{index}]")));
            }
        }
        if first == second {
            return Err(refuse("plane[1]", "another axis than the first"));
        }
        if let Some(name) = arc.centre_mm.keys().find(|name| !arc.plane.contains(name)) {
            let what = format!("only the axes of the plane ({first}, {second})");
            return Err(refuse(&format!("centre_mm.{name}"), &what));
        }
        let coordinate = |name: &String| {
            let given = arc.centre_mm.get(name).copied();
            given.ok_or_else(|| refuse(&format!("centre_mm.{name}"), "this key"))
        };
        Ok([coordinate(first)?, coordinate(second)?])
    }

    /// Moves the running position to the end of an arc; after whole turns that is where it began.
    fn turn(&mut self, arc: &RawArc, from_mm: [f64; 2], centre_mm: [f64; 2]) {
        let (sin, cos) = (TAU * arc.turns.fract()).sin_cos();
        let (x, y) = (from_mm[0] - centre_mm[0], from_mm[1] - centre_mm[1]);
        let end_mm = [centre_mm[0] + x * cos - y * sin, centre_mm[1] + x * sin + y * cos];
        for (name, end_mm) in arc.plane.iter().zip(end_mm) {
            self.position_mm[name] = end_mm;
        }
    }

    /// Feed and acceleration of a block: its own, or those of the file.
    fn pace(
        &mut self,
        (feed, acceleration): (Option<f64>, Option<f64>),
        length_mm: f64,
        key: &str,
    ) -> Result<(f64, f64), InputError> {
        let own = |name: &str, value| positive(value, &format!("{key}.{name}"), self.document);
        let feed = own("feed_mm_per_min", feed.unwrap_or(self.feed_mm_per_min))?;
        let acceleration = acceleration.unwrap_or(self.acceleration_m_per_s2);
        let acceleration = own("acceleration_m_per_s2", acceleration)?;
        self.lasts(60.0 * length_mm / feed, key)?;
        Ok((feed, acceleration))
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
        self.document.refuse(key, &format!("an axis that start_mm names ({})", names.join(", ")))
    }
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
