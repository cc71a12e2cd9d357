//! The block-triangular solution of positions.

use std::fmt::Write;

use crate::emit::rust::code::{lets, list};
use crate::emit::rust::elimination::Eliminations;
use crate::emit::rust::scope::{Scope, local, number};
use crate::equations::Equations;
use crate::model::Model;
use crate::program::{BlockMethod, BlockProgram, Program, System};
use crate::structure::dyad::Dyad;
use crate::symbolic::NodeId;

/// Body of `solve_with_position`; `position` builds the position stage from its values.
pub fn solve(
    equations: &Equations,
    program: &Program,
    eliminations: &Eliminations,
    scope: &Scope<'_>,
    position: &str,
) -> String {
    let mut text = start();
    for (index, block) in program.blocks.iter().enumerate() {
        let factors = eliminations.factorization(index, block.rows.len());
        self::position(equations, block, &factors, scope, &mut text);
    }
    lets(&program.rest, scope, &mut text);
    text + "(__outcome, " + position + ")"
}

/// Before any block.
pub fn start() -> String {
    "let __outcome = T::per_lane(|_| __mbs::Outcome::Converged);\n".into()
}

/// The coordinates of a block.
pub fn position(
    equations: &Equations,
    block: &BlockProgram,
    factors: &str,
    scope: &Scope<'_>,
    text: &mut String,
) {
    lets(&block.before, scope, text);
    match &block.method {
        BlockMethod::Explicit { value, .. } => {
            for coordinate in &block.coordinates {
                let _ = writeln!(text, "__q[{coordinate}] = {};", scope.operand(*value));
            }
        }
        BlockMethod::Newton(system) => newton(equations, block, (system, factors), scope, text),
    }
}

/// Solvers without a copy for each block share what they evaluate.
const EVALUATED: &str = "if __S::INLINED_PER_BLOCK { __evaluate(__x) } else { __mbs::__private::call_never_inlined(&mut __evaluate, __x) }";

/// A nonlinear block. The values kept of an iterate are stored with its coordinates, for a solver that ends elsewhere.
fn newton(
    equations: &Equations,
    block: &BlockProgram,
    (system, factors): (&System, &str),
    scope: &Scope<'_>,
    text: &mut String,
) {
    let System { section, kept, phi, phi_q, branches, branch_section, dyad, curvature, .. } = system;
    let inner = Scope { unknowns: &block.coordinates, ..*scope };
    let starts = list(block.coordinates.iter().map(|c| format!("__q[{c}]")));
    let size = block.coordinates.len();
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
        (Some(_), _) => format!("solve_closed::<{size}, {factors}>"),
        (None, true) => format!("solve::<{size}, {factors}>"),
        (None, false) => format!("solve_branched::<{size}, {factors}>"),
    };
    *text += "let (__x, __block) = ";
    if let Some((second, section)) = curvature {
        *text += "if const { __S::SECOND_ORDER } {\n";
        lets(section, scope, text);
        let second = list(second.iter().map(|id| scope.or_zero(*id)));
        let _ = writeln!(
            text,
            "__solver.solve_round::<{size}, {factors}>(&{description}, {starts}, \
             #[inline(always)] |__x| __evaluate(__x), &{second})\n}} else {{"
        );
    }
    let call = format!("__solver.{method}");
    let rows = list(block.rows.iter().map(usize::to_string));
    let widths = if surplus { widths(scope.model, &rows) } else { String::new() };
    let _ = write!(text, "{call}(&{description}, {widths}{starts}, #[inline(always)] |__x| {EVALUATED}");
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
        let _ = writeln!(text, "{}\n}}", formula(dyad, &mut |id| scope.operand(id)));
    }
    *text += if curvature.is_some() { ")\n};\n" } else { ");\n" };
    if !kept.is_empty() {
        *text += "let mut __values = __kept.get();\n\
                  if !__S::INLINED_PER_BLOCK && !__mbs::__private::is_same(&__values.0, &__x) {\n\
                  __mbs::__private::call_never_inlined(&mut __evaluate, &__x);\n__values = __kept.get();\n}\n";
        let _ = writeln!(text, "let {} = __values.1;", list(kept.iter().map(|id| local(*id))));
    }
    for (index, coordinate) in block.coordinates.iter().enumerate() {
        let _ = writeln!(text, "__q[{coordinate}] = __x[{index}];");
    }
    *text += "let __outcome = __mbs::__private::first_failure::<T>(__outcome, __block);\n";
}

/// Both positions of `Dyad::… { … }` or `Single::… { … }` with its coefficients, which are written in the order of the text.
pub fn formula(dyad: &Dyad, operand: &mut dyn FnMut(NodeId) -> String) -> String {
    let mut vector = |c: &[NodeId]| list(c.iter().map(|id| operand(*id)));
    let mut matrix = |a: &[[NodeId; 2]; 2]| list(a.iter().map(|row| vector(row)));
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
            let rows = list(rows.iter().map(|row| vector(row)));
            format!("__mbs::Dyad::Circles {{ rows: {rows} }}")
        }
        Dyad::Angle { a, c } => format!("__mbs::Single::Angle {{ a: {}, c: {} }}", vector(a), operand(*c)),
        Dyad::Length { row } => format!("__mbs::Single::Length {{ row: {} }}", vector(row)),
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

/// The argument of `solve_redundant` and `factorize_yielding` with the largest contradiction allowed between `rows`.
pub fn widths(model: &Model, rows: &str) -> String {
    match model.rows.iter().any(|row| row.within.is_some()) {
        true => format!("&__mbs::Widths::of(&__mbs::Mechanism::widths(self, __p), &{rows}), "),
        false => "&__mbs::Widths::none(), ".into(),
    }
}
