//! Sparsity → matching → block-triangular order; a system that is not square is reported by name.

#[cfg(test)]
mod analysed;
pub mod curvature;
pub mod dyad;
mod freedom;
mod independent;
mod matching;
pub mod mobility;
mod partition;
pub mod pivots;
mod polynomial;
pub mod sparse;
mod surplus;
mod triangular;

use std::collections::BTreeMap;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::Model;
use crate::model::expression::{Id, Node as Written};
use crate::symbolic::{Binary, Leaf, Node, NodeId, substitute::substitute};

use dyad::Dyad;
use matching::Matching;
use pivots::Order;

/// Most blocks with a curvature; the steps of more are loops, which take Newton's.
const MOST_CURVED: usize = 48;

/// The order in which the rows are solved.
#[derive(Debug)]
pub struct Structure {
    /// Diagonal blocks; each uses coordinates of earlier blocks, independent ones and its own alone.
    pub blocks: Vec<Block>,
    /// `true` if the rows fix every coordinate.
    pub square: bool,
    /// Coordinates that no block solves for, ascending.
    pub independent: Vec<usize>,
    /// The coordinate that each row is matched with; none for surplus rows of constraints marked `redundant`.
    pub matched: Vec<Option<usize>>,
}

impl Structure {
    /// `true` if there are more rows than can be matched.
    pub fn has_surplus(&self) -> bool {
        self.matched.iter().any(Option::is_none)
    }

    /// The roots that the equations do not have already, to be replaced.
    pub fn roots_mut(&mut self) -> Vec<&mut NodeId> {
        let mut roots = Vec::new();
        for block in &mut self.blocks {
            roots.extend(block.explicit.as_mut().map(|explicit| &mut explicit.value));
            roots.extend(block.dyad.iter_mut().flat_map(Dyad::nodes_mut));
            roots.extend(block.curvature.iter_mut().flatten().flatten());
        }
        roots
    }
}

/// A diagonal block.
#[derive(Debug)]
pub struct Block {
    /// Rows, ascending.
    pub rows: Vec<usize>,
    /// Coordinates, ascending, as many as rows; fewer where some of the rows may follow from others.
    pub coordinates: Vec<usize>,
    /// The coordinate as a function of earlier ones, where the row gives it explicitly.
    pub explicit: Option<Explicit>,
    /// The formula of both its positions, where it is a dyad.
    pub dyad: Option<Dyad>,
    /// The order in which four and more unknowns are eliminated.
    pub order: Option<Order>,
    /// Second derivatives of its rows, where it is a dyad of circles and lines; see [`curvature`](curvature::curvature).
    pub curvature: Option<Vec<Option<NodeId>>>,
}

/// A coordinate that its row gives explicitly.
#[derive(Debug)]
pub struct Explicit {
    /// Its value, of earlier coordinates and time alone.
    pub value: NodeId,
    /// Its constant coefficient in the row.
    pub coefficient: f64,
}

/// Before: the equations of a model without faults. After: the block-triangular order, or the faults reported.
///
/// A text without masses must be square; one with masses may leave coordinates free. Rows of constraints marked
/// `redundant` may be too many.
pub fn analyse(model: &Model, equations: &mut Equations, diagnostics: &mut Diagnostics) -> Option<Structure> {
    let rows: Vec<Vec<usize>> =
        equations.rows.iter().map(|row| row.phi_q.iter().map(|(column, _)| *column).collect()).collect();
    let matching = matching::match_in_order(&rows, model.coordinates.len(), surplus::order(model));
    report_cancelled(model, equations, diagnostics);
    if !diagnostics.is_empty() {
        return None;
    }
    match &equations.dynamics {
        Some(dynamics) => freedom::report(model, dynamics, &rows, diagnostics),
        None => report_missing(model, &rows, &matching, diagnostics),
    }
    report_surplus(model, &rows, &matching, diagnostics);
    report_branches(model, equations, diagnostics);
    independent::check(model, &rows, diagnostics);
    if !diagnostics.is_empty() {
        return None;
    }
    let square = matching.free_columns().next().is_none();
    if !square {
        report_references(model, equations, diagnostics);
    }
    let surplus: Vec<usize> = matching.free_rows().collect();
    let uncounted = square && surplus.is_empty() && is_uncounted(model);
    if !square && !surplus.is_empty() || uncounted {
        // No block is solved: the equations of motion take all rows together.
        let independent: Vec<usize> = (0..model.coordinates.len()).collect();
        missing_guesses(model, &[], &independent, diagnostics);
        let open = |row: usize| uncounted && model.rows.get(row).is_some_and(|row| row.redundant);
        let matched = matching.of_row.into_iter().enumerate();
        let matched = matched.map(|(row, column)| if open(row) { None } else { column }).collect();
        return diagnostics.is_empty().then_some(Structure {
            blocks: Vec::new(),
            square: false,
            independent,
            matched,
        });
    }
    let matching = if square { matching } else { partition::choose(model, &rows) };
    let independent: Vec<usize> = matching.free_columns().collect();
    let blocks = triangular::blocks(&rows, &matching)
        .into_iter()
        .filter_map(|rows| {
            let mut coordinates: Vec<usize> =
                rows.iter().filter_map(|row| matching.of_row.get(*row).copied().flatten()).collect();
            coordinates.sort_unstable();
            let explicit = explicit(equations, &rows, &coordinates);
            let dyad = if explicit.is_some() { None } else { dyad(equations, &rows, &coordinates) };
            let order = order(equations, &rows, &coordinates);
            // A surplus row is a part of its own that determines no coordinate.
            let curvature = None;
            (!coordinates.is_empty()).then_some(Block { rows, coordinates, explicit, dyad, order, curvature })
        })
        .collect::<Vec<_>>();
    let mut blocks = surplus::merged(blocks, &surplus, &rows, &matching, model.coordinates.len());
    curve(equations, &mut blocks);
    missing_guesses(model, &blocks, &independent, diagnostics);
    diagnostics.is_empty().then_some(Structure { blocks, square, independent, matched: matching.of_row })
}

/// Gives dyads of circles and lines their curvature, where blocks are not too many.
fn curve(equations: &mut Equations, blocks: &mut [Block]) {
    if blocks.iter().filter(|block| block.explicit.is_none()).count() > MOST_CURVED {
        return;
    }
    for Block { rows, coordinates, dyad, curvature, .. } in blocks {
        *curvature = dyad.as_ref().and_then(|dyad| curvature::curvature(equations, rows, coordinates, dyad));
    }
}

/// `true` if masses move freely although there are as many rows as coordinates. Then some rows follow from others, as the text
/// declares, and no coordinate is driven. By count such a loop is rigid: Bricard's mechanism.
fn is_uncounted(model: &Model) -> bool {
    let rows = &model.rows;
    model.dynamics.is_some() && rows.iter().any(|row| row.redundant) && !rows.iter().any(|row| row.driven)
}

/// Reports coordinates without a guess that Newton's method has to start from.
fn missing_guesses(model: &Model, blocks: &[Block], independent: &[usize], diagnostics: &mut Diagnostics) {
    let solved = blocks.iter().filter(|block| block.explicit.is_none()).flat_map(|block| &block.coordinates);
    let solved = solved.chain(independent);
    let coordinates = solved.filter_map(|coordinate| model.coordinates.get(*coordinate));
    // One message a declaration: the components of an array share their guess.
    let mut declarations: Vec<&crate::model::Coordinate> =
        coordinates.filter(|c| c.guess.is_none()).collect();
    let place = |coordinate: &crate::model::Coordinate| {
        let start = coordinate.span.start();
        (start.line, start.column)
    };
    declarations.sort_by_key(|coordinate| place(coordinate));
    declarations.dedup_by_key(|coordinate| place(coordinate));
    for coordinate in declarations {
        diagnostics.report(
            coordinate.span,
            format!("coordinate `{}` has no guess, and no row gives it explicitly", coordinate.name),
            format!("write where the assembly starts: `= 0.5` behind `{}`", coordinate.unit),
        );
    }
}

/// The coordinate of a one-row block solved for, where its coefficient is a number.
fn explicit(equations: &mut Equations, rows: &[usize], coordinates: &[usize]) -> Option<Explicit> {
    let (&[row], &[coordinate]) = (rows, coordinates) else { return None };
    let row = equations.rows.get(row)?;
    let (_, entry) = row.phi_q.iter().find(|(column, _)| *column == coordinate)?;
    let (phi, entry) = (row.phi, *entry);
    let g = &mut equations.graph;
    let coefficient = g.constant_value(entry).filter(|coefficient| coefficient.is_normal())?;
    let zero = g.constant(0.0);
    let rest = substitute(g, phi, |leaf| (leaf == Leaf::Position(coordinate as u32)).then_some(zero));
    let negative = g.negate(rest);
    let value = g.divide(negative, entry);
    Some(Explicit { value, coefficient })
}

/// A block of one or two rows as a formula of both its positions.
fn dyad(equations: &mut Equations, rows: &[usize], coordinates: &[usize]) -> Option<Dyad> {
    let phi = |row: usize| equations.rows.get(row).map(|row| row.phi);
    match (rows, coordinates) {
        (&[row], &[x]) => {
            let residual = phi(row)?;
            dyad::recognise_single(&mut equations.graph, residual, x)
        }
        (&[first, second], &[x, y]) => {
            let residuals = [phi(first)?, phi(second)?];
            dyad::recognise(&mut equations.graph, residuals, [x, y])
        }
        _ => None,
    }
}

/// The order of elimination within a block.
fn order(equations: &Equations, rows: &[usize], coordinates: &[usize]) -> Option<Order> {
    let entry = |row: &crate::equations::Row, coordinate: usize| {
        row.phi_q.iter().find(|(column, _)| *column == coordinate).map(|(_, entry)| *entry)
    };
    let scales: Vec<NodeId> = rows.iter().filter_map(|row| equations.row_scales.get(*row)).copied().collect();
    let rows = rows.iter().filter_map(|row| equations.rows.get(*row));
    let phi_q: Vec<Vec<Option<NodeId>>> =
        rows.map(|row| coordinates.iter().map(|coordinate| entry(row, *coordinate)).collect()).collect();
    pivots::order(&equations.graph, &phi_q, &scales)
}

/// The rows that contain each coordinate.
fn columns_of(rows: &[Vec<usize>], coordinates: usize) -> Vec<Vec<usize>> {
    let mut columns = vec![Vec::new(); coordinates];
    for (row, used) in rows.iter().enumerate() {
        for column in used {
            if let Some(column) = columns.get_mut(*column) {
                column.push(row);
            }
        }
    }
    columns
}

/// Names the coordinates that no row or too few rows fix.
fn report_missing(model: &Model, rows: &[Vec<usize>], matching: &Matching, diagnostics: &mut Diagnostics) {
    let columns = columns_of(rows, model.coordinates.len());
    for (coordinate, _) in model.coordinates.iter().zip(&columns).filter(|(_, rows)| rows.is_empty()) {
        diagnostics.report(
            coordinate.span,
            format!("coordinate `{}` stands in no constraint or drive", coordinate.name),
            "remove it, or add the row that fixes it; an angle that only outputs need is a `let`",
        );
    }
    let free = matching.free_columns().filter(|column| columns.get(*column).is_some_and(|c| !c.is_empty()));
    for part in parts(free, &columns, &matching.of_row) {
        let names = part.starts.iter().filter_map(|column| model.coordinates.get(*column));
        let names = list(names.map(|coordinate| coordinate.name.as_str()));
        let Some(first) = part.starts.first().and_then(|column| model.coordinates.get(*column)) else {
            continue;
        };
        let missing = part.starts.len() - part.ends.len();
        diagnostics.report(
            first.span,
            format!("{} for {names}: {missing} more needed", count(part.ends.len(), "row")),
            "add a constraint, or drive a coordinate: `drive crank: phi == omega*t;`",
        );
    }
}

/// Names the rows without a coordinate: others that are missing only follow.
fn report_cancelled(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let vanishes = |entry: NodeId| match equations.graph.node(entry) {
        Node::Binary(Binary::Subtract, a, b) => a == b,
        _ => false,
    };
    let rows = model.rows.iter().zip(&equations.rows);
    for (row, _) in rows.filter(|(_, row)| row.phi_q.iter().all(|(_, entry)| vanishes(*entry))) {
        let written = coordinates_of(model, row.residual);
        let names =
            list(written.iter().filter_map(|index| Some(model.coordinates.get(*index)?.name.as_str())));
        match written.as_slice() {
            [] => diagnostics.report(
                row.span,
                format!("row `{}` contains no coordinate", row.name),
                "remove it, or write the coordinates that it ties",
            ),
            _ => diagnostics.report(
                row.span,
                format!("row `{}` contains no coordinate: {names} cancels", row.name),
                format!("both sides have the same term; leave {names} on one side alone"),
            ),
        }
    }
}

/// Coordinates that an expression is written with.
fn coordinates_of(model: &Model, root: Id) -> Vec<usize> {
    let reached = model.expressions.reachable([root]);
    let nodes = model.expressions.iter().filter(|(id, _)| reached.get(id.index()) == Some(&true));
    nodes
        .filter_map(|(_, node)| match node {
            Written::Coordinate(index) => Some(index),
            _ => None,
        })
        .collect()
}

/// Names the rows that fix too few coordinates.
fn report_surplus(model: &Model, rows: &[Vec<usize>], matching: &Matching, diagnostics: &mut Diagnostics) {
    let marked = |row: usize| model.rows.get(row).is_some_and(|row| row.redundant);
    let free = matching.free_rows().filter(|row| rows.get(*row).is_some_and(|c| !c.is_empty()));
    let free = free.filter(|row| !marked(*row));
    for part in parts(free, rows, &matching.of_column) {
        let names = list(part.starts.iter().filter_map(|r| model.rows.get(*r)).map(|row| row.name.as_str()));
        let fixed = part.ends.iter().filter_map(|column| model.coordinates.get(*column));
        let fixed = list(fixed.map(|coordinate| coordinate.name.as_str()));
        let Some(last) = part.starts.last().and_then(|row| model.rows.get(*row)) else { continue };
        let surplus = part.starts.len() - part.ends.len();
        diagnostics.report(
            last.span,
            format!("{} {names} for {fixed}: {surplus} too many", count(part.starts.len(), "row")),
            surplus::cure(model, rows, &part.starts, surplus),
        );
    }
}

/// Names branches that no position decides.
fn report_branches(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let graph = &equations.graph;
    let is_coordinate = |id: &NodeId| matches!(graph.node(*id), Node::Leaf(Leaf::Position(_)));
    for (branch, value) in model.branches.iter().zip(&equations.branches) {
        if !graph.reachable([*value]).iter().any(is_coordinate) {
            diagnostics.report(
                branch.span,
                format!("branch `{}` contains no coordinate", branch.name),
                "write a condition on the coordinates that tells the assemblies apart",
            );
        }
    }
}

/// Names outputs of margins and ratios where the rows leave a coordinate free, though they are as many.
fn report_references(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let graph = &equations.graph;
    let is_given = |id: &NodeId| matches!(graph.node(*id), Node::Leaf(Leaf::Given(..)));
    for (output, derived) in model.outputs.iter().zip(&equations.outputs) {
        if graph.reachable([derived.value]).iter().any(is_given) {
            diagnostics.report(
                output.span,
                format!(
                    "output `{}` has a margin or ratio, and the rows leave a coordinate free",
                    output.name
                ),
                "drive what moves freely, or leave the output to a scene that does",
            );
        }
    }
}

/// A part that is not square: `starts` outnumber the `ends` that they are tied to.
struct NonSquarePart {
    starts: Vec<usize>,
    ends: Vec<usize>,
}

/// Before: unmatched nodes of one side, the edges from that side, and the match of each node of the other. After: all
/// nodes that alternating paths reach from them, ascending, one part a connected piece.
fn parts(
    free: impl Iterator<Item = usize>,
    edges: &[Vec<usize>],
    matched: &[Option<usize>],
) -> Vec<NonSquarePart> {
    let mut pieces: Vec<NonSquarePart> = Vec::new();
    // Piece that each piece is part of; itself, if there is none.
    let mut whole: Vec<usize> = Vec::new();
    let mut owners: BTreeMap<usize, usize> = BTreeMap::new();
    for start in free {
        let piece = pieces.len();
        let (mut starts, mut ends, mut waiting) = (vec![start], Vec::new(), vec![start]);
        whole.push(piece);
        while let Some(node) = waiting.pop() {
            for end in edges.get(node).into_iter().flatten() {
                // Parts that share an end are one, and the nodes reached from it are known.
                if let Some(owner) = owners.get(end) {
                    let root = root(*owner, &mut whole);
                    whole.get_mut(root).into_iter().for_each(|whole| *whole = piece);
                    continue;
                }
                owners.insert(*end, piece);
                ends.push(*end);
                let next = matched.get(*end).copied().flatten();
                starts.extend(next);
                waiting.extend(next);
            }
        }
        pieces.push(NonSquarePart { starts, ends });
    }
    let mut parts: BTreeMap<usize, NonSquarePart> = BTreeMap::new();
    for (piece, NonSquarePart { starts, ends }) in pieces.into_iter().enumerate() {
        let part = parts
            .entry(root(piece, &mut whole))
            .or_insert(NonSquarePart { starts: Vec::new(), ends: Vec::new() });
        part.starts.extend(starts);
        part.ends.extend(ends);
    }
    let mut parts: Vec<NonSquarePart> = parts.into_values().collect();
    for NonSquarePart { starts, ends } in &mut parts {
        starts.sort_unstable();
        ends.sort_unstable();
    }
    parts
}

/// Root of the tree of pieces that a piece is part of; the path to it is shortened.
fn root(piece: usize, whole: &mut [usize]) -> usize {
    let mut piece = piece;
    while let Some(above) = whole.get(piece).copied().filter(|above| *above != piece) {
        let next = whole.get(above).copied().unwrap_or(above);
        whole.get_mut(piece).into_iter().for_each(|above| *above = next);
        piece = next;
    }
    piece
}

/// Most names that a message lists.
const MOST_NAMES: usize = 8;

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    match names.get(..MOST_NAMES) {
        Some(first) if names.len() > MOST_NAMES => {
            format!("{} and {} more", first.join(", "), names.len() - MOST_NAMES)
        }
        _ => names.join(", "),
    }
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
