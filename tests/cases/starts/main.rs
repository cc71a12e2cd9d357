//! Starts, first steps, equilibria, parameters of methods.
mod d23_dead_centres;
mod d24_far_rests;
mod d24_starts_in_line;
mod d25_rows_after_steps;
mod d7_absurd_steps;
mod d8_declared_starts;
mod d9_reference_length;
mod k7_times_of_steps;
