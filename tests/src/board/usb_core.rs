//! A model of a USB core that answers but does not end its reset: what is broken in it is not known before it is used.
//!
//! Addresses and bits are those of the reference manual RM0090, 34.16.2.

use super::device::Device;

/// Product number: that of the STM32F405.
const CID: u32 = 0x5000_003c;
const STM32F405: u32 = 0x1100;

/// Reset register.
const GRSTCTL: u32 = 0x5000_0010;

/// The bus side is idle.
const AHBIDL: u32 = 1 << 31;
/// Reset of the core: set by the program, cleared by the core.
const CSRST: u32 = 1;

/// The registers.
#[derive(Default)]
pub struct StuckUsbCore {
    reset: u32,
    /// Reads of the reset register.
    pub reads: u32,
}

impl Device for StuckUsbCore {
    fn registers(&self) -> &[u32] {
        &[CID, GRSTCTL]
    }

    fn read(&mut self, address: u32) -> u32 {
        match address {
            CID => STM32F405,
            GRSTCTL => {
                self.reads += 1;
                AHBIDL | self.reset
            }
            _ => panic!("{address:#x} is not watched"),
        }
    }

    fn write(&mut self, address: u32, value: u32) {
        assert_eq!(address, GRSTCTL, "{value:#x}");
        self.reset |= value & CSRST;
    }
}
