//! Gradients of rows: the measure of a row that is multiplied by a thousand, or written in another unit.

use super::Row;
use crate::model::Model;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::sample_points::scattered;
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Stage, Unary};

/// Times that the unit of a row may be off its gradient before the row is measured by the latter: bars of one linkage,
/// gears and squares of lengths are well measured by their units, and keep round numbers.
const MOST_OFF: f64 = 8.0;

/// Distance from the guess at which rows are evaluated, in the scales of the coordinates: away from positions at which a
/// gradient vanishes.
const ASIDE: f64 = 0.5;

/// Rows of a text with their measures by units.
pub struct Rows<'a> {
    pub rows: &'a [Row],
    /// Scales of the coordinates.
    pub coordinates: &'a [NodeId],
    /// Start of the search for an assembly.
    pub guesses: &'a [NodeId],
}

impl Rows<'_> {
    /// Before: scales of rows by their units. After: times a power of two where the gradient is far from the unit's. It must be
    /// far both by the bounds of its terms and about the guess, with parameters at their defaults.
    pub fn measure(&self, model: &Model, g: &mut Graph, row_scales: &mut [NodeId]) {
        let bounds = self.bounds(model, g, row_scales);
        if bounds.iter().flatten().all(|ratio| !is_far(*ratio)) {
            return;
        }
        let found = self.about_the_guess(model, g, row_scales);
        for ((bound, found), scale) in bounds.into_iter().zip(found).zip(row_scales) {
            let Some(bound) = bound else { continue };
            let ratio = if bound > 1.0 { bound.min(found) } else { bound.max(found) };
            let factor = libm::exp2(libm::round(libm::log2(ratio)));
            if is_far(ratio) && factor.is_normal() {
                let factor = g.constant(factor);
                *scale = g.binary(Binary::Multiply, *scale, factor);
            }
        }
    }

    /// Bound on the gradient of each row, relative to its scale; `None` where none is known.
    fn bounds(&self, model: &Model, g: &Graph, row_scales: &[NodeId]) -> Vec<Option<f64>> {
        let entries = self.rows.iter().flat_map(|row| row.phi_q.iter().map(|(_, entry)| *entry));
        let scales: Vec<NodeId> = self.coordinates.iter().chain(row_scales).copied().collect();
        let mut sizes = Sizes { sizes: vec![None; g.len()], model, coordinates: self.coordinates };
        // The size of a coordinate is its scale, which depends on parameters: those come first.
        sizes.fill(g, g.reachable(scales.iter().copied()));
        sizes.fill(g, g.reachable(entries));
        let size = |id: &NodeId| sizes.of(*id);
        let steepest = |row: &Row| {
            row.phi_q.iter().try_fold(0.0_f64, |largest, (coordinate, entry)| {
                Some(largest.max(size(entry)? * size(self.coordinates.get(*coordinate)?)?))
            })
        };
        let rows = self.rows.iter().zip(row_scales);
        rows.map(|(row, scale)| Some(steepest(row)? / size(scale)?)).collect()
    }

    /// Largest entry of the gradient of each row over its scale, at the guess and on both sides of it.
    fn about_the_guess(&self, model: &Model, g: &Graph, row_scales: &[NodeId]) -> Vec<f64> {
        let known = |leaf: Leaf| match leaf {
            Leaf::Parameter(index) | Leaf::Input(index) => {
                model.variables.get(index as usize).map_or(0.0, |variable| variable.default)
            }
            _ => 0.0,
        };
        let guesses = evaluate(g, self.guesses, known);
        let coordinates = evaluate(g, self.coordinates, known);
        let units = evaluate(g, row_scales, known);
        let places: Vec<(usize, usize)> = (0..self.rows.len())
            .zip(self.rows)
            .flat_map(|(index, row)| row.phi_q.iter().map(move |(coordinate, _)| (index, *coordinate)))
            .collect();
        let entries: Vec<NodeId> =
            self.rows.iter().flat_map(|row| row.phi_q.iter().map(|(_, entry)| *entry)).collect();
        let mut steepest = vec![0.0_f64; self.rows.len()];
        for side in [0.0, 1.0, -1.0] {
            let at = |leaf: Leaf| match leaf {
                Leaf::Position(index) => {
                    let index = index as usize;
                    // All values differ, not in equal steps, so that no symmetry of the mechanism is kept.
                    let share = 0.25 + 0.75 * scattered(leaf, 0);
                    let guess = guesses.get(index).copied().unwrap_or(0.0);
                    guess + side * ASIDE * share * coordinates.get(index).copied().unwrap_or(1.0)
                }
                other => known(other),
            };
            for (entry, (row, coordinate)) in evaluate(g, &entries, at).into_iter().zip(&places) {
                let scale = coordinates.get(*coordinate).copied().unwrap_or(1.0);
                let unit = units.get(*row).copied().unwrap_or(1.0);
                let steep = (entry * scale / unit).abs();
                if let Some(steepest) = steepest.get_mut(*row).filter(|_| steep.is_finite()) {
                    *steepest = steepest.max(steep);
                }
            }
        }
        steepest
    }
}

fn is_far(ratio: f64) -> bool {
    !(1.0 / MOST_OFF..=MOST_OFF).contains(&ratio)
}

/// Estimated size of values; `None` where it is unknown.
struct Sizes<'a> {
    sizes: Vec<Option<f64>>,
    model: &'a Model,
    coordinates: &'a [NodeId],
}

impl Sizes<'_> {
    fn fill(&mut self, g: &Graph, nodes: Vec<NodeId>) {
        for id in nodes {
            let size = self.size(g, id).filter(|size| size.is_finite());
            if let Some(place) = self.sizes.get_mut(id.index()) {
                *place = size;
            }
        }
    }

    fn of(&self, id: NodeId) -> Option<f64> {
        self.sizes.get(id.index()).copied().flatten()
    }

    fn size(&self, g: &Graph, id: NodeId) -> Option<f64> {
        match g.node(id) {
            Node::Constant(_) => g.constant_value(id).map(f64::abs),
            Node::Leaf(Leaf::Time) => Some(1.0),
            Node::Leaf(Leaf::Parameter(index)) => {
                Some(self.model.variables.get(index as usize)?.default.abs())
            }
            Node::Leaf(Leaf::Position(index)) => self.of(*self.coordinates.get(index as usize)?),
            Node::Leaf(_) | Node::Call { .. } => None,
            Node::Unary(Unary::Negate | Unary::Abs, a) => self.of(a),
            Node::Unary(Unary::Sqrt, a) => self.of(a).map(f64::sqrt),
            Node::Unary(_, a) => self.of(a).map(|_| 1.0),
            Node::Binary(function, a, b) => {
                let (left, right) = (self.of(a)?, self.of(b)?);
                match function {
                    Binary::Multiply => Some(left * right),
                    Binary::Divide => Some(left / right),
                    Binary::Power => Some(libm::pow(left, g.constant_value(b)?)),
                    Binary::Atan2 => Some(1.0),
                    Binary::Add | Binary::Subtract | Binary::Min | Binary::Max | Binary::Hypot => {
                        Some(left.max(right))
                    }
                }
            }
            // The reference length is 1 m where no length is declared.
            Node::Select { less, than, yes, no } if g.stage(id) <= Stage::Parameter => {
                if self.of(less)? < self.of(than)? { self.of(yes) } else { self.of(no) }
            }
            Node::Select { yes, no, .. } => Some(self.of(yes)?.max(self.of(no)?)),
        }
    }
}
