//! The registers after the start of the board, against those that the vendor's description of the chip gives by name (the crate stm32g4): addresses, places of
//! the bits, and values of the fields have another source than the code.

use std::ops::Deref;

use stm32g4::stm32g474 as chip;

use firmware::g474::counters::{self, Signals, scale_signals};
use firmware::setup::TABLE;

use super::board::{Board, Port};
use super::model::Model;

/// A register that the start writes: its name, its address, and its value.
struct Expected {
    name: &'static str,
    address: u32,
    value: u32,
}

/// Memory for the registers of a device.
fn block<D: Deref>() -> &'static D::Target
where
    D::Target: Sized,
{
    let words = size_of::<D::Target>().div_ceil(4);
    let memory: &'static mut [u32] = Box::leak(vec![0; words].into_boxed_slice());
    // SAFETY: registers are words, aligned as these, of which every value is valid; the memory is as long as they are, and nothing else refers to it.
    unsafe { &*memory.as_mut_ptr().cast() }
}

/// A register by the names of the description: what is not named has its value after a reset.
macro_rules! expected {
    ($device:ident.$register:ident, |$w:ident| $fields:expr) => {{
        let block = block::<chip::$device>();
        // SAFETY: the memory of the test; fields that the description does not limit take any number.
        #[allow(unused_unsafe, reason = "some fields are safe")]
        block.$register().write(|$w| unsafe { $fields });
        let start: *const _ = block;
        let offset = block.$register().as_ptr().addr() - start.addr();
        #[allow(
            clippy::cast_ptr_alignment,
            reason = "some registers are half-words, in the memory of whole words"
        )]
        // SAFETY: the memory of the test, of whole words.
        let value = unsafe { block.$register().as_ptr().cast::<u32>().read_volatile() };
        Expected {
            name: concat!(stringify!($device), " ", stringify!($register)),
            address: u32::try_from(chip::$device::PTR.addr() + offset).unwrap(),
            value,
        }
    }};
}

fn check(model: &Model, expected: &[Expected]) {
    for Expected { name, address, value } in expected {
        let last = model.written(*address).last().copied();
        assert_eq!(last, Some(*value), "{name} at {address:#x}: {last:x?}, expected {value:#x}");
    }
}

fn started() -> &'static Model {
    Board::start(Port::Serial).model
}

#[test]
fn clock_and_supply() {
    let model = started();
    let expected = [
        expected!(RCC.pllcfgr, |w| w
            .bits(0)
            .pllsrc()
            .bits(3)
            .pllm()
            .bits(1)
            .plln()
            .bits(85)
            .pllren()
            .set_bit()),
        expected!(RCC.cfgr, |w| w.bits(1 << 2).sw().bits(3)),
        expected!(RCC.csr, |w| w.bits(0).rmvf().set_bit()),
        expected!(RCC.ccipr, |w| w.bits(0).fdcansel().bits(2)),
        expected!(PWR.cr5, |w| w.bits(0).r1mode().clear_bit()),
        expected!(PWR.cr3, |w| w.bits(0).ucpd1_dbdis().set_bit()),
        expected!(PWR.cr2, |w| w.bits(0).pvde().set_bit().pvdls().bits(6)),
        expected!(SYSCFG.cfgr2, |w| w.bits(0).cll().set_bit().pvdl().set_bit()),
        expected!(RCC.ahb2enr, |w| {
            w.bits(0).gpioaen().set_bit().gpioben().set_bit().gpiocen().set_bit().gpioden().set_bit();
            w.adc12en().set_bit().dac1en().set_bit()
        }),
        expected!(RCC.apb1enr1, |w| {
            w.bits(0).tim2en().set_bit().tim3en().set_bit().tim4en().set_bit().tim5en().set_bit();
            w.usart3en().set_bit().fdcanen().set_bit().pwren().set_bit()
        }),
        expected!(RCC.apb2enr, |w| w.bits(0).syscfgen().set_bit().tim1en().set_bit().tim8en().set_bit()),
        // Each reset was released.
        expected!(RCC.ahb2rstr, |w| w.bits(0)),
        expected!(RCC.apb1rstr1, |w| w.bits(0)),
        expected!(RCC.apb2rstr, |w| w.bits(0)),
    ];
    // The change of the source is not in the model's copy: the last write has the state of the one before.
    let [pll, cfgr, rest @ ..] = expected;
    check(model, &[pll]);
    assert_eq!(
        model.written(cfgr.address).last().unwrap() & 0b1111_0011,
        0b11,
        "the whole core, from the PLL"
    );
    check(model, &rest);
    // Caches, prefetch, four wait states, the debugger; and the clock security system with crystal and PLL.
    let access = expected!(FLASH.acr, |w| {
        w.latency().bits(4).prften().set_bit().icen().set_bit().dcen().set_bit()
    });
    let written = model.written(access.address)[0];
    assert_eq!(written & !(1 << 18), access.value & !(1 << 18), "{written:#x}");
    assert_ne!(written & 1 << 18, 0, "the access of a debugger");
    let control = expected!(RCC.cr, |w| w.bits(0).csson().set_bit().hseon().set_bit().pllon().set_bit());
    assert_eq!(model.written(control.address).last().unwrap() & control.value, control.value);
}

#[test]
fn power_stages_and_ticks() {
    let expected = [
        expected!(TIM1.cr2, |w| w.mms().bits(2)),
        expected!(TIM1.ccmr1_output, |w| {
            w.oc1m().pwm_mode2().oc1pe().enabled();
            w.oc2m().pwm_mode2().oc2pe().enabled()
        }),
        expected!(TIM1.ccer, |w| w.cc1e().set_bit().cc2e().set_bit()),
        expected!(TIM1.arr, |w| w.bits(8499)),
        expected!(TIM1.ccr1, |w| w.bits(8500)),
        expected!(TIM1.ccr2, |w| w.bits(8500)),
        expected!(TIM1.bdtr, |w| {
            w.bke().enabled().bkp().active_low().aoe().manual().moe().disabled_idle();
            w.ossr().idle_level().ossi().idle_level().lock().level2()
        }),
        expected!(TIM1.egr, |w| w.ug().set_bit()),
        expected!(TIM1.cr1, |w| w.cen().set_bit().arpe().set_bit()),
        expected!(TIM2.smcr, |w| w.sms().bits(4).ts().bits(0)),
        expected!(TIM2.cr2, |w| w.mms().bits(2)),
        expected!(TIM2.ccmr1_output, |w| w.oc1m().pwm_mode2()),
        expected!(TIM2.ccer, |w| w.cc1e().set_bit()),
        expected!(TIM2.arr, |w| w.bits(8500 + 128 - 1)),
        // 7 µs before the tick.
        expected!(TIM2.ccr1, |w| w.bits(8500 - 1190)),
        expected!(TIM2.dier, |w| w.uie().set_bit()),
        expected!(TIM2.cr1, |w| w.cen().set_bit()),
        expected!(DAC1.mcr, |w| w.bits(0).hfsel().bits(2)),
        expected!(DAC1.dhr12r1, |w| w.bits(2048)),
        expected!(DAC1.dhr12r2, |w| w.bits(2048)),
        expected!(DAC1.cr, |w| w.en1().set_bit().en2().set_bit()),
    ];
    check(started(), &expected);
}

/// The registers of a counter with its index on channel 3.
macro_rules! counter {
    ($device:ident) => {
        [
            expected!($device.ccmr1_input, |w| {
                w.cc1s().ti1().ic1f().fdts_div4_n8();
                w.cc2s().ti2().ic2f().bits(0b0111)
            }),
            // The index on channel 3, and the trigger on channel 4.
            expected!($device.ccmr2_input, |w| w.cc3s().ti3().ic3f().bits(0b0111).cc4s().trc()),
            expected!($device.ccer, |w| {
                w.cc1e().set_bit().cc2e().set_bit().cc3e().set_bit().cc4e().set_bit()
            }),
            // TIM2 is ITR1 (001).
            expected!($device.smcr, |w| w.sms().bits(3).ts().bits(1)),
            expected!($device.cr1, |w| w.cen().set_bit()),
        ]
    };
}

#[test]
fn counters() {
    let model = started();
    check(model, &counter!(TIM3));
    check(model, &counter!(TIM5));
    check(model, &counter!(TIM8));
    // The index of Y is on channel 4, and the trigger on channel 3.
    let [inputs, _, channels, mode, on] = counter!(TIM4);
    check(model, &[inputs, channels, mode, on]);
    check(model, &[expected!(TIM4.ccmr2_input, |w| w.cc4s().ti4().ic4f().bits(0b0111).cc3s().trc())]);
}

/// Steps of a master at the inputs of both scales: their rising edges count (CC2P), up or down by the other input.
#[test]
fn counters_of_steps() {
    let model = started();
    counters::start(model, [Signals::DirectionAndSteps; 2]);
    macro_rules! steps {
        ($device:ident) => {
            [
                expected!($device.ccer, |w| {
                    w.cc1e().set_bit().cc2e().set_bit().cc2p().set_bit().cc3e().set_bit().cc4e().set_bit()
                }),
                // 1011, of which the description has the upper bit apart.
                expected!($device.smcr, |w| w.sms().bits(3).sms_3().set_bit().ts().bits(1)),
            ]
        };
    }
    check(model, &steps!(TIM5));
    check(model, &steps!(TIM8));
    // The motor encoders remain encoders.
    check(model, &counter!(TIM3));
}

/// A scale is an encoder, whatever the master of an axis without one is.
#[test]
fn a_scale_has_the_signals_of_an_encoder() {
    let steps = [Signals::DirectionAndSteps; 2];
    let mut table = TABLE;
    table[0].scale_m_per_count = Some(1e-7);
    table[1].scale_m_per_count = None;
    assert_eq!(scale_signals(&table, steps), [Signals::Quadrature, Signals::DirectionAndSteps]);
    assert_eq!(scale_signals(&table, [Signals::Quadrature; 2]), [Signals::Quadrature; 2]);
}

#[test]
fn converters() {
    let expected = [
        expected!(ADC12_COMMON.ccr, |w| w.ckmode().bits(3)),
        // Channels 8 and 6; 9, 7, 5 and 11; 47.5 cycles (100).
        expected!(ADC1.smpr1, |w| w.smp8().bits(4).smp6().bits(4)),
        expected!(ADC2.smpr1, |w| w.smp9().bits(4).smp7().bits(4).smp5().bits(4)),
        expected!(ADC2.smpr2, |w| w.smp11().bits(4)),
        expected!(ADC1.jsqr, |w| {
            w.jl().bits(1).jextsel().tim2_cc1().jexten().bits(1).jsq1().bits(8).jsq2().bits(6)
        }),
        expected!(ADC2.jsqr, |w| {
            w.jl().bits(3).jextsel().tim2_cc1().jexten().bits(1);
            w.jsq1().bits(9).jsq2().bits(7).jsq3().bits(5).jsq4().bits(11)
        }),
        expected!(ADC1.cr, |w| w.bits(0).advregen().set_bit().aden().set_bit().jadstart().set_bit()),
        expected!(ADC2.cr, |w| w.bits(0).advregen().set_bit().aden().set_bit().jadstart().set_bit()),
    ];
    let model = started();
    check(model, &expected);
    // Each was calibrated.
    for control in &expected[6..] {
        assert!(model.written(control.address).iter().any(|value| value & 1 << 31 != 0), "{}", control.name);
    }
}

#[test]
fn ports_of_the_link_and_watchdog() {
    let expected = [
        expected!(USART3.brr, |w| w.bits(170)),
        expected!(FDCAN1.nbtp, |w| {
            // 170 MHz / 5 = 34 MHz; 1 + 51 + 16 quanta.
            w.nbrp().bits(4).ntseg1().bits(50).ntseg2().bits(15).nsjw().bits(15)
        }),
        // 1 + 12 + 4 quanta.
        expected!(FDCAN1.dbtp, |w| {
            w.dbrp().bits(4).dtseg1().bits(11).dtseg2().bits(3).dsjw().bits(3).tdc().set_bit()
        }),
        // 13 quanta of five cycles.
        expected!(FDCAN1.tdcr, |w| w.tdco().bits(65)),
        expected!(FDCAN1.rxgfc, |w| {
            w.rrfe().set_bit().rrfs().set_bit().anfe().bits(2).anfs().bits(2).lss().bits(1).lse().bits(0)
        }),
        expected!(FDCAN1.cccr, |w| w.bits(0).fdoe().set_bit().brse().set_bit()),
        expected!(FDCAN1.ie, |w| w.rf0ne().set_bit().tce().set_bit().boe().set_bit()),
        expected!(FDCAN1.ile, |w| w.eint0().set_bit()),
        expected!(FDCAN1.txbtie, |w| w.bits(0b111)),
        expected!(IWDG.pr, |w| w.bits(0)),
        // 80 periods of 8 kHz: 10 ms.
        expected!(IWDG.rlr, |w| w.bits(79)),
    ];
    let model = started();
    check(model, &expected);
    let control = expected!(USART3.cr1, |w| {
        w.bits(0).ue().set_bit().re().set_bit().te().set_bit().rxneie().set_bit()
    });
    assert_eq!(model.written(control.address)[0], control.value);
    // Identifier and mask, to the first queue; the rest of the memory is zero.
    assert_eq!(model.with(|state| state.can.memory[&0]), 0b10 << 30 | 1 << 27 | 0x640 << 16 | 0x7ff);
    assert!((4..0x350).step_by(4).all(|at| model.with(|state| state.can.memory[&at]) == 0));
    // Start, write access, and feed once both values have arrived.
    assert_eq!(model.written(u32::try_from(chip::IWDG::PTR.addr()).unwrap()), [0xcccc, 0x5555, 0xaaaa]);
}

#[test]
fn pins() {
    let expected = [
        expected!(GPIOA.moder, |w| {
            w.moder0().alternate().moder1().alternate().moder2().alternate().moder3().input();
            w.moder4().analog().moder5().analog().moder6().alternate().moder7().alternate();
            w.moder8().alternate().moder9().alternate().moder10().input();
            w.moder11().alternate().moder12().alternate().moder15().input()
        }),
        expected!(GPIOB.moder, |w| {
            w.moder0().alternate().moder1().input().moder2().input().moder3().input().moder4().input();
            w.moder5().input().moder6().alternate().moder7().alternate().moder9().alternate();
            w.moder10().alternate().moder11().alternate().moder12().alternate().moder13().input();
            w.moder14().output().moder15().input()
        }),
        expected!(GPIOC.moder, |w| {
            w.moder0().analog().moder1().analog().moder2().analog().moder3().analog();
            w.moder4().analog().moder5().analog().moder6().alternate().moder7().alternate();
            w.moder8().alternate().moder9().input().moder10().output().moder11().output();
            w.moder12().input().moder13().output()
        }),
        expected!(GPIOD.moder, |w| w.moder2().output()),
        expected!(GPIOA.pupdr, |w| {
            w.pupdr0().pull_up().pupdr1().pull_up().pupdr2().pull_up().pupdr3().pull_down();
            w.pupdr6().pull_up().pupdr7().pull_up().pupdr10().pull_down().pupdr15().pull_down()
        }),
        expected!(GPIOB.pupdr, |w| {
            w.pupdr0().pull_up().pupdr1().pull_down().pupdr2().pull_down().pupdr3().pull_down();
            w.pupdr4().pull_down().pupdr5().pull_down().pupdr6().pull_up().pupdr7().pull_up();
            w.pupdr9()
                .pull_up()
                .pupdr11()
                .pull_up()
                .pupdr12()
                .pull_down()
                .pupdr13()
                .pull_down()
                .pupdr15()
                .pull_down()
        }),
        expected!(GPIOC.pupdr, |w| {
            w.pupdr6().pull_up().pupdr7().pull_up().pupdr8().pull_up();
            w.pupdr9().pull_down().pupdr12().pull_down()
        }),
        expected!(GPIOA.afrl, |w| w.afrl0().af2().afrl1().af2().afrl2().af2().afrl6().af2().afrl7().af2()),
        expected!(GPIOA.afrh, |w| w.afrh8().af6().afrh9().af6().afrh11().af9().afrh12().af9()),
        expected!(GPIOB.afrl, |w| w.afrl0().af2().afrl6().af2().afrl7().af2()),
        expected!(GPIOB.afrh, |w| w.afrh9().af2().afrh10().af7().afrh11().af7().afrh12().af6()),
        expected!(GPIOC.afrl, |w| w.afrl6().af4().afrl7().af4()),
        expected!(GPIOC.afrh, |w| w.afrh8().af4()),
    ];
    check(started(), &expected);
}
