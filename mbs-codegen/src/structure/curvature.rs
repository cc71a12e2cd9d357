//! Second derivatives of a dyad of circles and lines.

use super::dyad::Dyad;
use crate::equations::Equations;
use crate::symbolic::substitute::substitute;
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// Second derivatives of the rows of a dyad of circles and lines: of each row the factor k of (Φ_q s)_q s = k |s|² along any step s of
/// the block's coordinates. A row's `None` is a structural zero; other dyads have no such factors.
pub fn curvature(
    equations: &mut Equations,
    rows: &[usize],
    coordinates: &[usize],
    dyad: &Dyad,
) -> Option<Vec<Option<NodeId>>> {
    let Dyad::Circles { .. } = dyad else { return None };
    let (&[_, _], &[x, y]) = (rows, coordinates) else { return None };
    let phi: Vec<NodeId> =
        rows.iter().filter_map(|row| equations.rows.get(*row)).map(|row| row.phi).collect();
    let g = &mut equations.graph;
    let along = |g: &mut Graph, leaf| match leaf {
        Leaf::Position(index) if coordinates.contains(&(index as usize)) => {
            Some(g.leaf(Leaf::Velocity(index)))
        }
        _ => None,
    };
    let zero = g.constant(0.0);
    let first: Vec<NodeId> = tangent(g, &phi, along).into_iter().map(|slope| slope.unwrap_or(zero)).collect();
    let second = tangent(g, &first, along);
    // Circles have the same in every direction: that of the first coordinate.
    let one = g.constant(1.0);
    let second = second.into_iter().map(|second| {
        second.map(|second| {
            substitute(g, second, |leaf| match leaf {
                Leaf::Velocity(index) if index as usize == x => Some(one),
                Leaf::Velocity(index) if index as usize == y => Some(zero),
                _ => None,
            })
        })
    });
    Some(second.collect())
}

#[cfg(test)]
#[path = "curvature_tests.rs"]
mod tests;
