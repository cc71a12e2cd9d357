//! Motion from forces through singular positions.
