//! Inputs with rates, carried on between the instants at which a caller sets them.

use std::fmt::Write;

use crate::emit::rust::scope::place;
use crate::model::{Model, Role};

/// `HAS_SIGNALS` and `carry_signals`, where there are such inputs.
pub fn carry(model: &Model) -> String {
    let mut moves = String::new();
    for field in model.fields.iter().filter(|field| field.role == Role::InputWithRates) {
        for component in 0..field.shape.iter().product::<usize>() {
            // Value, rate and acceleration are three variables.
            let place = place(model, field.first + 3 * component);
            let _ = writeln!(moves, "self.{place} = __start.{place}.moved(__h);");
        }
    }
    if moves.is_empty() {
        return moves;
    }
    format!(
        "const HAS_SIGNALS: ::core::primitive::bool = true;\n#[inline]\n\
         fn carry_signals(&mut self, __start: &Self, __h: T) {{\n{moves}}}\n"
    )
}
