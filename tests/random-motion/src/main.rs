//! The digests of random motions ([`random_motion`]) of the controller in this build: one line for each motion.
//!
//! `random-motion FIRST COUNT TICKS`

use random_motion::{Motion, run};
use shared::lockstep::protocol::encode;
use shared::lockstep::session::{NoMeter, Session};
use shared::scalar::Format;

fn main() {
    let numbers: Vec<u64> = std::env::args().skip(1).filter_map(|number| number.parse().ok()).collect();
    let [first, count, ticks] = numbers[..] else {
        eprintln!("expected FIRST COUNT TICKS");
        std::process::exit(2);
    };
    let ticks = usize::try_from(ticks).expect("a number of ticks");
    for seed in first..first + count {
        for format in [Format::Fixed, Format::F32] {
            let mut session = Box::new(Session::NEW);
            let motion = Motion { seed, format, ticks, gain_error: 0.0 };
            let outcome = run(&motion, &mut |frame| {
                let answer = session.answer(frame, &mut NoMeter).expect("not the end");
                encode(&answer, frame).expect("an answer fits");
            });
            println!("{seed} {format:?} {:016x}", outcome.digests.last().expect("ticks"));
        }
    }
}
