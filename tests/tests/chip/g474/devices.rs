//! What becomes ready after what, what is protected, and what the hardware does by itself: clocks, counters, converters, watchdog and CAN of the
//! model (RM0440).

use super::model::{ADCS, CAN, COUNTERS, FLASH_REGISTERS, IWDG, PWR, RCC, State, TIM2};

impl State {
    /// Chapters 7, 6 and 3.
    pub(super) fn clock(&mut self, address: u32, value: u32, before: u32) {
        match address - RCC {
            0x00 => {
                let started = value & !before;
                self.words.insert(address, value & !(1 << 17 | 1 << 25) | before & (1 << 17 | 1 << 25));
                if started & 1 << 16 != 0 {
                    self.change_later(address, 1 << 17);
                }
                if started & 1 << 24 != 0 {
                    let pll = self.word(RCC + 0x0c);
                    assert!(pll & 0b11 == 3 && before & 1 << 17 != 0, "the PLL without the crystal");
                    let input = 8_000_000 / (1 + (pll >> 4 & 0b1111));
                    let [times, divider] = [pll >> 8 & 0x7f, 2 * (1 + (pll >> 25 & 0b11))];
                    assert!((2_660_000..=16_000_000).contains(&input) && pll & 1 << 24 != 0);
                    assert_eq!(input * times / divider, 170_000_000);
                    self.change_later(address, 1 << 25);
                }
            }
            0x08 => {
                self.words.insert(address, value & !(0b11 << 2) | before & (0b11 << 2));
                if value & 0b11 != before & 0b11 {
                    assert_eq!(value & 0b11, 3);
                    assert!(self.word(RCC) & 1 << 25 != 0, "the PLL is not ready");
                    assert_eq!(value >> 4 & 0b1111, 0b1000, "the core is not halved");
                    assert_eq!(self.word(PWR + 0x80) & 1 << 8, 0, "without the boost");
                    assert!(self.word(FLASH_REGISTERS) & 0b1111 >= 4, "too few wait states");
                    self.waited_us = 0;
                    self.change_later(address, (before ^ 0b11 << 2) & 0b11 << 2);
                } else if before & 0b11 == 3 && value & 1 << 7 == 0 {
                    assert!(self.waited_us >= 1, "chapter 6: a microsecond before the whole core");
                }
            }
            _ => {}
        }
    }

    /// The update of TIM2. Chapter 29: if it is the trigger output (MMS 010), it is ITR1 of the counters, which capture their count in the channels that
    /// are on and are inputs of the trigger (`CCxS` 11), with ITR1 selected (TS 001).
    pub(super) fn latch_counters(&mut self) {
        if self.word(TIM2 + 0x04) >> 4 & 0b111 != 0b010 {
            return;
        }
        for timer in COUNTERS {
            let triggered = self.word(timer + 0x08) >> 4 & 0b111 == 1;
            for (channel, source) in [(2, 0), (3, 8)] {
                let is_input = self.word(timer + 0x1c) >> source & 0b11 == 0b11;
                let is_on = self.word(timer + 0x20) >> (4 * channel) & 1 == 1;
                if triggered && is_input && is_on {
                    let count = self.word(timer + 0x24);
                    self.words.insert(timer + 0x34 + 4 * channel, count);
                }
            }
        }
    }

    /// Chapter 21.
    pub(super) fn converter(&mut self, address: u32, value: u32, before: u32) {
        let device = address & !0xff;
        if !ADCS.contains(&device) {
            return;
        }
        match address & 0xff {
            0x08 => {
                let [on, calibrate] = [value & 1 != 0, value & 1 << 31 != 0];
                if value & 1 << 28 != 0 && before & 1 << 28 == 0 {
                    assert_eq!(before & 1 << 29, 0, "in deep power-down");
                    self.waited_us = 0;
                }
                if calibrate || on {
                    assert!(before & 1 << 28 != 0 && self.waited_us >= 20, "the regulator is not ready");
                }
                if calibrate {
                    assert!(!on, "calibrated while on");
                    self.change_later(address, 1 << 31);
                }
                if on && before & 1 == 0 {
                    assert_eq!(before & 1 << 31, 0, "it is being calibrated");
                    self.change_later(device, 1);
                }
                if value & 1 << 3 != 0 {
                    assert!(self.word(device) & 1 != 0, "started before it is ready");
                }
            }
            // Chapter 21: a one clears.
            0x00 => {
                self.words.insert(address, before & !value);
            }
            0x14 | 0x18 | 0x4c => {
                assert_eq!(self.word(device + 8) & 1 << 3, 0, "changed while conversions are running");
            }
            _ => {}
        }
    }

    /// Chapter 42.
    pub(super) fn watchdog(&mut self, address: u32, value: u32, before: u32) {
        match address - IWDG {
            0x00 => self.watchdog_is_open = value == 0x5555,
            0x04 | 0x08 => {
                assert!(self.watchdog_is_open, "protected");
                if value != before {
                    self.words.insert(IWDG + 0x0c, 0b11);
                    self.change_later(IWDG + 0x0c, 0b11);
                }
            }
            _ => {}
        }
    }

    /// Chapter 44: initialisation, change of the configuration.
    pub(super) fn can_register(&mut self, address: u32, value: u32, before: u32) {
        let control = self.word(CAN + 0x18);
        match address - CAN {
            0x18 => {
                assert!(value & 0b10 == 0 || before & 1 != 0, "CCE without INIT");
                let protected = 1 << 8 | 1 << 9;
                assert!(
                    (value ^ before) & protected == 0 || before & 0b11 == 0b11,
                    "a protected bit: {value:#x}"
                );
                self.can.is_on_bus = value & 1 == 0;
            }
            0x0c | 0x1c | 0x48 | 0x80 => assert_eq!(control & 0b11, 0b11, "{address:#x} is protected"),
            // A one clears.
            0x50 => {
                self.words.insert(address, before & !value);
            }
            0x94 => self.can.release(value),
            0xcc => self.can.send(value),
            _ => {}
        }
    }
}
