//! The program `lost-motion`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    return_freed_memory();
    cli::run()
}

/// Keeps the size from which the allocator of the GNU C library returns freed memory to the system. It would raise this size to
/// that of the largest block that was freed, up to 32 MB, and a trace of a long log would take twice its memory.
fn return_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        const THRESHOLD_BYTES: libc::c_int = 1 << 17;
        // SAFETY: sets a number of the allocator, before any other thread exists.
        unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, THRESHOLD_BYTES) };
    }
}
