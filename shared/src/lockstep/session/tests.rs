extern crate std;

use proptest::prelude::*;

use super::*;
use crate::config::{AxisSettings, Law, Rates, ScaleLimits, Sensors, VelocitySource};
use crate::interpolate::block::Shape;
use crate::interpolate::{Block, Joint, PathError, Ramps, Smoothing};
use crate::lockstep::protocol::{PART, encode};
use crate::safety::Power;
use crate::units::Position;

fn answer_to(session: &mut Session, order: &Order) -> Option<Answer> {
    let mut frame = [0; FRAME];
    if encode(order, &mut frame).is_ok() {
        return session.answer(&frame, &mut NoMeter);
    }
    let mut bytes = [0; LONGEST_ORDER];
    let bytes = postcard::to_slice(order, &mut bytes).unwrap();
    let count = bytes.len().div_ceil(PART);
    let mut answer = None;
    for (k, piece) in bytes.chunks(PART).enumerate() {
        let part = Part { bytes: heapless::Vec::from_slice(piece).unwrap(), last: k + 1 == count };
        encode(&Order::Part(part), &mut frame).unwrap();
        answer = session.answer(&frame, &mut NoMeter);
        assert!(k + 1 == count || answer == Some(Answer::Ready));
    }
    answer
}

fn setup(format: Format, second: &AxisSettings) -> Order {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
    Order::Setup(Setup {
        format,
        rates,
        axes: [AxisSettings::default(), *second],
        start: [Position(0); AXES],
    })
}

#[test]
fn every_number_format_answers_orders() {
    for format in [Format::Fixed, Format::F32, Format::F64] {
        let mut session = Session::default();
        assert_eq!(answer_to(&mut session, &setup(format, &AxisSettings::default())), Some(Answer::Ready));
        assert_eq!(
            answer_to(&mut session, &Order::Block(Block::line([0.1, 0.0], 0.1, 1.0))),
            Some(Answer::Ready)
        );
        assert_eq!(answer_to(&mut session, &Order::Enable), Some(Answer::Ready));
        // 1 µm is within the tolerance of 0.1 mm for the distance from the start of the path.
        let away = Reading { motor: Position(-(1 << 30)), table: None };
        let Some(Answer::Tick(ticked)) = answer_to(&mut session, &Order::Tick([away; AXES])) else {
            panic!()
        };
        assert_eq!((ticked.power, ticked.done), (Power::On, false));
        assert_ne!(ticked.force_bits, [0; AXES]);
        assert_eq!(answer_to(&mut session, &Order::End), None);
    }
}

#[test]
fn the_version_is_told_before_a_setup() {
    let mut session = Session::default();
    assert_eq!(answer_to(&mut session, &Order::Identify), Some(Answer::Sources(SOURCES)));
    assert_eq!(answer_to(&mut session, &Order::Enable), Some(Answer::Rejected(Rejection::NotSetUp)));
}

#[test]
fn a_refusal_states_its_reason() {
    let mut session = Session::default();
    let refusal_for = |refusal| Some(Answer::Rejected(refusal));
    assert_eq!(answer_to(&mut session, &Order::Enable), refusal_for(Rejection::NotSetUp));
    let bad = AxisSettings { force_limit_n: 0.0, ..AxisSettings::default() };
    assert_eq!(
        answer_to(&mut session, &setup(Format::F32, &bad)),
        refusal_for(Rejection::Settings { axis: 1 })
    );
    assert_eq!(answer_to(&mut session, &setup(Format::F32, &AxisSettings::default())), Some(Answer::Ready));
    let zero_length = Order::Block(Block::line([0.0; AXES], 0.1, 1.0));
    assert_eq!(answer_to(&mut session, &zero_length), refusal_for(Rejection::Path(PathError::ZeroLength)));
    assert_eq!(session.answer(&[0xff; FRAME], &mut NoMeter), refusal_for(Rejection::Unreadable));
}

/// Any floating-point number: special values, extreme magnitudes and ordinary ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        prop::sample::select(std::vec![
            0.0,
            1.0,
            1e-310,
            1e308,
            -1.0,
            f64::NAN,
            f64::INFINITY,
            1e-3,
            1e3,
            1e6
        ]),
        (-6.0..6.0).prop_map(|power| libm::pow(10.0, power)),
    ]
}

fn scale_limits([disagreement_m, frozen_m]: [f64; 2]) -> ScaleLimits {
    ScaleLimits { disagreement_m, frozen_m }
}

fn axis() -> impl Strategy<Value = AxisSettings> {
    let sensors = prop_oneof![
        [prop::option::of(number()), prop::option::of(number())].prop_map(|[disagreement, frozen]| {
            Sensors::Motor { scale_disagreement_limit_m: disagreement, frozen_encoder_limit_m: frozen }
        }),
        [number(), number()].prop_map(|limits| Sensors::Table(scale_limits(limits))),
        [number(), number(), number()].prop_map(|[time_constant_s, disagreement_m, frozen_m]| {
            Sensors::Dual { time_constant_s, limits: scale_limits([disagreement_m, frozen_m]) }
        }),
    ];
    let gains = (number(), 0.0..200.0f64, number(), prop::option::of(number()));
    (any::<bool>(), gains, number(), number(), (sensors, number())).prop_map(
        |(hpc, (kp, kf, kv, ti), force_limit_n, following_error_limit_m, (sensors, fade))| AxisSettings {
            law: if hpc { Law::Hpc } else { Law::P },
            position_gain_per_s: kp,
            feedforward_percent: kf,
            velocity_gain_n_s_per_m: kv,
            velocity_integral_time_s: ti,
            velocity_source: if hpc {
                VelocitySource::Observer { bandwidth_hz: kp }
            } else {
                VelocitySource::Difference
            },
            velocity_lag_s: 0.0,
            force_limit_n,
            sensors,
            scale_fade_time_s: fade,
            following_error_limit_m,
            fastest_m_per_s: hpc.then_some(kv),
            travel_m: hpc.then_some([-kp, kv]),
            saturation_time_s: ti.unwrap_or(1.0),
            smoothing: Smoothing::SCurve { time_s: kp * 1e-3, jerk_time_s: 1e-3 },
            ..AxisSettings::default()
        },
    )
}

fn block() -> impl Strategy<Value = Block<AXES>> {
    let ramps = prop_oneof![
        Just(Ramps::Trapezoid),
        Just(Ramps::Exponential),
        Just(Ramps::AfterInterpolation),
        number().prop_map(|jerk_m_per_s3| Ramps::SCurve { jerk_m_per_s3 }),
    ];
    let joint =
        prop_oneof![Just(Joint::Stop), number().prop_map(|tolerance_m| Joint::Within { tolerance_m })];
    let shape = prop_oneof![
        number().prop_map(|seconds| Shape::Dwell { seconds }),
        [number(), number()].prop_map(|to_m| Shape::Line { to_m }),
        (any::<[u8; 2]>(), [number(), number()], number()).prop_map(|(plane, centre_m, turns)| {
            Shape::Arc { plane: plane.map(|p| p % 3), centre_m, turns }
        }),
        (any::<bool>(), [number(), number()], [number(), number()]).prop_map(|(positive, centre_m, to_m)| {
            Shape::ArcTo { plane: [0, 1], centre_m, to_m, positive }
        }),
    ];
    (shape, number(), number(), ramps, joint).prop_map(
        |(shape, feed_m_per_s, acceleration_m_per_s2, ramps, joint)| Block {
            shape,
            feed_m_per_s,
            acceleration_m_per_s2,
            ramps,
            joint,
        },
    )
}

/// The parts of an order are discarded with the next order, and no bytes may follow an order.
#[test]
fn parts_belong_to_one_order() {
    let mut session = Session::default();
    answer_to(&mut session, &setup(Format::Fixed, &AxisSettings::default()));
    let mut enable = [0; FRAME];
    encode(&Order::Enable, &mut enable).unwrap();
    let part = Part { bytes: heapless::Vec::from_slice(&enable[..1]).unwrap(), last: false };
    assert_eq!(answer_to(&mut session, &Order::Part(part)), Some(Answer::Ready));
    assert_eq!(answer_to(&mut session, &setup(Format::Fixed, &AxisSettings::default())), Some(Answer::Ready));
    let empty = Part { bytes: heapless::Vec::new(), last: true };
    assert_eq!(answer_to(&mut session, &Order::Part(empty)), Some(Answer::Rejected(Rejection::Unreadable)));
    enable[1] = 0xaa;
    assert_eq!(session.answer(&enable, &mut NoMeter), Some(Answer::Rejected(Rejection::Unreadable)));
    let readings = [Reading { motor: Position(0), table: None }; AXES];
    let Some(Answer::Tick(ticked)) = answer_to(&mut session, &Order::Tick(readings)) else { panic!() };
    assert_eq!(ticked.power, Power::Off);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 4096 }))]

    /// Every order is answered, whatever its numbers.
    #[test]
    fn orders_with_any_numbers_are_answered(
        format in prop::sample::select(std::vec![Format::Fixed, Format::F32, Format::F64]),
        rate in number(), divider in prop_oneof![any::<u32>(), 0..10u32],
        axes in [axis(), axis()],
        start in [-100.0..100.0f64, -100.0..100.0],
        blocks in prop::collection::vec(block(), 0..4),
        readings in prop::collection::vec(any::<[i64; AXES]>(), 1..20),
    ) {
        let mut session = Session::default();
        let rates = Rates { velocity_loop_hz: rate, position_loop_divider: divider };
        let start = start.map(|m| Position::from_m(m).unwrap());
        if answer_to(&mut session, &Order::Setup(Setup { format, rates, axes, start })) != Some(Answer::Ready) {
            // Otherwise with valid rates and gains, so that blocks and readings are tested in any case.
            let axes = axes.map(|axis| AxisSettings { law: axis.law, ..AxisSettings::default() });
            let rates = Rates { velocity_loop_hz: 1e4, position_loop_divider: 1 };
            prop_assert_eq!(answer_to(&mut session, &Order::Setup(Setup { format, rates, axes, start })), Some(Answer::Ready));
        }
        for block in blocks {
            answer_to(&mut session, &Order::Block(block));
        }
        answer_to(&mut session, &Order::Enable);
        for motor in readings {
            let readings = motor.map(|motor| Reading { motor: Position(motor), table: Some(Position(motor / 2)) });
            answer_to(&mut session, &Order::Tick(readings));
            answer_to(&mut session, &Order::Disable);
            answer_to(&mut session, &Order::Enable);
        }
    }

    /// Any bytes are answered, before and after the setup, and so are damaged orders.
    #[test]
    fn any_bytes_are_answered(
        frames in prop::collection::vec(prop::collection::vec(any::<u8>(), FRAME), 1..if cfg!(miri) { 3 } else { 40 }),
        damaged in 0..FRAME, by in any::<u8>(),
    ) {
        let mut session = Session::default();
        let mut orders = [[0; FRAME]; 4];
        let block = Block::line([0.1, 0.2], 0.1, 1.0);
        let reading = Reading { motor: Position(5), table: Some(Position(7)) };
        encode(&setup(Format::Fixed, &AxisSettings::default()), &mut orders[0]).unwrap();
        encode(&Order::Block(block), &mut orders[1]).unwrap();
        encode(&Order::Enable, &mut orders[2]).unwrap();
        encode(&Order::Tick([reading; AXES]), &mut orders[3]).unwrap();
        for order in &orders {
            session.answer(order, &mut NoMeter);
        }
        for frame in &frames {
            session.answer(frame.as_slice().try_into().unwrap(), &mut NoMeter);
        }
        for mut order in orders {
            order[damaged] ^= by;
            session.answer(&order, &mut NoMeter);
        }
    }
}
