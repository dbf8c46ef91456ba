//! What tells the STM32F405 board from others with the same machine: its name and its clock. A host builds it, too.

use shared::link::report::Identity;

use crate::setup::{self, AXES};

/// Clock of the core, Hz: its cycles time the ticks.
pub const CORE_HZ: u32 = 168_000_000;

/// What the board says about itself.
pub const IDENTITY: Identity<AXES> = setup::identity("STM32F405, two drives");
