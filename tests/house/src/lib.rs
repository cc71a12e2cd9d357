//! Tests of the layout alone.
