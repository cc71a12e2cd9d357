//! Stiff motions.

mod d15_corrections_in_circles;
mod d15_equal_steps;
mod d15_features_of_a_text;
mod d15_limits_of_the_stiff_method;
mod d15_stiff_motions;
mod d32_unresolved_steps;
#[cfg(feature = "long")]
mod governor_long;
mod peers;
mod texts;
