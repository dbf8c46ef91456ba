//! The pins: what each is, and their set-up. The wiring table is in `docs/firmware.md`; alternate functions are those of DS12288.

use super::address::gpio;
use super::bus::Bus;
use crate::two_drives::switches::{Levels, Wiring};

/// A pull-up or pull-down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pull {
    None,
    Up,
    Down,
}

/// What a pin is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// For a converter.
    Analog,
    /// Input with a pull-down.
    Input,
    /// Output, first low or high.
    Output { high: bool },
    /// A device's, by its number.
    Device(u32, Pull),
}

/// A pin of a port.
#[derive(Clone, Copy, Debug)]
struct Pin {
    port: u32,
    number: u32,
    mode: Mode,
}

const fn pin(port: u32, number: u32, mode: Mode) -> Pin {
    Pin { port, number, mode }
}

/// Enable input of both stages, active high; and the brakes of all axes, high: open.
const ENABLE: Pin = pin(gpio::B, 14, Mode::Output { high: false });
const BRAKES: Pin = pin(gpio::D, 2, Mode::Output { high: false });

/// The fault light, which is between the pin and the supply: on when low.
const LIGHT: Pin = pin(gpio::C, 13, Mode::Output { high: true });

/// High for a negative force.
const DIRECTIONS: [Pin; 2] =
    [pin(gpio::C, 10, Mode::Output { high: false }), pin(gpio::C, 11, Mode::Output { high: false })];

/// Alternate functions of the encoders on TIM3, TIM4 and TIM5; of TIM8; of TIM1; of USART3; of FDCAN1.
const ENCODER: Mode = Mode::Device(2, Pull::Up);
const SCALE_Y: Mode = Mode::Device(4, Pull::Up);
const PWM: Mode = Mode::Device(6, Pull::None);
const BREAK: Mode = Mode::Device(6, Pull::Down);
const SERIAL: Mode = Mode::Device(7, Pull::None);
/// With the pull-up, a port without a cable receives nothing.
const RECEIVER: Mode = Mode::Device(7, Pull::Up);
const CAN: Mode = Mode::Device(9, Pull::None);

/// All but the enable and the brakes, which are first. Encoders have pull-ups: an open input does not float. With the pull-down of the stop
/// (PB12) a broken wire stops the drives.
const PINS: [Pin; 40] = [
    LIGHT,
    DIRECTIONS[0],
    DIRECTIONS[1],
    // Analogue outputs; resolvers of X and Y; bus voltage and temperature.
    pin(gpio::A, 4, Mode::Analog),
    pin(gpio::A, 5, Mode::Analog),
    pin(gpio::C, 2, Mode::Analog),
    pin(gpio::C, 3, Mode::Analog),
    pin(gpio::C, 0, Mode::Analog),
    pin(gpio::C, 1, Mode::Analog),
    pin(gpio::C, 4, Mode::Analog),
    pin(gpio::C, 5, Mode::Analog),
    pin(gpio::A, 8, PWM),
    pin(gpio::A, 9, PWM),
    pin(gpio::B, 12, BREAK),
    // Motor encoders, A, B and index.
    pin(gpio::A, 6, ENCODER),
    pin(gpio::A, 7, ENCODER),
    pin(gpio::B, 0, ENCODER),
    pin(gpio::B, 6, ENCODER),
    pin(gpio::B, 7, ENCODER),
    pin(gpio::B, 9, ENCODER),
    // Scales, A, B and index.
    pin(gpio::A, 0, ENCODER),
    pin(gpio::A, 1, ENCODER),
    pin(gpio::A, 2, ENCODER),
    pin(gpio::C, 6, SCALE_Y),
    pin(gpio::C, 7, SCALE_Y),
    pin(gpio::C, 8, SCALE_Y),
    // Switches and fault inputs, as in `WIRING`.
    pin(gpio::A, 3, Mode::Input),
    pin(gpio::A, 10, Mode::Input),
    pin(gpio::A, 15, Mode::Input),
    pin(gpio::B, 1, Mode::Input),
    pin(gpio::B, 2, Mode::Input),
    pin(gpio::B, 3, Mode::Input),
    pin(gpio::B, 4, Mode::Input),
    pin(gpio::B, 5, Mode::Input),
    pin(gpio::B, 13, Mode::Input),
    pin(gpio::B, 15, Mode::Input),
    pin(gpio::C, 9, Mode::Input),
    pin(gpio::C, 12, Mode::Input),
    pin(gpio::B, 10, SERIAL),
    pin(gpio::B, 11, RECEIVER),
];

/// Receiver and transmitter of CAN.
const CAN_PINS: [Pin; 2] = [pin(gpio::A, 11, CAN), pin(gpio::A, 12, CAN)];

/// The pins of the switches.
pub static WIRING: Wiring = Wiring {
    scale_signals: [1 << 3, 1 << 10],
    probe: 1 << 15,
    limits: [[1 << 1, 1 << 5], [1 << 4, 1 << 13]],
    drive_faults: [1 << 2, 1 << 3],
    stop: 1 << 12,
    enable_switch: 1 << 15,
    homes: [1 << 9, 1 << 12],
};

/// Makes enable and brakes outputs that are low.
pub fn set_up_outputs_of_drives(bus: impl Bus) {
    for pin in [ENABLE, BRAKES] {
        pin.set_up(bus);
    }
}

/// Sets up all other pins.
pub fn set_up(bus: impl Bus) {
    PINS.into_iter().chain(CAN_PINS).for_each(|pin| pin.set_up(bus));
}

/// Input data of the ports.
pub fn levels(bus: impl Bus) -> Levels {
    let input = |port| bus.read(port + gpio::IDR);
    Levels { a: input(gpio::A), b: input(gpio::B), c: input(gpio::C) }
}

/// Sets the direction pins.
pub fn set_directions(bus: impl Bus, reverse: [bool; 2]) {
    DIRECTIONS.into_iter().zip(reverse).for_each(|(pin, high)| pin.set(bus, high));
}

/// Sets the enable of the stages.
pub fn set_enable(bus: impl Bus, on: bool) {
    ENABLE.set(bus, on);
}

/// Opens or closes the brakes.
pub fn set_brakes_open(bus: impl Bus, open: bool) {
    BRAKES.set(bus, open);
}

/// Switches the fault light.
pub fn set_light(bus: impl Bus, lit: bool) {
    LIGHT.set(bus, !lit);
}

impl Pin {
    /// Sets or resets an output. No other pin changes.
    fn set(self, bus: impl Bus, high: bool) {
        bus.write(self.port + gpio::BSRR, 1 << (self.number + if high { 0 } else { 16 }));
    }

    /// Level, function and pull before the mode: no pin has another state in between.
    fn set_up(self, bus: impl Bus) {
        let (mode, pull) = match self.mode {
            Mode::Analog => (0b11, Pull::None),
            Mode::Input => (0b00, Pull::Down),
            Mode::Output { high } => {
                self.set(bus, high);
                (0b01, Pull::None)
            }
            Mode::Device(function, pull) => {
                let (register, place) = (gpio::AFRL + self.number / 8 * 4, self.number % 8 * 4);
                bus.set_field(self.port + register, 0b1111 << place, function << place);
                (0b10, pull)
            }
        };
        let pull = match pull {
            Pull::None => 0b00,
            Pull::Up => 0b01,
            Pull::Down => 0b10,
        };
        let place = 2 * self.number;
        bus.set_field(self.port + gpio::PUPDR, 0b11 << place, pull << place);
        bus.set_field(self.port + gpio::MODER, 0b11 << place, mode << place);
    }
}
