//! Hard cases: a mechanism by every method in many variants, each run judged by an oracle of its own.

pub mod oracle;
