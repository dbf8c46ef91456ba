//! The drives behind RTIC's lock.

use rtic::Mutex;
use shared::link::SharedDrive;
use shared::scalar::Fixed;

use super::Drive;
use crate::setup::AXES;

/// The drives behind a lock, which holds off the ticks.
pub struct Locked<M>(pub M);

impl<M: Mutex<T = Drive>> SharedDrive<'static, Fixed, AXES> for Locked<M> {
    fn with<R>(&mut self, access: impl FnOnce(&mut Drive) -> R) -> R {
        self.0.lock(access)
    }
}
