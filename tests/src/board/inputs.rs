//! A model of the inputs of the board as a function of the tick: the enable switch, the encoder of X and both scales, closed safety
//! contacts, scales with a signal, home switches, and a supply within its limits.
//!
//! Each access halts the emulator while its clock runs on, so that every tick of TIM2 would be late. Therefore the
//! first tick disables its interrupt, and the test pends the next one when the idle loop has run for some time after the
//! inputs were read.

use firmware::setup::SWITCH_SETTLING_TICKS;

use super::device::Device;

/// Input data of port B; bit 15 is the switch, high: closed.
const GPIOB_IDR: u32 = 0x4002_0410;
const SWITCH: u32 = 1 << 15;

/// Limit switches (1, 5, 9, 13), drive faults (2, 3) and stop (12), high: closed, not active.
const SAFETY_CONTACTS: u32 = 1 << 1 | 1 << 5 | 1 << 9 | 1 << 13 | 1 << 2 | 1 << 3 | 1 << 12;

/// Input data of ports A and C (8.4.5): the signals of the scales of X and Y, high: present; the home switches, high: active.
const GPIOA_IDR: u32 = 0x4002_0010;
const GPIOC_IDR: u32 = 0x4002_0810;
const SCALE_SIGNALS: u32 = 1 << 3 | 1 << 10;

/// Third injected results of ADC1 and ADC2: bus voltage and temperature (RM0090, 13.13.14).
const ADC1_JDR3: u32 = 0x4001_2044;
const ADC2_JDR3: u32 = 0x4001_2144;

/// Control and status of the supply of the chip (5.4.2); bit 2: below the level of the detector.
const PWR_CSR: u32 = 0x4000_7004;
const IS_LOW: u32 = 1 << 2;

/// Counters of TIM3 and TIM4, the encoders of X and Y, and of TIM5 and TIM8, the scales of X and Y.
const COUNTERS: [u32; 4] = [0x4000_0424, 0x4000_0824, 0x4000_0c24, 0x4001_0424];
/// Their captures of channel 4, at the start of a tick.
const TIM3_CCR4: u32 = 0x4000_0440;
const TIM4_CCR4: u32 = 0x4000_0840;
const TIM5_CCR4: u32 = 0x4000_0c40;
const TIM8_CCR4: u32 = 0x4001_0440;

/// Counts by which the tables of X and Y are displaced when X is.
pub const SCALE_COUNTS: [u32; 2] = [40, 90];

/// Status of TIM3, TIM5, TIM4 and TIM8 (18.4.5): whether an index was captured, of the motor and the scale of X, then of Y.
pub const INDEX_STATUS: [u32; 4] = [0x4000_0410, 0x4000_0c10, 0x4000_0810, 0x4001_0410];

/// First tick with the switch closed: the switch has been open for longer than its settling time.
pub const CLOSED: u32 = SWITCH_SETTLING_TICKS + 50;

/// First tick in which the switch permits an enable by a host.
pub const ARMED: u32 = CLOSED + SWITCH_SETTLING_TICKS;

/// First tick with X displaced; the drives are on.
pub const PUSHED: u32 = ARMED + 200;

/// Counts by which X is displaced, one a tick: 5 mm/s.
pub const COUNTS: u32 = 20;

/// Interrupt enable of TIM2, and set-pending register of the interrupt controller (RM0090, 18.4.4; ARMv7-M, B3.4.6).
const TIM2_DIER: u32 = 0x4000_000c;
const NVIC_ISPR0: u32 = 0xe000_e200;
const TIM2_PENDING: u32 = 1 << 28;

/// The store that pends a tick.
pub(super) const PEND_TICK: (u32, u32) = (NVIC_ISPR0, TIM2_PENDING);

/// Counter of the cycles of the core (ARMv7-M, C1.8.8), which each tick reads at its start.
const CYCLE_COUNT: u32 = 0xe000_1004;

/// Cycles in a tick: 168 MHz / 20 kHz.
const CYCLES_PER_TICK: u32 = 8400;

/// Supply of the power stages, V, and their temperature, °C.
#[derive(Clone, Copy)]
pub struct SupplyInputs {
    /// Bus voltage.
    pub bus_v: f64,
    /// Temperature.
    pub temperature_c: f64,
}

impl Default for SupplyInputs {
    /// Within the limits.
    fn default() -> Self {
        Self { bus_v: 48.0, temperature_c: 25.0 }
    }
}

/// The inputs.
#[derive(Default)]
pub struct Inputs {
    /// The supply.
    pub supply: SupplyInputs,
    /// Number of ticks so far: each reads the switch once, before the encoders.
    ticks: u32,
    /// Pending stores of the core: address and value.
    stores: Vec<(u32, u32)>,
    /// Whether a tick has read its inputs, and the next one was not pended yet.
    ticked: bool,
    /// Safety contacts that are open: bits of port B.
    pub open: u32,
    /// Interrupts of ticks that are lost before the next tick.
    pub lost: u32,
    /// Cycles of the core.
    cycles: u32,
    /// Home switches that are active: bits of port C.
    pub home: u32,
    /// Scales without a signal: bits of port A.
    pub no_signal: u32,
    /// The contact of the probe, if it is closed: a bit of port A.
    pub probe: u32,
    /// Whether the supply of the chip is low.
    pub low_supply: bool,
    /// The registers of [`INDEX_STATUS`] that were read, in order.
    pub index_reads: Vec<u32>,
}

/// Counts of a converter.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4095")]
fn counts(exact: f64) -> u32 {
    exact.round().clamp(0.0, 4095.0) as u32
}

impl Inputs {
    const fn scale_counts(&self, axis: usize) -> u32 {
        if self.ticks > PUSHED { SCALE_COUNTS[axis] } else { 0 }
    }

    /// The store that pends the next tick, if one has read its inputs.
    pub fn next_tick(&mut self) -> Option<(u32, u32)> {
        std::mem::take(&mut self.ticked).then_some(PEND_TICK)
    }

    /// Takes the stores that the core has to execute before it continues: address and value.
    pub fn stores(&mut self) -> Vec<(u32, u32)> {
        std::mem::take(&mut self.stores)
    }
}

impl Device for Inputs {
    fn registers(&self) -> &[u32] {
        &[
            GPIOA_IDR,
            GPIOB_IDR,
            GPIOC_IDR,
            COUNTERS[0],
            COUNTERS[1],
            COUNTERS[2],
            COUNTERS[3],
            TIM3_CCR4,
            TIM4_CCR4,
            TIM5_CCR4,
            TIM8_CCR4,
            CYCLE_COUNT,
            ADC1_JDR3,
            ADC2_JDR3,
            PWR_CSR,
            INDEX_STATUS[0],
            INDEX_STATUS[1],
            INDEX_STATUS[2],
            INDEX_STATUS[3],
        ]
    }

    fn read(&mut self, address: u32) -> u32 {
        match address {
            GPIOB_IDR => {
                self.ticks += 1;
                let first = self.ticks == 1;
                self.stores.extend(first.then_some((TIM2_DIER, 0)));
                SAFETY_CONTACTS & !self.open | if self.ticks < CLOSED { 0 } else { SWITCH }
            }
            CYCLE_COUNT => {
                let ticks = 1 + std::mem::take(&mut self.lost);
                self.cycles = self.cycles.wrapping_add(ticks * CYCLES_PER_TICK);
                self.cycles
            }
            // A tick is delayed by the server: it reads what was latched at its start. The start-up reads the counters.
            address if COUNTERS.contains(&address) => {
                assert_eq!(self.ticks, 0, "a tick reads the counter {address:#x}");
                0
            }
            TIM3_CCR4 => self.ticks.saturating_sub(PUSHED).min(COUNTS),
            TIM4_CCR4 => {
                self.ticked = true;
                0
            }
            GPIOA_IDR => SCALE_SIGNALS & !self.no_signal | self.probe,
            GPIOC_IDR => self.home,
            PWR_CSR => u32::from(self.low_supply) * IS_LOW,
            TIM5_CCR4 => self.scale_counts(0),
            TIM8_CCR4 => self.scale_counts(1),
            address if INDEX_STATUS.contains(&address) => {
                self.index_reads.push(address);
                0
            }
            // Behind 100 kΩ and 4.7 kΩ; 10 mV/K and 500 mV at 0 °C. 4096 counts are 3.3 V.
            ADC1_JDR3 => counts(self.supply.bus_v * 4.7 / (100.0 + 4.7) * 4096.0 / 3.3),
            ADC2_JDR3 => counts((0.5 + 0.01 * self.supply.temperature_c) * 4096.0 / 3.3),
            _ => panic!("{address:#x} is not watched"),
        }
    }

    fn write(&mut self, address: u32, value: u32) {
        match address {
            // The start-up of an encoder may clear its counter.
            address if COUNTERS.contains(&address) => assert_eq!(value, 0, "to the counter {address:#x}"),
            _ => panic!("{value:#x} to the input {address:#x}"),
        }
    }
}
