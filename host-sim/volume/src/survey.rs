//! The survey: a TOML file that says which measurements were taken, and where.
//!
//! ```toml
//! chain = ["y", "x", "z"]              # the axes from the workpiece to the tool
//!
//! [[positioning]]
//! file = "x-front.csv"
//! axis = "x"
//! at_mm = { y = 50.0, z = -100.0 }     # where the other axes were
//!
//! [[circle]]
//! files = ["xy-ccw.csv", "xy-cw.csv"]  # or one file with both directions
//! plane = ["x", "y"]
//! at_mm = { x = 250.0, y = 200.0, z = -100.0 }   # the centre
//! radius_mm = 100.0                    # of a ballbar's table; of a log it is known
//! validate = true                      # takes no part in the fit: judges it
//! ```

use std::path::{Path, PathBuf};

use serde::Deserialize;

use files::document::Document;
use files::error::{InputError, quoted};

use super::component::Axis;

/// Smallest radius and furthest position, mm.
const LEAST_RADIUS_MM: f64 = 1.0;
const FURTHEST_MM: f64 = 1e5;

/// A survey.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// The axes from the workpiece to the tool.
    pub chain: [Axis; 3],
    /// The measurements, in the order of the file within each kind.
    pub measurements: Vec<Measurement>,
}

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Its files, with the folder of the survey.
    pub files: Vec<PathBuf>,
    /// What was measured.
    pub what: What,
    /// Position of x, y and z, mm: of a circle its centre; of a positioning test 0 for the axis itself.
    pub at_mm: [f64; 3],
    /// Whether it judges the fit and takes no part in it.
    pub is_held_out: bool,
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// A positioning test of an axis.
    Positioning(Axis),
    /// A circle of two axes.
    Circle {
        /// The axes: the first one at the angle 0.
        plane: [Axis; 2],
        /// Nominal radius of a ballbar's table, mm.
        radius_mm: Option<f64>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurveyTable {
    chain: [String; 3],
    #[serde(default)]
    positioning: Vec<PositioningTable>,
    #[serde(default)]
    circle: Vec<CircleTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PositioningTable {
    file: PathBuf,
    axis: String,
    at_mm: PlaceTable,
    #[serde(default)]
    validate: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CircleTable {
    files: Vec<PathBuf>,
    plane: [String; 2],
    at_mm: PlaceTable,
    radius_mm: Option<f64>,
    #[serde(default)]
    validate: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceTable {
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
}

impl Survey {
    /// Reads the text of a survey; `source` is its path, in whose folder the files of the measurements are.
    ///
    /// # Errors
    /// The first key that is missing or has another value than expected.
    pub fn parse(text: &str, source: &Path) -> Result<Self, InputError> {
        let name = source.display().to_string();
        let document = Document::parse(text, &name)?;
        let raw: SurveyTable = document.deserialize()?;
        let folder = source.parent().unwrap_or(Path::new(""));
        let chain = [0, 1, 2].map(|index| Axis::of(&raw.chain[index]));
        let chain = match chain {
            [Some(a), Some(b), Some(c)] if a != b && b != c && a != c => [a, b, c],
            _ => {
                return Err(
                    document.refuse("chain", "x, y and z in their order from the workpiece to the tool")
                );
            }
        };
        let mut measurements = Vec::new();
        for (index, table) in raw.positioning.into_iter().enumerate() {
            measurements.push(positioning(table, &format!("positioning[{index}]"), &document, folder)?);
        }
        for (index, table) in raw.circle.into_iter().enumerate() {
            measurements.push(circle(table, &format!("circle[{index}]"), &document, folder)?);
        }
        let mut files: Vec<&PathBuf> =
            measurements.iter().flat_map(|measurement| &measurement.files).collect();
        files.sort();
        if let Some(twice) = files.windows(2).find(|two| two[0] == two[1]) {
            let found = quoted(&twice[0].display().to_string());
            return Err(InputError::expected(&name, "each file once", format!("{found} twice")));
        }
        if measurements.iter().all(|measurement| measurement.is_held_out) {
            let expected = "a [[positioning]] or [[circle]] without validate = true";
            return Err(InputError::expected(&name, expected, "none"));
        }
        Ok(Self { chain, measurements })
    }
}

fn positioning(
    table: PositioningTable,
    key: &str,
    document: &Document<'_>,
    folder: &Path,
) -> Result<Measurement, InputError> {
    let axis = axis(&table.axis, &format!("{key}.axis"), document)?;
    if place(&table.at_mm)[axis as usize].is_some() {
        return Err(document.refuse(&format!("{key}.at_mm.{}", axis.name()), "the other two axes alone"));
    }
    let needed: Vec<Axis> = Axis::ALL.into_iter().filter(|other| *other != axis).collect();
    let at_mm = complete(&table.at_mm, &needed, &format!("{key}.at_mm"), document)?;
    let files = vec![folder.join(table.file)];
    Ok(Measurement { files, what: What::Positioning(axis), at_mm, is_held_out: table.validate })
}

fn circle(
    table: CircleTable,
    key: &str,
    document: &Document<'_>,
    folder: &Path,
) -> Result<Measurement, InputError> {
    let names = [0, 1].map(|index| axis(&table.plane[index], &format!("{key}.plane[{index}]"), document));
    let [first, second] = names;
    let plane = [first?, second?];
    if plane[0] == plane[1] {
        return Err(document.refuse(&format!("{key}.plane"), "two different axes"));
    }
    if table.files.is_empty() || table.files.len() > 2 {
        return Err(document.refuse(&format!("{key}.files"), "one file, or one for each direction"));
    }
    if table.radius_mm.is_some_and(|radius_mm| !(LEAST_RADIUS_MM..=FURTHEST_MM).contains(&radius_mm)) {
        return Err(document.refuse(&format!("{key}.radius_mm"), "1 to 100000"));
    }
    let at_mm = complete(&table.at_mm, &Axis::ALL, &format!("{key}.at_mm"), document)?;
    let files = table.files.into_iter().map(|file| folder.join(file)).collect();
    let what = What::Circle { plane, radius_mm: table.radius_mm };
    Ok(Measurement { files, what, at_mm, is_held_out: table.validate })
}

fn axis(name: &str, key: &str, document: &Document<'_>) -> Result<Axis, InputError> {
    Axis::of(name).ok_or_else(|| document.refuse(key, "x, y or z"))
}

const fn place(table: &PlaceTable) -> [Option<f64>; 3] {
    [table.x, table.y, table.z]
}

fn complete(
    table: &PlaceTable,
    needed: &[Axis],
    key: &str,
    document: &Document<'_>,
) -> Result<[f64; 3], InputError> {
    let place = place(table);
    if let Some(axis) = needed.iter().find(|axis| place[**axis as usize].is_none()) {
        return Err(document.refuse(key, &format!("the position of {}", axis.name())));
    }
    for axis in needed {
        if place[*axis as usize].is_some_and(|mm| mm.abs() > FURTHEST_MM) {
            return Err(document.refuse(&format!("{key}.{}", axis.name()), "-100000 to 100000"));
        }
    }
    Ok(place.map(Option::unwrap_or_default))
}
