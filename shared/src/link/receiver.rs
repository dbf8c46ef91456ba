//! Bytes to packets.

use serde::{Deserialize, Serialize};

use super::packet::{MAX_FRAME, Packet, PacketError, decode};

/// What a receiver has received, by its kind. Counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkCounts {
    /// Packets of this version.
    pub packets: u32,
    /// Stretches without a zero that are longer than a frame.
    pub too_long: u32,
    /// Frames that are too short for a packet.
    pub too_short: u32,
    /// Frames that are not COBS.
    pub encoding: u32,
    /// Packets with a wrong checksum.
    pub checksum: u32,
    /// Packets of another version.
    pub version: u32,
}

/// Collects bytes up to a zero.
#[derive(Clone, Debug)]
pub struct Receiver {
    bytes: [u8; MAX_FRAME],
    length: usize,
    /// Whether more bytes have arrived than a frame has: discarded up to the next zero.
    overrun: bool,
    counts: LinkCounts,
}

impl Receiver {
    /// Before the first byte.
    pub const NEW: Self = Self {
        bytes: [0; MAX_FRAME],
        length: 0,
        overrun: false,
        counts: LinkCounts { packets: 0, too_long: 0, too_short: 0, encoding: 0, checksum: 0, version: 0 },
    };

    /// Takes a byte. Returns the packet that it ends, or why the bytes up to it are none. Zeros in a row are no frames.
    pub fn push(&mut self, byte: u8) -> Option<Result<Packet<'_>, PacketError>> {
        if byte != 0 {
            match self.bytes.get_mut(self.length) {
                Some(place) => (*place, self.length) = (byte, self.length + 1),
                None => self.overrun = true,
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if core::mem::take(&mut self.overrun) {
            self.counts.too_long = self.counts.too_long.wrapping_add(1);
            return Some(Err(PacketError::TooLong));
        }
        if length == 0 {
            return None;
        }
        let packet = decode(self.bytes.get_mut(..length)?);
        let counter = match packet {
            Ok(_) => &mut self.counts.packets,
            Err(PacketError::TooLong) => &mut self.counts.too_long,
            Err(PacketError::TooShort) => &mut self.counts.too_short,
            Err(PacketError::Encoding) => &mut self.counts.encoding,
            Err(PacketError::Checksum) => &mut self.counts.checksum,
            Err(PacketError::Version { .. }) => &mut self.counts.version,
        };
        *counter = counter.wrapping_add(1);
        Some(packet)
    }

    /// What has been received.
    #[must_use]
    pub const fn counts(&self) -> LinkCounts {
        self.counts
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::super::packet::{Frame, Header, VERSION, encode, message};
    use super::*;

    fn frame(sequence: u32) -> Frame {
        let mut frame = Frame::new();
        encode(Header { session: 1, sequence }, &sequence, &mut frame).unwrap();
        frame
    }

    /// The sequence numbers of the packets in bytes.
    fn received(receiver: &mut Receiver, bytes: &[u8]) -> Vec<u32> {
        let mut numbers = Vec::new();
        for byte in bytes {
            if let Some(Ok(packet)) = receiver.push(*byte) {
                assert_eq!(message::<u32>(packet.message), Ok(packet.header.sequence));
                numbers.push(packet.header.sequence);
            }
        }
        numbers
    }

    proptest! {
        /// Whatever has been received before, the packet after a zero is received.
        #[test]
        fn a_packet_after_garbage_is_received(garbage in proptest::collection::vec(any::<u8>(), 0..1500)) {
            let mut receiver = Receiver::NEW;
            prop_assert!(received(&mut receiver, &garbage).is_empty());
            receiver.push(0);
            prop_assert_eq!(received(&mut receiver, &frame(5)), [5]);
        }
    }

    #[test]
    fn every_kind_is_counted() {
        let mut receiver = Receiver::NEW;
        let mut expected = LinkCounts::default();
        received(&mut receiver, &[1; MAX_FRAME + 1]);
        received(&mut receiver, &[0, 0]);
        expected.too_long = 1;
        assert_eq!(receiver.counts(), expected);
        received(&mut receiver, &[3, 7, 7, 0]);
        expected.too_short = 1;
        assert_eq!(receiver.counts(), expected);
        received(&mut receiver, &[9, 7, 7, 0]);
        expected.encoding = 1;
        assert_eq!(receiver.counts(), expected);
        let mut damaged = frame(1);
        // The last byte of the checksum, before the zero; it stays other than zero.
        let at = damaged.len() - 2;
        damaged[at] ^= if damaged[at] == 1 { 2 } else { 1 };
        received(&mut receiver, &damaged);
        expected.checksum = 1;
        assert_eq!(receiver.counts(), expected);
        let mut other = Frame::new();
        super::super::packet::encode_version(
            VERSION + 1,
            Header { session: 0, sequence: 0 },
            &0u8,
            &mut other,
        )
        .unwrap();
        received(&mut receiver, &other);
        expected.version = 1;
        assert_eq!(receiver.counts(), expected);
        assert_eq!(received(&mut receiver, &frame(9)), [9]);
        expected.packets = 1;
        assert_eq!(receiver.counts(), expected);
    }
}
