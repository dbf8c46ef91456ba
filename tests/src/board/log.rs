//! The emulator's log: exceptions, and accesses to devices that it does not model.

use std::fs;
use std::path::PathBuf;

/// The log file.
pub struct Log(pub PathBuf);

/// An access to a device that is not modelled.
#[derive(Debug)]
pub struct Access {
    /// QEMU's name of the device.
    pub device: String,
    /// Offset of the register, bytes.
    pub offset: u32,
    /// The value; `None`: a read, which gives 0.
    pub written: Option<u32>,
}

/// Text before the number of an exception whose handler begins.
const BEGINS: &str = "...loading from element ";

/// Text between a device and the access.
const UNIMPLEMENTED: &str = ": unimplemented device ";

impl Log {
    /// The text so far. Incomplete UTF-8 of a line that is being written is replaced.
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

    /// The numbers of the exceptions that were taken, in order.
    #[must_use]
    pub fn exceptions(&self) -> Vec<usize> {
        let number = |line: &str| line.strip_prefix(BEGINS)?.split(' ').next()?.parse().ok();
        self.text().lines().filter_map(number).collect()
    }

    /// The accesses to devices that are not modelled, in order.
    #[must_use]
    pub fn accesses(&self) -> Vec<Access> {
        self.text().lines().filter_map(access).collect()
    }
}

/// The values that were written to a register, in order.
pub fn written<'a>(accesses: &'a [Access], device: &'a str, offset: u32) -> impl Iterator<Item = u32> + 'a {
    let is = move |access: &&Access| access.device == device && access.offset == offset;
    accesses.iter().filter(is).filter_map(|access| access.written)
}

/// The periods of the watchdog by its writes, ms: (RLR + 1)·4·2^PR periods of its clock of 32 kHz, nominally (21.4.2, 21.4.3). Each has a
/// register of prescaler and of reload.
pub fn watchdog_periods_ms(accesses: &[Access], expected: &[f64]) {
    // QEMU maps another device without registers over it: either name may be logged.
    let register = |offset| -> Vec<u32> {
        written(accesses, "IWDG", offset).chain(written(accesses, "I2S2ext", offset)).collect()
    };
    let (prescalers, reloads) = (register(0x04), register(0x08));
    assert_eq!(prescalers.len(), reloads.len());
    let period = |(prescaler, reload): (&u32, &u32)| f64::from(reload + 1) * f64::from(4 << prescaler) / 32.0;
    let mut periods: Vec<f64> = prescalers.iter().zip(&reloads).map(period).collect();
    // The same period may be set again.
    periods.dedup_by_key(|period| period.to_bits());
    assert_eq!(periods.len(), expected.len(), "{periods:?} ms");
    for (found, expected) in periods.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 0.03, "{periods:?} ms");
    }
}

/// `GPIOB: unimplemented device write (size 4, offset 0x018, value 0x40000000)`
fn access(line: &str) -> Option<Access> {
    let (device, details) = line.split_once(UNIMPLEMENTED)?;
    let after = |name: &str| {
        let text = details.split_once(name)?.1;
        u32::from_str_radix(text.split([',', ')']).next()?, 16).ok()
    };
    Some(Access { device: device.to_owned(), offset: after("offset 0x")?, written: after("value 0x") })
}

#[test]
fn accesses_in_the_format_of_the_emulator() {
    let write = access("GPIOB: unimplemented device write (size 4, offset 0x018, value 0x40000000)").unwrap();
    assert_eq!((write.device.as_str(), write.offset, write.written), ("GPIOB", 0x18, Some(0x4000_0000)));
    let read = access("RCC: unimplemented device read  (size 4, offset 0x030)").unwrap();
    assert_eq!((read.device.as_str(), read.offset, read.written), ("RCC", 0x30, None));
    assert!(access("Taking exception 5 [IRQ] on CPU 0").is_none());
}
