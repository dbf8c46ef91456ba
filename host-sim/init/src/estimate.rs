//! What a machine file does not say, estimated from the logs of a trace, which then fits it.

use files::log::Log;
use model::axis::{Drive, Settings, TOLERATED, Tolerated};
use model::machine::{Machine, rotary};
use trace::Progress;

use crate::initial::{Initial, STIFFNESS_PERCENT};
use crate::rough::Origin;
use crate::{gains, machine, rounded};

/// The machine with masses, friction, stiffness and gains from the logs where it has none, and what is said of them.
///
/// Of an axis whose force is commanded and logged, [`machine`] estimates everything that is not declared; of one whose velocity is
/// commanded, [`gains`] the gains. Values that are estimated have tolerances, within which a trace fits them. What the logs do not show stays
/// unknown.
#[must_use]
pub fn unknown_values(declared: &Machine, logs: &[Log], progress: &Progress<'_>) -> (Machine, Vec<String>) {
    let (mut with, mut notes) = gains::of_unknown(declared, logs);
    let open: Vec<String> = with
        .axis
        .iter()
        .filter(|(name, axis)| is_open(&axis.settings, name, logs))
        .map(|(name, _)| name.clone())
        .collect();
    if !open.is_empty() {
        // Logs that do not belong to the machine are refused by the trace.
        if let Ok(initial) = machine(&with, logs, progress) {
            for name in open {
                notes.extend(adopt(&mut with, &name, &initial));
            }
        }
    }
    let is_unused =
        |settings: &Settings| settings.mechanics.stiffness_n_per_um.is_some() && settings.is_rigid();
    let unused = with.axis.iter().filter(|(_, axis)| is_unused(&axis.settings));
    notes.extend(unused.map(|(name, axis)| {
        let key = |key| rotary::written(key, 0.0, axis.settings.names).0;
        let [stiffness, motor, table] = ["stiffness_n_per_um", "motor_mass_kg", "table_mass_kg"].map(key);
        format!("{name}: {stiffness} is not used, as {motor} and {table} are not known.")
    }));
    (with, notes)
}

/// Whether the force of an axis is commanded and logged, and its masses, or the gains of a loop whose command is logged, are not known.
fn is_open(settings: &Settings, name: &str, logs: &[Log]) -> bool {
    let Settings { controller, .. } = settings;
    let mut of_axis = logs.iter().map(|log| log.axis(name));
    let has_force = of_axis.clone().all(|axis| axis.is_some_and(|axis| axis.force.is_some()));
    let has_command = of_axis.all(|axis| axis.is_some_and(|axis| axis.command.is_some()));
    let has_gains = controller.position_gain_per_s.is_some() && controller.velocity_gain_n_s_per_m.is_some();
    let is_unknown = !settings.has_mass() || has_command && !has_gains;
    controller.drive == Drive::Torque && has_force && is_unknown
}

/// Gives a stiffness at least [`STIFFNESS_PERCENT`] of tolerance: how far it is off is known only as well as the masses beside it.
fn widen_stiffness(settings: &mut Settings) {
    let key = Tolerated::with_key("stiffness_n_per_um");
    let Some(key) = key.filter(|key| 100.0 * key.tolerance(settings) < STIFFNESS_PERCENT) else { return };
    let tolerances = settings.mechanics.tolerance_percent.get_or_insert_default();
    (key.set_tolerance_percent)(tolerances, STIFFNESS_PERCENT);
}

/// Takes the settings of an axis, with a sentence on those that were not declared; `None` if the logs show none.
fn adopt(with: &mut Machine, name: &str, initial: &Initial) -> Option<String> {
    let estimated = &initial.machine.axis.get(name)?.settings;
    let names = estimated.names;
    let values: Vec<String> = TOLERATED
        .iter()
        .filter_map(|key| {
            let value = initial.values.get(&(name.to_owned(), key.key))?;
            let number = (key.get)(estimated)?;
            let (key, number) = rotary::written(key.key, number, names);
            let said = format!("{key} {}", rounded(number));
            match (value.origin, value.tolerance_percent) {
                (Origin::Known, _) => None,
                (_, Some(percent)) => Some(format!("{said} ± {percent} %")),
                (_, None) => Some(said),
            }
        })
        .collect();
    if values.is_empty() {
        return None;
    }
    with.velocity_loop_rate_hz = with.velocity_loop_rate_hz.or(initial.machine.velocity_loop_rate_hz);
    let axis = with.axis.get_mut(name)?;
    let had_mass = axis.settings.has_mass();
    axis.settings = estimated.clone();
    if !had_mass && estimated.mechanics.stiffness_n_per_um.is_some() {
        widen_stiffness(&mut axis.settings);
    }
    Some(format!(
        "{name}: not in the machine file, and estimated from the fitted logs: {}. What they are wrong by is no effect.",
        values.join(", ")
    ))
}
