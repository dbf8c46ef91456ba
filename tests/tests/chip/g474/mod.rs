//! The board with an STM32G474, for which there is neither a chip nor an emulator here: its code on a model of the registers ([`model`]), with the host of
//! the test at its ports.

mod board;
mod can_model;
mod devices;
mod flash;
mod flash_model;
mod model;
mod outputs;
mod ports;
mod program;
mod registers;
mod start;
mod wiring;
