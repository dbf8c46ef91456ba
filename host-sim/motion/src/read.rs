//! Reads a motion file, block by block.

use std::path::Path;

use files::axis_name::{AXIS_NAME, is_axis_name};
use files::document::{Document, read_text};
use files::error::InputError;
use indexmap::IndexMap;

use super::arc::PlannedArc;
use super::block::{Block, Motion, Pace};
use super::bounds::{LONGEST_S, SHORTEST_MM, positive, unknown_axis, within_travel};
use super::duration::Duration;
use super::pace::{BlockPace, DefaultPace};
use super::tables::{ArcTable, BlockTable, MotionTable};

impl Motion {
    /// Reads a motion file.
    ///
    /// # Errors
    /// If the file cannot be read, or a block cannot be run.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a motion file; `source` names it in error messages.
    ///
    /// # Errors
    /// If a block cannot be run.
    pub fn parse(text: &str, source: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, source)?;
        let raw: MotionTable = document.deserialize()?;
        let mut reader = Reader::begin(&raw, &document)?;
        reader.pace.jerk_is_used(&raw.block, &document)?;
        let mut blocks = Vec::with_capacity(raw.block.len());
        for (index, block) in raw.block.into_iter().enumerate() {
            blocks.push(reader.block(block, &format!("block[{index}]"))?);
        }
        if blocks.is_empty() {
            return Err(document.refuse("block", "at least one [[block]]"));
        }
        Ok(Self { name: raw.name, start_mm: reader.start_mm, blocks })
    }
}

/// The motion up to the current block.
struct Reader<'a> {
    document: &'a Document<'a>,
    pace: DefaultPace,
    start_mm: IndexMap<String, f64>,
    position_mm: IndexMap<String, f64>,
    duration: Duration,
}

impl<'a> Reader<'a> {
    fn begin(raw: &MotionTable, document: &'a Document<'a>) -> Result<Self, InputError> {
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
            pace: DefaultPace::of(raw, document)?,
            position_mm: start_mm.clone(),
            start_mm,
            duration: Duration::default(),
        })
    }

    fn block(&mut self, raw: BlockTable, key: &str) -> Result<Block, InputError> {
        let pace = BlockPace::of(&raw);
        match (raw.dwell_s, raw.line_to_mm, raw.arc) {
            (Some(seconds), None, None) => self.dwell(seconds, &pace, key),
            (None, Some(to_mm), None) => self.line(&to_mm, &pace, key),
            (None, None, Some(arc)) => self.arc(arc, &pace, key),
            _ => Err(self.document.refuse(key, "exactly one of dwell_s, line_to_mm, arc")),
        }
    }

    fn dwell(&mut self, seconds: f64, pace: &BlockPace, key: &str) -> Result<Block, InputError> {
        if *pace != BlockPace::default() {
            let what = "a dwell without feed, acceleration, ramps, jerk or tolerance";
            return Err(self.document.refuse(key, what));
        }
        let seconds = positive(seconds, &format!("{key}.dwell_s"), self.document)?;
        self.duration.add_dwell(seconds);
        self.check_duration(key)?;
        Ok(Block::Dwell { seconds })
    }

    fn line(
        &mut self,
        named_mm: &IndexMap<String, f64>,
        pace: &BlockPace,
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
            let what = "a target other than the current position";
            return Err(self.document.refuse(&format!("{key}.line_to_mm"), what));
        }
        let pace = self.pace(pace, length_mm, key)?;
        self.position_mm.clone_from(&to_mm);
        Ok(Block::Line { to_mm, pace })
    }

    fn arc(&mut self, arc: ArcTable, pace: &BlockPace, key: &str) -> Result<Block, InputError> {
        let names = self.start_mm.keys().map(String::as_str).collect::<Vec<_>>();
        let from_mm = |name: &String| self.position_mm.get(name).copied();
        let planned = PlannedArc::of(&arc, from_mm, &names, &format!("{key}.arc"), self.document)?;
        let pace = self.pace(pace, planned.length_mm, key)?;
        for (name, end_mm) in arc.plane.iter().zip(planned.end_mm) {
            self.position_mm[name] = end_mm;
        }
        Ok(Block::Arc { plane: arc.plane, centre_mm: planned.centre_mm, sweep: planned.sweep, pace })
    }

    /// The pace of a block of this length. Adds its duration to that of the motion.
    fn pace(&mut self, own: &BlockPace, length_mm: f64, key: &str) -> Result<Pace, InputError> {
        let pace = self.pace.with(own, key, self.document)?;
        self.duration.add_path(length_mm, &pace);
        self.check_duration(key)?;
        Ok(pace)
    }

    fn check_duration(&self, key: &str) -> Result<(), InputError> {
        if self.duration.is_permitted() {
            return Ok(());
        }
        let what = format!("a total duration of at most {LONGEST_S} s");
        Err(self.document.refuse(key, &what))
    }

    fn unknown_axis(&self, key: &str) -> InputError {
        let names: Vec<&str> = self.start_mm.keys().map(String::as_str).collect();
        unknown_axis(&names, key, self.document)
    }
}
