//! Lost motion: backlash and wind-up under friction, where nothing distinguishes them.

use serde::{Deserialize, Serialize};

use super::backlash::{Backlash, GUESSED_WIDTHS_UM};
use super::declaration::{
    Abscissa, AnyEffect, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation,
    ImitationContext, Misplaced, Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range,
    ResidualShape, Stage, Unit, Wording,
};
use crate::axis::{Drive, Settings};

/// The way that the motor travels after a reversal before the table follows: a gap, and the stretch 2·F/k of the drive train under the
/// friction F that reverses. Where neither the force nor stiffness and masses are known, both are one quantity.
///
/// By itself it acts as a gap. With [`Self::friction_m_per_s2`] the table slides on in the gap where it is braked harder than friction
/// brakes it: it is then a mass on a spring behind a gap, all relative to that mass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LostMotion {
    /// Total width.
    pub width_um: f64,
    /// Sliding friction of the table over its mass. Absent: the table never slides by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_m_per_s2: Option<f64>,
    /// Travel over which this friction reverses: its deflection before the table slides. Absent with the friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presliding_um: Option<f64>,
}

/// Highest friction over mass, m/s²: twice the weight. Above, the table never slides by itself, and the plain form says the same.
const HIGHEST_FRICTION: f64 = 20.0;

/// Frictions over mass with which a fit starts, m/s².
const GUESSED_FRICTIONS: [f64; 2] = [0.4, 1.6];

/// Travel of presliding with which a fit starts.
const GUESSED_PRESLIDING_UM: f64 = 5.0;

/// What would tell the parts of the lost motion apart.
const DECIDED_BY: &str =
    "a force channel, or the masses, the friction and stiffness_n_per_um in the machine file";

const GAP: Imitation = Imitation {
    name: Backlash::NAME,
    clause: "the screw has a gap of up to this width",
    decided_by: DECIDED_BY,
};

const LOAD_ANGLE: Imitation = Imitation {
    name: "load_angle",
    clause: "friction turns the rotor of the stepper motor away from its command",
    decided_by: "a motor channel",
};

impl LostMotion {
    /// A table that never slides by itself.
    #[must_use]
    pub const fn of_width(width_um: f64) -> Self {
        Self { width_um, friction_m_per_s2: None, presliding_um: None }
    }

    /// The gap, beside a stretch of the drive train per acceleration (m per m/s²): the total width less the stretch by friction either way.
    #[must_use]
    pub fn gap(&self, stretch_s2: f64) -> Backlash {
        let by_friction_um = 2e6 * self.friction_m_per_s2.unwrap_or(0.0) * stretch_s2;
        Backlash { width_um: (self.width_um - by_friction_um).max(0.0) }
    }
}

impl EffectModel for LostMotion {
    const NAME: &'static str = "lost_motion";
    const SUMMARY: &'static str = "total width by which the table lags after a reversal: backlash and wind-up under friction, which the logs do not distinguish";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("width_um", Unit::Micrometre, Range::NotNegative),
        Parameter::new("friction_m_per_s2", Unit::MetrePerSecondSquared, Range::Positive),
        Parameter::new("presliding_um", Unit::Micrometre, Range::Positive),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if axis.has_drive_train() { Prerequisite::NotApplicable } else { Prerequisite::Met }
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where neither masses nor stiffness are given, otherwise backlash";
        // One of the two alone would say nothing: both describe the sliding.
        let lacking = |key, given: &str| Some(Misplaced { key, expected: format!("a value beside {given}") });
        match (self.friction_m_per_s2, self.presliding_um) {
            _ if place.axis.has_drive_train() => Some(Misplaced::name(what)),
            (Some(_), None) => lacking("presliding_um", "friction_m_per_s2"),
            (None, Some(_)) => lacking("friction_m_per_s2", "presliding_um"),
            _ => None,
        }
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !(context.has(Stage::Table) && context.hides_windup()) {
            return Vec::new();
        }
        let sliding = |width_um: f64| {
            GUESSED_FRICTIONS.map(|friction| Self {
                friction_m_per_s2: Some(friction),
                presliding_um: Some(GUESSED_PRESLIDING_UM),
                ..Self::of_width(width_um)
            })
        };
        let plain = GUESSED_WIDTHS_UM.map(Self::of_width);
        plain.into_iter().chain(GUESSED_WIDTHS_UM.into_iter().flat_map(sliding)).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let friction =
            self.friction_m_per_s2.map(|friction| Coordinate::scale(friction, 1e-2, HIGHEST_FRICTION));
        // A friction that reverses at once is no limit of the search.
        let presliding = self.presliding_um.map(|um| {
            let scale = Coordinate::scale(um, 0.1, 1e3);
            Coordinate { limits: [f64::NEG_INFINITY, scale.limits[1]], ..scale }
        });
        let width = Coordinate::between(self.width_um, 0.2, 0.0, 1000.0);
        [width].into_iter().chain(friction).chain(presliding).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        Self {
            width_um: x[0],
            friction_m_per_s2: self.friction_m_per_s2.and_then(|_| x.get(1).copied()),
            presliding_um: self.presliding_um.and_then(|_| x.get(2).copied()),
        }
    }

    fn values(&self) -> Vec<f64> {
        [self.width_um].into_iter().chain(self.friction_m_per_s2).chain(self.presliding_um).collect()
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let stretch = Imitation { decided_by: DECIDED_BY, ..Imitation::STRETCH };
        let is_commanded = context.axis.controller.drive == Drive::Stepper && !context.logged.motor;
        [GAP, stretch].into_iter().chain(is_commanded.then_some(LOAD_ANGLE)).collect()
    }

    /// A table that friction brakes harder than anything else never slides by itself.
    fn at_its_limit(&self) -> Option<Self> {
        self.friction_m_per_s2.map(|_| Self::of_width(self.width_um))
    }

    fn variation(&self, residual: &dyn Fn() -> ResidualShape, travel_mm: [f64; 2]) -> Option<AnyEffect> {
        self.gap(0.0).variation(residual, travel_mm)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::REVERSAL
    }

    fn sentence(&self, wording: &Wording) -> String {
        let sliding = if self.presliding_um.is_some() {
            format!(
                "; friction brakes the table by {} and reverses over {}",
                wording.value(1),
                wording.value(2)
            )
        } else {
            String::new()
        };
        let width = wording.value(0);
        format!(
            "{width} lost motion between motor and table: gap and stretch under friction together{sliding}"
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
