//! The linear systems of the diagonal blocks: factors, rates, multipliers.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::emit::rust::blocks::widths;
use crate::emit::rust::code::{bind, lets, list};
use crate::emit::rust::elimination::Eliminations;
use crate::emit::rust::jacobian_outputs;
use crate::emit::rust::long::factorization::{Factorizations, Rounds};
use crate::emit::rust::long::substitution::{Substitution, substitution};
use crate::emit::rust::long::{self, BlockKind};
use crate::emit::rust::matrix_entries::{MatrixEntries, unknown};
use crate::emit::rust::scope::{Scope, number, quotient};
use crate::equations::Equations;
use crate::program::{BlockMethod, BlockProgram, Program, System};
use crate::symbolic::NodeId;

/// Code of the linear systems.
pub struct Linear {
    /// Declaration of the factors.
    pub factors: String,
    /// Body of `factorize`, or of `partition`.
    pub factorize: String,
    /// Body of `solve_linear`: the unknowns of all blocks from the right-hand sides.
    pub solve: String,
    /// Body of `complete`: the dependent entries of `x` from the independent ones.
    pub complete: String,
    /// Body of `reduce`: the multipliers, and their part in the independent entries of `y`.
    pub reduce: String,
    /// Methods that long ones call.
    pub methods: String,
}

/// Before: blocks in the order of solution, and the coordinates that none solves for. After: the code of their linear
/// systems, a `long` one in parts.
pub fn linear(
    equations: &Equations,
    program: &Program,
    (scope, eliminations): (&Scope<'_>, &Eliminations),
    independent: &[usize],
    long: bool,
) -> Linear {
    let entries = MatrixEntries::of(equations, program, scope, long);
    let asked = jacobian_outputs::blocks(equations, program, scope.model);
    let kinds = if long { long::kinds(program) } else { BTreeMap::new() };
    let of_kinds = if long { long::factors(program, eliminations) } else { BTreeMap::new() };
    let mut rounds = Factorizations::default();
    let (mut diagonals, mut places) = (Vec::new(), Vec::new());
    for (index, block) in program.blocks.iter().enumerate() {
        let (mut place, size) = (format!("block{index}"), block.rows.len());
        let mut factors = eliminations.factorization(index, size);
        if let BlockMethod::Newton(system) = &block.method {
            let asked = asked.contains(&index);
            let kind = BlockKind::of(block, system);
            match kinds.get(&kind).filter(|_| !asked && !block.has_surplus()) {
                Some(number) => {
                    factors = of_kinds.get(&kind).cloned().unwrap_or(factors);
                    place = rounds.add(*number, block, (&factors, &entries));
                }
                None => {
                    let guarded = Factorized::Guarded { asked };
                    diagonals.push(diagonal(block, system, &entries, (index, &factors), guarded))
                }
            }
        }
        places.push((place, factors));
    }
    let rounds = rounds.print(&entries);
    let (factors, factorize) = in_one(&diagonals, &rounds, program, &entries);
    if long {
        let Substitution { solve, complete, reduce, methods } =
            substitution(program, &places, independent, &entries);
        let methods = rounds.methods + &methods;
        return Linear { factors, factorize, solve, complete, reduce, methods };
    }
    let n = scope.model.coordinates.len();
    let pieces = program.blocks.iter().zip(&places);
    let solved: String =
        pieces.map(|(block, (place, kind))| solution(block, (place, kind), &entries)).collect();
    let unknowns = list((0..n).map(unknown));
    let mut given = String::new();
    let known = independent.iter().map(|coordinate| (unknown(*coordinate), format!("__x[{coordinate}]")));
    bind(known, &mut given);
    Linear {
        factors,
        factorize,
        complete: complete(given + &solved, independent, n),
        solve: solved + &unknowns,
        reduce: reduce(transposed(program, &places, &entries), independent, &entries),
        methods: String::new(),
    }
}

fn multiplier(row: usize) -> String {
    format!("__l{row}")
}

/// A diagonal block that is factorised.
pub struct Diagonal {
    index: usize,
    /// Type of its factors.
    kind: String,
    /// `let`s of its factors and of the margin of all blocks so far.
    pub text: String,
    /// `true` if its own margin is kept, too.
    asked: bool,
}

/// Factorization of a block.
#[derive(Clone, Copy)]
pub enum Factorized {
    /// Finite factors even where the block is singular; its margin is kept where it is `asked` for.
    Guarded {
        /// `true` if the margin is asked for.
        asked: bool,
    },
    /// Unguarded factors, for callers that check the sum of all blocks' witnesses.
    Unguarded,
    /// Factors in the block's own order, for callers that ask if multipliers were bounded.
    Ordered,
}

impl Factorized {
    /// Trait of the factors.
    pub fn contract(self) -> &'static str {
        match self {
            Factorized::Ordered => "Elimination",
            Factorized::Guarded { .. } | Factorized::Unguarded => "Factorization",
        }
    }
}

/// The factors of a block, and their part of the margin.
pub fn diagonal(
    block: &BlockProgram,
    system: &System,
    entries: &MatrixEntries<'_>,
    (index, factors): (usize, &str),
    factorized: Factorized,
) -> Diagonal {
    let (equations, scope) = (entries.equations, entries.scope);
    let size = block.rows.len();
    let rows = list(system.phi_q.iter().map(|row| list(row.iter().map(|id| entries.of_block(*id)))));
    let one = has_one_metric(block, equations);
    let scale = |scales: &[NodeId], index: &usize| match one {
        true => number(1.0),
        false => scope.or_zero(scales.get(*index).copied()),
    };
    let row_scales = list(block.rows.iter().map(|row| scale(&equations.row_scales, row)));
    let scales = list(block.coordinates.iter().map(|c| scale(&equations.coordinate_scales, c)));
    let (row, coordinate) = (block.rows.first().unwrap_or(&0), block.coordinates.first().unwrap_or(&0));
    let (kind, mut text);
    if block.has_surplus() {
        kind = format!("__mbs::Orthogonal<T, {}, {size}>", block.coordinates.len());
        // There is no determinant, hence no orientation.
        let given = format!("&{rows}, &{row_scales}, &{scales}");
        let yields = |row: &usize| scope.model.rows.get(*row).is_some_and(|row| row.within.is_some());
        let factorize = match block.rows.iter().any(yields) {
            true => {
                let places = list(block.rows.iter().map(usize::to_string));
                let widths = widths(scope.model, &places);
                format!("factorize_yielding({given}, {widths})")
            }
            false => format!("factorize({given})"),
        };
        text = format!(
            "let (__block{index}, __value) = <{kind}>::{factorize};\n\
             let __margin = __margin.with_block(__value, {row}, {coordinate});\n"
        );
    } else {
        kind = factors.to_owned();
        let given = format!("(&{rows}, &{row_scales}, &{scales})");
        let call = match factorized {
            Factorized::Guarded { .. } => format!(
                "let (__block{index}, __value) = <{kind} as __mbs::Factorization<T, {size}>>::factorize{given};"
            ),
            Factorized::Unguarded => format!(
                "let (__block{index}, __value, __witness) = <{kind} as __mbs::Factorization<T, {size}>>::factorize_unguarded{given};\nlet __sum = __sum + __witness;"
            ),
            Factorized::Ordered => format!(
                "let (__block{index}, __value, __bounded) = <{kind} as __mbs::Elimination<T, {size}>>::eliminate{given};\nlet __ordered = __ordered & __bounded;"
            ),
        };
        let contract = factorized.contract();
        text = format!(
            "{call}\n\
             let __margin = __margin.with_block(__value, {row}, {coordinate})\
             .oriented(<{kind} as __mbs::{contract}<T, {size}>>::reverses(&__block{index}));\n"
        );
    }
    let asked = matches!(factorized, Factorized::Guarded { asked: true });
    if asked {
        let _ = writeln!(text, "let __margin{index} = __value;");
    }
    Diagonal { index, kind, text, asked }
}

/// `true` if all rows of a closed form have one scale and all coordinates another: its margin is that without them.
fn has_one_metric(block: &BlockProgram, equations: &Equations) -> bool {
    let are_equal = |scales: &[NodeId], indices: &[usize]| {
        let mut scales = indices.iter().map(|index| scales.get(*index));
        scales.next().is_none_or(|first| scales.all(|scale| scale == first))
    };
    matches!(block.rows.len(), 2 | 3)
        && !block.has_surplus()
        && are_equal(&equations.row_scales, &block.rows)
        && are_equal(&equations.coordinate_scales, &block.coordinates)
}

/// Declaration and body: blocks of one kind as `rounds`, others a field each.
fn in_one(
    diagonals: &[Diagonal],
    rounds: &Rounds,
    program: &Program,
    entries: &MatrixEntries<'_>,
) -> (String, String) {
    let (mut fields, mut names) = (rounds.fields.clone(), rounds.names.clone());
    let mut text = String::new();
    if entries.long {
        text += "let __entries = __mbs::Mechanism::phi_q_entries(self, __p, __s);\n";
    } else {
        lets(&program.phi_q, entries.scope, &mut text);
    }
    text += "let __margin = __mbs::Margin::<T>::regular();\n";
    text += &rounds.body;
    for Diagonal { index, kind, text: factorize, asked } in diagonals {
        let _ = writeln!(fields, "/// Diagonal block {index}.\nblock{index}: {kind},");
        let _ = write!(names, "block{index}: __block{index}, ");
        text += factorize;
        if *asked {
            let _ = writeln!(fields, "/// Its margin.\nmargin{index}: T,");
            let _ = write!(names, "margin{index}: __margin{index}, ");
        }
    }
    let (count, kept) = match entries.long {
        true => (entries.places.len(), "__entries".to_owned()),
        false => (entries.kept.len(), list(entries.kept.keys().map(|id| entries.scope.operand(*id)))),
    };
    let _ = write!(text, "(__Factors {{ entries: {kept}, {names} }}, __margin)");
    let declaration = format!(
        "/// Factorised diagonal blocks, and the entries of Φ_q off them.\n\
         #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]\n\
         pub struct __Factors<T: __mbs::Scalar> {{\n\
         /// Entries off the diagonal blocks.\nentries: [T; {count}],\n{fields}}}"
    );
    (declaration, text)
}

/// The unknowns of a block from the right-hand sides and earlier unknowns.
fn solution(block: &BlockProgram, (place, kind): (&str, &str), entries: &MatrixEntries<'_>) -> String {
    let right_sides = block.rows.iter().map(|row| entries.right_side(*row, block));
    let defines: Vec<String> = block.coordinates.iter().map(|coordinate| unknown(*coordinate)).collect();
    match &block.method {
        BlockMethod::Explicit { coefficient, .. } => assigned(&defines, right_sides, *coefficient),
        BlockMethod::Newton(_) => {
            let (size, unknowns) = (block.rows.len(), defines.join(", "));
            let right_sides = list(right_sides);
            if block.has_surplus() {
                let kind = format!("__mbs::Orthogonal<T, {}, {size}>", block.coordinates.len());
                format!("let [{unknowns}] = <{kind}>::solve(&__factors.{place}, &{right_sides});\n")
            } else {
                format!(
                    "let [{unknowns}] = <{kind} as __mbs::Factorization<T, {size}>>::solve(&__factors.{place}, &{right_sides});\n"
                )
            }
        }
    }
}

/// Φ_qdᵀ λ = y_d, the last block first; empty where surplus rows leave λ open.
fn transposed(program: &Program, places: &[(String, String)], entries: &MatrixEntries<'_>) -> String {
    if program.blocks.iter().any(BlockProgram::has_surplus) {
        return String::new();
    }
    let pieces = program.blocks.iter().zip(places).rev().map(|(block, (place, kind))| {
        let name = |row: usize| multiplier(row);
        let right_sides = block.coordinates.iter().map(|c| entries.transposed(*c, Some(block), name));
        let defines: Vec<String> = block.rows.iter().map(|row| multiplier(*row)).collect();
        match &block.method {
            BlockMethod::Explicit { coefficient, .. } => assigned(&defines, right_sides, *coefficient),
            BlockMethod::Newton(_) => {
                let size = block.rows.len();
                let (multipliers, right_sides) = (defines.join(", "), list(right_sides));
                format!(
                    "let [{multipliers}] = <{kind} as __mbs::Factorization<T, {size}>>::solve_transposed(&__factors.{place}, &{right_sides});\n"
                )
            }
        }
    });
    pieces.collect()
}

fn assigned(locals: &[String], right_sides: impl Iterator<Item = String>, coefficient: f64) -> String {
    let assign =
        |(local, value): (&String, String)| format!("let {local} = {};\n", quotient(&value, coefficient));
    locals.iter().zip(right_sides).map(assign).collect()
}

fn complete(solved: String, independent: &[usize], coordinates: usize) -> String {
    let mut text = solved;
    for coordinate in (0..coordinates).filter(|coordinate| independent.binary_search(coordinate).is_err()) {
        let _ = writeln!(text, "__x[{coordinate}] = {};", unknown(coordinate));
    }
    text
}

fn reduce(solved: String, independent: &[usize], entries: &MatrixEntries<'_>) -> String {
    let mut text = solved;
    for coordinate in independent {
        let place = format!("__y[{coordinate}]");
        let value = entries.transposed(*coordinate, None, multiplier);
        // A coordinate in no row keeps what it has.
        if value != place {
            let _ = writeln!(text, "{place} = {value};");
        }
    }
    text + &list((0..entries.equations.rows.len()).map(multiplier))
}
