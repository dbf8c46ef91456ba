//! The preload of axes whose machine file declares none: a constant load that a trace has found.

use commissioning::compensate::CompensationFile;
use model::effects::Effect;
use model::machine::{Axis, Machine};
use shared::config::AxisSettings;

/// Completes the settings by the constant loads that are known, of the machine file or else of the compensation. Returns a sentence for
/// each, with the names of the files.
pub fn complete(
    settings: &mut [AxisSettings],
    machine: &Machine,
    source: &str,
    compensation: Option<(&CompensationFile, &str)>,
) -> Vec<String> {
    let mut sentences = Vec::new();
    for ((name, axis), settings) in machine.axis.iter().zip(settings) {
        let declared = declared_n(axis).map(|n| (n, source));
        let known = declared.or_else(|| {
            let (file, source) = compensation?;
            compensated_n(file, name).map(|n| (n, source))
        });
        if let (None, Some((load_n, source))) = (settings.preload_n, known) {
            settings.preload_n = Some(load_n);
            sentences.push(format!(
                "The drive of {name} comes on with {load_n:.1} N: the constant_load of {source}, as the machine file has no preload_n."
            ));
        }
    }
    sentences
}

/// The force against a constant load of the machine file, N.
fn declared_n(axis: &Axis) -> Option<f64> {
    let loads = axis.effect.iter().filter_map(|effect| match effect {
        Effect::ConstantLoad(load) => Some(load.force_n),
        _ => None,
    });
    loads.reduce(|a, b| a + b)
}

/// The force against a constant load that is compensated, N. A load that depends on the position is not one.
fn compensated_n(file: &CompensationFile, name: &str) -> Option<f64> {
    let item = format!("{name}: constant_load");
    let load = file.axis.get(name)?.compensation.force.as_ref()?.load.as_ref()?;
    let first = *load.values.first()?;
    let is_constant = load.values.iter().all(|n| (n - first).abs() <= 1e-6 * first.abs());
    (is_constant && file.provenance.compensates.contains(&item)).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::compensate::settings::{ForceModel, Points};

    fn machine(keys: &str) -> Machine {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\n[axis.y]\ndrive = \"velocity\"\n{keys}"
        );
        Machine::parse(&text, "m.toml").unwrap()
    }

    fn compensation(values: &[f64], compensates: &[&str]) -> CompensationFile {
        let load = Points { start_m: 0.0, spacing_m: 0.1, values: values.iter().copied().collect() };
        let mut file = CompensationFile::default();
        file.axis.entry("y".to_owned()).or_default().compensation.force =
            Some(ForceModel { load: Some(load), ..ForceModel::default() });
        file.provenance.compensates = compensates.iter().map(|&item| item.to_owned()).collect();
        file
    }

    /// The preloads of both axes, and the sentences.
    fn completed(
        declared_n: Option<f64>,
        keys: &str,
        file: Option<&CompensationFile>,
    ) -> ([Option<f64>; 2], Vec<String>) {
        let axis = AxisSettings { preload_n: declared_n, ..AxisSettings::default() };
        let mut settings = [AxisSettings::default(), axis];
        let sentences = complete(&mut settings, &machine(keys), "m.toml", file.map(|file| (file, "c.toml")));
        (settings.map(|axis| axis.preload_n), sentences)
    }

    const LOADS: &str = "[[axis.y.effect]]\nname = \"constant_load\"\nforce_n = 140.0\n\
                         [[axis.y.effect]]\nname = \"constant_load\"\nforce_n = 7.0\n";

    /// The sum of the loads of the machine file; else that of the compensation; a preload that is declared stays, also zero.
    #[test]
    fn a_constant_load_is_the_preload_unless_one_is_declared() {
        let file = compensation(&[150.0; 2], &["x: backlash", "y: constant_load"]);
        let (preloads, sentences) = completed(None, LOADS, Some(&file));
        assert_eq!(preloads, [None, Some(147.0)]);
        assert!(
            sentences.len() == 1
                && sentences[0].contains("y comes on with 147.0 N: the constant_load of m.toml")
        );
        let (preloads, sentences) = completed(None, "", Some(&file));
        assert_eq!(preloads, [None, Some(150.0)]);
        assert!(sentences.len() == 1 && sentences[0].contains("of c.toml"), "{sentences:?}");
        for declared_n in [0.0, -3.0] {
            assert_eq!(completed(Some(declared_n), LOADS, Some(&file)), ([None, Some(declared_n)], vec![]));
        }
    }

    /// What nobody has declared stays unknown: no load, a load that depends on the position, one of another effect.
    #[test]
    fn what_is_not_a_constant_load_is_no_preload() {
        assert_eq!(completed(None, "", None), ([None; 2], vec![]));
        for file in [
            compensation(&[150.0, 151.0], &["y: constant_load", "y: position_load"]),
            compensation(&[150.0; 2], &["x: constant_load"]),
        ] {
            assert_eq!(completed(None, "", Some(&file)), ([None; 2], vec![]));
        }
    }
}
