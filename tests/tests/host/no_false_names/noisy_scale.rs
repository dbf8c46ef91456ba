//! A scale that is noisier than what the tool is displaced by: its noise is in the reading from which the tool is predicted, and in the
//! acceleration.

use files::log::Log;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use trace::Identification;

use super::machine::TestMachine;
use super::reported::{assert_value, beyond_tolerance, certain, context, found, named};

/// A machine with P control.
const P: u64 = 1;

/// The trace of a machine whose scales are logged with more noise of this standard deviation, µm, uniform.
fn with_noise(machine: &TestMachine, noise_um: f64) -> Identification {
    let mut random = ChaCha8Rng::seed_from_u64(25);
    machine.trace_of(|log: &mut Log| {
        let tables = log.axes.iter_mut().filter_map(|axis| axis.table.as_mut()).flatten();
        tables.for_each(|mm| *mm += 3.0_f64.sqrt() * 1e-3 * noise_um * random.random_range(-1.0..=1.0));
    })
}

/// Once: an in-talk of 0.4 ± 0.1 µm per m/s² on each axis, certain, that grew with the noise.
#[test]
fn noise_of_the_scale_is_no_intalk() {
    for noise_um in [0.4, 0.8, 1.6] {
        let trace = with_noise(&TestMachine::new(P), noise_um);
        assert_eq!((named(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
    }
}

/// Once: 0.99 ± 0.09 of 1.5 µm per m/s², certain: noise attenuates a coefficient of what it is in.
#[test]
fn noise_of_the_scale_does_not_attenuate_an_intalk() {
    let mut machine = TestMachine::new(P);
    machine.drawn.axes[0].intalk_s2 = 1.5e-6;
    let trace = with_noise(&machine, 0.8);
    assert_eq!(certain(&trace), [("x", "intalk")], "{}", context(&trace));
    assert_value(found(&trace, 0, "intalk"), "um_s2_per_m", 1.5, 0.1);
}
