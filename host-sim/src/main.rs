//! The program `lost-motion`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    return_freed_memory();
    cli::run()
}

/// Fixes the sizes from which the allocator of the GNU C library takes memory from the system for one block alone, and from which
/// it returns freed memory. It would raise both with the largest block that was freed, up to 64 MB, and a trace of a long log would
/// take twice its memory. The default sizes of 128 kB, if fixed, would ask the system for each signal of each simulation. The number
/// of its arenas is limited too, as each keeps freed memory of its own: by default there are eight for each core.
fn return_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        const BLOCK_BYTES: libc::c_int = 1 << 22;
        const FREED_BYTES: libc::c_int = 1 << 23;
        const ARENAS: libc::c_int = 2;
        // SAFETY: sets numbers of the allocator, before any other thread exists.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, BLOCK_BYTES);
            libc::mallopt(libc::M_TRIM_THRESHOLD, FREED_BYTES);
            libc::mallopt(libc::M_ARENA_MAX, ARENAS);
        }
    }
}
