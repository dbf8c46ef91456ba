//! The settings of a board, and the upload that carries them.

use serde::{Serialize, Serializer};

use super::packet::MAX_AXES;
use super::refusal::{Refusal, UploadError};
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

fn with_their_number<S: Serializer>(axes: &[AxisSettings], to: S) -> Result<S::Ok, S::Error> {
    axes.serialize(to)
}

impl<const N: usize> BoardSettings<N> {
    /// Reads the settings in the bytes of an upload.
    ///
    /// # Errors
    /// [`Refusal::Axes`] if they are those of a board with another number of axes; [`Refusal::Upload`] if the bytes are no settings of any
    /// board, or others follow them.
    pub fn read(bytes: &[u8]) -> Result<Self, Refusal> {
        let unreadable = |_| Refusal::Upload(UploadError::Unreadable);
        let (rates, bytes) = postcard::take_from_bytes(bytes).map_err(unreadable)?;
        let (count, mut bytes) = postcard::take_from_bytes::<usize>(bytes).map_err(unreadable)?;
        if !(1..=MAX_AXES).contains(&count) {
            return Err(Refusal::Upload(UploadError::Unreadable));
        }
        if count != N {
            return Err(Refusal::Axes { board: u8::try_from(N).unwrap_or(u8::MAX) });
        }
        let mut axes = [AxisSettings::default(); N];
        for axis in &mut axes {
            (*axis, bytes) = postcard::take_from_bytes(bytes).map_err(unreadable)?;
        }
        if bytes.is_empty() {
            Ok(Self { rates, axes })
        } else {
            Err(Refusal::Upload(UploadError::Unreadable))
        }
    }
}
