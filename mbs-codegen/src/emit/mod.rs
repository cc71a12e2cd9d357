//! Back ends: Rust code, formulas to read, CasADi definitions; and the structure as data.

pub mod casadi;
pub mod formula;
pub mod report;
pub mod rust;
