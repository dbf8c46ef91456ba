//! Any frames at the lock-step protocol: no panic, and without an order `Enable` no force.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::config::{AxisSettings, Rates};
use shared::lockstep::protocol::{Answer, FRAME, Order, Setup, decode, encode};
use shared::lockstep::session::{NoMeter, Session};
use shared::scalar::Format;
use shared::units::Position;

// An input is a number format, then frames: each with its length, and ticks between them.
fuzz_target!(|data: &[u8]| {
    let Some((format, mut rest)) = data.split_first() else { return };
    let format = [Format::Fixed, Format::F32, Format::F64][usize::from(format % 3)];
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
    let setup = Setup { format, rates, axes: [AxisSettings::default(); 2], start: [Position(0); 2] };
    let mut session = Box::new(Session::NEW);
    let mut frame = [0; FRAME];
    encode(&Order::Setup(setup), &mut frame).expect("it fits");
    assert_eq!(session.answer(&frame, &mut NoMeter), Some(Answer::Ready));
    // Parts of an order may hide an enable.
    let mut enabled = false;
    while let Some((length, bytes)) = rest.split_first() {
        let (bytes, behind) = bytes.split_at(usize::from(*length).min(bytes.len()));
        rest = behind;
        frame.fill(0);
        frame[..bytes.len()].copy_from_slice(bytes);
        enabled |= matches!(decode::<Order>(&frame), Ok(Order::Enable | Order::Part(_)));
        let Some(answer) = session.answer(&frame, &mut NoMeter) else { return };
        if let Answer::Tick(result) = answer {
            assert!(
                enabled || !result.power.is_on() && result.force_bits == [0; 2],
                "a force without an enable"
            );
        }
    }
});
