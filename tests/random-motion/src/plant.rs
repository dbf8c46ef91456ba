//! Two masses with friction, and sensors that fail at random.

use shared::lockstep::protocol::AXES;
use shared::machine::Reading;
use shared::units::Position;

use super::draws::Draws;

/// Rate of the ticks, Hz.
const TICK_HZ: f64 = 20_000.0;

/// Mass and viscous friction of an axis.
const MASS_KG: f64 = 40.0;
const VISCOUS_N_S_PER_M: f64 = 500.0;

/// An axis.
#[derive(Clone, Copy, Default)]
struct Axis {
    at_m: f64,
    velocity: f64,
    /// The position that its encoder reads.
    read_m: f64,
    /// A force from outside, N, and the ticks for which it acts.
    pushed: (f64, usize),
    /// Ticks for which the scale has no signal, and for which the encoder stands.
    dropped: usize,
    frozen: usize,
}

/// The axes.
pub struct Plant([Axis; AXES]);

impl Plant {
    pub fn new() -> Self {
        Self([Axis::default(); AXES])
    }

    /// What happens to the axes before a tick.
    pub fn disturb(&mut self, draws: &mut Draws) {
        for axis in &mut self.0 {
            if axis.pushed.1 == 0 && draws.one_in(400) {
                axis.pushed = (draws.between(-4000.0, 4000.0), 1 + draws.below(200));
            }
            if axis.dropped == 0 && draws.one_in(250) {
                axis.dropped = 1 + draws.below(80);
            }
            if axis.frozen == 0 && draws.one_in(1500) {
                axis.frozen = 1 + draws.below(400);
            }
            if axis.frozen == 0 {
                axis.read_m = axis.at_m;
                if draws.one_in(4000) {
                    // A jump of the reading, for this tick.
                    axis.read_m += draws.between(-2e-3, 2e-3);
                }
            }
        }
    }

    pub fn readings(&self) -> [Reading; AXES] {
        // The scale has an error of the screw of 2 µm in 4 mm: a triangle.
        let error_m = |m: f64| 2e-6 * (2.0 * (m / 4e-3 - (m / 4e-3).floor()) - 1.0).abs();
        self.0.map(|axis| Reading {
            motor: Position::from_m(axis.read_m).unwrap(),
            table: (axis.dropped == 0).then(|| Position::from_m(axis.at_m + error_m(axis.at_m)).unwrap()),
        })
    }

    pub fn is_without_scale(&self) -> bool {
        self.0.iter().any(|axis| axis.dropped > 0)
    }

    pub fn step(&mut self, forces_n: [f64; AXES]) {
        for (axis, force) in self.0.iter_mut().zip(forces_n) {
            let outside = if axis.pushed.1 > 0 { axis.pushed.0 } else { 0.0 };
            axis.velocity += (force + outside - VISCOUS_N_S_PER_M * axis.velocity) / MASS_KG / TICK_HZ;
            // Stops at the ends of the travel.
            axis.at_m = (axis.at_m + axis.velocity / TICK_HZ).clamp(-1.0, 1.0);
            for left in [&mut axis.pushed.1, &mut axis.dropped, &mut axis.frozen] {
                *left = left.saturating_sub(1);
            }
        }
    }
}
