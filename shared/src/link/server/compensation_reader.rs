//! Reads the compensation of an upload setting by setting.
//!
//! The reader that serde derives has three copies of all settings on the stack at a time, 22 kB, which are more than anything else on the
//! stack of a board. Here the settings are where the caller wants them, and one of them is on the stack beside.

use serde::Deserialize;

use crate::compensate::CompensationSettings;

/// Reads the settings in the bytes of an upload, in postcard, to `settings`.
///
/// # Errors
/// If the bytes are no settings, or others follow them. The settings are those that were read until then.
#[inline(never)]
pub(super) fn read(mut bytes: &[u8], settings: &mut CompensationSettings) -> postcard::Result<()> {
    // In the order of the struct, as they are written; a setting that is missing here does not compile.
    let CompensationSettings {
        pitch,
        backlash_width_m,
        screw,
        dividing,
        reversal,
        intalk,
        crosstalk,
        squareness,
        straightness,
        ripple,
        force,
        stretch_m_per_n,
        drift,
        products,
        position_bound_m,
        position_rate_m_per_s,
        force_bound_n,
        force_rate_n_per_s,
    } = settings;
    let bytes = &mut bytes;
    next(bytes, pitch)?;
    next(bytes, backlash_width_m)?;
    next(bytes, screw)?;
    next(bytes, dividing)?;
    next(bytes, reversal)?;
    next(bytes, intalk)?;
    next(bytes, crosstalk)?;
    next(bytes, squareness)?;
    next(bytes, straightness)?;
    next(bytes, ripple)?;
    next(bytes, force)?;
    next(bytes, stretch_m_per_n)?;
    next(bytes, drift)?;
    next(bytes, products)?;
    next(bytes, position_bound_m)?;
    next(bytes, position_rate_m_per_s)?;
    next(bytes, force_bound_n)?;
    next(bytes, force_rate_n_per_s)?;
    if bytes.is_empty() { Ok(()) } else { Err(postcard::Error::DeserializeBadEncoding) }
}

/// Reads the next setting, and leaves the bytes behind it.
#[inline(never)]
fn next<'b, T: Deserialize<'b>>(bytes: &mut &'b [u8], setting: &mut T) -> postcard::Result<()> {
    (*setting, *bytes) = postcard::take_from_bytes(bytes)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::message::LONGEST_UPLOAD;

    /// Every setting has another value than the default, so that an exchange of two is noticed.
    #[test]
    fn the_settings_are_read_as_written() {
        let written = CompensationSettings {
            position_bound_m: 0.1,
            position_rate_m_per_s: 0.2,
            force_bound_n: 0.3,
            force_rate_n_per_s: 0.4,
            stretch_m_per_n: Some(0.7),
            ..CompensationSettings::longest()
        };
        let mut bytes = [0; LONGEST_UPLOAD];
        let bytes = postcard::to_slice(&written, &mut bytes).unwrap();
        let mut settings = CompensationSettings::default();
        assert_eq!(read(bytes, &mut settings), Ok(()));
        assert_eq!(settings, written);
        assert_eq!(postcard::take_from_bytes(bytes), Ok((settings, &[][..])));
    }

    /// No length but the right one is accepted.
    #[test]
    fn bytes_that_are_missing_or_left_over_are_refused() {
        let mut bytes = [0; LONGEST_UPLOAD + 1];
        let length = postcard::to_slice(&CompensationSettings::longest(), &mut bytes).unwrap().len();
        let mut settings = CompensationSettings::default();
        for wrong in (0..length).step_by(7).chain([length - 1, length + 1]) {
            assert!(read(&bytes[..wrong], &mut settings).is_err(), "{wrong} of {length} bytes");
        }
    }
}
