//! Runs a program as the emitted code runs: stage by stage, line by line, without reading a value that was not computed.

use super::law;
use super::oracle::Evaluation;
use crate::equations::{Equations, Sparse};
use crate::program::{Assignment, Program, Section, Stage};
use crate::symbolic::{Graph, Leaf, Node, NodeId, Unary};

/// A value of a function and its index there.
pub struct Found {
    pub function: &'static str,
    pub index: usize,
    pub value: f64,
}

/// Values in the order of the oracle.
pub fn run(equations: &Equations, program: &Program, state: &Evaluation) -> Vec<Found> {
    let machine = Machine { graph: &equations.graph, state };
    let nothing = vec![None; equations.graph.len()];
    let parameters = machine.stage(&program.parameters, &nothing);
    let known = machine.stage(&program.position, &parameters);
    let mut results = Vec::new();
    let mut read = |function: &'static str, section: &Section, roots: Vec<Option<NodeId>>| {
        let values = machine.section(section, &known);
        for (index, root) in roots.into_iter().enumerate() {
            let value = root.map_or(0.0, |root| machine.value(root, &values));
            results.push(Found { function, index, value });
        }
    };
    let rows = &equations.rows;
    let entries = rows.iter().flat_map(|row| {
        (0..state.q.len()).map(|column| row.phi_q.iter().find(|(c, _)| *c == column).map(|(_, entry)| *entry))
    });
    read("phi", &program.phi, rows.iter().map(|row| Some(row.phi)).collect());
    read("phi_q", &program.phi_q, entries.collect());
    read("phi_t", &program.phi_t, rows.iter().map(|row| row.phi_t).collect());
    read("phi_tt", &program.phi_tt, rows.iter().map(|row| row.phi_tt).collect());
    read("phi_qt_qd", &program.phi_qt_qd, rows.iter().map(|row| row.phi_qt_qd).collect());
    read("gamma", &program.gamma, rows.iter().map(|row| row.gamma).collect());
    read("branch", &program.branches, equations.branches.iter().map(|branch| Some(*branch)).collect());
    let outputs = equations.outputs.iter();
    let outputs = outputs.flat_map(|y| [Some(y.value), y.rate.flatten(), y.acceleration.flatten()]);
    read("output", &program.outputs, outputs.collect());
    if let (Some(dynamics), Some(program)) = (&equations.dynamics, &program.dynamics) {
        let dense = |matrix: &Sparse| -> Vec<Option<NodeId>> {
            let entry =
                |row: &[(usize, NodeId)], column| row.iter().find(|(c, _)| *c == column).map(|(_, e)| *e);
            matrix.iter().flat_map(|row| (0..state.q.len()).map(|column| entry(row, column))).collect()
        };
        read("mass", &program.mass, dense(&dynamics.mass));
        read("mass_times", &program.mass_times, dynamics.mass_times.clone());
        read("force", &program.force, dynamics.force.clone());
        read("reaction", &program.reaction, dynamics.reaction.clone());
        read("force_q", &program.force_q, dense(&dynamics.force_q));
        read("force_qd", &program.force_qd, dense(&dynamics.force_qd));
        read("mass_times_q", &program.mass_times_q, dense(&dynamics.mass_times_q));
        read("reaction_q", &program.reaction_q, dense(&dynamics.reaction_q));
        if let Some(third) = &dynamics.third {
            read("third", &program.third, third.row.iter().copied().chain([third.right]).collect());
        }
        read("energy", &program.energy, vec![dynamics.kinetic, dynamics.potential]);
        read("power", &program.powers, dynamics.powers.clone());
        read("state_rate", &program.state_rates, dynamics.state_rates.clone());
        read("load", &program.loads, dynamics.loads.iter().map(|load| Some(*load)).collect());
    }
    results
}

struct Machine<'a> {
    graph: &'a Graph,
    state: &'a Evaluation,
}

/// One slot a node of the graph, filled once it is computed.
type Values = Vec<Option<f64>>;

impl Machine<'_> {
    /// Known values, and those that a stage keeps.
    fn stage(&self, stage: &Stage, known: &Values) -> Values {
        let values = self.section(&stage.section, known);
        let mut kept = known.clone();
        for id in stage.fields.keys() {
            kept[id.index()] = Some(self.value(*id, &values));
        }
        kept
    }

    /// Executes a section with the known values.
    fn section(&self, section: &Section, known: &Values) -> Values {
        let mut values = known.clone();
        for line in &section.lines {
            match line {
                Assignment::Value(id) => {
                    let value = self.operation(*id, &values);
                    values[id.index()] = Some(value);
                }
                Assignment::SineCosine(angles) => {
                    for known in angles {
                        let angle = self.value(known.angle, &values);
                        for (function, id) in [(Unary::Sin, known.sine), (Unary::Cos, known.cosine)] {
                            if let Some(id) = id {
                                values[id.index()] = Some((function.entry().value)(angle));
                            }
                        }
                    }
                }
                Assignment::Jet(jet) => {
                    let argument = self.value(jet.argument, &values);
                    for (order, id) in jet.orders.iter().enumerate() {
                        if let Some(id) = id {
                            let value = law::derivative(jet.function, order as u8, argument);
                            values[id.index()] = Some(value);
                        }
                    }
                }
            }
        }
        values
    }

    fn operation(&self, id: NodeId, values: &Values) -> f64 {
        let of = |id: NodeId| self.value(id, values);
        match self.graph.node(id) {
            Node::Unary(function, a) => (function.entry().value)(of(a)),
            Node::Binary(function, a, b) => (function.entry().value)(of(a), of(b)),
            Node::Select { less, than, yes, no } => {
                if of(less) < of(than) {
                    of(yes)
                } else {
                    of(no)
                }
            }
            Node::Constant(_) | Node::Leaf(_) | Node::Call { .. } => of(id),
        }
    }

    /// An operand: a number, a variable of the state, or a value that was computed before.
    fn value(&self, id: NodeId, values: &Values) -> f64 {
        if let Some(value) = values[id.index()] {
            return value;
        }
        match self.graph.node(id) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Leaf(Leaf::Parameter(i) | Leaf::Input(i)) => self.state.variables[i as usize],
            Node::Leaf(Leaf::Time) => self.state.t,
            Node::Leaf(Leaf::Position(i)) => self.state.q[i as usize],
            Node::Leaf(Leaf::Velocity(i)) => self.state.qd[i as usize],
            Node::Leaf(Leaf::Acceleration(i) | Leaf::Direction(i)) => self.state.qdd[i as usize],
            Node::Leaf(Leaf::State(i)) => self.state.states[i as usize],
            Node::Leaf(Leaf::Multiplier(i)) => self.state.lambda[i as usize],
            node => panic!("{node:?} is used before it is computed"),
        }
    }
}
