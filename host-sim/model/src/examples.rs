//! Machine and motion files of `host-sim/machines` and `host-sim/motions` that are compiled into programs and tests.

/// Two axes with a linear scale and a tool sensor: the machine of `demo`.
pub const DEMO_MACHINE: &str = include_str!("../../machines/demo.toml");

/// A vertical machining centre.
pub const VMC_MACHINE: &str = include_str!("../../machines/vmc.toml");

/// A machine as rigid bodies on elastic joints.
pub const BODIES_MACHINE: &str = include_str!("../../machines/bodies.toml");

/// A circle on the machine of `demo`.
pub const DEMO_CIRCLE: &str = include_str!("../../motions/demo_circle.toml");

/// Circles in both directions, for validation, on the machine of `demo`.
pub const DEMO_BALLBAR: &str = include_str!("../../motions/demo_ballbar.toml");

/// A circle of the vertical machining centre.
pub const VMC_CIRCLE: &str = include_str!("../../motions/circle.toml");
