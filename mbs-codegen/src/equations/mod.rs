//! Model → roots of one graph: Φ, Φ_q, Φ_t, Φ_tt, Φ_qt q̇, γ, branches, limits, phases, outputs, guesses,
//! metric; M, Q and their derivatives, energies, powers.

mod acting_bodies;
#[cfg(test)]
mod bristles_tests;
mod contacts;
pub mod continuity;
#[cfg(test)]
mod curves_tests;
pub mod deferred;
mod degree;
mod dynamics;
mod events;
pub mod folds;
mod generalized_forces;
mod gradients;
mod inertia;
mod lower;
mod non_negative;
pub mod normal_forces;
pub mod pins;
mod power_of_time;
#[cfg(test)]
mod restitution_tests;
mod second_moments;
#[cfg(test)]
mod seen_tests;
mod set_valued;
mod sparse;
mod spatial_inertia;
mod sum;
pub mod turns;

use std::collections::BTreeMap;

use crate::model::Model;
use crate::symbolic::{Graph, Leaf, Node, NodeId, tangent, tangents};

pub use acting_bodies::{Attribution, On, RowMotion};
pub use contacts::{ByContact, Pressing, Push};
pub use dynamics::{Dynamics, Gap, Slope};
pub use events::{Condition, Events};
use lower::Lowered;
pub use lower::MARGIN;
pub use non_negative::Of;
pub use set_valued::SetValuedRow;
pub use sparse::Sparse;

/// All expressions of a model as nodes of one graph, in their order.
pub fn lowered(model: &Model) -> (Graph, Vec<NodeId>) {
    let Lowered { graph, nodes, .. } = lower::lower(model);
    (graph, nodes)
}

/// One graph and its roots. `None` is a structural zero.
#[derive(Debug)]
pub struct Equations {
    /// All functions share it.
    pub graph: Graph,
    /// One a row of Φ.
    pub rows: Vec<Row>,
    /// One a branch, positive where it holds.
    pub branches: Vec<NodeId>,
    /// One a limit: lower bound, value, upper bound.
    pub limits: Vec<[NodeId; 3]>,
    /// One a drive that prescribes a rate.
    pub phases: Vec<Phase>,
    /// One an output.
    pub outputs: Vec<Output>,
    /// One a coordinate.
    pub guesses: Vec<NodeId>,
    /// Reference metric of the coordinates.
    pub coordinate_scales: Vec<NodeId>,
    /// Reference metric of the rows.
    pub row_scales: Vec<NodeId>,
    /// Widths by which rows may contradict each other, in their units; empty where the text gives none.
    pub widths: Vec<NodeId>,
    /// Masses and forces, where the text has any.
    pub dynamics: Option<Dynamics>,
    /// One a call of a declared function, in the order of the model.
    pub calls: Vec<NodeId>,
}

/// A row of Φ with its derivatives.
#[derive(Debug)]
pub struct Row {
    /// Residual.
    pub phi: NodeId,
    /// Coordinates and entries of the row of Φ_q, in the order of the coordinates.
    pub phi_q: Vec<(usize, NodeId)>,
    /// Φ_t
    pub phi_t: Option<NodeId>,
    /// Φ_tt
    pub phi_tt: Option<NodeId>,
    /// Φ_qt q̇
    pub phi_qt_qd: Option<NodeId>,
    /// γ
    pub gamma: Option<NodeId>,
}

/// Terms of a drive that prescribes a rate.
#[derive(Debug)]
pub struct Phase {
    /// Driven expression.
    pub argument: NodeId,
    /// Its rate.
    pub speed: NodeId,
    /// The rate's time derivative.
    pub acceleration: Option<NodeId>,
}

/// An output with as many derivatives as its definition leaves it; the inner `None` is a zero.
#[derive(Debug)]
pub struct Output {
    /// Value.
    pub value: NodeId,
    /// First time derivative.
    pub rate: Option<Option<NodeId>>,
    /// Second time derivative.
    pub acceleration: Option<Option<NodeId>>,
}

impl Equations {
    /// The roots of every function that is emitted, to be replaced.
    pub fn roots_mut(&mut self) -> Vec<&mut NodeId> {
        let mut roots = Vec::new();
        for row in &mut self.rows {
            let Row { phi, phi_q, phi_t, phi_tt, phi_qt_qd, gamma } = row;
            roots.push(phi);
            roots.extend(phi_q.iter_mut().map(|(_, entry)| entry));
            roots.extend([phi_t, phi_tt, phi_qt_qd, gamma].into_iter().flatten());
        }
        for output in &mut self.outputs {
            roots.push(&mut output.value);
            roots.extend([&mut output.rate, &mut output.acceleration].into_iter().flatten().flatten());
        }
        for phase in &mut self.phases {
            roots.extend([&mut phase.argument, &mut phase.speed]);
            roots.extend(&mut phase.acceleration);
        }
        roots.extend(self.limits.iter_mut().flatten());
        roots.extend(&mut self.widths);
        let lists =
            [&mut self.branches, &mut self.guesses, &mut self.coordinate_scales, &mut self.row_scales];
        roots.extend(lists.into_iter().flatten());
        roots.extend(self.dynamics.iter_mut().flat_map(Dynamics::roots_mut));
        roots
    }
}

impl Equations {
    /// Before: all roots. After: no third derivative of rows that needs more of a declared function than the other roots: a caller
    /// is not asked for it.
    fn keep_third_derivative_of_known_functions(&mut self) {
        if self.calls.is_empty() {
            return;
        }
        let Some(third) = self.dynamics.as_mut().and_then(|dynamics| dynamics.third.take()) else { return };
        let others: Vec<NodeId> = self.roots_mut().into_iter().map(|root| *root).collect();
        let [known, needed] = [self.orders(others), self.orders(third.roots().collect())];
        let covered = |(function, order)| known.get(function).is_some_and(|known| order <= known);
        if let (true, Some(dynamics)) = (needed.iter().all(covered), &mut self.dynamics) {
            dynamics.third = Some(third);
        }
    }

    /// Highest order of each declared function below `roots`.
    fn orders(&self, roots: Vec<NodeId>) -> BTreeMap<u32, u8> {
        let mut orders = BTreeMap::new();
        for id in self.graph.reachable(roots) {
            if let Node::Call { function, order, .. } = self.graph.node(id) {
                let highest = orders.entry(function).or_insert(order);
                *highest = order.max(*highest);
            }
        }
        orders
    }
}

/// Before: a resolved model. After: every function that is emitted, as roots of one graph.
pub fn derive(model: &Model) -> Equations {
    let lowered = lower::lower(model);
    let Lowered {
        mut graph,
        residuals,
        branches,
        limits,
        phases,
        outputs,
        guesses,
        coordinate_scales,
        mut row_scales,
        widths,
        length,
        calls,
        clock,
        nodes,
    } = lowered;
    let g = &mut graph;
    let columns = jacobian(g, &residuals, model.coordinates.len(), Leaf::Position);
    let phi_t = tangent(g, &residuals, |g, leaf| clock.partial(g, leaf));
    let phi_tt = again(g, &phi_t, |g, leaf| clock.partial(g, leaf));
    let along = tangent(g, &residuals, |g, leaf| match leaf {
        Leaf::Position(i) => Some(g.leaf(Leaf::Velocity(i))),
        _ => None,
    });
    let phi_qt_qd = again(g, &along, |g, leaf| clock.partial(g, leaf));
    // γ: second derivative along (q̇, 1) with q̈ = 0, its sign turned.
    let first = tangent(g, &residuals, |g, leaf| clock.total(g, leaf, false));
    let second = again(g, &first, |g, leaf| clock.total(g, leaf, false));
    let gamma: Vec<_> = second.into_iter().map(|second| second.map(|second| g.negate(second))).collect();

    let outputs =
        outputs.into_iter().map(|(value, derivatives)| output(g, &clock, value, derivatives)).collect();
    let phases = phases.into_iter().map(|[argument, speed]| {
        let acceleration = tangent(g, &[speed], |g, leaf| clock.partial(g, leaf)).pop().flatten();
        Phase { argument, speed, acceleration }
    });
    let phases = phases.collect();
    let rows = residuals
        .iter()
        .zip(columns)
        .zip(phi_t.into_iter().zip(phi_tt))
        .zip(phi_qt_qd.into_iter().zip(gamma))
        .map(|(((phi, phi_q), (phi_t, phi_tt)), (phi_qt_qd, gamma))| Row {
            phi: *phi,
            phi_q,
            phi_t,
            phi_tt,
            phi_qt_qd,
            gamma,
        })
        .collect::<Vec<Row>>();
    gradients::Rows { rows: &rows, coordinates: &coordinate_scales, guesses: &guesses }.measure(
        model,
        g,
        &mut row_scales,
    );
    let dynamics = model
        .dynamics
        .as_ref()
        .map(|dynamics| dynamics::derive(g, dynamics, &nodes, &clock, &rows, &guesses));
    let dynamics = match (dynamics, &model.dynamics) {
        (Some(mut derived), Some(declared)) => {
            let given = pins::Given { nodes: &nodes, clock: &clock, length, rows: &rows, guesses: &guesses };
            pins::complete(g, model, declared, &mut derived, given);
            if model.can_be_enclosed() {
                let mut rate =
                    |id: &NodeId| tangent(g, &[*id], |g, leaf| clock.total(g, leaf, false)).pop().flatten();
                derived.limit_rates = limits.iter().map(|limit| limit.each_ref().map(&mut rate)).collect();
            }
            Some(derived)
        }
        _ => None,
    };
    let mut equations = Equations {
        graph,
        rows,
        branches,
        limits,
        phases,
        outputs,
        guesses,
        coordinate_scales,
        row_scales,
        widths,
        dynamics,
        calls,
    };
    equations.defer_slopes(model);
    equations.keep_third_derivative_of_known_functions();
    equations
}

/// Entries of each row, column by column along the axes of a kind of leaves.
fn jacobian(g: &mut Graph, roots: &[NodeId], columns: usize, axis: impl Fn(u32) -> Leaf) -> Sparse {
    tangents(g, roots, &(0..columns).map(|column| axis(column as u32)).collect::<Vec<Leaf>>())
}

/// Derivative of what may be zero already.
fn again(
    g: &mut Graph,
    roots: &[Option<NodeId>],
    direction: impl FnMut(&mut Graph, Leaf) -> Option<NodeId>,
) -> Vec<Option<NodeId>> {
    let zero = g.constant(0.0);
    let roots: Vec<NodeId> = roots.iter().map(|root| root.unwrap_or(zero)).collect();
    tangent(g, &roots, direction)
}

fn output(g: &mut Graph, clock: &lower::Clock, value: NodeId, derivatives: u8) -> Output {
    let total = |g: &mut Graph, root: Option<NodeId>| {
        again(g, &[root], |g, leaf| clock.total(g, leaf, true)).pop().flatten()
    };
    let rate = (derivatives >= 1).then(|| total(g, Some(value)));
    let acceleration = (derivatives >= 2).then(|| total(g, rate.flatten()));
    Output { value, rate, acceleration }
}
