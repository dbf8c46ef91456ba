//! The variables over which residuals are plotted, and the mean residual over a variable.

use super::axis_view::AxisView;
use files::log::Unit;
use model::effects::{Abscissa, Effect, Stage, Unit as ParameterUnit};
use numerics::bins::{Bin, binned};
use trace::analysis::variable::Variable;
use trace::fit::fit_data::ResidualSeries;
use trace::input::signals::AxisSignals;
use trace::input::smoothing::Smooth;

/// Bins over the range of a variable.
const BINS: usize = 64;

/// Minimum number of samples of a mean.
const LEAST_SAMPLES: usize = 8;

/// The variable over which an effect's residual is plotted.
pub fn of_effect(effect: &Effect, view: &AxisView<'_>) -> Abscissa {
    let is_force_known = view.data.logs.iter().all(|log| log.axes[view.data.axis].force.is_some());
    match effect.abscissa() {
        Abscissa::Force if !is_force_known => Abscissa::Acceleration,
        Abscissa::OtherPosition(None) => Abscissa::OtherPosition(first_other(view)),
        Abscissa::OtherAcceleration(None) => Abscissa::OtherAcceleration(first_other(view)),
        abscissa => abscissa,
    }
}

/// The variable on which an unexplained residual depends; a vibration is visible in the plot over time.
pub fn of_residual(variable: Variable, view: &AxisView<'_>) -> Option<Abscissa> {
    match variable {
        Variable::Time | Variable::None => None,
        Variable::Position => Some(Abscissa::Position),
        Variable::Velocity | Variable::Direction => Some(Abscissa::Velocity),
        Variable::Acceleration => Some(Abscissa::Acceleration),
        Variable::Force => Some(Abscissa::Force),
        Variable::OtherPosition => first_other(view).map(|axis| Abscissa::OtherPosition(Some(axis))),
        Variable::OtherAcceleration => first_other(view).map(|axis| Abscissa::OtherAcceleration(Some(axis))),
    }
}

/// The name of a variable with its unit, for an axis of a plot.
pub fn label(abscissa: &Abscissa, view: &AxisView<'_>) -> String {
    let name = |axis: usize| &view.data.names[axis];
    let is_rotary = |axis: usize| {
        view.data.logs.iter().filter_map(|log| log.axes.get(axis)?.unit).any(|unit| unit == Unit::Degree)
    };
    let symbol = |unit: ParameterUnit, axis: usize| unit.symbols()[usize::from(is_rotary(axis))];
    let length = |axis: usize| symbol(ParameterUnit::Millimetre, axis);
    // Signals are in m or 1000°; no parameter is an acceleration.
    let acceleration = |axis: usize| if is_rotary(axis) { "1000°/s²" } else { "m/s²" };
    let own = view.data.axis;
    match abscissa {
        Abscissa::Time => "time, s".to_owned(),
        Abscissa::Position => format!("position, {}", length(own)),
        Abscissa::WithinPeriod(period_mm) => {
            let number = files::format::significant(*period_mm, 4);
            let period = ParameterUnit::Millimetre.with(&number, is_rotary(own));
            format!("motor position within each {period}, {}", length(own))
        }
        Abscissa::Velocity => format!("velocity, {}", symbol(ParameterUnit::MillimetrePerSecond, own)),
        Abscissa::Acceleration => format!("acceleration, {}", acceleration(own)),
        Abscissa::Force => {
            let name = if is_rotary(own) { "torque" } else { "force" };
            format!("drive {name}, {}", symbol(ParameterUnit::Newton, own))
        }
        Abscissa::OtherPosition(axis) => {
            let axis = other(axis.as_deref(), view);
            format!("position of {}, {}", name(axis), length(axis))
        }
        Abscissa::OtherAcceleration(axis) => {
            let axis = other(axis.as_deref(), view);
            format!("acceleration of {}, {}", name(axis), acceleration(axis))
        }
    }
}

/// The values of a variable over one log, if it was measured, in the unit of its [`label`].
fn values(abscissa: &Abscissa, view: &AxisView<'_>, log: usize) -> Option<Vec<f64>> {
    let log = &view.data.logs[log];
    let own = &log.axes[view.data.axis];
    let millimetres = |values: &[f64]| values.iter().map(|v| 1e3 * v).collect();
    let carried = |axis: usize| log.axes.get(axis).and_then(AxisSignals::table_or_motor);
    let acceleration = |smooth: &Smooth| smooth.acceleration.clone();
    let other = |name: &Option<String>| carried(other(name.as_deref(), view));
    match abscissa {
        Abscissa::Time => Some((0..log.len()).map(|i| log.start_s + i as f64 * log.sample_s).collect()),
        Abscissa::Position => carried(view.data.axis).map(|smooth| millimetres(&smooth.value)),
        Abscissa::WithinPeriod(period_mm) => {
            let motor = own.motor.as_ref().or(own.table.as_ref())?;
            Some(motor.value.iter().map(|m| (1e3 * m).rem_euclid(*period_mm)).collect())
        }
        Abscissa::Velocity => carried(view.data.axis).map(|smooth| millimetres(&smooth.velocity)),
        Abscissa::Acceleration => carried(view.data.axis).map(acceleration),
        Abscissa::Force => own.force.as_ref().map(|force| force.value.clone()),
        Abscissa::OtherPosition(axis) => other(axis).map(|smooth| millimetres(&smooth.value)),
        Abscissa::OtherAcceleration(axis) => other(axis).map(acceleration),
    }
}

/// The first of the other axes.
fn first_other(view: &AxisView<'_>) -> Option<String> {
    let (names, own) = (view.data.names, view.data.axis);
    names.iter().enumerate().find(|(axis, _)| *axis != own).map(|(_, name)| name.clone())
}

/// The axis with a name, or the view's own if there is none.
fn other(name: Option<&str>, view: &AxisView<'_>) -> usize {
    let (names, own) = (view.data.names, view.data.axis);
    names.iter().position(|other| Some(other.as_str()) == name).unwrap_or(own)
}

/// Mean residual of a stage over all logs in equal bins of a variable: the middle of each bin, and
/// the mean there, in sequences of bins that contain samples. Empty if the variable was not measured or
/// is constant.
pub fn means(
    view: &AxisView<'_>,
    parts: &[ResidualSeries],
    stage: Stage,
    abscissa: &Abscissa,
) -> Vec<Vec<(f64, f64)>> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for part in parts.iter().filter(|part| part.stage == stage) {
        let Some(values) = values(abscissa, view, part.log) else { return Vec::new() };
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
