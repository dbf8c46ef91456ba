//! Checks after a run.

use firmware::setup::{CRYSTAL_HZ, FULL_DUTY_N, METRES_PER_COUNT, SETTINGS, TICK_HZ};
use shared::config::AxisSettings;
use tests::chip::vectors::EXCEPTION_FRAME;
use tests::firmware::{DECLARED, TICK};
use tests::gdb::{SP, XPSR};

use tests::board::Chip;
use tests::board::inputs::{ARMED, COUNTS, PUSHED};
use tests::board::log::{Access, written};

/// TIM2 (RM0090, 18.4).
const TIM2: u32 = 0x4000_0000;

/// Offsets of CR1, DIER, PSC and ARR.
const TIMER_REGISTERS: [u32; 4] = [0, 0xc, 0x28, 0x2c];

/// Enabled interrupts 0 to 31 (ARMv7-M reference manual, B3.4.4).
const NVIC_ISER0: u32 = 0xe000_e100;

/// Set where the program is built without link-time optimisation, as mutants are (`tests/firmware_mutants.py`): it has calls whose depth is
/// not computed.
const QUICK_BUILD: &str = "QUICK_CHIP_BUILD";

/// The used stack is at most the depth computed from the code, and at least that of one tick.
pub fn stack_depth_is_as_computed(chip: &mut Chip) {
    if std::env::var_os(QUICK_BUILD).is_some() {
        return;
    }
    let [used, room] = chip.stack().unwrap();
    let worst = chip.vectors.worst_case(&chip.image, &DECLARED).unwrap();
    println!("{used} B of the stack were used, {} B computed, {room} B available", worst.bytes());
    assert!(
        used <= worst.bytes() && worst.bytes() <= room,
        "{used} B used, {} B computed, {room} B available",
        worst.bytes()
    );
    // The frame of the tick and that of the core. Two words of the latter, alignment and reserve, are not written.
    let tick = chip.vectors.handler(TICK);
    let (_, frame) = worst.exceptions.iter().find(|depth| depth.chain[0].0 == tick).unwrap().chain[0];
    assert!(used >= frame + EXCEPTION_FRAME - 8, "{used} B used, the frame is {frame} B");
    let (sp, running) = (chip.target.register(SP).unwrap(), chip.target.register(XPSR).unwrap() & 511);
    assert!(sp <= chip.vectors.initial_sp && sp >= chip.vectors.initial_sp - worst.bytes(), "{sp:#x}");
    assert!(running == 0 || running as usize == TICK, "exception {running}");
}

/// A tick is a period of the PWM: its rate is the clock of TIM1 over the period of TIM1. Each update of TIM1 resets
/// TIM2, whose own period, the only one in QEMU, is a little longer.
pub fn tick_rate_is_as_set_up(chip: &mut Chip, accesses: &[Access]) {
    let [control, interrupts, prescaler, reload] =
        TIMER_REGISTERS.map(|offset| chip.target.word(TIM2 + offset).unwrap());
    // Counts up continuously, an update by a reset sets its flag (URS = 0); interrupts at updates only.
    assert_eq!((control & 0x7d, interrupts), (1, 1), "CR1 {control:#x}, DIER {interrupts:#x}");
    let [own_clock, clock] = chip.clocks.timers_hz(CRYSTAL_HZ);
    let period = written(accesses, "timer[1]", 0x2c).last().unwrap() + 1;
    assert_eq!(written(accesses, "timer[1]", 0x28).sum::<u32>(), 0, "a prescaler of TIM1");
    assert_eq!((clock % period, clock / period), (0, TICK_HZ));
    let own = f64::from(own_clock) / f64::from((prescaler + 1) * (reload + 1)) / f64::from(TICK_HZ);
    assert!(own < 0.995 && own > 0.97, "{own} of the rate without TIM1");
    assert_eq!(chip.target.word(NVIC_ISER0).unwrap(), 1 << 28, "TIM2 and nothing else");
}

/// Offset and bit of the clock enable of each device (RM0090, 7.3.10 to 7.3.14). Without its clock a device ignores
/// writes.
const CLOCK_OF: [(&str, u32, u32); 7] = [
    ("GPIOA", 0x30, 0),
    ("GPIOB", 0x30, 1),
    ("GPIOC", 0x30, 2),
    ("GPIOD", 0x30, 3),
    ("timer[1]", 0x44, 0),
    ("timer[8]", 0x44, 1),
    ("DAC", 0x40, 29),
];

/// Clock enables of the devices that QEMU models, so that their accesses are not in the log: TIM2 to TIM5, USART3; ADC1, ADC2.
const CLOCKS_OF_MODELLED: [(u32, u32); 7] =
    [(0x40, 0), (0x40, 1), (0x40, 2), (0x40, 3), (0x40, 18), (0x44, 8), (0x44, 9)];

/// The clock of each device was enabled before its first access.
pub fn every_device_has_a_clock(accesses: &[Access]) {
    for (device, offset, bit) in CLOCK_OF {
        let first = accesses.iter().position(|access| access.device == device).expect(device);
        let clocked = |access: &Access| {
            let enables = access.written.is_some_and(|value| value >> bit & 1 == 1);
            access.device == "RCC" && access.offset == offset && enables
        };
        assert!(accesses[..first].iter().any(clocked), "{device} is used without its clock");
    }
    for (offset, bit) in CLOCKS_OF_MODELLED {
        let enables = |access: &Access| access.written.is_some_and(|value| value >> bit & 1 == 1);
        let clocked = accesses.iter().any(|a| a.device == "RCC" && a.offset == offset && enables(a));
        assert!(clocked, "bit {bit} of RCC + {offset:#x} is never set");
    }
}

/// Counts of a period. A compare value of at least this is never reached and gives no pulse.
const FULL_COUNTS: u32 = 8400;

/// Main output enable in BDTR of TIM1.
const MOE: u32 = 1 << 15;

/// Whether the enable pin is high and whether the PWM is on, by the last writes.
pub fn power_stages(accesses: &[Access]) -> [bool; 2] {
    let enable = written(accesses, "GPIOB", 0x18).filter(|bits| bits & 0x4000_4000 != 0).last();
    let outputs = written(accesses, "timer[1]", 0x44).last();
    [enable.unwrap() & 1 << 14 != 0, outputs.unwrap() & MOE != 0]
}

/// The enable switch reads as open: PB14, and PD2 of the brakes, are low before they are outputs, and stay low. There is no overrun: the fault light
/// at PC13, active low, stays off. Each of the `ticks` that have ended sets the duties and feeds the watchdog.
pub fn drives_stay_off_and_the_watchdog_is_fed(accesses: &[Access], ticks: usize) {
    let low_before = |device, bit: u32, mode: u32| {
        let position = |offset: u32, bits: u32| {
            let is = |access: &Access| {
                let sets = access.written.is_some_and(|value| value & bits != 0);
                access.device == device && access.offset == offset && sets
            };
            accesses.iter().position(is)
        };
        position(0x18, bit).unwrap() < position(0, mode).unwrap()
    };
    assert!(low_before("GPIOB", 1 << (14 + 16), 1 << (2 * 14)), "PB14 is an output before it is low");
    assert!(written(accesses, "GPIOB", 0x18).all(|bits| bits & 1 << 14 == 0), "PB14 was set");
    assert!(low_before("GPIOD", 1 << (2 + 16), 1 << (2 * 2)), "PD2 is an output before it is low");
    assert!(written(accesses, "GPIOD", 0x18).all(|bits| bits & 1 << 2 == 0), "PD2 was set");
    assert!(written(accesses, "timer[1]", 0x44).all(|bits| bits & MOE == 0), "the PWM was on");
    assert!(
        written(accesses, "GPIOC", 0x18).all(|bits| bits & 1 << (13 + 16) == 0),
        "the fault light was on"
    );
    // Compare values of PWM channels 1 and 2 of TIM1.
    for offset in [0x34, 0x38] {
        assert!(written(accesses, "timer[1]", offset).all(|counts| counts >= FULL_COUNTS), "a duty");
        assert!(written(accesses, "timer[1]", offset).count() >= ticks, "every tick sets a duty");
    }
    // QEMU maps another device without registers over the watchdog: either name may be logged.
    let key = |value: u32| {
        let keys = written(accesses, "IWDG", 0).chain(written(accesses, "I2S2ext", 0));
        keys.filter(move |&written| written == value).count()
    };
    assert_eq!(key(0xcccc), 1, "the watchdog is started once");
    assert!(key(0xaaaa) >= ticks, "fed {} times in {ticks} ticks", key(0xaaaa));
}

/// PB14 and the main output of the PWM are switched on once, when the switch has been closed for its settling time and the host
/// has enabled the drives. X is displaced in the positive direction by one count per tick. The force on it is:
/// - while it moves at v: Kv·v, and at most the force at standstill in addition;
/// - at standstill at a distance d: Kv·Kp·d by the position loop and Kv/Ti·d by the integral part, which grows by
///   Kv/Ti·Kp·d·t: 4 % of the sum in the 3 ms of the motion and after it. The duty is rounded to a count.
pub fn drives_come_on_and_push_back(accesses: &[Access]) {
    // Low at the start, then high once; the PWM with it.
    let power: Vec<bool> = written(accesses, "GPIOB", 0x18).map(|bits| bits & 1 << 14 != 0).collect();
    assert_eq!(power, [false, true]);
    let outputs: Vec<u32> = written(accesses, "timer[1]", 0x44).map(|bits| bits & MOE).collect();
    assert_eq!(outputs, [0, MOE]);
    let high = |a: &Access| a.device == "GPIOB" && a.offset == 0x18 && a.written == Some(1 << 14);
    let on = accesses.iter().position(high).unwrap();
    // The watchdog is fed once by its start, and in each tick before the power stages are enabled.
    let fed = accesses[..on].iter().filter(|access| access.written == Some(0xaaaa)).count();
    assert!((ARMED as usize..PUSHED as usize).contains(&fed), "{fed} ticks before the drives are on");

    let AxisSettings { position_gain_per_s, velocity_gain_n_s_per_m, velocity_integral_time_s, .. } =
        SETTINGS[0];
    let counts_per_n = f64::from(FULL_COUNTS) / FULL_DUTY_N[0];
    let speed = METRES_PER_COUNT[0] * f64::from(TICK_HZ);
    let distance = METRES_PER_COUNT[0] * f64::from(COUNTS);
    let moving = velocity_gain_n_s_per_m * speed * counts_per_n;
    let rate = position_gain_per_s + 1.0 / velocity_integral_time_s.unwrap();
    let at_standstill = velocity_gain_n_s_per_m * rate * distance * counts_per_n;

    // The pulse is at the end of the period, after the compare value.
    let counts = |offset| written(accesses, "timer[1]", offset).map(|compare| FULL_COUNTS - compare);
    let duties: Vec<f64> = counts(0x34).map(f64::from).collect();
    let (max, last) = (duties.iter().copied().fold(0.0, f64::max), duties[duties.len() - 1]);
    assert!(
        moving - 1.0 <= max && max <= moving + 1.04 * at_standstill + 1.0,
        "{max} counts, expected {moving}"
    );
    assert!(
        at_standstill - 1.0 <= last && last <= 1.04 * at_standstill + 1.0,
        "{last} counts, expected {at_standstill}"
    );
    // PC10 is high for a negative force.
    let directions = written(accesses, "GPIOC", 0x18).filter(|bits| bits & 0x0400_0400 != 0);
    assert_eq!(directions.last(), Some(1 << 10));
    // Y is at standstill at zero: its duty is exactly zero.
    assert!(counts(0x38).all(|counts| counts == 0));
}
