//! What a residual is drawn against, and its mean over that.

use super::stages::AxisView;
use model::effects::{Effect, Stage};
use numerics::bins::{Bin, binned};
use trace::residual::Part;
use trace::signals::{AxisSignals, Smooth};
use trace::unexplained::Variable;

/// Bins over the range of a variable.
const BINS: usize = 64;

/// A mean over fewer samples than this is left out.
const LEAST_SAMPLES: usize = 8;

/// What goes to the right in a picture of a residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Across {
    /// The session's clock.
    Time,
    /// Place on the axis.
    Position,
    /// Place of the motor within a period, mm.
    Folded(f64),
    /// Of the axis.
    Velocity,
    /// Of the axis.
    Acceleration,
    /// Of the drive.
    Force,
    /// Place on another axis.
    OtherPosition(usize),
    /// Of another axis.
    OtherAcceleration(usize),
}

impl Across {
    /// The variable that what an effect does is a function of, or that shows it best.
    pub fn of_effect(effect: &Effect, view: &AxisView<'_>) -> Self {
        let (names, own) = (view.evidence.names, view.evidence.axis);
        let is_force_known = view.evidence.logs.iter().all(|log| log.axes[own].force.is_some());
        let named = |name: &String| names.iter().position(|other| other == name).unwrap_or(own);
        match effect {
            Effect::Backlash(_)
            | Effect::Stribeck(_)
            | Effect::FrictionAsymmetry(_)
            | Effect::ConstantLoad(_)
            | Effect::Presliding(_)
            | Effect::ShearThinning(_)
            | Effect::ServoMismatch(_)
            | Effect::Latency(_) => Self::Velocity,
            Effect::PitchProgressive(_) | Effect::PreloadVariation(_) => Self::Position,
            Effect::FrictionMemory(_) => Self::Acceleration,
            Effect::FrictionRipple(e) => Self::Folded(e.period_mm),
            Effect::PitchCyclic(e) => Self::Folded(e.period_mm),
            Effect::ResolverDividing(e) => Self::Folded(e.period_mm),
            Effect::TorqueRipple(e) => Self::Folded(e.period_mm),
            Effect::Windup(_) if is_force_known => Self::Force,
            Effect::Windup(_) | Effect::VelocityLag(_) | Effect::Intalk(_) | Effect::Resonance(_) => {
                Self::Acceleration
            }
            Effect::Crosstalk(e) => Self::OtherAcceleration(named(&e.source)),
            Effect::Straightness(e) => Self::OtherPosition(named(&e.source)),
            Effect::Squareness(_) => Self::OtherPosition(other(names.len(), own).unwrap_or(own)),
            Effect::ThermalDrift(_) => Self::Time,
        }
    }

    /// The variable that an unexplained rest follows; a vibration is seen in the picture over time.
    pub fn of_rest(variable: Variable, axes: usize, own: usize) -> Option<Self> {
        match variable {
            Variable::Time | Variable::None => None,
            Variable::Position => Some(Self::Position),
            Variable::Velocity | Variable::Direction => Some(Self::Velocity),
            Variable::Acceleration => Some(Self::Acceleration),
            Variable::Force => Some(Self::Force),
            Variable::OtherPosition => other(axes, own).map(Self::OtherPosition),
            Variable::OtherAcceleration => other(axes, own).map(Self::OtherAcceleration),
        }
    }

    /// Its name with its unit, for an axis of a picture.
    pub fn label(self, names: &[String]) -> String {
        let name = |axis: usize| names.get(axis).map_or("", String::as_str);
        match self {
            Self::Time => "time, s".to_owned(),
            Self::Position => "position, mm".to_owned(),
            Self::Folded(period) => {
                let period = super::number::significant(period, 4);
                format!("motor position within each {period} mm, mm")
            }
            Self::Velocity => "velocity, mm/s".to_owned(),
            Self::Acceleration => "acceleration, m/s²".to_owned(),
            Self::Force => "drive force, N".to_owned(),
            Self::OtherPosition(axis) => format!("position of {}, mm", name(axis)),
            Self::OtherAcceleration(axis) => format!("acceleration of {}, m/s²", name(axis)),
        }
    }

    /// Its values over one log, if it was measured, in the unit of [`Across::label`].
    fn values(self, view: &AxisView<'_>, log: usize) -> Option<Vec<f64>> {
        let log = &view.evidence.logs[log];
        let own = &log.axes[view.evidence.axis];
        let millimetres = |values: &[f64]| values.iter().map(|v| 1e3 * v).collect();
        let carried = |axis: usize| log.axes.get(axis).and_then(AxisSignals::table_or_motor);
        let acceleration = |smooth: &Smooth| smooth.acceleration.clone();
        match self {
            Self::Time => Some((0..log.len()).map(|i| log.start_s + i as f64 * log.sample_s).collect()),
            Self::Position => carried(view.evidence.axis).map(|smooth| millimetres(&smooth.position)),
            Self::Folded(period) => {
                let motor = own.motor.as_ref().or(own.table.as_ref())?;
                Some(motor.position.iter().map(|m| (1e3 * m).rem_euclid(period)).collect())
            }
            Self::Velocity => carried(view.evidence.axis).map(|smooth| millimetres(&smooth.velocity)),
            Self::Acceleration => carried(view.evidence.axis).map(acceleration),
            Self::Force => own.force.as_ref().map(|force| force.position.clone()),
            Self::OtherPosition(axis) => carried(axis).map(|smooth| millimetres(&smooth.position)),
            Self::OtherAcceleration(axis) => carried(axis).map(acceleration),
        }
    }
}

/// The first of the other axes.
fn other(axes: usize, own: usize) -> Option<usize> {
    (0..axes).find(|&axis| axis != own)
}

/// Mean residual of a stage over all logs in equal bins of a variable: the middle of each bin, and
/// the mean there, in runs of bins that hold samples. Empty where the variable was not measured or
/// never changes.
pub fn means(view: &AxisView<'_>, parts: &[Part], stage: Stage, across: Across) -> Vec<Vec<(f64, f64)>> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for part in parts.iter().filter(|part| part.stage == stage) {
        let Some(values) = across.values(view, part.log) else { return Vec::new() };
        let (skipped, residual) = view.settled(parts, stage, part.log);
        pairs.extend(values.into_iter().skip(skipped).zip(residual.iter().copied()));
    }
    let is_used = |bin: &Bin| bin.count >= LEAST_SAMPLES;
    binned(&pairs, BINS)
        .unwrap_or_default()
        .chunk_by(|a, b| is_used(a) && is_used(b))
        .filter(|run| is_used(&run[0]))
        .map(|run| run.iter().map(|bin| (bin.centre, bin.mean())).collect())
        .collect()
}
