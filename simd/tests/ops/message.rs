//! WebAssembly without a system cannot print: the message of a failed test stays where `tests/wasm.mjs` finds it.

use std::ptr;
use std::sync::Once;
use std::sync::atomic::{AtomicPtr, Ordering};

static MESSAGE: AtomicPtr<u8> = AtomicPtr::new(ptr::null_mut());

/// From now on.
pub fn keep() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            let text = format!("{info}\0").into_bytes();
            MESSAGE.store(text.leak().as_mut_ptr(), Ordering::Relaxed);
        }));
    });
}

/// What the last panic said, with a zero at the end; null before there is one.
// SAFETY: no one else has a function of this name.
#[unsafe(no_mangle)]
extern "C" fn panic_message() -> *const u8 {
    MESSAGE.load(Ordering::Relaxed)
}
