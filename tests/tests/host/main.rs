//! Requirements across crates that need no program of the chip.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod added_force;
mod app_in_browser;
mod blind_cases;
mod board_setup;
mod budget;
mod command_line;
mod compensation;
mod corrupted;
mod data_faults;
mod demo_seeds;
mod documented_commands;
mod documents;
mod drag;
mod drives;
mod effect_table;
mod effects;
mod effects_own;
mod empirical;
mod example_machines;
mod hum;
mod incomplete_logs;
mod init;
mod laws;
mod measured_data;
mod model_again;
mod module_circles;
mod no_false_names;
mod pages_in_browser;
#[path = "../../../shared/tests/slide.rs"]
mod slide;
mod trace_schema;
mod traces;
mod usb_port;
