//! Time-stepping: steps of fixed size over impacts and changes of modes.

mod end;
mod inclusion;
mod middle;
pub(crate) mod moreau_jean;
