//! Which compensations need a homed axis: those that depend on an absolute position.
//!
//! | compensation | needs the position of |
//! |---|---|
//! | pitch, screw, dividing, ripple | its own axis: the error is that of one place of screw, scale or motor |
//! | in-talk, cross-talk with a table over the position | its own axis |
//! | force and stretch with a load or a friction map over the position | its own axis |
//! | squareness, straightness | the other axis |
//! | products | each axis whose position is a factor |
//! | backlash, reversal, drift; in-talk, cross-talk and force with constants | none: motion or time alone |
//!
//! # Example
//!
//! ```
//! use shared::compensate::settings::Cycle;
//! use shared::compensate::{CompensationKind, CompensationSettings, Dependence};
//!
//! let screw = [Cycle::harmonic(2e-6, 0.005, 0.0)].into_iter().collect();
//! let settings =
//!     CompensationSettings { screw, backlash_width_m: Some(5e-6), ..CompensationSettings::default() };
//! let dependence = Dependence::of(1, &settings);
//! assert_eq!(dependence.on(CompensationKind::Screw), 0b10);
//! assert_eq!(dependence.on(CompensationKind::Backlash), 0);
//! ```

use super::kind::CompensationKind;
use super::settings::{CompensationSettings, Factor, Talk};

/// The axes whose absolute positions the compensations of one axis depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dependence {
    axis: u8,
    /// One bit for each kind that depends on the position of its own axis.
    own: u16,
    squareness: Option<u8>,
    straightness: Option<u8>,
    /// One bit for each axis whose position is a factor of a product.
    products: u8,
}

impl Dependence {
    /// No compensation.
    pub const NONE: Self = Self { axis: 0, own: 0, squareness: None, straightness: None, products: 0 };

    /// Of the settings of an axis.
    #[must_use]
    pub fn of(axis: u8, settings: &CompensationSettings) -> Self {
        let over_position = |talk: Option<&Talk>| matches!(talk, Some(Talk::Over(_)));
        let force = settings.force.as_ref();
        let force = force.is_some_and(|model| model.load.is_some() || model.friction.map.is_some());
        let own = [
            (CompensationKind::Pitch, settings.pitch.is_some()),
            (CompensationKind::Screw, !settings.screw.is_empty()),
            (CompensationKind::Dividing, !settings.dividing.is_empty()),
            (CompensationKind::Ripple, !settings.ripple.is_empty()),
            (CompensationKind::Intalk, over_position(settings.intalk.as_ref())),
            (CompensationKind::Crosstalk, over_position(settings.crosstalk.as_ref().map(|(_, talk)| talk))),
            (CompensationKind::Force, force),
            (CompensationKind::Stretch, force && settings.stretch_m_per_n.is_some()),
        ];
        let bits = own.into_iter().map(|(kind, depends)| u16::from(depends) << kind as u8);
        Self {
            axis,
            own: bits.fold(0, |all, bit| all | bit),
            squareness: settings.squareness.map(|(other, _)| other),
            straightness: settings.straightness.as_ref().map(|(other, _)| *other),
            products: settings.products.iter().flat_map(|product| &product.factors).fold(0, with_position),
        }
    }

    /// The axes that have to be homed before a compensation is applied: one bit for each, the lowest for axis 0.
    #[must_use]
    pub fn on(&self, kind: CompensationKind) -> u8 {
        match kind {
            CompensationKind::Squareness => self.squareness.map_or(0, bit),
            CompensationKind::Straightness => self.straightness.map_or(0, bit),
            CompensationKind::Products => self.products,
            _ if self.own & 1 << kind as u8 != 0 => bit(self.axis),
            _ => 0,
        }
    }
}

/// The bit of an axis; the settings of one beyond the eighth are refused.
fn bit(axis: u8) -> u8 {
    1u8.checked_shl(u32::from(axis)).unwrap_or(0)
}

/// Axes, with that of a factor if it is a position.
fn with_position(axes: u8, factor: &Factor) -> u8 {
    match factor {
        Factor::Position { axis, .. } => axes | bit(*axis),
        _ => axes,
    }
}

#[cfg(test)]
mod tests {
    use super::super::settings::{
        Cycle, ForceModel, PRODUCTS, Pitch, PitchSource, Points, Product, Straightness, TableFriction,
    };
    use super::*;

    fn points() -> Points {
        Points { start_m: 0.0, spacing_m: 0.1, values: [0.0, 1e-6].into_iter().collect() }
    }

    fn product(factors: [Factor; 2]) -> heapless::Vec<Product, PRODUCTS> {
        [Product { amplitude_m: 1e-6, factors: factors.into_iter().collect() }].into_iter().collect()
    }

    /// The kinds that depend on axes, with these.
    fn dependent(settings: &CompensationSettings) -> heapless::Vec<(CompensationKind, u8), 14> {
        let dependence = Dependence::of(2, settings);
        let kinds = CompensationKind::ALL.into_iter();
        kinds.map(|kind| (kind, dependence.on(kind))).filter(|(_, axes)| *axes != 0).collect()
    }

    /// Everything over a position depends on its axis; everything that follows motion or time depends on none.
    #[test]
    fn what_is_a_function_of_position_needs_the_position() {
        let cycle = || [Cycle::harmonic(1e-6, 0.01, 0.0)].into_iter().collect();
        let model = ForceModel { load: Some(points()), ..ForceModel::default() };
        let settings = CompensationSettings {
            pitch: Some(Pitch { of: PitchSource::Scale, forward: points(), backward: None }),
            screw: cycle(),
            dividing: cycle(),
            ripple: cycle(),
            intalk: Some(Talk::Over(points())),
            crosstalk: Some((0, Talk::Over(points()))),
            squareness: Some((0, 1e-5)),
            straightness: Some((1, Straightness::Quadratic(1e-6))),
            force: Some(model),
            stretch_m_per_n: Some(1e-9),
            products: product([
                Factor::Position { axis: 0, full_scale_m: 0.1 },
                Factor::Position { axis: 2, full_scale_m: 0.1 },
            ]),
            ..CompensationSettings::default()
        };
        let expected = [
            (CompensationKind::Pitch, 0b100),
            (CompensationKind::Dividing, 0b100),
            (CompensationKind::Intalk, 0b100),
            (CompensationKind::Crosstalk, 0b100),
            (CompensationKind::Squareness, 0b1),
            (CompensationKind::Straightness, 0b10),
            (CompensationKind::Ripple, 0b100),
            (CompensationKind::Screw, 0b100),
            (CompensationKind::Force, 0b100),
            (CompensationKind::Stretch, 0b100),
            (CompensationKind::Products, 0b101),
        ];
        assert_eq!(dependent(&settings), expected);
    }

    #[test]
    fn what_follows_motion_or_time_needs_no_position() {
        let settings = CompensationSettings {
            backlash_width_m: Some(5e-6),
            intalk: Some(Talk::Constant(1e-6)),
            crosstalk: Some((0, Talk::Constant(1e-6))),
            force: Some(ForceModel { table_mass_kg: 10.0, ..ForceModel::default() }),
            stretch_m_per_n: Some(1e-9),
            products: product([
                Factor::Direction { axis: 0 },
                Factor::Speed { axis: 2, full_scale_m_per_s: 1.0 },
            ]),
            ..CompensationSettings::default()
        };
        assert!(dependent(&settings).is_empty());
        // The same position twice is one position.
        let squared = CompensationSettings {
            products: product([Factor::Position { axis: 1, full_scale_m: 0.1 }; 2]),
            ..CompensationSettings::default()
        };
        assert_eq!(dependent(&squared), [(CompensationKind::Products, 0b10)]);
        // With a map of the friction the force depends on the position, and the deflection with it.
        let friction = TableFriction { map: Some(points()), ..TableFriction::default() };
        let settings = CompensationSettings {
            force: Some(ForceModel { friction, ..ForceModel::default() }),
            ..settings
        };
        assert_eq!(
            dependent(&settings),
            [(CompensationKind::Force, 0b100), (CompensationKind::Stretch, 0b100)]
        );
    }
}
