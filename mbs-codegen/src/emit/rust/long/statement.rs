//! Lines of code whose operands are separate from their wording: lines that apply the same operation to other values are
//! recognised.

use std::collections::BTreeMap;

use crate::emit::rust::code::{Naming, SINE_COSINE, jet, sine_cosine, value};
use crate::emit::rust::scope::{Scope, Written};
use crate::program::Assignment;
use crate::symbolic::NodeId;

/// Placeholder of an operand in a wording.
pub const OPERAND: char = '\u{1}';

/// Placeholder of the name of a computed value in a wording.
pub const DEFINED: char = '\u{2}';

/// Calls of kernels with long code: inlined in each place, and through one function for all places.
pub const KERNELS: [(&str, &str); 3] = [
    (SINE_COSINE, "T::sin_cos_called("),
    ("::solve(__block, ", "::solve_called(__block, "),
    ("::solve_transposed(__block, ", "::solve_transposed_called(__block, "),
];

/// Call that stores a value among those that are passed on.
pub const PUT: &str = "__v.put(";

/// Most angles of one call where code is long: what a processor takes at once, and a bound on the length of a line.
const MOST_ANGLES: usize = 8;

/// One line.
#[derive(Clone, Debug)]
pub struct Statement {
    /// Number of its wording; equal for lines that differ in their operands alone.
    pub wording: usize,
    /// Its operands, in the order of the wording.
    pub operands: Vec<Operand>,
    /// Values that it computes, in the order of the wording.
    pub defines: Vec<NodeId>,
}

/// Operand of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// Value that another line computes.
    Local(NodeId),
    /// An element of an array, which the wording does not name.
    Element {
        /// The array.
        array: String,
        /// Its place there.
        index: usize,
    },
    /// A number.
    Number(f64),
    /// A place as such, of something to be written.
    Place(usize),
}

/// All wordings, numbered as they come.
#[derive(Default)]
pub struct Wordings {
    numbers: BTreeMap<String, usize>,
    texts: Vec<String>,
}

impl Wordings {
    /// The wording of a number.
    pub fn text(&self, number: usize) -> &str {
        self.texts.get(number).map_or("", String::as_str)
    }

    /// `true` if a statement of this number has a copy of some kernel in it.
    pub fn has_kernel(&self, number: usize) -> bool {
        KERNELS.iter().any(|(copied, _)| self.text(number).contains(copied))
    }

    /// Statements of a line: many angles are taken a few at a time.
    pub fn of_line(&mut self, line: &Assignment, scope: &Scope<'_>, statements: &mut Vec<Statement>) {
        match line {
            Assignment::Value(id) => {
                statements
                    .push(self.statement(|open, text| value(*id, scope, &mut Marked { open, scope }, text)));
            }
            Assignment::SineCosine(angles) => {
                for angles in angles.chunks(MOST_ANGLES) {
                    statements.push(
                        self.statement(|open, text| sine_cosine(angles, &mut Marked { open, scope }, text)),
                    );
                }
            }
            Assignment::Jet(called) => {
                statements
                    .push(self.statement(|open, text| jet(called, scope, &mut Marked { open, scope }, text)));
            }
        }
    }

    /// A call of `function` that puts a value in a place.
    pub fn put(
        &mut self,
        function: &str,
        place: usize,
        value: Option<NodeId>,
        scope: &Scope<'_>,
    ) -> Statement {
        self.statement(|open, text| {
            let place = open.push(Operand::Place(place));
            *text = format!("{function}{place}, {});\n", open.operand(value, scope));
        })
    }

    /// An assignment of a value to a coordinate of `__q`.
    pub fn assign(&mut self, coordinate: usize, value: NodeId, scope: &Scope<'_>) -> Statement {
        const ASSIGN: &str = "__mbs::__private::chunks::put(__q, ";
        let is_coordinate = matches!(scope.written(value), Written::Element { array, .. } if array == "__q");
        if !is_coordinate {
            return self.put(ASSIGN, coordinate, Some(value), scope);
        }
        // Another coordinate is read before the array is borrowed to be written.
        self.statement(|open, text| {
            let value = open.operand(Some(value), scope);
            let place = open.push(Operand::Place(coordinate));
            *text = format!("let __value = {value};\n{ASSIGN}{place}, __value);\n");
        })
    }

    /// A statement whose wording is printed with the placeholders that `Open` has for its operands.
    pub fn statement(&mut self, print: impl FnOnce(&mut Open, &mut String)) -> Statement {
        let (mut open, mut text) = (Open::default(), String::new());
        print(&mut open, &mut text);
        let mut key = text.clone();
        for operand in &open.operands {
            key.push(OPERAND);
            key += match operand {
                Operand::Local(_) => "local",
                Operand::Element { array, .. } => array,
                Operand::Number(_) => "number",
                Operand::Place(_) => "place",
            };
        }
        let next = self.texts.len();
        let wording = *self.numbers.entry(key).or_insert(next);
        if wording == next {
            self.texts.push(text);
        }
        Statement { wording, operands: open.operands, defines: open.defines }
    }
}

/// A statement that is being printed.
#[derive(Default)]
pub struct Open {
    operands: Vec<Operand>,
    defines: Vec<NodeId>,
}

impl Open {
    /// Adds an operand; returns its mark.
    pub fn push(&mut self, operand: Operand) -> String {
        self.operands.push(operand);
        OPERAND.to_string()
    }

    /// Adds an operand, zero where there is none; returns its mark, or its text where it has another form.
    pub fn operand(&mut self, id: Option<NodeId>, scope: &Scope<'_>) -> String {
        let written = id.map_or(Written::Number(0.0), |id| scope.written(id));
        self.push(match written {
            Written::Local(id) => Operand::Local(id),
            Written::Element { array, index } => Operand::Element { array, index },
            Written::Number(value) => Operand::Number(value),
            Written::Otherwise(text) => return text,
        })
    }
}

/// Operands and values of a line go into a statement; its wording has marks for them.
struct Marked<'a> {
    open: &'a mut Open,
    scope: &'a Scope<'a>,
}

impl Naming for Marked<'_> {
    fn operand(&mut self, id: NodeId) -> String {
        self.open.operand(Some(id), self.scope)
    }

    fn defined(&mut self, id: NodeId) -> String {
        self.open.defines.push(id);
        DEFINED.to_string()
    }

    fn place(&mut self, index: usize) -> Option<String> {
        Some(self.open.push(Operand::Place(index)))
    }
}
