//! Long motions of the ready mechanisms: a package of its own, so that its tests are optimised and the others build soon.
