//! Degrees of freedom: rows without the drives, their rank, independent and dependent coordinates.

use mbs_codegen::StructureReport;

use super::rank::{independent_columns, rank};
use crate::facade::{AnyEquations, State};

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
    /// Whether the text names them, and they determine the others at the position.
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

/// Indices of the rows that follow from those before them, where `late` ones stand behind all others.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::{ALL, find};

    fn of(name: &str) -> Freedom {
        let mechanism = (find(name).expect("in the list").make)();
        let report =
            mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene())).expect("a good text");
        let q = mechanism
            .experiment()
            .assembled(&mechanism.experiment().guess(), 0.0, true)
            .expect("it assembles");
        freedom(mechanism.as_ref(), &report, &q, 0.0)
    }

    #[test]
    fn the_four_bar_has_one_degree_of_freedom_and_its_crank_is_independent() {
        let found = of("four_bar");
        assert_eq!((found.coordinates, found.constraints, found.drives), (5, 4, 1));
        assert_eq!((found.structural_rank, found.rank, found.whole_rank), (4, 4, 5));
        assert_eq!((&found.independent[..], &found.dependent[..]), (&[2][..], &[0, 1, 3, 4][..]));
        assert!(found.redundant.is_empty());
    }

    #[test]
    fn what_the_text_names_is_independent_unless_it_leaves_others_open_at_the_position() {
        use mbs_runtime::mechanism;
        mechanism! {
            pub mechanism Named;
            coord phi: [rad; 3] = [0.3, 0.9, 1.8];
            coord x: m = 0.1;
            constraint closure { 0.1m*unit(phi[0]) + 0.25m*unit(phi[1]) == [0.3m, 0] + 0.2m*unit(phi[2]); }
            constraint slide { x == 0.2m*cos(phi[2]); }
            drive crank: phi[0] == 0.3 + 2*t/1s;
            independent x;
        }
        let mechanism = crate::facade::boxed::<Named, 4>();
        let report = mbs_codegen::structure_of(mechanism.source(), None).expect("a good text");
        assert_eq!(report.independent, [3]);
        let q = mechanism
            .experiment()
            .assembled(&mechanism.experiment().guess(), 0.0, true)
            .expect("it assembles");
        let found = freedom(mechanism.as_ref(), &report, &q, 0.0);
        assert_eq!((&found.independent[..], found.declared), (&[3][..], true));
        // With the last link along x its angle does not follow from x.
        let dead = [q[0], q[1], 0.0, 0.2];
        let found = freedom(mechanism.as_ref(), &report, &dead, 0.0);
        assert!(found.independent != [3] && !found.declared, "{found:?}");
        assert!(!of("four_bar").declared);
    }

    #[test]
    fn of_rows_that_follow_from_one_another_the_last_one_is_named() {
        let found = of("double_parallelogram");
        assert_eq!((found.constraints, found.drives, found.rank, found.whole_rank), (4, 1, 3, 4));
        assert_eq!((found.structural_rank, &found.redundant[..]), (4, &[3][..]));
    }

    #[test]
    fn an_open_chain_has_independent_coordinates_alone() {
        let found = of("open_chain");
        assert_eq!((found.constraints, found.drives, found.rank), (0, 3, 0));
        assert_eq!(found.independent, [0, 1, 2]);
    }

    #[test]
    fn drives_take_up_every_degree_of_freedom_of_every_mechanism() {
        for card in ALL {
            let found = of(card.name);
            assert_eq!(found.independent.len(), found.drives, "{}: {found:?}", card.name);
            assert_eq!(found.whole_rank, found.coordinates, "{}", card.name);
            let mechanism = (card.make)();
            let surplus = mechanism.rows().len() - mechanism.coordinates().len();
            assert_eq!(found.redundant.len(), surplus, "{}", card.name);
            assert_eq!(found.structural_rank, found.rank + surplus, "{}", card.name);
        }
    }
}
