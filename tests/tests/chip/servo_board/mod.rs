//! The commands for a servo board, on the emulated board: QEMU runs its program with its own ticks.
//!
//! Without `qemu-system-arm` the tests are skipped with a message.

mod anticogging;
mod document;
mod drives;
mod emulated_board;
mod envelope;
mod figures;
mod follow;
mod four_axes;
mod gantry;
mod halts;
mod hard_stop;
mod idle;
mod logs;
mod overrides;
mod ports;
mod probe;
mod raw_link;
mod response;
mod sensors;
mod settings;
mod silence;
mod ticks;
mod vertical;
