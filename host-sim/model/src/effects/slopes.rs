//! The effects that are slopes.

use super::{Effect, PitchProgressive, ProbeGain, ProbeRotation, ScaleGain, SlopeOf, Squareness};

impl SlopeOf {
    /// The effect with this slope.
    #[must_use]
    pub const fn effect(self, um_per_m: f64) -> Effect {
        match self {
            Self::Screw => Effect::PitchProgressive(PitchProgressive { slope_um_per_m: um_per_m }),
            Self::Scale => Effect::ScaleGain(ScaleGain { um_per_m }),
            Self::Probe => Effect::ProbeGain(ProbeGain { um_per_m }),
            Self::Axes => Effect::Squareness(Squareness { um_per_m }),
            Self::ProbeAngle => Effect::ProbeRotation(ProbeRotation { um_per_m }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_the_effect_that_says_so() {
        for of in [SlopeOf::Screw, SlopeOf::Scale, SlopeOf::Probe, SlopeOf::Axes, SlopeOf::ProbeAngle] {
            let effect = of.effect(12.0);
            assert_eq!((effect.slope(), effect.values()), (Some(of), vec![12.0]));
        }
    }
}
