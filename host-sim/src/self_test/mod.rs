//! Machines drawn at random and simulated by a second, separate program: is what they lack found?
//!
//! [`plant`], [`servo`] and [`bench`] are that program; [`draw`], [`truth`] and [`motion`] say what it is given;
//! [`case`] is one machine with its logs.

pub mod bench;
pub mod case;
pub mod draw;
pub mod motion;
pub mod plant;
pub mod servo;
pub mod truth;
