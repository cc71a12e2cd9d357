//! Inertia of a body in space that turns with Euler parameters: M, the velocity-quadratic terms, the energy.
//!
//! In the axes of the body ω' = 2 L(e) ė, L(e) = [−ε, e₀ 1 − ε̃], so that T = ½ ω'ᵀ J ω' = ½ (L ė)ᵀ 4J (L ė). L(a) b = −L(b) a
//! turns ∂ω'/∂e into L(ė) and leaves nothing to differentiate but e. Source: Nikravesh 1988, §§6.5, 8.4.

use super::inertia::Inertia;
use super::lower::Clock;
use super::power_of_time::Rates;
use super::sum::Sum;
use super::{again, jacobian};
use crate::symbolic::{Graph, Leaf, NodeId, tangent};

/// A vector in the axes of the body; `None` is a structural zero.
type Vector = [Option<NodeId>; 3];

/// Four Euler parameters, or a change of them.
type Change = [Option<NodeId>; 4];

impl Inertia {
    /// Adds M = (L e_q)ᵀ 4J (L e_q) and d/dt(∂T/∂q̇) − ∂T/∂q at q̈ = 0:
    /// (L e_q)ᵀ 4J L ë₀ + 2 (L(ė) e_q)ᵀ 4J L ė, ë₀ the second derivative of e along the motion.
    ///
    /// `inertia`: the upper triangle of J, row, column and entry.
    pub fn turning(
        &mut self,
        g: &mut Graph,
        inertia: &[(usize, usize, NodeId)],
        orientation: [NodeId; 4],
        clock: &Clock,
    ) {
        let four = g.constant(4.0);
        let inertia = inertia.iter().filter(|(.., entry)| g.constant_value(*entry) != Some(0.0)).copied();
        let inertia: Vec<_> = inertia.collect();
        let inertia: Vec<_> =
            inertia.into_iter().map(|(row, column, entry)| (row, column, g.multiply(four, entry))).collect();
        let e = orientation.map(Some);
        let columns = changes(g, orientation, self.coordinates());
        let turns: Vec<(usize, Vector)> =
            columns.iter().map(|(index, change)| (*index, turn(g, e, *change))).collect();
        for (position, (row, left)) in turns.iter().enumerate() {
            let momentum = times(g, &inertia, *left);
            for (column, right) in turns.iter().skip(position) {
                if let Some(entry) = dot(g, momentum, *right) {
                    self.add(g, *row, *column, entry);
                }
            }
        }
        let velocity = tangent(g, &orientation, |g, leaf| clock.total(g, leaf, false));
        let acceleration = again(g, &velocity, |g, leaf| clock.total(g, leaf, false));
        let (velocity, acceleration) = (four_of(&velocity), four_of(&acceleration));
        let spin = turn(g, e, velocity);
        let momentum = times(g, &inertia, spin);
        if let Some(square) = dot(g, spin, momentum) {
            let half = g.constant(0.5);
            let energy = g.multiply(half, square);
            self.add_kinetic(g, energy);
        }
        self.carry(g, &inertia, orientation, velocity, clock);
        let changing = turn(g, e, acceleration);
        let changing = times(g, &inertia, changing);
        let two = g.constant(2.0);
        let twice = momentum.map(|component| component.map(|component| g.multiply(two, component)));
        for ((row, column), (_, change)) in turns.iter().zip(&columns) {
            let convected = turn(g, velocity, *change);
            let terms = [dot(g, *column, changing), dot(g, convected, twice)];
            for bias in terms.into_iter().flatten() {
                self.bias_at(g, *row, bias);
            }
        }
    }
}

impl Inertia {
    /// Adds the power into a body that time turns along: (L e_t)ᵀ 4J L ë + 2 (L(ė) e_t)ᵀ 4J L ė, e_t the change of e with the
    /// coordinates held.
    fn carry(
        &mut self,
        g: &mut Graph,
        inertia: &[(usize, usize, NodeId)],
        orientation: [NodeId; 4],
        velocity: Change,
        clock: &Clock,
    ) {
        let rates = Rates { clock };
        let (e, carried) = (orientation.map(Some), orientation.map(|part| rates.partial(g, part)));
        if carried.iter().all(Option::is_none) {
            return;
        }
        let acceleration = velocity.map(|part| part.and_then(|part| rates.total(g, part)));
        let (spin, changing) = (turn(g, e, velocity), turn(g, e, acceleration));
        let (momentum, changing) = (times(g, inertia, spin), times(g, inertia, changing));
        let (turned, convected) = (turn(g, e, carried), turn(g, velocity, carried));
        let twice = dot(g, convected, momentum);
        for term in [dot(g, turned, changing), twice, twice].into_iter().flatten() {
            self.add_carried(g, term);
        }
    }
}

/// Derivatives of the parameters by each coordinate that moves them.
fn changes(g: &mut Graph, orientation: [NodeId; 4], count: usize) -> Vec<(usize, Change)> {
    let mut columns: Vec<(usize, Change)> = Vec::new();
    for (slot, row) in jacobian(g, &orientation, count, Leaf::Position).into_iter().enumerate() {
        for (index, entry) in row {
            let known = columns.iter().position(|(column, _)| *column == index);
            let at = known.unwrap_or_else(|| {
                columns.push((index, [None; 4]));
                columns.len() - 1
            });
            if let Some(slot) = columns.get_mut(at).and_then(|(_, change)| change.get_mut(slot)) {
                *slot = Some(entry);
            }
        }
    }
    columns.sort_unstable_by_key(|(column, _)| *column);
    columns
}

fn four_of(values: &[Option<NodeId>]) -> Change {
    match *values {
        [e0, x, y, z] => [e0, x, y, z],
        _ => [None; 4],
    }
}

/// L(e) d = e₀ δ − d₀ ε − ε × δ with d = (d₀, δ): half the turn that a change d of e makes, in the axes of the body.
fn turn(g: &mut Graph, [e0, ex, ey, ez]: Change, [d0, dx, dy, dz]: Change) -> Vector {
    let axes = [(ex, ey, ez, dx, dy, dz), (ey, ez, ex, dy, dz, dx), (ez, ex, ey, dz, dx, dy)];
    axes.map(|(ei, ej, ek, di, dj, dk)| {
        let mut sum = Sum::default();
        for (a, b) in [(e0, di), (ek, dj)] {
            if let Some(product) = product(g, a, b) {
                sum.add(g, product);
            }
        }
        for (a, b) in [(ei, d0), (ej, dk)] {
            let product = product(g, a, b);
            sum = sum.minus(g, product);
        }
        sum.0
    })
}

/// J v
fn times(g: &mut Graph, inertia: &[(usize, usize, NodeId)], v: Vector) -> Vector {
    let mut result = [Sum::default(); 3];
    for (row, column, entry) in inertia {
        for (to, from) in [(row, column), (column, row)].into_iter().take(1 + usize::from(row != column)) {
            let product = product(g, Some(*entry), v.get(*from).copied().flatten());
            if let (Some(sum), Some(product)) = (result.get_mut(*to), product) {
                sum.add(g, product);
            }
        }
    }
    result.map(|sum| sum.0)
}

fn dot(g: &mut Graph, a: Vector, b: Vector) -> Option<NodeId> {
    let mut sum = Sum::default();
    for (a, b) in a.into_iter().zip(b) {
        if let Some(product) = product(g, a, b) {
            sum.add(g, product);
        }
    }
    sum.0
}

fn product(g: &mut Graph, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
    Some(g.multiply(a?, b?))
}
