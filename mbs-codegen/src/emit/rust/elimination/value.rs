//! Entries of a matrix while it is eliminated: numbers of the text, and names with their values.

use crate::emit::rust::scope::number;

/// A number of the text, or a name with its value.
#[derive(Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Local(String),
}

impl Value {
    pub(super) fn text(&self) -> String {
        match self {
            Value::Number(value) => number(*value),
            Value::Local(name) => name.clone(),
        }
    }

    /// `true` if it is negative as it is written, and the text of the rest; no text for 1.
    pub(super) fn parts(&self) -> (bool, Option<String>) {
        match self {
            Value::Number(value) => (*value < 0.0, (value.abs() != 1.0).then(|| number(value.abs()))),
            Value::Local(name) => match name.strip_prefix('-') {
                Some(name) => (true, Some(name.to_owned())),
                None => (false, Some(name.clone())),
            },
        }
    }
}

/// Zero where there is none.
pub(super) type Entry = Option<Value>;

pub(super) fn at(entries: &[Entry], index: usize) -> Entry {
    entries.get(index).cloned().flatten()
}

pub(super) fn put(entries: &mut [Entry], index: usize, value: Entry) {
    if let Some(entry) = entries.get_mut(index) {
        *entry = value;
    }
}

/// The value with the other sign.
pub(super) fn negated(entry: &Entry) -> Entry {
    entry.as_ref().map(|value| match value {
        Value::Number(value) => Value::Number(-value),
        Value::Local(name) => match name.strip_prefix('-') {
            Some(name) => Value::Local(name.to_owned()),
            None => Value::Local(format!("-{name}")),
        },
    })
}
