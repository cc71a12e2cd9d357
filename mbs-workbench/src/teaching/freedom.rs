//! Degrees of freedom: rows without the drives, their rank, independent and dependent coordinates.

use mbs_codegen::StructureReport;

use super::rank::{independent_columns, rank};
use crate::erased::facade::{AnyEquations, State};

/// The count of a mechanism at one position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Freedom {
    /// Coordinates.
    pub coordinates: usize,
    /// Rows of constraints.
    pub constraints: usize,
    /// Rows of drives.
    pub drives: usize,
    /// Largest rank that the constraints' sparsity allows.
    pub structural_rank: usize,
    /// Rank of the constraints' Jacobian at the position.
    pub rank: usize,
    /// Rank of the whole Jacobian, drives included, at the position.
    pub whole_rank: usize,
    /// Indices of the independent coordinates: those that the text names, else those that drives prescribe, as far as the
    /// rank allows.
    pub independent: Vec<usize>,
    /// `true` if the text names them, and they determine the others at the position.
    pub declared: bool,
    /// Indices of the dependent coordinates.
    pub dependent: Vec<usize>,
    /// Indices of constraints that follow from the others at the position.
    pub redundant: Vec<usize>,
}

/// Counts `mechanism`, of structure `report`, at `q` and `t` (s).
pub fn freedom(mechanism: &dyn AnyEquations, report: &StructureReport, q: &[f64], t: f64) -> Freedom {
    let n = q.len();
    let rows = scaled_jacobian(mechanism, q, t);
    let constrained: Vec<usize> =
        report.rows.iter().enumerate().filter(|(_, row)| !row.driven).map(|(index, _)| index).collect();
    let constraints: Vec<Vec<f64>> = constrained.iter().map(|index| rows[*index].clone()).collect();
    let mut preferred = vec![false; n];
    report.independent.iter().for_each(|column| preferred[*column] = true);
    if report.independent.is_empty() {
        let driven_rows = report.rows.iter().filter(|row| row.driven);
        driven_rows.flat_map(|row| &row.entries).for_each(|(column, _)| preferred[*column] = true);
    }
    // Without constraints nothing depends on anything.
    let mut dependent = independent_columns(&constraints, &preferred);
    dependent.sort_unstable();
    let independent: Vec<usize> = (0..n).filter(|k| !dependent.contains(k)).collect();
    let named = !report.independent.is_empty();
    let marked = |k: &usize| report.rows[constrained[*k]].redundant;
    let mut redundant: Vec<usize> =
        following(&constraints, marked).into_iter().map(|k| constrained[k]).collect();
    redundant.sort_unstable();
    Freedom {
        coordinates: n,
        constraints: constrained.len(),
        drives: report.rows.len() - constrained.len(),
        structural_rank: report.mobility.constraint_rank,
        rank: dependent.len(),
        whole_rank: rank(&rows),
        declared: named && independent.iter().all(|column| report.independent.contains(column)),
        independent,
        dependent,
        redundant,
    }
}

/// Indices of the rows that follow from those before them; `late` rows come after all others.
fn following(rows: &[Vec<f64>], late: impl Fn(&usize) -> bool) -> Vec<usize> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_key(|k| late(k));
    let mut carried: Vec<Vec<f64>> = Vec::new();
    order.retain(|k| {
        carried.push(rows[*k].clone());
        let follows = rank(&carried) < carried.len();
        if follows {
            carried.pop();
        }
        follows
    });
    order
}

/// Φ_q in the reference metric: rows over their scale, columns times theirs.
pub fn scaled_jacobian(mechanism: &dyn AnyEquations, q: &[f64], t: f64) -> Vec<Vec<f64>> {
    let zero = vec![0.0; q.len()];
    let functions = mechanism.evaluate(&State { q: q.to_vec(), qd: zero.clone(), qdd: zero, t });
    let scales = mechanism.coordinate_scales();
    let rows = functions.phi_q.chunks(q.len().max(1)).zip(mechanism.row_scales());
    rows.map(|(row, scale)| row.iter().zip(&scales).map(|(entry, s)| entry * s / scale).collect()).collect()
}
