//! Starts, first steps, equilibria, parameters of methods.
