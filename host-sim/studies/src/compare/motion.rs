//! The motions that are run in every pipeline.

use std::f64::consts::TAU;

use shared::units::Position;

use super::point::{AXES, Point};
use motion::{PathBlock, PathShape};

/// Radius of all circles, m.
pub const RADIUS_M: f64 = 0.1;

/// Feed of circles and corner, m/s: 10 m/min.
pub const FEED_M_PER_S: f64 = 10.0 / 60.0;

const ACCELERATION_M_PER_S2: f64 = 1.0;

/// Most turns of one arc that the path accepts.
const MAX_TURNS: u32 = 1000;

/// One of the motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Two turns of a circle, radius 100 mm, 10 m/min.
    Circle,
    /// Two lines with a stop at the corner of 90 degrees, and back, 10 m/min.
    Corner,
    /// Ten steps of 1 µm up and ten down, 1 m from the origin.
    Steps,
    /// 10 µm out and back at 1 µm/s, 1 m from the origin.
    Creep,
    /// Circles for a day.
    LongRun,
}

impl Motion {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Circle, Self::Corner, Self::Steps, Self::Creep, Self::LongRun];

    /// Name in the results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Circle => "circle",
            Self::Corner => "corner",
            Self::Steps => "steps",
            Self::Creep => "creep",
            Self::LongRun => "long_run",
        }
    }

    /// Start of the axes, m.
    #[must_use]
    pub const fn start_m(self) -> [f64; AXES] {
        match self {
            Self::Circle | Self::LongRun => [RADIUS_M, 0.0],
            Self::Corner => [0.0, 0.0],
            Self::Steps | Self::Creep => [1.0, 1.0],
        }
    }

    /// Start of the axes.
    #[must_use]
    pub fn start(self) -> Point {
        self.start_m().map(|m| Position::from_m(m).unwrap_or_default())
    }

    /// The blocks on which the loop is closed; for the long run, the first and the last `turns` turns.
    #[must_use]
    pub fn blocks(self, turns: u32) -> Vec<PathBlock> {
        match self {
            Self::Circle => vec![PathBlock::dwell(0.1), circles(2), PathBlock::dwell(0.3)],
            Self::Corner => vec![
                PathBlock::dwell(0.1),
                line([0.04, 0.0], FEED_M_PER_S),
                line([0.04, 0.04], FEED_M_PER_S),
                line([0.04, 0.0], FEED_M_PER_S),
                line([0.0, 0.0], FEED_M_PER_S),
                PathBlock::dwell(0.3),
            ],
            Self::Steps => {
                let ends = (1..=10).chain((0..10).rev());
                let steps = ends.flat_map(|um| {
                    let x = 1.0 + 1e-6 * f64::from(um);
                    // 1 mm/s and 1 m/s²: the step itself takes 2 ms.
                    [PathBlock::dwell(0.15), line([x, 1.0], 1e-3)]
                });
                steps.chain([PathBlock::dwell(0.3)]).collect()
            }
            Self::Creep => {
                vec![
                    PathBlock::dwell(0.1),
                    line([1.0 + 10e-6, 1.0], 1e-6),
                    line([1.0, 1.0], 1e-6),
                    PathBlock::dwell(0.3),
                ]
            }
            // The machine comes to rest within the second between them.
            Self::LongRun => vec![
                PathBlock::dwell(0.1),
                circles(turns),
                PathBlock::dwell(1.0),
                circles(turns),
                PathBlock::dwell(0.3),
            ],
        }
    }
}

/// Turns of the circle in a number of hours, at least two.
#[must_use]
pub fn turns_in(hours: f64) -> u32 {
    let turns = hours * 3600.0 * FEED_M_PER_S / (TAU * RADIUS_M);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates; callers check the hours"
    )]
    let whole = turns.round() as u32;
    whole.max(2)
}

/// A number of turns as blocks that the path accepts: 1000 turns each, and the remainder.
pub fn circle_blocks(turns: u32) -> impl Iterator<Item = PathBlock> {
    let whole = std::iter::repeat_n(MAX_TURNS, (turns / MAX_TURNS) as usize);
    whole.chain([turns % MAX_TURNS]).filter(|&turns| turns > 0).map(circles)
}

fn circles(turns: u32) -> PathBlock {
    let shape = PathShape::Arc { plane: [0, 1], centre_m: [0.0, 0.0], turns: f64::from(turns) };
    PathBlock::new(shape, FEED_M_PER_S, ACCELERATION_M_PER_S2)
}

fn line(to_m: [f64; AXES], feed_m_per_s: f64) -> PathBlock {
    PathBlock::new(PathShape::Line { to_m: to_m.to_vec() }, feed_m_per_s, ACCELERATION_M_PER_S2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_of_circles_is_complete() {
        // 86,400 s · (1/6 m/s) / (2π · 0.1 m) = 22,918.3 turns.
        assert_eq!(turns_in(24.0), 22_918);
        let turns = |block: PathBlock| match block.shape {
            PathShape::Arc { turns, .. } => turns,
            other => panic!("{other:?}"),
        };
        let blocks: Vec<f64> = circle_blocks(22_918).map(turns).collect();
        assert!((blocks.iter().sum::<f64>() - 22_918.0).abs() < f64::EPSILON);
        assert!(blocks.iter().all(|&turns| (1.0..=1000.0).contains(&turns)));
        assert_eq!(circle_blocks(2000).count(), 2);
    }
}
