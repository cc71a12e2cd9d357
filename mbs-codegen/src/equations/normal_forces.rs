//! Q in the multipliers: a sum of multipliers, of absolute values of such sums and of norms of two of them.

use std::collections::BTreeMap;

use super::jacobian;
use super::sparse::Sparse;
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Function that a term applies to its components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalFunction {
    /// The multiplier itself.
    Multiplier,
    /// The absolute value of one component.
    Absolute,
    /// The norm of two.
    Norm,
}

/// One term v.
#[derive(Debug)]
pub struct Term {
    /// Its function.
    pub kind: NormalFunction,
    /// One or two sums of multipliers and of terms before; multipliers from M on represent the terms.
    pub components: Vec<NodeId>,
    /// Its derivatives by each multiplier, one row a component.
    pub by_multiplier: Sparse,
    /// Its derivatives by each term.
    pub by_term: Sparse,
}

/// Q = Q₀ + D v.
#[derive(Debug)]
pub struct NormalForces {
    /// The terms; those that a term depends on precede it.
    pub terms: Vec<Term>,
    /// D: one row a coordinate.
    pub force: Sparse,
}

impl NormalForces {
    /// All of its roots.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let of_terms = self.terms.iter().flat_map(|term| {
            let slopes = term.by_multiplier.iter().chain(&term.by_term).flatten().map(|(_, entry)| *entry);
            term.components.iter().copied().chain(slopes)
        });
        of_terms.chain(self.force.iter().flatten().map(|(_, entry)| *entry))
    }

    /// All of its roots, to be replaced.
    pub fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let of_terms = self.terms.iter_mut().flat_map(|term| {
            let Term { components, by_multiplier, by_term, .. } = term;
            let slopes = by_multiplier.iter_mut().chain(by_term).flatten().map(|(_, entry)| entry);
            components.iter_mut().chain(slopes)
        });
        of_terms.chain(self.force.iter_mut().flatten().map(|(_, entry)| entry))
    }
}

/// Before: Q, one root a coordinate, and the number of multipliers. After: Q as a sum of terms; none where it depends on a
/// multiplier otherwise.
pub fn normal_forces(g: &mut Graph, force: &[Option<NodeId>], rows: usize) -> Option<NormalForces> {
    let zero = g.constant(0.0);
    let roots: Vec<NodeId> = force.iter().map(|root| root.unwrap_or(zero)).collect();
    let mut walk = Walk { images: BTreeMap::new(), terms: Vec::new(), rows };
    for id in g.reachable(roots.iter().copied()) {
        walk.visit(g, id);
    }
    let images: Vec<NodeId> = roots.iter().map(|root| walk.image(*root)).collect::<Option<_>>()?;
    let mut terms = walk.terms;
    let places = (0..terms.len()).map(|place| rows + place);
    let mut leaves: Vec<usize> = places.collect();
    for multiplier in plain_multipliers(g, &images, rows) {
        let component = g.leaf(Leaf::Multiplier(multiplier as u32));
        terms.push((NormalFunction::Multiplier, vec![component]));
        leaves.push(multiplier);
    }
    let by = |g: &mut Graph, roots: &[NodeId], leaves: &[usize]| {
        jacobian(g, roots, leaves.len(), |column| {
            Leaf::Multiplier(leaves.get(column as usize).map_or(0, |leaf| *leaf as u32))
        })
    };
    let force = by(g, &images, &leaves);
    let multipliers: Vec<usize> = (0..rows).collect();
    let before: Vec<usize> = leaves.iter().copied().take_while(|leaf| *leaf >= rows).collect();
    let terms = terms.into_iter().map(|(kind, components)| Term {
        kind,
        by_multiplier: by(g, &components, &multipliers),
        by_term: by(g, &components, &before),
        components,
    });
    Some(NormalForces { terms: terms.collect(), force })
}

/// The multipliers that are leaves of `roots`, ascending.
fn plain_multipliers(g: &Graph, roots: &[NodeId], rows: usize) -> Vec<usize> {
    let mut found: Vec<usize> = g
        .reachable(roots.iter().copied())
        .into_iter()
        .filter_map(|id| match g.node(id) {
            Node::Leaf(Leaf::Multiplier(index)) => Some(index as usize),
            _ => None,
        })
        .filter(|index| *index < rows)
        .collect();
    found.sort_unstable();
    found
}

/// A walk over Q, operands first.
struct Walk {
    /// Form of each node that depends on a multiplier, with its terms as leaves; `None` where it is no such sum.
    images: BTreeMap<NodeId, Option<NodeId>>,
    terms: Vec<(NormalFunction, Vec<NodeId>)>,
    rows: usize,
}

impl Walk {
    /// Node that replaces another one.
    fn image(&self, id: NodeId) -> Option<NodeId> {
        self.images.get(&id).copied().unwrap_or(Some(id))
    }

    fn depends(&self, id: NodeId) -> bool {
        self.images.contains_key(&id)
    }

    fn visit(&mut self, g: &mut Graph, id: NodeId) {
        let node = g.node(id);
        if matches!(node, Node::Leaf(Leaf::Multiplier(_))) {
            self.images.insert(id, Some(id));
        } else if node.operands().any(|operand| self.depends(operand)) {
            let image = self.sum(g, node);
            self.images.insert(id, image);
        }
    }

    /// A node with the images of its operands, where it is a sum of terms.
    fn sum(&mut self, g: &mut Graph, node: Node) -> Option<NodeId> {
        Some(match node {
            Node::Unary(Unary::Negate, a) => {
                let a = self.image(a)?;
                g.negate(a)
            }
            Node::Unary(Unary::Abs, a) => {
                let a = self.image(a)?;
                self.term(g, NormalFunction::Absolute, vec![a])
            }
            Node::Unary(Unary::Sqrt, a) => {
                let components = self.squares(g, a)?;
                self.term(g, NormalFunction::Norm, components)
            }
            Node::Binary(function @ (Binary::Add | Binary::Subtract), a, b) => {
                let (a, b) = (self.image(a)?, self.image(b)?);
                g.binary(function, a, b)
            }
            Node::Binary(Binary::Multiply, a, b) if !(self.depends(a) && self.depends(b)) => {
                let (a, b) = (self.image(a)?, self.image(b)?);
                g.multiply(a, b)
            }
            Node::Binary(Binary::Divide, a, b) if !self.depends(b) => {
                let a = self.image(a)?;
                g.divide(a, b)
            }
            Node::Binary(Binary::Hypot, a, b) => {
                let components = vec![self.image(a)?, self.image(b)?];
                self.term(g, NormalFunction::Norm, components)
            }
            // max(a, b) = (a + b + |a − b|)/2
            Node::Binary(function @ (Binary::Min | Binary::Max), a, b) => {
                let (a, b) = (self.image(a)?, self.image(b)?);
                let apart = g.subtract(a, b);
                let apart = self.term(g, NormalFunction::Absolute, vec![apart]);
                let sum = g.add(a, b);
                let twice = if function == Binary::Max { g.add(sum, apart) } else { g.subtract(sum, apart) };
                let half = g.constant(0.5);
                g.multiply(half, twice)
            }
            Node::Select { less, than, yes, no } if !self.depends(less) && !self.depends(than) => {
                let (yes, no) = (self.image(yes)?, self.image(no)?);
                g.select(less, than, yes, no)
            }
            _ => return None,
        })
    }

    /// x and y of x² + y².
    fn squares(&self, g: &Graph, sum: NodeId) -> Option<Vec<NodeId>> {
        let Node::Binary(Binary::Add, a, b) = g.node(sum) else { return None };
        let root = |id: NodeId| match g.node(id) {
            Node::Binary(Binary::Multiply, x, y) if x == y => self.image(x),
            _ => None,
        };
        Some(vec![root(a)?, root(b)?])
    }

    /// A leaf for a term.
    fn term(&mut self, g: &mut Graph, kind: NormalFunction, components: Vec<NodeId>) -> NodeId {
        let known = self.terms.iter().position(|(other, parts)| *other == kind && *parts == components);
        let place = known.unwrap_or(self.terms.len());
        if known.is_none() {
            self.terms.push((kind, components));
        }
        g.leaf(Leaf::Multiplier((self.rows + place) as u32))
    }
}
