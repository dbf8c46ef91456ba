//! The link of the board: the drives behind RTIC's lock, and the serial port as the port of the server.

use core::mem::MaybeUninit;

use rtic::Mutex;
use shared::link::{BytePort, HostedDrive, SharedDrive};
use shared::scalar::Fixed;

use super::uart::Uart;
use crate::setup::AXES;

/// Memory for a recording: the core-coupled memory, which only the processor can access and nothing else uses.
const CAPTURE_BYTES: usize = 64 * 1024;

#[unsafe(link_section = ".ccm")]
static mut CAPTURE: MaybeUninit<[u8; CAPTURE_BYTES]> = MaybeUninit::uninit();

/// The memory for a recording, filled with zeros.
///
/// # Safety
/// To be called once.
pub unsafe fn capture_memory() -> &'static mut [u8] {
    let start = (&raw mut CAPTURE).cast::<u8>();
    // SAFETY: the memory of a static; by the condition of this function there is no other reference to it. Zeros are bytes.
    unsafe {
        start.write_bytes(0, CAPTURE_BYTES);
        core::slice::from_raw_parts_mut(start, CAPTURE_BYTES)
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

impl BytePort for Uart {
    fn read(&mut self) -> Option<u8> {
        Self::read(self)
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        Self::write(self, bytes)
    }
}
