//! A hum of the mains in the readings of scale and force.

use files::log::{Channel, Log};
use model::machine::Machine;
use trace::data_faults::FaultKind;
use trace::trace;

/// 60 nm at 50.02 Hz on both scales, 6 N on both forces.
fn with_hum(mut log: Log) -> Log {
    let start_s = log.start_s;
    let hum = |i: usize| (std::f64::consts::TAU * 50.02 * (start_s + 1e-3 * i as f64)).sin();
    for axis in &mut log.axes {
        for (channel, amplitude) in [(Channel::Table, 60e-6), (Channel::Force, 6.0)] {
            let values = axis.channel_mut(channel).as_mut().unwrap();
            values.iter_mut().enumerate().for_each(|(i, value)| *value += amplitude * hum(i));
        }
    }
    log
}

/// The hum is named in each log, and an error of squareness is found as without it.
#[test]
fn a_hum_is_named_and_does_not_hide_an_effect() {
    let effect = "[[axis.x.effect]]\nname = \"squareness\"\num_per_m = 40.0\n";
    let machine = Machine::parse(&format!("{}\n{effect}", demo::MACHINE), "true.toml").unwrap();
    let [fit, validate] =
        demo::logs(&machine, 1).unwrap().map(|logs| logs.into_iter().map(with_hum).collect::<Vec<_>>());
    let declared = Machine::parse(demo::MACHINE, "m.toml").unwrap();
    let trace = trace(&declared, &fit, &validate, &|_| {}).unwrap();
    assert_eq!(trace.found_names(), ["x: squareness"]);
    for (axis, log) in
        trace.axes().iter().flat_map(|axis| fit.iter().chain(&validate).map(move |log| (axis, log)))
    {
        let of = |channel| {
            let mut faults = axis.data_faults.iter().filter(|fault| fault.log == log.source);
            faults.find(|fault| fault.kind == FaultKind::Hum && fault.channel == Some(channel)).unwrap()
        };
        let (table, force) = (of(Channel::Table), of(Channel::Force));
        // The noise of 10 to 40 nm over 2 to 10 s shifts the amplitude by at most 2 nm, the frequency by a hundredth of 1/T.
        assert!((table.size.unwrap() - 0.06).abs() < 0.004, "{table:?}");
        assert!((table.frequency_hz.unwrap() - 50.02).abs() < 0.03, "{table:?}");
        // Friction and inertia of the motion have a part at 50 Hz, too.
        assert!((force.size.unwrap() - 6.0).abs() < 1.5, "{force:?}");
    }
}
