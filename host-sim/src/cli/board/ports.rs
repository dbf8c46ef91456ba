//! `lost-motion board ports`.

use anyhow::Result;

use crate::cli::outputs::print;

/// Lists the serial ports of this computer, with vendor and product of those at USB, and the emulated board.
///
/// # Errors
/// Output that cannot be written.
pub fn run() -> Result<()> {
    print(&board::open::describe().join("\n"))
}
