//! Motion from forces through singular positions.
#![forbid(unsafe_code)]

mod d25_all_rows_vanish;
mod d2_augmented_lagrangian;
mod d2_four_bar;
mod d2_implicit_single_precision;
mod d2_parallelogram;
mod d2_single_precision;
mod d2_singular_positions_under_forces;
mod n_four_bars;
