//! Accelerations at small margins, rates at late times, singular positions, redundant rows.

mod k5_accelerations_at_small_margins;
mod k6_declared_branch_near_a_change_point;
mod k7_rates_at_late_times;
mod k7_singular_exactly;
mod k7_widths_of_redundant_rows;
