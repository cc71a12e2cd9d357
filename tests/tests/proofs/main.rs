//! Proofs by compiler and linker, in one program: each keeps a single processor busy for a minute, so that they go side by side.
#![forbid(unsafe_code)]

mod freestanding;
mod from_c;
#[cfg(feature = "long")]
mod left_out;
#[cfg(feature = "long")]
mod panic_free;
mod scene_code;
