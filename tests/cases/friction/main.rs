//! Friction whose normal force is a Lagrange multiplier.

mod d11_shared_normal_forces;
mod d12_velocity_transformation_of_redundant_rows;
mod d16_free_play;
mod d17_fractional_exponents;
mod d18_gaps_of_tables;
mod d5_every_method;
mod d5_normal_forces;
#[cfg(feature = "long")]
mod d5_normal_forces_of_contacts;
mod d5_norms;
mod d5_rests;
mod d5_single_precision;
mod d5_slider_crank;
mod d5_small_motions;
mod d5_smooth_normal_forces;
mod frames;
