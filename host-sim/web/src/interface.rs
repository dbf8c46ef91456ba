//! The functions that the page calls, and the one that it offers.
//!
//! The page asks for a [`lost_motion_buffer`], writes a request into it, and gives it to [`lost_motion_answer`]; the answer begins with its length
//! (four bytes, little-endian). The page discards the whole memory with its worker; between two requests it calls [`lost_motion_free`].

use crate::answer;

#[cfg(target_arch = "wasm32")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Shows a message; of a panic as well.
    fn show(text: *const u8, length: usize);
}

/// Shows a message on the page.
#[cfg(target_arch = "wasm32")]
fn tell(message: &str) {
    // SAFETY: the page only reads the text, before it returns.
    unsafe { show(message.as_ptr(), message.len()) };
}

#[cfg(not(target_arch = "wasm32"))]
fn tell(_: &str) {}

/// A buffer for a request of this length; `lost_motion_answer` or `lost_motion_free` takes it back.
#[unsafe(no_mangle)]
pub extern "C" fn lost_motion_buffer(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Answers a request, which is freed.
///
/// # Safety
/// `request` is from [`lost_motion_buffer`] with this length, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lost_motion_answer(request: *mut u8, length: usize) -> *mut u8 {
    std::panic::set_hook(Box::new(|panic| tell(&format!("defect: {panic}"))));
    // SAFETY: by the contract of this function.
    let request = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(request, length)) };
    let answer = answer(&request, &tell);
    let length = u32::try_from(answer.len()).unwrap_or(u32::MAX).to_le_bytes();
    Box::into_raw([&length[..], &answer].concat().into_boxed_slice()).cast()
}

/// Frees an answer; `length` is that of its first bytes, without them.
///
/// # Safety
/// `answer` is from [`lost_motion_answer`] and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lost_motion_free(answer: *mut u8, length: usize) {
    // SAFETY: by the contract of this function.
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(answer, length + 4)) });
}
