//! Program → Rust tokens; model → CasADi definition; equations → formulas; structure → report.

mod blocks;
pub mod casadi;
mod code;
mod docs;
pub mod formula;
mod functions;
mod item;
pub mod notation;
mod phases;
pub mod report;
mod scope;
mod stub;
mod terms;

use proc_macro2::TokenStream;

use crate::equations::Equations;
use crate::model::Model;
use crate::program::Program;
use crate::structure::Structure;
use crate::syntax::Text;

pub use stub::stub;

/// Before: a model without faults and its program. After: the struct, its views and its trait implementations.
pub fn rust(
    text: &Text,
    model: &Model,
    equations: &Equations,
    structure: &Structure,
    program: &Program,
) -> TokenStream {
    let docs = docs::structure(model, equations, structure, program);
    let bodies = functions::bodies(model, equations, program, &text.header.runtime);
    item::item(text, model, &docs, &bodies)
}
