//! How the samples of a stream are divided into packets.

use shared::config::Rates;
use shared::link::message::{BoardSettings, Reply, Request};
use shared::link::stream::StreamPacket;

use super::rig::{IDENTITY, Rig, TICK_HZ, settings};

/// The packets of a stream with the drives off, which lasts this many ticks.
fn packets(rig: &mut Rig, decimation: u32, ticks: u32) -> Vec<StreamPacket> {
    assert_eq!(rig.request(&Request::Stream { decimation }), Reply::Done);
    rig.run(ticks);
    assert_eq!(rig.request(&Request::Stream { decimation: 0 }), Reply::Done);
    std::mem::take(&mut rig.streamed)
}

/// Samples are collected to 24: at 20 and 4 kHz a packet has this number, on a line that is always free.
#[test]
fn a_packet_has_its_samples_as_soon_as_there_are_24() {
    for decimation in [1, 5] {
        let mut rig = Rig::new();
        let packets = packets(&mut rig, decimation, 24 * 10 * decimation);
        // One more or less for the ticks of the requests.
        assert!((9..=11).contains(&packets.len()), "{} packets", packets.len());
        for packet in &packets {
            assert_eq!((packet.samples, packet.lost), (24, 0), "of {decimation} ticks");
        }
    }
}

/// A slow stream does not wait for 24 samples: at 200 Hz, what there is every fiftieth of a second, four samples.
#[test]
fn a_slow_stream_is_sent_fifty_times_in_a_second() {
    let mut rig = Rig::new();
    let packets = packets(&mut rig, 100, TICK_HZ);
    assert!((49..=51).contains(&packets.len()), "{} packets", packets.len());
    // The first and the last may have fewer.
    for packet in &packets[1..packets.len() - 1] {
        assert_eq!(packet.samples, 4, "from sample {}", packet.first);
    }
}

/// A packet states how many of its samples there are in a position tick: a whole number of them, or 1 if there is none.
#[test]
fn the_period_is_the_number_of_samples_in_a_position_tick() {
    let with_divider = |position_loop_divider| {
        let settings = settings();
        let rates = Rates { position_loop_divider, ..settings.rates };
        Rig::of(&IDENTITY, BoardSettings { rates, ..settings })
    };
    for (divider, decimation, period) in
        [(5, 1, 5), (5, 5, 1), (5, 2, 1), (5, 10, 1), (4, 1, 4), (4, 2, 2), (4, 3, 1), (4, 4, 1), (1, 1, 1)]
    {
        let mut rig = with_divider(divider);
        let packets = packets(&mut rig, decimation, 60 * decimation);
        assert!(!packets.is_empty());
        for packet in packets {
            assert_eq!(packet.period, period, "{divider} ticks, every {decimation}");
        }
    }
}
