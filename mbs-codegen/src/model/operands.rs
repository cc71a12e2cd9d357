//! Values that wait for their operator; a declared array is kept by its name: the cost of `A[0]` does not depend on A's length.

use proc_macro2::Span;

use super::names::{Names, Symbol};
use super::value::{Fault, Scalar, Value};

/// A stack of operands, made by an expression whose names live for `'a`.
#[derive(Default)]
pub struct Operands<'a> {
    stack: Vec<Operand<'a>>,
}

enum Operand<'a> {
    Value(Value),
    /// A name with a value, and its token.
    Named(&'a str, Span),
}

impl<'a> Operands<'a> {
    /// Puts a value on top.
    pub fn push(&mut self, value: Value) {
        self.stack.push(Operand::Value(value));
    }

    /// Puts the value of `name` on top.
    pub fn push_named(&mut self, name: &'a str, span: Span) {
        self.stack.push(Operand::Named(name, span));
    }

    /// Takes the topmost value.
    pub fn pop(&mut self, names: &Names) -> Result<Value, Fault> {
        match self.stack.pop() {
            Some(operand) => whole(operand, names),
            None => Err(Fault),
        }
    }

    /// Takes the `count` topmost values, the topmost one last.
    pub fn pop_many(&mut self, count: usize, names: &Names) -> Result<Vec<Value>, Fault> {
        let taken = self.stack.split_off(self.stack.len().saturating_sub(count));
        taken.into_iter().map(|operand| whole(operand, names)).collect()
    }

    /// Lengths of the topmost array.
    pub fn top_shape(&self, names: &Names) -> Result<Vec<usize>, Fault> {
        match self.stack.last() {
            Some(Operand::Value(value)) => Ok(value.shape.clone()),
            Some(Operand::Named(name, _)) => Ok(named(name, names)?.shape.clone()),
            None => Err(Fault),
        }
    }

    /// Takes the topmost array and returns its `length` components from the one at `first` on.
    pub fn pop_components(
        &mut self,
        first: usize,
        length: usize,
        names: &Names,
    ) -> Result<Vec<Scalar>, Fault> {
        match self.stack.pop() {
            Some(Operand::Value(value)) => Ok(value.items.into_iter().skip(first).take(length).collect()),
            Some(Operand::Named(name, span)) => {
                let items = named(name, names)?.items.iter().skip(first).take(length);
                Ok(items.map(|item| Scalar { span, ..*item }).collect())
            }
            None => Err(Fault),
        }
    }
}

fn named<'a>(name: &str, names: &'a Names) -> Result<&'a Value, Fault> {
    match names.get(name) {
        Some(Symbol::Value(value)) => Ok(value),
        _ => Err(Fault),
    }
}

/// A value with all its components.
fn whole(operand: Operand<'_>, names: &Names) -> Result<Value, Fault> {
    match operand {
        Operand::Value(value) => Ok(value),
        Operand::Named(name, span) => {
            let value = named(name, names)?;
            let items = value.items.iter().map(|item| Scalar { span, ..*item }).collect();
            Ok(Value { shape: value.shape.clone(), items, span })
        }
    }
}
