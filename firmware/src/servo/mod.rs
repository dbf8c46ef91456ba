//! The environment of the emulated servo board: two serial ports, a flash in a file, the system timer, and the emulator.
//!
//! | port | for |
//! |---|---|
//! | UART0 | the link of a host, as on a real board |
//! | UART1 | the bench: a byte operates a switch of the simulated machine. A real board has hands and wires instead |

mod bench_port;
mod flash;
mod uart;

pub use bench_port::{END, operate};
pub use flash::{FileFlash, settings_memory};
pub use uart::Uart;
