//! How fast the axes are in a block, and the greatest feed override that it permits.

use super::super::message::BoardSettings;
use crate::interpolate::Block;
use crate::interpolate::block::Shape;
use crate::interpolate::feed_hold::MOST_PERCENT;
use crate::units::Position;

/// Greatest speed of a block over the speed at which a reading becomes a fault.
pub(super) const SPEED_SHARE: f64 = 0.9;

/// The greatest override of a block that starts at a position, 100 to 200 %.
///
/// At r times its speed no axis is faster than a motion may be, and the accelerations of the block, which are r² times the planned ones, are
/// at most the declared deceleration of a stop. A block that is planned with more than that is not accelerated further.
pub(super) fn most_percent<const N: usize>(
    block: &Block<N>,
    start: [Position; N],
    settings: &BoardSettings<N>,
) -> u8 {
    let mut rate = f64::from(MOST_PERCENT) / 100.0;
    for (axis, speed) in settings.axes.iter().zip(axis_speeds(block, start)) {
        let acceleration = axis.stop_deceleration_m_per_s2 / block.acceleration_m_per_s2;
        rate = rate.min(libm::sqrt(acceleration));
        if let Some(fastest) = axis.fastest_m_per_s.filter(|_| speed > 0.0) {
            rate = rate.min(SPEED_SHARE * fastest / speed);
        }
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 2")]
    let percent = (100.0 * rate.max(1.0)) as u8;
    percent
}

/// The greatest speed of each axis in a block that starts at a position, m/s.
pub(super) fn axis_speeds<const N: usize>(block: &Block<N>, start: [Position; N]) -> [f64; N] {
    let mut speeds = [0.0; N];
    match block.shape {
        Shape::Dwell { .. } => {}
        Shape::Line { to_m } => {
            let mut way = to_m;
            for (way, start) in way.iter_mut().zip(start) {
                *way -= start.to_m();
            }
            let length = libm::sqrt(way.iter().map(|way| way * way).sum());
            if length > 0.0 {
                speeds = way.map(|way| libm::fabs(way) / length * block.feed_m_per_s);
            }
        }
        Shape::Arc { plane, .. } | Shape::ArcTo { plane, .. } => {
            for axis in plane {
                if let Some(speed) = speeds.get_mut(usize::from(axis)) {
                    *speed = block.feed_m_per_s;
                }
            }
        }
    }
    speeds
}
