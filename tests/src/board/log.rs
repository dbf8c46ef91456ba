//! What the emulator writes down: exceptions, and accesses to what it does not model.

use std::fs;
use std::path::PathBuf;

/// The file that the emulator appends to.
pub struct Log(pub PathBuf);

/// An access to a device that is not modelled.
#[derive(Debug)]
pub struct Access {
    /// As QEMU names it.
    pub device: String,
    /// Of the register, bytes.
    pub offset: u32,
    /// `None`: a read, which gives 0.
    pub written: Option<u32>,
}

/// Before the number of an exception whose handler is begun.
const BEGUN: &str = "...loading from element ";

/// Between a device and what was done to it.
const UNIMPLEMENTED: &str = ": unimplemented device ";

impl Log {
    /// All so far; what is not text, a line that is being written, is replaced.
    #[must_use]
    pub fn text(&self) -> String {
        fs::read(&self.0).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
    }

    /// The last lines.
    #[must_use]
    pub fn end(&self) -> String {
        let text = self.text();
        let lines: Vec<_> = text.lines().collect();
        lines[lines.len().saturating_sub(12)..].join("\n")
    }

    /// The exceptions that were begun, by their number.
    #[must_use]
    pub fn exceptions(&self) -> Vec<usize> {
        let number = |line: &str| line.strip_prefix(BEGUN)?.split(' ').next()?.parse().ok();
        self.text().lines().filter_map(number).collect()
    }

    /// The accesses to devices that are not modelled, in their order.
    #[must_use]
    pub fn accesses(&self) -> Vec<Access> {
        self.text().lines().filter_map(access).collect()
    }
}

/// What was written to a register.
pub fn written<'a>(accesses: &'a [Access], device: &'a str, offset: u32) -> impl Iterator<Item = u32> + 'a {
    let is = move |access: &&Access| access.device == device && access.offset == offset;
    accesses.iter().filter(is).filter_map(|access| access.written)
}

/// `GPIOB: unimplemented device write (size 4, offset 0x018, value 0x40000000)`
fn access(line: &str) -> Option<Access> {
    let (device, what) = line.split_once(UNIMPLEMENTED)?;
    let after = |name: &str| {
        let text = what.split_once(name)?.1;
        u32::from_str_radix(text.split([',', ')']).next()?, 16).ok()
    };
    Some(Access { device: device.to_owned(), offset: after("offset 0x")?, written: after("value 0x") })
}

#[test]
fn accesses_as_the_emulator_writes_them() {
    let write = access("GPIOB: unimplemented device write (size 4, offset 0x018, value 0x40000000)").unwrap();
    assert_eq!((write.device.as_str(), write.offset, write.written), ("GPIOB", 0x18, Some(0x4000_0000)));
    let read = access("RCC: unimplemented device read  (size 4, offset 0x030)").unwrap();
    assert_eq!((read.device.as_str(), read.offset, read.written), ("RCC", 0x30, None));
    assert!(access("Taking exception 5 [IRQ] on CPU 0").is_none());
}
