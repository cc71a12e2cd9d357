//! Friction whose normal force is a Lagrange multiplier.

mod d5_every_method;
mod d5_normal_forces;
mod d5_slider_crank;
