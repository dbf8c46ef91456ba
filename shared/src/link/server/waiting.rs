//! What waits while a reply, or a packet of the stream, is being sent.

use heapless::Deque;

use super::super::packet::{Header, MAX_MESSAGE, Packet};

/// Greatest number of halts whose replies wait. A further one is executed, too, but not answered: it is repeated.
const HALTS: usize = 4;

/// The replies to halts, which were executed at once, and one request. A host has one request at a time: another one is not
/// answered, and repeated by it.
#[derive(Debug)]
pub(super) struct Waiting {
    halted: Deque<Header, HALTS>,
    /// Header, checksum and message of the request, while there is one.
    header: Header,
    checksum: u32,
    message: heapless::Vec<u8, MAX_MESSAGE>,
    is_kept: bool,
}

impl Waiting {
    pub(super) const NONE: Self = Self {
        halted: Deque::new(),
        header: Header::without_session(0),
        checksum: 0,
        message: heapless::Vec::new(),
        is_kept: false,
    };

    /// A halt has been executed. A request of its own host that waits is dropped: it was sent before the halt.
    pub(super) fn halted(&mut self, header: Header) {
        if header.session == self.header.session {
            self.is_kept = false;
        }
        let _ = self.halted.push_back(header);
    }

    /// The next halt whose reply can be sent.
    pub(super) fn next_halted(&mut self) -> Option<Header> {
        self.halted.pop_front()
    }

    /// Keeps a request, unless one waits already.
    pub(super) fn keep(&mut self, packet: &Packet<'_>) {
        if !self.is_kept {
            self.message.clear();
            self.is_kept = self.message.extend_from_slice(packet.message).is_ok();
            (self.header, self.checksum) = (packet.header, packet.checksum);
        }
    }

    /// The request that waits. It remains until [`Waiting::forget`].
    pub(super) fn packet(&self) -> Option<Packet<'_>> {
        self.is_kept.then_some(Packet {
            header: self.header,
            message: &self.message,
            checksum: self.checksum,
        })
    }

    /// The request has been answered.
    pub(super) const fn forget(&mut self) {
        self.is_kept = false;
    }
}
