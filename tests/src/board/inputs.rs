//! What stands at the pins of the board, by the number of the tick: the enable switch and the encoder of X.
//!
//! Each access halts the emulator, and its clock goes on meanwhile: TIM2 would find every tick late. So the first
//! tick stops its interrupts, and each tick, when it has read its inputs, pends the next one.

use firmware::setup::SWITCH_SETTLING_TICKS;

use super::Device;

/// Input data of port B; its bit 15 is the switch, high: closed.
const GPIOB_IDR: u32 = 0x4002_0410;
const SWITCH: u32 = 1 << 15;

/// Counters of TIM3 and TIM4, the encoders of X and Y.
const TIM3_CNT: u32 = 0x4000_0424;
const TIM4_CNT: u32 = 0x4000_0824;

/// The tick that first sees the switch closed, long enough after one that saw it open for the first time.
pub const CLOSED: u32 = SWITCH_SETTLING_TICKS + 50;

/// The tick that first sees X pushed, when the drives are on.
pub const PUSHED: u32 = CLOSED + SWITCH_SETTLING_TICKS + 50;

/// X is pushed so many counts, one a tick: 5 mm/s.
pub const COUNTS: u32 = 20;

/// Interrupts of TIM2, and those that are to be pended by hand (RM0090, 18.4.4; ARMv7-M, B3.4.6).
const TIM2_DIER: u32 = 0x4000_000c;
const NVIC_ISPR0: u32 = 0xe000_e200;
const TIM2_PENDING: u32 = 1 << 28;

/// The pins.
#[derive(Default)]
pub struct Inputs {
    /// Ticks that have looked at the switch: each does once, before the encoders.
    ticks: u32,
    /// What the core has to store before it goes on: address and value.
    stores: Vec<(u32, u32)>,
}

impl Inputs {
    /// What the core has to store before it goes on.
    pub fn stores(&mut self) -> Vec<(u32, u32)> {
        std::mem::take(&mut self.stores)
    }
}

impl Device for Inputs {
    fn registers(&self) -> &[u32] {
        &[GPIOB_IDR, TIM3_CNT, TIM4_CNT]
    }

    fn read(&mut self, address: u32) -> u32 {
        match address {
            GPIOB_IDR => {
                self.ticks += 1;
                let first = self.ticks == 1;
                self.stores.extend(first.then_some((TIM2_DIER, 0)));
                if self.ticks < CLOSED { 0 } else { SWITCH }
            }
            TIM3_CNT => self.ticks.saturating_sub(PUSHED).min(COUNTS),
            TIM4_CNT => {
                // The start reads it once, too.
                self.stores.extend((self.ticks > 0).then_some((NVIC_ISPR0, TIM2_PENDING)));
                0
            }
            _ => panic!("{address:#x} is not watched"),
        }
    }

    fn write(&mut self, address: u32, value: u32) {
        match address {
            // The start of an encoder may clear its counter.
            TIM3_CNT | TIM4_CNT => assert_eq!(value, 0, "to the counter {address:#x}"),
            _ => panic!("{value:#x} to the input {address:#x}"),
        }
    }
}
