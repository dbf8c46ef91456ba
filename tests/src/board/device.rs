//! Devices that a test models instead of QEMU.

/// A device that the test models instead of QEMU.
pub trait Device {
    /// Addresses of its registers.
    fn registers(&self) -> &[u32];
    /// Value of a load.
    fn read(&mut self, address: u32) -> u32;
    /// Effect of a store.
    fn write(&mut self, address: u32, value: u32);
}
