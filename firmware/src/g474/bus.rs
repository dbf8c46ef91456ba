//! Accesses to the registers of the chip by their addresses: those of the chip itself, or of a model of it on a host.

/// An interrupt that a program raises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Serial port.
    Usart3,
    /// CAN, its first line.
    Fdcan1,
}

/// The bus of the core. All accesses are of whole words at addresses that are multiples of four.
pub trait Bus: Copy {
    /// Reads a word.
    fn read(self, address: u32) -> u32;

    /// Writes a word.
    fn write(self, address: u32, value: u32);

    /// Waits for at least this time, µs.
    fn wait_us(self, us: u32);

    /// Raises an interrupt, from any context.
    fn pend(line: Line);

    /// Sets bits of a register.
    fn set_bits(self, address: u32, bits: u32) {
        self.write(address, self.read(address) | bits);
    }

    /// Clears bits of a register.
    fn clear_bits(self, address: u32, bits: u32) {
        self.write(address, self.read(address) & !bits);
    }

    /// Sets a field of a register, which `mask` covers.
    fn set_field(self, address: u32, mask: u32, value: u32) {
        self.write(address, self.read(address) & !mask | value);
    }

    /// Waits until the bits of a register have a value, for at most `reads` reads. False if they do not.
    fn within_reads(self, reads: u32, address: u32, bits: u32, value: u32) -> bool {
        (0..reads).any(|_| self.read(address) & bits == value)
    }

    /// Waits without a limit until the bits of a register have a value. For the start-up, before the watchdog runs.
    fn wait_for(self, address: u32, bits: u32, value: u32) {
        while self.read(address) & bits != value {}
    }
}
