//! The programs of the chip: their instructions, stack and registers, and runs on an emulated core or board.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod board_axes;
mod board_boot;
mod cost;
mod fault_table;
mod flash_model;
mod g474;
mod panic_free;
mod processor_in_the_loop;
mod random_motions;
mod record;
mod registers;
mod servo_board;
mod setup_values;
mod stack_depth;
mod stored_records;
mod two_drives;
