//! The equations of motion as an ordinary differential equation, and the stiff method that needs their slopes.

pub(crate) mod crossing;
pub(crate) mod equations;
pub(crate) mod events;
pub(crate) mod explicit;
pub(crate) mod modes;
pub(crate) mod phases;
pub(crate) mod radau;
