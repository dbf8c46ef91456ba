//! The programs of the chip, for tests that analyse or run them.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::chip::depth::{Declared, SelfCall};
use crate::chip::virtual_calls::VirtualCalls;

/// Address of the program of an STM32F405, which begins with its vector table.
pub const FLASH: u32 = 0x0800_0000;

/// The slots for settings in its flash (`firmware/src/board/flash.rs`).
pub const SETTINGS_SLOTS: [u32; 2] = [FLASH + 0xc_0000, FLASH + 0xe_0000];

/// Exception number of the tick: 16 exceptions of the core precede the interrupts, and TIM2 is interrupt 28.
pub const TICK: usize = 16 + 28;

/// Exception number of the serial port of the link: USART3 is interrupt 39.
pub const SERIAL: usize = 16 + 39;

/// Main RAM of an STM32F405 (data sheet DS8626, memory map): 128 KiB.
pub const RAM: Range<u32> = 0x2000_0000..0x2002_0000;

/// What the programs do beside what their instructions say:
///
/// - `frexp` of a subnormal number calls itself once, with that number times 2⁶⁴, which is normal.
/// - `UsbDevice` calls the methods of its classes as trait objects, and has no other calls through registers. `UsbClass` of
///   usb-device 0.3 has 12 methods.
pub const DECLARED: Declared<'_> = Declared {
    self_calls: &[SelfCall { name: "libm4math5frexp5frexp", frames: 2 }],
    virtual_calls: &[VirtualCalls {
        callers: &["usb_device6device", "usb_port16CdcPort"],
        method: "UsbClass$LT$B$GT$$GT$29get_configuration_descriptors",
        methods: 12,
    }],
};

/// The ELF file of a program, `board` or `emulated` for example, built by the alias of that name.
///
/// # Panics
/// Where cargo cannot build it, with its messages.
#[must_use]
pub fn built(program: &str) -> PathBuf {
    let workspace =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests is a folder of the workspace");
    let cargo = Command::new(env!("CARGO")).arg(program).current_dir(workspace).output();
    let output = cargo.expect("cargo runs, as it has built this test");
    assert!(
        output.status.success(),
        "`cargo {program}` failed (is the target thumbv7em-none-eabihf installed?):\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // A relative path is relative to where cargo ran; an absolute one replaces the workspace in `join`.
    let target = workspace.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or("target".into()));
    // The profile of its alias.
    let profile = if program == "board-g474" { "firmware-small" } else { "firmware" };
    target.join("thumbv7em-none-eabihf").join(profile).join(program)
}
