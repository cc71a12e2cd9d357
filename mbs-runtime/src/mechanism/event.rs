//! Events of a text: conditions that begin and end them.

/// A condition of an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition<T> {
    /// It holds where this value exceeds the other one.
    pub larger: T,
    /// The other one, in the same unit.
    pub smaller: T,
}

/// Conditions of an event in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<T> {
    /// It begins where this one holds.
    pub begins: Condition<T>,
    /// It ends where this one holds; `None` if it never ends.
    pub ends: Option<Condition<T>>,
}
