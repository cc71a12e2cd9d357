//! Linkages through many turns: assemblies kept in every number type, number of lanes and kind of drive, and refusals where a way ends.
#![forbid(unsafe_code)]

mod linkages;

mod feet;
mod k1_assemblies_are_kept;
mod k1_dead_centres;
mod k1_inputs_that_turn;
mod k1_points_at_rest;
#[cfg(feature = "long")]
mod k1_redundant_rows;
mod k1_saved_states;
mod k1_short_links;
mod k1_short_links_in_sums;
mod k1_ways_that_end;
mod k1_ways_that_fold;
mod k2_single_precision;
mod k4_next_to_a_change_point;
mod t8_lanes_begin_at_their_own_values;
