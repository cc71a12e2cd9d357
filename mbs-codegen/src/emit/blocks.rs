//! The block-triangular solution: nonlinear for positions, linear for rates.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::code::{lets, local};
use super::given;
use super::scope::{Scope, number};
use crate::equations::Equations;
use crate::program::{BlockProgram, Method, Program, System};
use crate::structure::dyad::Dyad;
use crate::symbolic::NodeId;

/// Body of `solve_with_position`; `position` makes the position stage of its values.
pub fn solve(equations: &Equations, program: &Program, scope: &Scope<'_>, position: &str) -> String {
    let mut text = String::from("let __outcome = T::per_lane(|_| __mbs::Outcome::Converged);\n");
    for block in &program.blocks {
        lets(&block.before, scope, &mut text);
        match &block.method {
            Method::Explicit { value, .. } => {
                for coordinate in &block.coordinates {
                    let _ = writeln!(text, "__q[{coordinate}] = {};", scope.operand(*value));
                }
            }
            Method::Newton(system) => newton(equations, block, system, scope, &mut text),
        }
    }
    lets(&program.rest, scope, &mut text);
    text + "(__outcome, " + position + ")"
}

/// A nonlinear block; what is kept of an iterate stands beside where that was, for a solver that ends elsewhere.
fn newton(
    equations: &Equations,
    block: &BlockProgram,
    system: &System,
    scope: &Scope<'_>,
    text: &mut String,
) {
    let System { section, kept, phi, phi_q, branches, branch_section, dyad } = system;
    let inner = Scope { unknowns: &block.coordinates, ..*scope };
    let starts = list(block.coordinates.iter().map(|c| format!("__q[{c}]")));
    let (size, kind) = (block.coordinates.len(), factorization(block.rows.len()));
    let description = description(equations, block, scope);
    if !kept.is_empty() {
        let (nowhere, zero, count) = (number(f64::INFINITY), number(0.0), kept.len());
        let _ =
            writeln!(text, "let __kept = ::core::cell::Cell::new(([{nowhere}; {size}], [{zero}; {count}]));");
    }
    let _ = writeln!(text, "let mut __evaluate = {{ #[inline(always)] |__x: &[T; {size}]| {{");
    lets(section, &inner, text);
    if !kept.is_empty() {
        let values = list(kept.iter().map(|id| inner.operand(*id)));
        let _ = writeln!(text, "__kept.set((*__x, {values}));");
    }
    let residuals = list(phi.iter().map(|id| inner.operand(*id)));
    let rows = list(phi_q.iter().map(|row| list(row.iter().map(|id| inner.or_zero(*id)))));
    let _ = writeln!(text, "({residuals}, {rows})\n}} }};");
    let surplus = block.has_surplus();
    let method = match (dyad, branches.is_empty()) {
        _ if surplus => format!("solve_redundant::<{size}, {}>", block.rows.len()),
        (Some(_), _) => format!("solve_closed::<{size}, {kind}>"),
        (None, true) => format!("solve::<{size}, {kind}>"),
        (None, false) => format!("solve_branched::<{size}, {kind}>"),
    };
    let call = format!("let (__x, __block) = __solver.{method}");
    let _ = write!(text, "{call}(&{description}, {starts}, #[inline(always)] |__x| __evaluate(__x)");
    if !branches.is_empty() {
        *text += ", |__x| {\n";
        lets(branch_section, &inner, text);
        let zero = number(0.0);
        let holds = branches.iter().map(|id| format!("T::less({zero}, {})", inner.operand(*id)));
        let _ = writeln!(text, "{}\n}}", holds.collect::<Vec<_>>().join(" & "));
    } else if dyad.is_some() || surplus {
        *text += ", |_| T::mask(true)\n";
    }
    if let Some((dyad, section)) = dyad {
        *text += ", |__near| {\n";
        lets(section, scope, text);
        let _ = writeln!(text, "{}\n}}", formula(dyad, scope));
    }
    *text += ");\n";
    if !kept.is_empty() {
        *text += "let mut __values = __kept.get();\n\
                  if !__mbs::mechanism::is_same(&__values.0, &__x) {\n\
                  __mbs::mechanism::called(&mut __evaluate, &__x);\n__values = __kept.get();\n}\n";
        let _ = writeln!(text, "let {} = __values.1;", list(kept.iter().map(|id| local(*id))));
    }
    for (index, coordinate) in block.coordinates.iter().enumerate() {
        let _ = writeln!(text, "__q[{coordinate}] = __x[{index}];");
    }
    *text += "let __outcome = __mbs::failure::first_failure::<T>(__outcome, __block);\n";
}

/// Both positions of `Dyad::… { … }` or `Single::… { … }` with its coefficients.
fn formula(dyad: &Dyad, scope: &Scope<'_>) -> String {
    let vector = |c: &[NodeId; 2]| list(c.iter().map(|id| scope.operand(*id)));
    let matrix = |a: &[[NodeId; 2]; 2]| list(a.iter().map(vector));
    let formula = match dyad {
        Dyad::Bars { a, b, c, unknowns } => {
            let unknowns =
                list(unknowns.iter().map(|row| list(row.iter().map(|entry| format!("{entry}.0")))));
            let (a, b, c) = (matrix(a), matrix(b), vector(c));
            format!("__mbs::Dyad::Bars {{ a: {a}, b: {b}, c: {c}, unknowns: {unknowns} }}")
        }
        Dyad::Slide { a, b, c, angle_first } => {
            let (a, b, c) = (matrix(a), vector(b), vector(c));
            format!("__mbs::Dyad::Slide {{ a: {a}, b: {b}, c: {c}, angle_first: {angle_first} }}")
        }
        Dyad::Telescope { a, b, c, angle_first } => {
            let (a, b, c) = (matrix(a), matrix(b), vector(c));
            format!("__mbs::Dyad::Telescope {{ a: {a}, b: {b}, c: {c}, angle_first: {angle_first} }}")
        }
        Dyad::Circles { rows } => {
            let rows = list(rows.iter().map(|row| list(row.iter().map(|id| scope.operand(*id)))));
            format!("__mbs::Dyad::Circles {{ rows: {rows} }}")
        }
        Dyad::Angle { a, c } => {
            format!("__mbs::Single::Angle {{ a: {}, c: {} }}", vector(a), scope.operand(*c))
        }
        Dyad::Length { row } => {
            format!("__mbs::Single::Length {{ row: {} }}", list(row.iter().map(|id| scope.operand(*id))))
        }
    };
    formula + ".roots(__near)"
}

/// `Block { … }` with its share of the metric.
fn description(equations: &Equations, block: &BlockProgram, scope: &Scope<'_>) -> String {
    let scale = |scales: &[NodeId], index: &usize| scope.or_zero(scales.get(*index).copied());
    let angle =
        |c: &usize| scope.model.coordinates.get(*c).is_some_and(|coordinate| coordinate.unit == "rad");
    format!(
        "__mbs::Block {{ rows: {}, coordinates: {}, angles: {}, row_scales: {}, coordinate_scales: {} }}",
        list(block.rows.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(usize::to_string)),
        list(block.coordinates.iter().map(|c| angle(c).to_string())),
        list(block.rows.iter().map(|row| scale(&equations.row_scales, row))),
        list(block.coordinates.iter().map(|c| scale(&equations.coordinate_scales, c))),
    )
}

fn factorization(size: usize) -> String {
    match size {
        1..=3 => format!("__mbs::Direct{size}<T>"),
        _ => format!("__mbs::Lu<T, {size}>"),
    }
}

/// What is emitted of the linear systems.
pub struct Linear {
    /// Declaration of the factors.
    pub factors: String,
    /// Body of `factorize`, or of `partition`.
    pub factorize: String,
    /// The unknowns of all blocks from the right-hand sides, one local each.
    pub solve: String,
    /// The multipliers from the transposed blocks, one local each, and what they leave at independent coordinates.
    pub reduce: String,
}

/// Before: blocks in the order of solution. After: the code of their linear systems.
pub fn linear(equations: &Equations, program: &Program, scope: &Scope<'_>) -> Linear {
    let entries = Entries::of(equations, program, scope);
    let mut fields = format!("/// Entries off the diagonal blocks.\nentries: [T; {}],\n", entries.kept.len());
    let mut factorize = String::new();
    lets(&program.phi_q, scope, &mut factorize);
    factorize += "let __margin = __mbs::Margin::<T>::regular();\n";
    let mut solve = String::new();
    let mut names = String::new();
    let asked = given::blocks(equations, program, scope.model);
    for (index, block) in program.blocks.iter().enumerate() {
        let right_sides: Vec<String> = block.rows.iter().map(|row| entries.right_side(*row, block)).collect();
        match &block.method {
            Method::Explicit { coefficient, .. } => {
                for (coordinate, right_side) in block.coordinates.iter().zip(&right_sides) {
                    let value = quotient(right_side, *coefficient);
                    let _ = writeln!(solve, "let __x{coordinate} = {value};");
                }
            }
            Method::Newton(system) => {
                let (size, kind) = (block.rows.len(), factorization(block.rows.len()));
                let rows = list(system.phi_q.iter().map(|row| list(row.iter().map(|id| scope.or_zero(*id)))));
                let scale = |scales: &[NodeId], index: &usize| scope.or_zero(scales.get(*index).copied());
                let row_scales = list(block.rows.iter().map(|row| scale(&equations.row_scales, row)));
                let scales = list(block.coordinates.iter().map(|c| scale(&equations.coordinate_scales, c)));
                let (row, coordinate) =
                    (block.rows.first().unwrap_or(&0), block.coordinates.first().unwrap_or(&0));
                let _ = write!(names, "block{index}: __block{index}, ");
                let unknowns = list(block.coordinates.iter().map(|c| format!("__x{c}")));
                let right_sides = list(right_sides.into_iter());
                if block.has_surplus() {
                    let kind = format!("__mbs::Orthogonal<T, {}, {size}>", block.coordinates.len());
                    let _ = writeln!(fields, "/// Diagonal block {index}.\nblock{index}: {kind},");
                    // No determinant, no orientation.
                    let _ = writeln!(
                        factorize,
                        "let (__block{index}, __value) = <{kind}>::factorize(&{rows}, &{row_scales}, &{scales});\n\
                         let __margin = __margin.with_block(__value, {row}, {coordinate});"
                    );
                    let _ = writeln!(
                        solve,
                        "let {unknowns} = <{kind}>::solve(&__factors.block{index}, &{right_sides});"
                    );
                    if asked.contains(&index) {
                        let _ = writeln!(fields, "/// Its margin.\nmargin{index}: T,");
                        let _ = writeln!(factorize, "let __margin{index} = __value;");
                        let _ = write!(names, "margin{index}: __margin{index}, ");
                    }
                    continue;
                }
                let _ = writeln!(fields, "/// Diagonal block {index}.\nblock{index}: {kind},");
                let _ = writeln!(
                    factorize,
                    "let (__block{index}, __value) = <{kind} as __mbs::Factorization<T, {size}>>::factorize(&{rows}, &{row_scales}, &{scales});\n\
                     let __margin = __margin.with_block(__value, {row}, {coordinate})\
                     .oriented(<{kind} as __mbs::Factorization<T, {size}>>::reverses(&__block{index}));"
                );
                if asked.contains(&index) {
                    let _ = writeln!(fields, "/// Its margin.\nmargin{index}: T,");
                    let _ = writeln!(factorize, "let __margin{index} = __value;");
                    let _ = write!(names, "margin{index}: __margin{index}, ");
                }
                let _ = writeln!(
                    solve,
                    "let {unknowns} = <{kind} as __mbs::Factorization<T, {size}>>::solve(&__factors.block{index}, &{right_sides});"
                );
            }
        }
    }
    let kept = list(entries.kept.keys().map(|id| scope.operand(*id)));
    let _ = write!(factorize, "(__Factors {{ entries: {kept}, {names} }}, __margin)");
    let factors = format!(
        "/// Factorised diagonal blocks, and the entries of Φ_q off them.\n\
         #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]\n\
         pub struct __Factors<T: __mbs::Scalar> {{\n{fields}}}"
    );
    Linear { factors, factorize, solve, reduce: reduce(program, &entries) }
}

/// Φ_qdᵀ λ = y_d, the last block first, then y_i − Φ_qiᵀ λ; nothing where surplus rows leave λ open.
fn reduce(program: &Program, entries: &Entries<'_>) -> String {
    let mut text = String::new();
    if program.blocks.iter().any(BlockProgram::has_surplus) {
        return text;
    }
    for (index, block) in program.blocks.iter().enumerate().rev() {
        let right_sides: Vec<String> =
            block.coordinates.iter().map(|c| entries.transposed(*c, Some(block))).collect();
        match &block.method {
            Method::Explicit { coefficient, .. } => {
                for (row, right_side) in block.rows.iter().zip(&right_sides) {
                    let _ = writeln!(text, "let __l{row} = {};", quotient(right_side, *coefficient));
                }
            }
            Method::Newton(_) => {
                let (size, kind) = (block.rows.len(), factorization(block.rows.len()));
                let multipliers = list(block.rows.iter().map(|row| format!("__l{row}")));
                let right_sides = list(right_sides.into_iter());
                let _ = writeln!(
                    text,
                    "let {multipliers} = <{kind} as __mbs::Factorization<T, {size}>>::solve_transposed(&__factors.block{index}, &{right_sides});"
                );
            }
        }
    }
    text
}

/// A value over a number.
fn quotient(value: &str, divisor: f64) -> String {
    match divisor {
        1.0 => value.to_owned(),
        -1.0 => format!("-({value})"),
        other => format!("({value}) / {}", number(other)),
    }
}

/// Body of `complete`: the dependent entries of `x` from the independent ones.
pub fn complete(independent: &[usize], solve: &str, coordinates: usize) -> String {
    let mut text = String::new();
    for coordinate in independent {
        let _ = writeln!(text, "let __x{coordinate} = __x[{coordinate}];");
    }
    text += solve;
    for coordinate in (0..coordinates).filter(|coordinate| !independent.contains(coordinate)) {
        let _ = writeln!(text, "__x[{coordinate}] = __x{coordinate};");
    }
    text
}

/// Body of `reduce`: the multipliers, and what they take from the independent entries of `y`.
pub fn reduced(
    equations: &Equations,
    scope: &Scope<'_>,
    program: &Program,
    independent: &[usize],
    reduce: &str,
) -> String {
    let entries = Entries::of(equations, program, scope);
    let mut text = reduce.to_owned();
    for coordinate in independent {
        let (place, value) = (format!("__y[{coordinate}]"), entries.transposed(*coordinate, None));
        // A coordinate in no row keeps what it has.
        if value != place {
            let _ = writeln!(text, "{place} = {value};");
        }
    }
    text + &list((0..equations.rows.len()).map(|row| format!("__l{row}")))
}

/// Entries of Φ_q off the diagonal blocks that are no numbers.
struct Entries<'a> {
    equations: &'a Equations,
    kept: BTreeMap<NodeId, usize>,
}

impl<'a> Entries<'a> {
    fn of(equations: &'a Equations, program: &Program, scope: &Scope<'_>) -> Self {
        let mut kept = BTreeMap::new();
        for block in &program.blocks {
            for row in block.rows.iter().filter_map(|row| equations.rows.get(*row)) {
                for (column, entry) in &row.phi_q {
                    if !block.coordinates.contains(column) && scope.graph.constant_value(*entry).is_none() {
                        kept.insert(*entry, 0);
                    }
                }
            }
        }
        for (index, slot) in kept.values_mut().enumerate() {
            *slot = index;
        }
        Entries { equations, kept }
    }

    /// `b − Σ Φ_q x` over coordinates of earlier blocks.
    fn right_side(&self, row: usize, block: &BlockProgram) -> String {
        let mut text = format!("__b[{row}]");
        let entries = self.equations.rows.get(row).map(|row| row.phi_q.as_slice()).unwrap_or_default();
        for (column, entry) in entries.iter().filter(|(column, _)| !block.coordinates.contains(column)) {
            self.subtract(*entry, &format!("__x{column}"), &mut text);
        }
        text
    }

    /// `y − Σ Φ_qᵀ λ` over the rows of later blocks; over all rows where the coordinate is independent.
    fn transposed(&self, coordinate: usize, block: Option<&BlockProgram>) -> String {
        let mut text = format!("__y[{coordinate}]");
        for (index, row) in self.equations.rows.iter().enumerate() {
            let entry = row.phi_q.iter().find(|(column, _)| *column == coordinate);
            if let Some((_, entry)) = entry.filter(|_| block.is_none_or(|block| !block.rows.contains(&index)))
            {
                self.subtract(*entry, &format!("__l{index}"), &mut text);
            }
        }
        text
    }

    /// ` - entry * factor`
    fn subtract(&self, entry: NodeId, factor: &str, text: &mut String) {
        match (self.kept.get(&entry), self.equations.graph.constant_value(entry)) {
            (_, Some(1.0)) => drop(write!(text, " - {factor}")),
            (_, Some(-1.0)) => drop(write!(text, " + {factor}")),
            (_, Some(value)) => drop(write!(text, " - {} * {factor}", number(value))),
            (Some(index), None) => drop(write!(text, " - __factors.entries[{index}] * {factor}")),
            (None, None) => {}
        }
    }
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}
