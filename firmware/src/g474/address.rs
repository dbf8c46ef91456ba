//! Addresses of the registers (RM0440, chapter 2 and the register maps at the end of each chapter).

/// Ports A to D of the pins (chapter 9).
pub mod gpio {
    /// Port A.
    pub const A: u32 = 0x4800_0000;
    /// Port B.
    pub const B: u32 = 0x4800_0400;
    /// Port C.
    pub const C: u32 = 0x4800_0800;
    /// Port D.
    pub const D: u32 = 0x4800_0c00;
    /// Modes, two bits a pin.
    pub const MODER: u32 = 0x00;
    /// Pull-ups and pull-downs, two bits a pin.
    pub const PUPDR: u32 = 0x0c;
    /// Input data.
    pub const IDR: u32 = 0x10;
    /// Sets (low half) and resets (high half) outputs.
    pub const BSRR: u32 = 0x18;
    /// Alternate functions of pins 0 to 7, four bits a pin.
    pub const AFRL: u32 = 0x20;
}

/// Reset and clock control (chapter 7).
pub mod rcc {
    const BASE: u32 = 0x4002_1000;
    /// Clock control.
    pub const CR: u32 = BASE;
    /// Clock configuration.
    pub const CFGR: u32 = BASE + 0x08;
    /// PLL configuration.
    pub const PLLCFGR: u32 = BASE + 0x0c;
    /// Flags of clock interrupts.
    pub const CIFR: u32 = BASE + 0x1c;
    /// Resets of the devices of AHB2. The enables of a bus are 0x20 above its resets.
    pub const AHB2RSTR: u32 = BASE + 0x2c;
    /// Resets of APB1.
    pub const APB1RSTR1: u32 = BASE + 0x38;
    /// Resets of APB2.
    pub const APB2RSTR: u32 = BASE + 0x40;
    /// From a reset register to the enable register with the same bits.
    pub const TO_ENABLE: u32 = 0x20;
    /// Clock sources of devices.
    pub const CCIPR: u32 = BASE + 0x88;
    /// Cause of the last reset.
    pub const CSR: u32 = BASE + 0x94;
}

/// Power control (chapter 6).
pub mod pwr {
    const BASE: u32 = 0x4000_7000;
    /// Voltage detector.
    pub const CR2: u32 = BASE + 0x04;
    /// Pull-downs of USB Type-C.
    pub const CR3: u32 = BASE + 0x08;
    /// Status.
    pub const SR2: u32 = BASE + 0x14;
    /// Boost of the core.
    pub const CR5: u32 = BASE + 0x80;
}

/// Flash interface (chapter 3).
pub mod flash {
    const BASE: u32 = 0x4002_2000;
    /// Wait states and caches.
    pub const ACR: u32 = BASE;
    /// Keys.
    pub const KEYR: u32 = BASE + 0x08;
    /// Errors and busy.
    pub const SR: u32 = BASE + 0x10;
    /// What an access does.
    pub const CR: u32 = BASE + 0x14;
    /// Errors of the check bits.
    pub const ECCR: u32 = BASE + 0x18;
    /// Option bits.
    pub const OPTR: u32 = BASE + 0x20;
}

/// System configuration (chapter 10).
pub mod syscfg {
    /// What stops the timers.
    pub const CFGR2: u32 = 0x4001_0000 + 0x1c;
}

/// Timers (chapters 28 and 29): addresses of the devices, and offsets of the registers.
pub mod tim {
    /// PWM.
    pub const TIM1: u32 = 0x4001_2c00;
    /// Ticks.
    pub const TIM2: u32 = 0x4000_0000;
    /// Motor encoder of X.
    pub const TIM3: u32 = 0x4000_0400;
    /// Motor encoder of Y.
    pub const TIM4: u32 = 0x4000_0800;
    /// Scale of X.
    pub const TIM5: u32 = 0x4000_0c00;
    /// Scale of Y.
    pub const TIM8: u32 = 0x4001_3400;
    /// Control 1.
    pub const CR1: u32 = 0x00;
    /// Control 2.
    pub const CR2: u32 = 0x04;
    /// Slave mode.
    pub const SMCR: u32 = 0x08;
    /// Interrupts.
    pub const DIER: u32 = 0x0c;
    /// Status.
    pub const SR: u32 = 0x10;
    /// Events.
    pub const EGR: u32 = 0x14;
    /// Channels 1 and 2.
    pub const CCMR1: u32 = 0x18;
    /// Channels 3 and 4.
    pub const CCMR2: u32 = 0x1c;
    /// Enables of the channels.
    pub const CCER: u32 = 0x20;
    /// Counter.
    pub const CNT: u32 = 0x24;
    /// Period.
    pub const ARR: u32 = 0x2c;
    /// Compare or captured value of channel 1; the others follow.
    pub const CCR1: u32 = 0x34;
    /// Break.
    pub const BDTR: u32 = 0x44;
}

/// Converters (chapter 21): addresses of the devices, and offsets of the registers.
pub mod adc {
    /// Sines.
    pub const ADC1: u32 = 0x5000_0000;
    /// Cosines and the supply.
    pub const ADC2: u32 = 0x5000_0100;
    /// Clock of both.
    pub const CCR: u32 = 0x5000_0308;
    /// Status.
    pub const ISR: u32 = 0x00;
    /// Control.
    pub const CR: u32 = 0x08;
    /// Sample times of channels 0 to 9.
    pub const SMPR1: u32 = 0x14;
    /// Sample times of channels 10 to 18.
    pub const SMPR2: u32 = 0x18;
    /// Injected sequence and trigger.
    pub const JSQR: u32 = 0x4c;
    /// First result; the others follow.
    pub const JDR1: u32 = 0x80;
}

/// Digital-to-analogue converter (chapter 22).
pub mod dac {
    const BASE: u32 = 0x5000_0800;
    /// Control.
    pub const CR: u32 = BASE;
    /// Counts of channel 1.
    pub const DHR12R1: u32 = BASE + 0x08;
    /// Counts of channel 2.
    pub const DHR12R2: u32 = BASE + 0x14;
    /// Modes.
    pub const MCR: u32 = BASE + 0x3c;
}

/// Serial port (chapter 37).
pub mod usart3 {
    const BASE: u32 = 0x4000_4800;
    /// Control 1.
    pub const CR1: u32 = BASE;
    /// Divider.
    pub const BRR: u32 = BASE + 0x0c;
    /// Status.
    pub const ISR: u32 = BASE + 0x1c;
    /// Clears flags.
    pub const ICR: u32 = BASE + 0x20;
    /// Received data.
    pub const RDR: u32 = BASE + 0x24;
    /// Data to send.
    pub const TDR: u32 = BASE + 0x28;
}

/// Independent watchdog (chapter 42).
pub mod iwdg {
    const BASE: u32 = 0x4000_3000;
    /// Keys.
    pub const KR: u32 = BASE;
    /// Prescaler.
    pub const PR: u32 = BASE + 0x04;
    /// Reload value.
    pub const RLR: u32 = BASE + 0x08;
    /// Values that have not arrived.
    pub const SR: u32 = BASE + 0x0c;
}

/// CAN, and its message memory (chapter 44).
pub mod fdcan {
    const BASE: u32 = 0x4000_6400;
    /// Data bit timing.
    pub const DBTP: u32 = BASE + 0x0c;
    /// Control.
    pub const CCCR: u32 = BASE + 0x18;
    /// Nominal bit timing.
    pub const NBTP: u32 = BASE + 0x1c;
    /// Delay of the transceiver.
    pub const TDCR: u32 = BASE + 0x48;
    /// Interrupt flags.
    pub const IR: u32 = BASE + 0x50;
    /// Enabled interrupts.
    pub const IE: u32 = BASE + 0x54;
    /// Enabled interrupt lines.
    pub const ILE: u32 = BASE + 0x5c;
    /// Filters.
    pub const RXGFC: u32 = BASE + 0x80;
    /// State of the first queue of received frames.
    pub const RXF0S: u32 = BASE + 0x90;
    /// Releases an element of it.
    pub const RXF0A: u32 = BASE + 0x94;
    /// State of the frames to send.
    pub const TXFQS: u32 = BASE + 0xc4;
    /// Sends a frame.
    pub const TXBAR: u32 = BASE + 0xcc;
    /// Interrupts of sent frames.
    pub const TXBTIE: u32 = BASE + 0xdc;
    /// Message memory of FDCAN1.
    pub const MEMORY: u32 = 0x4000_a400;
    /// Its length, bytes.
    pub const MEMORY_BYTES: u32 = 0x350;
    /// First queue of received frames: three elements.
    pub const RECEIVED: u32 = MEMORY + 0xb0;
    /// Frames to send: three elements.
    pub const SENT: u32 = MEMORY + 0x278;
    /// Length of an element of 64 data bytes, bytes.
    pub const ELEMENT: u32 = 18 * 4;
}

/// Cycle counter of the core (ARMv7-M, C1.8.8).
pub const CYCLE_COUNTER: u32 = 0xe000_1004;
