//! How large the gradients of rows are: what a row that is written a thousand times over is measured by.

use std::collections::BTreeMap;

use super::Row;
use crate::model::Model;
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Times that the unit of a row may be off its gradient before the row is measured by the latter: bars of one linkage,
/// gears and squares of lengths are well measured by their units, and keep round numbers.
const MOST_OFF: f64 = 8.0;

/// Before: rows with their gradients, and the scales of coordinates and rows by their units. After: scales of rows times a power
/// of two where the gradient, of coordinates as large as their scales and parameters at their defaults, is far from the unit's.
pub fn measure_rows(
    model: &Model,
    g: &mut Graph,
    rows: &[Row],
    coordinate_scales: &[NodeId],
    row_scales: &mut [NodeId],
) {
    let entries = rows.iter().flat_map(|row| row.phi_q.iter().map(|(_, entry)| *entry));
    let scales = coordinate_scales.iter().chain(row_scales.iter()).copied();
    let sizes = Sizes::of(model, g, coordinate_scales, scales.chain(entries).collect());
    for (row, scale) in rows.iter().zip(row_scales) {
        let factor = sizes.gradient(row, coordinate_scales).zip(sizes.of_node(*scale)).and_then(factor);
        if let Some(factor) = factor {
            let factor = g.constant(factor);
            *scale = g.binary(Binary::Multiply, *scale, factor);
        }
    }
}

/// The power of two next to what a gradient is of its unit's scale, where that is far from 1.
fn factor((gradient, unit): (f64, f64)) -> Option<f64> {
    let ratio = gradient / unit;
    let far = !(1.0 / MOST_OFF..=MOST_OFF).contains(&ratio);
    let factor = ratio.log2().round().exp2();
    (far && factor.is_normal()).then_some(factor)
}

/// About how large values become; those that nothing is known of are left out.
struct Sizes {
    sizes: BTreeMap<NodeId, f64>,
}

impl Sizes {
    fn of(model: &Model, g: &Graph, coordinate_scales: &[NodeId], roots: Vec<NodeId>) -> Self {
        let mut sizes = Sizes { sizes: BTreeMap::new() };
        // A coordinate is as large as its scale, which is made of parameters: those come first.
        for id in g.reachable(coordinate_scales.iter().copied()) {
            sizes.keep(model, g, coordinate_scales, id);
        }
        for id in g.reachable(roots) {
            sizes.keep(model, g, coordinate_scales, id);
        }
        sizes
    }

    fn keep(&mut self, model: &Model, g: &Graph, coordinate_scales: &[NodeId], id: NodeId) {
        if let Some(size) = self.size(model, coordinate_scales, g, id) {
            self.sizes.insert(id, size);
        }
    }

    fn of_node(&self, id: NodeId) -> Option<f64> {
        self.sizes.get(&id).copied()
    }

    /// The largest entry of a row, a coordinate's scale further on; `None` where one is unknown.
    fn gradient(&self, row: &Row, coordinate_scales: &[NodeId]) -> Option<f64> {
        row.phi_q.iter().try_fold(0.0_f64, |largest, (coordinate, entry)| {
            let scale = self.of_node(*coordinate_scales.get(*coordinate)?)?;
            Some(largest.max(self.of_node(*entry)? * scale))
        })
    }

    fn size(&self, model: &Model, coordinate_scales: &[NodeId], g: &Graph, id: NodeId) -> Option<f64> {
        let of = |id: NodeId| self.of_node(id);
        match g.node(id) {
            Node::Constant(_) => g.constant_value(id).map(f64::abs),
            Node::Leaf(Leaf::Time) => Some(1.0),
            Node::Leaf(Leaf::Parameter(index)) => Some(model.variables.get(index as usize)?.default.abs()),
            Node::Leaf(Leaf::Position(index)) => of(*coordinate_scales.get(index as usize)?),
            Node::Leaf(_) | Node::Call { .. } => None,
            Node::Unary(function, a) => match function {
                Unary::Negate | Unary::Abs => of(a),
                Unary::Sqrt => of(a).map(f64::sqrt),
                _ => of(a).map(|_| 1.0),
            },
            Node::Binary(function, a, b) => {
                let (a_size, b_size) = (of(a)?, of(b)?);
                match function {
                    Binary::Multiply => Some(a_size * b_size),
                    Binary::Divide => Some(a_size / b_size).filter(|size| size.is_finite()),
                    Binary::Power => Some(a_size.powf(g.constant_value(b)?)).filter(|size| size.is_finite()),
                    Binary::Atan2 => Some(1.0),
                    Binary::Add | Binary::Subtract | Binary::Min | Binary::Max | Binary::Hypot => {
                        Some(a_size.max(b_size))
                    }
                }
            }
            Node::Select { yes, no, .. } => Some(of(yes)?.max(of(no)?)),
        }
    }
}
