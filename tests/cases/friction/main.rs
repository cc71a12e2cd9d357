//! Friction whose normal force is a Lagrange multiplier.
