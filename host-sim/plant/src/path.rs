//! A motion file made into the blocks of a machine: names become axis numbers, mm become m.

use shared::interpolate::Joint;

use files::error::InputError;
use link::controller::{PathBlock, PathShape};
use model::machine::Machine;
use model::motion::{Block, Direction, Motion, Pace, Sweep};

/// Where a machine starts, and what it does.
#[derive(Clone, Debug, PartialEq)]
pub struct MachinePath {
    /// One an axis, m.
    pub start_m: Vec<f64>,
    /// Blocks in the machine's axes.
    pub blocks: Vec<PathBlock>,
}

/// The path of a motion on a machine. Axes that the motion does not name stand at zero; `source` is
/// the motion's file, for messages.
///
/// # Errors
/// When the motion names an axis that the machine has not.
pub fn of(motion: &Motion, machine: &Machine, source: &str) -> Result<MachinePath, InputError> {
    for name in motion.start_mm.keys() {
        if !machine.axis.contains_key(name) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            let expected = format!("axes of the machine ({})", names.join(", "));
            return Err(InputError::expected(source, expected, format!("axis {name}")).at_key("start_mm"));
        }
    }
    let metres = |at: &indexmap::IndexMap<String, f64>| -> Vec<f64> {
        machine.axis.keys().map(|name| 1e-3 * at.get(name).copied().unwrap_or(0.0)).collect()
    };
    let block = |block: &Block| match block {
        Block::Dwell { seconds } => PathBlock::dwell(*seconds),
        Block::Line { to_mm, pace } => travelled(PathShape::Line { to_m: metres(to_mm) }, pace),
        Block::Arc { plane, centre_mm, sweep, pace } => {
            let plane = plane.each_ref().map(|name| number(machine, name));
            let centre_m = centre_mm.map(|mm| 1e-3 * mm);
            let shape = match *sweep {
                Sweep::Turns(turns) => PathShape::Arc { plane, centre_m, turns },
                Sweep::To { to_mm, direction } => PathShape::ArcTo {
                    plane,
                    centre_m,
                    to_m: to_mm.map(|mm| 1e-3 * mm),
                    positive: direction == Direction::Positive,
                },
            };
            travelled(shape, pace)
        }
    };
    Ok(MachinePath { start_m: metres(&motion.start_mm), blocks: motion.blocks.iter().map(block).collect() })
}

fn travelled(shape: PathShape, pace: &Pace) -> PathBlock {
    PathBlock {
        shape,
        feed_m_per_s: pace.feed_mm_per_min / 60e3,
        acceleration_m_per_s2: pace.acceleration_m_per_s2,
        ramps: pace.ramps,
        joint: match pace.joint_tolerance_um {
            0.0 => Joint::Stop,
            um => Joint::Within { tolerance_m: 1e-6 * um },
        },
    }
}

/// Number of an axis that the motion's start names, and so the machine has.
fn number(machine: &Machine, name: &str) -> u8 {
    machine.axis.get_index_of(name).and_then(|index| u8::try_from(index).ok()).unwrap_or(u8::MAX)
}
