//! The command line as people and scripts meet it: exit codes, one-line errors, whole outputs.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod compare;
mod desk;
mod good;
mod refused;
mod reproduce;
mod stopped;
