//! The bytes of the bench: what a person does at the machine.

use crate::bench::Hands;

/// The byte that ends the emulator.
pub const END: u8 = b'q';

/// Operates an input. Returns whether the byte means one.
///
/// | byte | input |
/// |---|---|
/// | `c`, `o` | closes, opens the enable switch |
/// | `e`, `r` | presses, releases the emergency stop |
/// | `f`, `t` | freezes the encoder of the x motor, thaws it |
/// | `k`, `m` | freezes the x scale, thaws it |
/// | `l`, `g` | loses the signal of the x scale, gives it back |
pub fn operate(hands: &mut Hands, byte: u8) -> bool {
    let (input, on) = match byte {
        b'c' => (&mut hands.enable_switch, true),
        b'o' => (&mut hands.enable_switch, false),
        b'e' => (&mut hands.emergency_stop, true),
        b'r' => (&mut hands.emergency_stop, false),
        b'f' => (&mut hands.x_frozen.encoder, true),
        b't' => (&mut hands.x_frozen.encoder, false),
        b'k' => (&mut hands.x_frozen.scale, true),
        b'm' => (&mut hands.x_frozen.scale, false),
        b'l' => (&mut hands.x_scale_lost, true),
        b'g' => (&mut hands.x_scale_lost, false),
        _ => return false,
    };
    *input = on;
    true
}
