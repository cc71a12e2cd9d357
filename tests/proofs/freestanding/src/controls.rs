//! Controls: code that the proof must reject, in place of the proven code.

use core::hint::black_box;

/// Entry point, from which the linker collects the needed code.
#[unsafe(no_mangle)]
pub extern "C" fn proof_entry() -> bool {
    let mut met = false;
    #[cfg(feature = "control-panics")]
    {
        met |= black_box(indexes(black_box(7))) == 0;
    }
    #[cfg(feature = "control-allocates")]
    {
        met |= *black_box(allocates(black_box(7))) == 0;
    }
    met
}

/// An index that may be out of range.
#[cfg(feature = "control-panics")]
fn indexes(index: usize) -> u8 {
    black_box([1, 2, 3])[index]
}

#[cfg(feature = "control-allocates")]
use allocation::allocates;

#[cfg(feature = "control-allocates")]
mod allocation {
    extern crate alloc;

    use core::alloc::{GlobalAlloc, Layout};

    unsafe extern "C" {
        fn malloc(size: usize) -> *mut u8;
        fn free(pointer: *mut u8);
    }

    struct CLibrary;

    // SAFETY: as the C library's; never run.
    unsafe impl GlobalAlloc for CLibrary {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            // SAFETY: see above.
            unsafe { malloc(layout.size()) }
        }
        unsafe fn dealloc(&self, pointer: *mut u8, _: Layout) {
            // SAFETY: see above.
            unsafe { free(pointer) }
        }
    }

    #[global_allocator]
    static ALLOCATOR: CLibrary = CLibrary;

    /// A number on the heap.
    pub fn allocates(number: u64) -> alloc::boxed::Box<u64> {
        alloc::boxed::Box::new(number)
    }
}
