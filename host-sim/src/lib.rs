//! Lost Motion: closes the loop against a simulated machine, and traces what a measured log holds
//! and its declared model lacks.

pub mod cli;
pub mod compare;
pub mod controller;
pub mod demo;
mod document;
pub mod effects;
pub mod error;
pub mod friction_map;
pub mod link;
pub mod log;
pub mod machine;
pub mod motion;
pub mod number;
pub mod output;
pub mod path;
pub mod plant;
pub mod report;
pub mod reproduce;
pub mod self_test;
pub mod servo;
pub mod simulate;
pub mod trace;
