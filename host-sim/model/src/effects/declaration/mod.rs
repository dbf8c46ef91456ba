//! The types that declare an effect.

mod abscissa;
mod catalogue;
mod context;
mod coordinate;
mod delay;
mod draw;
mod effect_model;
mod entry;
mod found;
pub mod harmonic;
mod identity;
mod imitation;
pub mod knots;
mod parameter;
mod relative_deviation;
mod residual_shape;
mod slope;
mod stage;
mod unit;
mod wording;

pub use abscissa::Abscissa;
pub(super) use catalogue::catalogue;
pub use context::{EffectContext, Misplaced, Neighbours, Placement, Prerequisite};
pub use coordinate::Coordinate;
pub(super) use delay::delay;
pub use draw::Draw;
pub use effect_model::EffectModel;
pub use entry::EntryValue;
pub use found::{Found, Substitute};
pub use harmonic::PeriodicError;
pub(super) use harmonic::harmonic_effect;
pub use identity::{Distinction, Occurrence};
pub use imitation::{Imitation, ImitationContext};
pub use knots::KeptPart;
pub use parameter::Parameter;
pub(super) use relative_deviation::relative_deviation;
pub use residual_shape::{ResidualShape, ResidualWave, WaveOf};
pub use slope::LEAST_SLOPE_UM_PER_M;
pub(super) use slope::slope;
pub use stage::{Channel, Stage};
pub use unit::Unit;
pub use wording::Wording;

pub(super) use crate::range::Range;
