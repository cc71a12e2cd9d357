//! Graph → ordered, staged straight-line code, with operation counts.

mod angles;
mod blocks;
mod contacts;
mod dynamics;
pub mod motion;
mod powers;
mod schedule;
mod stages;

use std::collections::{BTreeMap, BTreeSet};

use crate::equations::Equations;
use crate::structure::Structure;
use crate::symbolic::{Graph, NodeId};

pub use angles::share_angles;
pub use blocks::{BlockMethod, BlockProgram, System};
pub use contacts::{ContactProgram, PushProgram};
pub use dynamics::DynamicsProgram;
pub use powers::take_roots;
pub use schedule::{Angle, Assignment, FunctionDerivatives, Operations, Section};

/// Everything that is emitted, in the order in which it is computed.
#[derive(Debug)]
pub struct Program {
    /// Values of parameters alone that later stages use: node → field of the stage's struct.
    pub parameters: Stage,
    /// Values of `(q, t)` that several functions share.
    pub position: Stage,
    /// Φ
    pub phi: Section,
    /// Φ_q
    pub phi_q: Section,
    /// Φ_t
    pub phi_t: Section,
    /// Φ_tt
    pub phi_tt: Section,
    /// Φ_qt q̇
    pub phi_qt_qd: Section,
    /// γ
    pub gamma: Section,
    /// Φ, Φ_q, Φ_t and γ together, from coordinates on.
    pub evaluation: Section,
    /// Branch conditions.
    pub branches: Section,
    /// Working ranges.
    pub limits: Section,
    /// Arguments of drives that prescribe a rate, without known values.
    pub phase_arguments: Section,
    /// Their rates, without known values.
    pub phase_speeds: Section,
    /// Outputs with their rates.
    pub outputs: Section,
    /// Guesses of the coordinates.
    pub guesses: Section,
    /// Reference metric of the coordinates.
    pub coordinate_scales: Section,
    /// Reference metric of the rows.
    pub row_scales: Section,
    /// Largest contradictions allowed between rows.
    pub widths: Section,
    /// The solution of Φ = 0, block after block.
    pub blocks: Vec<BlockProgram>,
    /// Values of the position stage that no block has computed.
    pub rest: Section,
    /// Masses and forces, where the text has any.
    pub dynamics: Option<DynamicsProgram>,
}

/// Straight-line code whose results are kept for later stages.
#[derive(Debug)]
pub struct Stage {
    /// The code.
    pub section: Section,
    /// Index of each kept value.
    pub fields: BTreeMap<NodeId, usize>,
}

/// Before: equations and their block order. After: one section of straight-line code a function, each value
/// computed in its own stage.
pub fn order(equations: &Equations, structure: &Structure) -> Program {
    let graph = &equations.graph;
    let roots = Roots::of(equations);
    let dynamics = equations.dynamics.as_ref().map(dynamics::Roots::of);
    let mut functions = roots.functions().to_vec();
    functions.extend(dynamics.iter().flat_map(dynamics::Roots::each_step));
    let rare: Vec<&[NodeId]> = dynamics.iter().flat_map(dynamics::Roots::rare).collect();
    let position_fields = stages::position_fields(graph, &functions, &rare);
    let blocks = blocks::roots(equations, structure);
    let mut consumers = functions;
    consumers.extend(rare);
    consumers.extend(dynamics.iter().flat_map(dynamics::Roots::start));
    consumers.push(&roots.guesses);
    consumers.push(&roots.coordinate_scales);
    consumers.push(&roots.row_scales);
    consumers.push(&roots.widths);
    consumers.push(&blocks);
    let parameter_fields = stages::parameter_fields(graph, &consumers);
    let none = BTreeSet::new();
    let parameters = Stage::new(graph, parameter_fields, &none);
    let after_parameters: BTreeSet<NodeId> = parameters.fields.keys().copied().collect();
    let position = Stage::new(graph, position_fields, &after_parameters);
    let known: BTreeSet<NodeId> = after_parameters.iter().chain(position.fields.keys()).copied().collect();
    let section = |roots: &[NodeId]| schedule::schedule(graph, roots, &known);
    let early = |roots: &[NodeId]| schedule::schedule(graph, roots, &after_parameters);
    let behind = |first: &Section, roots: &[NodeId]| {
        schedule::schedule(graph, roots, &known.iter().copied().chain(first.computed()).collect())
    };
    let kept: Vec<NodeId> = position.fields.keys().copied().collect();
    let solution = blocks::order(equations, structure, &after_parameters, &kept);
    Program {
        phi: section(&roots.phi),
        phi_q: section(&roots.phi_q),
        phi_t: section(&roots.phi_t),
        phi_tt: section(&roots.phi_tt),
        phi_qt_qd: section(&roots.phi_qt_qd),
        gamma: section(&roots.gamma),
        evaluation: early(&[&roots.phi[..], &roots.phi_q, &roots.phi_t, &roots.gamma].concat()),
        branches: section(&roots.branches),
        limits: section(&roots.limits),
        phase_arguments: schedule::schedule(graph, &roots.phase_arguments, &none),
        phase_speeds: schedule::schedule(graph, &roots.phase_speeds, &none),
        outputs: section(&roots.outputs),
        guesses: early(&roots.guesses),
        coordinate_scales: early(&roots.coordinate_scales),
        row_scales: early(&roots.row_scales),
        widths: early(&roots.widths),
        blocks: solution.blocks,
        rest: solution.rest,
        dynamics: dynamics.map(|roots| roots.order(graph, section, behind, early)),
        parameters,
        position,
    }
}

impl Program {
    /// Operations of the solution of Φ = 0 and of Φ_q, an iteration of each block counted once.
    pub fn length(&self) -> usize {
        let block = |block: &BlockProgram| {
            let iteration = match &block.method {
                BlockMethod::Newton(system) => system.section.lines.len(),
                BlockMethod::Explicit { .. } => 0,
            };
            block.before.lines.len() + iteration
        };
        self.blocks.iter().map(block).sum::<usize>() + self.rest.lines.len() + self.phi_q.lines.len()
    }
}

impl Stage {
    fn new(graph: &Graph, fields: BTreeSet<NodeId>, known: &BTreeSet<NodeId>) -> Self {
        let roots: Vec<NodeId> = fields.iter().copied().collect();
        let section = schedule::schedule(graph, &roots, known);
        let fields = roots.into_iter().enumerate().map(|(index, id)| (id, index)).collect();
        Stage { section, fields }
    }
}

/// The roots of each function.
struct Roots {
    phi: Vec<NodeId>,
    phi_q: Vec<NodeId>,
    phi_t: Vec<NodeId>,
    phi_tt: Vec<NodeId>,
    phi_qt_qd: Vec<NodeId>,
    gamma: Vec<NodeId>,
    branches: Vec<NodeId>,
    limits: Vec<NodeId>,
    phase_arguments: Vec<NodeId>,
    phase_speeds: Vec<NodeId>,
    outputs: Vec<NodeId>,
    guesses: Vec<NodeId>,
    coordinate_scales: Vec<NodeId>,
    row_scales: Vec<NodeId>,
    widths: Vec<NodeId>,
}

impl Roots {
    fn of(equations: &Equations) -> Self {
        let rows = &equations.rows;
        let outputs = equations.outputs.iter();
        Roots {
            phi: rows.iter().map(|row| row.phi).collect(),
            phi_q: rows.iter().flat_map(|row| row.phi_q.iter().map(|(_, entry)| *entry)).collect(),
            phi_t: rows.iter().filter_map(|row| row.phi_t).collect(),
            phi_tt: rows.iter().filter_map(|row| row.phi_tt).collect(),
            phi_qt_qd: rows.iter().filter_map(|row| row.phi_qt_qd).collect(),
            gamma: rows.iter().filter_map(|row| row.gamma).collect(),
            branches: equations.branches.clone(),
            limits: equations.limits.iter().flatten().copied().collect(),
            phase_arguments: equations.phases.iter().map(|phase| phase.argument).collect(),
            phase_speeds: equations
                .phases
                .iter()
                .flat_map(|phase| [Some(phase.speed), phase.acceleration].into_iter().flatten())
                .collect(),
            outputs: outputs
                .flat_map(|output| {
                    [Some(output.value), output.rate.flatten(), output.acceleration.flatten()]
                        .into_iter()
                        .flatten()
                })
                .collect(),
            guesses: equations.guesses.clone(),
            coordinate_scales: equations.coordinate_scales.clone(),
            row_scales: equations.row_scales.clone(),
            widths: equations.widths.clone(),
        }
    }

    /// The functions of a position.
    fn functions(&self) -> [&[NodeId]; 9] {
        [
            &self.phi,
            &self.phi_q,
            &self.phi_t,
            &self.phi_tt,
            &self.phi_qt_qd,
            &self.gamma,
            &self.branches,
            &self.limits,
            &self.outputs,
        ]
    }
}
