//! What a board provides to the server.

use super::hosted_drive::HostedDrive;
use super::report::UsbState;
use crate::scalar::Scalar;

/// Bits per second of a serial port; 8 data bits, no parity, one stop bit. USB ignores it.
pub const BAUD: u32 = 1_000_000;

/// A serial port that never waits.
pub trait BytePort {
    /// The next byte that has been received.
    fn read(&mut self) -> Option<u8>;

    /// Sends as many of the bytes as can be taken now. Returns their number.
    fn write(&mut self, bytes: &[u8]) -> usize;

    /// The USB port of the board, for its status.
    fn usb(&self) -> UsbState {
        UsbState::None
    }
}

impl<P: BytePort> BytePort for &mut P {
    fn read(&mut self) -> Option<u8> {
        (**self).read()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        (**self).write(bytes)
    }

    fn usb(&self) -> UsbState {
        (**self).usb()
    }
}

/// Access to the drives of `N` axes, which the tick uses at any time.
pub trait SharedDrive<'m, S: Scalar, const N: usize> {
    /// Runs `access` while no tick runs. It has to be short: ticks wait for it.
    fn with<R>(&mut self, access: impl FnOnce(&mut HostedDrive<'m, S, N>) -> R) -> R;
}

/// Without ticks beside it: on a host.
impl<'m, S: Scalar, const N: usize> SharedDrive<'m, S, N> for HostedDrive<'m, S, N> {
    fn with<R>(&mut self, access: impl FnOnce(&mut Self) -> R) -> R {
        access(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A port that receives a number and takes three bytes.
    struct Three(u8);

    impl BytePort for Three {
        fn read(&mut self) -> Option<u8> {
            self.0.checked_sub(1).inspect(|left| self.0 = *left)
        }

        fn write(&mut self, bytes: &[u8]) -> usize {
            bytes.len().min(3)
        }

        fn usb(&self) -> UsbState {
            UsbState::Attached
        }
    }

    #[test]
    fn a_borrowed_port_is_the_port() {
        fn uses(mut port: impl BytePort) {
            assert_eq!([port.read(), port.read(), port.read()], [Some(2), Some(1), Some(0)]);
            assert_eq!(port.read(), None);
            assert_eq!((port.write(&[0; 2]), port.write(&[0; 5])), (2, 3));
            assert_eq!(port.usb(), UsbState::Attached);
        }
        let mut port = Three(3);
        uses(&mut port);
        assert_eq!(port.0, 0);
    }
}
