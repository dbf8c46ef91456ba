//! The CAN port of the link: its interrupt moves frames between the device and two queues, at a higher priority than the tick.

use heapless::spsc::{Consumer, Producer, Queue};
use shared::link::can_frames::{CanFrame, CanPort, FramePort};

use super::bus::{Bus, Line};
use super::can::Fdcan;

/// Capacity of a queue in frames, plus one. A packet has at most eight frames, and the device holds three more.
pub const QUEUE: usize = 9;

/// The queues of received and of waiting frames.
pub type Queues = [Queue<CanFrame, QUEUE>; 2];

/// The port, between ticks.
pub type Can<B> = CanPort<Frames<B>>;

/// The frames of the port, between ticks.
pub struct Frames<B> {
    received: Consumer<'static, CanFrame>,
    waiting: Producer<'static, CanFrame>,
    bus: core::marker::PhantomData<B>,
}

/// The port, in its interrupt.
pub struct CanInterrupt<B> {
    device: Fdcan<B>,
    received: Producer<'static, CanFrame>,
    waiting: Consumer<'static, CanFrame>,
    /// Frames that were lost because the queue was full.
    lost: u32,
}

/// Starts the port.
pub fn start<B: Bus>(bus: B, queues: &'static mut Queues) -> (Can<B>, CanInterrupt<B>) {
    let device = Fdcan::start(bus);
    let [received, waiting] = queues;
    let ((to_loop, from_device), (to_device, from_loop)) = (received.split(), waiting.split());
    let frames = Frames { received: from_device, waiting: to_device, bus: core::marker::PhantomData };
    (CanPort::new(frames), CanInterrupt { device, received: to_loop, waiting: from_loop, lost: 0 })
}

impl<B: Bus> FramePort for Frames<B> {
    fn receive(&mut self) -> Option<CanFrame> {
        self.received.dequeue()
    }

    fn send(&mut self, frame: &CanFrame) -> bool {
        let is_taken = self.waiting.enqueue(*frame).is_ok();
        // The interrupt sends the first frame.
        B::pend(Line::Fdcan1);
        is_taken
    }
}

impl<B: Bus> CanInterrupt<B> {
    /// Moves frames between device and queues.
    pub fn service(&mut self) {
        self.device.acknowledge();
        while let Some(frame) = self.device.receive() {
            self.lost = self.lost.saturating_add(u32::from(self.received.enqueue(frame).is_err()));
        }
        while self.device.can_send() {
            let Some(frame) = self.waiting.dequeue() else { break };
            self.device.send(&frame);
        }
    }

    /// Frames that were lost because the queue was full.
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}
