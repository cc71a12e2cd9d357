//! The language: texts that were misread, refused without need, or answered by messages of the compiler.

mod d19_units_of_numbers;
mod d1_rows_on_euler_parameters;
mod d20_rates_in_lets;
mod k3_powers_of_numbers_with_units;
mod k8_names_of_rust;
mod picture;
mod sums_and_ratios;
mod t6_threshold_of_dependent_rows;
