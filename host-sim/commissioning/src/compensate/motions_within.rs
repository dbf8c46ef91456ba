//! Motions within the travel of the axes where none are given: a circle, corners, travels and a small part.

use indexmap::IndexMap;

use crate::compensate::mapped;
use crate::compensate::prediction::TestMotion;
use model::axis::KeyNames;
use model::machine::Machine;
use motion::{Block, Motion, Pace, Sweep};

/// Part of the travel that is used: an axis overshoots.
const WITHIN: f64 = 0.9;

/// Largest half of a motion, mm, and largest half of a travel.
const HALF_MM: f64 = 30.0;
const HALF_TRAVEL_MM: f64 = 150.0;

/// Feed, mm/s, and acceleration, m/s².
const FEED_MM_PER_S: f64 = 50.0;
const ACCELERATION_M_PER_S2: f64 = 1.0;

/// A linear axis with the ends of its travel, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Travel {
    /// Name of the axis.
    pub axis: String,
    /// Its ends, mm, in ascending order.
    pub ends_mm: [f64; 2],
}

impl Travel {
    /// The linear axes of a machine: their soft limits, else the travel in which the maps of the model are known, else ±30 mm.
    #[must_use]
    pub fn of(machine: &Machine) -> Vec<Self> {
        let linear = machine.axis.iter().filter(|(_, axis)| axis.settings.names == KeyNames::Linear);
        linear
            .map(|(name, axis)| {
                let maps_mm = || mapped::maps_m(axis).map(|ends| ends.map(|m| 1e3 * m));
                let usual_mm = HALF_MM / WITHIN;
                let ends_mm = axis.settings.limits.travel_mm.or_else(maps_mm);
                Self { axis: name.clone(), ends_mm: ends_mm.unwrap_or([-usual_mm, usual_mm]) }
            })
            .collect()
    }
}

/// The motions of a compensation that is to cover the whole travel: a circle and corners, if there are two axes, and the travel of each.
#[must_use]
pub fn whole_travel(axes: &[Travel], start_s: f64) -> Vec<TestMotion> {
    let whole_mm = |axis: &Travel| 0.5 * (axis.ends_mm[1] - axis.ends_mm[0]);
    all(axes, |plane| vec![plane.circle(), plane.corners()], whole_mm, start_s)
}

/// The motions of an error budget, for the first three axes: with one of them its travel alone.
#[must_use]
pub fn standard(axes: &[Travel]) -> Vec<TestMotion> {
    let half_mm = |axis: &Travel| half(axis).min(HALF_TRAVEL_MM);
    all(axes, |plane| vec![plane.circle(), plane.corners(), plane.part()], half_mm, 0.0)
}

/// Motions in the plane of the first two axes, if there are two, and a travel of each of the first three.
fn all(
    axes: &[Travel],
    in_plane: impl Fn(&Plane) -> Vec<Motion>,
    half_mm: impl Fn(&Travel) -> f64,
    start_s: f64,
) -> Vec<TestMotion> {
    let axes = &axes[..axes.len().min(motion::MAX_AXES)];
    let plane = (axes.len() > 1).then(|| Plane::of(axes));
    let travel = (!axes.is_empty()).then(|| travel(axes, half_mm));
    let motions = plane.iter().flat_map(in_plane).chain(travel);
    motions.map(|motion| TestMotion::of_program(motion, start_s)).collect()
}

const fn pace() -> Pace {
    Pace::with_exact_stop(FEED_MM_PER_S, ACCELERATION_M_PER_S2)
}

fn centre(axis: &Travel) -> f64 {
    0.5 * (axis.ends_mm[0] + axis.ends_mm[1])
}

fn half(axis: &Travel) -> f64 {
    WITHIN * 0.5 * (axis.ends_mm[1] - axis.ends_mm[0])
}

/// A motion that starts after a rest of half a second, which is not evaluated.
fn motion(name: &str, start_mm: IndexMap<String, f64>, blocks: Vec<Block>) -> Motion {
    let rest = Block::Dwell { seconds: 0.5 };
    Motion { name: name.to_owned(), start_mm, blocks: std::iter::once(rest).chain(blocks).collect() }
}

/// Every axis, one after the other, by a half of its travel to either side of its centre.
fn travel(axes: &[Travel], half_mm: impl Fn(&Travel) -> f64) -> Motion {
    let centre_mm: IndexMap<String, f64> =
        axes.iter().map(|axis| (axis.axis.clone(), centre(axis))).collect();
    let mut blocks = Vec::new();
    for axis in axes {
        let half_mm = half_mm(axis);
        for offset_mm in [half_mm, -half_mm, 0.0] {
            let mut to_mm = centre_mm.clone();
            to_mm[&axis.axis] += offset_mm;
            blocks.push(Block::Line { to_mm, pace: pace() });
        }
    }
    motion("travel", centre_mm, blocks)
}

/// The plane of the first two axes.
struct Plane {
    axes: [String; 2],
    centre_mm: [f64; 2],
    half_mm: f64,
}

impl Plane {
    fn of(axes: &[Travel]) -> Self {
        let half_mm = HALF_MM.min(half(&axes[0])).min(half(&axes[1]));
        Self {
            axes: [axes[0].axis.clone(), axes[1].axis.clone()],
            centre_mm: [centre(&axes[0]), centre(&axes[1])],
            half_mm,
        }
    }

    /// A point, from the centre in parts of the half size.
    fn at(&self, [x, y]: [f64; 2]) -> IndexMap<String, f64> {
        let [cx, cy] = self.centre_mm;
        let point = [cx + x * self.half_mm, cy + y * self.half_mm];
        self.axes.iter().cloned().zip(point).collect()
    }

    fn line(&self, to: [f64; 2]) -> Block {
        Block::Line { to_mm: self.at(to), pace: pace() }
    }

    fn arc(&self, centre: [f64; 2], turns: f64) -> Block {
        let centre_mm = self.at(centre);
        let centre_mm = [centre_mm[0], centre_mm[1]];
        Block::Arc { plane: self.axes.clone(), centre_mm, sweep: Sweep::Turns(turns), pace: pace() }
    }

    /// A circle in both directions.
    fn circle(&self) -> Motion {
        let pause = Block::Dwell { seconds: 0.2 };
        let blocks = vec![self.arc([0.0; 2], 1.0), pause.clone(), self.arc([0.0; 2], -1.0), pause];
        motion("circle", self.at([1.0, 0.0]), blocks)
    }

    /// A square about the centre.
    fn corners(&self) -> Motion {
        let to = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|to| self.line(to));
        motion("corners", self.at([1.0, -1.0]), to.to_vec())
    }

    /// A part: a slot with round ends, a slope, and a full circle inside.
    fn part(&self) -> Motion {
        let blocks = vec![
            self.line([0.5, -0.5]),
            self.arc([0.5, 0.0], 0.5),
            self.line([-0.5, 0.5]),
            self.arc([-0.5, 0.0], 0.5),
            self.line([0.8, 0.2]),
            self.line([0.3, 0.0]),
            self.arc([0.0, 0.0], 1.0),
            self.line([-0.5, -0.5]),
        ];
        motion("part", self.at([-0.5, -0.5]), blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motions_stay_within_the_travel_and_move_the_axes() {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let axes = [("x", [10.0, 90.0]), ("y", [-300.0, -20.0])];
        let axes = axes.map(|(axis, ends_mm)| Travel { axis: axis.to_owned(), ends_mm });
        let motions = standard(&axes);
        let names: Vec<&str> = motions.iter().map(|test| test.motion.name.as_str()).collect();
        assert_eq!(names, ["circle", "corners", "part", "travel"]);
        for test in motions {
            let path = test.nominal_path(&machine).unwrap();
            for (index, axis) in axes.iter().enumerate() {
                let [least, greatest] = path.extent_m(index).map(|m| 1e3 * m);
                let [from, to] = axis.ends_mm;
                assert!(least >= from && greatest <= to && greatest - least > 20.0, "{}", test.source);
            }
        }
        assert_eq!(standard(&axes[..1]).len(), 1);
        let whole = whole_travel(&axes[..1], 0.0);
        assert_eq!(whole.len(), 1);
        let [least, greatest] = whole[0].nominal_path(&machine).unwrap().extent_m(0);
        assert!((least - 0.01).abs() < 1e-9 && (greatest - 0.09).abs() < 1e-9, "{least} {greatest}");
    }
}
