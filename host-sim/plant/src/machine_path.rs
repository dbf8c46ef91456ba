//! A motion file in the axes of a machine: axis names become numbers, mm become m.

use indexmap::IndexMap;
use shared::interpolate::Joint;

use files::error::InputError;
use model::machine::Machine;
use motion::{Block, Direction, Motion, Pace, Sweep};
use motion::{PathBlock, PathShape};

/// The start of a motion and its blocks, as the controller of a machine takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct MachinePath {
    /// Start, one position per axis, m.
    pub start_m: Vec<f64>,
    /// Blocks, in their order.
    pub blocks: Vec<PathBlock>,
}

impl MachinePath {
    /// The path of a motion on a machine. Axes that the motion does not name stay at zero. `source` is the file of the
    /// motion, for messages.
    ///
    /// # Errors
    /// When the motion names an axis that the machine does not have, or that is the second motor of a gantry.
    pub fn new(motion: &Motion, machine: &Machine, source: &str) -> Result<Self, InputError> {
        for name in motion.start_mm.keys() {
            if !machine.axis.contains_key(name) {
                let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
                let expected = format!("axes of the machine ({})", names.join(", "));
                let found = format!("axis {name}");
                return Err(InputError::expected(source, expected, found).at_key("start_mm"));
            }
            let gantry = machine.axis.get(name).map(|axis| &axis.settings.gantry);
            if let Some(first) = gantry.and_then(|gantry| gantry.gantry_with.as_ref()) {
                let expected =
                    format!("axes with a command of their own ({name} is the second motor of {})", first.0);
                let found = format!("axis {name}");
                return Err(InputError::expected(source, expected, found).at_key("start_mm"));
            }
        }
        Ok(Self {
            start_m: axes_m(machine, &motion.start_mm),
            blocks: motion.blocks.iter().map(|block| path_block(machine, block)).collect(),
        })
    }
}

/// One position per axis, m.
fn axes_m(machine: &Machine, named_mm: &IndexMap<String, f64>) -> Vec<f64> {
    machine.axis.keys().map(|name| 1e-3 * named_mm.get(name).copied().unwrap_or(0.0)).collect()
}

fn path_block(machine: &Machine, block: &Block) -> PathBlock {
    match block {
        Block::Dwell { seconds } => PathBlock::dwell(*seconds),
        Block::Line { to_mm, pace } => with_pace(PathShape::Line { to_m: axes_m(machine, to_mm) }, pace),
        Block::Arc { plane, centre_mm, sweep, pace } => {
            let plane = plane.each_ref().map(|name| axis_number(machine, name));
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
            with_pace(shape, pace)
        }
    }
}

fn with_pace(shape: PathShape, pace: &Pace) -> PathBlock {
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

/// The number of an axis. The motion's start names it, so the machine has it.
fn axis_number(machine: &Machine, name: &str) -> u8 {
    machine.axis.get_index_of(name).and_then(|index| u8::try_from(index).ok()).unwrap_or(u8::MAX)
}
