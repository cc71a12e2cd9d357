//! Starts, first steps, equilibria, parameters of methods.
mod d8_declared_starts;
