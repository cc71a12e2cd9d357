//! Sparsity → matching → block-triangular order; what is not square is reported by name.

mod matching;
mod triangular;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::Model;
use crate::symbolic::{Leaf, NodeId, substitute::substitute};

/// The order in which the rows are solved.
#[derive(Debug)]
pub struct Structure {
    /// Diagonal blocks; each uses coordinates of earlier blocks and its own alone.
    pub blocks: Vec<Block>,
}

/// A diagonal block.
#[derive(Debug)]
pub struct Block {
    /// Rows, ascending.
    pub rows: Vec<usize>,
    /// Coordinates, ascending, as many as rows.
    pub coordinates: Vec<usize>,
    /// The coordinate as a function of earlier ones, where the row gives it explicitly.
    pub explicit: Option<Explicit>,
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
pub fn analyse(model: &Model, equations: &mut Equations, diagnostics: &mut Diagnostics) -> Option<Structure> {
    let rows: Vec<Vec<usize>> =
        equations.rows.iter().map(|row| row.phi_q.iter().map(|(column, _)| *column).collect()).collect();
    let matching = matching::match_rows(&rows, model.coordinates.len());
    report(model, &rows, &matching, diagnostics);
    if !diagnostics.is_empty() {
        return None;
    }
    let blocks = triangular::blocks(&rows, &matching)
        .into_iter()
        .map(|rows| {
            let mut coordinates: Vec<usize> =
                rows.iter().filter_map(|row| matching.of_row.get(*row).copied().flatten()).collect();
            coordinates.sort_unstable();
            let explicit = explicit(equations, &rows, &coordinates);
            Block { rows, coordinates, explicit }
        })
        .collect();
    Some(Structure { blocks })
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

fn report(model: &Model, rows: &[Vec<usize>], matching: &matching::Matching, diagnostics: &mut Diagnostics) {
    let mut used = vec![false; model.coordinates.len()];
    for column in rows.iter().flatten() {
        if let Some(mark) = used.get_mut(*column) {
            *mark = true;
        }
    }
    for (coordinate, _) in model.coordinates.iter().zip(&used).filter(|(_, used)| !**used) {
        diagnostics.report(
            coordinate.span,
            format!("coordinate `{}` stands in no constraint or drive", coordinate.name),
            "remove it, or add the row that fixes it; an angle that only outputs need is a `let`",
        );
    }
    for (row, _) in model.rows.iter().zip(rows).filter(|(_, columns)| columns.is_empty()) {
        diagnostics.report(
            row.span,
            format!("row `{}` contains no coordinate", row.name),
            "remove it, or write the coordinates that it ties",
        );
    }
    if !diagnostics.is_empty() {
        return;
    }
    let (n, m) = (model.coordinates.len(), model.rows.len());
    let square = if n == m { "part of the rows".into() } else { format!("{m} rows for {n} coordinates") };
    for coordinate in matching.free_columns().filter_map(|column| model.coordinates.get(column)) {
        diagnostics.report(
            coordinate.span,
            format!("{square}: nothing is left to fix coordinate `{}`", coordinate.name),
            "add a constraint, or drive a coordinate: `drive crank: phi == omega*t;`",
        );
    }
    for row in matching.free_rows().filter_map(|row| model.rows.get(row)) {
        diagnostics.report(
            row.span,
            format!("{square}: row `{}` finds no coordinate that other rows do not fix already", row.name),
            "remove the row if it follows from the others, or declare the coordinate that it is meant for",
        );
    }
}
