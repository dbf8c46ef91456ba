//! The bytes of the bench: what a person does at the machine.

use crate::bench::Inputs;

/// The byte that ends the emulator.
pub const END: u8 = b'q';

/// Operates an input. Returns whether the byte means one.
///
/// | byte | input |
/// |---|---|
/// | `c`, `o` | closes, opens the enable switch |
/// | `e`, `r` | presses, releases the emergency stop |
/// | `f`, `t` | freezes the encoder of the x motor, thaws it |
/// | `l`, `g` | loses the signal of the x scale, gives it back |
pub fn operate(inputs: &mut Inputs, byte: u8) -> bool {
    let (input, on) = match byte {
        b'c' => (&mut inputs.enable_switch, true),
        b'o' => (&mut inputs.enable_switch, false),
        b'e' => (&mut inputs.emergency_stop, true),
        b'r' => (&mut inputs.emergency_stop, false),
        b'f' => (&mut inputs.x_encoder_frozen, true),
        b't' => (&mut inputs.x_encoder_frozen, false),
        b'l' => (&mut inputs.x_scale_lost, true),
        b'g' => (&mut inputs.x_scale_lost, false),
        _ => return false,
    };
    *input = on;
    true
}
