//! Long code without repetition as data: a tape, which the runtime's `tape::run` works through.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::emit::rust::long::statement::{Operand, PUT, Statement, Wordings};
use crate::emit::rust::scope::{Scope, Written};
use crate::symbolic::{Node, NodeId, Unary};

/// Some statements as one tape.
pub struct Tape {
    /// Arrays that it reads, each with the places there.
    arrays: BTreeMap<String, Vec<usize>>,
    /// Values outside arrays: times, parameters.
    given: Vec<String>,
    /// Values of other parts.
    passed: Vec<NodeId>,
    numbers: Vec<f64>,
    /// Signs and operands, by the numbers of the values.
    runs: Vec<(u8, Vec<u16>)>,
    /// Values that it computes, and their numbers.
    defines: BTreeMap<NodeId, u16>,
    /// Values that are put in places, by their numbers.
    puts: Vec<(u16, usize)>,
    /// Total number of values.
    count: usize,
}

/// Operand of an operation.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Input {
    /// Element of an array, in the order in which they are read.
    Element(String, usize),
    Given(String),
    Value(NodeId),
    /// A number by its bits.
    Number(u64),
}

/// One operation.
struct Operation {
    opcode: u8,
    inputs: Vec<Input>,
    /// Values that it computes; of an angle sine and cosine.
    defines: Vec<Option<NodeId>>,
    /// Length of the longest chain of operations that ends in it.
    level: usize,
}

impl Tape {
    /// `true` if a tape accepts a statement: calls of declared functions are refused.
    pub fn accepts(statement: &Statement, wordings: &Wordings, scope: &Scope<'_>) -> bool {
        match statement.defines.first() {
            Some(id) => !matches!(scope.graph.node(*id), Node::Call { .. }),
            None => {
                matches!(statement.operands.as_slice(), [Operand::Place(_), _])
                    && wordings.text(statement.wording).starts_with(PUT)
            }
        }
    }

    /// Before: statements that it accepts, in their order. After: their operations in runs, operations of equal level together.
    pub fn of(statements: &[Statement], scope: &Scope<'_>) -> Self {
        let (mut operations, mut puts) = (Vec::new(), Vec::new());
        let mut levels: BTreeMap<NodeId, usize> = BTreeMap::new();
        for statement in statements {
            match statement.operands.as_slice() {
                [Operand::Place(place), operand] => puts.push((input_of(operand), *place)),
                _ => {
                    for (opcode, inputs, defines) in done(statement, scope) {
                        let inputs: Vec<Input> = inputs.into_iter().map(|id| input(id, scope)).collect();
                        let level =
                            1 + inputs.iter().filter_map(|input| level(input, &levels)).max().unwrap_or(0);
                        levels.extend(defines.iter().flatten().map(|id| (*id, level)));
                        operations.push(Operation { opcode, inputs, defines, level });
                    }
                }
            }
        }
        // A stable order: equal operations on neighbours remain neighbours.
        operations.sort_by_key(|operation| (operation.level, operation.opcode));
        Self::recorded(&operations, &puts, &levels)
    }

    /// Before: operations, operands first. After: these with a number for each value.
    fn recorded(operations: &[Operation], puts: &[(Input, usize)], own: &BTreeMap<NodeId, usize>) -> Self {
        let mut inputs: BTreeMap<Input, u16> = BTreeMap::new();
        let all = operations
            .iter()
            .flat_map(|operation| &operation.inputs)
            .chain(puts.iter().map(|(input, _)| input));
        for input in all {
            if !matches!(input, Input::Value(id) if own.contains_key(id)) {
                inputs.insert(input.clone(), 0);
            }
        }
        let mut tape = Tape {
            arrays: BTreeMap::new(),
            given: Vec::new(),
            passed: Vec::new(),
            numbers: Vec::new(),
            runs: Vec::new(),
            defines: BTreeMap::new(),
            puts: Vec::new(),
            count: 0,
        };
        for (input, number) in &mut inputs {
            *number = tape.next();
            match input {
                Input::Element(array, index) => tape.arrays.entry(array.clone()).or_default().push(*index),
                Input::Given(text) => tape.given.push(text.clone()),
                Input::Value(id) => tape.passed.push(*id),
                Input::Number(bits) => tape.numbers.push(f64::from_bits(*bits)),
            }
        }
        for alike in operations.chunk_by(|a, b| (a.level, a.opcode) == (b.level, b.opcode)) {
            let mut round = Vec::new();
            for input in alike.iter().flat_map(|operation| &operation.inputs) {
                round.push(tape.number(input, &inputs));
            }
            tape.runs.push((alike.first().map_or(0, |operation| operation.opcode), round));
            // Results are stored in columns.
            for column in 0..alike.first().map_or(0, |operation| operation.defines.len()) {
                for operation in alike {
                    let number = tape.next();
                    let defined = operation.defines.get(column).copied().flatten();
                    tape.defines.extend(defined.map(|id| (id, number)));
                }
            }
        }
        tape.puts = puts.iter().map(|(input, place)| (tape.number(input, &inputs), *place)).collect();
        tape
    }

    fn next(&mut self) -> u16 {
        let next = u16::try_from(self.count).unwrap_or(u16::MAX);
        self.count += 1;
        next
    }

    fn number(&self, input: &Input, inputs: &BTreeMap<Input, u16>) -> u16 {
        let own = if let Input::Value(id) = input { self.defines.get(id) } else { None };
        own.or_else(|| inputs.get(input)).copied().unwrap_or(u16::MAX)
    }

    /// Values that must be passed on to it.
    pub fn passed(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.passed.iter().copied()
    }

    /// Values that it computes.
    pub fn defines(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.defines.keys().copied()
    }

    /// Before: places of the values that are passed on. After: the body of a method.
    pub fn print(&self, slots: &BTreeMap<NodeId, usize>) -> String {
        let (mut bytes, mut arrays, mut missing) = (Vec::new(), Vec::new(), String::new());
        for (array, places) in &self.arrays {
            run(b'@', arrays.len(), places.len(), &mut bytes);
            places.iter().for_each(|index| place(*index, &mut bytes));
            arrays.push(format!("&{array}[..]"));
        }
        if !self.given.is_empty() {
            run(b'@', arrays.len(), self.given.len(), &mut bytes);
            (0..self.given.len()).for_each(|index| place(index, &mut bytes));
            arrays.push(format!("&[{}]", self.given.join(", ")));
        }
        run(b'<', 0, self.passed.len(), &mut bytes);
        for id in &self.passed {
            match slots.get(id) {
                Some(slot) => place(*slot, &mut bytes),
                // No code passes it on: an error of the compiler's, not a wrong number.
                None => drop(writeln!(missing, "__not_passed_{};", id.index())),
            }
        }
        run(b'#', 0, self.numbers.len(), &mut bytes);
        self.numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        for (opcode, round) in &self.runs {
            run(*opcode, 0, round.len() / operands(*opcode), &mut bytes);
            round.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        }
        let passed = self.defines.iter().filter_map(|(id, number)| Some((*number, *slots.get(id)?)));
        let passed: Vec<(u16, usize)> = passed.chain(self.puts.iter().copied()).collect();
        run(b'>', 0, passed.len(), &mut bytes);
        for (number, to) in passed {
            bytes.extend(number.to_le_bytes());
            place(to, &mut bytes);
        }
        format!(
            "const __TAPE: &[::core::primitive::u8] = b\"{}\";\n{missing}\
             __mbs::__private::tape::run(__TAPE, &[{}], &mut [T::constant(0.0f64); {}], &__v.0);\n",
            bytes.escape_ascii(),
            arrays.join(", "),
            self.count
        )
    }
}

/// The beginning of a run, if it has any rounds.
fn run(opcode: u8, array: usize, rounds: usize, bytes: &mut Vec<u8>) {
    let number = |count: usize| u16::try_from(count).unwrap_or(u16::MAX).to_le_bytes();
    if rounds > 0 {
        bytes.push(opcode);
        bytes.extend(number(array));
        bytes.extend(number(rounds));
    }
}

/// A place in 3 bytes.
fn place(index: usize, bytes: &mut Vec<u8>) {
    bytes.extend(index.to_le_bytes().iter().take(3));
}

/// Number of operands of an operation.
fn operands(opcode: u8) -> usize {
    match opcode {
        b'?' => 4,
        b'+' | b'-' | b'*' | b'/' | b'^' | b'2' | b'm' | b'M' | b'h' => 2,
        _ => 1,
    }
}

/// The operations of a statement: opcode, operands, values computed.
fn done(statement: &Statement, scope: &Scope<'_>) -> Vec<(u8, Vec<NodeId>, Vec<Option<NodeId>>)> {
    let mut angles: BTreeMap<NodeId, Vec<Option<NodeId>>> = BTreeMap::new();
    let mut done = Vec::new();
    for id in &statement.defines {
        let node = scope.graph.node(*id);
        if let Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) = node {
            let both = angles.entry(angle).or_insert_with(|| vec![None, None]);
            if let Some(place) = both.get_mut(usize::from(function == Unary::Cos)) {
                *place = Some(*id);
            }
        } else {
            done.push((opcode(node), node.operands().collect(), vec![Some(*id)]));
        }
    }
    done.extend(angles.into_iter().map(|(angle, both)| (b'c', vec![angle], both)));
    done
}

fn input(id: NodeId, scope: &Scope<'_>) -> Input {
    match scope.written(id) {
        Written::Local(id) => Input::Value(id),
        Written::Number(value) => Input::Number(value.to_bits()),
        Written::Element { array, index } => Input::Element(array, index),
        Written::Otherwise(text) => Input::Given(text),
    }
}

fn input_of(operand: &Operand) -> Input {
    match operand {
        Operand::Local(id) => Input::Value(*id),
        Operand::Number(value) => Input::Number(value.to_bits()),
        Operand::Element { array, index } => Input::Element(array.clone(), *index),
        Operand::Place(index) => Input::Number((*index as f64).to_bits()),
    }
}

fn level(input: &Input, levels: &BTreeMap<NodeId, usize>) -> Option<usize> {
    if let Input::Value(id) = input { levels.get(id).copied() } else { None }
}

/// Opcode of an operation on a tape; the runtime's `tape` knows the same ones.
fn opcode(node: Node) -> u8 {
    match node {
        Node::Unary(function, _) => function.entry().opcode,
        Node::Binary(function, ..) => function.entry().opcode,
        Node::Select { .. } => b'?',
        // None of these is a line of its own.
        Node::Constant(_) | Node::Leaf(_) | Node::Call { .. } => 0,
    }
}
