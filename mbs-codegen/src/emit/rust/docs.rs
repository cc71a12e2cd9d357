//! The generated doc comment: shapes, sparsity, block order, cost.

use crate::equations::Equations;
use crate::equations::continuity::{self, Demand};
use crate::model::dynamics::FirstOrderState;
use crate::model::{Model, Output};
use crate::program::{BlockMethod, Operations, Program};
use crate::structure::dyad::Dyad;
use crate::structure::mobility::{Mobility, mobility};
use crate::structure::pivots::Pivot;
use crate::structure::{Block, Structure};
use crate::symbolic::{NodeId, Stage};

/// Lines that follow the text's own doc comment.
pub fn structure(
    model: &Model,
    equations: &Equations,
    structure: &Structure,
    program: &Program,
) -> Vec<String> {
    let mut lines = vec![String::new()];
    shapes(model, &mut lines);
    freedom(model, equations, &mut lines);
    reference(model, &mut lines);
    lines.push(String::new());
    functions(model, equations, &mut lines);
    sparsity(model, equations, &mut lines);
    masses(model, equations, &mut lines);
    order(model, structure, &mut lines);
    cost(model, program, &mut lines);
    if structure.square {
        lines.push(String::new());
        lines.push("`WorstCase::WORST_CASE_OPERATIONS` is what a step of bounded work costs at most.".into());
    }
    lines.into_iter().map(|line| if line.is_empty() { line } else { format!(" {line}") }).collect()
}

fn shapes(model: &Model, lines: &mut Vec<String>) {
    let names = |names: Vec<String>| names.join(", ");
    lines.push("# Structure".into());
    lines.push(format!(
        "{} {}: {}.",
        model.coordinates.len(),
        plural("coordinate", model.coordinates.len()),
        names(model.coordinates.iter().map(|c| format!("`{}` ({})", c.name, c.unit)).collect())
    ));
    lines.push(format!(
        "{} {}: {}.",
        model.rows.len(),
        plural("row", model.rows.len()),
        names(model.rows.iter().map(|row| format!("`{}` ({})", row.name, row.unit(model))).collect())
    ));
    if !model.outputs.is_empty() {
        let outputs =
            model.outputs.iter().map(|output| format!("`{}` ({})", output.name, output.unit)).collect();
        lines.push(format!(
            "{} {}: {}.",
            model.outputs.len(),
            plural("output", model.outputs.len()),
            names(outputs)
        ));
    }
    if let Some(dynamics) = &model.dynamics {
        let list = |word: &str, entries: Vec<String>, lines: &mut Vec<String>| {
            if !entries.is_empty() {
                lines.push(format!(
                    "{} {}: {}.",
                    entries.len(),
                    plural(word, entries.len()),
                    entries.join(", ")
                ));
            }
        };
        let state = |state: &FirstOrderState| format!("`{}` ({})", state.name, state.unit);
        let bodies: Vec<String> = dynamics.bodies.iter().map(|body| format!("`{}`", body.name)).collect();
        if !bodies.is_empty() {
            let word = if bodies.len() == 1 { "body" } else { "bodies" };
            lines.push(format!("{} {word}: {}.", bodies.len(), bodies.join(", ")));
        }
        list("force", dynamics.forces.iter().map(|force| format!("`{}`", force.name)).collect(), lines);
        list("state", dynamics.states.iter().map(state).collect(), lines);
        let load = |load: &Output| format!("`{}` ({})", load.name, load.unit);
        list("load", dynamics.loads.iter().map(load).collect(), lines);
    }
}

/// Degrees of freedom, where a text need not be square.
fn freedom(model: &Model, equations: &Equations, lines: &mut Vec<String>) {
    if model.dynamics.is_none() {
        return;
    }
    let mobility = mobility(model, equations);
    let Mobility { coordinates, constraints, drives, rank, bodies, points, apart, .. } = mobility;
    let freedom = mobility.freedom();
    let of_rows = match model.rows.len() {
        0 => "no row takes any".into(),
        rows => format!("the structural rank of {rows} {} is {rank}", plural("row", rows)),
    };
    let degrees = if freedom == 1 { "degree" } else { "degrees" };
    lines.push(format!("{freedom} {degrees} of freedom: {of_rows}."));
    let driven = match drives {
        0 => String::new(),
        _ => format!(", the {drives} {} of drives left out", plural("row", drives)),
    };
    let mut count =
        format!("Grübler's count: {coordinates} − {constraints} = {}{driven}", mobility.grubler());
    if let Some(taken) = mobility.taken() {
        let of_bodies =
            (bodies > 0).then(|| format!("{bodies} {}", if bodies == 1 { "body" } else { "bodies" }));
        let of_points = (points > 0).then(|| format!("{points} {}", plural("point mass", points)));
        let apart_from_joints: Vec<String> = [of_bodies, of_points].into_iter().flatten().collect();
        count += &format!(
            "; {} would have {apart} freedoms apart, joints and guides take {taken}",
            apart_from_joints.join(" and ")
        );
    }
    lines.push(count + ".");
}

/// Reference length of the mechanism.
fn reference(model: &Model, lines: &mut Vec<String>) {
    if !model.is_measured_by_length() {
        return;
    }
    let longest = model.longest.iter().map(|longest| format!("`{}` ({} m)", longest.name, longest.length));
    let parameters = model.lengths.iter().filter_map(|index| model.variables.get(*index));
    let parameters = parameters.map(|parameter| format!("`{}`", parameter.name));
    let candidates: Vec<String> = longest.chain(parameters).collect();
    lines.push(match candidates.as_slice() {
        [] => "Reference length: 1 m, for no place, row, law or guess has a length.".into(),
        [one] => format!("Reference length: {one}."),
        _ => format!("Reference length: the largest of {}.", candidates.join(", ")),
    });
}

/// Derivatives that each declared function must provide.
fn functions(model: &Model, equations: &Equations, lines: &mut Vec<String>) {
    for demand in continuity::of_declarations(model, continuity::highest(model, equations)) {
        let Some(function) = model.functions.get(demand.function) else { continue };
        let Demand { order, by, .. } = demand;
        let (name, unit, argument) = (&function.name.text, function.declared_unit(), &function.argument_unit);
        let most = if order == 0 {
            "its value alone is used".into()
        } else {
            format!("{order} {} used, by {by} for one", plural("derivative", usize::from(order)))
        };
        lines.push(format!("Function `{name}` (`{unit}` of `{argument}`): {most}."));
        lines.push(String::new());
    }
    for missing in equations.dynamics.iter().flat_map(|dynamics| &dynamics.missing) {
        let Some(function) = model.functions.get(missing.function) else { continue };
        let (slope, derivative) = (missing.slopes.name(), missing.derivative());
        let (name, declared) = (function.label(), function.continuity);
        lines.push(format!(
            "No implicit methods, rests and small motions: {slope} needs {derivative} of `{name}`, declared C{declared}."
        ));
        lines.push(String::new());
    }
}

fn plural(word: &str, count: usize) -> String {
    match word {
        _ if count == 1 => word.into(),
        _ if word.ends_with('s') => format!("{word}es"),
        _ => format!("{word}s"),
    }
}

/// Widest matrix that is drawn.
const WIDEST: usize = 40;

fn sparsity(model: &Model, equations: &Equations, lines: &mut Vec<String>) {
    let (n, m) = (model.coordinates.len(), model.rows.len());
    let entries: usize = equations.rows.iter().map(|row| row.phi_q.len()).sum();
    lines.push(format!("`Φ_q` has {entries} of {} entries", n * m));
    if n > WIDEST {
        return lines.push(String::new());
    }
    let last = lines.len() - 1;
    if let Some(line) = lines.get_mut(last) {
        line.push_str(" (1: a number, p: parameters alone, x: varies):");
    }
    let names = model.rows.iter().map(|row| row.name.as_str()).collect();
    pattern(model, equations, names, equations.rows.iter().map(|row| &row.phi_q), lines);
}

/// The mass matrix, where the text has one.
fn masses(model: &Model, equations: &Equations, lines: &mut Vec<String>) {
    let Some(dynamics) = &equations.dynamics else { return };
    let n = model.coordinates.len();
    let entries: usize = dynamics.mass.iter().map(Vec::len).sum();
    if n > WIDEST {
        lines.push(format!("`M` has {entries} of {} entries", n * n));
        return lines.push(String::new());
    }
    lines.push(format!("`M` has {entries} of {} entries (marked as above):", n * n));
    let names = model.coordinates.iter().map(|c| c.name.as_str()).collect();
    pattern(model, equations, names, dynamics.mass.iter(), lines);
}

/// Draws a matrix with a column a coordinate.
fn pattern<'a>(
    model: &Model,
    equations: &Equations,
    names: Vec<&str>,
    rows: impl Iterator<Item = &'a Vec<(usize, NodeId)>>,
    lines: &mut Vec<String>,
) {
    lines.push("```text".into());
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let heads: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
    lines.push(format!("{:width$}  {}", "", heads.join(" ")).trim_end().to_owned());
    for (name, row) in names.iter().zip(rows) {
        let mut line = format!("{name:width$} ");
        for (column, head) in heads.iter().enumerate() {
            let mark = row.iter().find(|(c, _)| *c == column).map_or('.', |(_, entry)| {
                match equations.graph.stage(*entry) {
                    Stage::Constant => '1',
                    Stage::Parameter => 'p',
                    _ => 'x',
                }
            });
            line += &format!(" {mark:^width$}", width = head.chars().count());
        }
        lines.push(line.trim_end().to_owned());
    }
    lines.push("```".into());
    lines.push(String::new());
}

fn order(model: &Model, structure: &Structure, lines: &mut Vec<String>) {
    let independent: Vec<String> = structure
        .independent
        .iter()
        .filter_map(|coordinate| model.coordinates.get(*coordinate))
        .map(|coordinate| format!("`{}`", coordinate.name))
        .collect();
    let independent =
        if independent.is_empty() { String::new() } else { format!(" from {}", independent.join(", ")) };
    lines.push(format!("Solved block after block{independent}:"));
    for (number, block) in structure.blocks.iter().enumerate() {
        let rows: Vec<_> = block
            .rows
            .iter()
            .filter_map(|r| model.rows.get(*r))
            .map(|row| format!("`{}`", row.name))
            .collect();
        let coordinates: Vec<_> = block
            .coordinates
            .iter()
            .filter_map(|c| model.coordinates.get(*c))
            .map(|c| format!("`{}`", c.name))
            .collect();
        let unknowns = block.coordinates.len();
        let how = match (&block.explicit, block.rows.len()) {
            (Some(_), _) => "explicit".into(),
            (None, size) if size > unknowns => {
                format!(
                    "Gauss–Newton, {size} × {unknowns} by orthogonal factors; rows may follow from others"
                )
            }
            (None, size @ 1..=2) if block.dyad.is_some() => {
                let name = block.dyad.as_ref().map_or("", Dyad::name);
                format!("{name}: assembled from both its positions; Newton, {size} × {size} in closed form")
            }
            (None, size @ 1..=3) => format!("Newton, {size} × {size} in closed form"),
            (None, size) => format!("Newton, {size} × {size} by {}", elimination(model, block)),
        };
        lines.push(format!("{}. {} from {} ({how})", number + 1, coordinates.join(", "), rows.join(", ")));
    }
    lines.push(String::new());
}

/// Method of the linear solution of a block with four and more unknowns.
pub fn elimination(model: &Model, block: &Block) -> String {
    let Some(order) = &block.order else { return "LU with pivoting".into() };
    let name = |column: &usize| {
        let coordinate = block.coordinates.get(*column).and_then(|index| model.coordinates.get(*index));
        coordinate.map_or("", |coordinate| coordinate.name.as_str())
    };
    let together = |pivot: &Pivot| pivot.columns.iter().map(name).collect::<Vec<_>>().join(" with ");
    let pivots: Vec<String> = order.pivots.iter().map(together).collect();
    format!("elimination of {}; LU with pivoting where that loses digits", pivots.join(", then "))
}

fn cost(model: &Model, program: &Program, lines: &mut Vec<String>) {
    lines.push("# Cost".into());
    lines.push("Operations of each emitted function, on top of the stages before it:".into());
    lines.push(String::new());
    // Texts without declared functions need no column for them.
    let (head, rule) = if model.functions.is_empty() { ("", "") } else { (" declared functions |", "---|") };
    lines.push(format!("| function | + − | × | ÷ | sin, cos | other functions | selections |{head}"));
    lines.push(format!("|---|---|---|---|---|---|---|{rule}"));
    for (name, count) in costs(program) {
        let Operations { additions, multiplications, divisions, sine_cosines, functions, selects, calls } =
            count;
        let calls = if model.functions.is_empty() { String::new() } else { format!(" {calls} |") };
        lines.push(format!(
            "| {name} | {additions} | {multiplications} | {divisions} | {sine_cosines} | {functions} | {selects} |{calls}"
        ));
    }
}

/// Operations of each emitted function, on top of the stages before it, under the name that the documentation gives it.
pub fn costs(program: &Program) -> Vec<(&'static str, Operations)> {
    let blocks = program.blocks.iter();
    let mut before = program.rest.operations;
    let mut iteration = Operations::default();
    for block in blocks {
        before += block.before.operations;
        if let BlockMethod::Newton(system) = &block.method {
            iteration += system.section.operations;
        }
    }
    let table = [
        ("`parameters` (once a design)", program.parameters.section.operations),
        ("`position` (once a `(q, t)`)", program.position.section.operations),
        ("`phi`", program.phi.operations),
        ("`phi_q`", program.phi_q.operations),
        ("`phi_t`", program.phi_t.operations),
        ("`phi_tt`", program.phi_tt.operations),
        ("`phi_qt_qd`", program.phi_qt_qd.operations),
        ("`gamma`", program.gamma.operations),
        ("`branches`", program.branches.operations),
        ("`limits`", program.limits.operations),
        ("`outputs`", program.outputs.operations),
    ];
    let mut table = table.to_vec();
    if !program.blocks.is_empty() {
        table.push(("`solve_with_position`, once", before));
        table.push(("`solve_with_position`, each iteration of every block", iteration));
    }
    if let Some(dynamics) = &program.dynamics {
        table.extend([
            ("`mass`", dynamics.mass.operations),
            ("`mass_times`", dynamics.mass_times.operations),
            ("`force`", dynamics.force.operations),
            ("`force_q`", dynamics.force_q.operations),
            ("`force_qd`", dynamics.force_qd.operations),
            ("`mass_times_q`", dynamics.mass_times_q.operations),
            ("`reaction`", dynamics.reaction.operations),
            ("`reaction_q`", dynamics.reaction_q.operations),
            ("`energy`", dynamics.energy.operations),
            ("`powers`", dynamics.powers.operations),
            ("`state_rates`", dynamics.state_rates.operations),
            ("`loads`", dynamics.loads.operations),
        ]);
        if !dynamics.carried.lines.is_empty() {
            table.push(("`carried`", dynamics.carried.operations));
        }
    }
    table
}
