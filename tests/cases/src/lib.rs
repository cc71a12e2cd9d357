//! Faults that were found, one file for each: the text with the fault and tests of its class.
//!
//! A file's name begins with the code of its fault. The letter says how the fault was found, the number counts in the order of
//! discovery:
//!
//! | code | found by | target |
//! |---|---|---|
//! | `k1` to `k8` | kinematics of independent texts, in `f64` and `f32` | `kinematics`, `assemblies`; of the language `language` |
//! | `d1` to `d32` | motions from forces of independent texts | `singular`, `events`, `friction`, `stiff`, `starts`; of the language `language` |
//! | `t6` to `t8` | a line of the library changed on purpose, which no test noticed | the target of that line |
//!
//! The tests of this package are compiled without optimisation, which takes a fifth of the time. Those of very many steps stand in the
//! optimised package `mbs-motions`: `assemblies`, `singular` and `stiff`.
//!
//! The first line of each file says what the fault was. Several files with one code are tests of one class. A fault without a file of its own is
//! tested with the one with which it was found, or in tests of the changed code.

/// Stride through a sample of which the first tier takes every `stride`th member. With the feature `long` it is 1.
pub const fn every(stride: usize) -> usize {
    if cfg!(feature = "long") { 1 } else { stride }
}
