//! Planning on a copy of the queue: a block is planned for longer than a tick, but appended within one.

use super::Path;

impl<const N: usize> Path<N> {
    /// Copies what [`Path::push`] needs from another path, so that blocks are planned on the copy while ticks use the
    /// original.
    pub fn copy_queue(&mut self, other: &Self) {
        self.copy_blocks(other);
        (self.started, self.revision) = (other.started, other.revision);
        (self.planned_end, self.travel) = (other.planned_end, other.travel);
        (self.blocked, self.second_motors) = (other.blocked, other.second_motors);
        (self.rate_hz, self.filters) = (other.rate_hz, other.filters);
    }

    /// Copies the blocks that there are, not the capacity of the queue.
    fn copy_blocks(&mut self, other: &Self) {
        self.blocks.clear();
        for block in &other.blocks {
            // Both queues have the same capacity.
            let _ = self.blocks.push_back(*block);
        }
    }

    /// Adopts a copy of the queue with one more block. False, with nothing changed, if the queue has changed since it was
    /// copied. The running block is kept: no block that is appended changes it.
    pub fn adopt_queue(&mut self, planned: &Self) -> bool {
        if planned.revision != self.revision.wrapping_add(1) {
            return false;
        }
        self.copy_blocks(planned);
        (self.planned_end, self.revision) = (planned.planned_end, planned.revision);
        true
    }
}
