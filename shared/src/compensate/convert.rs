//! Checks of the compensation settings of an axis, and their conversion to what a tick computes with.

use super::axis::AxisCompensation;
use super::backlash::Backlash;
use super::cycles::Cycles;
use super::drift::Drift;
use super::force::Force;
use super::geometry::{Squareness, Straightness};
use super::names::{DIVIDING, RIPPLE, SCREW, points_names};
use super::pitch::Pitch;
use super::products::Products;
use super::reversal::Reversal;
use super::round_robin::RoundRobinTerm;
use super::settings::CompensationSettings;
use super::slew::Slew;
use super::table::{Table, ValueRange};
use super::talk::Talk;
use crate::config::check::{gain, positive, ranged};
use crate::config::{ConfigError, Rates};
use crate::scalar::{Fixed, Scalar};
use crate::units::LENGTH_M;

/// Bounds of the corrections in SI, and the rates of their ticks.
struct Limits {
    bound_m: f64,
    bound_n: f64,
    /// Of the position loop, Hz.
    rate_hz: f64,
    /// Of the velocity loop, Hz.
    tick_hz: f64,
}

impl Limits {
    fn new<S: Scalar>(settings: &CompensationSettings, rates: Rates) -> Result<Self, ConfigError> {
        let bound_m = positive("position_bound_m", settings.position_bound_m)?;
        let bound_n = positive("force_bound_n", settings.force_bound_n)?;
        Ok(Self {
            bound_m: ranged("position_bound_m", bound_m, 0.0, 0.01)?,
            bound_n: ranged("force_bound_n", bound_n, 0.0, S::SIGNAL_LIMIT)?,
            rate_hz: rates.position_loop_hz(),
            tick_hz: rates.velocity_loop_hz,
        })
    }

    /// Unit and range of lengths.
    const fn lengths(&self) -> ValueRange {
        ValueRange { unit: LENGTH_M, bound: self.bound_m }
    }

    /// Unit and range of forces.
    const fn forces(&self) -> ValueRange {
        ValueRange { unit: 1.0, bound: self.bound_n }
    }

    fn position<S: Scalar>(&self, m_per_s: f64, per_s: f64) -> Result<Slew<S>, ConfigError> {
        let name = "position_rate_m_per_s";
        let per_tick = Slew::per_tick(name, positive(name, m_per_s)?, per_s * LENGTH_M)?;
        Ok(Slew { bound: S::signal(self.bound_m / LENGTH_M), per_tick })
    }

    fn force<S: Scalar>(&self, n_per_s: f64) -> Result<Slew<S>, ConfigError> {
        let name = "force_rate_n_per_s";
        let per_tick = Slew::per_tick(name, positive(name, n_per_s)?, self.tick_hz)?;
        Ok(Slew { bound: S::signal(self.bound_n), per_tick })
    }
}

/// An axis of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisOf {
    /// Number of the axis, counted from 0.
    pub axis: usize,
    /// Number of axes of the machine.
    pub axes: usize,
}

/// Another axis of the machine.
fn another(name: &'static str, other: u8, AxisOf { axis, axes }: AxisOf) -> Result<u8, ConfigError> {
    if usize::from(other) < axes && usize::from(other) != axis {
        Ok(other)
    } else {
        Err(ConfigError::NotAnotherAxis { name, axes: u8::try_from(axes).unwrap_or(u8::MAX) })
    }
}

// Tables are large, and each of these functions keeps several of them on its stack: not inlined, so that these are not there
// all at once.
impl<S: Scalar> AxisCompensation<S> {
    /// Checks and converts the settings of an axis.
    ///
    /// # Errors
    /// [`ConfigError`] for the first setting that is not finite, exceeds its bound or the range of the number format `S`, or
    /// requires another one.
    pub fn new(settings: &CompensationSettings, rates: Rates, place: AxisOf) -> Result<Self, ConfigError> {
        Self::convert_for(settings, rates, place, Self::clone)
    }

    /// [`AxisCompensation::new`] without a copy: passes the converted settings on where they are. They are large.
    ///
    /// # Errors
    /// [`ConfigError`]; `then` is not called.
    pub fn convert_for<R>(
        settings: &CompensationSettings,
        rates: Rates,
        place: AxisOf,
        then: impl FnOnce(&Self) -> R,
    ) -> Result<R, ConfigError> {
        let limits = Limits::new::<S>(settings, rates)?;
        let mut converted = Self {
            command: limits.position(settings.position_rate_m_per_s, limits.rate_hz)?,
            reading: limits.position(settings.position_rate_m_per_s, limits.tick_hz)?,
            force: limits.force(settings.force_rate_n_per_s)?,
            ..Self::NONE
        };
        converted.convert_screw(settings, &limits)?;
        converted.convert_tool(settings, &limits, place)?;
        converted.convert_motor(settings, &limits)?;
        converted.convert_model(settings, &limits)?;
        converted.list_slow_terms();
        Ok(then(&converted))
    }

    /// Errors between motor and scale, except for the stretch.
    #[inline(never)]
    fn convert_screw(&mut self, settings: &CompensationSettings, limits: &Limits) -> Result<(), ConfigError> {
        let bound_m = limits.bound_m;
        self.pitch = settings.pitch.as_ref().map(|pitch| Pitch::new(pitch, bound_m)).transpose()?;
        self.backlash = settings.backlash_width_m.map(|width| Backlash::new(width, bound_m)).transpose()?;
        self.screw = Cycles::new(&SCREW, &settings.screw, limits.lengths())?;
        Ok(())
    }

    /// Errors of the tool.
    #[inline(never)]
    fn convert_tool(
        &mut self,
        settings: &CompensationSettings,
        limits: &Limits,
        place: AxisOf,
    ) -> Result<(), ConfigError> {
        let &Limits { bound_m, rate_hz, tick_hz, .. } = limits;
        if let Some(talk) = &settings.intalk {
            self.intalk = Some(Talk::new(("intalk.Constant", &points_names!("intalk.Over")), talk, rate_hz)?);
        }
        if let Some((axis, talk)) = &settings.crosstalk {
            self.crosstalk_source = another("crosstalk[0]", *axis, place)?;
            self.crosstalk = Some(Talk::new(
                ("crosstalk[1].Constant", &points_names!("crosstalk[1].Over")),
                talk,
                rate_hz,
            )?);
        }
        if let Some((axis, k)) = settings.squareness {
            self.squareness_source = another("squareness[0]", axis, place)?;
            self.squareness = Some(Squareness::new(k)?);
        }
        if let Some((axis, shape)) = &settings.straightness {
            let axis = another("straightness[0]", *axis, place)?;
            self.straightness = Some((axis, Straightness::new(shape, bound_m)?));
        }
        if let Some(drift) = &settings.drift {
            self.drift = Some(Drift::new(drift, tick_hz, bound_m)?);
        }
        self.products = Products::new(&settings.products, rate_hz, place.axes)?;
        Ok(())
    }

    /// Errors of the motor: its reading, its ripple, and the pulse at a reversal.
    #[inline(never)]
    fn convert_motor(&mut self, settings: &CompensationSettings, limits: &Limits) -> Result<(), ConfigError> {
        self.dividing = Cycles::new(&DIVIDING, &settings.dividing, limits.lengths())?;
        self.ripple = Cycles::new(&RIPPLE, &settings.ripple, limits.forces())?;
        if let Some(reversal) = &settings.reversal {
            self.reversal = Some(Reversal::new(reversal, limits.rate_hz, limits.bound_n)?);
        }
        Ok(())
    }

    /// The force feed-forward, and the stretch.
    #[inline(never)]
    fn convert_model(&mut self, settings: &CompensationSettings, limits: &Limits) -> Result<(), ConfigError> {
        let Some(model) = &settings.force else {
            return match settings.stretch_m_per_n {
                Some(_) => Err(ConfigError::Requires { name: "stretch_m_per_n", other: "force" }),
                None => Ok(()),
            };
        };
        // The model is in fixed point in every number format.
        let bound_n = limits.bound_n.min(Fixed::SIGNAL_LIMIT);
        let forces = ValueRange { unit: 1.0, bound: bound_n };
        self.model = Some(Force::new(model, [limits.rate_hz, limits.tick_hz], bound_n)?);
        if let Some(load) = &model.load {
            self.load = Some(Table::new(&points_names!("force.load"), load, forces)?);
        }
        if let Some(map) = &model.friction.map {
            self.friction_map = Some(Table::new(&points_names!("force.friction.map"), map, forces)?);
        }
        if let Some(m_per_n) = settings.stretch_m_per_n {
            let name = "stretch_m_per_n";
            let m_per_n = ranged(name, m_per_n, 0.0, S::GAIN_LIMIT * LENGTH_M)?;
            self.stretch = Some(gain::<S>(name, m_per_n, 1.0 / LENGTH_M)?);
        }
        Ok(())
    }

    fn list_slow_terms(&mut self) {
        let warms_up = self.model.as_ref().is_some_and(Force::warms_up);
        let present = [
            (RoundRobinTerm::Pitch, self.pitch.is_some()),
            (RoundRobinTerm::Straightness, self.straightness.is_some()),
            (RoundRobinTerm::Intalk, self.intalk.is_some()),
            (RoundRobinTerm::Crosstalk, self.crosstalk.is_some()),
            (RoundRobinTerm::Drift, self.drift.is_some()),
            (RoundRobinTerm::Load, self.load.is_some()),
            (RoundRobinTerm::AdditionalFriction, self.friction_map.is_some() || warms_up),
        ];
        for (term, _) in present.into_iter().filter(|(_, is)| *is) {
            self.round_robin.push(term);
        }
    }
}
