//! Random motions ([`tests::random_motion`]) are the same to the last bit on the host, optimised and not, and on the emulated
//! core, in fixed point and f32.
//!
//! The long form, `cargo test --release --test chip random_motions:: -- --ignored`, has a million ticks for each format.

use std::path::Path;
use std::process::Command;

use lockstep::emulator::{DEFAULT_TIMEOUT, Emulator};
use lockstep::remote::Connection;
use random_motion::{Motion, Outcome, faults, run};
use shared::lockstep::protocol::encode;
use shared::lockstep::session::{NoMeter, Session};
use shared::scalar::Format;

/// Number of motions, and the ticks of each. Their seeds are 1, 2 and so on.
const MOTIONS: u64 = 200;
const TICKS: usize = 1000;

/// Motions that are also run without optimisation.
const UNOPTIMISED: u64 = 40;

fn on_host(motion: &Motion) -> Outcome {
    let mut session = Box::new(Session::NEW);
    run(motion, &mut |frame| {
        let answer = session.answer(frame, &mut NoMeter).unwrap();
        encode(&answer, frame).unwrap();
    })
}

fn core() -> Emulator {
    Emulator::start(&tests::firmware::built("emulated"), DEFAULT_TIMEOUT).unwrap()
}

/// Runs a motion on both and compares every tick.
fn compare(core: &mut Emulator, motion: &Motion) -> Outcome {
    let host = on_host(motion);
    let chip = run(motion, &mut |frame| core.exchange(frame).unwrap());
    let different = host.digests.iter().zip(&chip.digests).position(|(host, chip)| host != chip);
    assert_eq!(different, None, "{motion:?}: first different tick");
    assert_eq!(host, chip);
    host
}

/// The motions show what they are for: each fault, the drives on most of the time, forces at their limit, scales without a signal,
/// and faults that the controller has found by itself.
fn assert_covers(outcomes: &[Outcome], ticks: usize) {
    let sum = |of: fn(&Outcome) -> usize| outcomes.iter().map(of).sum::<usize>();
    let (all, on) = (outcomes.len() * ticks, sum(|outcome| outcome.on));
    let (saturated, without_scale) = (sum(|outcome| outcome.saturated), sum(|outcome| outcome.without_scale));
    let orders: [usize; 9] = std::array::from_fn(|k| outcomes.iter().map(|outcome| outcome.orders[k]).sum());
    let mut detected: Vec<&str> =
        outcomes.iter().flat_map(|outcome| &outcome.detected).map(String::as_str).collect();
    detected.sort_unstable();
    detected.dedup();
    println!(
        "{} motions of {ticks} ticks: {on} with the drives on, {saturated} at a force limit, {without_scale} without a scale; \
         detected: {detected:?}; switches, changes, holds, resumes, stops, disables, enables, blocks, overrides: {orders:?}",
        outcomes.len()
    );
    assert!(2 * on > all && 100 * saturated > all && 20 * without_scale > all);
    for kind in ["FollowingError", "Disagreement", "EncoderStep", "ForceSaturated"] {
        assert!(detected.contains(&kind), "{kind} was not detected: {detected:?}");
    }
    for number in 0..faults().len() {
        let injected = outcomes.iter().any(|outcome| outcome.injected.contains(&number));
        assert!(injected, "{:?} was not injected with the drives on", faults()[number]);
    }
    // At least two of each in a motion.
    assert!(orders.iter().all(|count| *count > 2 * outcomes.len()), "{orders:?}");
}

fn same_on_host_and_core(format: Format) {
    let mut core = core();
    let motions = (1..=MOTIONS).map(|seed| Motion { seed, format, ticks: TICKS, gain_error: 0.0 });
    let outcomes: Vec<Outcome> = motions.map(|motion| compare(&mut core, &motion)).collect();
    assert_covers(&outcomes, TICKS);
}

#[test]
fn random_motions_in_fixed_point_are_the_same_on_host_and_core() {
    same_on_host_and_core(Format::Fixed);
}

#[test]
fn random_motions_in_f32_are_the_same_on_host_and_core() {
    same_on_host_and_core(Format::F32);
}

/// A million ticks for each format, in motions of 50,000 ticks.
#[test]
#[ignore = "long: tests/deep.sh bits"]
fn a_million_ticks_are_the_same_on_host_and_core() {
    for format in [Format::Fixed, Format::F32] {
        let mut core = core();
        for seed in 1000..1020 {
            let outcome = compare(&mut core, &Motion { seed, format, ticks: 50_000, gain_error: 0.0 });
            assert!(outcome.on > 25_000, "{seed}: {} ticks with the drives on", outcome.on);
        }
    }
}

/// Without optimisation, with checks of every overflow, the digests are those of this build.
#[test]
fn random_motions_are_the_same_without_optimisation() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let arguments = [1.to_string(), UNOPTIMISED.to_string(), TICKS.to_string()];
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--package", "random-motion", "--profile", "unoptimised", "--"])
        .args(&arguments)
        .current_dir(workspace)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = String::from_utf8(output.stdout).unwrap();
    assert_eq!(found.lines().count() as u64, 2 * UNOPTIMISED);
    for line in found.lines() {
        let [seed, format, digest] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        let format = if format == "Fixed" { Format::Fixed } else { Format::F32 };
        let motion = Motion { seed: seed.parse().unwrap(), format, ticks: TICKS, gain_error: 0.0 };
        assert_eq!(format!("{:016x}", on_host(&motion).digests.last().unwrap()), digest, "{line}");
    }
}

/// Negative control: a velocity gain that differs by 2⁻²⁰ is noticed, in every motion in which the drives come on.
#[test]
fn a_gain_that_differs_by_a_millionth_is_noticed() {
    for format in [Format::Fixed, Format::F32] {
        let (mut noticed, mut moved) = (0, 0);
        for seed in 1..=50 {
            let exact = Motion { seed, format, ticks: TICKS, gain_error: 0.0 };
            let outcome = on_host(&exact);
            moved += usize::from(outcome.on > 100);
            let different = on_host(&Motion { gain_error: 2f64.powi(-20), ..exact });
            noticed += usize::from(outcome.on > 100 && different.digests != outcome.digests);
        }
        assert!(moved >= 45 && noticed == moved, "{format:?}: {noticed} of {moved}");
    }
}
