//! A model of the clock registers of an STM32F405, which QEMU's `netduinoplus2` does not have.
//!
//! Addresses and bits are those of the reference manual RM0090, chapters 3.9 and 7.3. A clock is ready as soon as it is
//! on; a sequence of writes that the manual forbids panics.

use super::device::Device;

/// Latency of the flash.
const ACR: u32 = 0x4002_3c00;
/// Oscillators and PLL on and ready.
const CR: u32 = 0x4002_3800;
/// Factors of the PLL.
const PLLCFGR: u32 = 0x4002_3804;
/// Source of the clock, and prescalers of the buses.
const CFGR: u32 = 0x4002_3808;

/// Enable bits of CR; the ready bit of each is the next higher one.
const HSI_ON: u32 = 1;
const HSE_ON: u32 = 1 << 16;
const PLL_ON: u32 = 1 << 24;

/// Bit of PLLCFGR: the source of the PLL is the crystal.
const FROM_CRYSTAL: u32 = 1 << 22;

/// Wait states that 168 MHz need at 2.7 to 3.6 V (RM0090, table 10).
const WAIT_STATES: u32 = 5;

/// The registers.
pub struct Clocks {
    acr: u32,
    cr: u32,
    pllcfgr: u32,
    cfgr: u32,
}

impl Clocks {
    /// Whether a failure of the crystal is detected: the clock security system (RM0090, 7.2.7).
    #[must_use]
    pub const fn are_monitored(&self) -> bool {
        self.cr & 1 << 19 != 0
    }

    /// Wait states of the flash (3.9.2), and whether its data cache is on.
    #[must_use]
    pub const fn flash_access(&self) -> (u32, bool) {
        (self.acr & 7, self.acr & 1 << 10 != 0)
    }

    /// After reset: the internal oscillator runs.
    #[must_use]
    pub const fn new() -> Self {
        Self { acr: 0, cr: 0x83, pllcfgr: 0x2400_3010, cfgr: 0 }
    }

    /// The clocks of TIM2 to TIM5 and of TIM1, Hz, for a crystal (Hz). Panics where a limit of the data sheet is
    /// exceeded.
    #[must_use]
    pub fn timers_hz(&self, crystal_hz: u32) -> [u32; 2] {
        assert_eq!(self.cfgr >> 2 & 3, 2, "the PLL clocks the core: CFGR {:#x}", self.cfgr);
        assert_ne!(self.pllcfgr & FROM_CRYSTAL, 0, "the crystal feeds the PLL: {:#x}", self.pllcfgr);
        let (m, n, p) = (self.pllcfgr & 63, self.pllcfgr >> 6 & 511, 2 * (self.pllcfgr >> 16 & 3) + 2);
        let reference = crystal_hz / m;
        assert!((1_000_000..=2_000_000).contains(&reference), "{reference} Hz into the PLL");
        let oscillator = reference * n;
        assert!((100_000_000..=432_000_000).contains(&oscillator), "{oscillator} Hz in the PLL");
        let core = oscillator / p;
        assert!(core <= 168_000_000, "{core} Hz of the core");
        // HPRE off; PPRE: 0xx one, 100 two, 101 four, 110 eight, 111 sixteen.
        assert_eq!(self.cfgr >> 4 & 8, 0, "the bus at the core's clock: CFGR {:#x}", self.cfgr);
        let divider = |bits: u32| if bits & 4 == 0 { 1 } else { 2 << (bits & 3) };
        let (slow, fast) = (divider(self.cfgr >> 10), divider(self.cfgr >> 13));
        assert!(core / slow <= 42_000_000 && core / fast <= 84_000_000, "buses at 1/{slow} and 1/{fast}");
        // The clock of a timer is twice that of its bus where the bus has a divider.
        [slow, fast].map(|divider| core / divider * if divider == 1 { 1 } else { 2 })
    }

    /// The clock of USB, Hz, for a crystal (Hz) that feeds the PLL.
    #[must_use]
    pub const fn usb_hz(&self, crystal_hz: u32) -> u32 {
        crystal_hz / (self.pllcfgr & 63) * (self.pllcfgr >> 6 & 511) / (self.pllcfgr >> 24 & 15)
    }
}

impl Default for Clocks {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for Clocks {
    fn registers(&self) -> &[u32] {
        &[ACR, CR, PLLCFGR, CFGR]
    }

    fn read(&mut self, address: u32) -> u32 {
        match address {
            ACR => self.acr,
            CR => self.cr,
            PLLCFGR => self.pllcfgr,
            CFGR => self.cfgr,
            _ => panic!("{address:#x} is not watched"),
        }
    }

    fn write(&mut self, address: u32, value: u32) {
        match address {
            ACR => self.acr = value,
            CR => {
                let on = value & (HSI_ON | HSE_ON | PLL_ON);
                let source = if self.pllcfgr & FROM_CRYSTAL == 0 { HSI_ON } else { HSE_ON };
                assert!(on & PLL_ON == 0 || on & source != 0, "the PLL without its source: {value:#x}");
                self.cr = value & !((HSI_ON | HSE_ON | PLL_ON) << 1) | on << 1;
            }
            PLLCFGR => {
                assert_eq!(self.cr & PLL_ON, 0, "factors of a running PLL: {value:#x}");
                self.pllcfgr = value;
            }
            CFGR => {
                let source = value & 3;
                let ready = [HSI_ON, HSE_ON, PLL_ON, 0][source as usize] << 1;
                assert_ne!(self.cr & ready, 0, "a clock that is not ready: {value:#x}");
                let fast = source == 2;
                assert!(!fast || self.acr & 7 >= WAIT_STATES, "the PLL with {} wait states", self.acr & 7);
                self.cfgr = value & !0xc | source << 2;
            }
            _ => panic!("{address:#x} is not watched"),
        }
    }
}

/// 8 MHz / 4 · 168 / 2, the buses at a quarter and a half: 84 and 168 MHz for their timers.
#[test]
fn a_correct_sequence_gives_ready_clocks_with_their_rates() {
    let mut clocks = Clocks::new();
    clocks.write(PLLCFGR, 7 << 24 | FROM_CRYSTAL | 168 << 6 | 4);
    clocks.write(CR, HSI_ON | HSE_ON);
    assert_eq!(clocks.read(CR), (HSI_ON | HSE_ON) * 3);
    clocks.write(CR, HSI_ON | HSE_ON | PLL_ON);
    assert_eq!(clocks.read(CR), (HSI_ON | HSE_ON | PLL_ON) * 3);
    clocks.write(ACR, WAIT_STATES);
    clocks.write(CFGR, 0b100 << 13 | 0b101 << 10 | 2);
    assert_eq!(clocks.read(CFGR) & 0xf, 0b1010);
    assert_eq!(clocks.timers_hz(8_000_000), [84_000_000, 168_000_000]);
    // 336 MHz / 7.
    assert_eq!(clocks.usb_hz(8_000_000), 48_000_000);
}

#[test]
fn a_sequence_that_the_manual_forbids_is_rejected() {
    let rejected = |writes: &[(u32, u32)]| {
        let run = || {
            writes.iter().fold(Clocks::new(), |mut clocks, &(to, value)| {
                clocks.write(to, value);
                clocks
            })
        };
        std::panic::catch_unwind(run).is_err()
    };
    let ready = [(PLLCFGR, FROM_CRYSTAL), (CR, HSE_ON | PLL_ON)];
    let [factors, on] = ready;
    assert!(!rejected(&[factors, on, (ACR, WAIT_STATES), (CFGR, 2)]));
    assert!(rejected(&[factors, on, (ACR, WAIT_STATES - 1), (CFGR, 2)]), "too few wait states");
    assert!(rejected(&[factors, (CR, HSI_ON | PLL_ON)]), "the PLL without its crystal");
    assert!(rejected(&[factors, on, factors]), "factors of a running PLL");
    assert!(rejected(&[(ACR, WAIT_STATES), (CFGR, 2)]), "a PLL that is off");
    assert!(rejected(&[(CFGR, 1)]), "a crystal that is off");
}
