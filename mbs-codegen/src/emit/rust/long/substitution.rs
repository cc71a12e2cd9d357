//! The linear systems of a long mechanism: block after block as rounds of loops.

use std::collections::BTreeMap;

use crate::emit::rust::code::list;
use crate::emit::rust::long::parts::{ExtraArguments, Parts};
use crate::emit::rust::long::statement::{Open, Operand, Statement};
use crate::emit::rust::matrix_entries::MatrixEntries;
use crate::emit::rust::scope::quotient;
use crate::program::{BlockMethod, BlockProgram, Program};
use crate::symbolic::NodeId;

/// Bodies of the functions, and the methods that they call.
pub struct Substitution {
    pub solve: String,
    pub complete: String,
    pub reduce: String,
    pub methods: String,
}

/// Before: blocks in the order of solution, of each the place of its factors and their type, and the coordinates that none
/// solves for. After: their linear systems.
pub fn substitution(
    program: &Program,
    places: &[(String, String)],
    independent: &[usize],
    entries: &MatrixEntries<'_>,
) -> Substitution {
    let (n, m) = (entries.scope.model.coordinates.len(), entries.equations.rows.len());
    let right_side = format!("__b: &[T; {m}], ");
    let (solve, solved) =
        forward("__solve_linear", program, places, (&[], n), (&right_side, "__b, "), entries);
    let declared = format!("{right_side}__x: &mut [T; {n}], ");
    // Both are equal where no coordinate is given.
    let (complete, completed) = match independent.is_empty() {
        true => (solve.clone(), String::new()),
        false => forward("__complete", program, places, (independent, n), (&declared, "__b, __x, "), entries),
    };
    let (reduce, reduced) = backward(program, places, independent, entries);
    Substitution {
        solve: solve + "__v.kept()",
        complete: complete + "*__x = __v.kept();",
        reduce: reduce + "__v.kept()",
        methods: solved + &completed + &reduced,
    }
}

/// The unknowns of all blocks, the first one first, after `given` ones of `__x`.
fn forward(
    name: &str,
    program: &Program,
    places: &[(String, String)],
    (given, n): (&[usize], usize),
    (declared, handed): (&str, &str),
    entries: &MatrixEntries<'_>,
) -> (String, String) {
    let mut parts = Parts::new(BTreeMap::new(), 0, entries.scope.lengths);
    let mut statements = Vec::new();
    for coordinate in given {
        statements.push(parts.wordings.statement(|open, text| {
            let place = open.push(Operand::Place(*coordinate));
            *text = format!("__v.put({place}, {});\n", element("__x", *coordinate, open));
        }));
    }
    for (block, (place, kind)) in program.blocks.iter().zip(places) {
        statements.push(parts.wordings.statement(|open, text| {
            let method = if block.has_surplus() {
                format!("<__mbs::Orthogonal<T, {}, {}>>::solve", block.coordinates.len(), block.rows.len())
            } else {
                format!("<{kind} as __mbs::Factorization<T, {}>>::solve", block.rows.len())
            };
            let factors = factors(place, open);
            let right_sides = block.rows.iter().map(|row| {
                let beside = entries.columns_beside(*row, block).map(|(column, entry)| (*column, *entry));
                let known = element("__b", *row, open);
                subtracted(known, beside, entries, open)
            });
            *text = solved(block, (&factors, &method), right_sides.collect(), &block.coordinates, open);
        }));
    }
    finished(name, (declared, handed), statements, parts, n)
}

/// Φ_qdᵀ λ = y_d, the last block first, and the part of λ in the independent entries of y; empty where surplus rows leave λ open.
fn backward(
    program: &Program,
    places: &[(String, String)],
    independent: &[usize],
    entries: &MatrixEntries<'_>,
) -> (String, String) {
    let (n, m) = (entries.scope.model.coordinates.len(), entries.equations.rows.len());
    let mut parts = Parts::new(BTreeMap::new(), 0, entries.scope.lengths);
    let mut statements = Vec::new();
    let is_open = program.blocks.iter().any(BlockProgram::has_surplus);
    for (block, (place, kind)) in program.blocks.iter().zip(places).rev().filter(|_| !is_open) {
        statements.push(parts.wordings.statement(|open, text| {
            let method =
                format!("<{kind} as __mbs::Factorization<T, {}>>::solve_transposed", block.rows.len());
            let factors = factors(place, open);
            let right_sides = block.coordinates.iter().map(|coordinate| {
                let beside = entries.rows_beside(*coordinate, Some(block)).map(|(row, entry)| (*row, *entry));
                let known = element("__y", *coordinate, open);
                subtracted(known, beside, entries, open)
            });
            *text = solved(block, (&factors, &method), right_sides.collect(), &block.rows, open);
        }));
    }
    for coordinate in independent.iter().filter(|_| !is_open) {
        let rows: Vec<(usize, NodeId)> = entries.rows_beside(*coordinate, None).copied().collect();
        // A coordinate in no row keeps what it has.
        if !rows.is_empty() {
            statements.push(parts.wordings.statement(|open, text| {
                let known = element("__y", *coordinate, open);
                let value = subtracted(known, rows.into_iter(), entries, open);
                let place = open.push(Operand::Place(*coordinate));
                *text = format!(
                    "let __value = {value};\n__mbs::__private::chunks::put(__y, {place}, __value);\n"
                );
            }));
        }
    }
    finished("__reduce", (&format!("__y: &mut [T; {n}], "), "__y, "), statements, parts, m)
}

/// Before: all statements. After: the function's calls, and the methods.
fn finished(
    name: &str,
    (declared, given): (&str, &str),
    statements: Vec<Statement>,
    mut parts: Parts,
    unknowns: usize,
) -> (String, String) {
    let declared = format!("__factors: &__Factors<T>, {declared}");
    let frame = ExtraArguments { declared, given: format!("__factors, {given}"), result: None };
    let group = parts.lengths.group;
    let calls = parts.sequence(name, &frame, &statements, (group, None));
    let (methods, passed) = parts.reserved(unknowns).print();
    (format!("let __v = &__mbs::__private::chunks::Passed::<T, {passed}>::none();\n{calls}"), methods)
}

/// Assigns or solves a block; its unknowns go to the places `unknowns` of the passed values.
fn solved(
    block: &BlockProgram,
    (factors, method): (&str, &str),
    right_sides: Vec<String>,
    unknowns: &[usize],
    open: &mut Open,
) -> String {
    let names: Vec<String> = (0..unknowns.len()).map(|index| format!("__x{index}")).collect();
    let put = |(name, unknown): (&String, &usize)| {
        format!("__v.put({}, {name});\n", open.push(Operand::Place(*unknown)))
    };
    let puts: String = names.iter().zip(unknowns).map(put).collect();
    match &block.method {
        BlockMethod::Explicit { coefficient, .. } => {
            let assign = |(name, value): (&String, &String)| {
                format!("let {name} = {};\n", quotient(value, *coefficient))
            };
            names.iter().zip(&right_sides).map(assign).collect::<String>() + &puts
        }
        BlockMethod::Newton(_) => {
            let (names, right_sides) = (names.join(", "), list(right_sides.into_iter()));
            let of = if block.has_surplus() { "__surplus" } else { "__block" };
            format!(
                "if let ::core::option::Option::Some({of}) = {factors} {{\n\
                 let [{names}] = {method}({of}, &{right_sides});\n{puts}}}\n"
            )
        }
    }
}

/// `Option` of a block's factors.
fn factors(place: &str, open: &mut Open) -> String {
    let element = place.strip_suffix(']').and_then(|place| place.split_once('['));
    match element.and_then(|(kind, index)| Some((kind, index.parse().ok()?))) {
        Some((kind, index)) => format!("__factors.{kind}.get({})", open.push(Operand::Place(index))),
        None => format!("::core::option::Option::Some(&__factors.{place})"),
    }
}

fn element(array: &str, index: usize, open: &mut Open) -> String {
    open.push(Operand::Element { array: array.into(), index })
}

/// `known − Σ entry · value` over the values that have been passed on.
fn subtracted(
    known: String,
    beside: impl Iterator<Item = (usize, NodeId)>,
    entries: &MatrixEntries<'_>,
    open: &mut Open,
) -> String {
    let mut text = known;
    for (place, entry) in beside {
        let constant = entries.equations.graph.constant_value(entry);
        text += &match (constant, entries.kept.get(&entry)) {
            (Some(1.0), _) => " - ".to_owned(),
            (Some(-1.0), _) => " + ".to_owned(),
            (Some(value), _) => format!(" - {} * ", open.push(Operand::Number(value))),
            (None, Some(index)) => format!(" - {} * ", element("__factors.entries", *index, open)),
            (None, None) => continue,
        };
        text += &format!("__v.get({})", open.push(Operand::Place(place)));
    }
    text
}
