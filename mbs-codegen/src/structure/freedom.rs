//! Check that masses and rows give every coordinate an acceleration.

use super::{list, matching};
use crate::diagnostics::Diagnostics;
use crate::equations::{Dynamics, Sparse};
use crate::model::Model;

/// Before: masses, rows and their sparsity. After: coordinates that neither a mass nor a row moves are reported, and
/// energies that are no kinetic ones.
///
/// The matrix [M Φ_qᵀ; Φ_q 0] must not be singular by its sparsity alone.
pub fn report(model: &Model, dynamics: &Dynamics, rows: &[Vec<usize>], diagnostics: &mut Diagnostics) {
    let kinetics = model.dynamics.iter().flat_map(|declared| &declared.kinetics);
    for (index, kinetic) in kinetics.enumerate() {
        if dynamics.not_quadratic.contains(&index) {
            diagnostics.report(
                kinetic.span,
                format!("the kinetic energy `{}` is not quadratic in the rates", kinetic.name),
                "write `m*dot(v, v)/2` with `v = der(P)`; other terms may be linear in the rates or without them",
            );
        }
    }
    let count = model.coordinates.len();
    // Rows that fix no coordinate, and energies that are not quadratic, are reported as such.
    if !dynamics.not_quadratic.is_empty() || matching::match_rows(rows, count).free_rows().next().is_some() {
        return;
    }
    let system = saddle(&dynamics.mass, rows, count);
    let matching = matching::match_rows(&system, count + rows.len());
    let massless: Vec<usize> = matching.free_columns().filter(|column| *column < count).collect();
    let Some(first) = massless.first().and_then(|column| model.coordinates.get(*column)) else { return };
    let names = massless.iter().filter_map(|column| model.coordinates.get(*column));
    diagnostics.report(
        first.span,
        format!("neither a mass nor a row moves {}", list(names.map(|coordinate| coordinate.name.as_str()))),
        "give a body that moves with it a mass, or add the row that fixes it",
    );
}

/// Sparsity of [M Φ_qᵀ; Φ_q 0].
fn saddle(mass: &Sparse, rows: &[Vec<usize>], count: usize) -> Vec<Vec<usize>> {
    let columns = super::columns_of(rows, count);
    let upper = mass.iter().zip(&columns).map(|(mass, rows)| {
        let mass = mass.iter().map(|(column, _)| *column);
        mass.chain(rows.iter().map(|row| count + row)).collect()
    });
    upper.chain(rows.iter().cloned()).collect()
}
