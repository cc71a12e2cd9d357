//! Check that the coordinates that a text names as independent determine the others.

use super::{count, list, matching};
use crate::diagnostics::Diagnostics;
use crate::model::Model;

/// Before: columns that each row uses. After: a choice of independent coordinates that leaves others open, or with
/// too many or too few in it, is reported; a text that names none is not checked.
///
/// The rows that no drive declares, restricted to the other coordinates, need a perfect matching: without one their
/// Jacobian is singular at every position.
pub fn check(model: &Model, rows: &[Vec<usize>], diagnostics: &mut Diagnostics) {
    let Some(last) = model.independent.last() else { return };
    let is_independent = |column: usize| model.independent.iter().any(|chosen| chosen.coordinate == column);
    let constraints = rows.iter().zip(&model.rows).filter(|(_, row)| !row.driven);
    let restricted: Vec<Vec<usize>> = constraints
        .map(|(columns, _)| columns.iter().copied().filter(|column| !is_independent(*column)).collect())
        .collect();
    let freedom = model.coordinates.len().saturating_sub(restricted.len());
    if model.independent.len() != freedom {
        let message = format!(
            "{} named as independent, but {} left by the constraints",
            count(model.independent.len(), "coordinate"),
            count(freedom, "degree") + " of freedom"
        );
        let help = match model.independent.len() > freedom {
            true => "name fewer: the constraints tie some of them",
            false => "name as many coordinates as the constraints leave free",
        };
        diagnostics.report(last.span, message, help);
        return;
    }
    let matching = matching::match_rows(&restricted, model.coordinates.len());
    let open = matching.free_columns().filter(|column| !is_independent(*column));
    let open: Vec<&str> =
        open.filter_map(|column| model.coordinates.get(column)).map(|c| c.name.as_str()).collect();
    if open.is_empty() {
        return;
    }
    let chosen = model.independent.iter().filter_map(|chosen| model.coordinates.get(chosen.coordinate));
    let chosen = list(chosen.map(|coordinate| coordinate.name.as_str()));
    let message =
        format!("with {chosen} as independent no constraint determines {}", list(open.iter().copied()));
    diagnostics.report(last.span, message, "name it as independent in place of one that the constraints tie");
}
