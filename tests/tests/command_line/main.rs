//! The command line: exit codes, one-line errors, complete outputs.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod accepted;
mod board_arguments;
mod compare;
mod compensate;
mod improve;
mod margins;
mod refused;
mod reproduce;
mod stopped;
mod tune;
mod verify;
mod work_folder;
mod worked_example;
