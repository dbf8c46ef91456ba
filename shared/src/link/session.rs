//! Which request is new, repeated, old or of another session.
//!
//! A host repeats a request whose reply it has not received. The board executes it once: a repetition gets the reply that was
//! given. A request of an earlier session, an old one, and one behind a gap are refused.

use super::packet::{Header, Packet};
use super::refusal::Refusal;

/// What is to be done with a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Execute it and keep the reply.
    Execute,
    /// Send the kept reply again.
    Repeat,
    /// Refuse it. The kept reply remains.
    Refuse(Refusal),
}

/// The state of the session.
#[derive(Clone, Copy, Debug)]
pub struct SessionState {
    /// Number of the session; 0: none yet.
    session: u32,
    /// Number of the hello that opened it.
    nonce: u32,
    /// Number and checksum of the last request that was executed.
    last: u32,
    checksum: u32,
}

impl SessionState {
    /// No session.
    pub const NEW: Self = Self { session: 0, nonce: 0, last: 0, checksum: 0 };

    /// Number of the session; 0: none yet.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.session
    }

    /// Opens a session, or confirms the one that the same hello has opened. `entropy` is a number that differs from run to run,
    /// so that a session of a previous run is not continued.
    pub const fn hello(&mut self, nonce: u32, entropy: u32) -> u32 {
        if self.session != 0 && self.nonce == nonce && self.last == 0 {
            return self.session;
        }
        // An odd factor keeps different numbers different.
        let mixed = self.session.wrapping_add(1) ^ nonce.rotate_left(13) ^ entropy.wrapping_mul(0x9e37_79b9);
        self.session = if mixed == 0 || mixed == self.session { self.session.wrapping_add(1) } else { mixed };
        if self.session == 0 {
            self.session = 1;
        }
        (self.nonce, self.last, self.checksum) = (nonce, 0, 0);
        self.session
    }

    /// Whether a packet has the number of the present session.
    #[must_use]
    pub const fn is_present(&self, header: Header) -> bool {
        self.session != 0 && header.session == self.session
    }

    /// Judges a request other than a hello.
    #[must_use]
    pub fn judge(&self, packet: &Packet<'_>) -> Verdict {
        if !self.is_present(packet.header) {
            return Verdict::Refuse(Refusal::Session);
        }
        let expected = self.last.wrapping_add(1);
        if packet.header.sequence == expected {
            Verdict::Execute
        } else if self.last != 0 && packet.header.sequence == self.last && packet.checksum == self.checksum {
            Verdict::Repeat
        } else {
            Verdict::Refuse(Refusal::Sequence { expected })
        }
    }

    /// A request has been executed.
    pub const fn executed(&mut self, packet: &Packet<'_>) {
        (self.last, self.checksum) = (packet.header.sequence, packet.checksum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn packet(session: u32, sequence: u32, checksum: u32) -> Packet<'static> {
        Packet { header: Header { session, sequence }, message: &[], checksum }
    }

    #[test]
    fn a_request_is_executed_once_and_in_order() {
        let mut state = SessionState::NEW;
        assert_eq!(state.judge(&packet(0, 1, 5)), Verdict::Refuse(Refusal::Session));
        let session = state.hello(77, 1);
        let expect = |state: &SessionState, sequence, checksum, verdict| {
            assert_eq!(state.judge(&packet(session, sequence, checksum)), verdict);
        };
        let wrong = |expected| Verdict::Refuse(Refusal::Sequence { expected });
        expect(&state, 0, 0, wrong(1));
        expect(&state, 2, 5, wrong(1));
        expect(&state, 1, 5, Verdict::Execute);
        state.executed(&packet(session, 1, 5));
        expect(&state, 1, 5, Verdict::Repeat);
        // The number of the last request with other contents is no repetition.
        expect(&state, 1, 6, wrong(2));
        expect(&state, 3, 7, wrong(2));
        state.executed(&packet(session, 2, 7));
        expect(&state, 1, 5, wrong(3));
        assert_eq!(state.judge(&packet(session ^ 1, 3, 8)), Verdict::Refuse(Refusal::Session));
    }

    #[test]
    fn a_repeated_hello_opens_no_further_session_until_a_request_was_executed() {
        let mut state = SessionState::NEW;
        let session = state.hello(77, 1);
        assert_eq!(state.hello(77, 9), session);
        state.executed(&packet(session, 1, 5));
        let other = state.hello(77, 9);
        assert_ne!(other, session);
        assert_eq!(state.judge(&packet(session, 2, 5)), Verdict::Refuse(Refusal::Session));
        assert_eq!(state.judge(&packet(other, 1, 5)), Verdict::Execute);
        assert_ne!(state.hello(78, 9), other);
    }

    /// Of two runs, or of two hosts, neither gets the session of the other: the numbers of different hellos and of different starts
    /// differ, whatever the other of both is.
    #[test]
    fn sessions_of_other_runs_and_other_hellos_have_other_numbers() {
        for fixed in [1, 77, 0x5555_5555, u32::MAX] {
            let session = |nonce, entropy| {
                let mut state = SessionState::NEW;
                let session = state.hello(nonce, entropy);
                assert_eq!(state.number(), session);
                session
            };
            let sessions: [[u32; 50]; 3] = [
                core::array::from_fn(|k| session(fixed, n(k))),
                core::array::from_fn(|k| session(n(k), fixed)),
                core::array::from_fn(|k| session(n(k).rotate_right(13), fixed)),
            ];
            for sessions in sessions {
                for (k, session) in sessions.iter().enumerate() {
                    assert!(
                        *session != 0 && !sessions[..k].contains(session),
                        "{session} twice with {fixed}"
                    );
                }
            }
        }
    }

    fn n(index: usize) -> u32 {
        u32::try_from(index).unwrap()
    }

    /// A hello whose number mixes to 0 or to the present session gets another one. Without entropy, the hello that mixes to
    /// a number is the exclusive or of that number and the next session, rotated back.
    #[test]
    fn a_session_is_never_zero_and_never_the_previous_one() {
        let mut state = SessionState::NEW;
        let mut last = 0u32;
        for step in 0..20u32 {
            for to in [0, last] {
                let nonce = (last.wrapping_add(1) ^ to).rotate_right(13);
                let mut other = state;
                other.executed(&packet(last, 1, step));
                let session = other.hello(nonce, 0);
                assert!(session != 0 && session != last, "{session} after {last}");
            }
            last = state.hello(1000 + step, 0);
        }
        // The greatest number is followed by 1, not by 0.
        let mut state = SessionState { session: u32::MAX, last: 1, ..SessionState::NEW };
        assert_eq!(state.hello(0, 0), 1);
    }
}
