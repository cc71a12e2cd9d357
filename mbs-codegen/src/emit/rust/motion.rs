//! Position, velocity and acceleration in one function.

use std::fmt::Write;

use crate::emit::rust::blocks;
use crate::emit::rust::code::{lets, list};
use crate::emit::rust::elimination::Eliminations;
use crate::emit::rust::linear::{Factorized, diagonal};
use crate::emit::rust::long;
use crate::emit::rust::matrix_entries::MatrixEntries;
use crate::emit::rust::scope::{Scope, number, quotient};
use crate::equations::Equations;
use crate::program::motion::{self, BlockMotion};
use crate::program::{BlockMethod, BlockProgram, Program};

/// A compiler that saw where the rates are used would compute those of all blocks there, after the last position.
const IN_PLACE: &str = "let [__q, __qd, __qdd] = ::core::hint::black_box(__motion);\n";

/// Body of `solve_motion`, where the rates of a block can be solved while the next one waits for its position. Such blocks are
/// square, and several of them iterate or one has four or more unknowns. `position` builds the position stage from its values.
pub fn solve(
    equations: &Equations,
    program: &Program,
    (scope, eliminations): (&Scope<'_>, &Eliminations),
    position: &str,
) -> Option<String> {
    let fixed: usize = program.blocks.iter().map(|block| block.coordinates.len()).sum();
    let n = scope.model.coordinates.len();
    let square = fixed == n && !program.blocks.iter().any(BlockProgram::has_surplus);
    // The factors of a block alone are in line here, too.
    let gains = long::newton_blocks(program) > 1 || program.blocks.iter().any(has_order);
    if !square || !gains || long::is_long(program, scope.lengths) {
        return None;
    }
    let motion = motion::motion(equations, program);
    if program.length() + motion.length() > scope.lengths.function {
        return None;
    }
    let entries = MatrixEntries::of(equations, program, scope, false);
    let mut text = blocks::start();
    text += IN_PLACE;
    let _ = writeln!(
        text,
        "let __margin = __mbs::Margin::<T>::regular();\nlet __sum = {};\nlet __ordered = T::mask(true);",
        number(0.0)
    );
    for (index, (block, rates)) in program.blocks.iter().zip(&motion.blocks).enumerate() {
        let factors = eliminations.factorization(index, block.rows.len());
        blocks::position(equations, block, &factors, scope, &mut text);
        let factors = match eliminations.ordered(index) {
            Some(order) => (order, Factorized::Ordered),
            None => (factors, Factorized::Unguarded),
        };
        solved(block, rates, (index, &factors.0, factors.1), &entries, &mut text);
    }
    lets(&motion.rest, scope, &mut text);
    text += &format!(
        "__mbs::Solved {{ position: {position}, margin: __margin, sum: __sum, ordered: __ordered }}"
    );
    Some(text)
}

/// `true` if a block is eliminated in an order of its own.
fn has_order(block: &BlockProgram) -> bool {
    matches!(&block.method, BlockMethod::Newton(system) if system.order.is_some())
}

/// Factors of a block, its velocities and its accelerations, after its position.
fn solved(
    block: &BlockProgram,
    rates: &BlockMotion,
    (index, factors, factorized): (usize, &str, Factorized),
    entries: &MatrixEntries<'_>,
    text: &mut String,
) {
    let (equations, scope) = (entries.equations, entries.scope);
    lets(&rates.linear, scope, text);
    if let BlockMethod::Newton(system) = &block.method {
        *text += &diagonal(block, system, entries, (index, factors), factorized).text;
    }
    let right_sides = |array: &str, part: &dyn Fn(usize) -> String| -> Vec<String> {
        block.rows.iter().map(|row| entries.beside(*row, block, part(*row), array)).collect()
    };
    let of = |row: usize| equations.rows.get(row);
    // A row without Φ_t has −0: a difference from it is a change of sign.
    let rate = |row: usize| of(row).and_then(|row| row.phi_t).map(|id| format!("-{}", scope.operand(id)));
    let velocities = right_sides("__qd", &|row| rate(row).unwrap_or_else(|| number(-0.0)));
    let solution = format!("<{factors} as __mbs::{}<T, {}>>", factorized.contract(), block.rows.len());
    assign("__qd", block, (index, &solution), velocities, text);
    lets(&rates.gamma, scope, text);
    let accelerations = right_sides("__qdd", &|row| scope.or_zero(of(row).and_then(|row| row.gamma)));
    assign("__qdd", block, (index, &solution), accelerations, text);
}

/// The rates of a block from its right-hand sides.
fn assign(
    array: &str,
    block: &BlockProgram,
    (index, solution): (usize, &str),
    right_sides: Vec<String>,
    text: &mut String,
) {
    match &block.method {
        BlockMethod::Explicit { coefficient, .. } => {
            for (coordinate, value) in block.coordinates.iter().zip(right_sides) {
                let _ = writeln!(text, "{array}[{coordinate}] = {};", quotient(&value, *coefficient));
            }
        }
        BlockMethod::Newton(_) => {
            let right_sides = list(right_sides.into_iter());
            let unknowns = list(block.coordinates.iter().map(|coordinate| format!("{array}[{coordinate}]")));
            let _ = writeln!(text, "{unknowns} = {solution}::solve(&__block{index}, &{right_sides});");
        }
    }
}
