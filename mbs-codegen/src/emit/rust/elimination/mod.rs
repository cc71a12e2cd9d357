//! The elimination of a block in its order as straight-line code: a type of factors for each pattern.

mod margin;
mod pivots;
mod printer;
mod scales;
mod substitution;
mod value;

use std::collections::BTreeMap;

use self::printer::Printer;
use self::scales::Scales;
use self::value::Value;
use crate::equations::Equations;
use crate::program::{BlockMethod, BlockProgram, Operations, Program};
use crate::symbolic::NodeId;

/// Types of factors, and the type of each block.
pub struct Eliminations {
    /// Declarations, one a pattern.
    pub types: String,
    /// Number of the type of each block that has one, by the index of the block in the program.
    of_block: BTreeMap<usize, usize>,
}

impl Eliminations {
    /// Before: blocks with their orders. After: a type for each pattern that occurs.
    pub fn of(equations: &Equations, program: &Program) -> Self {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let mut of_block = BTreeMap::new();
        let mut types = String::new();
        for (index, block) in program.blocks.iter().enumerate() {
            let Some(elimination) = elimination(equations, block) else { continue };
            let next = numbers.len();
            let number = *numbers.entry(elimination.text.clone()).or_insert(next);
            if number == next {
                types += &elimination.text.replace(NAME, &name(number));
            }
            of_block.insert(index, number);
        }
        Eliminations { types, of_block }
    }

    /// Type of the factors of a diagonal block in its own order, where it has one.
    pub fn ordered(&self, index: usize) -> Option<String> {
        self.of_block.get(&index).map(|number| format!("{}<T>", name(*number)))
    }

    /// Type of the factors of a diagonal block.
    pub fn factorization(&self, index: usize, size: usize) -> String {
        match self.of_block.get(&index) {
            Some(number) => format!("__mbs::Guarded<{}<T>, T, {size}>", name(*number)),
            None => factorization(size),
        }
    }
}

/// Type of the factors of a diagonal block without an order of its own.
pub fn factorization(size: usize) -> String {
    match size {
        1..=3 => format!("__mbs::Direct{size}<T>"),
        _ => format!("__mbs::Lu<T, {size}>"),
    }
}

/// Placeholder of the type's name in its text, so that equal patterns have equal texts.
const NAME: &str = "__Order";

fn name(number: usize) -> String {
    format!("{NAME}{number}")
}

/// Operations of an order's code, without the closed form at its end.
#[derive(Default)]
pub struct Cost {
    /// The elimination.
    pub elimination: Operations,
    /// Comparisons of the elimination.
    pub comparisons: usize,
    /// A solution with its factors.
    pub substitution: Operations,
    /// Unknowns of the closed form.
    pub last: usize,
}

/// Costs of a block's order; none where it has none.
pub fn cost(equations: &Equations, block: &BlockProgram) -> Cost {
    elimination(equations, block).map_or_else(Default::default, |elimination| elimination.cost)
}

/// A type of factors, and what its functions cost.
struct Elimination {
    text: String,
    cost: Cost,
}

fn elimination(equations: &Equations, block: &BlockProgram) -> Option<Elimination> {
    let BlockMethod::Newton(system) = &block.method else { return None };
    let order = system.order.as_ref()?;
    let scales = Scales::of(equations, block);
    let graph = &equations.graph;
    let entry = |row: usize, (column, id): (usize, &Option<NodeId>)| {
        id.map(|id| match graph.constant_value(id) {
            Some(value) => Value::Number(value),
            None => Value::Local(format!("__a[{row}][{column}]")),
        })
    };
    let entries = system.phi_q.iter().enumerate();
    let entries =
        entries.map(|(row, line)| line.iter().enumerate().map(|entry_of| entry(row, entry_of)).collect());
    Some(Printer { entries: entries.collect(), scales, ..Printer::default() }.print(order))
}
