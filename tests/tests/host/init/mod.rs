//! Machine files from logs: what a trace with one of them leaves, against the same trace with the true file.

mod cases;
mod drives;
mod measured;

use files::log::Log;
use init::Initial;
use model::machine::Machine;
use trace::Identification;

/// The machine file of logs of a machine of which this much is known.
fn initial(known: &Machine, logs: &[Log]) -> Initial {
    let initial = init::machine(known, logs, &|_| {}).unwrap();
    // What is written is a machine file.
    let text = init::written::file(&initial, &["a.csv".to_owned()]);
    assert_eq!(Machine::parse(&text, "init.toml").unwrap(), initial.machine, "{text}");
    initial
}

/// Asserts that a trace with an estimated file leaves at most 10 % more of each stage, on data not used in the fit, than one with the
/// true file. It cannot leave much less than the noise either.
fn leaves_no_more(name: &str, estimated: &Identification, declared: &Identification) {
    for (own, declared) in estimated.axes().iter().zip(declared.axes()) {
        assert_eq!(own.axis, declared.axis);
        for residual in &declared.residuals {
            let after = own.residual(residual.stage).unwrap().after.validate;
            let most = 1.1 * residual.after.validate;
            assert!(
                (0.7 * residual.noise..most).contains(&after),
                "{name} {} {:?}: {after}, with the true file {}",
                own.axis,
                residual.stage,
                residual.after.validate
            );
        }
    }
}
