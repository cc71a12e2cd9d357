//! Starts, first steps, equilibria, parameters of methods.
mod d26_dead_centres;
mod d27_far_rests;
mod d28_starts_in_line;
mod d29_rows_after_steps;
mod d31_vanishing_gradients;
mod d7_absurd_steps;
mod d8_declared_starts;
mod d9_reference_length;
mod k7_times_of_steps;
