//! Starts, first steps, equilibria, parameters of methods.
mod d24_starts_in_line;
mod d7_absurd_steps;
mod d8_declared_starts;
mod d9_reference_length;
mod k7_times_of_steps;
