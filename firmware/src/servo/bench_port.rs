//! The bytes of the bench: what a person does at the machine.

use crate::bench::{MASTER_TURN, OperatorInputs};

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
/// | `w`, `n` | the x motor has cogging, has none |
/// | `v`, `h` | y is vertical with a brake, horizontal |
/// | `a`, `d` | puts 3 kg on the table of y, takes them away |
/// | `b`, `u` | puts a hard stop before x, takes it away |
/// | `p`, `x` | puts a workpiece before the probe of x, takes it away |
/// | `B`, `U` | puts a beam on the tables of x and the last axis, with skew; takes it away |
/// | `D`, `R` | gives the last table more friction than its drive has force, takes it away |
/// | `j`, `z` | turns the master at the counter of x forwards, back by a turn |
/// | `s`, `i` | makes the next tick with the stages on slow, holds off the interrupts of the ticks |
pub fn operate(operator_inputs: &mut OperatorInputs, byte: u8) -> bool {
    let turns = &mut operator_inputs.master_counts;
    match byte {
        b'j' => *turns = turns.saturating_add(MASTER_TURN),
        b'z' => *turns = turns.saturating_sub(MASTER_TURN),
        _ => return operate_switch(operator_inputs, byte),
    }
    true
}

/// Operates an input that is on or off.
fn operate_switch(operator_inputs: &mut OperatorInputs, byte: u8) -> bool {
    let (input, on) = match byte {
        b'c' => (&mut operator_inputs.enable_switch, true),
        b'o' => (&mut operator_inputs.enable_switch, false),
        b'e' => (&mut operator_inputs.emergency_stop, true),
        b'r' => (&mut operator_inputs.emergency_stop, false),
        b'f' => (&mut operator_inputs.x_frozen.encoder, true),
        b't' => (&mut operator_inputs.x_frozen.encoder, false),
        b'k' => (&mut operator_inputs.x_frozen.scale, true),
        b'm' => (&mut operator_inputs.x_frozen.scale, false),
        b'l' => (&mut operator_inputs.x_scale_lost, true),
        b'g' => (&mut operator_inputs.x_scale_lost, false),
        b'w' => (&mut operator_inputs.x_cogging, true),
        b'n' => (&mut operator_inputs.x_cogging, false),
        b'v' => (&mut operator_inputs.y_vertical, true),
        b'h' => (&mut operator_inputs.y_vertical, false),
        b'a' => (&mut operator_inputs.y_loaded, true),
        b'd' => (&mut operator_inputs.y_loaded, false),
        b'b' => (&mut operator_inputs.x_stop, true),
        b'u' => (&mut operator_inputs.x_stop, false),
        b'p' => (&mut operator_inputs.x_workpiece, true),
        b'x' => (&mut operator_inputs.x_workpiece, false),
        b'B' => (&mut operator_inputs.beam, true),
        b'U' => (&mut operator_inputs.beam, false),
        b'D' => (&mut operator_inputs.last_dragged, true),
        b'R' => (&mut operator_inputs.last_dragged, false),
        b's' => (&mut operator_inputs.slow_tick, true),
        b'i' => (&mut operator_inputs.held_off, true),
        _ => return false,
    };
    *input = on;
    true
}
