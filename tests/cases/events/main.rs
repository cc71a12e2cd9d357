//! Events, contacts and limits within a step.

mod continued;
#[path = "../../../mbs-runtime/tests/worst_case/counted.rs"]
mod counted;
mod d10_settings;
mod d21_tables;
mod d30_touched_limits;
mod d3_contacts;
mod d3_events;
mod d3_fixed_steps;
mod d3_jumps;
mod d3_limits;
mod d3_many;
mod d3_open_contacts;
mod d3_spikes;
mod d4_zero_start;
mod declared;
mod declared_in_loops;
mod pulses;
mod released;
mod runs;
mod t7_contact_damping;
mod texts;
