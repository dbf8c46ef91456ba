//! The core-coupled memory with the recordings and the USB port.

use core::mem::MaybeUninit;

use super::usb;

/// The core-coupled memory, which only the processor can access: 64 KiB (RM0090, 2.3.1). The program is linked without it.
const CORE_COUPLED: usize = 0x1000_0000;
const CORE_COUPLED_BYTES: usize = 64 * 1024;

/// The end of it is for the USB port, the rest for a recording.
const USB_BYTES: usize = 3 * 1024;
const CAPTURE_BYTES: usize = CORE_COUPLED_BYTES - USB_BYTES;
const _: () = assert!(size_of::<usb::Memory>() <= USB_BYTES && align_of::<usb::Memory>() <= 8);

/// The memory for a recording, which is not accessed before one is made, and that for the USB port.
///
/// # Safety
/// To be called once.
#[must_use]
pub unsafe fn core_coupled_memory() -> (&'static mut [u8], &'static mut MaybeUninit<usb::Memory>) {
    let capture = core::ptr::with_exposed_provenance_mut(CORE_COUPLED);
    let usb = core::ptr::with_exposed_provenance_mut(CORE_COUPLED + CAPTURE_BYTES);
    // SAFETY: RAM of the chip outside of what the linker uses, with some content, in two parts; by the condition of this function
    // there is no other reference to it. The second part is aligned to 1024 bytes.
    unsafe { (core::slice::from_raw_parts_mut(capture, CAPTURE_BYTES), &mut *usb) }
}
