//! The link of a servo board: a server with drives on a simulated plant, and a host that may be slow, silent, wrong or
//! malicious.

mod axes;
mod brakes;
mod can_frames;
mod direction;
mod envelope;
mod excitation;
mod following;
mod gantry;
mod garbage;
mod halts;
mod hard_stop;
mod home;
mod motions;
mod order;
mod overrides;

mod power_loss;
mod probing;
mod recordings;
mod rig;
mod saving;
mod silence;
mod streams;
mod ticks;
mod two_ports;
mod uploads;

use rig::Rig;
use shared::interpolate::Block;
use shared::link::message::{Jog, Reply, Request};

/// A jog of x by a distance at 30 mm/s.
fn jog_by(distance_m: f64) -> Request {
    Request::Jog(Jog {
        axis: 0,
        distance_m: Some(distance_m),
        velocity_m_per_s: 0.03,
        acceleration_m_per_s2: 0.5,
    })
}

/// A jog of x at a speed.
fn jog_at(velocity_m_per_s: f64) -> Request {
    Request::Jog(Jog { axis: 0, distance_m: None, velocity_m_per_s, acceleration_m_per_s2: 0.5 })
}

/// Sends and starts a motion; all of it is accepted.
fn start(rig: &mut Rig, blocks: &[Block<2>]) {
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    for block in blocks {
        assert_eq!(rig.request(&Request::add_block(*block)), Reply::Done);
    }
    let blocks = u16::try_from(blocks.len()).unwrap();
    assert_eq!(rig.request(&Request::StartMotion { blocks }), Reply::Done);
}
