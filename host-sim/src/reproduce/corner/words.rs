//! What came out, in sentences, and what the print leaves open.

use super::{Corner, Experiment, Tuned};

pub(super) fn said(e: &Experiment) -> Vec<String> {
    let row = |t: &Tuned| {
        let c = |c: &Corner| {
            format!("{:.1}/{:.1}/{:.1}", c.overshoot_um(), c.motor_overshoot_um(), c.rounding_um())
        };
        format!(
            "{} printed {} without {} least {} {:?}",
            t.gain_per_s,
            c(&t.printed),
            c(&t.without),
            c(&t.least),
            t.kept
        )
    };
    e.hpc.iter().chain(&e.p).map(row).chain([format!("{:?}", e.mechanics)]).collect()
}

pub(super) fn notes(_experiment: &Experiment) -> Vec<String> {
    Vec::new()
}
