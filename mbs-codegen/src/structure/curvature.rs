//! Second derivatives of a dyad's rows along a step of its coordinates.

use super::dyad::Dyad;
use crate::equations::Equations;
use crate::symbolic::substitute::substitute;
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// Second derivatives of the rows of a block; `None` is a structural zero.
#[derive(Clone, Debug)]
pub enum Curvature {
    /// (Φ_q s)_q s of each row along a step s, whose components are the leaves of the coordinates' velocities.
    Along(Vec<Option<NodeId>>),
    /// Of each row the factor k of (Φ_q s)_q s = k |s|².
    Round(Vec<Option<NodeId>>),
}

impl Curvature {
    /// All nodes, row by row.
    pub fn nodes(&self) -> Vec<Option<NodeId>> {
        match self {
            Curvature::Along(nodes) | Curvature::Round(nodes) => nodes.clone(),
        }
    }

    /// Those that are not zero, to be replaced.
    pub fn nodes_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        match self {
            Curvature::Along(nodes) | Curvature::Round(nodes) => nodes.iter_mut().flatten(),
        }
    }
}

/// Before: rows of a block of two unknowns, these coordinates, and the dyad that it is. After: second derivatives of its rows.
pub fn curvature(
    equations: &mut Equations,
    rows: &[usize],
    coordinates: &[usize],
    dyad: &Dyad,
) -> Option<Curvature> {
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
    let Dyad::Circles { .. } = dyad else { return Some(Curvature::Along(second)) };
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
    Some(Curvature::Round(second.collect()))
}

#[cfg(test)]
#[path = "curvature_tests.rs"]
mod tests;
