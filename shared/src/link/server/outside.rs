//! Requests that are not the next one of the session.
//!
//! | request | header | answer |
//! |---|---|---|
//! | a halt | any | executed |
//! | what changes nothing: status, history of faults, what the board is | session 0 | executed |
//! | the feed override | session 0 | executed |
//! | any other | any | refused |
//!
//! None of them is a sign of life of the host: nobody else can keep its motion going.

use super::super::HostedDrive;
use super::super::halt::Halt;
use super::super::message::{Reply, Request};
use super::super::packet::{self, Header, Packet};
use super::super::port::SharedDrive;
use super::super::receiver::LinkCounts;
use super::super::refusal::Refusal;
use super::super::report::Status;
use super::super::session::Verdict;
use super::send;
use super::state::ServerState;
use crate::scalar::Scalar;

// Not inlined: their messages are not on the stack while a compensation is converted.
impl<const N: usize> ServerState<N> {
    /// Answers a request that was refused as one of the session.
    #[inline(never)]
    pub(super) fn execute_outside<'m, S: Scalar>(
        &self,
        request: &Request,
        (header, refusal): (Header, Refusal),
        counts: LinkCounts,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Reply {
        if let Some(halt) = request.halt() {
            self.halt_outside(halt, header, drive);
            return Reply::Done;
        }
        if header.session != 0 {
            return Reply::Refused(refusal);
        }
        if let Request::Override { percent } = request {
            let set = drive.with(|drive| drive.set_override(*percent));
            return set.map_or_else(Reply::Refused, |()| Reply::Done);
        }
        self.look(request, counts, drive).unwrap_or(Reply::Refused(refusal))
    }

    /// Executes a halt although the reply to a request before it has not been sent. False for anything else, and for a repetition.
    #[inline(never)]
    pub(super) fn halt_at_once<'m, S: Scalar>(
        &mut self,
        packet: &Packet<'_>,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> bool {
        let halt = packet::message::<Request>(packet.message).ok().and_then(|request| request.halt());
        let Some(halt) = halt else { return false };
        match self.session.judge(packet) {
            Verdict::Repeat => return false,
            Verdict::Execute => {
                drive.with(|drive| {
                    drive.heard();
                    drive.halt(halt);
                });
                send(packet.header, Reply::Done, &mut self.kept);
                self.session.executed(packet);
            }
            Verdict::Refuse(_) => self.halt_outside(halt, packet.header, drive),
        }
        true
    }

    fn halt_outside<'m, S: Scalar>(
        &self,
        halt: Halt,
        header: Header,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) {
        // A host that has lost count is still the host.
        let is_host = self.session.is_present(header);
        drive.with(|drive| if is_host { drive.halt(halt) } else { drive.halt_from_outside(halt) });
    }

    /// Answers a request that changes nothing; `None` for any other.
    #[inline(never)]
    pub(super) fn look<'m, S: Scalar>(
        &self,
        request: &Request,
        counts: LinkCounts,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Option<Reply> {
        Some(match request {
            Request::Status => {
                let status =
                    drive.with(|drive: &mut HostedDrive<'m, S, _>| drive.status(counts, self.report));
                Reply::Status(Status { usb: self.usb, ..status })
            }
            Request::FaultHistory => {
                Reply::FaultHistory(drive.with(|drive| drive.history().newest_first().collect()))
            }
            Request::Identify => self.welcome(0, drive),
            _ => return None,
        })
    }
}
