//! Factors of printed products.

/// A factor that is printed `head` `tail`; an exponent is printed between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Atom {
    /// Text that an exponent follows.
    pub head: String,
    /// The argument, where the exponent of a function precedes it.
    pub tail: String,
    /// Place in a product.
    pub rank: Rank,
}

/// Order of the factors of a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// π
    Number,
    /// Constant in time.
    Parameter,
    /// Coordinate, input or time.
    Variable,
    /// Rate of one.
    Rate,
    /// Function of something.
    Function,
    /// Something to a power.
    Power,
    /// Sum in parentheses.
    Sum,
}
