//! The link of the board: the drives behind RTIC's lock, and the memory for recordings.

use rtic::Mutex;
use shared::link::{HostedDrive, SharedDrive};
use shared::scalar::Fixed;

use crate::setup::AXES;

/// The core-coupled memory, which only the processor can access: 64 KiB (RM0090, 2.3.1). The program is linked without it.
const CORE_COUPLED: usize = 0x1000_0000;
const CORE_COUPLED_BYTES: usize = 64 * 1024;

/// The memory for a recording. It is not accessed before one is made.
///
/// # Safety
/// To be called once.
#[must_use]
pub unsafe fn capture_memory() -> &'static mut [u8] {
    // SAFETY: RAM of the chip outside of what the linker uses, with some content; by the condition of this function there is no
    // other reference to it.
    unsafe {
        core::slice::from_raw_parts_mut(
            core::ptr::with_exposed_provenance_mut(CORE_COUPLED),
            CORE_COUPLED_BYTES,
        )
    }
}

/// The drives under the control of a host.
pub type Drive = HostedDrive<'static, Fixed, AXES>;

/// The drives behind a lock, which holds off the ticks.
pub struct Locked<M>(pub M);

impl<M: Mutex<T = Drive>> SharedDrive<'static, Fixed> for Locked<M> {
    fn with<R>(&mut self, access: impl FnOnce(&mut Drive) -> R) -> R {
        self.0.lock(access)
    }
}
