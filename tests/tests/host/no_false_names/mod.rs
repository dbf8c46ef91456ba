//! Traces that once reported an effect that the machine does not have: none of these names is reported, and what is
//! reported instead has the true values.
//!
//! The logs are those of the second simulator ([`machine`]), except where a test says so. `docs/testing.md` lists each case
//! with the test that contains it.

mod broken_data;
mod coarse_encoders;
mod controller;
mod declared_values;

mod displaced_sensors;
mod gear;
mod guide;
mod hidden;
mod intervals;
mod load;
mod local_defects;
mod machine;
mod measuring_chain;
mod missing_knowledge;
mod noisy_scale;
mod nothing_to_find;
mod probe_and_scale;
mod reported;
mod resonance;
mod screw;
mod slices;
mod temperature;
mod wave_periods;
