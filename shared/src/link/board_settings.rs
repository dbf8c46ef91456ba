//! The settings of a board, and the upload that carries them.

use serde::{Serialize, Serializer};

use super::packet::MAX_AXES;
use crate::config::{AxisSettings, Rates};

/// The settings of the controller on a board of `N` axes. In an upload the axes have their number before them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoardSettings<const N: usize> {
    /// Rates of the loops; the tick rate has to be that of the board.
    pub rates: Rates,
    /// Axes.
    #[serde(serialize_with = "with_their_number")]
    pub axes: [AxisSettings; N],
}

/// The settings for a board of any number of axes, as an upload has them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UploadedSettings<'a> {
    /// Rates of the loops.
    pub rates: Rates,
    /// Axes.
    pub axes: &'a [AxisSettings],
}

/// Why the bytes of an upload are not settings of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotSettings {
    /// They are no settings of any board, or other bytes follow them.
    Unreadable,
    /// They are those of a board with another number of axes.
    Axes {
        /// Number of axes of this board.
        board: u8,
    },
}

fn with_their_number<S: Serializer>(axes: &[AxisSettings], to: S) -> Result<S::Ok, S::Error> {
    axes.serialize(to)
}

impl<const N: usize> BoardSettings<N> {
    /// Reads the settings in the bytes of an upload.
    ///
    /// # Errors
    /// [`NotSettings`].
    pub fn read(bytes: &[u8]) -> Result<Self, NotSettings> {
        let unreadable = |_| NotSettings::Unreadable;
        let (rates, bytes) = postcard::take_from_bytes(bytes).map_err(unreadable)?;
        let (count, mut bytes) = postcard::take_from_bytes::<usize>(bytes).map_err(unreadable)?;
        if !(1..=MAX_AXES).contains(&count) {
            return Err(NotSettings::Unreadable);
        }
        if count != N {
            return Err(NotSettings::Axes { board: u8::try_from(N).unwrap_or(u8::MAX) });
        }
        let mut axes = [AxisSettings::default(); N];
        for axis in &mut axes {
            (*axis, bytes) = postcard::take_from_bytes(bytes).map_err(unreadable)?;
        }
        if bytes.is_empty() { Ok(Self { rates, axes }) } else { Err(NotSettings::Unreadable) }
    }
}
