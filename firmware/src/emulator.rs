//! The end of a program on the emulator: for all programs but that of the board.

use core::panic::PanicInfo;

use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
#[cfg(feature = "cost")]
use cortex_m_semihosting::hprintln;

/// Ends the emulator, with exit code 0 or 1.
pub fn end(success: bool) -> ! {
    exit(if success { EXIT_SUCCESS } else { EXIT_FAILURE });
    // Reached in a debugger that does not end the program.
    loop {
        cortex_m::asm::wfi();
    }
}

/// A panic ends the emulator with exit code 1. The program `cost` has a console for its message.
#[panic_handler]
#[cfg_attr(not(feature = "cost"), expect(unused_variables, reason = "no console"))]
fn panic(info: &PanicInfo) -> ! {
    #[cfg(feature = "cost")]
    hprintln!("{}", info);
    end(false)
}
