//! The end of an arc, given by turns or by an end point.

use std::f64::consts::TAU;

use indexmap::IndexMap;
use shared::interpolate::arc::END_TOLERANCE_NM;

use super::block::{Direction, Sweep};
use super::bounds::{SHORTEST_MM, unknown_axis, within_travel};
use super::tables::ArcTable;
use files::document::Document;
use files::error::InputError;

/// A checked arc; pairs are in the order of the plane.
#[derive(Debug)]
pub(super) struct PlannedArc {
    pub centre_mm: [f64; 2],
    pub sweep: Sweep,
    pub end_mm: [f64; 2],
    pub length_mm: f64,
}

impl PlannedArc {
    /// Checks an arc of a motion with the axes `names`, whose current positions are `from_mm`.
    pub fn of(
        arc: &ArcTable,
        from_mm: impl Fn(&String) -> Option<f64>,
        names: &[&str],
        key: &str,
        document: &Document<'_>,
    ) -> Result<Self, InputError> {
        let reader = Reader { arc, key, document };
        let [first, second] = &arc.plane;
        let position = |index: usize, name| {
            from_mm(name).ok_or_else(|| unknown_axis(names, &format!("{key}.plane[{index}]"), document))
        };
        let from_mm = [position(0, first)?, position(1, second)?];
        if first == second {
            return Err(reader.refuse("plane[1]", "another axis than the first"));
        }
        let centre_mm = reader.pair("centre_mm", &arc.centre_mm)?;
        let radius = [from_mm[0] - centre_mm[0], from_mm[1] - centre_mm[1]];
        let radius_mm = libm::hypot(radius[0], radius[1]);
        if radius_mm < SHORTEST_MM {
            return Err(reader.refuse("centre_mm", "a centre other than the current position"));
        }
        // Conservative: the full circle is checked, not only the arc.
        for centre_mm in centre_mm {
            within_travel(centre_mm.abs() + radius_mm, &format!("{key}.centre_mm"), document)?;
        }
        let sweep = reader.sweep()?;
        let (turns, end_mm) = match sweep {
            Sweep::Turns(turns) => (turns, turned(radius, centre_mm, turns)),
            Sweep::To { to_mm, direction } => (reader.turns_to(to_mm, direction, radius, centre_mm)?, to_mm),
        };
        Ok(Self { centre_mm, sweep, end_mm, length_mm: TAU * radius_mm * turns.abs() })
    }
}

/// An arc with its key in the document.
struct Reader<'a> {
    arc: &'a ArcTable,
    key: &'a str,
    document: &'a Document<'a>,
}

impl Reader<'_> {
    fn refuse(&self, name: &str, what: &str) -> InputError {
        self.document.refuse(&format!("{}.{name}", self.key), what)
    }

    /// A point in the order of the plane.
    fn pair(&self, key: &str, named_mm: &IndexMap<String, f64>) -> Result<[f64; 2], InputError> {
        let [first, second] = &self.arc.plane;
        if let Some(name) = named_mm.keys().find(|name| !self.arc.plane.contains(name)) {
            let what = format!("only the axes of the plane ({first}, {second})");
            return Err(self.refuse(&format!("{key}.{name}"), &what));
        }
        let coordinate = |name: &String| {
            let given = named_mm.get(name).copied();
            given.ok_or_else(|| self.refuse(&format!("{key}.{name}"), "this key"))
        };
        Ok([coordinate(first)?, coordinate(second)?])
    }

    fn sweep(&self) -> Result<Sweep, InputError> {
        let arc = self.arc;
        match (arc.turns, &arc.to_mm, arc.direction) {
            (Some(0.0), None, None) => Err(self.refuse("turns", "a number other than 0")),
            (Some(turns), None, None) => Ok(Sweep::Turns(turns)),
            (None, Some(to_mm), Some(direction)) => {
                Ok(Sweep::To { to_mm: self.pair("to_mm", to_mm)?, direction })
            }
            (None, Some(_), None) => Err(self.refuse("direction", "a value beside to_mm")),
            (None, None, Some(_)) => Err(self.refuse("to_mm", "a value beside direction")),
            _ => Err(self.document.refuse(self.key, "either turns, or to_mm with direction")),
        }
    }

    /// Signed turns to an end point, which must be on the circle and differ from the start. `radius` is the vector from the
    /// centre to the start.
    fn turns_to(
        &self,
        to_mm: [f64; 2],
        direction: Direction,
        radius: [f64; 2],
        centre_mm: [f64; 2],
    ) -> Result<f64, InputError> {
        let to = [to_mm[0] - centre_mm[0], to_mm[1] - centre_mm[1]];
        if libm::hypot(to[0] - radius[0], to[1] - radius[1]) < SHORTEST_MM {
            let what = "a point other than the current position: a full circle is given by turns";
            return Err(self.refuse("to_mm", what));
        }
        let radius_mm = libm::hypot(radius[0], radius[1]);
        let distance_mm = (libm::hypot(to[0], to[1]) - radius_mm).abs();
        let tolerance_mm = 1e-6 * END_TOLERANCE_NM as f64;
        if distance_mm > tolerance_mm {
            let what = format!(
                "a point within {tolerance_mm} mm of the circle of radius {radius_mm:.6} mm: its distance is \
                 {distance_mm:.6} mm"
            );
            return Err(self.refuse("to_mm", &what));
        }
        let turn = (libm::atan2(to[1], to[0]) - libm::atan2(radius[1], radius[0])) / TAU;
        let forward = if turn > 0.0 { turn } else { turn + 1.0 };
        Ok(match direction {
            Direction::Positive => forward,
            Direction::Negative => forward - 1.0,
        })
    }
}

/// The end point of an arc given by turns. `fract` makes it exactly the start after whole turns.
fn turned([x, y]: [f64; 2], centre_mm: [f64; 2], turns: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(TAU * turns.fract());
    [centre_mm[0] + x * cos - y * sin, centre_mm[1] + x * sin + y * cos]
}
