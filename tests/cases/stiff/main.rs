//! Stiff motions.
